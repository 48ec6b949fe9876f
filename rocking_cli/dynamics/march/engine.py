"""The march: cells (A, Omega) under one motion, advanced arc by arc in a pool of
lanes. Lanes that finish hand in their result and new cells take their places. It skips
cells that never leave the ground, times of rest, and lanes whose outcome is proved.
"""

import ctypes
import sys
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Array
from ..batch import Batch, cannot_return
from ..condition import lifted_at_once, rows, through_impact
from ..contacts.sequences import STILL, sequence_ends
from ..drive import place
from ..equations.straight_lines import weight_series
from ..equations.taylor import TaylorSeries
from ..lanes import Lanes
from ..observers.observer import Arcs, Observer
from ..outcome import FALLEN, Outcome, Work
from .carried import carry_errors, carry_free_peaks
from .one_turn import StepResult, advance
from .proofs import LaneProof, Proved, proofs_of

if TYPE_CHECKING:
    from .over_samples import OverSamples
    from .whole_lines import WholeLines

# lanes that are advanced together: fewer rounds against arrays that no longer fit the
# caches; more lanes where an arc has few numbers
_POOL, _LARGE_POOL = 4096, 16384

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


def ahead_of(
    batch: Batch, observers: Sequence[Observer]
) -> "OverSamples | WholeLines | None":
    """Return what takes lanes of a batch ahead in the air, None under a motion without
    straight lines.
    """
    if not batch.segments.straight:
        return None
    if batch.equation.bounded and batch.segments.of_samples and not observers:
        from .over_samples import OverSamples

        return OverSamples(batch)
    from .whole_lines import WholeLines

    return WholeLines(batch, observers)


