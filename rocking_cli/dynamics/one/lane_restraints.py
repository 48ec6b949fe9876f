"""Ties and a tendon of one body on floats, before its march: what they do on each
branch of their force laws, by the arrays of one lane that `tied.transitions` changes.
"""

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..equations.straight_lines import growth_rate, size_limits
from ..equations.taylor import LONGEST
from ..lanes import Cells
from ..system import System
from ..tied.bounces import Bounces
from ..tied.devices import Branch, Devices
from ..tied.series import HeldBody, Law
from ..tied.tied_lanes import TiedLanes

_STATES = 1000  # states of the devices that are kept
# factor of the size that gives the degree of a series: one term more at most, without
# which a third of the lines of stiff ties would not hold
_ROOM = 64.0
ONE = np.zeros(1, dtype=np.int64)  # index of the only lane


class BodyOnBranch(NamedTuple):
    """A body on one side while its restraints keep their branches."""

    row: Array  # row of the devices of the side, (1,)
    now: Branch  # the branch of each device
    low: float  # y at its lower end, in the unit of the side; the ground is 0
    high: float  # y at its upper end, or at the limit of y
    yields: bool  # True if a device yields
    law: HeldBody  # the equation
    constant: float  # of the devices, as of `Devices.linear_terms`
    stiffness: float
    growth: float  # growth rate of the motion [1/tau]
    at_ground: float  # -y'' that the devices add at the ground
    # drive at which the body at rest leaves the ground onto each side, over that of the
    # free body, (sides,)
    ratios: Array
    # largest sizes for which series of degree 3, 4 ... hold over `LONGEST`
    limits: list[float]

    def size(self, shaking: float, y: float, v: float) -> float:
        """The size of the motion that gives the degree of its series."""
        pull = abs(self.constant + self.stiffness * y)
        return _ROOM * (shaking + self.growth * abs(v) + pull)


class LaneRestraints:
    """The restraints of one body under one motion, on every branch."""

    def __init__(self, system: System, segments: Segments, devices: Devices) -> None:
        self.devices, self.equation = devices, system.equation
        self.law = Law(system.equation, devices)
        self.bounces = Bounces(devices, system.contact, system.equation, segments)
        self._held: dict[tuple[float, bytes, bytes], BodyOnBranch] = {}

    def slack(self) -> TiedLanes:
        """The restraints at the start, as one lane."""
        one = np.ones((1, 1))
        devices = self.devices.stiffness.shape
        return TiedLanes.slack(Cells(one, one, one), ONE.copy(), devices)

    def forces_at_ground(self, ties: TiedLanes) -> Array:
        """The forces [N] with which the devices hold the body at the ground against
        each side, (sides, devices).
        """
        rows, devices = range(len(ties.branch)), self.devices
        return np.array(
            [
                devices.force_at_ground(np.array([i]), ties.branch[i], ties.plastic[i])
                for i in rows
            ]
        )[:, :, 0]

    def on(self, side: float, limit: float, ties: TiedLanes) -> BodyOnBranch:
        """The body on a side with its restraints on these branches; limit: y from which
        it has fallen.
        """
        key = side, ties.branch.tobytes(), ties.plastic.tobytes()
        found = self._held.get(key)
        if found is None:
            if len(self._held) >= _STATES:
                self._held.clear()
            found = self._held[key] = self._of(side, limit, ties)
        return found

    def _of(self, side: float, limit: float, ties: TiedLanes) -> BodyOnBranch:
        at, devices = np.array([side]), self.devices
        row = devices.row(at)
        now = devices.branch(
            row, *(x[row, :, 0].T for x in (ties.branch, ties.plastic))
        )
        law = HeldBody.of(self.equation.on(at), devices, row, now)
        of_first = law.of_first(self.equation.edge(side))
        constant, stiffness = devices.linear_terms(row, now)
        rate = growth_rate(stiffness).item()
        return BodyOnBranch(
            row,
            now,
            float(now.low.max(initial=0.0)),
            min(float(now.high.min(initial=np.inf)), limit),
            bool(now.yields[0]),
            of_first,
            constant.item(),
            stiffness.item(),
            rate,
            of_first.moment.at(0.0),
            self.bounces.uplift_ratios(ties)[:, 0],
            size_limits(LONGEST, self.equation.tolerance, rate),
        )
