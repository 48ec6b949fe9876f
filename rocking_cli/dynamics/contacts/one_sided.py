"""A body that is free for theta > 0 only, on its right edge: a facade against transverse walls (Sorrentino et al. 2011).

At theta = 0 it hits what stands behind it and returns on the same side with e times its speed, -1 < e <= 0; it lifts off only
outwards, and an inward drive presses it to its backing.
"""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..equations.equation import Equation
from ..lanes import Cells, Lanes
from .contact import Fate, Uplift, first_uplift, free_motion, settled_on_one_side

Array = np.ndarray


class OneSided:
    """eta is e, within (-1, 0], of each cell."""

    alike = False

    def cells(self, equation: Equation, amplitude: Array, omega: Array, eta: Array) -> Cells:
        """One row, of the right edge; the lanes' eta is -e."""
        if not np.all((eta > -1.0) & (eta <= 0.0)):
            raise ValueError("eta of a one-sided body must be within (-1, 0]")
        return Cells((amplitude / equation.uplift_amplitude)[None], omega[None], np.abs(eta)[None])

    def strongest(self, cells: Cells, segments: Segments) -> Array:
        """-A min s: only a ground acceleration towards the backing lifts it."""
        return cells.amplitude[0] * -segments.later_min[0]

    def uplift(self, cells: Cells, segments: Segments, cell: Array, k: Array, u: Array) -> Uplift:
        """At -A s > 1."""
        amplitude = cells.amplitude[0, cell]
        return first_uplift(segments, k, u, amplitude, np.zeros_like(amplitude))

    def turn(self, cells: Cells, lanes: Lanes, at: Array, side: Array) -> None:
        """There is one side."""

    def speed(self, side: Array, rate: Array) -> Array:
        """There is one unit."""
        return rate

    def strike(self, cells: Cells, lanes: Lanes, v: Array, b: Array) -> None:
        """Back on the same side, under the same force."""
        lanes.v = -lanes.eta * v
        lanes.b = b.copy()

    def bouncing_ends(self, segments: Segments, lanes: Lanes, equation: Equation) -> Array:
        """Every arc is on this side."""
        return settled_on_one_side(segments, lanes, equation)

    def bouncing_time(self, lanes: Lanes, weight: Array | float = 1.0) -> Array:
        """2 v / (1 - eta) / (1 - a)."""
        return 2.0 * lanes.v / (1.0 - lanes.eta) / -lanes.b

    def fate(self, equation: Equation, lanes: Lanes, at: Array, y: Array, v: Array) -> Fate:
        """The next arc is on this side too."""
        return free_motion(equation, lanes, at, y, v)