class Run:
    """The march of a batch: the lanes in the pool, and the results so far."""

    def __init__(
        self, batch: Batch, pool: int | None = None, observers: Sequence[Observer] = ()
    ) -> None:
        keep_freed_memory()
        self.batch = batch
        # True for exact flows; observers see series
        self.exact = not observers and batch.equation.has_exact_flow(batch.segments)
        few = batch.segments.straight or self.exact
        self.pool = pool or (_LARGE_POOL if few else _POOL)
        self.observers = list(observers)  # objects that see the motion of the lanes
        self.proofs, self.after_rest = proofs_of(batch, bool(observers))
        # takes lanes in the air over lines of a record
        self.ahead = ahead_of(batch, observers)
        # results so far, as in `Response`, (cells,)
        self.theta_ratio = np.full(batch.size, 0.0 if batch.peaks else np.nan)
        self.outcome = np.full(batch.size, Outcome.NO_UPLIFT, dtype=np.uint8)
        self.impacts = np.zeros(batch.size, dtype=np.int32)
        self.condition = np.full(batch.size, np.nan)
        # True for damped cells after an impact on still ground, (cells,)
        self.bounced = np.zeros(batch.size, dtype=bool)
        self.work = Work()
        # a body that leans on its wall loses the ground too
        if batch.free_fall is not None:
            self._lose_contact(np.flatnonzero(batch.free_fall.occurs))

    def all(self, cells: Array | None = None) -> None:
        """Run every cell, or these cells, to its end, once."""
        batch = self.batch
        lifts = (
            batch.contact.strongest(batch.cells.amplitude, batch.segments, batch.first)
            > 1.0
        )
        every = np.arange(batch.size) if cells is None else cells
        waiting = every[lifts[every]]
        self.work.cells += every.size
        self.work.no_uplift += every.size - waiting.size
        # Under a record cells with about the same time between samples go together.
        # Else bodies that are hardly lifted, and may bounce for long, begin first: so
        # the last rounds have few lanes.
        order = (
            -batch.cells.omega[0, waiting]
            if batch.segments.straight
            else batch.cells.amplitude[:, waiting].max(axis=0)
        )
        waiting = waiting[np.argsort(order, kind="stable")]
        with np.errstate(all="ignore"):
            for some in [waiting] if self.ahead is None else self.ahead.groups(waiting):
                self._march(some)

    def _march(self, waiting: Array) -> None:
        """March these cells, (cells,) indices, to their end."""
        lanes = self._begin(waiting[:0])
        while waiting.size or lanes.cell.size:
            room = self.pool - lanes.cell.size
            if waiting.size and 4 * room >= self.pool:
                lanes = lanes.join(self._begin(waiting[:room]))
                waiting = waiting[room:]
            lanes = self.round(lanes)

    def _begin(self, cell: Array) -> Lanes:
        """Return lanes for these cells at their first uplift, without those that the
        ground has fallen away from before, or that the very end of the motion lifts.
        """
        lanes = self.end_free_fall(self.start(cell))
        return self._at_uplift(lanes, np.arange(lanes.cell.size))

    def _at_uplift(self, lanes: Lanes, at: Array) -> Lanes:
        """Place the lanes `at`, which are at an uplift, inside their segments; finish
        those that nothing lifts any more. Returns the other lanes.
        """
        seg = self.batch.segments
        k, u = place(seg, lanes.segment[at], lanes.phase[at])
        lanes.segment[at], lanes.phase[at] = k, u
        settled = at[k >= len(seg)]
        self.finish(lanes, settled, Outcome.ROCKED, lanes.peak[settled])
        return lanes.take(np.delete(np.arange(lanes.cell.size), settled))

    def start(self, cell: Array) -> Lanes:
        """Return lanes for these cells, at their first uplift from rest; the segment is
        the number of segments if there is no uplift.
        """
        batch, size = self.batch, cell.size
        first = batch.contact.uplift(
            batch.cells, batch.segments, cell, batch.first[cell], np.zeros(size)
        )
        return Lanes.at_rest(
            batch.cells,
            cell,
            first.side,
            segment=first.segment,
            phase=first.phase,
            force=first.force,
            peak=np.full(size, 0.0 if batch.peaks else np.inf),  # none exceeds infinity
        )

    def round(self, lanes: Lanes) -> Lanes:
        """Take one step of every lane; returns the lanes that go on, in any order."""
        batch, seg = self.batch, self.batch.segments
        if self.ahead is not None:
            self.ahead.move(lanes)
        lanes.steps += 1
        until = np.inf if batch.free_fall is None else batch.free_fall.time_left(lanes)
        equation = batch.equation.on(lanes.side, lanes.cell)
        if self.exact:
            from .exact import advance_exactly

            step = advance_exactly(seg, lanes, until, batch.peaks)
        else:
            step = advance(seg, lanes, equation, until, batch.peaks)
        self.work.impacts += int(np.count_nonzero(step.hit))
        self.work.steps += step.hit.size

        # A body that rounding alone lifts, at an extreme of the drive, does not move.
        still = (lanes.y == 0.0) & (lanes.v == 0.0) & ~np.isfinite(step.reach)
        unmoved = lanes.take(np.flatnonzero(still))

        # The order decides: a lane that fails has no other end, and a body that has
        # lain on its side on the way has overturned, even if it ends lower.
        known = np.isfinite(step.end.y) & np.isfinite(step.reach)
        ended = ~(known & ~np.isnan(step.top)) | (lanes.steps > batch.most_steps)
        self.finish(lanes, np.flatnonzero(ended & ~still), Outcome.FAILED, np.nan)
        ended |= still
        fallen = np.flatnonzero((step.top >= equation.limit) & ~ended)
        if fallen.size:
            # raises if a drive could bring them back
            some = lanes.take(fallen)
            some.y, some.v = step.top[fallen], np.zeros(fallen.size)
            cannot_return(seg, batch.equation, some)
        self.overturn(lanes, fallen)
        ended[fallen] = True
        if batch.peaks:
            carry_errors(batch, lanes, step, equation)
        np.maximum(lanes.peak, step.top, out=lanes.peak)
        if self.observers:
            self._show(lanes, step, ~ended)

        landed = np.flatnonzero(step.hit & ~ended)
        some = lanes.take(landed)
        air = np.flatnonzero(~(ended | step.hit))
        self._into_the_air(lanes, step)
        going = [self._in_the_air(lanes.take(air))]
        if landed.size:
            at = step.reach[landed], step.impact_v[landed], step.impact_force[landed]
            going.append(self._after_impact(some, *at))
        if unmoved.cell.size:
            k = np.minimum(unmoved.segment + 1, len(seg))
            every = np.arange(k.size)
            going.append(self._to_uplift(unmoved, every, k, np.zeros(k.size)))
        return self.end_free_fall(Lanes.joined(going))

    def _show(self, lanes: Lanes, step: StepResult, wanted: Array) -> None:
        """Show the steps to the observers; wanted: True for lanes that are still
        open.
        """
        assert isinstance(step.arc, TaylorSeries)
        weight = weight_series(self.batch.segments, lanes, len(step.arc.terms) - 1)
        bounds = step.fastest, step.acceleration
        arcs = Arcs(lanes, step.arc, step.reach, *bounds, wanted, weight)
        for observer in self.observers:
            observer.arcs(arcs)

    def _into_the_air(self, lanes: Lanes, step: StepResult) -> None:
        """Give every lane the state at the end of its step; those that strike the
        ground are replaced.
        """
        seg, k, u = self.batch.segments, lanes.segment, lanes.phase
        u += lanes.omega * step.reach
        over = np.flatnonzero(step.whole)
        k[over], u[over] = step.segment[over], 0.0
        lanes.segment, lanes.phase = place(seg, k, u)
        lanes.y, lanes.v = step.end.y, step.end.v
        lanes.force[:] = np.nan

    def _in_the_air(self, lanes: Lanes) -> Lanes:
        """Finish lanes in the air that have ended; returns the other lanes."""
        batch = self.batch
        for proof in self.proofs:
            lanes = self._prove(proof, lanes)
        equation = batch.equation.on(lanes.side, lanes.cell)
        at = np.flatnonzero(equation.may_overturn(lanes.y, lanes.v))
        at = at[cannot_return(batch.segments, batch.equation, lanes.take(at))]
        self.overturn(lanes, at)
        return lanes.take(np.delete(np.arange(lanes.cell.size), at))

    def _after_impact(self, lanes: Lanes, h: Array, v: Array, b: Array) -> Lanes:
        """Return the lanes after impacts h [tau] from now, with velocity v <= 0 and
        force b, without those that the impact finishes.
        """
        batch, seg, before = self.batch, self.batch.segments, lanes.segment
        lanes.segment, lanes.phase = place(seg, before, lanes.phase + lanes.omega * h)
        lanes.y = np.zeros(h.size)
        omega, drag = lanes.omega, 2.0 * batch.equation.damping_of(lanes.cell)
        batch.contact.impact(batch.cells, lanes, v, b)
        lanes.force = seg.force_at_impact(
            lanes.side, lanes.amplitude, lanes.segment, lanes.phase, lanes.force
        )
        if batch.peaks:
            lanes.moments[:3] = through_impact(
                rows(lanes.moments),
                (v, b - drag * v),
                (lanes.v, lanes.force - drag * lanes.v),
                omega / lanes.omega,
            )
        lanes.impacts += lanes.segment < batch.shaken if batch.equation.damped else 1
        self._renew_forces(lanes, before)
        if batch.equation.damped:
            self.bounced[lanes.cell[lanes.segment >= batch.shaken]] = True
        for proof in self.proofs:
            lanes = self._prove(proof, lanes)
        lanes = self._rest(lanes)
        for proof in self.after_rest:
            lanes = self._prove(proof, lanes)
        return lanes

    def _rest(self, lanes: Lanes) -> Lanes:
        """Take bodies whose sequence of impacts ends in rest to their next uplift, or
        finish them.
        """
        batch = self.batch
        there = batch.contact.other_side(lanes)
        ends = sequence_ends(batch.segments, lanes, batch.equation, there)
        resting = np.flatnonzero(ends | (lanes.v < STILL))
        for observer in self.observers if resting.size else ():
            resting = resting[observer.may_rest(lanes.take(resting))]
        if not resting.size:
            return lanes
        self.work.sequences_closed += int(ends[resting].sum())
        self.work.rests_skipped += resting.size
        return self._to_uplift(
            lanes, resting, lanes.segment[resting], lanes.phase[resting]
        )

    def _to_uplift(self, lanes: Lanes, at: Array, k: Array, u: Array) -> Lanes:
        """Take the lanes `at`, which rest at (k, u), to their next uplift; finish those
        that nothing lifts any more. Returns the other lanes.
        """
        batch = self.batch
        again = batch.contact.uplift(batch.cells, batch.segments, lanes.cell[at], k, u)
        left, vv = (lanes.force[at], lanes.omega[at]), lanes.moments[2, at]
        at_once = (again.segment == lanes.segment[at]) & (again.force > 0.0)
        at_once &= again.phase == lanes.phase[at]
        lanes.segment[at], lanes.phase[at] = again.segment, again.phase
        lanes.y[at], lanes.v[at], lanes.force[at] = 0.0, 0.0, again.force
        batch.contact.turn(batch.cells, lanes, at, again.side)
        vv = lifted_at_once(vv, left, (again.force, lanes.omega[at]))
        lanes.moments[:2, at], lanes.moments[2, at] = 0.0, np.where(at_once, vv, 0.0)
        return self._at_uplift(lanes, at)

    def end_free_fall(self, lanes: Lanes) -> Lanes:
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

    def _prove(self, proof: LaneProof, lanes: Lanes) -> Lanes:
        """Finish the lanes whose outcome is proved; returns the other lanes."""
        proved = proof.proves(self.batch, lanes)
        if proved.at.size:
            ended = self._end(proof, lanes, proved)
            lanes = lanes.take(np.delete(np.arange(lanes.segment.size), ended))
        return lanes

    def _end(self, proof: LaneProof, lanes: Lanes, proved: Proved) -> Array:
        """Finish proved lanes, except those that an observer still has to see; returns
        the indices of the finished lanes.
        """
        at, outcome, peak = proved
        if proof.still and self.batch.equation.damped:
            for observer in self.observers:
                kept = observer.may_settle(lanes.take(at), self.bounced)
                at, peak = at[kept], np.asarray(peak)[kept]
        elif proof.still:
            upright = lanes.take(at[outcome == Outcome.ROCKED])
            for observer in self.observers:
                observer.free(upright)
        if proof.still and self.batch.peaks:
            carry_free_peaks(self.batch, lanes, at, np.broadcast_to(peak, at.shape))
        self.finish(lanes, at, outcome, peak)
        if proof.still and not self.batch.equation.damped:
            self.work.free_phase += at.size
        return at

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

    def _renew_forces(self, lanes: Lanes, before: Array) -> None:
        """Recompute the force of lanes that have entered a segment with a new closed
        form, from the segments `before`: the drive may jump there.
        """
        seg, k = self.batch.segments, lanes.segment
        at = np.flatnonzero((k > before) & (k < len(seg)))
        at = at[~seg.joins[k[at] - 1]]
        side, amplitude, k = lanes.side[at], lanes.amplitude[at], k[at]
        weight = seg.weight(side, amplitude, k, lanes.phase[at])
        drive = -side * amplitude * seg.s_start[k]
        lanes.force[at] = self.batch.equation.on(side, lanes.cell[at]).force(
            lanes.y[at], drive, weight
        )
