"""The coefficients of a mechanism's equation between nodes, for the general solver: an
evaluation of a linkage takes a hundred times as long as that of a polynomial.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ...structures.mechanics.kinematics import Mechanism

_NODES = 10  # of the polynomial of a panel, whose ends are the middle two
_PANELS = 96  # between rest and alpha
_BELOW, _REACH = -0.5, 5.0  # the first and last rotation of a panel, over alpha
# difference of a polynomial from the linkage in the middle of its panel, over the
# value at rest
_CLOSE = 1e-13

# 1/sqrt(m), V'/(g M0 sqrt(m)) and B/(M0 sqrt(m)) of Eq. 3.4 at a rotation [rad], with
# m = M/M0 and M0 = M at rest
Functions = Callable[[float], tuple[float, float, float]]


@lru_cache(maxsize=64)
def tabulated(mechanism: Mechanism, alpha: float) -> Functions:
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
    first = math.floor(_BELOW * _PANELS)
    last = math.floor(min(_REACH * alpha, mechanism.reach) / width)
    half = _NODES // 2
    known = exactly(width * np.arange(first - half + 1, last + half))
    windows = np.lib.stride_tricks.sliding_window_view(known, _NODES, axis=0)
    places = np.linspace(1 - _NODES, _NODES - 1, _NODES)  # of the nodes, over width/2
    with np.errstate(all="ignore"):
        terms = np.linalg.solve(np.vander(places), windows.swapaxes(1, 2))
        apart = np.abs(terms[:, -1] - exactly(width * (np.arange(first, last) + 0.5)))
        close = np.all(apart <= _CLOSE * exactly(np.zeros(())), axis=-1)
    panels = dict(
        zip(np.flatnonzero(close).tolist(), terms[close].tolist(), strict=True)
    )

    def functions(theta: float) -> tuple[float, float, float]:
        place = math.floor(theta / width) - first
        if place not in panels:
            return tuple(exactly(np.array(theta)).tolist())
        x = 2.0 * (theta / width - first - place) - 1.0
        a = b = c = 0.0
        for i, j, k in panels[place]:
            a, b, c = a * x + i, b * x + j, c * x + k
        return a, b, c

    return functions
