"""Exact flow of the linear rocking oscillator with viscous damping, for drives that are sums of sinusoids and a ramp.

    y'' + 2 zeta y' - y = -1 + a

The roots of r^2 + 2 zeta r - 1 = 0 take the place of +1 and -1. With k = sqrt(1 + zeta^2), S = exp(-zeta h) sinh(k h)/k and
C = int S dh (sinh h and cosh h - 1 without damping), the force f and a(h) = a(0) + sum_j [S_j sin(w_j h) - C_j (1 - cos(w_j h))] + r h,

    y(h) = y0 + v0 S + f C + sum_j [S_j G3(w_j, h) - C_j G4(w_j, h)] + r (S - h + 2 zeta C)
    G3 = [(1 + w^2)(w S - sin(w h)) + 2 zeta w (C + 1 - cos(w h))] / D,           D = (1 + w^2)^2 + 4 zeta^2 w^2
    G4 = [(D - 1 - w^2) C - (1 + w^2)(1 - cos(w h)) + 2 zeta w (w S - sin(w h))] / D

As in `flow`, increments of small arguments come from their series.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .equation import Point
from .flow import SMALL

Array = np.ndarray

_TERMS = 18  # of a series at SMALL: what is left out is below 1e-17 of its sum for zeta up to 1


class DampedFlow(NamedTuple):
    """One arc a lane, as `LinearFlow`; b is the force at its start and damping is zeta."""

    y: Array
    v: Array
    b: Array
    sin: Array
    cos: Array
    w: Array
    ramp: Array | None
    damping: float

    @property
    def longest(self) -> Array:
        """Longest step [tau]: growth is slower than without damping."""
        return np.full(self.y.shape, 24.0)

    @property
    def fastest(self) -> Array:
        """Rate at which the arc bends: the mode that decays, or the fastest drive over p."""
        return 1.0 + 2.0 * self.damping + self.w.max(axis=0, initial=0.0)

    def take(self, lanes: Array) -> DampedFlow:
        """The arcs of some lanes."""
        ramp = None if self.ramp is None else self.ramp[lanes]
        sin, cos, w = self.sin[:, lanes], self.cos[:, lanes], self.w[:, lanes]
        return DampedFlow(self.y[lanes], self.v[lanes], self.b[lanes], sin, cos, w, ramp, self.damping)

    def at(self, h: Array) -> Point:
        """The state after h >= 0 [-], exact up to rounding."""
        zeta = self.damping
        k = math.sqrt(1.0 + zeta * zeta)
        decay, sinh, cosh = np.exp(-zeta * h), np.sinh(k * h) / k, np.cosh(k * h)
        s, rate_s = decay * sinh, decay * (cosh - zeta * sinh)
        c = decay * (cosh + zeta * sinh) - 1.0
        tiny = np.flatnonzero(h < SMALL)
        if tiny.size:
            c[tiny] = _increment(h[tiny], zeta, [1.0])
        y, v = self.y + (self.v * s + self.b * c), self.v * rate_s + self.b * s
        drive, drive_rate = np.zeros(h.shape), np.zeros(h.shape)
        for sin, cos, w in zip(self.sin, self.cos, self.w, strict=True):
            wh, w2 = w * h, w * w
            t = np.tan(0.5 * wh)
            cosm = 2.0 * t * t / (1.0 + t * t)
            sinw = 2.0 * t / (1.0 + t * t)
            d = (1.0 + w2) ** 2 + (2.0 * zeta * w) ** 2
            lag, cross = w * s - sinw, 2.0 * zeta * w
            g3 = ((1.0 + w2) * lag + cross * (c + cosm)) / d
            g4 = ((d - 1.0 - w2) * c - (1.0 + w2) * cosm + cross * lag) / d
            small = np.flatnonzero(np.maximum(h, wh) < SMALL)
            if small.size:
                g3[small] = _increment(h[small], zeta, _wave(wh[small], 1))
                g4[small] = _increment(h[small], zeta, _wave(wh[small], 2))
            y += sin * g3 - cos * g4
            v += w * (sin * (c - g4) - cos * g3)
            drive += sin * sinw - cos * cosm
            drive_rate += w * (sin * (1.0 - cosm) - cos * sinw)
        if self.ramp is not None:
            ramp = s - h + 2.0 * zeta * c
            if tiny.size:
                ramp[tiny] = _increment(h[tiny], zeta, [0.0, h[tiny]])
            y, v = y + self.ramp * ramp, v + self.ramp * c
            drive, drive_rate = drive + self.ramp * h, drive_rate + self.ramp
        b = self.b + (y - self.y) + drive - 2.0 * zeta * v
        return Point(y, v, b, v + drive_rate - 2.0 * zeta * b)

    def at_ground(self, h: Array) -> Array:
        """The force at an impact, where y = 0, from the change of the drive since the start."""
        total = self.b - self.y if self.ramp is None else self.b - self.y + self.ramp * h
        for s, c, w in zip(self.sin, self.cos, self.w, strict=True):
            t = np.tan(0.5 * (w * h))
            total = total + 2.0 * t * (s - c * t) / (1.0 + t * t)
        return total


def _wave(x: Array, first: int) -> list[Array | float]:
    """Terms of sin x (first = 1) or of 1 - cos x (first = 2), by their power."""
    terms: list[Array | float] = [0.0] * (_TERMS + 1)
    terms[first] = x if first == 1 else 0.5 * x * x
    for n in range(first, _TERMS - 1, 2):
        terms[n + 2] = terms[n] * x * x * (-1.0 / ((n + 1) * (n + 2)))
    return terms


def _increment(h: Array, zeta: float, drive: list[Array | float]) -> Array:
    """y(h) from rest, y'' + 2 zeta y' - y = a, by the recurrence of its series; drive: terms of a, each with its power of h."""
    before, last = np.zeros_like(h), np.zeros_like(h)
    total = np.zeros_like(h)
    for n in range(_TERMS):
        push = before + drive[n] if n < len(drive) else before
        before, last = last, (h * h * push / (n + 1) - 2.0 * zeta * h * last) / (n + 2)
        total = total + last
    return total
