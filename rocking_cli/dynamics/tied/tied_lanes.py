"""The data of the march of tied bodies: its lanes, the ends of steps, a recorder of one
body, and the results.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from ..equations.taylor import TaylorSeries
from ..lanes import Array, Lanes
from ..outcome import Work
from .devices import Branch


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
    lost: Array  # True if Fz <= 0 has occurred


class StepEnds(NamedTuple):
    """What happens at the ends of steps. Every array is (lanes,)."""

    up: Array  # True if y has come to the upper end of the branch of the restraints
    # True if y has come to the lower end of the branch; the ground is a lower end
    down: Array
    peaked: Array  # True if y had a peak in the step
    bottom: Array  # True if the body turns outwards again
    top: Array  # y of the peak, in the unit of the side
    still: Array  # True if the shaking is over


class Recorder(Protocol):
    """Records the march of one body."""

    until: float  # phase of the motion up to which the march is recorded [rad]
    visible: float  # speed |y'| down to which each bounce is recorded

    def keep(self, lanes: Lanes, arc: TaylorSeries, reach: float, now: Branch) -> None:
        """Record an arc that lasts `reach` [tau] from the state of the lanes, with the
        force law of the devices on it.
        """

    def note(
        self, lanes: Lanes, event: str, y: float, v: float, device: str = ""
    ) -> None:
        """Record an event at the present position of the lanes in the motion."""

    def rest(self, before: TiedLanes, after: TiedLanes, bounces: float) -> None:
        """Record a rest until the next uplift, after `bounces` [tau] of bouncing that
        follow an impact.
        """


@dataclass(frozen=True)
class Found:
    """Results of cells."""

    outcome: Array  # codes of `Outcome`, as in `Response`, (cells,)
    theta_ratio: Array  # max |theta|/alpha [-], as in `Response`, (cells,)
    impacts: Array  # number of impacts during the shaking, as in `Response`, (cells,)
    steps: Array  # number of steps, (cells,)
    # branch of the force law of each device at the end of the march, (sides, devices,
    # cells)
    branch: Array
    # permanent elongation of each device then [m], (sides, devices, cells)
    plastic: Array
    farthest: Array  # largest elongation of each device [m], (sides, devices, cells)

    @property
    def work(self) -> Work:
        """The counters of the march."""
        return Work(
            cells=self.outcome.size,
            impacts=int(self.impacts.sum()),
            steps=int(self.steps.sum()),
        )
