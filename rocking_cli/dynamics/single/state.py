"""The state of one body on floats, and its events: uplift, impact, rest, overturning, the end of the motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..contacts.contact import Uplift
from ..contacts.sequences import BELOW_ROUNDING, outlasts
from ..drive import place
from ..equations.taylor import LONGEST, WITHIN
from ..lanes import Cells, Lanes
from ..march.batch import FreeFall
from ..outcome import Outcome
from .lane import Face, Lane

_STILL = 1e-100  # speed that counts as zero, since its square is below double precision
Keep = Callable[[float, float, float, float, float, tuple[float, ...]], None]  # start [tau], reach [tau of the side], side, pace, h, terms
Note = Callable[[float, str, float, float, float], None]  # tau, event, side, y, y'


class Listener(NamedTuple):
    """Functions that a march calls, and how far it then goes: bounces down to the speed `visible`, a fall to y = fallen (right, left)."""

    keep: Keep
    note: Note
    rest: Callable[[Lanes, Lanes], None]
    visible: float
    fallen: tuple[float, float]


class Ended(NamedTuple):
    """The end of a march: outcome, max |theta|/alpha (NaN where the body fell), impacts during the shaking; lost: tau at which the ground
    falls away from the body, None if it does not."""

    outcome: Outcome
    theta_ratio: float
    impacts: int
    lost: float | None = None


class Body:
    """The state of a march: segment k and phase u in it, the face (side) the body is on, y and y', the force if it is known to more digits
    than the drive tells, and the largest y so far in the unit of the first side."""

    def __init__(self, lane: Lane, cells: Cells, faces: dict[float, Face], peaks: bool, listener: Listener | None, most: int) -> None:
        self.lane, self.cells, self.faces, self.listener, self.most = lane, cells, faces, listener, most
        self.equation, self.contact, self.segments, self.reel = lane.system.equation, lane.system.contact, lane.segments, lane.reel
        self.watched = peaks or listener is not None
        self.k, self.u, self.y, self.v = 0, 0.0, 0.0, 0.0
        self.force: float | None = None
        self.face = faces[1.0]
        self.peak = 0.0 if self.watched else math.inf
        self.impacts = self.steps = 0
        self.bounced = False
        self.reach = LONGEST
        self.least = WITHIN * self.equation.tolerance
        self.end: Ended | None = None
        self.drop = FreeFall.of(lane.segments, cells, lane.shaken)

    def _lanes(self) -> Lanes:
        """Returns this body as `Lanes` with one lane."""
        lanes = self.lane.lanes(self.cells, self.face.side)
        lanes.k[0], lanes.u[0], lanes.y[0], lanes.v[0] = self.k, self.u, self.y, self.v
        lanes.b[0] = self._net(self.face, self.k, self.u) - 1.0 if self.force is None else self.force
        lanes.peak[0] = self.peak / self.face.unit
        return lanes

    def _net(self, face: Face, k: int, u: float) -> float:
        """The net drive c at phase u of segment k; 0 on the still ground after the motion."""
        if k >= self.reel.count:
            return 0.0
        s, up = self.reel.value(k, u)
        return face.drive * s - face.sway * up

    def _impact(self, v: float) -> None:
        """Apply an impact with velocity v <= 0 by the rule of the contact."""
        face = self.face
        self._note("impact", 0.0, v)
        if self.k < self.lane.shaken:
            self.impacts += 1
        self.bounced = True
        to = self.faces.get(-face.side, face)
        self.face, self.y, self.v = to, 0.0, -face.keeps * v
        fall = 1.0 - self._net(to, self.k, self.u)
        self.force = -fall
        if self.impacts > 15 and self.impacts & (self.impacts - 1) == 0 and self._bounces_too_often():
            self._finish(Outcome.FAILED)
        elif self.k < self.reel.count and (self.v < _STILL or self._may_rest(to, fall)):
            lanes = self._lanes()
            if self.v < _STILL or self.contact.sequence_ends(self.segments, lanes, self.equation)[0]:
                self._uplift(lanes=lanes)

    def _bounces_too_often(self) -> bool:
        """True if the body would need more steps than allowed within this segment."""
        if self.k >= self.lane.shaken or self.lane.zeta or not self.contact.alike or self.segments.weighed is not None:
            return False
        lanes = self._lanes()
        lanes.steps[0] = self.impacts
        return bool(outlasts(self.segments, lanes, self.most)[0])

    def _may_rest(self, face: Face, fall: float) -> bool:
        """The part of the test of Lemma 7 that needs no arrays: False if the lemma cannot prove that the bounces end in this segment."""
        v = self.v
        if fall <= 0.0 or v * v >= 0.05 * fall * fall or (self.listener is not None and v >= self.listener.visible):
            return False
        if v < BELOW_ROUNDING or face.cycle >= 1.0:
            return v < BELOW_ROUNDING
        there = self.faces.get(-face.side)
        lasts = 1.0 / fall
        if there is not None:
            beyond = 1.0 - self._net(there, self.k, self.u)
            if beyond <= 0.0:
                return False
            lasts += face.keeps * there.omega / (face.omega * beyond)
        block = self.reel.at(self.k)
        return 3.0 * v * lasts * face.omega <= (1.0 - face.cycle) * (block.length[self.k - block.first] - self.u)

    def _uplift(self, first: bool = False, lanes: Lanes | None = None) -> None:
        """Go from rest to the next uplift; end the march if there is none."""
        at = np.array([self.k]), np.array([self.u])
        lift: Uplift = self.contact.uplift(self.cells, self.segments, np.zeros(1, dtype=np.int64), *at)
        k, u = place(self.segments, lift.k, lift.u)
        before = lanes
        self.k, self.u, self.y, self.v, self.force = int(k[0]), float(u[0]), 0.0, 0.0, float(lift.b[0])
        if self.faces.get(float(lift.side[0])) is not None:
            self.face = self.faces[float(lift.side[0])]
        lifts = self.k < self.reel.count
        if self.listener is not None and before is not None:
            self.listener.rest(before, self._lanes())
        elif lifts and first:
            self._note("uplift", 0.0, 0.0)
        if not lifts:
            dropped = self.drop is not None and self.drop.ever[0]
            self._finish(Outcome.LOST_CONTACT if dropped else Outcome.NO_UPLIFT if first else Outcome.ROCKED)

    def _doubt(self) -> None:
        """End the march of a body beyond the unstable equilibrium if no later drive can bring it back (Lemma 6)."""
        seg, face = self.segments, self.face
        side, k = np.array([face.side]), np.array([min(self.k, len(seg) - 1)])
        amplitude = np.array([abs(face.drive)])
        inward = seg.hardest(side, amplitude, k)
        y, v = np.array([self.y]), np.array([self.v])
        if bool(self.equation.on(side).certainly_overturns(y, v, inward, not self.lane.weighed)[0]):
            self._finish(self._overturned())

    def _overturned(self) -> Outcome:
        return Outcome.OVERTURNED_AFTER_IMPACT if self.bounced else Outcome.OVERTURNED_NO_IMPACT

    def _settled(self) -> bool:
        """True, and the march ends, if a damped body on still ground would even without damping pass neither the barrier nor its peak."""
        lanes, equation = self._lanes(), self.equation.on(np.array([self.face.side]))
        peak = equation.damped_peak(lanes.y, lanes.v)
        if np.isfinite(peak[0]):
            lanes.y[:], lanes.v[:] = peak, 0.0
            self.peak = max(self.peak, float(peak[0]) * self.face.unit)
        if float(equation.rotation(lanes.y)[0]) >= 1.0:
            return False
        most = self.contact.free_motion(self.equation, lanes, np.array([0]), lanes.y, lanes.v)
        if most.overturns[0] or most.overturns_after_impact[0] or float(most.peak[0]) * self.face.unit > self.peak:
            return False
        self._finish(Outcome.ROCKED)
        return True

    def _free(self) -> None:
        """End the march on still ground: undamped by the closed form of the free motion (Lemma 8)."""
        if self.lane.zeta:
            if not self._settled():  # the march does not test this before if a listener is present
                self._finish(Outcome.FAILED)
            return
        lanes = self._lanes()
        free = self.contact.free_motion(self.equation, lanes, np.array([0]), lanes.y, lanes.v)
        if free.overturns[0]:
            self._finish(self._overturned())
        elif free.overturns_after_impact[0]:
            self._finish(Outcome.OVERTURNED_AFTER_IMPACT)
        else:
            self.peak = max(self.peak, float(free.peak[0]) * self.face.unit)
            self._finish(Outcome.ROCKED)

    def _note(self, event: str, y: float, v: float) -> None:
        if self.listener is not None:
            self.listener.note(self.lane.tau(self.k, self.u), event, self.face.side, y, v)

    def _finish(self, outcome: Outcome) -> Ended:
        ratio = math.nan
        if outcome == Outcome.NO_UPLIFT:
            ratio = 0.0
        elif outcome == Outcome.ROCKED and math.isfinite(self.peak):
            ratio = float(np.ravel(self.equation.on(np.ones(1)).rotation(np.array([self.peak])))[0])
        if outcome == Outcome.ROCKED and self.drop is not None and self.drop.ever[0]:
            outcome, ratio = Outcome.LOST_CONTACT, math.nan
        lost = None
        if outcome == Outcome.LOST_CONTACT and self.drop is not None:
            lost = self.lane.tau(int(self.drop.k[0]), float(self.drop.u[0]))
        self.end = Ended(outcome, ratio, self.impacts, lost)
        return self.end
