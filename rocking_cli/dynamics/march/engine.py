"""The march: cells (A, Omega, eta) under one motion, advanced arc by arc in a pool of
lanes. Lanes that finish hand in their result and new cells take their places. It skips
cells that never leave the ground, times of rest, and lanes whose outcome a closing
proves.
"""

import ctypes
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
from typing import NamedTuple, TypeVar

import numpy as np

from ..batch import Batch
from ..condition import at_free_peak, moved, slope_between, through_impact
from ..contacts.sequences import STILL
from ..drive import place
from ..lanes import Array, Lanes
from ..observers.observer import Arcs, Observer
from ..outcome import FALLEN, Outcome, Work
from .advance import StepResult, advance, turning_points
from .closings import FREE_MOTION, Closed, Closing, closings_of, free_motion

AnyLanes = TypeVar("AnyLanes", bound=Lanes)

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # parameters of mallopt(3)
_BLOCK = 32 << 20  # bytes, the largest that it takes


@cache
def keep_freed_memory() -> None:
    """Make glibc keep freed blocks of up to 32 MB, 64 MB in all: page faults for the
    arrays of each round would double the time.
    """
    if sys.platform == "linux":
        with suppress(AttributeError):  # another library than glibc
            mallopt = ctypes.CDLL(None).mallopt
            mallopt(_MMAP_THRESHOLD, _BLOCK)
            mallopt(_TRIM_THRESHOLD, 2 * _BLOCK)


def by_windows(run: "Run", waiting: Array) -> None:
    """March these cells of a run, (cells,) indices, to their end, from window to window
    of the drive (`advance`).
    """
    lanes, taken = run.start(waiting[:0]), 0
    with np.errstate(all="ignore"):
        while taken < waiting.size or lanes.cell.size:
            room = run.pool - lanes.cell.size
            if room > 0 and taken < waiting.size:
                lanes = lanes.join(
                    run.end_free_fall(run.start(waiting[taken : taken + room]))
                )
                taken += room
            lanes = run.round(lanes)


class RoundEnds(NamedTuple):
    """What the steps of a round end with. Every array is (lanes,); a lane has one of
    the three ends at most.
    """

    segment: Array  # segment of the end of the step; their number after the motion
    phase: Array  # phase of the end in its segment [rad]
    failed: Array  # True if the march of the lane fails
    shaken: Array  # True if an undamped lane is in the air when the shaking ends
    over: Array  # True if the lane has overturned, or will for certain (Lemma 6)


