"""What the march of tied bodies carries from event to event, tells a listener, and hands in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from ..equations.taylor import TaylorSeries
from ..lanes import Array, Lanes


@dataclass
class TiedLanes(Lanes):
    """Lanes of tied bodies. phase, plastic, farthest: of each device, its permanent and its largest elongation [m], (sides, devices,
    lanes); exact: True where y'' is exactly 0; bounced: True after an impact; turned: bits of the sides, 1 right and 2 left, on which the
    body has turned back on still ground; rests: True where it comes to rest; lost: True if Fz <= 0 was met."""

    phase: Array
    plastic: Array
    farthest: Array
    exact: Array
    bounced: Array
    turned: Array
    rests: Array
    lost: Array


class Ends(NamedTuple):
    """The ends of steps, (lanes,). up, down: True at the upper and at the lower end of a phase, which may be the ground; peaked: True if a
    peak was met, at `top`; bottom: True at a turn outwards; still: True on still ground."""

    up: Array
    down: Array
    peaked: Array
    bottom: Array
    top: Array
    still: Array


class Recorder(Protocol):
    """It sees the march of one body, which it follows up to a phase `until` [rad], and each bounce down to the speed `visible`."""

    until: float
    visible: float

    def keep(self, lanes: Lanes, arc: TaylorSeries, reach: float) -> None:
        """An arc of `reach` [tau] from the state of the lanes."""

    def note(self, lanes: Lanes, event: str, y: float, v: float, device: str = "") -> None:
        """An event at the place of the lanes."""

    def rest(self, before: Lanes, after: Lanes, bounces: float) -> None:
        """A rest, after bouncing for `bounces` [tau] from just after an impact on, to the next uplift."""


@dataclass(frozen=True)
class Found:
    """Results of cells. outcome, theta_ratio, impacts: as in `Response`; phase, plastic, farthest: of each device at the end, (sides,
    devices, cells)."""

    outcome: Array
    theta_ratio: Array
    impacts: Array
    steps: Array
    phase: Array
    plastic: Array
    farthest: Array
