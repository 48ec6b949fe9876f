"""After the shaking: the linear oscillator's fate in closed form, no integration (Eq. 2.7).

With E = v^2 - (1 - y)^2 constant between impacts, D0* of Eq. 2.7 is -E at the end of the pulse.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class Fate(NamedTuple):
    """What the free motion comes to: overturns before or after its next impact, and the largest |theta|/alpha."""

    overturns: Array
    overturns_after_impact: Array
    peak: Array


def free_fate(y: Array, v: Array, eta: Array) -> Fate:
    """Fate of bodies released at displacement y >= 0 and velocity v (outward positive) on still ground.

    Parameters are arrays of one shape: y = |theta|/alpha [-], v = dy/dtau [-], eta restitution [-]. `peak` is NaN where
    the body overturns. Later maxima are smaller than the two looked at, since eta <= 1.
    """
    unstable = y - 1.0 + v
    drop = v * v + y * (2.0 - y)  # 1 + E: square of the speed at the next impact, free of cancellation
    rebound = eta * eta * drop
    overturns = unstable > 0.0
    after = ~overturns & ((v < 0.0) | (y < 1.0)) & (rebound > 1.0)
    outward = np.where((v > 0.0) & ~overturns, _crest(drop), y)
    peak = np.maximum(outward, _crest(rebound))
    return Fate(overturns, after, np.where(overturns | after, np.nan, peak))


def _crest(drop: Array) -> Array:
    """1 - sqrt(1 - drop) without cancellation where `drop` is small; at most 1."""
    return drop / (1.0 + np.sqrt(np.maximum(0.0, 1.0 - drop)))