class Run:
    """The march of a batch: the lanes in the pool, and the results so far."""

    def __init__(
        self, batch: Batch, pool: int | None = None, observers: Sequence[Observer] = ()
    ) -> None:
        keep_freed_memory()
        self.batch = batch
        self.pool = pool or batch.equation.pool  # lanes that are advanced together
        self.observers = list(observers)  # objects that see the motion of the lanes
        self.closings, self.after_rest = closings_of(batch, bool(observers))
        # results so far, as in `Response`, (cells,)
        self.theta_ratio = np.full(batch.size, 0.0 if batch.peaks else np.nan)
        self.outcome = np.full(batch.size, Outcome.NO_UPLIFT, dtype=np.uint8)
        self.impacts = np.zeros(batch.size, dtype=np.int32)
        self.condition = np.full(batch.size, np.nan)
        # True for damped cells after an impact on still ground, (cells,)
        self.bounced = np.zeros(batch.size, dtype=bool)
        self.work = Work(cells=batch.size)
        # a body that leans on its wall loses the ground too
        if batch.free_fall is not None:
            self._lose_contact(np.flatnonzero(batch.free_fall.occurs))

    def all(self, march: Callable[["Run", Array], None] = by_windows) -> None:
        """Run every cell to its end, once. march: function that runs those cells to
        their end that leave the ground.
        """
        batch = self.batch
        lifts = batch.contact.strongest(batch.cells, batch.segments, batch.first) > 1.0
        waiting, still = np.flatnonzero(lifts), np.flatnonzero(~lifts)
        self.work.no_uplift += still.size
        march(self, waiting)

    def start(self, cell: Array) -> Lanes:
        """Return lanes for these cells, at their first uplift from rest; the segment is
        the number of segments if there is no uplift.
        """
        batch, size = self.batch, cell.size
        first = batch.contact.uplift(
            batch.cells, batch.segments, cell, batch.first[cell], np.zeros(size)
        )
        row = batch.cells.row(first.side)
        amplitude, omega, eta = (values[row, cell] for values in batch.cells)
        return Lanes(
            cell=cell,
            amplitude=amplitude,
            omega=omega,
            eta=eta,
            segment=first.segment,
            phase=first.phase,
            side=first.side,
            y=np.zeros(size),
            v=np.zeros(size),
            force=first.force,
            peak=np.full(size, 0.0 if batch.peaks else np.inf),  # none exceeds infinity
            impacts=np.zeros(size, dtype=np.int32),
            steps=np.zeros(size, dtype=np.int32),
            moments=np.zeros((4, size)),
        )

    def round(self, lanes: AnyLanes) -> AnyLanes:
        """Take one step of every lane; returns the lanes that are not finished."""
        batch = self.batch
        lanes.steps += 1
        until = np.inf if batch.free_fall is None else batch.free_fall.time_left(lanes)
        equation = batch.equation.on(lanes.side, lanes.cell)
        result = advance(batch.segments, lanes, equation, until)
        self.work.impacts += int(result.hit.sum())
        self.work.steps += result.hit.size

        # Peaks come before results: a body that has lain on its side on the way has
        # overturned, even if it ends lower.
        ends = self._ends(lanes, result)
        before, slope = lanes.moments[:3], np.zeros(0)
        if batch.peaks:
            ends_y = np.where(result.hit, 0.0, result.end.y)
            ends_v = np.where(result.hit, result.impact_v, result.end.v)
            found = slope_between(
                equation, (lanes.y, lanes.v), (ends_y, ends_v), result.reach
            )
            slope = np.broadcast_to(found, result.reach.shape)
            lanes.moments = np.concatenate(
                [
                    moved(before, result.reach, slope, equation.damping),
                    lanes.moments[3:],
                ]
            )
        last = self._in_the_air(lanes, result, ends, np.flatnonzero(ends.shaken))
        free = free_motion(batch, last)
        if batch.peaks:
            self._raise_peaks(lanes, result, ends, free.outcome, before, slope)
        if self.observers:
            self._show(lanes, result, np.flatnonzero(~(ends.failed | ends.over)))

        # Store the results of the lanes that end; `_go_on` takes them out of the pool.
        self.finish(lanes, np.flatnonzero(ends.failed), Outcome.FAILED, np.nan)
        last.peak = lanes.peak[ends.shaken]
        last.moments[3] = lanes.moments[3, ends.shaken]
        peak = np.maximum(last.peak, free.peak)
        self._end(FREE_MOTION, last, free._replace(peak=peak))
        self.overturn(lanes, np.flatnonzero(ends.over))
        return self._go_on(lanes, result, ends)

    def _ends(self, lanes: Lanes, result: StepResult) -> RoundEnds:
        """Return what the steps end with. The order decides: a lane that fails has no
        other end, an impact comes before the end of the shaking, and that before
        overturning.
        """
        batch, seg = self.batch, self.batch.segments
        end, hit = result.end, result.hit
        k, u = place(seg, result.step.segment, result.step.phase)

        failed = ~(np.isfinite(end.y) & np.isfinite(result.reach))
        failed |= lanes.steps > batch.most_steps

        shaken = ~hit & ~failed & (k >= len(seg))
        if batch.equation.damping:  # a damped lane should have settled before
            failed, shaken = failed | shaken, np.zeros(hit.shape, dtype=bool)

        here = np.minimum(k, len(seg) - 1)
        cannot_return = batch.cannot_return(lanes, slice(None), here, end.y, end.v)
        over = ~hit & ~failed & ~shaken & cannot_return
        return RoundEnds(k, u, failed, shaken, over)

    def _raise_peaks(
        self,
        lanes: Lanes,
        result: StepResult,
        ends: RoundEnds,
        free: Array | Outcome,
        moments: Array,
        slope: Array,
    ) -> None:
        """Take the turning points of the steps into the peaks of the lanes. free:
        outcomes of the free motion of shaken lanes; moments, slope: of the lanes at the
        start of the steps, and df/dy on them.
        """
        # Peaks are reported for bodies that stand only.
        wanted = ~(ends.failed | ends.over)
        wanted[np.flatnonzero(ends.shaken)[free != Outcome.ROCKED]] = False
        at, h, y = turning_points(self.batch.segments, lanes, result, wanted)
        higher = y >= lanes.peak[at]
        on, h = at[higher], h[higher]
        lanes.moments[3, on] = self._of_rotation(
            lanes,
            on,
            y[higher],
            moved(moments[:, on], h, slope[on], result.arc.damping)[0],
        )
        np.maximum.at(lanes.peak, at, y)  # a lane may have several turning points
        limit = self.batch.equation.on(lanes.side, lanes.cell).limit
        fallen = at[y >= np.broadcast_to(limit, wanted.shape)[at]]
        ends.over[fallen] = ~ends.failed[fallen]

    def _of_rotation(self, lanes: Lanes, at: Array, y: Array, moment: Array) -> Array:
        """The second moment of |theta|/alpha from that of y of the lanes `at`."""
        equation = self.batch.equation.on(lanes.side[at], lanes.cell[at])
        rate: Array = equation.rotation_rate(y, np.ones(at.size))
        return rate * rate * moment

    def _show(self, lanes: Lanes, result: StepResult, wanted: Array) -> None:
        """Show the steps to the observers; wanted: indices of lanes that are still
        open.
        """
        end, hit = result.end, result.hit
        y, v = np.where(hit, 0.0, end.y), np.where(hit, result.impact_v, end.v)
        force = np.where(hit, result.impact_force, result.force)
        arcs = Arcs(lanes, result.arc, result.reach, y, v, force, wanted)
        for observer in self.observers:
            observer.arcs(arcs)

    def _go_on(self, lanes: AnyLanes, result: StepResult, ends: RoundEnds) -> AnyLanes:
        """Return the lanes after their steps that are not finished."""
        going = ~(ends.failed | ends.over | ends.shaken)
        flying = np.flatnonzero(going & ~result.hit)
        in_air = self._in_the_air(lanes, result, ends, flying)
        for closing in self.closings if self.batch.equation.damping else ():
            in_air = self._close(closing, in_air) if closing.still else in_air
        landed = np.flatnonzero(going & result.hit)
        after_impact = self._after_impact(
            lanes.take(landed),
            result.reach[landed],
            result.impact_v[landed],
            result.impact_force[landed],
        )
        return self.end_free_fall(in_air.join(after_impact))

    def _in_the_air(
        self, lanes: AnyLanes, result: StepResult, ends: RoundEnds, at: Array
    ) -> AnyLanes:
        """Return the lanes `at`, which reached the end of their step in the air, with
        their new state.
        """
        lanes = lanes.take(at)
        lanes.segment, lanes.phase = ends.segment[at], ends.phase[at]
        lanes.y, lanes.v = result.end.y[at], result.end.v[at]
        lanes.force = result.force[at]
        self._renew_forces(lanes)
        return lanes

    def _after_impact(self, lanes: AnyLanes, h: Array, v: Array, b: Array) -> AnyLanes:
        """Return the lanes after impacts h [tau] from now, with velocity v <= 0 and
        force b, without those that the impact finishes.
        """
        batch, seg = self.batch, self.batch.segments
        lanes.segment, lanes.phase = place(
            seg, lanes.segment, lanes.phase + lanes.omega * h
        )
        lanes.y = np.zeros(h.size)
        omega, drag = lanes.omega, 2.0 * batch.equation.damping
        batch.contact.impact(batch.cells, lanes, v, b)
        lanes.force = seg.force_at_impact(
            lanes.side, lanes.amplitude, lanes.segment, lanes.phase, lanes.force
        )
        if batch.peaks:
            lanes.moments[:3] = through_impact(
                (lanes.moments[0], lanes.moments[1], lanes.moments[2]),
                (v, b - drag * v),
                (lanes.v, lanes.force - drag * lanes.v),
                omega / lanes.omega,
            )
        lanes.impacts += lanes.segment < batch.shaken if batch.equation.damping else 1
        self._renew_forces(lanes)
        if batch.equation.damping:
            self.bounced[lanes.cell[lanes.segment >= batch.shaken]] = True
        for closing in self.closings:
            lanes = self._close(closing, lanes)
        lanes = self._rest(lanes)
        for closing in self.after_rest:
            lanes = self._close(closing, lanes)
        return lanes

    def _rest(self, lanes: AnyLanes) -> AnyLanes:
        """Take bodies whose sequence of impacts ends in rest to their next uplift, or
        finish them.
        """
        batch = self.batch
        ends = batch.contact.sequence_ends(batch.segments, lanes, batch.equation)
        resting = np.flatnonzero(ends | (lanes.v < STILL))
        for observer in self.observers if resting.size else ():
            resting = resting[observer.may_close(lanes.take(resting))]
        if not resting.size:
            return lanes
        again = batch.contact.uplift(
            batch.cells,
            batch.segments,
            lanes.cell[resting],
            lanes.segment[resting],
            lanes.phase[resting],
        )
        lanes.segment[resting], lanes.phase[resting] = again.segment, again.phase
        lanes.y[resting], lanes.v[resting], lanes.force[resting] = 0.0, 0.0, again.force
        lanes.moments[:3, resting] = 0.0
        batch.contact.turn(batch.cells, lanes, resting, again.side)
        self.work.sequences_closed += int(ends[resting].sum())
        self.work.rests_skipped += resting.size
        settled = resting[again.segment >= len(batch.segments)]
        self.finish(lanes, settled, Outcome.ROCKED, lanes.peak[settled])
        return lanes.take(np.flatnonzero(lanes.segment < len(batch.segments)))

    def end_free_fall(self, lanes: AnyLanes) -> AnyLanes:
        """Finish bodies from which the ground has fallen away: overturned if the
        rotation is at least `FALLEN`, otherwise lost contact.
        """
        if self.batch.free_fall is None:
            return lanes
        falls = self.batch.free_fall.has_begun(lanes)
        over = falls & (self.batch.rotation(lanes, slice(None), lanes.y) >= FALLEN)
        self.overturn(lanes, np.flatnonzero(over))
        self.finish(lanes, np.flatnonzero(falls & ~over), Outcome.LOST_CONTACT, np.nan)
        return lanes.take(np.flatnonzero(~falls))

    def end_shaking(self, lanes: Lanes) -> None:
        """Finish undamped lanes for which the shaking is over, by the outcome of their
        free motion.
        """
        self._end(FREE_MOTION, lanes, free_motion(self.batch, lanes))

    def _close(self, closing: Closing, lanes: AnyLanes) -> AnyLanes:
        """Finish the lanes that the closing closes; returns the other lanes."""
        closed = closing.closes(self.batch, lanes)
        if closed.at.size:
            ended = self._end(closing, lanes, closed)
            lanes = lanes.take(np.delete(np.arange(lanes.segment.size), ended))
        return lanes

    def _end(self, closing: Closing, lanes: Lanes, closed: Closed) -> Array:
        """Finish closed lanes, except lanes that an observer still has to see; returns
        the indices of the finished lanes.
        """
        at, outcome, peak = closed
        if closing.still and self.batch.equation.damping:
            for observer in self.observers:
                kept = observer.may_settle(lanes.take(at), self.bounced)
                at, peak = at[kept], np.asarray(peak)[kept]
        elif closing.still:
            upright = lanes.take(at[outcome == Outcome.ROCKED])
            for observer in self.observers:
                observer.free(upright)
        if closing.still and self.batch.peaks:
            self._free_peaks(lanes, at, peak)
        self.finish(lanes, at, outcome, peak)
        if closing.counts:
            setattr(
                self.work, closing.counts, getattr(self.work, closing.counts) + at.size
            )
        return at

    def _free_peaks(self, lanes: Lanes, at: Array, peak: Array | float) -> None:
        """Take the peaks of free motions into the moments of the lanes `at`."""
        batch = self.batch
        free = np.flatnonzero(np.broadcast_to(peak, at.shape) > lanes.peak[at])
        at = at[free]
        if not at.size:
            return

        def peak_of(y: Array, v: Array) -> Array:
            return batch.contact.free_motion(batch.equation, lanes, at, y, v).peak

        y, v = lanes.y[at], lanes.v[at]
        moment = at_free_peak(lanes.moments[:3, at], y, v, peak_of)
        top = np.broadcast_to(peak, free.shape) if np.ndim(peak) == 0 else peak[free]
        lanes.moments[3, at] = self._of_rotation(lanes, at, np.asarray(top), moment)

    def overturn(self, lanes: Lanes, at: Array) -> None:
        """Finish the lanes `at` as overturned."""
        bounced = (lanes.impacts[at] > 0) | self.bounced[lanes.cell[at]]
        self.finish(
            lanes,
            at,
            np.where(
                bounced, Outcome.OVERTURNED_AFTER_IMPACT, Outcome.OVERTURNED_NO_IMPACT
            ),
            np.nan,
        )
        self.work.certain_overturning += at.size

    def finish(
        self, lanes: Lanes, at: Array, outcome: Outcome | Array, peak: Array | float
    ) -> None:
        """Store the results of the lanes `at`: their outcomes, and the largest y of
        those that rocked (NaN for other outcomes).
        """
        if not at.size:
            return
        cell = lanes.cell[at]
        self.outcome[cell] = outcome
        if self.batch.peaks:
            self.theta_ratio[cell] = self.batch.rotation(lanes, at, peak)
            self.condition[cell] = np.sqrt(lanes.moments[3, at])
        rocked = cell[self.outcome[cell] == Outcome.ROCKED]
        if self.batch.free_fall is not None:
            self._lose_contact(rocked[self.batch.free_fall.occurs[rocked]])
        for observer in self.observers:
            self._lose_contact(rocked[observer.lost(rocked)])
        self.impacts[cell] = lanes.impacts[at]

    def _lose_contact(self, cell: Array) -> None:
        """Mark cells as having lost contact."""
        self.outcome[cell], self.theta_ratio[cell] = Outcome.LOST_CONTACT, np.nan

    def _renew_forces(self, lanes: Lanes) -> None:
        """Recompute the force of lanes at the start of a segment with a new closed
        form: the drive may jump there.
        """
        seg = self.batch.segments
        at = np.flatnonzero(
            (lanes.phase == 0.0) & (lanes.segment > 0) & (lanes.segment < len(seg))
        )
        self.renew_force(lanes, at[~seg.joins[lanes.segment[at] - 1]])

    def renew_force(self, lanes: Lanes, at: Array) -> None:
        """Recompute the force on the lanes `at`, which are at the start
        of a segment.
        """
        seg = self.batch.segments
        side = lanes.side[at]
        amplitude = lanes.amplitude[at]
        k = lanes.segment[at]
        weight = seg.weight(side, amplitude, k, lanes.phase[at])
        drive = -side * amplitude * seg.s_start[k]
        lanes.force[at] = self.batch.equation.on(side, lanes.cell[at]).force(
            lanes.y[at], drive, weight
        )
