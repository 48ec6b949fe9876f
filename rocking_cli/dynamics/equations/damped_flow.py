"""Exact flow of the linear rocking oscillator with viscous damping, for drives that are sums of sinusoids and a ramp.

    y'' + 2 zeta y' - y = -1 + a

With k = sqrt(1 + zeta^2), S = exp(-zeta h) sinh(k h)/k and
C = int S dh (sinh h and cosh h - 1 without damping), the force f and a(h) = a(0) + sum_j [S_j sin(w_j h) - C_j (1 - cos(w_j h))] + r h,

    y(h) = y0 + v0 S + f C + sum_j [S_j G3(w_j, h) - C_j G4(w_j, h)] + r (S - h + 2 zeta C)
    G3 = [(1 + w^2)(w S - sin(w h)) + 2 zeta w (C + 1 - cos(w h))] / D,           D = (1 + w^2)^2 + 4 zeta^2 w^2
    G4 = [(D - 1 - w^2) C - (1 + w^2)(1 - cos(w h)) + 2 zeta w (w S - sin(w h))] / D

As in `flow`, small increments are summed from their series.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..drive import turn
from ..lanes import Array
from .equation import Point
from .flow import SMALL, LinearFlow

_TERMS = 17  # powers of h in a series: the terms left out at SMALL are below 1e-17 of its sum for zeta up to 1


@dataclass
class DampedFlow(LinearFlow):
    """One arc a lane, with the fields of `LinearFlow`; b is the force f at its start."""

    @property
    def fastest(self) -> Array:
        """Rate [1/tau] of the fastest change: of the decaying mode, or of the fastest drive."""
        return 1.0 + 2.0 * self.damping + self.w.max(axis=0, initial=0.0)

    def at(self, h: Array) -> Point:
        """The state after h >= 0 [-], exact up to rounding."""
        zeta = self.damping
        k = math.sqrt(1.0 + zeta * zeta)
        half = np.sinh(h * (0.5 * k))
        half2 = half * half
        s, decay = np.sqrt(half2 + 1.0) * half * (2.0 / k), np.exp(h * -zeta)
        c = (2.0 * half2 + s * zeta) * decay + np.expm1(h * -zeta)
        s *= decay
        tiny = np.flatnonzero(h < SMALL)
        x = h[tiny]
        s4, c4 = (np.polyval(terms, x) * (x * x) ** 2 for terms in _coefficients(zeta))  # the terms of S and C from h^4 on
        c[tiny] = x * x * (0.5 - zeta * x / 3.0) + c4
        y, v = self.v * s + self.b * c, (s * (-2.0 * zeta) + c + 1.0) * self.v + self.b * s
        drive, drive_rate = np.zeros(h.shape), np.zeros(h.shape)
        for sin, cos, w in zip(self.sin, self.cos, self.w, strict=True):
            sinw, cosm = turn(w * h)
            w1, cross = w * w + 1.0, w * (2.0 * zeta)
            d, lag = w1 * w1 + cross * cross, w * s - sinw
            g3 = ((c + cosm) * cross + w1 * lag) / d
            g4 = ((d - w1) * c - w1 * cosm + cross * lag) / d
            small = np.flatnonzero(w[tiny] * x < SMALL)
            at = tiny[small]
            g3[at], g4[at] = _responses(w[at], x[small], zeta, s4[small], c4[small])
            y += sin * g3
            y -= cos * g4
            v += ((c - g4) * sin - g3 * cos) * w
            drive += sin * sinw
            drive -= cos * cosm
            drive_rate += ((1.0 - cosm) * sin - cos * sinw) * w
        if self.ramp is not None:
            ramp = s - h + 2.0 * zeta * c
            ramp[tiny] = x**3 / 6.0 + (s4 + 2.0 * zeta * c4)  # terms in h^2 cancel
            y, v = y + self.ramp * ramp, v + self.ramp * c
            drive, drive_rate = drive + self.ramp * h, drive_rate + self.ramp
        b = drive + self.b + y - v * (2.0 * zeta)
        return Point(y + self.y, v, b, drive_rate + v - b * (2.0 * zeta))


def _responses(w: Array, h: Array, zeta: float, s4: Array, c4: Array) -> tuple[Array, Array]:
    """G3 and G4 for small h and w h, from the terms of S and C from h^4 on. Each difference omits its lower powers, which cancel."""
    x2 = (w * h) ** 2
    h3, cube = h**3 / 6.0, w * h * x2 / 6.0
    sine5 = -cube * x2 * np.polyval(_ODD, -x2) / 20.0  # x - sin x - x^3/6
    cosine4 = x2 * x2 * np.polyval(_EVEN, -x2) / 24.0  # cos x - 1 + x^2/2
    w1, cross = 1.0 + w * w, 2.0 * zeta * w
    d = w1 * w1 + cross * cross
    lag3 = w * (h3 * (1.0 + 4.0 * zeta * zeta) + s4) + (cube + sine5)
    g3 = (w1 * lag3 + cross * (c4 - 2.0 * zeta * h3 - cosine4)) / d
    g4 = ((d - w1) * c4 + w1 * cosine4 + cross * (w * s4 + sine5)) / d
    return g3, g4


# Of 20 (x^3/6 - x + sin x)/(x^5/6) and 24 (cos x - 1 + x^2/2)/x^4 in powers of -x^2, the last first.
_ODD, _EVEN = ([math.factorial(k) / math.factorial(2 * n + k) for n in range(6, -1, -1)] for k in (5, 4))


@lru_cache(maxsize=64)
def _coefficients(zeta: float) -> tuple[list[float], list[float]]:
    """Coefficients of S and C from h^4 on, the last first: (n + 1)(n + 2) s_(n+2) = s_n - 2 zeta (n + 1) s_(n+1), c_n = s_(n-1)/n."""
    s = [0.0, 1.0]
    for n in range(_TERMS - 1):
        s.append((s[n] - 2.0 * zeta * (n + 1) * s[n + 1]) / ((n + 1) * (n + 2)))
    c = [0.0, *(s[n - 1] / n for n in range(1, len(s)))]
    return s[:3:-1], c[:3:-1]
