"""A body whose two edges are alike: it rocks from one to the other, and an impact takes the part 1 - eta of its speed (Eq. 2.6)."""

from __future__ import annotations

import numpy as np

from ..equations.equation import Equation
from ..lanes import Cells, Lanes
from .contact import Contact
from .sequences import OtherSide

Array = np.ndarray


class Symmetric(Contact):
    """eta within [0, 1], of each cell."""

    alike = True

    def cells(self, equation: Equation, amplitude: Array, omega: Array, eta: Array) -> Cells:
        """One row for both sides."""
        if not np.all((eta >= 0.0) & (eta <= 1.0)):
            raise ValueError("eta must be within [0, 1]")
        return Cells((amplitude / equation.uplift_amplitude)[None], omega[None], eta[None])

    def strike(self, cells: Cells, lanes: Lanes, v: Array, b: Array) -> None:
        """The side flips, and with it the sign of the drive."""
        lanes.side = -lanes.side
        lanes.v = -lanes.eta * v
        lanes.b = -2.0 - b  # b = -1 + a at y = 0, and a changes sign

    def other_side(self, lanes: Lanes) -> OtherSide:
        """The other side is like this one."""
        return OtherSide(1.0, 1.0, lanes.eta, lanes.eta, 1.0)
