"""Exact propagation of the undamped linear oscillator over many samples of a record,
where Lemma 11 proves that no impact occurs.

Y'' = Y + s has one bounded solution Y, of two modes, each integrated in the direction
in which it decays: Y + Y' = -int_tau^T exp(tau - t) s dt and Y - Y' = -int_0^tau exp(t
- tau) s dt. Every motion on one side is then y = 1 + c Y + up exp(tau) + down
exp(-tau), c = -side A. So the state at any later sample costs two exponentials.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...motions.blocks import largest
from ...motions.segments import Samples
from ..condition import moved as along_arcs
from ..lanes import Array
from ..march.engine import Run
from ..observers.observer import Propagation
from .stepper import PooledLanes, SampleStepper

LANES = 65536  # lanes: fewer rounds outweigh arrays that no longer fit any cache
_TABLES = 1 << 25  # bytes of tables at a time
# over 1 + A: below this displacement the march goes on, since a propagation errs by
# 1e-15
_LEAST = 1e-8
# largest number of propagations in a row; then the waiting lanes get their round of the
# march
_ROUNDS = 16
_FEW = 2  # propagations stop when fewer than one in so many lanes goes on
# share of a horizon that is used: y at the end of a propagation may err by 1e-15 of
# 1e-8
_SAFE_SHARE = 1.0 - 1e-6
# terms of the series of the weights: the first one left out is below 1e-17 up to
# `stepper.LONGEST`
_TERMS = 20
# tau: its exp stays below 3e10, so that growth cannot bury the state in rounding
LONGEST_STRETCH = 24.0
_NEGLIGIBLE = 1e-20  # a mode that has decayed to this share is left out
# part of the peak by which each bound lies below what it bounds: far above the rounding
# to single precision
BOUND_MARGIN = 1e-6
# stretches of 2^k samples begin at every sample up to this k, at every 2^(k - 3)rd
# beyond
_FINE = 3


def bounded_response(samples: Array, pace: Array) -> Array:
    """Return Y + i Y' at the samples, Y the bounded solution of Y'' = Y + s, (paces,
    samples). pace: time between samples [tau], (paces,), at most `stepper.LONGEST`.
    """
    total = -np.expm1(-pace)  # int_0^h exp(-t) dt
    far = np.zeros_like(pace)  # int_0^h exp(-t) t/h dt
    for k in range(_TERMS, -1, -1):
        far = far * -pace + (k + 1.0) / math.factorial(k + 2)
    far *= pace
    near = total - far
    # over 1, 2, 4 ... samples
    decays = np.exp(-pace[:, None] * 2.0 ** np.arange((samples.size - 1).bit_length()))
    result = np.empty((pace.size, samples.size), dtype=complex)
    for row, *weights, decay in zip(
        result, near.tolist(), far.tolist(), decays, strict=True
    ):
        decays = decay[decay >= _NEGLIGIBLE].tolist()
        up = _mode(samples, weights, decays)
        down = _mode(samples[::-1], weights, decays)[::-1]
        row.real, row.imag = 0.5 * (up + down), 0.5 * (up - down)
    return result


def _mode(samples: Array, weights: Sequence[float], decays: Sequence[float]) -> Array:
    """The integral, from each sample to the last one, of the record times one
    exponential mode of the linear equation.
    """
    near, far = weights
    total = np.append(-(near * samples[:-1] + far * samples[1:]), 0.0)
    for level, decay in enumerate(decays):
        reach = 1 << level
        total[:-reach] += decay * total[reach:]
    return total


class Stretches(NamedTuple):
    """Lower bounds of the outward drive of A = 1 over stretches: the stretch of level k
    from sample n covers the samples n ... n + 2^k, up to the last one. They take 40
    bytes for each sample.
    """

    # the bounds [-], (motions x 2 sides x stretches,); the right edge comes first
    low: Array
    start: Array  # index of the first entry of each level on a side, (levels,)
    shift: Array  # a level has an entry for every 2^shift samples, (levels,)
    side_size: int  # number of entries of one side of a motion

    def at(self, begin: Array, level: Array, n: Array) -> Array:
        """Lower bound of the outward drive of A = 1 over the stretches of these levels
        from these samples. begin: index at which the entries of the motion and the side
        begin.
        """
        return self.low.take(
            begin + self.start.take(level) + (n >> self.shift.take(level))
        )


def stretches(motions: Sequence[Array], levels: int) -> Stretches:
    """Build `Stretches` from the samples s (n,) of motions, for stretches of 1, 2, 4
    ... 2^(levels - 1) intervals. On the right edge the outward drive is -s. Every
    motion takes as much room as the longest one.
    """
    shift = np.maximum(0, np.arange(levels, dtype=np.int64) - _FINE)
    sizes = (max(samples.size for samples in motions) - 1) // (1 << shift) + 1
    start = np.cumsum(sizes) - sizes
    low = np.empty((len(motions), 2, int(sizes.sum())), dtype=np.float32)
    for own, samples in zip(low, motions, strict=True):
        last, margin = samples.size - 1, BOUND_MARGIN * largest(samples)
        for side, outward in zip(own, (-samples, samples), strict=True):
            least = (outward - margin).astype(np.float32)
            for level in range(levels):
                # From the front: entries that come later still hold the level before.
                reach = 1 << max(level - 1, 0)
                least[:-reach] = np.minimum(least[:-reach], least[reach:])
                found = np.minimum.reduceat(
                    least, np.arange(0, last + 1, 1 << int(shift[level]))
                )
                side[start[level] : start[level] + found.size] = found
    return Stretches(low.ravel(), start, shift, low.shape[2])


@dataclass
class ExactLanes(PooledLanes):
    """Lanes with their modes. Every array is (lanes,)."""

    # coefficient of exp(tau) in y, tau from the first sample that is not before u
    up: Array
    down: Array  # coefficient of exp(-tau) in y, with the same tau
    row: Array  # index at which the table for the lane's pace begins
    level: Array  # level of the stretch to try next


class Course(NamedTuple):
    """What stays the same while lanes are propagated. Every array is (lanes,)."""

    first: Array  # index of the first sample of the motion
    last: Array  # index of its last sample
    begin: Array  # index at which the `Stretches` of the motion and the side begin
    per_step: Array  # 1 over the phase between two samples [1/rad]
    top: Array  # largest level of `Stretches` over which the lane is propagated


class AtSample(NamedTuple):
    """The state of lanes at a sample. Every array is (lanes,)."""

    segment: Array  # index of the sample
    y: Array  # displacement, in the unit of the side
    v: Array  # dy/dtau
    up: Array  # coefficient of exp(tau) in y, tau from this sample
    down: Array  # coefficient of exp(-tau) in y


class ExactStepper(SampleStepper[ExactLanes]):
    """Advances the cells of a `Run` of the undamped linear oscillator over many samples
    of a record at once.
    """

    def __init__(self, run: Run, samples: Sequence[Samples]) -> None:
        super().__init__(run, samples)
        self.sizes = np.array([one.size for one in self.values])
        self.stretches = stretches(
            self.values, 1 + math.ceil(math.log2(self.sizes.max() - 1))
        )
        # index at which the `Stretches` of the motion of each cell begin, (cells,)
        self.begin = 2 * self.stretches.side_size * self.motion
        self.rows = np.zeros(self.cells.omega.shape, dtype=np.int64)

    def shares(self, waiting: Array) -> Iterator[Array]:
        """Groups the cells so that each group has few motions and frequencies, whose
        tables are small.
        """
        pairs = self.motion[waiting] + 1j * (
            self.step[waiting] / self.cells.omega[:, waiting]
        )
        tables, which = np.unique(pairs, return_inverse=True)
        motion, which = tables.real.astype(np.int64), which.reshape(-1, waiting.size)
        order = np.argsort(which[0], kind="stable")
        begin = np.cumsum(self.sizes[motion]) - self.sizes[motion]
        for some in _cut(order, begin[which[0][order]], _TABLES // (16 * len(which))):
            mine, row = np.unique(which[:, some], return_inverse=True)
            of = [
                (self.values[i], tables.imag[mine[motion[mine] == i]])
                for i in np.unique(motion[mine]).tolist()
            ]
            self.bounded = np.concatenate(
                [bounded_response(values, paces).ravel() for values, paces in of]
            )
            begins = np.cumsum(self.sizes[motion[mine]]) - self.sizes[motion[mine]]
            self.rows[:, waiting[some]] = (
                begins[row].reshape(len(which), -1) - self.first[waiting[some]]
            )
            yield np.sort(waiting[some])

    def prepare(self, lanes: PooledLanes) -> ExactLanes:
        found = lanes.extended(
            ExactLanes, up=lanes.y, down=lanes.y, row=lanes.segment, level=lanes.segment
        )
        self._renew_modes(found)
        return found

    def after_round(self, lanes: ExactLanes) -> None:
        super().after_round(lanes)
        self._renew_modes(lanes)

    def _renew_modes(self, lanes: ExactLanes) -> None:
        """Compute the modes of lanes at the next sample."""
        inside = lanes.phase > 0.0
        lanes.row = self.rows[self.cells.row(lanes.side), lanes.cell]
        there = self.equation.flow(self.segments, lanes).at(
            (lanes.pace - lanes.phase / lanes.omega) * inside
        )
        bounded = self.bounded.take(
            lanes.row + np.minimum(lanes.segment + inside, self.last.take(lanes.cell))
        )
        y = there.y - 1.0 - lanes.outward * bounded.real
        v = there.v - lanes.outward * bounded.imag
        lanes.up, lanes.down = 0.5 * (y + v), 0.5 * (y - v)
        fall = (
            lanes.v + np.sqrt(lanes.v * lanes.v - 2.0 * lanes.force * lanes.y)
        ) / -lanes.force
        level = np.frexp(np.where(fall > 0.0, 0.5 * fall / lanes.pace, 8.0))[1]
        lanes.level = np.clip(level, 0, self._top(lanes.pace)).astype(np.int64)

    def _top(self, pace: Array) -> Array:
        """The largest level of `Stretches` (2^level samples) over which lanes of this
        pace are propagated.
        """
        return np.minimum(
            np.frexp(LONGEST_STRETCH / pace)[1] - 1, self.stretches.start.size - 1
        ).astype(np.int64)

    def can_propagate(self, lanes: ExactLanes) -> Array:
        ahead = self.step.take(lanes.cell) - lanes.phase
        return (lanes.segment < self.last.take(lanes.cell)) & (
            (lanes.y > 0.0) | (2.0 * lanes.v * lanes.omega >= -lanes.force * ahead)
        )

    def propagate(self, lanes: ExactLanes, at: Array) -> Array:
        """Propagate lanes several times. A lane stops when a propagation is not
        proved.
        """
        own, go = lanes.take(at), np.ones(at.size, dtype=bool)
        course, total = self._course(own), np.zeros(at.size)  # time on the way [tau]
        for _ in range(_ROUNDS):
            # Lemma 11: whole samples that lie before the first possible impact.
            ahead, past, fall = self._ahead(own, course)
            go &= ahead >= 1.0
            count = np.where(go, ahead, 1.0).astype(np.int64)

            # The state there; one too close to the ground is not exact enough.
            there = self._state_ahead(own, course, count)
            go &= there.y >= _LEAST * (1.0 + np.abs(own.outward))

            # Lanes in which a peak or a speed may hide go half as far, or stop.
            peak = np.maximum(own.peak, there.y)
            time = (count - past) * own.pace
            step = Propagation(there.y, there.v, peak, fall, time)
            held = self._doubtful(own, step, go)
            moved = go.copy()
            moved[held] = False
            go[held[count[held] == 1]] = False
            level = np.minimum(np.frexp(ahead)[1], course.top)
            level[held] = np.frexp(count[held] // 2)[1] - 1

            total += np.where(moved, time, 0.0)
            self._move(own, there, peak, moved)
            own.level = np.where(go, level, own.level)
            go &= own.segment < course.last
            if np.count_nonzero(go) * _FEW < at.size:
                break
        if self.run.batch.peaks:
            own.moments[:3] = along_arcs(own.moments, total, 1.0, 0.0)
        lanes.put(at, own)
        return go

    def _course(self, own: ExactLanes) -> Course:
        """Return what stays the same while these lanes are propagated."""
        first, last, begin, per_step = (
            x.take(own.cell)
            for x in (self.first, self.last, self.begin, 1.0 / self.step)
        )
        # The right edge comes first; its outward drive is -A s.
        begin += (own.outward > 0.0) * self.stretches.side_size
        return Course(first, last, begin, per_step, self._top(own.pace))

    def _ahead(self, own: ExactLanes, course: Course) -> tuple[Array, Array, Array]:
        """(samples that lanes may go ahead without an impact (Lemma 11), samples since
        the start of their interval, largest 1 - a on the way).
        """
        stretch = self.stretches.at(course.begin, own.level, own.segment - course.first)
        time, fall = horizon(own.y, own.v, np.abs(own.outward) * stretch)
        past = own.phase * course.per_step
        ahead = np.fmin(
            past + time * (_SAFE_SHARE / own.pace),
            np.minimum(np.left_shift(1, own.level), course.last - own.segment),
        )
        return ahead, past, fall

    def _state_ahead(self, own: ExactLanes, course: Course, count: Array) -> AtSample:
        """Return the state of lanes `count` samples ahead (Lemma 11): the bounded
        solution of `bounded_response`, and what the lane has of the growing mode
        exp(tau) and of the decaying mode exp(-tau).
        """
        to = np.minimum(own.segment + count, course.last)
        # Where the phase is 0 the modes belong to this sample, else to the next.
        grown = np.exp((count - (own.phase > 0.0)) * own.pace)
        up, down = own.up * grown, own.down / grown
        bounded = self.bounded.take(own.row + to)
        return AtSample(
            to,
            own.outward * bounded.real + (up + down) + 1.0,
            own.outward * bounded.imag + (up - down),
            up,
            down,
        )

    def _move(
        self, own: ExactLanes, there: AtSample, peak: Array, moved: Array
    ) -> None:
        """Put those of the lanes that `moved` at their sample."""
        own.segment = np.where(moved, there.segment, own.segment)
        own.phase = np.where(moved, 0.0, own.phase)
        own.y = np.where(moved, there.y, own.y)
        own.v = np.where(moved, there.v, own.v)
        own.peak = np.where(moved, peak, own.peak)
        own.up = np.where(moved, there.up, own.up)
        own.down = np.where(moved, there.down, own.down)

    def _doubtful(self, lanes: ExactLanes, step: Propagation, proved: Array) -> Array:
        """Indices of lanes whose propagation may hold a peak above their highest one
        (Lemma 11); these lanes go half as far.
        """
        if not self.run.batch.peaks:
            return np.zeros(0, dtype=np.int64)
        highest = (
            np.maximum(lanes.y, step.y) + 0.125 * step.fall * step.time * step.time
        )
        high = np.flatnonzero((highest > step.peak) & proved)
        y, v, time, end_v = lanes.y[high], lanes.v[high], step.time[high], step.v[high]
        pull = self._largest_drive(lanes, high) - 1.0
        start, end = y + pull, step.y[high] + pull
        # the largest y of the stretch is at its end
        rises = end_v >= np.maximum(end, 0.0) * (0.5 * time)
        falls = -v >= np.maximum(start, 0.0) * (0.5 * time)
        top = np.where(
            (start < 0.0) & (v > 0.0),
            turn_below(y, v, start),
            np.inf,
        )
        held = high[~(rises | falls | (top <= step.peak[high]))]
        for observer in self.run.observers:
            held = np.union1d(
                held,
                observer.propagates(
                    lanes, step, proved, lambda at: self._largest_drive(lanes, at)
                ),
            )
        return held

    def _largest_drive(self, lanes: ExactLanes, at: Array) -> Array:
        """Upper bound of the outward drive of the lanes `at` over the stretch of their
        `level` from their sample on.
        """
        # The outward drive here is minus that on the other side, whose lower bound is
        # stored.
        drive, cell = lanes.outward[at], lanes.cell[at]
        begin = self.begin.take(cell) + (drive < 0.0) * self.stretches.side_size
        return -np.abs(drive) * self.stretches.at(
            begin, lanes.level[at], lanes.segment[at] - self.first.take(cell)
        )


def turn_below(y: Array, v: Array, start: Array) -> Array:
    """The y at which y'' = start + (change of y), start < 0, turns a body at y with v
    > 0 inwards; NaN if it does not.
    """
    return np.asarray(y + v * v / (-start + np.sqrt(start * start - v * v)))


def horizon(y: Array, v: Array, least: Array) -> tuple[Array, Array]:
    """(time [tau] for which y + v sinh h + (y - 1 + least)(cosh h - 1) stays positive,
    1 - least); least: bound of the outward drive.
    """
    fall = 1.0 - least
    q = y - fall
    grows = q + v
    root = fall * fall
    q -= v
    q *= grows
    root -= q
    np.sqrt(root, out=root)
    root += fall
    root /= -grows  # exp of the time
    never = np.flatnonzero((grows >= 0.0) & ~(root > 1.0))
    time = np.log(np.maximum(root, 1.0, out=root), out=root)
    time[never] = np.inf
    return time, fall


def _cut(order: Array, rows: Array, most: int) -> Iterator[Array]:
    """Cut `order`, which is sorted by rows, into parts that cover at most `most` rows
    each.
    """
    first = 0
    while first < order.size:
        stop = int(np.searchsorted(rows, rows[first] + most))
        yield order[first:stop]
        first = stop
