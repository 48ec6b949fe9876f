"""The march of tied bodies, many at once, from event to event.

A step lies within one closed form of the motion and one branch of the restraints, and
has one turn at most (`series`). If y passes an end of the branch before or after the
turn, the step ends there: the bracket holds one root. So a step cannot miss an
engagement, a yield, a slack, a rupture or an impact. A peak ends a step only if a
restraint yields there.

Under a constant drive an elastic body comes back to the ground with the speed 0, by its
energy: it touches the ground without an impact, and turns outwards again. Computed, it
turns a rounding above or below the ground. So a turn outwards within the error of y
from the ground is a touch.

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

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..condition import rows, through_impact
from ..drive import place
from ..equations.straight_lines import weight_series
from ..lanes import Cells
from ..observers.contact_watch import ContactWatch
from ..observers.observer import Arcs, Observer
from ..outcome import FALLEN, Outcome
from .bounces import Bounces
from .carried import carry_step, carry_through_break, keep_yield_error
from .cuts import cut
from .devices import Branch, Devices
from .series import HeldBody, Law, Step, one_turn
from .tied_lanes import STILL, CutStep, Found, OnBranch, TiedLanes, touch_of
from .tied_lines import LEAST_LINES, TiedLines
from .transitions import keep_yield, leave, pass_end, stretch, unload

_TOGETHER = 8192  # lanes
_DOUBTFUL = 1.0  # y beyond which the march tests whether a body can come back


class TiedMarch:
    """The march of a batch of cells of bodies with these devices; speed: finds the
    largest speeds.
    """

    def __init__(self, devices: Devices, batch: Batch, speed: Observer | None = None):
        self.equation, self.contact = batch.equation, batch.contact
        self.cells, self.segments = batch.cells, batch.segments
        self.shaken, self.free_fall = batch.shaken, batch.free_fall
        self.devices = devices
        # bits of `turned` to the second turn on a side, and all bits that it needs
        again = self.equation.damped and self.devices.body is not None
        self.again = 2 if again else 0
        self.every = (1 << devices.sides) - 1 << self.again
        of_lines = self.segments.straight and self.shaken >= LEAST_LINES
        self.law = Law(self.equation, self.devices, of_lines)
        self.lever_ends = self.devices.lever_ends()
        self.bounces = Bounces(self.devices, self.contact, self.equation, self.segments)
        self.watch = None
        if self.devices.body is not None:
            self.watch = ContactWatch(
                self.devices.body,
                self.equation,
                self.contact,
                self.segments,
                np.ones(batch.size, dtype=bool),
                self.bounces,
            )
        self.observers = [x for x in (self.watch, speed) if x is not None]
        # the lines of a record, None under another motion
        self.lines = None
        if of_lines and self.segments.weighed is None:
            self.lines = TiedLines(batch, self.devices, self.observers)
        self.touch = touch_of(self.equation.tolerance)
        self.most = batch.most_steps  # steps beyond which a lane fails
        self.held = self.devices.sides, len(self.devices.names)
        self.found = Found.empty((*self.held, batch.size))

    def run(self) -> Found:
        """March all cells from rest to their ends; returns their results."""
        with np.errstate(all="ignore"):
            waiting = np.arange(self.found.outcome.size)
            lanes = self._begin(waiting[:0])
            while waiting.size or lanes.cell.size:
                if room := min(waiting.size, _TOGETHER - lanes.cell.size):
                    lanes = lanes.join(self._begin(waiting[:room]))
                    waiting = waiting[room:]
                if not lanes.cell.size:
                    continue
                branch = self._branch(lanes)
                if self.lines is not None:
                    # `_certain` is asked on the last branch only.
                    last = branch.high >= branch.limit
                    self.lines.along(lanes, branch, np.where(last, _DOUBTFUL, np.inf))
                lanes = self._round(lanes, branch)
        return self.found

    def _begin(self, cell: Array) -> TiedLanes:
        """Return new lanes for these cells, at their first uplift."""
        lanes = TiedLanes.slack(self.cells, cell, self.held)
        return self._from_rest(lanes, np.arange(cell.size), first=True)

    def _from_rest(self, lanes: TiedLanes, at: Array, first: bool = False) -> TiedLanes:
        """Move lanes that rest to their next uplift; finish those that never lift off
        again.
        """
        if not at.size:
            return lanes
        resting = lanes.take(at)
        ratios = self.bounces.uplift_ratios(resting)
        # The devices hold the body at rest as a larger amplitude of uplift would.
        drive = np.broadcast_to(
            self.cells.amplitude[:, resting.cell], (len(self.cells.amplitude), at.size)
        )
        effective = Cells(
            np.array([drive[0] / ratios[0], drive[-1] / ratios[-1]]),
            self.cells.omega,
            self.cells.eta,
        )
        again = self.contact.uplift(
            effective, self.segments, np.arange(at.size), resting.segment, resting.phase
        )
        k, u = place(self.segments, again.segment, again.phase)
        lanes.segment[at], lanes.phase[at], lanes.y[at], lanes.v[at] = k, u, 0.0, 0.0
        lanes.moments[:3, at] = 0.0
        self.contact.turn(self.cells, lanes, at, again.side)
        # y'' is exactly 0 at an uplift, unless the drive jumps on the way to the next
        # segment.
        moved = (k != again.segment) & ~self.segments.joins[
            np.minimum(again.segment, len(self.segments) - 1)
        ]
        lanes.exact[at] = (again.force == 0.0) & ~moved
        leave(self.devices, lanes, at)
        ended = k >= self.shaken
        lanes.rests[at] = False
        outcome = np.zeros(lanes.cell.size, dtype=np.int64)
        outcome[at[ended]] = Outcome.NO_UPLIFT if first else Outcome.ROCKED
        if self.free_fall is not None:
            outcome[at] = self._without_ground(lanes, outcome)[at]
        return self._finish(lanes, np.flatnonzero(outcome), outcome)

    def _without_ground(self, lanes: TiedLanes, outcome: Array) -> Array:
        """The outcomes of all lanes, with those from which the ground has fallen away:
        overturned if the rotation is at least `FALLEN`, otherwise lost contact.
        """
        if self.free_fall is None:
            return outcome
        falls = self.free_fall.has_begun(lanes)
        over = self.equation.on(lanes.side, lanes.cell).rotation(lanes.y) >= FALLEN
        fallen = np.where(over, _overturned(lanes), Outcome.LOST_CONTACT)
        return np.where(falls & (outcome == 0), fallen, outcome)

    def _branch(self, lanes: TiedLanes) -> OnBranch:
        """The branch of the devices of each lane."""
        row = self.devices.row(lanes.side, lanes.cell)
        here = self.devices.place(row)
        now = self.devices.branch(row, lanes.branch[here].T, lanes.plastic[here].T)
        limit = np.minimum(
            self.equation.on(lanes.side, lanes.cell).limit, self.lever_ends[row]
        )
        return OnBranch(
            row,
            now,
            now.low.max(axis=0, initial=0.0),
            np.minimum(now.high.min(axis=0, initial=np.inf), limit),
            limit,
        )

    def _round(self, lanes: TiedLanes, branch: OnBranch) -> TiedLanes:
        """Take one step of every lane by its series, and apply the events at its end;
        returns the lanes that go on.
        """
        lanes.steps += 1
        row, now, low, high, _ = branch
        seg, k = self.segments, lanes.segment
        left = whole = seg.left_of_piece(k, lanes.phase) / lanes.omega
        if self.free_fall is not None:
            left = np.minimum(whole, self.free_fall.time_left(lanes))
        arc = self.law.flow(seg, lanes, row, now, lanes.exact)
        step = one_turn(arc, left)
        touch = self.touch * lanes.peak
        ended = cut(step, now, low, high, touch)
        # A body that rounding alone lifts, at an extreme of the drive, does not move.
        still = (lanes.y == 0.0) & (lanes.v == 0.0)
        still &= ~np.isfinite(ended.reach + ended.v)
        if still.any():
            ended = ended.without(still)
        self._show(lanes, step, ended.reach, branch)
        equation = self.equation.on(lanes.side, lanes.cell)
        held = HeldBody.of(equation, self.devices, row, now)
        carry_step(lanes, held, step, ended, touch)

        over = (ended.reach >= whole) & ~(ended.up | ended.down)
        self._go_on(lanes, ended, over, still)
        return self._events(lanes, branch, ended, k >= self.shaken)

    def _go_on(
        self, lanes: TiedLanes, ended: CutStep, over: Array, still: Array
    ) -> None:
        """Put lanes at the ends of their steps; over: True where the closed form of the
        motion ends there and the next one begins; still: True for bodies that have not
        moved, which rest until the next segment.
        """
        k = lanes.segment
        lanes.y, lanes.v = ended.y, ended.v
        lanes.segment, lanes.phase = place(
            self.segments,
            np.where(over, self.segments.after_piece(k), k),
            np.where(over, 0.0, lanes.phase + lanes.omega * ended.reach),
        )
        lanes.segment[still], lanes.phase[still] = k[still] + 1, 0.0
        lanes.rests |= still
        lanes.exact[:] = False

    def _show(
        self, lanes: TiedLanes, step: Step, reach: Array, branch: OnBranch
    ) -> None:
        """Show the steps to the observers."""
        arc, bounds = step.arc, (step.fastest, step.largest_acceleration)
        weight = weight_series(self.segments, lanes, self.law.order - 2)
        wanted, held = np.ones(reach.size, dtype=bool), (branch.row, branch.now)
        arcs = Arcs(lanes, arc, reach, *bounds, wanted, weight, held)
        for observer in self.observers:
            observer.arcs(arcs)

    def _events(
        self, lanes: TiedLanes, branch: OnBranch, ended: CutStep, still: Array
    ) -> TiedLanes:
        """Apply the events at step ends: a peak on the way, an end of a branch, an
        impact, a turn; still: True for lanes whose step began on still ground. Returns
        the lanes that go on.
        """
        # A body that passes the limit of y has fallen; one that comes to 0 strikes.
        row, now, _, high, limit = branch
        fallen, hit = ended.up & (high >= limit), ended.down & (lanes.y <= 0.0)
        stretch(
            self.devices, lanes, np.flatnonzero(ended.peaked | ended.up), row, ended.top
        )
        self._apply_peaks(lanes, row, now.yields, ended, still)
        self._pass_ends(lanes, np.flatnonzero(ended.up & ~fallen), row, now, 1.0)
        self._pass_ends(lanes, np.flatnonzero(ended.down & ~hit), row, now, -1.0)
        # A body that turned inwards on still ground and turns outwards again above the
        # ground comes to rest there: its restraints hold it.
        bottom = (ended.v == 0.0) & ~(ended.peaked | ended.up | ended.down)
        again = row % self.devices.sides + self.again
        leans = bottom & ((lanes.turned >> again) & 1 > 0)
        falls = fallen | self._certain(lanes, branch)
        failed = (lanes.steps > self.most) | ~np.isfinite(lanes.y + lanes.v)
        impacts = np.flatnonzero(hit)
        rocked = np.zeros(lanes.cell.size, dtype=bool)
        if impacts.size:
            rocked = self._apply_impacts(lanes, impacts, row)
        # The outcome, 0 while it is open. Later lines outweigh earlier ones.
        outcome = np.where(falls, _overturned(lanes), 0)
        outcome = np.where(
            leans, Outcome.LEANING, np.where(rocked, Outcome.ROCKED, outcome)
        )
        outcome = self._without_ground(lanes, outcome)
        outcome = np.where(failed, Outcome.FAILED, outcome)
        if falls.any():
            stretch(self.devices, lanes, np.flatnonzero(falls), row, lanes.y)
        lanes = self._finish(lanes, np.flatnonzero(outcome), outcome)
        return self._from_rest(lanes, np.flatnonzero(lanes.rests))

    def _apply_peaks(
        self,
        lanes: TiedLanes,
        row: Array,
        yields: Array,
        ended: CutStep,
        still: Array,
    ) -> None:
        """Record the peaks on the way: bodies have turned back, and restraints that
        yield unload.
        """
        at = np.flatnonzero(ended.peaked)
        if not at.size:
            return
        lanes.peak[at] = np.maximum(lanes.peak[at], ended.top[at])
        turned = at[still[at]]
        here = 1 << row[turned] % self.devices.sides
        lanes.turned[turned] |= here | (lanes.turned[turned] & here) << 2
        at = at[yields[at]]
        keep_yield_error(lanes, at)
        unload(self.devices, lanes, at, row)

    def _pass_ends(
        self, lanes: TiedLanes, at: Array, row: Array, now: Branch, sign: float
    ) -> None:
        """Move devices of the lanes `at`, whose branch ends there, to the next one;
        sign: 1 for its upper end, -1 for its lower end.
        """
        if not at.size:
            return
        limits = now.high if sign > 0.0 else now.low
        broken = pass_end(self.devices, lanes, at, row, limits, sign)
        if broken.size:
            before, after = now.take(broken), self._branch(lanes).now.take(broken)
            carry_through_break(lanes, broken, self.devices, row[broken], before, after)

    def _certain(self, lanes: TiedLanes, branch: OnBranch) -> Array:
        """True for lanes that no later drive can turn back."""
        row, now, _, high, limit = branch
        falls = np.zeros(lanes.cell.size, dtype=bool)
        at = np.flatnonzero((lanes.y > _DOUBTFUL) & (lanes.v > 0.0) & (high >= limit))
        if not at.size:
            return falls
        some, there = lanes.take(at), now.take(at)
        falls[at] = self.law.cannot_return(self.segments, some, row[at], there)
        return falls

    def _apply_impacts(self, lanes: TiedLanes, at: Array, row: Array) -> Array:
        """Apply the impacts of the lanes `at`, and mark lanes that come to rest; True
        for lanes whose outcome is known.
        """
        struck = lanes.take(at)
        still = struck.segment >= self.shaken
        struck.impacts += ~still
        struck.bounced[:] = True
        struck.v = np.minimum(struck.v, 0.0)
        # Once a body has turned back on every side on still ground, its later peaks are
        # lower (Lemma 8).
        known = np.zeros(lanes.cell.size, dtype=bool)
        known[at] = still & (struck.turned & self.every == self.every)
        before = struck.v, self._acceleration(struck)
        omega = struck.omega
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
        leave(self.devices, lanes, at)
        left = lanes.take(at)
        lanes.moments[:3, at] = through_impact(
            rows(left.moments),
            before,
            (left.v, self._acceleration(left)),
            omega / left.omega,
        )
        stops = struck.v < STILL
        # Bounces that end in rest (Lemma 7) and are proved to keep contact (Lemma 13).
        low = lanes.take(at)
        ends = self.bounces.end(low)
        if self.watch is not None:
            at_rest = np.flatnonzero(ends)
            ends[at_rest] = self.watch.may_rest(low.take(at_rest))
        lanes.rests[at] = stops | ends
        return known

    def _acceleration(self, lanes: TiedLanes) -> Array:
        """y'' of lanes at their present position."""
        row, now, *_ = self._branch(lanes)
        force = self.law.force_now(self.segments, lanes, row, now)
        return force - 2.0 * self.equation.damping_of(lanes.cell) * lanes.v

    def _finish(self, lanes: TiedLanes, at: Array, outcome: Array) -> TiedLanes:
        """Store the results of the lanes `at`; outcome: of all lanes. Returns the other
        lanes.
        """
        if not at.size:
            return lanes
        cell, found = lanes.cell[at], self.found
        row = self.devices.row(lanes.side[at], cell)
        found.outcome[cell] = outcome[at]
        found.impacts[cell] = lanes.impacts[at]
        found.steps[cell] = lanes.steps[at]
        found.condition[cell] = np.sqrt(lanes.moments[3, at])
        known = np.isin(
            outcome[at], (Outcome.NO_UPLIFT, Outcome.ROCKED, Outcome.LEANING)
        )
        ratio = self.equation.on(lanes.side[at], cell).rotation(lanes.peak[at])
        lost = np.zeros(at.size, dtype=bool)
        if self.watch is not None:
            lost = self.watch.lost(cell)
        if self.free_fall is not None:
            lost = lost | self.free_fall.occurs[cell]
        found.theta_ratio[cell] = np.where(known & ~lost, ratio, np.nan)
        found.outcome[cell[known & lost]] = Outcome.LOST_CONTACT
        keep_yield(self.devices, lanes, at, row)
        for name in ("branch", "plastic", "farthest"):
            getattr(found, name)[..., cell] = getattr(lanes, name)[..., at]
        return lanes.take(np.delete(np.arange(lanes.cell.size), at))


def _overturned(lanes: TiedLanes) -> Array:
    """The outcome of each lane if it overturns."""
    after, before = Outcome.OVERTURNED_AFTER_IMPACT, Outcome.OVERTURNED_NO_IMPACT
    return np.where(lanes.bounced, after, before)
