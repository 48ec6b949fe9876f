"""Lanes of the march, the state of many rocking bodies as arrays of one length; and the drive of each cell on its sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .arrays import Arrays

Array = np.ndarray


class Cells(NamedTuple):
    """The drive of each cell, a row a side: (1, cells) if the sides are alike, else (2, cells): right edge (theta > 0), left edge.

    amplitude: over the side's uplift acceleration; omega: omega_g / p of the side; eta: speed after over speed before an impact on leaving
    the side, both in the sides' own units.
    """

    amplitude: Array
    omega: Array
    eta: Array

    def row(self, side: Array) -> Array | int:
        """The row of a side, +1 or -1."""
        return 0 if len(self.amplitude) == 1 else (side < 0.0).astype(np.int64)


@dataclass
class Lanes(Arrays):
    """One body a lane. The side is stored, never inferred from a sign.

    cell: index of the cell; amplitude, omega, eta: of the present side (`Cells`); k, u: segment of the motion and phase in it; side: +1
    or -1; y, v: displacement in the unit of the side and its derivative by the tau of the side; b: the force y'' + 2 zeta y'; peak:
    largest y at a turning point so far, in the unit of the present side; impacts, steps: numbers so far.
    """

    cell: Array
    amplitude: Array
    omega: Array
    eta: Array
    k: Array
    u: Array
    side: Array
    y: Array
    v: Array
    b: Array
    peak: Array
    impacts: Array
    steps: Array
