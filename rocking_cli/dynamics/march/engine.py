"""The march: cells (A, Omega, eta) under one motion, advanced arc by arc in a pool of lanes.

In each round every lane goes from its present state to the end of a window of the drive, or to its impact (`advance`).
Lanes that finish hand in their result and new cells take their places, so that a cell which chatters never holds up the
others. What is known in closed form is not marched through: cells that never leave the ground, rest, the end of a
chatter, certain overturning, the free motion after the shaking.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ...motions.segments import Segments
from ..body import Body
from ..contacts.contact import Uplift
from ..drive import place
from ..lanes import Lanes
from ..observers.observer import Arcs
from ..outcome import Outcome
from ..system import System
from .account import Work
from .advance import Passage, TurningPoints, advance, low_bounces, turning_points
from .batch import Batch, Landing
from .closings import AT_IMPACTS, conditions, impulse_bound
from .memory import keep_freed_memory

if TYPE_CHECKING:
    from ..observers.contact_loss import ContactLoss
    from ..observers.ground_forces import GroundForces
    from ..observers.observer import Observer
    from ..observers.peak_speed import PeakSpeed

Array = np.ndarray

MAX_STEPS = 120_000  # a cell that takes more, and 40 for each segment of the motion, is given up as failed
_LIKELY = 2.0  # times the push that is proved beforehand: beyond it most cells would have to be looked at afterwards
STILL = 1e-100  # a speed whose square a double does not hold is none


class Stepper(Protocol):
    """How the lanes of a run go from instant to instant. shows_arcs: whether observers see every arc; false of one that jumps."""

    shows_arcs: bool

    def march(self, waiting: Array) -> None:
        """Bring these cells, which leave the ground, to their end; (cells,) indices."""


class WindowStepper:
    """From window to window of the drive (`advance`), round by round."""

    shows_arcs = True

    def __init__(self, run: Run) -> None:
        self.run = run

    def march(self, waiting: Array) -> None:
        """Those that are hardly lifted bounce longest, so they begin."""
        run = self.run
        if waiting.size > run.pool:
            lift = run.contact.strongest(run.cells, run.segments)[waiting]
            waiting = waiting[np.argsort((255.0 - 255.0 / lift).astype(np.uint8), kind="stable")]  # of bytes it takes a pass each
        lanes, taken = run.start(waiting[:0]), 0
        with np.errstate(all="ignore"):
            while taken < waiting.size or lanes.cell.size:
                room = run.pool - lanes.cell.size
                if room > 0 and taken < waiting.size:
                    lanes = lanes.join(run.end_free_fall(run.start(waiting[taken : taken + room])))
                    taken += room
                lanes = run.round(lanes)


class Run(Batch):
    """One batch of cells on its way through the pool.

    Parameters: amplitude, omega, eta: (cells,), as `response` takes them; peaks: whether the largest rotations are wanted; pool: lanes
    advanced together; stepper: makes what advances the lanes of a run; body: whose ground forces are wanted; speed: whether the largest
    speeds are wanted; ahead: the push over the proved one above which cells are observed for lost contact on their way (`ContactLoss`),
    None for what is best. Raises ValueError when an eta does not fit the contact.
    """

    contact_loss: ContactLoss | None = None
    forces: GroundForces | None = None
    speed: PeakSpeed | None = None

    def __init__(
        self, system: System, segments: Segments, amplitude: Array, omega: Array, eta: Array, peaks: bool, pool: int, *,
        stepper: Callable[[Run], Stepper] = WindowStepper, body: Body | None = None, speed: bool = False,
        ahead: float | None = None,
    ) -> None:  # fmt: skip
        keep_freed_memory()
        super().__init__(system, segments, amplitude, omega, eta, peaks)
        self.pool, self.most_steps = pool, MAX_STEPS + 40 * len(segments)
        self.stepper = stepper(self)
        self.observers = self._chosen(system, body, speed, ahead)
        held = conditions(self)
        self.closings = [closing for closing in AT_IMPACTS if closing.needs <= held]
        self.stands = impulse_bound(self)

    def _chosen(self, system: System, body: Body | None, speed: bool, ahead: float | None) -> list[Observer]:
        """The observers that this run needs."""
        found: list[Observer] = []
        given = self.equation, self.segments, self.shaken, self.contact, self.cells
        if body is not None:
            from ..observers.ground_forces import GroundForces

            self.forces = GroundForces(body, *given, self.free_fall)
            found.append(self.forces)
        if system.body is not None:
            from ..observers.contact_loss import ContactLoss

            likely = _LIKELY if self.stepper.shows_arcs and not self.equation.bounded else np.inf
            self.contact_loss = ContactLoss(system.body, self.segments, self.contact, self.cells, likely if ahead is None else ahead)
            found += [self.contact_loss] if self.contact_loss.any else []
        if speed:
            from ..observers.peak_speed import PeakSpeed

            self.speed = PeakSpeed(self.equation, self.contact, self.shaken, self.outcome.size)
            found.append(self.speed)
        return found

    def all(self) -> None:
        """Run every cell to its end, once."""
        lifts = self.contact.strongest(self.cells, self.segments) > 1.0
        waiting = np.flatnonzero(lifts)
        if self.forces is not None:
            still = np.flatnonzero(~lifts)
            start, zero = np.zeros(still.size, dtype=np.int64), np.zeros(still.size)
            until = Uplift(start + len(self.segments), zero, zero, zero)
            self.forces.rest(still, start, zero, *self._rests_until(still, until))
        self.work += Work(no_uplift=self.outcome.size - waiting.size)
        self.stepper.march(waiting)
        del self.stepper  # it refers to the run: the memory of both would wait for the collector of cycles

    def start(self, cell: Array) -> Lanes:
        """Bodies at rest, taken to their first uplift; k is the number of segments where there is none."""
        zero, count = np.zeros(cell.size), np.zeros(cell.size, dtype=np.int32)
        first = self.contact.uplift(self.cells, self.segments, cell, np.zeros(cell.size, dtype=np.int64), zero)
        for observer in self.observers if cell.size else ():
            observer.rest(cell, np.zeros(cell.size, dtype=np.int64), zero, *self._rests_until(cell, first))
        peak = np.full(cell.size, 0.0 if self.peaks else np.inf)  # infinite: nothing that comes can matter to it
        row = self.cells.row(first.side)
        amplitude, omega, eta = (values[row, cell] for values in self.cells)
        place_and_state = (first.k, first.u, first.side, zero, zero.copy(), first.b)
        return Lanes(cell, amplitude, omega, eta, *place_and_state, peak, count, count.copy())

    def round(self, lanes: Landing) -> Landing:
        """Take one step of every lane; returns the lanes that go on."""
        seg = self.segments
        lanes.steps += 1
        equation = self.equation.on(lanes.side, lanes.cell)
        passage = advance(seg, lanes, equation, np.inf if self.free_fall is None else self.free_fall.until(lanes))
        end, hit = passage.end, passage.hit
        k, u = place(seg, passage.step.k, passage.step.u)
        bad = ~(np.isfinite(end.y) & np.isfinite(passage.reach)) | (lanes.steps > self.most_steps)
        shaken = ~hit & ~bad & (k >= len(seg))
        if self.equation.damping:
            bad, shaken = bad | shaken, np.zeros(hit.shape, dtype=bool)  # it should have settled
        foreseen = self.cannot_return(lanes, slice(None), np.minimum(k, len(seg) - 1), end.y, end.v)
        over = ~hit & ~bad & ~shaken & foreseen
        last = np.flatnonzero(shaken)
        fate = self.contact.fate(self.equation, lanes, last, end.y[last], end.v[last])
        wanted = ~(bad | over)
        wanted[last[np.isnan(fate.peak)]] = False
        found = self._turning_points(lanes, passage, wanted)
        if self.peaks:
            np.maximum.at(lanes.peak, found.lanes, found.y)  # there may be several to a lane
            limit = np.broadcast_to(equation.limit, hit.shape)[found.lanes]
            fallen = found.lanes[found.y >= limit]  # on its side, though it may be back within one step
            over[fallen] = ~bad[fallen]

        if self.observers:
            self._show(lanes, passage, np.flatnonzero(~(bad | over)))
        self.work += Work(certain_overturning=int(over.sum()), impacts=int(hit.sum()), steps=hit.size)
        self.finish(lanes, np.flatnonzero(bad), Outcome.FAILED, np.nan)
        self._meet(fate, lanes, last, end.y[last], end.v[last])
        self.overturn(lanes, np.flatnonzero(over))

        going = ~(bad | over | shaken)
        free, struck = np.flatnonzero(going & ~hit), np.flatnonzero(going & hit)
        landed = self.land(lanes.take(struck), passage.reach[struck], passage.impact_v[struck], passage.impact_b[struck])
        return self.end_free_fall(self._onward(lanes, passage, k, u, free).join(landed))

    def _show(self, lanes: Lanes, passage: Passage, wanted: Array) -> None:
        """The arcs of this round to the observers."""
        end, hit = passage.end, passage.hit
        y, v = np.where(hit, 0.0, end.y), np.where(hit, passage.impact_v, end.v)
        arcs = Arcs(lanes, passage.arc, passage.reach, y, v, np.where(hit, passage.impact_b, passage.force), wanted)
        for observer in self.observers:
            observer.arcs(arcs)

    def _rests_until(self, cell: Array, lift: Uplift) -> tuple[Array, Array]:
        """Where bodies at rest lift off, or the ground falls away from them."""
        return (lift.k, lift.u) if self.free_fall is None else self.free_fall.sooner(cell, lift)

    def _turning_points(self, lanes: Lanes, passage: Passage, wanted: Array) -> TurningPoints:
        """The turning points of those steps whose peak is wanted."""
        if not self.peaks:
            return TurningPoints(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0))
        gain = self.equation.on(lanes.side, lanes.cell).gain
        gain = gain * np.maximum(1.0, self.segments.greatest_weight(lanes.side, lanes.amplitude))
        return turning_points(self.segments, lanes, passage, wanted & ~low_bounces(lanes, passage, gain))

    def _onward(self, lanes: Landing, passage: Passage, k: Array, u: Array, at: Array) -> Landing:
        """The lanes `at`, which reached the end of their step in the air, in their new state."""
        lanes = lanes.take(at)
        lanes.k, lanes.u = k[at], u[at]
        lanes.y, lanes.v, lanes.b = passage.end.y[at], passage.end.v[at], passage.force[at]
        self._renew_drive(lanes)
        return self._settle(lanes) if self.equation.damping else lanes

    def land(self, lanes: Landing, h: Array, v: Array, b: Array, rest: Callable[[Landing], Landing] | None = None) -> Landing:
        """These lanes after impacts h [tau] from now, with velocity v <= 0 and force b; those that came to their end are gone. rest: what
        bodies whose bouncing is over do, `rest` unless given."""
        seg = self.segments
        lanes.k, lanes.u = place(seg, lanes.k, lanes.u + lanes.omega * h)
        lanes.y = np.zeros(h.size)
        self.contact.strike(self.cells, lanes, v, b)
        lanes.b = seg.force_at_impact(lanes.side, lanes.amplitude, lanes.k, lanes.u, lanes.b)
        lanes.impacts += lanes.k < self.shaken if self.equation.damping else 1
        self._renew_drive(lanes)

        over = lanes.k >= len(seg)  # the impact fell on the very end of the shaking
        last = np.flatnonzero(over)
        if last.size:
            self.end_shaking(lanes, last)
            lanes = lanes.take(np.flatnonzero(~over))
        if self.equation.damping:
            self.bounced[lanes.cell[lanes.k >= self.shaken]] = True
            lanes = self._settle(lanes)
        for closing in self.closings:
            closed = closing.closes(seg, lanes, self.equation, self.most_steps)
            if closed.any():
                self.finish(lanes, np.flatnonzero(closed), closing.outcome, lanes.peak[closed] if closing.rests else np.nan)
                self.work += Work(chatters_closed=int(closed.sum()) if closing.rests else 0)
                lanes = lanes.take(np.flatnonzero(~closed))
        lanes = (rest or self.rest)(lanes)
        if self.stands is not None:
            stands = self.stands(lanes)
            self.finish(lanes, np.flatnonzero(stands), Outcome.ROCKED, np.nan)
            lanes = lanes.take(np.flatnonzero(~stands)) if stands.any() else lanes
        return lanes

    def rest(self, lanes: Landing) -> Landing:
        """Bodies whose bouncing is over skip to their next uplift, or finish."""
        ends = self.contact.bouncing_ends(self.segments, lanes, self.equation)
        resting = np.flatnonzero(ends | (lanes.v < STILL))
        if not resting.size:
            return lanes
        again = self.contact.uplift(self.cells, self.segments, lanes.cell[resting], lanes.k[resting], lanes.u[resting])
        for observer in self.observers:
            observer.close(lanes.take(resting))
        lanes.k[resting], lanes.u[resting] = again.k, again.u
        lanes.y[resting], lanes.v[resting], lanes.b[resting] = 0.0, 0.0, again.b
        self.contact.turn(self.cells, lanes, resting, again.side)
        self.work += Work(chatters_closed=int(ends.sum()), rests_skipped=resting.size)
        settled = resting[again.k >= len(self.segments)]
        self.finish(lanes, settled, Outcome.ROCKED, lanes.peak[settled])
        return lanes.take(np.flatnonzero(lanes.k < len(self.segments)))

    def _renew_drive(self, lanes: Lanes) -> None:
        """Where a piece of the motion begins the drive may jump: take the force from the new side of the jump."""
        seg = self.segments
        at = np.flatnonzero((lanes.u == 0.0) & (lanes.k > 0) & (lanes.k < len(seg)))
        at = at[~seg.joins[lanes.k[at] - 1]]
        self.push(lanes, at)

    def push(self, lanes: Lanes, at: Array) -> None:
        """The force on the lanes `at`, which are where a segment begins."""
        seg, side, amplitude, k = self.segments, lanes.side[at], lanes.amplitude[at], lanes.k[at]
        drive = -side * amplitude * seg.s_start[k]
        weight = seg.weight(side, amplitude, k, lanes.u[at])
        lanes.b[at] = self.equation.on(side, lanes.cell[at]).force(lanes.y[at], drive, weight)
