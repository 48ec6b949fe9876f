"""Exact flow of the linear rocking oscillator on one side, for drives that are sums of
sinusoids and a ramp.

With y = |theta|/alpha on the current side, tau = p t and the outward drive a = -side A
s (positive lifts the body),

    y'' = y - 1 + a                                 (Eqs. 2.4 and 3.6, dimensionless)

The state after h is the present state plus increments with their leading power of h as
a factor: for a small motion, a difference of terms of order one would lose its digits.
With b = y''(0) and a(h) = a(0) + sum_j [S_j sin(w_j h) - C_j (1 - cos(w_j h))] + r h,

    y(h) = y0 + v0 sinh h + b (cosh h - 1)
           + sum_j [S_j F3(w_j, h) - C_j F4(w_j, h)] + r (sinh h - h)
    F3 = (w sinh h - sin(w h)) / (1 + w^2)
    F4 = (w^2 (cosh h - 1) - (1 - cos(w h))) / (1 + w^2)
"""

import math
from dataclasses import dataclass

import numpy as np

from ..drive import turn
from ..lanes import Array, Arrays
from .equation import Point

# where max(1, w) h is below this, series replace the differences in F3 and F4
SMALL = 0.5
# terms of those series: the first one left out is below 1e-17 of the sum at SMALL
_TERMS = 7
# Of 6 (sinh x - x)/x^3 and 24 (cosh x - 1 - x^2/2)/x^4 in powers of x^2.
_ODD, _EVEN = (
    np.array([math.factorial(k) / math.factorial(2 * n + k) for n in range(_TERMS)])
    for k in (3, 4)
)
_BOTH = np.stack([_ODD, _EVEN], axis=1)[:, :, None, None]


@dataclass
class LinearFlow(Arrays):
    """An arc for each lane: the state at its start, and the terms of the drive."""

    y: Array  # displacement at the start, in the unit of the side, (lanes,)
    v: Array  # velocity y' at the start, by tau, (lanes,)
    b: Array  # acceleration y'' at the start, by tau, (lanes,)
    # S_j: coefficient of sin(w h), rate of the outward drive over w [-], (harmonics,
    # lanes)
    sin: Array
    # C_j: coefficient of cos(w h) in the outward drive [-], (harmonics, lanes)
    cos: Array
    w: Array  # angular frequency over p [1/tau], (harmonics, lanes)
    ramp: Array | None  # r [1/tau], (lanes,), or None when the motion has no ramp
    damping = 0.0

    @property
    def longest(self) -> Array:
        """Longest step [tau]: cosh stays below 2e10, so growth cannot bury the state in
        rounding.
        """
        return np.full(self.y.shape, 24.0)

    @property
    def fastest(self) -> Array:
        """Rate [1/tau] of the fastest change: 1 + the fastest frequency
        of the drive.
        """
        return 1.0 + self.w.max(axis=0, initial=0.0)

    def at(self, h: Array) -> Point:
        """The state after h >= 0 [-], exact up to rounding."""
        half = np.sinh(0.5 * h)
        half2 = half * half
        sinh, cosh1 = 2.0 * (np.sqrt(half2 + 1.0) * half), 2.0 * half2
        y = self.v * sinh + self.y + self.b * cosh1
        v = self.v * cosh1 + self.v + self.b * sinh
        drive, drive_rate = np.zeros(h.shape), np.zeros(h.shape)
        moved = Point(y, v, drive, drive_rate)
        for s, c, w in zip(self.sin, self.cos, self.w, strict=True):
            _add_sinusoid(moved, (s, c, w), h, sinh, cosh1)
        if self.ramp is not None:
            y = y + self.ramp * _sinh_less_h(h, sinh)
            v = v + self.ramp * cosh1
            drive = drive + self.ramp * h
            drive_rate = drive_rate + self.ramp
        return Point(y, v, drive + self.b + (y - self.y), drive_rate + v)

    def at_ground(self, h: Array) -> Array:
        """The force at an impact, where y = 0, computed from the change of the drive
        since the start.
        """
        total = (
            self.b - self.y if self.ramp is None else self.b - self.y + self.ramp * h
        )
        for s, c, w in zip(self.sin, self.cos, self.w, strict=True):
            t = np.tan(0.5 * (w * h))
            total = total + 2.0 * t * (s - c * t) / (1.0 + t * t)
        return total


def _add_sinusoid(
    moved: Point,
    sinusoid: tuple[Array, Array, Array],
    h: Array,
    sinh: Array,
    cosh1: Array,
) -> None:
    """Add the part of a sinusoid (S_j, C_j, w_j) of the drive to y, y', the change of
    the drive and its rate, which stand in `moved`, in this order; sinh, cosh1: sinh h
    and cosh h - 1.
    """
    y, v, drive, drive_rate = moved
    s, c, w = sinusoid
    wh = w * h
    sinw, cosm = turn(wh)
    w2 = w * w
    over = 1.0 / (w2 + 1.0)
    f3, f4 = (w * sinh - sinw) * over, (w2 * cosh1 - cosm) * over
    (small,) = (np.maximum(h, wh) < SMALL).nonzero()
    f3[small], f4[small] = _series(w[small], h[small])
    y += s * f3
    y -= c * f4
    v += s * ((cosm + cosh1) * w * over)  # derivative of F3
    v -= c * (f3 * w)
    drive += s * sinw
    drive -= c * cosm
    drive_rate += ((1.0 - cosm) * s - c * sinw) * w


def _sinh_less_h(h: Array, sinh: Array) -> Array:
    """sinh h - h, by its series where h is small."""
    tiny, rest = h < SMALL, sinh - h
    x, x2 = h[tiny], h[tiny] * h[tiny]
    rest[tiny] = x * x2 * np.polyval(_ODD[::-1], x2) * (1.0 / 6.0)
    return rest


def _series(w: Array, h: Array) -> tuple[Array, Array]:
    """F3 and F4, the parts of y that sin(w h) and 1 - cos(w h) in the drive add, by
    series for small arguments.
    """
    # Each bracket of
    #     F3 (1 + w^2) = [w (sinh h - h)] + [w h - sin(w h)]
    #     F4 (1 + w^2) = [w^2 (cosh h - 1 - h^2/2)] + [w^2 h^2/2 - 1 + cos(w h)]
    # is a series in h^2, or in -(w h)^2.
    h2, w2 = h * h, w * w
    argument = np.empty((2, h.size))
    argument[0] = h2
    np.multiply(h2, -w2, out=argument[1])
    total = _BOTH[-1] * argument  # (odd or even, h or wh, lanes)
    for c in _BOTH[-2:0:-1]:
        total += c
        total *= argument
    total += _BOTH[0]
    factor = w * h * h2 / (1.0 + w2)
    (odd_h, odd_wh), (even_h, even_wh) = total
    return factor * (odd_h + w2 * odd_wh) * (1.0 / 6.0), w * h * factor * (
        even_h + w2 * even_wh
    ) * (1.0 / 24.0)
