"""Where the free motion of an equation is decided by its energy."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def falls_by_energy(v: Array, energy: Array, barrier: Array | float, beyond: Array) -> Array:
    """Whether bodies of this energy on still ground overturn; beyond: past the unstable equilibrium, from where only the speed
    to climb back over the barrier saves them."""
    return np.where(beyond, (v >= 0.0) | (energy < barrier), (v > 0.0) & (energy > barrier))
