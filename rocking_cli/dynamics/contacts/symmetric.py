"""A body whose two edges are alike: it rocks from one to the other, and an impact takes the part 1 - eta of its speed (Eq. 2.6)."""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..equations.equation import Equation
from ..lanes import Cells, Lanes
from .contact import Bounce, Fate, Uplift, bouncing_ends, bouncing_time, first_uplift, free_motion

Array = np.ndarray


class Symmetric:
    """eta within [0, 1], of each cell."""

    alike = True

    def cells(self, equation: Equation, amplitude: Array, omega: Array, eta: Array) -> Cells:
        """One row for both sides."""
        if not np.all((eta >= 0.0) & (eta <= 1.0)):
            raise ValueError("eta must be within [0, 1]")
        return Cells((amplitude / equation.uplift_amplitude)[None], omega[None], eta[None])

    def strongest(self, cells: Cells, segments: Segments) -> Array:
        """A max|s|."""
        return cells.amplitude[0] * max(segments.later_max[0], -segments.later_min[0])

    def uplift(self, cells: Cells, segments: Segments, cell: Array, k: Array, u: Array) -> Uplift:
        """At A |s| > 1, on the side -sgn s."""
        amplitude = cells.amplitude[0, cell]
        return first_uplift(segments, k, u, amplitude, amplitude)

    def turn(self, cells: Cells, lanes: Lanes, at: Array, side: Array) -> None:
        """Only the side changes."""
        lanes.side[at] = side

    def speed(self, side: Array, rate: Array) -> Array:
        """There is one unit."""
        return rate

    def strike(self, cells: Cells, lanes: Lanes, v: Array, b: Array) -> None:
        """The side flips, and with it the sign of the drive."""
        lanes.side = -lanes.side
        lanes.v = -lanes.eta * v
        lanes.b = -2.0 - b  # b = -1 + a at y = 0, and a changes sign

    def bouncing_ends(self, segments: Segments, lanes: Lanes, equation: Equation) -> Array:
        """The other side of a bounce is like this one."""
        return bouncing_ends(segments, lanes, equation, self._bounce(lanes))

    def bouncing_time(self, lanes: Lanes, weight: Array | float = 1.0) -> Array:
        """2 v / (1 - eta^2) [1/(1 - a) + eta/(1 + a)]."""
        return bouncing_time(lanes, self._bounce(lanes), weight)

    def _bounce(self, lanes: Lanes) -> Bounce:
        return Bounce(1.0, 1.0, lanes.eta, lanes.eta, 1.0)

    def fate(self, equation: Equation, lanes: Lanes, at: Array, y: Array, v: Array) -> Fate:
        """Eq. 2.7."""
        return free_motion(equation, lanes, at, y, v)
