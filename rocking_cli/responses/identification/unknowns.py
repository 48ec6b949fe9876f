"""What a fit leaves free: from a few unknowns to alpha and p of both sides."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...arrays import Array

INSET, ALPHA, BOTH = "inset", "alpha", "alpha,p"
FITS = (INSET, ALPHA, BOTH)
_SIGNS = np.array([1.0, -1.0])  # right, left
_STEP = 1e-6
_LARGEST = 1.5  # rad


@dataclass(frozen=True)
class Shape:
    """A function of the unknowns of a fit."""

    fit: str  # one of FITS
    two_sides: bool
    # (ln alpha, ln p) of the right and the left edge, (4,), at the unknowns: the insets
    # [m], or those of `angle_shape`
    at: Callable[[Array], Array]
    starts: list[Array]  # unknowns to begin with

    def slope(self, u: Array) -> Array:
        """Return the derivative of `at`, (4, unknowns)."""
        steps = _STEP * np.eye(u.size)
        return np.stack(
            [(self.at(u + h) - self.at(u - h)) / (2.0 * _STEP) for h in steps], axis=1
        )


def inset_shape(
    edges: Callable[[float, int], tuple[float, float]], lever: float, two_sides: bool
) -> Shape:
    """Return the shape whose unknown is the inset [m], or one of each side. edges:
    returns (alpha, p) for an inset and a side; lever: the largest inset [m].
    """

    def at(u: Array) -> Array:
        # beyond the lever there is no body: a large inset stays just below it
        insets = np.minimum(u, 0.999 * lever)
        pairs = [edges(float(insets[side % u.size]), side) for side in (0, 1)]
        return np.log(np.array(pairs)).T.ravel()

    shares = (0.0, 0.15, 0.3, 0.45, 0.6)
    count = 2 if two_sides else 1
    return Shape(INSET, two_sides, at, [np.full(count, x * lever) for x in shares])


def angle_shape(
    largest: float,
    p_at: Callable[[float], float],
    p: tuple[float, float] | None,
    ratio: float | None,
) -> Shape:
    """Return the shape whose unknowns are ln(p^2 alpha), unless p is known, ln alpha,
    and of two sides the log ratio right over left. largest: the first peak [rad]; p_at:
    a guess of p for an alpha; p: of the right and the left side; ratio: a guess of that
    of two sides, None for equal ones.
    """

    two_sides = ratio is not None
    more = [np.log(ratio)] if ratio is not None else []

    def at(u: Array) -> Array:
        # ln alpha as it is, but below a right angle
        ln_alpha = np.log(_LARGEST * np.tanh(np.exp(u[-1 - two_sides]) / _LARGEST))
        half = 0.5 * u[-1] * _SIGNS if two_sides else np.zeros(2)
        ln_p = np.log(p) if p else np.full(2, 0.5 * (u[0] - ln_alpha))
        return np.concatenate([ln_alpha + half, ln_p])

    starts = []
    for alpha in largest * np.array([1.03, 1.08, 1.3, 2.0, 4.0]):
        first = [] if p else [np.log(p_at(alpha) ** 2 * alpha)]
        starts.append(np.array([*first, np.log(alpha), *more]))
    return Shape(ALPHA if p else BOTH, two_sides, at, starts)
