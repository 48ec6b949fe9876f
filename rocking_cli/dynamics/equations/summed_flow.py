"""Exact flow of the linear rocking oscillator for drives of many sinusoids: it separates the modes of y from the sums over the sinusoids.

The solution of `flow` is, with D_j = S_j/(1 + w_j^2) and E_j = C_j/(1 + w_j^2),

    y(h) = y0 + (v0 + P) sinh h + (b - Q) (cosh h - 1) + Y(h),   Y = sum_j [E_j (1 - cos(w_j h)) - D_j sin(w_j h)]
    P = sum_j w_j D_j,   Q = sum_j w_j^2 E_j

so an evaluation takes a sine and a cosine for each harmonic and four sums, and no F3 and F4. On a short arc these sums cancel; the
derivatives of the drive d_n = a^(n)(0) replace them there,

    y(h) = y0 + v0 sinh h + b (cosh h - 1) + sum_{m>=3} G_m h^m/m!,   G_m = d_(m-2) + G_(m-2),   G_1 = G_2 = 0
"""

import math
from typing import NamedTuple, Self

import numpy as np

from ...motions.segments import Segments
from ..drive import turn
from ..lanes import Array
from .equation import Point
from .taylor import powers

SHORT = 2.0  # where (1 + fastest w) h is below this, the derivatives of the drive give the arc
_PAIRS = 11  # of derivatives: the first power of h that is left out is below 1e-17 of the sum at SHORT
_WEIGHED, _PRODUCTS = "kj,jl->kl", "...jl,jl->...l"
_OVER = 1.0 / np.array([math.factorial(m) for m in range(2 * _PAIRS + 3)], dtype=float)[:, None]
_MOST_LOST = 100.0  # allowed loss by cancellation just above SHORT, in roundings of the drive's part of the motion


def can_be_summed(segments: Segments) -> bool:
    """True if all segments of a motion have the same sinusoids, with frequencies so close to each other that the sums keep their digits.
    The sums are of order sum |C| h/w, their result sum |C| w h^3/6 at small h, where h is at least SHORT over the fastest w."""
    alike = not segments.sloped and bool(np.all(segments.frequency == segments.frequency[:, :1]))
    return alike and 6.0 * segments.spread / SHORT**2 <= _MOST_LOST


