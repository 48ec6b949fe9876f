"""The coefficients of a mechanism's equation between nodes, for the general solver: an
evaluation of a linkage takes a hundred times as long as that of a polynomial.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ...structures.mechanics.kinematics import Mechanism

_DEGREE = 10  # of the polynomials of a panel
_PANELS = 8  # panels between rest and alpha, before they are halved
_HALVINGS = 12  # of a panel; where none of them helps, the linkage itself is asked
# difference of a polynomial from the linkage between the nodes, over the largest value
# in the panel
_CLOSE = 1e-13
_NODES = -np.cos(np.pi * (np.arange(_DEGREE + 1) + 0.5) / (_DEGREE + 1))  # of [-1, 1]
# the nodes, and the places between them where a polynomial is compared
_PLACES = np.append(_NODES, [-1.0, -0.55, 0.1, 0.71, 1.0])

# 1/sqrt(m), V'/(g M0 sqrt(m)) and B/(M0 sqrt(m)) of Eq. 3.4 at a rotation [rad], with
# m = M/M0 and M0 = M at rest
Functions = Callable[[float], tuple[float, float, float]]


def _polynomials(
    centre: float, half: float, terms: Sequence[tuple[float, float, float]]
) -> Functions:
    """Return three polynomials on one panel. centre, half: the middle of the panel and
    half its width [rad]; terms: coefficients of the powers of (theta - centre)/half,
    the highest first, each of the three functions.
    """

    def functions(theta: float) -> tuple[float, float, float]:
        x = (theta - centre) / half
        a = b = c = 0.0
        for i, j, k in terms:
            a, b, c = a * x + i, b * x + j, c * x + k
        return a, b, c

    return functions


class _Tables:
    """Polynomials on panels of one width, each fitted when a rotation first falls into
    it.
    """

    def __init__(self, mechanism: Mechanism, width: float, halvings: int) -> None:
        self.mechanism = mechanism
        self.at_rest = float(mechanism.coefficients(0.0).inertia)  # M0 [kg m2]
        self.width = width  # of a panel [rad]
        self.halvings = halvings  # how often a panel may be halved
        self.panels: dict[int, Functions] = {}  # by the number of the panel

    def __call__(self, theta: float) -> tuple[float, float, float]:
        place = math.floor(theta / self.width)
        panel = self.panels.get(place)
        if panel is None:
            panel = self.panels[place] = self._fitted(place)
        return panel(theta)

    def exactly(self, theta: np.ndarray) -> np.ndarray:
        """Return the three functions by the linkage, (rotations, 3)."""
        c = self.mechanism.coefficients(theta)
        root = np.sqrt(c.inertia / self.at_rest)
        moment = self.at_rest * root
        return np.stack([1.0 / root, c.lift / moment, c.push / moment], axis=-1)

    def _fitted(self, place: int) -> Functions:
        """Return the functions of a panel: polynomials, or panels of half the width
        where these are not close enough.
        """
        half = 0.5 * self.width
        centre = (2 * place + 1) * half
        known = self.exactly(centre + half * _PLACES)
        if np.all(np.isfinite(known)):
            powers = np.vander(_PLACES, _DEGREE + 1)
            terms = np.linalg.solve(powers[: _NODES.size], known[: _NODES.size])
            apart = np.abs(powers @ terms - known).max(axis=0)
            if np.all(apart <= _CLOSE * np.abs(known).max(axis=0)):
                return _polynomials(centre, half, terms.tolist())
        if self.halvings:
            return _Tables(self.mechanism, half, self.halvings - 1)
        return lambda theta: tuple(self.exactly(np.array(theta)).tolist())


@lru_cache(maxsize=64)
def tabulated(mechanism: Mechanism, alpha: float) -> Functions:
    """Return the functions of a mechanism in Eq. 3.4; alpha: its critical angle
    [rad].
    """
    return _Tables(mechanism, alpha / _PANELS, _HALVINGS)
