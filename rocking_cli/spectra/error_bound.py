"""The bound of the error of a sweep: the tolerance times the condition of its cells.

The conditions of all cells that stand are counted in bins, so that units of work,
processes, clusters, resumed sweeps and shards add them up, and the median is known to
4 %.
"""

import math
import struct
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from ..arrays import Array
from ..dynamics.equations.linear import SERIES
from ..dynamics.method import Method

# bins; a smaller condition counts in the first one, a larger one in the last
_PER_DECADE, _DECADES, _LOWEST = 64, 32, -8.0
_FAR = 10.0  # times the median, above which cells are counted
# packed: the largest condition, then the number of cells in each bin that has some
_HEAD, _BIN = struct.Struct("<d"), np.dtype([("bin", "<u2"), ("count", "<u4")])


def tolerance_of(method: Method) -> float:
    """Return the tolerance in whose units a method states its errors [-]."""
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

    @classmethod
    def unpacked(cls, raw: bytes) -> Self:
        """Return the conditions that `packed` has packed. Raises ValueError if they are
        none.
        """
        many, left = divmod(len(raw) - _HEAD.size, _BIN.itemsize)
        if many < 0 or left:
            raise ValueError("its conditions are damaged")
        bins = np.frombuffer(raw, _BIN, offset=_HEAD.size)
        counts = np.zeros(_PER_DECADE * _DECADES, dtype=np.int64)
        counts[bins["bin"]] = bins["count"]
        return cls(counts, *_HEAD.unpack_from(raw))

    def packed(self) -> bytes:
        """Return the largest condition and the bins that are not empty."""
        at = np.flatnonzero(self.counts)
        bins = np.empty(at.size, _BIN)
        bins["bin"], bins["count"] = at, self.counts[at]
        return _HEAD.pack(self.largest) + bins.tobytes()

    def __add__(self, other: "Conditions") -> "Conditions":
        return Conditions(self.counts + other.counts, max(self.largest, other.largest))

    def bounds(self, tolerance: float) -> dict[str, Any]:
        """Return the bounds by the fields of `Summary`. A bound is 1 at most: no
        rotation of a body that stands is known worse.
        """
        total = np.cumsum(self.counts)
        middle = int(np.searchsorted(total, 0.5 * total[-1])) if total[-1] else 0
        median = 10.0 ** ((middle + 0.5) / _PER_DECADE + _LOWEST) if total[-1] else 0.0
        first = middle + math.ceil(_PER_DECADE * math.log10(_FAR)) + 1
        return {
            "error_bound": min(1.0, tolerance * self.largest),
            "error_bound_median": min(1.0, tolerance * min(median, self.largest)),
            "cells_above_ten_medians": int(self.counts[first:].sum()),
        }
