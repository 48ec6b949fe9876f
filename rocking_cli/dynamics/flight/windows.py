"""Bounds of the outward drive over stretches of a record."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from ...motions.blocks import blocks, largest
from ...motions.columns import Column

Array = np.ndarray

SLACK = 1e-6  # part of the peak by which each bound lies below what it bounds: far above the rounding to single precision
_FINE = 3  # stretches of 2^k samples begin at every sample up to this k, at every 2^(k - 3)rd beyond


class Windows(Protocol):
    """Stretches of level k from sample n, which cover the samples n ... n + 2^k, as far as there are any.

    levels: their number; face: 0 is the right edge, this the left one.
    """

    @property
    def levels(self) -> int:
        """Number of levels."""

    @property
    def face(self) -> int:
        """What stands for the left edge."""

    def at(self, face: Array, level: Array, n: Array) -> Array:
        """Lower bound of the outward drive of A = 1 over the stretch."""


class Tabled(NamedTuple):
    """A bound for each stretch: 40 bytes a sample, and one look for each. start, shift: (levels,); face: entries of one side."""

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


class Blockwise(NamedTuple):
    """The same bounds from those of aligned blocks of 2, 4, 8 ... samples, 8 bytes a sample, and of the samples themselves: a stretch is
    nine blocks at the most. low: (2, blocks); start: of each size of blocks, none for single samples; last: the last block of each size."""

    samples: Array | Column
    slack: float
    low: Array
    start: Array
    last: Array
    levels: int
    face: int = 1

    def at(self, face: Array, level: Array, n: Array) -> Array:
        """Lower bound of the outward drive of A = 1 over the stretch."""
        shift = np.maximum(level - _FINE, 0)
        ahead = np.minimum(np.arange((1 << _FINE) + 1)[:, None], 1 << (level - shift))
        block = np.minimum((n >> shift) + ahead, self.last.take(shift))
        found = np.empty(n.shape, dtype=np.float32)
        one, many = np.flatnonzero(shift == 0), np.flatnonzero(shift)
        outward = np.where(face[one] > 0, 1.0, -1.0) * self.samples.take(block[:, one])
        outward -= self.slack
        found[one] = outward.min(axis=0).astype(np.float32)
        entry = face[many] * self.low.shape[1] + self.start.take(shift[many])
        found[many] = self.low.take(entry + block[:, many]).min(axis=0)
        return found


def windows(samples: Array | Column, levels: int) -> Windows:
    """The bounds of samples s (n,), for stretches of 1, 2, 4 ... 2^(levels - 1) intervals; on the right edge the outward drive is -s."""
    return blockwise(samples, levels) if isinstance(samples, Column) else tabled(samples, levels)


def tabled(samples: Array, levels: int) -> Tabled:
    """A table of all stretches."""
    last = samples.size - 1
    slack = SLACK * largest(samples)
    shift = np.maximum(0, np.arange(levels, dtype=np.int64) - _FINE)
    sizes = last // (1 << shift) + 1
    start = np.cumsum(sizes) - sizes
    low = np.empty((2, int(sizes.sum())), dtype=np.float32)
    for side, outward in zip(low, (np.negative, np.positive), strict=True):
        least = np.empty(last + 1, dtype=np.float32)
        for part in blocks(last + 1):  # so that no more than the tables themselves is held
            least[part] = outward(samples[part]) - slack
        _pairwise_least(least, 1)
        for level in range(levels):
            if level:
                _pairwise_least(least, min(1 << (level - 1), last + 1))
            side[start[level] : start[level] + sizes[level]] = _least_from(least, 1 << int(shift[level]))
    return Tabled(low.ravel(), start, shift, low.shape[1])


def blockwise(samples: Array | Column, levels: int) -> Blockwise:
    """A table of aligned blocks."""
    last = samples.size - 1
    slack = SLACK * max(largest(samples[part]) for part in blocks(samples.size))
    largest_block = max(0, levels - 1 - _FINE)
    lasts = last >> np.arange(largest_block + 1)
    sizes = np.append(0, lasts[1:] + 1)
    start = np.cumsum(sizes) - sizes
    low = np.full((2, int(sizes.sum())), np.inf, dtype=np.float32)
    for side, sense in zip(low, (-1.0, 1.0), strict=True):
        for part in blocks(last + 1):  # of an even number of samples
            if largest_block:
                least = (sense * samples[part] - slack).astype(np.float32)
                first = part.start >> 1
                side[first : first + (least.size + 1) // 2] = _least_from(least, 2)
        for size in range(2, largest_block + 1):
            below = side[start[size - 1] : start[size - 1] + sizes[size - 1]]
            side[start[size] : start[size] + sizes[size]] = _least_from(below, 2)
    return Blockwise(samples, slack, low, start, lasts, levels)


def _pairwise_least(values: Array, reach: int) -> None:
    """Each value becomes the lesser of itself and the one so far after it, where there is one."""
    for part in blocks(values.size - reach):  # from the front: what comes later has not changed yet
        np.minimum(values[part], values[part.start + reach : part.stop + reach], out=values[part])


def _least_from(values: Array, by: int) -> Array:
    """The least of each run of so many values."""
    return values if by == 1 else np.minimum.reduceat(values, np.arange(0, values.size, by))
