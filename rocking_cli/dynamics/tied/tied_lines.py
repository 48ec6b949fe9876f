"""Whole lines of a record, as `march.whole_lines` has them, for tied bodies:
y stays on the present branch of the restraints, no peak is the largest of the body or
of a restraint, and the largest speed and acceleration leave Fz > 0 (as in
`contact_watch`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..march.whole_lines import LineEnd, LineLimits, OnLines, WholeLines
from .carried import carry
from .devices import BROKEN, Devices
from .series import HeldBody
from .tied_lanes import OnBranch, TiedLanes

LEAST_LINES = 100  # under fewer lines every line goes through a round


@dataclass
class TiedLimits(LineLimits):
    """Limits within which nothing happens to tied bodies. Every array is (lanes,)."""

    top: Array  # y beyond which the march asks whether the body overturns
    unit: Array  # rotation of y = 1 [rad]
    alpha: Array  # critical angle [rad]
    # m R^2/I times the unit [rad]; 0 for lanes whose contact is not watched
    kappa: Array

    def hold(self, y: Array, first: Array, end: LineEnd, h: Array) -> Array:
        """As `LineLimits.hold`."""
        holds = super().hold(y, first, end, h)
        # Fz > 0, where |z| is at most alpha or theta - alpha.
        over = 1.0 / (h * h)
        centripetal = self.unit * end.speed * end.speed * over
        highest = np.maximum(y, end.y) + 0.125 * end.acceleration
        lean = np.maximum(self.alpha, self.unit * highest - self.alpha)
        downwards = lean * end.acceleration * over + centripetal
        holds &= self.kappa * downwards < 1.0
        return holds & ((end.y <= self.top) | (end.first <= 0.0))


class TiedLines(WholeLines):
    """Takes tied bodies over the lines of a record."""

    def __init__(self, batch: Batch, devices: Devices) -> None:
        super().__init__(batch)
        self.devices = devices

    def along(self, lanes: TiedLanes, branch: OnBranch, top: Array) -> None:
        """Take lanes over lines that are clear, in place.

        branch: of the restraints; top: as of `TiedLimits`, (lanes,).
        """
        at = self.in_the_air(lanes)
        limits = self._limits(lanes, branch, top).take(at)
        pull = self.devices.linear_terms(branch.row, branch.now)

        def law(some: OnLines) -> HeldBody:
            return self._held(some, branch.take(some.lane))

        on_lines = self.on_lines(lanes, at, limits, tuple(x[at] for x in pull))
        behind = self.over(on_lines, law)
        at = behind.lane
        gone = lanes.take(at)
        held, ends = self._held(gone, branch.take(at)), (behind.y, behind.v)
        carry(gone, held, ends, behind.time, self.least * behind.time)
        lanes.moments[:, at] = gone.moments
        self.put(lanes, behind)
        lanes.exact[at] = False

    def _held(self, lanes: OnLines | TiedLanes, branch: OnBranch) -> HeldBody:
        equation = self.batch.equation.on(lanes.side, lanes.cell)
        return HeldBody.of(equation, self.devices, branch.row, branch.now)

    def _limits(self, lanes: TiedLanes, branch: OnBranch, top: Array) -> TiedLimits:
        """The limits of lanes on a branch; top: as of `TiedLimits`."""
        row, now, ones = branch.row, branch.now, np.ones(lanes.y.size)
        unit, alpha, kappa = ones, ones, 0.0 * ones
        if self.devices.body is not None:
            edge = self.devices.body.on(lanes.side, lanes.cell)
            unit, alpha = edge.unit * ones, edge.alpha * ones
            kappa = np.where(lanes.lost, 0.0, edge.kappa * unit)
        # A broken restraint is not stretched any more.
        here = row % self.devices.sides, slice(None), np.arange(row.size)
        farthest, broken = lanes.farthest[here].T, lanes.branch[here].T == BROKEN
        stretched = np.where(broken, np.inf, self.devices.level(row, farthest))
        known = np.minimum(lanes.peak, stretched.min(axis=0))
        return TiedLimits(
            branch.low,
            branch.high,
            np.where(now.yields, -1.0, known),
            top,
            unit,
            alpha,
            kappa,
        )
