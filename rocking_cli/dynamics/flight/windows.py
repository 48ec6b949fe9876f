"""Bounds of the outward drive over stretches of a record."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray

SLACK = 1e-6  # part of the peak by which each bound lies below what it bounds: far above the rounding to single precision
_FINE = 3  # stretches of 2^k samples begin at every sample up to this k, at every 2^(k - 3)rd beyond


class Windows(NamedTuple):
    """low: flat float32 bounds; `at` says which. start, shift: (levels,); face: entries of one side.

    The stretch of level k from sample n covers the samples n ... n + 2^k, as far as there are any.
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
        """Lower bound of the outward drive of A = 1 over the stretch; face: 0 on the right edge, `self.face` on the left."""
        return self.low.take(face + self.start.take(level) + (n >> self.shift.take(level)))


def windows(samples: Array, levels: int) -> Windows:
    """The bounds of samples s (n,), for stretches of 1, 2, 4 ... 2^(levels - 1) intervals; on the right edge the outward drive is -s."""
    last = samples.size - 1
    slack = SLACK * float(np.abs(samples).max())
    least = np.stack([-samples, samples])
    least -= slack
    least = least.astype(np.float32)
    least[:, :-1] = np.minimum(least[:, :-1], least[:, 1:])
    parts, shift = [], []
    for level in range(levels):
        if level:
            reach = min(1 << (level - 1), last + 1)
            least[:, : last + 1 - reach] = np.minimum(least[:, : last + 1 - reach], least[:, reach:])
        by = max(0, level - _FINE)
        shift.append(by)
        parts.append(np.minimum.reduceat(least, np.arange(0, last + 1, 1 << by), axis=1) if by else least.copy())
    sizes = [part.shape[1] for part in parts]
    start = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    low = np.concatenate(parts, axis=1)
    return Windows(low.ravel(), start.astype(np.int64), np.array(shift, dtype=np.int64), low.shape[1])
