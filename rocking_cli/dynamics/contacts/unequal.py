"""A body whose two edges differ: each side has its own p, alpha and uplift, and an impact passes between their units.

With y = |theta| over its unit and tau = p t on each side, an impact multiplies the speed y' by eta_12 (unit_1 p_1)/(unit_2 p_2), which
may exceed 1; eta_12 eta_21 < 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..equations.equation import Equation
from ..lanes import Cells, Lanes
from .contact import Contact
from .sequences import OtherSide

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
class Unequal(Contact):
    """A = 1 and Omega = 1 of a reference in the units of each edge, (right, left).

    drive: amplitude over the edge's uplift; omega: omega_g over the edge's p; eta: speed y' after over y' before on leaving the
    edge; rotation: |theta|/alpha of y = 1; pace: |theta'| of d(|theta|/alpha)/dtau = 1 over that of the reference. Raises ValueError
    when a number is out of range.
    """

    drive: tuple[float, float]
    omega: tuple[float, float]
    eta: tuple[float, float]
    rotation: tuple[float, float]
    pace: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        if not all(x > 0.0 for x in (*self.drive, *self.omega, *self.rotation, *self.pace)):
            raise ValueError("drive, omega, rotation and pace of both edges must be positive")
        if not (min(self.eta) >= 0.0 and self.eta[0] * self.eta[1] <= 1.0):
            raise ValueError("eta of both edges must be from 0, and their product at most 1")

    def _of(self, pair: tuple[float, float], side: Array) -> Array:
        return np.where(side > 0.0, *pair)

    def cells(self, equation: Equation, amplitude: Array, omega: Array, eta: Array) -> Cells:
        """A row for each edge; eta is this body's own, the cells' is ignored."""
        drive, frequency, own = (np.array(pair)[:, None] for pair in (self.drive, self.omega, self.eta))
        return Cells(drive * amplitude, frequency * omega, np.broadcast_to(own, (2, omega.size)))

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

    def other_side(self, lanes: Lanes) -> OtherSide:
        """The other edge."""
        here, there = lanes.side, -lanes.side
        drive, omega, rotation = (self._of(pair, there) / self._of(pair, here) for pair in (self.drive, self.omega, self.rotation))
        return OtherSide(drive, omega, lanes.eta, self._of(self.eta, there), rotation)
