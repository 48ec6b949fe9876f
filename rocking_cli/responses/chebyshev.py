"""Extremes of a smooth function on an interval of time, found as roots of the
derivative of its Chebyshev series, not by sampling.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ..arrays import Array

_DEGREE = 24
# last coefficients over the largest: the place of an extremum is then good to 1e-5 of
# the interval, its value to rounding
_ENDED = 1e-10
_SMALL = 1e-14  # coefficients that are rounding
_DEEPEST = 12  # halvings of an interval whose series does not end


class Extent(NamedTuple):
    """The least and the largest value of a function, and the places of both."""

    least: float  # value
    at_least: float  # place of the least value
    largest: float  # value
    at_largest: float  # place of the largest value

    def join(self, other: "Extent") -> "Extent":
        """Return the extent over the intervals of both."""
        low = min(self, other, key=lambda e: e.least)
        high = max(self, other, key=lambda e: e.largest)
        return Extent(low.least, low.at_least, high.largest, high.at_largest)


def extent(
    f: Callable[[Array], Array], low: float, high: float, depth: int = 0
) -> Extent:
    """Return the least and the largest value of an analytic, vectorised function f on
    [low, high], from its ends and all extrema inside.

    The interval is halved until the Chebyshev series of f converges on each part. The
    roots of the derivative of the series are the extrema; f itself is then evaluated
    there.
    """
    x, analyse = _nodes()
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    t = middle + half * x
    t[0], t[-1] = low, high
    values = f(t)
    if not np.isfinite(values).all():
        return Extent(-np.inf, low, np.inf, low)
    terms = analyse @ values
    scale = float(np.abs(terms).max())
    if np.abs(terms[-3:]).max() > _ENDED * scale and depth < _DEEPEST:
        return extent(f, low, middle, depth + 1).join(
            extent(f, middle, high, depth + 1)
        )
    slope = chebyshev.chebder(np.where(np.abs(terms) > _SMALL * scale, terms, 0.0))
    if (
        np.abs(slope[0]) <= np.abs(slope[1:]).sum()
        and (slope := np.trim_zeros(slope, "b")).size > 1
    ):
        roots = chebyshev.chebroots(slope)
        inner = roots.real[(np.abs(roots.imag) < 1e-6) & (np.abs(roots.real) < 1.0)]
        if inner.size:
            turns = middle + half * inner
            t, values = np.append(t, turns), np.append(values, f(turns))
    i, j = int(np.argmin(values)), int(np.argmax(values))
    return Extent(float(values[i]), float(t[i]), float(values[j]), float(t[j]))


@cache
def _nodes() -> tuple[Array, Array]:
    """Return the Chebyshev points of the second kind, from -1 to 1, and the matrix from
    values at them to the coefficients.
    """
    k = np.arange(_DEGREE + 1)
    x = -np.cos(np.pi * k / _DEGREE)
    return x, np.linalg.inv(chebyshev.chebvander(x, _DEGREE))
