"""Whole straight lines of a record on which nothing happens to bodies in the air: the
march takes them one after the other, without a search for events.

Over a line of duration h the motion has the terms c_n of y, in powers of the time over
h. With a_j = sum n (n - 1) ... (n - j + 1) |c_n|,

    |y - its chord| <= a_2/8,    |h y' - its chord| <= a_3/8

since a function leaves the chord between its ends by at most an eighth of its largest
second derivative. A line is clear if these bounds prove that y stays above the ground
and below its limit, and that no peak is above the highest one so far, and if the last
terms show that the series holds. Any other line goes through a round of the march.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..condition import in_tolerances, moved, slope_between
from ..equations.equation import Equation
from ..equations.recurrence import motion_terms
from ..equations.taylor import (
    MOST_TERMS,
    WITHIN,
    degrees,
    factors_for,
    last_terms,
    line_drive,
)
from ..lanes import Arrays, Lanes

_LONGEST = 0.15  # duration of a line that is tried, at most [tau]
_LINES = 16  # lines in a row
# Factor of the size that gives the degree of the series: the degree for the first line
# serves all, and the last terms show if it is enough.
_ROOM = 8.0
# n (n - 1) ... (n - j + 1) for j = 0 ... 3, (j, terms)
_FACTORS = np.array(
    [
        [np.prod(n - np.arange(float(j))) for n in range(MOST_TERMS + 1)]
        for j in range(4)
    ]
)


@dataclass
class OnLines(Arrays):
    """Lanes on lines, with the names of `Lanes`. Every array is (lanes,)."""

    lane: Array  # index of the lane
    cell: Array  # index of its cell
    side: Array  # +1 or -1
    amplitude: Array  # A [-]
    omega: Array  # Omega [-]
    segment: Array  # index of the line
    phase: Array  # phase since its start [rad]
    y: Array  # displacement, in the unit of the side
    v: Array  # dy/dtau
    peak: Array  # largest y so far, infinite if none is wanted
    left: Array  # number of lines to the last one of the motion
    time: Array  # duration of the lines that are behind [tau]
    degree: Array  # degree of the series of each line

    @cached_property
    def factors(self) -> Array:
        """1/((n + 1)(n + 2)) up to the degree, as of `factors_for`."""
        return factors_for(np.ones(self.y.size), self.degree)

    @cached_property
    def last(self) -> Array:
        """Flat index of the last term, as of `last_terms`."""
        return self.degree * self.y.size + np.arange(self.y.size)


class WholeLines:
    """Takes lanes of a batch over whole lines of its records."""

    def __init__(self, batch: Batch) -> None:
        self.batch, self.segments = batch, batch.segments
        # largest size of the last terms, over the duration of a line
        self.least = WITHIN * batch.equation.tolerance
        # last line of the motion of each cell that is tried, (cells,)
        last = np.minimum(batch.segments.last_line(batch.first), batch.shaken - 1)
        if batch.free_fall is not None:
            last = np.where(batch.free_fall.occurs, -1, last)
        self.last = last

    def move(self, lanes: Lanes) -> None:
        """Take lanes that are in the air over lines, in place."""
        some, behind = self._begin(lanes), list[OnLines]()
        on = np.ones(some.y.size, dtype=bool)
        equation = self.batch.equation.on(some.side, some.cell)
        for _ in range(_LINES):
            on = self._line(equation, some, on)
            going = np.flatnonzero(on)
            if 2 * going.size < on.size:
                behind.append(some.take(np.flatnonzero(~on)))
                some, on = some.take(going), on[going]
                equation = self.batch.equation.on(some.side, some.cell)
            if not going.size:
                break
        ended = OnLines.joined([*behind, some])
        self._end(lanes, ended.take(np.flatnonzero(ended.time > 0.0)))

    def _begin(self, lanes: Lanes) -> OnLines:
        """Return the lanes that are in the air on a short line of a record."""
        seg, k = self.segments, lanes.segment
        left = self.last[lanes.cell] - k
        air = (left > 0) & ((lanes.y > 0.0) | (lanes.v > 0.0))
        at = np.flatnonzero(air & (seg.length[k] <= _LONGEST * lanes.omega))
        k, amplitude, omega, v = (
            k[at],
            lanes.amplitude[at],
            lanes.omega[at],
            lanes.v[at],
        )
        h, zero = seg.length[k] / omega, np.zeros(at.size)
        shaking = amplitude * (np.abs(seg.s_start[k]) + np.abs(seg.slope[k]) * omega)
        return OnLines(
            at,
            lanes.cell[at],
            lanes.side[at],
            amplitude,
            omega,
            k,
            lanes.phase[at],
            lanes.y[at],
            v,
            lanes.peak[at],
            left[at],
            zero,
            degrees(
                _ROOM * (2.0 + shaking + np.abs(v)), h, self.batch.equation.tolerance
            ),
        )

    def _line(self, equation: Equation, some: OnLines, going: Array) -> Array:
        """Take those `going` to the ends of their lines, where these are clear; returns
        True for lanes that may go on.
        """
        h = (self.segments.length[some.segment] - some.phase) / some.omega
        drive = line_drive(self.segments, some, h)
        terms = motion_terms(
            equation,
            some.y,
            some.v,
            h,
            h * h * some.factors,
            drive.terms,
            drive.weight,
        )
        y, v, clear = _end_if_clear(equation, some, terms)
        clear &= last_terms(terms, some.last, h) <= self.least * h
        clear &= going
        np.copyto(some.y, y, where=clear)
        np.copyto(some.v, v / h, where=clear)
        some.time += h * clear
        some.segment += clear
        some.left -= clear
        some.phase[clear] = 0.0
        return clear & (some.left > 0)

    def _end(self, lanes: Lanes, ended: OnLines) -> None:
        """Put lanes where their last line has ended."""
        at = ended.lane
        if self.batch.peaks:
            equation = self.batch.equation.on(ended.side, ended.cell)
            error = in_tolerances(self.least * ended.time, equation.stated)
            ends = (lanes.y[at], lanes.v[at]), (ended.y, ended.v)
            slope = slope_between(equation, *ends, ended.time)
            lanes.moments[:3, at] = moved(
                lanes.moments[:3, at], ended.time, slope, equation.damping, error
            )
        lanes.segment[at], lanes.phase[at] = ended.segment, 0.0
        lanes.y[at], lanes.v[at], lanes.force[at] = ended.y, ended.v, np.nan


def _end_if_clear(
    equation: Equation, some: OnLines, terms: Array
) -> tuple[Array, Array, Array]:
    """(y and h y' at the ends of lines, True where the terms prove that nothing happens
    on the way).
    """
    n, rows, y = some.y.size, terms, some.y
    if n == 1:  # NumPy sums a single lane in another order
        rows = np.repeat(terms, 2, axis=1)
    factors = _FACTORS[:, : len(rows)]
    end, end_v = np.einsum("jn,nl->jl", factors[:2], rows)[:, :n]
    bend, turn = 0.125 * np.einsum("jn,nl->jl", factors[2:], np.abs(rows))[:, :n]
    low, high = np.minimum(y, end) - bend, np.maximum(y, end) + bend

    # y stays near its chord, above the ground, or it goes outwards from the start on
    v = terms[1]
    clear = ((low > 0.0) | (v > 4.0 * bend)) & (high < equation.limit)
    # y' keeps its sign near its chord, or no peak is the highest
    inward, outward = np.maximum(v, end_v), np.minimum(v, end_v)
    clear &= (high < some.peak) | (outward > turn) | (inward < -turn)
    return end, end_v, clear
