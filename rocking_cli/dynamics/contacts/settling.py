"""Undamped linear oscillators on equal edges that are not lifted again: they bounce to the end of the shaking (Lemma 7 (a))."""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..lanes import Lanes

Array = np.ndarray


def settles(segments: Segments, lanes: Lanes) -> Array:
    """True for lanes just after an impact that bounce or rest until the shaking is over and never rise above their peak."""
    drive, ends = 1.0 + lanes.b, -lanes.side * lanes.amplitude * segments.s_end[lanes.k]
    left = 1.0 - np.maximum(np.maximum(np.abs(drive), np.abs(ends)), lanes.amplitude * segments.largest_later[lanes.k])
    variation = np.abs(ends - drive) + lanes.amplitude * segments.variation[lanes.k]
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        fastest = lanes.v * lanes.v * np.exp(4.0 / 3.0 * variation / left)
        return np.asarray((left > 0.0) & (fastest <= 0.75 * left * left) & (fastest <= 1.5 * left * lanes.peak))
