"""Whole straight lines of a record on which nothing happens to bodies in the air: the
march takes them one after the other, without a search for events.

Over a line of duration h the motion has the terms c_n of y, in powers of the time over
h. With a_j = sum n (n - 1) ... (n - j + 1) |c_n|,

    h |y'| <= a_1,    h^2 |y''| <= a_2,    |y - its chord| <= a_2/8,
    |h y' - its chord| <= a_3/8

since a function leaves the chord between its ends by at most an eighth of its largest
second derivative. A line is clear if these bounds prove that y stays between its limits
and that no peak changes a result, and if the last terms show that the series holds. Any
other line goes through a round of the march.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..condition import in_tolerances, moved, slope_between
from ..equations.recurrence import Recurrence, motion_terms
from ..equations.straight_lines import (
    GROWTH,
    degrees,
    factors_for,
    growth_rate,
    last_terms,
    line_drive,
)
from ..equations.taylor import MOST_TERMS, WITHIN
from ..lanes import Arrays, Lanes, ahead
from ..observers.observer import Observer

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


class LineEnd(NamedTuple):
    """The end of a line, and the sums a_j over it, (lanes,) each."""

    y: Array  # displacement at the end
    first: Array  # h y' at the end
    speed: Array  # a_1
    acceleration: Array  # a_2
    jerk: Array  # a_3

    @classmethod
    def of(cls, terms: Array) -> Self:
        """Return the end of a line with these terms of y, (terms, lanes)."""
        # NumPy sums a single lane in another order.
        lanes = terms.shape[1]
        rows = np.repeat(terms, 2, axis=1) if lanes == 1 else terms
        factors = _FACTORS[:, : len(rows)]
        ends = np.einsum("jn,nl->jl", factors[:2], rows)[:, :lanes]
        sums = np.einsum("jn,nl->jl", factors[1:], np.abs(rows))[:, :lanes]
        return cls(*ends, *sums)


@dataclass
class LineLimits(Arrays):
    """Limits within which nothing happens to lanes; arrays are (lanes,)."""

    low: Array | float  # y below which something happens, 0 at the ground
    high: Array | float  # y above which something happens
    known: Array  # y up to which no peak changes a result; negative if every peak does

    def hold(self, y: Array, first: Array, end: LineEnd, h: Array) -> Array:
        """True where nothing happens on a line of duration h [tau] that begins at y
        with h y' = `first`.
        """
        bend, turn = 0.125 * end.acceleration, 0.125 * end.jerk
        lowest, highest = np.minimum(y, end.y) - bend, np.maximum(y, end.y) + bend
        # y stays near its chord; or it leaves a limit and does not turn back
        above = (lowest > self.low) | ((y >= self.low) & (first > 4.0 * bend))
        below = (highest < self.high) | ((y <= self.high) & (first < -4.0 * bend))
        # y' keeps its sign near its chord, or no peak is the highest
        least, most = np.minimum(first, end.first), np.maximum(first, end.first)
        no_peak = (highest < self.known) | (least > turn) | (most < -turn)
        return above & below & no_peak


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
    left: Array  # number of lines to the last one of the motion
    time: Array  # duration of the lines that are behind [tau]
    degree: Array  # degree of the series of each line
    limits: LineLimits  # limits of the lanes
    law_of: Callable[["OnLines"], Recurrence]  # returns the equation of lanes

    @cached_property
    def law(self) -> Recurrence:
        """The equation of these lanes."""
        return self.law_of(self)

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

    def __init__(self, batch: Batch, observers: Sequence[Observer] = ()) -> None:
        self.batch, self.segments = batch, batch.segments
        self.observers = observers  # which say what lines they must see
        # largest size of the last terms, over the duration of a line
        self.least = WITHIN * batch.equation.tolerance
        # last line of the motion of each cell that is tried, (cells,)
        last = np.minimum(batch.segments.last_line(batch.first), batch.shaken - 1)
        if batch.free_fall is not None:
            last = np.where(batch.free_fall.occurs, -1, last)
        self.last = last

    def groups(self, waiting: Array) -> list[Array]:
        """Return the cells, (cells,), as one group."""
        return [waiting]

    def move(self, lanes: Lanes) -> None:
        """Take lanes that are in the air over lines, in place."""
        equation = self.batch.equation
        at = self.in_the_air(lanes)
        limits = LineLimits(
            0.0, equation.on(lanes.side[at], lanes.cell[at]).limit, lanes.peak[at]
        )

        def law(some: OnLines) -> Recurrence:
            return equation.on(some.side, some.cell)

        behind = self.over(self.on_lines(lanes, at, limits, law))
        if self.batch.peaks:
            self._carry_errors(lanes, behind)
        self.put(lanes, behind)

    def in_the_air(self, lanes: Lanes) -> Array:
        """Return the indices of lanes that are in the air on a short line."""
        left = self.last[lanes.cell] - lanes.segment
        air = (left > 0) & ((lanes.y > 0.0) | (lanes.v > 0.0))
        length = self.segments.length[lanes.segment]
        return np.flatnonzero(air & (length <= _LONGEST * lanes.omega))

    def on_lines(
        self,
        lanes: Lanes,
        at: Array,
        limits: LineLimits,
        law_of: Callable[[OnLines], Recurrence],
        pull: tuple[Any, Any] = (0.0, 0.0),
    ) -> OnLines:
        """Return the lanes `at` on their lines; law_of: as of `OnLines`; pull: constant
        and stiffness of what restraints take from y'', (lanes,) each.
        """
        seg, k = self.segments, lanes.segment[at]
        amplitude, omega, v = lanes.amplitude[at], lanes.omega[at], lanes.v[at]
        y, (constant, stiffness) = lanes.y[at], pull
        rate = growth_rate(stiffness)
        size = 2.0 + amplitude * (np.abs(seg.s_start[k]) + np.abs(seg.slope[k]) * omega)
        size += rate / GROWTH * np.abs(v) + np.abs(constant + stiffness * y)
        degree = degrees(
            _ROOM * size,
            seg.length[k] / omega,
            self.batch.equation.tolerance,
            rate,
        )
        return OnLines(
            lane=at,
            cell=lanes.cell[at],
            side=lanes.side[at],
            amplitude=amplitude,
            omega=omega,
            segment=k,
            phase=lanes.phase[at],
            y=y,
            v=v,
            left=self.last[lanes.cell[at]] - k,
            time=np.zeros(at.size),
            degree=degree,
            limits=limits,
            law_of=law_of,
        )

    def over(self, some: OnLines) -> OnLines:
        """Return lanes after the lines that are clear, those that have some behind
        them.
        """
        behind: OnLines = ahead(some, self._line, _LINES)
        return behind

    def _line(self, some: OnLines, going: Array) -> Array:
        """Take those `going` to the ends of their lines, where these are clear; returns
        True for lanes that may go on.
        """
        h = (self.segments.length[some.segment] - some.phase) / some.omega
        drive = line_drive(self.segments, some, h)
        factors = h * h * some.factors
        terms = motion_terms(
            some.law, some.y, some.v, h, factors, drive.terms, drive.weight
        )
        end = LineEnd.of(terms)
        clear = some.limits.hold(some.y, terms[1], end, h)
        clear &= last_terms(terms, some.last, h) <= self.least * h
        clear &= going
        if self.observers:
            highest = np.maximum(some.y, end.y) + 0.125 * end.acceleration
            fastest = np.maximum(np.abs(terms[1]), np.abs(end.first)) + 0.125 * end.jerk
            bounds = highest, fastest / h, end.acceleration / (h * h)
            lightest = 1.0
            if drive.weight is not None:
                start, gain = drive.weight.array[:, : h.size]
                lightest = np.minimum(start, start + gain)
            for one in self.observers:
                clear &= ~one.needs(some.side, some.cell, *bounds, lightest)
        np.copyto(some.y, end.y, where=clear)
        np.copyto(some.v, end.first / h, where=clear)
        some.time += h * clear
        some.segment += clear
        some.left -= clear
        some.phase[clear] = 0.0
        return clear & (some.left > 0)

    def _carry_errors(self, lanes: Lanes, behind: OnLines) -> None:
        """Carry the moments of the errors over the lines."""
        at, h = behind.lane, behind.time
        equation = self.batch.equation.on(lanes.side[at], lanes.cell[at])
        error = in_tolerances(self.least * h, equation.error_unit)
        ends = (lanes.y[at], lanes.v[at]), (behind.y, behind.v)
        slope = slope_between(equation, *ends, h)
        moments = lanes.moments[:3, at]
        lanes.moments[:3, at] = moved(moments, h, slope, equation.damping, error)

    @staticmethod
    def put(lanes: Lanes, behind: OnLines) -> None:
        """Put lanes where their lines have ended."""
        at = behind.lane
        lanes.segment[at], lanes.phase[at] = behind.segment, 0.0
        lanes.y[at], lanes.v[at], lanes.force[at] = behind.y, behind.v, np.nan
