"""A body that is free for theta > 0 only, on its right edge: a facade against transverse walls (Sorrentino et al. 2011).

At theta = 0 it hits its backing and returns on the same side with e times its speed, -1 < e <= 0; it lifts off only
outwards, and an inward drive presses it to its backing.
"""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..equations.equation import Equation
from ..lanes import Cells, Lanes
from .contact import Contact, Uplift, first_uplift

Array = np.ndarray


class OneSided(Contact):
    """eta is e, within (-1, 0], of each cell."""

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

    def strike(self, cells: Cells, lanes: Lanes, v: Array, b: Array) -> None:
        """Back on the same side, under the same force."""
        lanes.v = -lanes.eta * v
        lanes.b = b.copy()

    def other_side(self, lanes: Lanes) -> None:
        """Every arc is on this side."""
