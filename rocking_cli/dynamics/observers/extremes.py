"""The largest value of a quantity along the motion of each cell, found to 1e-6, not
proved. Values and slopes at both ends of a short span give a cubic; the quantity is
evaluated at its peak, and the search repeats on the part that holds the peak.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ..lanes import Arrays

_CUT = 1.6  # longest span, times the rate of change of the quantity
_CUTS = 7  # largest number of evaluations inside a span, at peaks of cubics


@dataclass
class ExtremePoint(Arrays):
    """A quantity and its slope by the time at points. Every array is (spans,)."""

    value: Array  # the quantity, in its own unit
    slope: Array  # its derivative by tau


@dataclass
class TimeSpans(Arrays):
    """Intervals of time of several motions. Every array is (spans,)."""

    own: Array  # index of the motion
    low: Array  # start of the interval [tau]
    high: Array  # end of the interval [tau]
    # how fast the quantity changes at most: circular frequency of a sinusoid [1/tau]
    rate: Array


# function of (indices of motions, times)
Along = Callable[[Array, Array], ExtremePoint]


class Extremes:
    """The largest value so far of each cell, `largest`, (cells,). Parameters: start:
    the first value of each cell, (cells,).
    """

    def __init__(self, start: Array) -> None:
        self.largest = start

    def include(self, cell: Array, value: Array) -> None:
        """Raise the extremes of these cells to these values, (n,). A cell may occur
        several times; NaN leaves it unchanged.
        """
        np.fmax.at(self.largest, cell, value)

    def can_exceed(self, cell: Array, bound: Array) -> Array:
        """True where a value up to `bound` can exceed the largest value so far of these
        cells, (n,), or the bound is NaN.
        """
        return ~(bound <= self.largest[cell])

    def search(
        self,
        cell: Array,
        along: Along,
        s: TimeSpans,
        one: ExtremePoint,
        other: ExtremePoint,
    ) -> None:
        """Raise the extremes of these cells to the largest values on spans, (n,).
        along: function of (indices of motions, times) that returns the quantity; one,
        other: the quantity at the start and at the end of each span. The value found
        on a span depends neither on other spans nor on the extremes so far.
        """
        best = np.maximum(one.value, other.value)
        self.include(cell, best)
        with np.errstate(all="ignore"):
            for _ in range(_CUTS):
                # Spans on which the cubic may exceed the largest value so far.
                at = np.flatnonzero(_excess(s, one, other, self.largest[cell]) > 0.0)
                if not at.size:
                    return
                cell = cell[at]
                s = s.take(at)
                one = one.take(at)
                other = other.take(at)
                best = best[at]
                # Cut at the peak of the cubic, and go on with the part that rises to
                # it.
                x = _peak(s, one, other)
                x = np.where((x > s.low) & (x < s.high), x, 0.5 * (s.low + s.high))
                there = along(s.own, x)
                best = np.fmax(best, there.value)
                self.include(cell, best)
                rises = there.slope > 0.0
                s.low, s.high = np.where(rises, x, s.low), np.where(rises, s.high, x)
                one, other = _either(rises, there, one), _either(rises, other, there)


def parts(
    along: Along, whole: TimeSpans, start: ExtremePoint, end: ExtremePoint
) -> tuple[TimeSpans, ExtremePoint, ExtremePoint]:
    """Short parts of whole spans, and the values at their starts and ends; start,
    end: values at the ends of the whole spans.
    """
    count = np.maximum(
        np.ceil((whole.high - whole.low) * whole.rate / _CUT), 1.0
    ).astype(np.int64)
    own = np.repeat(np.arange(count.size), count)
    n = np.arange(own.size) - np.repeat(np.cumsum(count) - count, count)
    s, one, other = whole.take(own), start.take(own), end.take(own)
    inner = np.flatnonzero(n)
    if inner.size:
        x = (s.low + n * ((whole.high - whole.low) / count)[own])[inner]
        s.low[inner], s.high[inner - 1] = x, x
        there = along(s.own[inner], x)
        one.put(inner, there)
        other.put(inner - 1, there)
    return s, one, other


def _excess(
    s: TimeSpans, one: ExtremePoint, other: ExtremePoint, level: Array
) -> Array:
    """The largest value - level inside a span: an inner Bernstein coefficient of the
    cubic, plus an estimate of its error.
    """
    h = s.high - s.low
    inner = [
        x.value - level + part * h * x.slope
        for x, part in ((one, 1.0 / 3.0), (other, -1.0 / 3.0))
    ]
    size = np.maximum(np.abs(one.value), np.abs(other.value)) + np.abs(level)
    return np.maximum(*inner) + (s.rate * h) ** 4 / 384.0 * size


def _peak(s: TimeSpans, one: ExtremePoint, other: ExtremePoint) -> Array:
    """Time of the peak of the cubic; NaN or outside the span if the cubic has no
    peak in it.
    """
    h = s.high - s.low
    gain = 3.0 * (other.value - one.value)
    c1, d1 = h * one.slope, h * other.slope
    c2, c3 = gain - 2.0 * c1 - d1, c1 + d1 - gain / 1.5
    root = np.sqrt(c2 * c2 - 3.0 * c1 * c3)
    return s.low + h * np.where(c2 > 0.0, -(c2 + root) / (3.0 * c3), c1 / (root - c2))


def _either(first: Array, a: ExtremePoint, b: ExtremePoint) -> ExtremePoint:
    return ExtremePoint(
        np.where(first, a.value, b.value), np.where(first, a.slope, b.slope)
    )
