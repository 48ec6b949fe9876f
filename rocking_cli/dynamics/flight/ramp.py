"""The linear oscillator within one interval between samples, where the drive is a ramp: a(h) = a(0) + r h."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..equations.equation import Point

Array = np.ndarray

_SERIES = [6.0 / math.factorial(2 * n + 3) for n in range(7)]  # of 6 (sinh h - h)/h^3 in h^2: complete to 1e-17 up to h = 0.5


def hyperbolic(h: Array) -> tuple[Array, Array, Array]:
    """sinh h, cosh h - 1 and sinh h - h for 0 <= h <= 0.5, to the last digits of each."""
    h2 = h * h
    ramp = np.full(h.shape, _SERIES[-1])
    for c in _SERIES[-2::-1]:
        ramp *= h2
        ramp += c
    ramp *= h2
    ramp *= h
    ramp *= 1.0 / 6.0
    sinh = h + ramp
    cosh1 = sinh * sinh
    cosh1 /= 1.0 + np.sqrt(1.0 + cosh1)
    return sinh, cosh1, ramp


class RampFlow(NamedTuple):
    """One arc a lane: the state at its start and the rate r of the outward drive, (lanes,)."""

    y: Array
    v: Array
    b: Array
    rate: Array

    @property
    def damping(self) -> float:
        """None."""
        return 0.0

    @property
    def longest(self) -> Array:
        """Longest step [tau] for which `hyperbolic` is good."""
        return np.full(self.y.shape, 0.5)

    @property
    def fastest(self) -> Array:
        """Rate at which the arc bends."""
        return np.ones(self.y.shape)

    def take(self, lanes: Array) -> RampFlow:
        """The arcs of some lanes."""
        return RampFlow(self.y[lanes], self.v[lanes], self.b[lanes], self.rate[lanes])

    def at(self, h: Array) -> Point:
        """The state after 0 <= h <= 0.5, exact up to rounding: the state at the start and increments."""
        sinh, cosh1, ramp = hyperbolic(h)
        change = self.v * sinh
        change += self.b * cosh1
        ramp *= self.rate
        change += ramp
        v = self.v + self.rate
        v *= cosh1
        sinh *= self.b
        v += sinh
        v += self.v
        return Point(self.y + change, v, self.b + change + self.rate * h, v + self.rate)

    def at_ground(self, h: Array) -> Array:
        """The force at an impact, where y = 0."""
        return self.b - self.y + self.rate * h