class SummedFlow(NamedTuple):
    """One arc a lane: state at its start, (lanes,), and the drive's coefficients, (harmonics, lanes). The frequencies of all lanes have the
    same ratios, so that lanes share the weights of sums over powers of w."""

    y: Array
    v: Array
    b: Array
    sin: Array  # D_j
    cos: Array  # E_j
    top: Array  # the fastest angular frequency over p, (lanes,)
    p: Array  # P, (lanes,)
    q: Array  # Q, (lanes,)
    rate: Array  # slope of the drive at the start, (lanes,)
    weights: Array  # powers 0, 2, 1 and 3 of the ratios of the frequencies to the fastest, (4, harmonics)
    damping: float = 0.0

    @classmethod
    def of(cls, y: Array, v: Array, b: Array, sin: Array, cos: Array, top: Array, ratios: Array) -> Self:
        """Build the flow from the state and from the coefficients S_j and C_j of the drive."""
        sin, cos = (np.ascontiguousarray(x) for x in (sin, cos))  # else the order of the sums would be another
        w = ratios[:, None] * top
        over = 1.0 / (1.0 + w * w)
        sines, cosines = sin * over, cos * over
        ratios2 = ratios * ratios
        weights = np.array([np.ones(ratios.size), ratios2, ratios, ratios * ratios2])
        rate, p, q = (_summed(_WEIGHED, weights[i : i + 1], x)[0] for i, x in ((2, sin), (2, sines), (1, cosines)))
        return cls(y, v, b, sines, cosines, top, top * p, top * top * q, top * rate, weights)

    @property
    def fastest(self) -> Array:
        """Rate [1/tau] of the fastest change: 1 + the fastest frequency of the drive, (lanes,)."""
        return 1.0 + self.top

    @property
    def longest(self) -> Array:
        """Longest step [tau]: cosh stays below 2e10, so growth cannot bury the state in rounding."""
        return np.full(self.y.shape, 24.0)

    def take(self, lanes: Array) -> "SummedFlow":
        """Return the arcs of some lanes."""
        return SummedFlow._make([*(x.take(lanes, axis=-1) for x in self[:-2]), *self[-2:]])

    def at(self, h: Array) -> Point:
        """The state after h >= 0 [-]."""
        (short,) = (self.fastest * h < SHORT).nonzero()
        half = np.sinh(0.5 * h)
        half2 = half * half
        sinh, cosh1 = 2.0 * half * np.sqrt(1.0 + half2), 2.0 * half2
        if short.size == h.size:
            return self._short(h, sinh, cosh1)
        turned, turned_rate, curved, curved_rate = self._sums(*self._phases(h))
        out, up = self.v + self.p, self.b - self.q
        rise = out * sinh + up * cosh1
        found = Point(
            self.y + rise + turned,
            self.v + out * cosh1 + up * sinh + turned_rate,
            self.b + rise - curved,
            self.v + out * cosh1 + up * sinh + self.rate - curved_rate,
        )
        if short.size:
            for x, there in zip(found, self.take(short)._short(h[short], sinh[short], cosh1[short]), strict=True):
                x[short] = there
        return found

    def _phases(self, h: Array) -> tuple[Array, Array]:
        """(sin(w h), 1 - cos(w h)) of each harmonic."""
        return turn(self.weights[2][:, None] * (self.top * h))

    def _turned(self, sin: Array, cosm: Array) -> tuple[Array, Array]:
        """(Y, the sum of its terms times w^2)."""
        turned = self.cos * cosm
        turned -= self.sin * sin
        total, curved = _summed(_WEIGHED, self.weights[:2], turned)
        return total, curved * self.top * self.top

    def _sums(self, sin: Array, cosm: Array) -> tuple[Array, Array, Array, Array]:
        """(Y, Y', the sums of their terms times w^2)."""
        turned, curved = self._turned(sin, cosm)
        np.multiply(self.cos, sin, out=sin)
        sin += np.multiply(self.sin, cosm, out=cosm)
        rate, curved_rate = _summed(_WEIGHED, self.weights[2:], sin)
        return turned, rate * self.top, curved, curved_rate * self.top * self.top * self.top

    def _short(self, h: Array, sinh: Array, cosh1: Array) -> Point:
        """The state after a short h. d_n and G_m are over powers of the fastest w, so that no number grows large."""
        ratios2, ratios, share = self.weights[1], self.weights[2], self.top / self.fastest
        scale = ratios2[:, None] * (self.top * self.top)
        scale += 1.0
        scale *= ratios[:, None] * share  # (1 + w^2) w over the fastest
        turns = powers(-ratios2, _PAIRS)
        shares = powers(share * share, _PAIRS)
        d: Array = np.empty((_PAIRS, 2, h.size))  # (d_1, d_2), (d_3, d_4) ...
        g: Array = np.empty((_PAIRS, 2, h.size))  # (G_3, G_4), (G_5, G_6) ...
        d[:, 0] = _summed(_WEIGHED, turns, self.sin * scale)
        d[:, 1] = _summed(_WEIGHED, turns * -ratios, self.cos * scale) * share
        d *= shares[:, None]
        over2 = 1.0 / (self.fastest * self.fastest)
        np.multiply(d[0], over2, out=g[0])
        for i in range(1, _PAIRS):
            np.add(d[i], g[i - 1], out=g[i])
            g[i] *= over2
        x = powers(self.fastest * h, len(_OVER))
        x *= _OVER
        d, g = d.reshape(-1, h.size), g.reshape(-1, h.size)
        y, v = _summed(_PRODUCTS, g, x[3:]), _summed(_PRODUCTS, g, x[2:-1])
        drive, rate = _summed(_PRODUCTS, d, x[1:-2]), _summed(_PRODUCTS, d, x[:-3])
        y += self.v * sinh + self.b * cosh1
        v *= self.fastest
        v += self.v * cosh1 + self.b * sinh
        v += self.v
        return Point(self.y + y, v, self.b + y + drive, v + rate * self.fastest)

    def at_ground(self, h: Array) -> Array:
        """The force at an impact, where y = 0, computed from the change of the drive since the start."""
        turned, curved = self._turned(*self._phases(h))
        return self.b - self.y - turned - curved


def _summed(formula: str, one: Array, rows: Array) -> Array:
    """np.einsum over the terms of rows (..., terms, lanes), with weights or other rows; no lane's result depends on other lanes."""
    if rows.shape[-1] == 1:  # NumPy sums a single lane in another order: no digit may depend on a lane's neighbours
        return np.einsum(formula, one, np.repeat(rows, 2, axis=-1))[..., :1]
    return np.einsum(formula, one, rows)
