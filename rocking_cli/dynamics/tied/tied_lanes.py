"""The data of the march of tied bodies: its lanes, the ends of steps, the results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from ...arrays import Array
from ..lanes import Cells, Lanes
from ..outcome import Work
from .devices import Branch

# a speed below this counts as zero: it changes y by about as much, and a later uplift
# by far less than rounding
STILL = 1e-20
# largest |y| of a touch over the peak: this part of the tolerance of y, or rounding
_TOUCH, _ROUNDING = 1e-2, 1e-13
_SIGNS = ("exact", "bounced", "rests")  # fields that are True or False


def touch_of(tolerance: float) -> float:
    """The largest |y| of a touch of the ground over the peak, at a tolerance of y."""
    return max(_ROUNDING, _TOUCH * tolerance)


@dataclass
class TiedLanes(Lanes):
    """Lanes of tied bodies; a device is a tie or the tendon on one side."""

    # branch of the force law that each device is on, as `devices` numbers them, (sides,
    # devices, lanes)
    branch: Array
    plastic: Array  # permanent elongation of each device [m], (sides, devices, lanes)
    farthest: Array  # largest elongation of each device [m], (sides, devices, lanes)
    exact: Array  # True where y'' is exactly 0
    bounced: Array  # True after an impact
    # turns back on still ground: 1 right, 2 left; 4 and 8 for a second turn there
    turned: Array
    rests: Array  # True where the body comes to rest
    # second moment of the error of y at which a restraint yielded (`carried`)
    yielded: Array

    @classmethod
    def slack(cls, cells: Cells, cell: Array, devices: Sequence[int]) -> Self:
        """Lanes of these cells at rest on the right at the start of the motion;
        devices: number of sides, and of devices on each.
        """
        none = np.zeros((*devices, cell.size))
        return cls.at_rest(
            cells,
            cell,
            np.ones(cell.size),
            branch=none.astype(np.int64),
            plastic=none,
            farthest=none.copy(),
            turned=np.zeros(cell.size, dtype=np.int64),
            yielded=np.zeros(cell.size),
            **{name: np.zeros(cell.size, bool) for name in _SIGNS},
        )


class OnBranch(NamedTuple):
    """The present branch of the restraints of lanes. Every array is (lanes,)."""

    row: Array  # row of its body and side in the arrays of `Devices`
    now: Branch  # the branch of each device
    low: Array  # y at its lower end, in the unit of the side; the ground is 0
    high: Array  # y at its upper end, or at the limit of y
    limit: Array  # y at which the body has fallen

    def take(self, at: Array) -> OnBranch:
        """Return these lanes only."""
        row, now, *ends = self
        return OnBranch(row[at], now.take(at), *(x[at] for x in ends))


class CutStep(NamedTuple):
    """Steps up to the events that end them. Every array is (lanes,)."""

    reach: Array  # time from the start to the end [tau]
    y: Array  # displacement at the end, in the unit of the side
    v: Array  # dy/dtau at the end
    top: Array  # y of the peak, or at the end without a peak on the way
    up: Array  # True if y comes to the upper end of the branch of the restraints
    down: Array  # True if y comes to its lower end; the ground is a lower end
    peaked: Array  # True if y has a peak in the step

    def without(self, lanes: Array) -> CutStep:
        """Return the steps, but that these lanes (True) do not move."""
        return CutStep(*(np.where(lanes, np.zeros((), x.dtype), x) for x in self))


@dataclass(frozen=True)
class Found:
    """Results of cells."""

    outcome: Array  # codes of `Outcome`, as in `Response`, (cells,)
    theta_ratio: Array  # max |theta|/alpha [-], as in `Response`, (cells,)
    impacts: Array  # number of impacts during the shaking, as in `Response`, (cells,)
    condition: Array  # condition of theta_ratio, as in `Response`, (cells,)
    steps: Array  # number of steps, (cells,)
    # branch of the force law of each device at the end of the march, (sides, devices,
    # cells)
    branch: Array
    # permanent elongation of each device then [m], (sides, devices, cells)
    plastic: Array
    farthest: Array  # largest elongation of each device [m], (sides, devices, cells)

    @classmethod
    def empty(cls, shape: tuple[int, ...]) -> Self:
        """Results of cells that are not computed yet; shape: (sides, devices,
        cells).
        """
        size = shape[-1]
        return cls(
            np.zeros(size, dtype=np.uint8),
            np.full(size, np.nan),
            np.zeros(size, dtype=np.int32),
            np.full(size, np.nan),
            np.zeros(size, dtype=np.int64),
            np.zeros(shape, dtype=np.int64),
            np.zeros(shape),
            np.zeros(shape),
        )

    @property
    def work(self) -> Work:
        """The counters of the march."""
        return Work(
            cells=self.outcome.size,
            impacts=int(self.impacts.sum()),
            steps=int(self.steps.sum()),
        )
