"""Long arrays in blocks, so that temporary arrays stay small."""

from collections.abc import Iterator

import numpy as np


def blocks(size: int, most: int = 1 << 16) -> Iterator[slice]:
    """Return slices that cut an array of this size into consecutive blocks of at most
    `most` values (default 2^16).
    """
    return (slice(first, min(first + most, size)) for first in range(0, size, most))


def largest(values: np.ndarray) -> float:
    """Return max |values|; 0 for an empty array, NaN if a value is NaN."""
    return max(abs(float(values.max(initial=0.0))), abs(float(values.min(initial=0.0))))
