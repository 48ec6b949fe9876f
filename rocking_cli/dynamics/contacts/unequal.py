"""A body whose two edges differ: each side has its own p, alpha and uplift, and an impact passes between their units.

With y = |theta| over its unit and tau = p t on each side, an impact multiplies the speed y' by eta_12 (unit_1 p_1)/(unit_2 p_2), which
may exceed 1; eta_12 eta_21 < 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...motions.segments import Segments
from ..equations.equation import Equation
from ..lanes import Cells, Lanes
from .contact import Bounce, Fate, Uplift, bouncing_ends, bouncing_time, first_uplift

Array = np.ndarray


def exchange(one: float, other: float) -> tuple[float, float]:
    """one/other and other/one of positive units, to a few roundings: their product is 1 to every digit, so that impacts which take nothing
    take nothing in these units either."""
    there, back = one / other, other / one
    while 0.0 < abs(there * back - 1.0) < 1.0:
        there = math.nextafter(there, math.inf)
        back = 1.0 / there
    return there, back


@dataclass(frozen=True)
class Unequal:
    """What turns A = 1 and Omega = 1 of a reference into the units of each edge, (right, left).

    drive: amplitude over the edge's uplift; omega: omega_g over the edge's p; eta: speed y' after over y' before on leaving the
    edge; rotation: |theta|/alpha of y = 1; pace: |theta'| of d(|theta|/alpha)/dtau = 1 over that of the reference. Raises ValueError
    when a number is out of range.
    """

    drive: tuple[float, float]
    omega: tuple[float, float]
    eta: tuple[float, float]
    rotation: tuple[float, float]
    pace: tuple[float, float] = (1.0, 1.0)

    alike = False

    def __post_init__(self) -> None:
        if not all(x > 0.0 for x in (*self.drive, *self.omega, *self.rotation, *self.pace)):
            raise ValueError("drive, omega, rotation and pace of both edges must be positive")
        if not (min(self.eta) >= 0.0 and self.eta[0] * self.eta[1] <= 1.0):
            raise ValueError("eta of both edges must be from 0, and their product at most 1")

    def _of(self, pair: tuple[float, float], side: Array) -> Array:
        return np.where(side > 0.0, *pair)

    def cells(self, equation: Equation, amplitude: Array, omega: Array, eta: Array) -> Cells:
        """A row for each edge; eta is this body's own, whatever the cells say."""
        drive, frequency, own = (np.array(pair)[:, None] for pair in (self.drive, self.omega, self.eta))
        return Cells(drive * amplitude, frequency * omega, np.broadcast_to(own, (2, omega.size)))

    def strongest(self, cells: Cells, segments: Segments) -> Array:
        """-A min s on the right edge or A max s on the left, whichever is more."""
        return np.maximum(cells.amplitude[0] * -segments.later_min[0], cells.amplitude[1] * segments.later_max[0])

    def uplift(self, cells: Cells, segments: Segments, cell: Array, k: Array, u: Array) -> Uplift:
        """On to whichever edge is reached first."""
        return first_uplift(segments, k, u, cells.amplitude[0, cell], cells.amplitude[1, cell])

    def turn(self, cells: Cells, lanes: Lanes, at: Array, side: Array) -> None:
        """Drive, time and restitution are the new side's, and the peak is in its unit."""
        lanes.peak[at] *= self._of(self.rotation, lanes.side[at]) / self._of(self.rotation, side)
        lanes.side[at] = side
        row, cell = cells.row(side), lanes.cell[at]
        lanes.amplitude[at], lanes.omega[at], lanes.eta[at] = (values[row, cell] for values in cells)

    def speed(self, side: Array, rate: Array) -> Array:
        """In units of the reference."""
        return rate * self._of(self.pace, side)

    def strike(self, cells: Cells, lanes: Lanes, v: Array, b: Array) -> None:
        """The side flips; drive, time and unit become those of the other edge."""
        lanes.v = -lanes.eta * v
        # b = -1 + a at y = 0; a changes sign, and is measured by the other edge's uplift
        lanes.b = -1.0 - (1.0 + b) * (self._of(self.drive, -lanes.side) / self._of(self.drive, lanes.side))
        self.turn(cells, lanes, np.arange(lanes.side.size), -lanes.side)

    def bouncing_ends(self, segments: Segments, lanes: Lanes, equation: Equation) -> Array:
        """The other side of a bounce is the other edge."""
        return bouncing_ends(segments, lanes, equation, self._bounce(lanes))

    def bouncing_time(self, lanes: Lanes, weight: Array | float = 1.0) -> Array:
        """As `bouncing_ends` sums it."""
        return bouncing_time(lanes, self._bounce(lanes), weight)

    def _bounce(self, lanes: Lanes) -> Bounce:
        here, there = lanes.side, -lanes.side
        drive, omega, rotation = (self._of(pair, there) / self._of(pair, here) for pair in (self.drive, self.omega, self.rotation))
        return Bounce(drive, omega, lanes.eta, self._of(self.eta, there), np.maximum(1.0, rotation))

    def fate(self, equation: Equation, lanes: Lanes, at: Array, y: Array, v: Array) -> Fate:
        """Two impacts decide: the arc on the other edge, then one on this edge again; after them each is lower than the one before
        on its own edge, since eta_12 eta_21 <= 1."""
        side = lanes.side[at]
        here, there = equation.on(side), equation.on(-side)
        overturns, energy = here.fall(y, v)
        across = lanes.eta[at] ** 2 * energy
        again = self._of(self.eta, -side) ** 2 * across
        after = ~overturns & ((across > there.barrier) | (again > here.barrier))
        outward = np.where(v > 0.0, here.crest(energy), y)
        unit = self._of(self.rotation, -side) / self._of(self.rotation, side)
        peak = np.maximum(np.maximum(outward, here.crest(again)), there.crest(across) * unit)
        return Fate(overturns, after, np.where(overturns | after, np.nan, peak))
