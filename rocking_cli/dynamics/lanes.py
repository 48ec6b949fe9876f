"""Lanes of the march: the state of many rocking bodies, as arrays of one length; and what each cell asks of its sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .arrays import Arrays

Array = np.ndarray


class Cells(NamedTuple):
    """What drives each cell, a row a side: (1, cells) where the sides are alike, else (2, cells), right edge and left edge.

    The right edge is the one of theta > 0. amplitude: the drive's, in units of the side's uplift acceleration; omega:
    omega_g / p of the side; eta: speed after over speed before an impact on leaving the side, both in the sides' own units.
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

    cell: index of the cell; amplitude, omega, eta: those of the side the body is on (`Cells`); k, u: position in the motion
    (segment, phase in it); side: +1 or -1; y, v: displacement on that side in its own unit and its derivative by its own tau;
    b: the force, y'' less what damping takes; peak: largest y at a turning point so far, in the unit of the present side;
    impacts, steps: numbers so far.
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
