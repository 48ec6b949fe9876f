"""Long arrays part by part, so that no more than a part is held of what is only needed on the way."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

_PART = 1 << 16


def blocks(size: int) -> Iterator[slice]:
    """Consecutive parts of an array of this size."""
    return (slice(first, min(first + _PART, size)) for first in range(0, size, _PART))


def largest(values: np.ndarray) -> float:
    """max |values|, 0 of none; NaN where one is."""
    return max(abs(float(values.max(initial=0.0))), abs(float(values.min(initial=0.0))))
