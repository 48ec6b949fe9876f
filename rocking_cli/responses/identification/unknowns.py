"""What a fit leaves free: from a few unknowns to alpha and p of both sides."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...arrays import Array

INSET, ALPHA, BOTH = "inset", "alpha", "alpha,p"
FITS = (INSET, ALPHA, BOTH)
_SIGNS = np.array([1.0, -1.0])  # right, left
_STEP = 1e-6
_LARGEST = np.log(1.4)  # of ln alpha


@dataclass(frozen=True)
class Shape:
    """A function of the unknowns of a fit."""

    fit: str  # one of FITS
    two_sides: bool
    # (ln alpha, ln p) of the right and the left edge, (4,), at the unknowns: the insets
    # [m] | ln alpha and the log ratio right over left | ln(p^2 alpha), and the same
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


def alpha_shape(
    p: tuple[float, float], largest: float, two_sides: bool, ratio: float
) -> Shape:
    """Return the shape whose unknown is ln alpha, beside a known p of each side.
    largest: the first peak [rad]; ratio: alpha of the right side over the left one.
    """

    def at(u: Array) -> Array:
        half = 0.5 * u[1] * _SIGNS if two_sides else np.zeros(2)
        return np.concatenate([_held(u[0]) + half, np.log(p)])

    return Shape(ALPHA, two_sides, at, _starts(largest, two_sides, ratio))


def free_shape(
    largest: float, p_at: Callable[[float], float], two_sides: bool, ratio: float
) -> Shape:
    """Return the shape whose unknowns are ln(p^2 alpha) and ln alpha; p_at: a guess of
    p for an alpha. The other arguments are those of `alpha_shape`.
    """

    def at(u: Array) -> Array:
        half = 0.5 * u[2] * _SIGNS if two_sides else np.zeros(2)
        ln_p = 0.5 * (u[0] - _held(u[1]))
        return np.concatenate([_held(u[1]) + half, [ln_p, ln_p]])

    starts = [
        np.concatenate([[2.0 * np.log(p_at(float(np.exp(u[0])))) + u[0]], u])
        for u in _starts(largest, two_sides, ratio)
    ]
    return Shape(BOTH, two_sides, at, starts)


def _held(ln_alpha: float) -> float:
    """Return ln alpha below a right angle."""
    return min(ln_alpha, _LARGEST)


def _starts(largest: float, two_sides: bool, ratio: float) -> list[Array]:
    """Return ln alpha, from 1.03 to 4 first peaks, and the ratio of the sides."""
    more = [np.log(ratio)] if two_sides else []
    return [np.array([np.log(x * largest), *more]) for x in (1.03, 1.08, 1.3, 2.0, 4.0)]
