"""Whole lines of a record, as `march.whole_lines` has them, for tied bodies:
y stays on the present branch of the restraints, and no peak is the largest of the body
or of a restraint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..march.whole_lines import LineEnd, LineLimits, OnLines, WholeLines
from ..observers.observer import Observer
from .carried import carry
from .devices import BROKEN, Devices
from .series import HeldBody
from .tied_lanes import OnBranch, TiedLanes

LEAST_LINES = 100  # under fewer lines every line goes through a round


@dataclass
class TiedLimits(LineLimits):
    """Limits within which nothing happens to tied bodies. Every array is (lanes,)."""

    top: Array  # y beyond which the march asks whether the body overturns

    def hold(self, y: Array, first: Array, end: LineEnd, h: Array) -> Array:
        """As `LineLimits.hold`."""
        holds = super().hold(y, first, end, h)
        return holds & ((end.y <= self.top) | (end.first <= 0.0))


class TiedLines(WholeLines):
    """Takes tied bodies over the lines of a record."""

    def __init__(
        self, batch: Batch, devices: Devices, observers: Sequence[Observer]
    ) -> None:
        super().__init__(batch, observers)
        self.devices = devices

    def along(self, lanes: TiedLanes, branch: OnBranch, top: Array) -> None:
        """Take lanes over lines that are clear, in place.

        branch: of the restraints; top: as of `TiedLimits`, (lanes,).
        """
        at = self.in_the_air(lanes)
        limits = self._limits(lanes, branch, top).take(at)

        def law(some: OnLines) -> HeldBody:
            return self._held(some, branch.take(some.lane))

        pull = tuple(x[at] for x in self.devices.linear_terms(branch.row, branch.now))
        behind = self.over(self.on_lines(lanes, at, limits, law, pull))
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
        row, now = branch.row, branch.now
        # A broken restraint is not stretched any more.
        here = self.devices.place(row)
        farthest, broken = lanes.farthest[here].T, lanes.branch[here].T == BROKEN
        stretched = np.where(broken, np.inf, self.devices.level(row, farthest))
        known = np.minimum(lanes.peak, stretched.min(axis=0))
        known = np.where(now.yields, -1.0, known)
        return TiedLimits(branch.low, branch.high, known, top)
