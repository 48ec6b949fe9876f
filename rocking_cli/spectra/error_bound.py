"""The bound of the error of a sweep: the tolerance times the condition of its cells.

The conditions of all cells that stand are counted in bins, so that units of work,
processes and clusters add them up, and the median is known to 4 %.
"""

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from ..arrays import Array
from ..dynamics.equations.linear import SERIES
from ..dynamics.method import Method

# bins; a smaller condition counts in the first one, a larger one in the last
_PER_DECADE, _DECADES, _LOWEST = 64, 32, -8.0
_FAR = 10.0  # times the median, above which cells are counted


def tolerance_of(method: Method) -> float:
    """Return the error that a method adds in every unit of tau, at most."""
    return method.stated_tolerance or SERIES


@dataclass(frozen=True)
class Conditions:
    """The conditions of cells that stand."""

    counts: Array  # number of cells in each bin
    largest: float = 0.0  # largest condition [-]; 0 without cells

    @classmethod
    def of(cls, condition: Array) -> Self:
        """Count these conditions, of any shape, without those that are NaN."""
        known = condition[np.isfinite(condition)]
        above = np.log10(np.maximum(known, 10.0**_LOWEST)) - _LOWEST
        bins = (_PER_DECADE * above).astype(np.int64)
        size = _PER_DECADE * _DECADES
        counts = np.bincount(np.minimum(bins, size - 1), minlength=size)
        return cls(counts, float(known.max(initial=0.0)))

    def __add__(self, other: "Conditions") -> "Conditions":
        return Conditions(self.counts + other.counts, max(self.largest, other.largest))

    def bounds(self, method: Method) -> dict[str, Any]:
        """Return the bounds by the fields of `Summary`. A bound is 1 at most: no
        rotation of a body that stands is known worse.
        """
        tolerance, total = tolerance_of(method), np.cumsum(self.counts)
        middle = int(np.searchsorted(total, 0.5 * total[-1])) if total[-1] else 0
        median = 10.0 ** ((middle + 0.5) / _PER_DECADE + _LOWEST) if total[-1] else 0.0
        first = middle + math.ceil(_PER_DECADE * math.log10(_FAR)) + 1
        return {
            "error_bound": min(1.0, tolerance * self.largest),
            "error_bound_median": min(1.0, tolerance * min(median, self.largest)),
            "cells_above_ten_medians": int(self.counts[first:].sum()),
        }
