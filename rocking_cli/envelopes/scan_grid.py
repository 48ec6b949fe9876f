"""The amplitudes of the scan at one frequency, and searches that skip amplitudes of the scan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Self, TypeVar

import numpy as np

from .changes import SECTIONS

Array = np.ndarray
Ends = TypeVar("Ends", bound=NamedTuple)  # arrays of shape (rows,)

SCAN_STEP = 0.999e-3  # in A; no interval wider than 1e-3 is missed
LONGEST_FINE = 200  # segments of a motion up to which the scan is as fine as an envelope's
COARSE = 1e-3  # ratio of neighbouring amplitudes minus 1 of the search for the lowest fall beyond that


@dataclass(frozen=True)
class ScanGrid:
    """The amplitudes of a scan: SCAN_STEP apart, and closer just above uplift, where slow pulses have many intervals.

    near: the first points one by one; after them point n is start + (n - near.size) step.
    """

    near: Array
    start: float
    step: float
    size: int

    @classmethod
    def between(cls, lowest: float, highest: float, *, uplift: float = 0.0, ratio: float = 0.0) -> Self:
        """The scan from one amplitude to another, both included. uplift: the least amplitude that lifts the body (default: the lowest);
        ratio: the ratio of neighbouring amplitudes minus 1, in place of a constant step."""
        if ratio:
            near = np.geomspace(lowest, highest, 2 + int(np.log(highest / lowest) / np.log1p(ratio)))
            near[0], near[-1] = lowest, highest
            return cls(near, highest, highest - lowest, near.size)
        count = int(np.ceil((highest - lowest) / SCAN_STEP))
        step = (highest - lowest) / count
        close = (uplift or lowest) * (1.0 + np.geomspace(1e-3, 0.1, 460))
        even = max(0, min(count, int(np.ceil((close[-1] - lowest) / step))))
        near = np.unique(np.concatenate([lowest + step * np.arange(even + 1), close[(close > lowest) & (close < highest)]]))
        return cls(near, lowest + step * (even + 1), step, near.size + count - even)

    def amplitude(self, n: Array) -> Array:
        """The amplitudes of scan points."""
        return np.where(n < self.near.size, self.near[np.minimum(n, self.near.size - 1)], self.start + self.step * (n - self.near.size))

    def below(self, amplitude: Array) -> Array:
        """The last scan point that is certainly not above each amplitude; the first point if there is none."""
        there = np.searchsorted(self.near, amplitude, side="right") - 1
        top = self.start + self.step * (self.size - self.near.size + 1)  # larger scan numbers overflow a whole number
        beyond = np.floor((np.minimum(amplitude, top) - self.start) / self.step).astype(np.int64) - 1 + self.near.size
        return np.clip(np.where(beyond >= self.near.size, beyond, there), 0, self.size - 1)


def onwards(rows: Array, first: Array, last: Array, there: Callable[[Array, Array], Array]) -> tuple[Array, Array]:
    """(rows in which a condition holds at the last scan point, the first scan point of each row at which it holds).

    there: function from scan points and rows, of shapes that broadcast, to the condition; if it holds at a point, it holds above."""
    at = np.flatnonzero(there(last, rows))
    rows, first, high = rows[at], first[at], last[at]
    low = first - 1
    while np.any(high - low > 1):
        points = low[:, None] + (high - low)[:, None] * np.arange(1, SECTIONS + 1) // SECTIONS
        points = np.maximum(points, first[:, None])
        step, row = there(points, np.broadcast_to(rows[:, None], points.shape)).argmax(axis=1), np.arange(rows.size)
        high, low = points[row, step], np.where(step > 0, points[row, step - 1], low)
    return rows, high


def gaps_between(
    row: Array,
    low: Array,
    high: Array,
    measure: Callable[[Array, Array], Ends],
    differ: Callable[[Ends, Ends, Array, Array, Array], Array],
) -> Array:
    """(gaps, 2): row and lower scan point of the gaps between `low` and `high` in which the outcome may change.

    measure: function from rows and scan points to values; differ: true if the outcome may change between two points with such values."""
    found = [np.zeros((0, 2), dtype=np.int64)]
    at = np.flatnonzero(low < high)
    row, low, high = row[at], low[at], high[at]
    one, other = measure(row, low), measure(row, high)
    while row.size:
        at = np.flatnonzero(differ(one, other, row, low, high))
        narrow = high[at] - low[at] == 1
        found.append(np.column_stack([row[at[narrow]], low[at[narrow]]]))
        at = at[~narrow]
        middle = (low[at] + high[at]) // 2
        between = measure(row[at], middle)
        one = one._make((np.concatenate([x[at], y]) for x, y in zip(one, between, strict=True)))
        other = other._make((np.concatenate([y, x[at]]) for x, y in zip(other, between, strict=True)))
        row, low, high = np.tile(row[at], 2), np.concatenate([low[at], middle]), np.concatenate([middle, high[at]])
    return np.concatenate(found)
