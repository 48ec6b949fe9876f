"""The march of tied bodies, many at once, from event to event.

A step lies within one closed form of the motion and one branch of the restraints, and
has one turn at most (`series`). If y passes an end of the branch before or after the
turn, the step ends there: the bracket holds one root. So a step cannot miss an
engagement, a yield, a slack, a rupture or an impact. A peak ends a step only if a
restraint yields there.

After the shaking the body goes on over still ground until its outcome is proved. The
energy that a body needs to come back to a peak, from which it has returned, is what it
had there. Impacts, damping, yielding and ruptures only take energy: a tendon that
breaks beyond this peak, on the other side, takes at least what it had stored at the
peak. So

- a body that has returned to the ground from a peak on each of its sides never exceeds
  these peaks again: it rocked;
- a body that turns back outwards above the ground after such a peak goes to and fro
  between both: it leans;
- a body overturns if it lies on its side, or, in the linear equation, if it moves
  outwards in the last branch of its restraints, whose stiffness is not positive, and no
  drive to come reaches its force.

A body that rocked or leans keeps Fz > 0 later if it did so up to then. At the same
rotation it is never faster than on the way back from that peak, and its restraints pull
as they did. Two things could make Fz less: damping, which acts downwards on the way
out, and the loss of a tendon. So a damped body is followed to a second peak on each
side, which begins and ends on still ground, and after the rupture of a tendon the peaks
count anew.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...errors import UsageError
from ...motions.motion import Motion
from ..batch import MAX_STEPS
from ..contacts.contact import OneSided
from ..drive import place
from ..lanes import Array, Cells, Lanes
from ..outcome import FALLEN, LOST, Outcome
from ..system import System
from .bounces import Bounces
from .contact_watch import ContactWatch, Steps
from .devices import BROKEN, ELASTIC, SLACK, YIELDING, Branch
from .series import Law, Step, falls, one_turn
from .tied_lanes import Found, Recorder, StepEnds, TiedLanes

# a speed below this counts as zero: it changes y by about as much, and a later uplift
# by far less than rounding
_STILL = 1e-20
_TOGETHER = 8192  # lanes
WORDS = {SLACK: "slack", ELASTIC: "engagement", YIELDING: "yield", BROKEN: "rupture"}


class March:
    """The march of cells (A, Omega, eta) of one body with ties or a tendon under a
    motion; recorder: stores the history of a single cell. Raises UsageError for a
    motion with a vertical part.
    """

    def __init__(
        self,
        system: System,
        motion: Motion,
        amplitude: Array,
        omega: Array,
        eta: Array,
        recorder: Recorder | None = None,
    ):
        if motion.vertical is not None:
            raise UsageError(
                "found a vertical motion under a body with ties or a tendon; expected a"
                " horizontal motion alone"
            )
        assert system.devices is not None
        segments = motion.segments
        self.equation, self.contact, self.devices = (
            system.equation,
            system.contact,
            system.devices,
        )
        self.cells = self.contact.cells(self.equation, amplitude, omega, eta)
        self.shaken, self.segments, self.recorder = (
            len(segments),
            segments.followed_by_rest(np.inf),
            recorder,
        )
        self.one_sided = isinstance(self.contact, OneSided)
        self.again = (
            2 if self.equation.damping and self.devices.body is not None else 0
        )  # bits to the second turn on a side
        self.every = (1 if self.one_sided else 3) << self.again
        sides = np.array([1.0, -1.0])
        self.law = Law(self.equation, self.devices)
        self.limit = np.minimum(
            np.broadcast_to(self.equation.on(sides).limit, 2), self.devices.lever_ends()
        )
        self.watch = (
            None
            if self.devices.body is None
            else ContactWatch(self.devices, self.devices.body)
        )
        self.bounces = Bounces(self.devices, self.contact, self.equation, self.segments)
        self.doubtful = (
            1.0  # y beyond which the march tests whether a body can come back
        )
        if recorder is not None:
            self.doubtful = float(
                np.max(self.equation.on(sides).displacement(np.full(2, FALLEN)))
            )
        self.most = MAX_STEPS + 40 * self.shaken
        size, shape = omega.size, (*self.devices.stiffness.shape, omega.size)
        self.found = Found(
            np.zeros(size, dtype=np.uint8),
            np.full(size, np.nan),
            np.zeros(size, dtype=np.int32),
            np.zeros(size, dtype=np.int64),
            np.zeros(shape, dtype=np.int64),
            np.zeros(shape),
            np.zeros(shape),
        )

    def run(self, release: float = 0.0) -> Found:
        """March all cells to their ends, from rest or released to the right from
        theta/alpha = release; returns their results.
        """
        with np.errstate(all="ignore"):
            waiting = np.arange(self.found.outcome.size)
            lanes = self._begin(waiting[:0], 0.0)
            while waiting.size or lanes.cell.size:
                if room := min(waiting.size, _TOGETHER - lanes.cell.size):
                    lanes, waiting = (
                        lanes.join(self._begin(waiting[:room], release)),
                        waiting[room:],
                    )
                lanes = self._round(lanes) if lanes.cell.size else lanes
        return self.found

    def _of(self, numbers: Array, row: Array) -> Array:
        return numbers[row, :, np.arange(row.size)].T

    def _begin(self, cell: Array, release: float) -> TiedLanes:
        count, zero = np.zeros(cell.size, dtype=np.int64), np.zeros(cell.size)
        amplitude, omega, eta = (
            np.broadcast_to(x, self.cells.omega.shape)[0, cell] for x in self.cells
        )
        none = np.zeros((*self.devices.stiffness.shape, cell.size))
        lanes = TiedLanes(
            cell,
            amplitude.copy(),
            omega.copy(),
            eta.copy(),
            count,
            zero,
            np.ones(cell.size),
            zero.copy(),
            zero.copy(),
            zero.copy(),
            zero.copy(),
            count.copy(),
            count.copy(),
            none.astype(np.int64),
            none.copy(),
            none.copy(),
            zero != 0.0,
            zero != 0.0,
            count.copy(),
            zero != 0.0,
            zero != 0.0,
        )
        if release:
            lanes.y[:] = self.equation.on(np.ones(cell.size)).displacement(
                np.full(cell.size, release)
            )
            lanes.peak[:] = lanes.y
            row = self.devices.row(lanes.side)
            e = self.devices.elongation(row, lanes.y)
            lanes.plastic[0], lanes.farthest[0] = self.devices.stretched(row, e), e
            pulls, _ = self.devices.thresholds(row, lanes.plastic[0])
            broken = e >= self.devices.on(self.devices.ultimate, row)
            lanes.branch[0] = np.where(
                broken, BROKEN, np.where(e > pulls, ELASTIC, SLACK)
            )
            self._note(lanes, "release", lanes.y, lanes.v)
            return lanes
        return self._from_rest(lanes, np.arange(cell.size), first=True)

    def _note(
        self, lanes: Lanes, event: str, y: Array, v: Array, device: str = ""
    ) -> None:
        if self.recorder is not None:
            self.recorder.note(lanes, event, float(y[0]), float(v[0]), device)

    def _from_rest(self, lanes: TiedLanes, at: Array, first: bool = False) -> TiedLanes:
        """Move lanes that rest to their next uplift; finish those that never lift off
        again.
        """
        if not at.size:
            return lanes
        resting = lanes.take(at)
        held = self.bounces.held(resting)
        bounces = (
            0.0
            if self.recorder is None or first
            else float(self.bounces.time(resting)[0])
        )
        drive = np.broadcast_to(
            self.cells.amplitude[:, resting.cell], (len(self.cells.amplitude), at.size)
        )
        effective = Cells(
            np.array([drive[0] / held[0], drive[-1] / held[-1]]),
            self.cells.omega,
            self.cells.eta,
        )
        again = self.contact.uplift(
            effective, self.segments, np.arange(at.size), resting.segment, resting.phase
        )
        k, u = place(self.segments, again.segment, again.phase)
        lanes.segment[at], lanes.phase[at], lanes.y[at], lanes.v[at] = k, u, 0.0, 0.0
        if not self.one_sided:
            self.contact.turn(self.cells, lanes, at, again.side)
        moved = (k != again.segment) & ~self.segments.joins[
            np.minimum(again.segment, len(self.segments) - 1)
        ]
        lanes.exact[at] = (again.force == 0.0) & ~moved
        self._leave(lanes, at)
        ended = k >= self.shaken
        if self.recorder is not None:
            if not first:
                self.recorder.rest(resting, lanes, bounces)
            elif not ended[0]:
                self._note(lanes, "uplift", lanes.y, lanes.v)
        lanes.rests[at] = False
        return self._finish(
            lanes,
            at[ended],
            np.full(lanes.cell.size, Outcome.NO_UPLIFT if first else Outcome.ROCKED),
        )

    def _leave(self, lanes: TiedLanes, at: Array) -> None:
        """Set the devices of lanes that leave the ground to the branches in which they
        begin.
        """
        row = self.devices.row(lanes.side)[at]
        branch, plastic = lanes.branch[row, :, at].T, lanes.plastic[row, :, at].T
        lanes.branch[row, :, at] = self.devices.at_ground(row, branch, plastic).T

    def _branch(self, lanes: TiedLanes) -> tuple[Array, Branch, Array, Array]:
        """(row, branch of the devices, y at its lower end, y at its upper end) of each
        lane.
        """
        row = self.devices.row(lanes.side)
        now = self.devices.branch(
            row, self._of(lanes.branch, row), self._of(lanes.plastic, row)
        )
        return (
            row,
            now,
            now.low.max(axis=0, initial=0.0),
            np.minimum(now.high.min(axis=0, initial=np.inf), self.limit[row]),
        )

    def _round(self, lanes: TiedLanes) -> TiedLanes:
        """Take one step of every lane by its series, and apply the events at its end;
        returns the lanes that go on.
        """
        lanes.steps += 1
        row, now, ground, high = self._branch(lanes)
        seg, k = self.segments, lanes.segment
        joined = seg.joins[k]
        left = (
            seg.length[k]
            - lanes.phase
            + np.where(joined, seg.length[np.minimum(k + 1, self.shaken)], 0.0)
        ) / lanes.omega
        step = one_turn(self.law.flow(seg, lanes, row, now, lanes.exact), left)
        arc, reach, y, v = step.arc, step.h.copy(), step.end.y.copy(), step.end.v.copy()
        turns = np.flatnonzero(step.turn > 0.0)
        reach[turns], y[turns], v[turns] = (
            step.turn[turns],
            arc.take(turns).at(step.turn[turns]).y,
            0.0,
        )
        top = y.copy()
        up, down = (
            (step.outward > 0.0) & (y >= high),
            (step.outward < 0.0) & (y <= ground),
        )
        peaked = np.zeros(k.size, dtype=bool)
        peaked[turns] = (step.outward[turns] > 0.0) & ~up[turns]
        through = (
            peaked & ~now.yields & (self.recorder is None)
        )  # here a peak ends no branch
        reach[through], y[through], v[through] = (
            step.h[through],
            step.end.y[through],
            step.end.v[through],
        )
        down |= through & (y <= ground)
        at = np.flatnonzero(up | down)
        if at.size:
            sense, level = (
                np.where(up[at], -1.0, 1.0),
                np.where(up[at], high[at], ground[at]),
            )
            here = arc.take(at)
            here.terms *= sense
            here.terms[0] -= sense * level
            reach[at], v[at] = falls(
                here, np.where(through[at], step.turn[at], 0.0), reach[at]
            )
            v[at] *= sense
            y[at] = level
        top = np.where(through, top, y)
        if self.recorder is not None:
            self.recorder.keep(lanes, arc, float(reach[0]), now)
        self._press(lanes, row, now, step, reach)
        whole = (reach >= left) & ~(up | down)
        lanes.y, lanes.v = y, v
        lanes.segment, lanes.phase = place(
            seg, k, np.where(whole, 0.0, lanes.phase + lanes.omega * reach)
        )
        lanes.segment[whole] = (k + 1 + joined)[whole]
        lanes.exact[:] = False
        turned = peaked | (v == 0.0)
        return self._events(
            lanes,
            row,
            now,
            high,
            StepEnds(
                up, down, peaked, turned & ~peaked & ~(up | down), top, k >= self.shaken
            ),
        )

    def _press(
        self, lanes: TiedLanes, row: Array, now: Branch, step: Step, reach: Array
    ) -> None:
        """Mark lanes with Fz <= 0 in their steps; of a body that is recorded, note the
        first such instant.
        """
        if self.watch is None:
            return
        steps = Steps(lanes, row, now, step, reach)
        lost, around = self.watch.losses(steps, lanes.lost)
        lanes.lost[lost] = True
        if self.recorder is not None and lost.size:
            instant = self.watch.first(steps, *around)
            then = step.arc.at(instant)
            self._note(
                replace(lanes, phase=lanes.phase + lanes.omega * instant),
                LOST,
                then.y,
                then.v,
            )

    def _events(
        self, lanes: TiedLanes, row: Array, now: Branch, high: Array, ends: StepEnds
    ) -> TiedLanes:
        """Apply the events at step ends: a peak on the way, an end of a branch, an
        impact, a turn. Returns the lanes that go on.
        """
        fallen, hit = ends.up & (high >= self.limit[row]), ends.down & (lanes.y <= 0.0)
        self._stretch(lanes, np.flatnonzero(ends.peaked | ends.up), row, ends.top)
        peaked = np.flatnonzero(ends.peaked)
        if peaked.size:
            lanes.peak[peaked] = np.maximum(lanes.peak[peaked], ends.top[peaked])
            still = peaked[ends.still[peaked]]
            here = 1 << row[still]
            lanes.turned[still] |= here | (lanes.turned[still] & here) << 2
            self._note(lanes, "peak", lanes.y, lanes.v)
            self._unload(lanes, peaked[now.yields[peaked]], row)
        for at, limits, sign in (
            (np.flatnonzero(ends.up & ~fallen), now.high, 1.0),
            (np.flatnonzero(ends.down & ~hit), now.low, -1.0),
        ):
            if at.size:
                self._pass(lanes, at, row, limits, sign)
        leans = ends.bottom & ((lanes.turned >> (row + self.again)) & 1 > 0)
        falls = fallen | self._certain(lanes, row, now, high)
        failed = (lanes.steps > self.most) | ~np.isfinite(lanes.y + lanes.v)
        impacts = np.flatnonzero(hit)
        ended = np.zeros(lanes.cell.size, dtype=bool)
        if impacts.size:
            ended = self._strike(lanes, impacts, row)
        outcome = np.where(
            falls,
            np.where(
                lanes.bounced,
                Outcome.OVERTURNED_AFTER_IMPACT,
                Outcome.OVERTURNED_NO_IMPACT,
            ),
            0,
        )
        outcome = np.where(
            leans, Outcome.LEANING, np.where(ended, Outcome.ROCKED, outcome)
        )
        outcome = np.where(failed, Outcome.FAILED, outcome)
        if self.recorder is not None and outcome[0] in (
            Outcome.LEANING,
            Outcome.ROCKED,
        ):
            outcome[0] *= (
                self.segments.start[lanes.segment[0]] + lanes.phase[0]
                >= self.recorder.until
            )
        if falls.any():
            self._stretch(lanes, np.flatnonzero(falls), row, lanes.y)
            self._note(lanes, "overturning", lanes.y, lanes.v)
        lanes = self._finish(lanes, np.flatnonzero(outcome), outcome)
        return self._from_rest(lanes, np.flatnonzero(lanes.rests))

    def _stretch(self, lanes: TiedLanes, at: Array, row: Array, top: Array) -> None:
        """Note the elongation of unbroken devices at y = `top` where it is their
        largest so far.
        """
        e, row = self.devices.elongation(row[at], top[at]), row[at]
        whole = lanes.branch[row, :, at].T != BROKEN
        lanes.farthest[row, :, at] = np.where(
            whole,
            np.maximum(lanes.farthest[row, :, at].T, e),
            lanes.farthest[row, :, at].T,
        ).T

    def _pass(
        self, lanes: TiedLanes, at: Array, row: Array, limits: Array, sign: float
    ) -> None:
        """Move devices of the lanes `at` that are at an upper (sign = 1) or lower (sign
        = -1) end of their branch to the next branch.
        """
        reached = sign * (lanes.y[at] - limits[:, at]) >= 0.0
        branch, plastic = (x[row[at], :, at].T for x in (lanes.branch, lanes.plastic))
        elastic, ultimate = (
            branch == ELASTIC,
            self.devices.on(self.devices.ultimate, row[at]),
        )
        _, yields = self.devices.thresholds(row[at], plastic)
        if sign > 0.0:
            following = np.where(
                branch == SLACK,
                ELASTIC,
                np.where(elastic & (yields < ultimate), YIELDING, BROKEN),
            )
        else:
            following = np.full(branch.shape, SLACK)
        following = np.where(reached, following, branch)
        breaks = reached & (following == BROKEN)
        kept = np.where(breaks, self.devices.stretched(row[at], ultimate), plastic)
        lanes.branch[row[at], :, at], lanes.plastic[row[at], :, at] = (
            following.T,
            kept.T,
        )
        for device in np.flatnonzero(
            self.devices.tendon
        ):  # a tendon breaks on both sides
            lanes.branch[:, device, at[breaks[device]]] = BROKEN
            lanes.turned[at[breaks[device]]] = (
                0  # without it Fz is not what it was on the way back from a peak
            )
        if self.recorder is not None:
            for device in np.flatnonzero(reached[:, 0]):
                self._note(
                    lanes,
                    WORDS[int(following[device, 0])],
                    lanes.y,
                    lanes.v,
                    self.devices.names[device],
                )

    def _unload(self, lanes: TiedLanes, at: Array, row: Array) -> None:
        """Unload the lanes `at`, whose velocity has changed sign: yielding devices
        become elastic and keep their permanent elongation.
        """
        if not at.size:
            return
        branch, plastic = (x[row[at], :, at].T for x in (lanes.branch, lanes.plastic))
        left = self.devices.stretched(
            row[at], self.devices.elongation(row[at], lanes.y[at])
        )
        yielding = branch == YIELDING
        lanes.branch[row[at], :, at] = np.where(yielding, ELASTIC, branch).T
        lanes.plastic[row[at], :, at] = np.where(
            yielding, np.maximum(left, plastic), plastic
        ).T
        if self.recorder is not None:
            for device in np.flatnonzero(yielding[:, 0]):
                self._note(
                    lanes, "unloading", lanes.y, lanes.v, self.devices.names[device]
                )

    def _certain(self, lanes: TiedLanes, row: Array, now: Branch, high: Array) -> Array:
        """True for lanes that no later drive can turn back."""
        falls = np.zeros(lanes.cell.size, dtype=bool)
        at = np.flatnonzero(
            (lanes.y > self.doubtful) & (lanes.v > 0.0) & (high >= self.limit[row])
        )
        if not at.size:
            return falls
        side, k = lanes.side[at], np.minimum(lanes.segment[at], len(self.segments) - 1)
        inward = self.segments.strongest_inward(side, lanes.amplitude[at], k)
        if self.devices.linear:
            there = Branch(*(x[..., at] for x in now))
            soft = self.devices.linear_terms(row[at], there)[1] <= 1.0
            falls[at] = soft & (
                self.law.force(row[at], there, side, lanes.y[at], -inward) > 0.0
            )
        else:
            free = ~(now.fixed[:, at].any(axis=0) | now.rate[:, at].any(axis=0))
            falls[at] = free & self.equation.on(side).certainly_overturns(
                lanes.y[at], lanes.v[at], inward
            )
        return falls

    def _strike(self, lanes: TiedLanes, at: Array, row: Array) -> Array:
        """Apply the impacts of the lanes `at`, and mark lanes that come to rest; True
        for lanes whose outcome is known.
        """
        self._note(lanes, "impact", lanes.y, lanes.v)
        struck = lanes.take(at)
        still = struck.segment >= self.shaken
        struck.impacts += ~still
        struck.bounced[:] = True
        struck.v = np.minimum(struck.v, 0.0)
        known = np.zeros(lanes.cell.size, dtype=bool)
        known[at] = still & (struck.turned & self.every == self.every)
        self.contact.impact(self.cells, struck, struck.v, struck.force)
        struck.y[:] = 0.0
        for name in (
            "side",
            "y",
            "v",
            "amplitude",
            "omega",
            "eta",
            "peak",
            "impacts",
            "bounced",
        ):
            getattr(lanes, name)[at] = getattr(struck, name)
        self._leave(lanes, at)
        stops, seen = (
            struck.v < _STILL,
            0.0 if self.recorder is None else self.recorder.visible,
        )
        low = lanes.take(at)
        ends = ((seen == 0.0) | (struck.v < seen)) & self.bounces.end(low)
        watched = np.flatnonzero(ends & ~low.lost)
        ends[watched] = self.bounces.keep_contact(low.take(watched))
        lanes.rests[at] = stops | ends
        return known

    def _finish(self, lanes: TiedLanes, at: Array, outcome: Array) -> TiedLanes:
        """Store the results of the lanes `at`; outcome: of all lanes. Returns the other
        lanes.
        """
        if not at.size:
            return lanes
        cell, found, row = lanes.cell[at], self.found, self.devices.row(lanes.side)[at]
        found.outcome[cell], found.impacts[cell], found.steps[cell] = (
            outcome[at],
            lanes.impacts[at],
            lanes.steps[at],
        )
        known = np.isin(
            outcome[at], (Outcome.NO_UPLIFT, Outcome.ROCKED, Outcome.LEANING)
        )
        ratio = self.equation.on(lanes.side[at]).rotation(lanes.peak[at])
        found.theta_ratio[cell] = np.where(known & ~lanes.lost[at], ratio, np.nan)
        found.outcome[cell[known & lanes.lost[at]]] = Outcome.LOST_CONTACT
        branch, plastic = lanes.branch[row, :, at].T, lanes.plastic[row, :, at].T
        left = self.devices.stretched(row, self.devices.elongation(row, lanes.y[at]))
        lanes.plastic[row, :, at] = np.where(
            branch == YIELDING, np.maximum(left, plastic), plastic
        ).T
        for name in ("branch", "plastic", "farthest"):
            getattr(found, name)[..., cell] = getattr(lanes, name)[..., at]
        return lanes.take(np.delete(np.arange(lanes.cell.size), at))
