"""After the shaking: the linear oscillator's fate in closed form, no integration (Eq. 2.7).

With E = v^2 - (1 - y)^2 constant between impacts, D0* of Eq. 2.7 is -E at the end of the pulse.
"""

from __future__ import annotations

from collections.abc import Callable
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


def fate_by_energy(y: Array, v: Array, eta: Array, energy: Array, barrier: float, beyond: Array, crest: Callable[[Array], Array]) -> Fate:
    """The same for any potential: energy (v^2/2 and the potential), its value at the unstable equilibrium, which bodies are
    beyond that, and the displacement at which an energy up to the barrier is used up."""
    overturns = np.where(beyond, (v >= 0.0) | (energy < barrier), (v > 0.0) & (energy > barrier))
    rebound = eta * eta * energy
    after = ~overturns & (rebound > barrier)
    peak = np.full(np.shape(y), np.nan)
    stays = np.flatnonzero(~(overturns | after))
    out = v[stays] > 0.0  # the next crest is the higher one, since eta <= 1
    top = crest(np.where(out, energy[stays], rebound[stays]))
    peak[stays] = np.where(out, top, np.maximum(y[stays], top))
    return Fate(overturns, after, peak)


def _crest(drop: Array) -> Array:
    """1 - sqrt(1 - drop) without cancellation where `drop` is small; at most 1."""
    return drop / (1.0 + np.sqrt(np.maximum(0.0, 1.0 - drop)))
