"""The state of one body with ties or a tendon on floats: its restraints, its contact
with the ground and its end.
"""

import math
from bisect import bisect_left
from dataclasses import fields
from typing import Any

import numpy as np

from ..lanes import Lanes
from ..outcome import Outcome
from ..tied.devices import Branch
from ..tied.tied_lanes import TiedLanes, touch_of
from ..tied.transitions import keep_yield, stretch
from .free_march import March
from .lane import LaneEdge
from .lane_restraints import ONE
from .state import Ended, LawOfDevices


class HeldState(March):
    """The state of the march of one body with restraints."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        assert self.lane.restraints is not None
        self.restraints = self.lane.restraints
        self.devices = devices = self.restraints.devices
        self.ties = self.restraints.slack()
        self.held = self.restraints.on(1.0, self.edge.limit, self.ties)
        self.watched, self.peak = True, 0.0  # the peak tells how close a touch is
        self.touch = touch_of(self.equation.tolerance)
        self.reached = [0.0, 0.0]  # y up to which elongations are noted, by row
        # second moment of the error of y at which a restraint yielded (`tied.carried`)
        self.yielded = 0.0
        # bits of `turned` to the second turn on a side, and all bits that it needs
        self.again = 2 if self.lane.zeta and devices.body is not None else 0
        self.every = (1 << len(self.edges)) - 1 << self.again

    @property
    def law(self) -> object:
        return self.held.law

    def _at_ground(self, edge: LaneEdge) -> float:
        pull = self.held.at_ground
        if edge is not self.edge:
            pull = float(self.held.ratios[0 if edge.side > 0.0 else -1]) - 1.0
        return super()._at_ground(edge) - pull

    def _lanes(self) -> TiedLanes:
        free = super()._lanes()
        for field in fields(Lanes):
            setattr(self.ties, field.name, getattr(free, field.name))
        return self.ties

    def _degree(self, shaking: float) -> int:
        held = self.held
        limits = held.limits
        if self.segment < self.lane.shaken:
            limits = self.lane.size_limits(self.edge.omega, held.growth)
        return 3 + bisect_left(limits, held.size(shaking, self.y, self.v))

    def _stretch(self, y: float) -> None:
        """Keep the elongations of the devices at y if they are the largest so far."""
        row = int(self.held.row[0])
        if y > self.reached[row]:
            self.reached[row] = y
            stretch(self.devices, self.ties, ONE, self.held.row, np.array([y]))

    def _devices_now(self) -> tuple[np.ndarray, Branch]:
        return self.held.row, self.held.now

    def _moments_at(self, y: float, v: float, t: float) -> tuple[float, float, float]:
        yy, yv, vv = super()._moments_at(y, v, t)
        if self.yielded:
            y0, _, since = self.carried
            stiffness = float(self.held.law.moment.slope(0.5 * (y0 + y)))
            push = abs(stiffness) * (since + t) * math.sqrt(self.yielded)
            yy = (math.sqrt(max(yy, 0.0)) + 0.5 * push * (since + t)) ** 2
            vv = (math.sqrt(max(vv, 0.0)) + push) ** 2
        return yy, yv, vv

    def _show_law(
        self, tau: float, row: int, fixed: np.ndarray, rate: np.ndarray
    ) -> None:
        """Show the force laws of the devices from an instant on to the listener."""
        if self.listener is not None and not self.ending:
            held = self.restraints.forces_at_ground(self.ties)
            self.listener.hold(LawOfDevices(tau, row, fixed, rate, held))

    def _note_rest(self, tau: float) -> None:
        # A tie of both sides has the larger of its two forces.
        super()._note_rest(tau)
        forces = self.restraints.forces_at_ground(self.ties).max(axis=0)
        self._show_law(tau, 0, forces, 0.0 * forces)

    def _test_overturning(self) -> None:
        """End the march of a body that no later drive can turn back (Lemma 6)."""
        edge, held = self.edge, self.held
        doubtful, fallen = 1.0, math.inf
        if self.listener is not None and self.listener.fallen is not None:
            doubtful = fallen = self.listener.fallen[0 if edge.side > 0.0 else 1]
        if not (self.y > doubtful and self.v > 0.0 and held.high >= edge.limit):
            return
        law, one = self.restraints.law, self._lanes()
        if law.cannot_return(self.segments, one, held.row, held.now)[0]:
            self.y = min(self.y, fallen)
            self._stretch(self.y)
            self._finish(self._overturned())

    def _settled(self) -> bool:
        """False: the march goes on until the body has turned back on every side."""
        return False

    def _finish(self, outcome: Outcome) -> Ended:
        self.ties.y[0] = self.y
        keep_yield(self.devices, self.ties, ONE, self.held.row)
        self.end = super()._finish(outcome)._replace(restraints=self.ties)
        return self.end
