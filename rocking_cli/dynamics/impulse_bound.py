"""Lemma 9: which bodies the rest of a motion cannot overturn, by the integral of the
drive that is still to come.
"""

from typing import NamedTuple, Self

import numpy as np

from ..arrays import Array
from ..motions.segments import Segments
from .drive import RemainingImpulse
from .equations.equation import Equation
from .lanes import Cells, Lanes

_SAFE_SHARE = 1.0 - 1e-9


class ImpulseBound(NamedTuple):
    """The bound of Lemma 9 for undamped cells under a steady weight."""

    remaining: RemainingImpulse  # int |s| dphi to come
    # c: unit of speed of each side in which no impact raises the speed [-], (1, cells)
    # for sides that are alike, otherwise (2, cells)
    unit: Array
    # largest growth of c times the speed at the ground, over int |s| dphi, (cells,)
    growth: Array
    # least c times the speed at the ground of a body that just overturns, (cells,)
    least: Array

    @classmethod
    def of(cls, equation: Equation, cells: Cells, segments: Segments) -> Self:
        """Build the bound of these cells under a motion."""
        cell = np.arange(cells.omega.shape[1])
        bounds = []
        for side in (1.0, -1.0)[: len(cells.omega)]:
            edge = equation.on(np.full(cell.size, side), cell)
            bounds.append((np.sqrt(2.0 * edge.barrier), edge.largest_m))
        speed, push = (
            np.array([np.broadcast_to(x, cell.size) for x in found])
            for found in zip(*bounds, strict=True)
        )
        unit = np.ones(cells.omega.shape)
        with np.errstate(divide="ignore"):
            unit[1:] = np.clip(1.0, cells.eta[1:], 1.0 / cells.eta[:1])
        growth = unit * (cells.amplitude / cells.omega) * push
        return cls(
            RemainingImpulse.of(segments),
            unit,
            growth.max(axis=0),
            (unit * speed).min(axis=0),
        )

    def cannot_overturn(self, cells: Cells, lanes: Lanes) -> Array:
        """True for lanes at y = 0 that the rest of the motion cannot overturn."""
        cell = lanes.cell
        to_come = self.growth[cell] * self.remaining.after(lanes.segment, lanes.phase)
        speed = self.unit[cells.row(lanes.side), cell] * np.abs(lanes.v)
        return np.asarray(to_come < _SAFE_SHARE * (self.least[cell] - speed))
