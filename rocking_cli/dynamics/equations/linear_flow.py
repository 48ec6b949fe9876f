"""Exact flow of the undamped linear oscillator on one side, under one sinusoid.

With y = |theta|/alpha on the side, tau = p t and the outward drive a = -side A s,

    y'' = y - 1 + a                                 (Eqs. 2.4 and 3.6, dimensionless)

The state after h is the present state plus increments with their leading power of h as
a factor: for a small motion, a difference of terms of order one would lose its digits.
With b = y''(0) and a(h) = a(0) + S sin(w h) - C (1 - cos(w h)),

    y(h) = y0 + v0 sinh h + b (cosh h - 1) + S F3(h) - C F4(h)
    F3 = (w sinh h - sin(w h)) / (1 + w^2)
    F4 = (w^2 (cosh h - 1) - (1 - cos(w h))) / (1 + w^2)
"""

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..drive import segment_value, turn
from ..lanes import Arrays, Lanes
from .taylor import Instant

LONGEST = 24.0  # tau: cosh stays below 2e10, growth cannot bury the state in rounding
# where max(1, w) h is below this, series replace the differences in F3 and F4
_SMALL = 0.5
# terms of those series: the first one left out is below 1e-17 of the sum at _SMALL
_TERMS = 7
# Of 6 (sinh x - x)/x^3 and 24 (cosh x - 1 - x^2/2)/x^4 in powers of x^2.
_ODD, _EVEN = (
    np.array([math.factorial(k) / math.factorial(2 * n + k) for n in range(_TERMS)])
    for k in (3, 4)
)
_BOTH = np.stack([_ODD, _EVEN], axis=1)[:, :, None, None]


@dataclass
class LinearFlow(Arrays):
    """The motion of each lane: the state at its start, and its drive. Every array is
    (lanes,).
    """

    y: Array  # displacement at the start, in the unit of the side
    v: Array  # velocity y' at the start, by tau
    b: Array  # acceleration y'' at the start, by tau
    sin: Array  # S: rate of the outward drive at the start over w [-]
    cos: Array  # C: the sinusoid in the outward drive at the start [-]
    w: Array  # angular frequency over p [1/tau]

    @classmethod
    def of(cls, segments: Segments, lanes: Lanes) -> "LinearFlow":
        """Build the flow of lanes from their present state."""
        k, outward = lanes.segment, -lanes.side * lanes.amplitude
        change, sin, cos = segment_value(segments, k, lanes.phase)
        unknown = np.isnan(lanes.force)
        drive = outward * (segments.s_start[k] + change)
        b = np.where(unknown, lanes.y - 1.0 + drive, lanes.force)
        w = segments.frequency[0].take(k) * lanes.omega
        return cls(lanes.y, lanes.v, b, outward * cos[0], outward * sin[0], w)

    @property
    def fastest(self) -> Array:
        """Rate of the fastest change [1/tau]."""
        return 1.0 + self.w

    def at(self, h: Array) -> Instant:
        """The state after h >= 0 [tau], exact up to rounding."""
        half = np.sinh(0.5 * h)
        cosh1 = 2.0 * (half * half)
        sinh = 2.0 * (np.sqrt(half * half + 1.0) * half)
        w, wh = self.w, self.w * h
        w2 = w * w
        sinw, cosm = turn(wh)
        over = 1.0 / (w2 + 1.0)
        f3, f4 = (w * sinh - sinw) * over, (w2 * cosh1 - cosm) * over
        (small,) = (np.maximum(h, wh) < _SMALL).nonzero()
        f3[small], f4[small] = _series(w[small], h[small])
        s, c = self.sin, self.cos
        moved = self.v * sinh + self.b * cosh1 + s * f3 - c * f4
        v = self.v * cosh1 + self.v + self.b * sinh
        v += s * ((cosm + cosh1) * w * over)  # derivative of F3
        v -= c * (f3 * w)
        drive = s * sinw - c * cosm
        rate = ((1.0 - cosm) * s - c * sinw) * w
        return Instant(self.y + moved, v, drive + self.b + moved, rate + v)

    def at_ground(self, h: Array) -> Array:
        """The force at an impact, where y = 0, by the change of the drive since the
        start.
        """
        sinw, cosm = turn(self.w * h)
        return self.b - self.y + self.sin * sinw - self.cos * cosm


def _series(w: Array, h: Array) -> tuple[Array, Array]:
    """F3 and F4 by series, for small arguments."""
    # Each bracket of
    #     F3 (1 + w^2) = [w (sinh h - h)] + [w h - sin(w h)]
    #     F4 (1 + w^2) = [w^2 (cosh h - 1 - h^2/2)] + [w^2 h^2/2 - 1 + cos(w h)]
    # is a series in h^2, or in -(w h)^2.
    h2, w2 = h * h, w * w
    argument = np.array([h2, -h2 * w2])
    total = _BOTH[-1] * argument  # (odd or even, h or wh, lanes)
    for c in _BOTH[-2:0:-1]:
        total += c
        total *= argument
    total += _BOTH[0]
    (odd_h, odd_wh), (even_h, even_wh) = total
    factor = w * h * h2 / (1.0 + w2)
    return factor * (odd_h + w2 * odd_wh) * (1.0 / 6.0), w * h * factor * (
        even_h + w2 * even_wh
    ) * (1.0 / 24.0)
