"""Bodies that are not lifted again: from an impact on they bounce to the end of the shaking, below their peak.

For the undamped linear oscillator on equal edges: Lemma 7 (a).
"""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..lanes import Lanes

Array = np.ndarray


def settles(segments: Segments, lanes: Lanes) -> Array:
    """True for lanes just after an impact that stay on or near the ground until the shaking is over, and below their peak for good."""
    drive, ends = 1.0 + lanes.b, -lanes.side * lanes.amplitude * segments.s_end[lanes.k]
    left = 1.0 - np.maximum(np.maximum(np.abs(drive), np.abs(ends)), lanes.amplitude * segments.largest_later[lanes.k])
    variation = np.abs(ends - drive) + lanes.amplitude * segments.variation[lanes.k]
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        fastest = lanes.v * lanes.v * np.exp(4.0 / 3.0 * variation / left)
        return np.asarray((left > 0.0) & (fastest <= 0.75 * left * left) & (fastest <= 1.5 * left * lanes.peak))
