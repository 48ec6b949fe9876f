"""Bounds of the outward drive over stretches of a record."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.blocks import largest

Array = np.ndarray

SLACK = 1e-6  # part of the peak by which each bound lies below what it bounds: far above the rounding to single precision
_FINE = 3  # stretches of 2^k samples begin at every sample up to this k, at every 2^(k - 3)rd beyond


class Stretches(NamedTuple):
    """Bounds over stretches: that of level k from sample n covers the samples n ... n + 2^k, as far as there are any.

    low: (2 sides x stretches,), 40 bytes a sample; start, shift: (levels,); face: entries of one side: 0 is the right edge, this the left.
    """

    low: Array
    start: Array
    shift: Array
    face: int

    @property
    def levels(self) -> int:
        """Number of levels."""
        return self.start.size

    def at(self, face: Array, level: Array, n: Array) -> Array:
        """Lower bound of the outward drive of A = 1 over the stretch."""
        return self.low.take(face + self.start.take(level) + (n >> self.shift.take(level)))


def stretches(samples: Array, levels: int) -> Stretches:
    """The bounds of samples s (n,), for stretches of 1, 2, 4 ... 2^(levels - 1) intervals; on the right edge the outward drive is -s."""
    last = samples.size - 1
    slack = SLACK * largest(samples)
    shift = np.maximum(0, np.arange(levels, dtype=np.int64) - _FINE)
    sizes = last // (1 << shift) + 1
    start = np.cumsum(sizes) - sizes
    low = np.empty((2, int(sizes.sum())), dtype=np.float32)
    for side, outward in zip(low, (-samples, samples), strict=True):
        least = (outward - slack).astype(np.float32)
        for level in range(levels):
            reach = 1 << max(level - 1, 0)  # from the front: what comes later has not changed yet
            least[:-reach] = np.minimum(least[:-reach], least[reach:])
            side[start[level] : start[level] + sizes[level]] = np.minimum.reduceat(least, np.arange(0, last + 1, 1 << int(shift[level])))
    return Stretches(low.ravel(), start, shift, low.shape[1])
