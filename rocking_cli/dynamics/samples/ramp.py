"""The linear oscillator within one interval between samples, where the drive is a ramp: a(h) = a(0) + r h."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Arrays
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


@dataclass
class RampFlow(Arrays):
    """One arc a lane: the state at its start and the rate r of the outward drive, (lanes,)."""

    y: Array
    v: Array
    b: Array
    rate: Array
    damping: float = 0.0

    @property
    def longest(self) -> Array:
        """Longest step [tau] for which `hyperbolic` is good."""
        return np.full(self.y.shape, 0.5)

    @property
    def fastest(self) -> Array:
        """Rate at which the arc bends."""
        return np.ones(self.y.shape)

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


def impact_guess(arc: RampFlow, end: Point, h: Array, low: Array, high: Array) -> Array:
    """A first guess inside the bracket: ballistic from the left where b < 0 at the start, else a step from the right; then the cubic."""
    y, v, b = arc.y, arc.v, arc.b
    left = (v + np.sqrt(v * v - 2.0 * b * y)) / -b
    slope = end.v
    right = h - end.y / (slope - 0.5 * end.y * end.b / slope)
    guess = np.where((b < 0.0) & (left < high) & (left > low), left, right)
    jerk = v + arc.rate  # what the cubic adds
    slope = v + guess * (b + 0.5 * guess * jerk)
    bend = b + guess * jerk
    short = (y + guess * (v + guess * (0.5 * b + guess * jerk * (1.0 / 6.0)))) / slope
    guess = guess - short / (1.0 - 0.5 * short * bend / slope)
    return np.where((guess > low) & (guess < high), guess, 0.5 * (low + high))
