"""The coefficients of a mechanism's equation between nodes, for the general solver: an
evaluation of a linkage takes a hundred times as long as that of a polynomial.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, lru_cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ...structures.mechanics.linkage import Linkage

_PANELS = 16  # between rest and alpha
_NODES = np.cos(np.pi * (np.arange(14) + 0.5) / 14)  # of a panel, from -1 to 1
# difference of a polynomial from the linkage in the middle of its panel, over the
# value at rest
_CLOSE = 1e-13

# 1/sqrt(m), V'/(g M0 sqrt(m)) and B/(M0 sqrt(m)) of Eq. 3.4 at a rotation [rad], with
# m = M/M0 and M0 = M at rest
Functions = Callable[[float], tuple[float, float, float]]


@lru_cache(maxsize=64)
def tabulated(mechanism: Linkage, alpha: float) -> Functions:
    """Return the functions of a mechanism in Eq. 3.4: polynomials on panels, and the
    linkage itself where none is close; alpha: its critical angle [rad].
    """
    at_rest = float(mechanism.coefficients(0.0).inertia)  # M0 [kg m2]

    def exactly(theta: np.ndarray) -> np.ndarray:  # (..., 3)
        with np.errstate(all="ignore"):
            c = mechanism.coefficients(theta)
            root = np.sqrt(c.inertia / at_rest)
            moment = at_rest * root
            return np.stack([1.0 / root, c.lift / moment, c.push / moment], axis=-1)

    width = alpha / _PANELS
    powers = np.vander(_NODES)

    @cache
    def panel(place: int) -> list[list[float]] | None:
        known = exactly(width * (place + 0.5 + 0.5 * np.append(_NODES, 0.0)))
        terms = np.linalg.solve(powers, known[:-1])
        apart = np.abs(terms[-1] - known[-1])
        close = np.all(apart <= _CLOSE * exactly(np.zeros(())))
        return terms.tolist() if close else None

    def functions(theta: float) -> tuple[float, float, float]:
        place = math.floor(theta / width)
        terms = panel(place)
        if terms is None:
            return tuple(exactly(np.array(theta)).tolist())
        x = 2.0 * (theta / width - place) - 1.0
        a = b = c = 0.0
        for i, j, k in terms:
            a, b, c = a * x + i, b * x + j, c * x + k
        return a, b, c

    return functions
