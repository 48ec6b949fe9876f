"""Bodies that nothing lifts again: from an impact on they bounce to the end of the shaking, and never as high as they were.

For the undamped linear oscillator on equal edges. Let the drive be at most e in size from the impact on, e < 1, and V all that it varies
until it has come to rest, jumps and the last one included. Over an arc from impact to impact v^2 changes by int 2 y' a = - int 2 y da,
and while v^2 <= 3/4 (1 - e)^2 no arc rises above 2/3 v^2/(1 - e), since y'' <= y - 1 + e. So an arc multiplies v^2 by no more than
1 + 4/3 dV/(1 - e), an impact lowers it, and all arcs to come multiply it by less than exp(4/3 V/(1 - e)).
"""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..lanes import Lanes

Array = np.ndarray


def settles(segments: Segments, lanes: Lanes) -> Array:
    """Whether lanes just after an impact stay on or near the ground until the shaking is over, and below their peak for good."""
    drive, ends = 1.0 + lanes.b, -lanes.side * lanes.amplitude * segments.s_end[lanes.k]
    left = 1.0 - np.maximum(np.maximum(np.abs(drive), np.abs(ends)), lanes.amplitude * segments.largest_later[lanes.k])
    variation = np.abs(ends - drive) + lanes.amplitude * segments.variation[lanes.k]
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        fastest = lanes.v * lanes.v * np.exp(4.0 / 3.0 * variation / left)
        return np.asarray((left > 0.0) & (fastest <= 0.75 * left * left) & (fastest <= 1.5 * left * lanes.peak))
