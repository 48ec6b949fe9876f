"""Undamped linear bodies in the air over many samples of a record at once, where
Lemma 11 proves that no impact comes, and no peak above the highest one so far.

Y'' = Y + s has one bounded solution Y, of two modes, each integrated in the direction
in which it decays: Y + Y' = -int_tau^T exp(tau - t) s dt and Y - Y' = -int_0^tau exp(t
- tau) s dt. Every motion on one side is then y = 1 + c Y + up exp(tau) + down
exp(-tau), c = -side A. So the state at any later sample costs one exponential.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..condition import in_tolerances, moved
from ..equations.linear_flow import LONGEST
from ..lanes import Arrays, Lanes, ahead

# interval between samples [tau] up to which bodies go over samples: the series of the
# weights in `bounded_response` hold, the first term left out is below 1e-17
_WIDEST, _TERMS = 0.5, 20
_NEGLIGIBLE = 1e-20  # a mode that has decayed to this share is left out
_TABLE = 1 << 22  # numbers of `bounded_response` that are kept at a time
# over 1 + A: a body that comes closer to the ground is left to the march
_CLOSE = 1e-8
# share of a time without impact that is used: its end may err by 1e-15 of `_CLOSE`
_SHARE = 1.0 - 1e-6
_TRIES = 16  # stretches in a row
_MARGIN = 1e-6  # far above rounding to single precision
_LAST_DIGIT = 1e-15  # of the motion, over the sizes of its terms


def bounded_response(samples: Array, pace: float) -> Array:
    """Return Y + i Y' at the samples s, (n,), Y the bounded solution of Y'' = Y + s;
    pace: time between samples [tau].
    """
    # near and far: weights of both ends of an interval in int exp(-t) s dt
    far, total = 0.0, -math.expm1(-pace)
    for k in range(_TERMS, -1, -1):
        far = far * -pace + (k + 1.0) / math.factorial(k + 2)
    far *= pace
    up = _mode(samples, total - far, far, pace)
    down = _mode(samples[::-1], total - far, far, pace)[::-1]
    return 0.5 * (up + down) + 0.5j * (up - down)


def _mode(samples: Array, near: float, far: float, pace: float) -> Array:
    """The integral, from each sample to the last one, of the record times one decaying
    exponential.
    """
    found = np.append(-(near * samples[:-1] + far * samples[1:]), 0.0)
    reach = 1
    while reach < samples.size and (decay := math.exp(-pace * reach)) > _NEGLIGIBLE:
        found[:-reach] += decay * found[reach:]
        reach *= 2
    return found


def least_ahead(values: Array) -> Array:
    """Return lower bounds of the values from each index k to k + 2^j, (levels,
    values), or to the last one.
    """
    rows = [(values - _MARGIN * np.abs(values).max()).astype(np.float32)]
    rows[0][:-1] = np.minimum(rows[0][:-1], rows[0][1:])
    while (reach := 1 << (len(rows) - 1)) < values.size:
        last = rows[-1]
        rows.append(last.copy())
        np.minimum(last[:-reach], last[reach:], out=rows[-1][:-reach])
    return np.array(rows)


@dataclass
class Flights(Arrays):
    """Lanes in the air, at a sample or between two. Every array is (lanes,)."""

    lane: Array  # index of the lane
    line: Array  # the line on which it is
    left: Array  # number of lines to the last one of its motion
    past: Array  # part of its line that is over
    pace: Array  # time between samples [tau]
    top: Array  # largest level of stretches of 2^level lines
    level: Array  # level of the stretch to try next
    outward: Array  # outward drive of s = 1 [-]
    row: Array  # index of line 0 in `bounded`
    y: Array  # displacement, in the unit of the side
    v: Array  # dy/dtau
    up: Array  # what y has of the growing mode
    down: Array  # what y has of the decaying mode
    peak: Array  # largest y so far, as of `Lanes`
    time: Array  # duration of the flight so far [tau]


class Trial(NamedTuple):
    """Stretches that flights may take. Every array is (lanes,)."""

    lines: Array  # number of lines
    duration: Array  # [tau]
    fall: Array  # bound of -y'' on the way
    y: Array  # displacement at the end
    v: Array  # dy/dtau there
    up: Array  # the modes there
    down: Array


class OverSamples:
    """Takes lanes of a batch over samples, one of its `groups` after the other."""

    def __init__(self, batch: Batch) -> None:
        self.batch, self.peaks = batch, batch.peaks
        segments = batch.segments
        s = np.append(segments.s_start, segments.s_end[-1])
        # bounds of the outward drive, on the right edge -s, then on the left
        both = least_ahead(-s), least_ahead(s)
        self.levels, self.lines = both[0].shape
        self.least = np.concatenate(both).ravel()
        # first and last line of the motion of each cell, and its step [rad], (cells,)
        self.first = batch.first
        self.last = segments.last_line(batch.first)
        self.step = segments.length[self.first]
        self.bounded = np.zeros(0, dtype=complex)
        # index in `bounded` of line 0 for each cell and side, (rows, cells)
        self.row = np.zeros(batch.cells.omega.shape, dtype=np.int64)

    def groups(self, waiting: Array) -> Iterator[Array]:
        """Part cells, (cells,), into groups whose tables are small, and set the tables
        for each.
        """
        # a table for each motion and frequency
        keys = self.first[waiting] + 1j * self.batch.cells.omega[:, waiting]
        tables, which = np.unique(keys, return_inverse=True)
        which = which.reshape(keys.shape)
        first = tables.real.astype(np.int64)
        size = self.batch.segments.last_line(first) + 2 - first
        part = (np.cumsum(size) // _TABLE)[which[0]]
        for n in np.unique(part).tolist():
            some = np.flatnonzero(part == n)
            mine, row = np.unique(which[:, some], return_inverse=True)
            begin = np.cumsum(size[mine]) - size[mine] - first[mine]
            self.bounded = np.concatenate(
                [self._table(first[i], tables[i].imag) for i in mine.tolist()]
            )
            self.row[:, waiting[some]] = begin[row].reshape(len(which), -1)
            yield waiting[some]

    def _table(self, first: int, omega: float) -> Array:
        """`bounded_response` of the motion that begins with segment `first`; zeros
        where its lines are too wide.
        """
        segments = self.batch.segments
        last = int(segments.last_line(np.array(first)))
        start, pace = segments.s_start[first : last + 1], segments.length[first] / omega
        samples = np.append(start, segments.s_end[last])
        if pace > _WIDEST:
            return np.zeros(samples.size, dtype=complex)
        return bounded_response(samples, float(pace))

    def move(self, lanes: Lanes) -> None:
        """Take lanes that are in the air over samples, in place."""
        self._end(lanes, ahead(self._begin(lanes), self._try, _TRIES))

    def _begin(self, lanes: Lanes) -> Flights:
        """Return the flights of lanes that are in the air."""
        pace = self.step[lanes.cell] / lanes.omega
        left = self.last[lanes.cell] - lanes.segment
        air = (left > 0) & (pace <= _WIDEST) & ((lanes.y > 0.0) | (lanes.v > 0.0))
        at = np.flatnonzero(air)
        pace, side, zero = pace[at], lanes.side[at], np.zeros(at.size)
        flights = Flights(
            lane=at,
            line=lanes.segment[at],
            left=left[at],
            past=lanes.phase[at] / (lanes.omega[at] * pace),
            pace=pace,
            top=np.minimum(np.frexp(LONGEST / pace)[1] - 1, self.levels - 1),
            level=zero,
            outward=-side * lanes.amplitude[at],
            row=self.row[self.batch.cells.row(side), lanes.cell[at]],
            y=lanes.y[at],
            v=lanes.v[at],
            up=zero,
            down=zero,
            peak=lanes.peak[at],
            time=zero.copy(),
        )
        self._start(flights)
        return flights

    def _start(self, flights: Flights) -> None:
        """Set the modes of flights, and the level of the stretch to try first."""
        y, v, outward, line = flights.y, flights.v, flights.outward, flights.line
        h, s = flights.past * flights.pace, self.batch.segments.s_start[line]
        slope = (self.batch.segments.s_end[line] - s) / flights.pace

        # The bounded solution inside a line, as that of Y'' = Y + s.
        here = self.bounded[flights.row + line]
        from_s, rate = here.real + s, here.imag + slope
        cosh, sinh = np.cosh(h), np.sinh(h)
        from_y = y - 1.0 - outward * (from_s * cosh + rate * sinh - s - slope * h)
        from_v = v - outward * (from_s * sinh + rate * cosh - slope)
        flights.up, flights.down = 0.5 * (from_y + from_v), 0.5 * (from_y - from_v)

        # Half of the way to the ground under a still drive, or a few samples.
        force = y - 1.0 + outward * (s + slope * h)
        fall = (v + np.sqrt(v * v - 2.0 * force * y)) / -force
        level = np.frexp(np.where(fall > 0.0, 0.5 * fall / flights.pace, 8.0))[1]
        flights.level = np.clip(level, 0, flights.top)

    def _least(self, flights: Flights, outward: Array) -> Array:
        """Lower bound of a drive over stretches of the level of the flights; outward:
        the drive of s = 1 [-].
        """
        side = np.where(outward < 0.0, 0, self.levels) + flights.level
        return np.abs(outward) * self.least.take(side * self.lines + flights.line)

    def _try(self, flights: Flights, going: Array) -> Array:
        """Take those `going` over one stretch, if that is proved; returns True for
        flights that can go on.
        """
        trial, on = self._trial(flights)
        on &= going
        level = np.minimum(np.frexp(trial.lines)[1], flights.top)
        taken = on.copy()
        if self.peaks:  # flights in which a peak may hide go half as far
            at = np.flatnonzero(on)
            halved = at[self._hides(flights, trial, at)]
            taken[halved], half = False, trial.lines[halved] // 2
            on[halved] = half > 0
            level[halved] = np.frexp(np.maximum(half, 1))[1] - 1
        for name in ("y", "v", "up", "down"):
            np.copyto(getattr(flights, name), getattr(trial, name), where=taken)
        count = trial.lines * taken
        flights.line += count
        flights.left -= count
        flights.time += trial.duration * taken
        np.copyto(flights.past, 0.0, where=taken)
        np.maximum(flights.peak, trial.y, out=flights.peak, where=taken)
        flights.level = level
        # Beyond this nothing brings the body back (Lemma 6).
        most = 1.0 + np.abs(flights.outward) * self.batch.segments.largest
        return on & (flights.left > 0) & (flights.y + flights.v <= most)

    def _trial(self, flights: Flights) -> tuple[Trial, Array]:
        """(stretches that end before the first possible impact (Lemma 11), True where
        there is one).
        """
        least = self._least(flights, flights.outward)
        free, fall = horizon(flights.y, flights.v, least)
        most = np.minimum(np.left_shift(1, flights.level), flights.left)
        reach = np.fmin(flights.past + free * (_SHARE / flights.pace), most)
        on = reach >= 1.0
        count = np.where(on, reach, 1.0).astype(np.int64)
        duration = (count - flights.past) * flights.pace
        grown = np.exp(duration)
        up, down = flights.up * grown, flights.down / grown
        there = self.bounded.take(flights.row + flights.line + count)
        y = flights.outward * there.real + (up + down) + 1.0
        v = flights.outward * there.imag + (up - down)
        on &= y >= _CLOSE * (1.0 + np.abs(flights.outward))
        return Trial(count, duration, fall, y, v, up, down), on

    def _hides(self, flights: Flights, trial: Trial, at: Array) -> Array:
        """True where a peak above the highest one so far may hide in the trials `at`
        (Lemma 11).
        """
        y, end, half = flights.y[at], trial.y[at], 0.5 * trial.duration[at]
        highest = np.maximum(y, end) + 0.5 * trial.fall[at] * half * half
        hides = highest > np.maximum(flights.peak[at], end)
        some = np.flatnonzero(hides)
        if some.size:
            at, y, end, half = at[some], y[some], end[some], half[some]
            own = flights.take(at)
            most = -self._least(own, -own.outward) - 1.0
            rises = trial.v[at] >= np.maximum(end + most, 0.0) * half
            falls = -own.v >= np.maximum(y + most, 0.0) * half
            hides[some] = ~(rises | falls)
        return hides

    def _end(self, lanes: Lanes, flights: Flights) -> None:
        """Put lanes where their flights have ended."""
        at = flights.lane
        if self.peaks:
            size = 1.0 + np.abs(flights.outward) + lanes.y[at]
            stated = self.batch.equation.error_unit
            error = in_tolerances(2.0 * _LAST_DIGIT * size, stated)
            # the error at the start, then it grows on the way
            begun = moved(lanes.moments[:3, at], 0.0 * error, 1.0, 0.0, error)
            lanes.moments[:3, at] = moved(begun, flights.time, 1.0, 0.0, error)
        lanes.segment[at], lanes.phase[at] = flights.line, 0.0
        lanes.y[at], lanes.v[at], lanes.force[at] = flights.y, flights.v, np.nan


def horizon(y: Array, v: Array, least: Array) -> tuple[Array, Array]:
    """(time [tau] for which y + v sinh h + (y - 1 + least)(cosh h - 1) stays positive,
    1 - least); least: bound of the outward drive.
    """
    fall = 1.0 - least
    q = y - fall
    grows = q + v
    root = np.sqrt(fall * fall - (q - v) * grows) + fall
    root /= -grows  # exp of the time
    never = np.flatnonzero((grows >= 0.0) & ~(root > 1.0))
    time = np.log(np.maximum(root, 1.0))
    time[never] = np.inf
    return time, fall
