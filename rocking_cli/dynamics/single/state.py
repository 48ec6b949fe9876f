"""The state of one body on floats, and its events: uplift, impact, rest, overturning,
the end of the motion.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..batch import FreeFall
from ..condition import (
    STEEP,
    Moments,
    along,
    at_free_peak,
    slope_between,
    through_impact,
)
from ..contacts.contact import Uplift
from ..contacts.lasting_bounces import too_many_impacts
from ..contacts.sequences import BELOW_ROUNDING, STILL
from ..drive import place
from ..equations.taylor import LONGEST, WITHIN
from ..lanes import Cells, Lanes
from ..outcome import Outcome
from .lane import Lane, LaneEdge

State = tuple[float, float]  # y and y'


_CARRIED = 0.25  # tau for which the moments may wait


class Listener(NamedTuple):
    """Functions that a march calls, and two limits that say how far the march then
    goes.
    """

    # called with each arc: start, reach [tau of the side], side, pace, h, terms
    keep: Callable[[float, float, float, float, float, Sequence[float]], None]
    # called with each event: tau, event, side, y, y'
    note: Callable[[float, str, float, float, float], None]
    # called at each rest: lanes before it, lanes after it
    rest: Callable[[Lanes, Lanes], object]
    visible: float  # speed |y'| down to which bounces are followed
    fallen: tuple[float, float]  # y to which a fall is followed (right, left)
    # called where an undamped body is left on still ground
    free: Callable[[Lanes], None] = lambda lanes: None
    # returns False where the body must bounce on instead of resting at once
    may_close: Callable[[Lanes], object] = lambda lanes: True


class Ended(NamedTuple):
    """The end of a march."""

    outcome: Outcome  # outcome of the body
    theta_ratio: float  # max |theta|/alpha [-], NaN where the body fell
    impacts: int  # number of impacts during the shaking
    # instant at which the ground falls away from the body [tau], None if it does not
    lost: float | None = None
    condition: float = (
        math.nan
    )  # condition of the largest rotation, where it is carried


class MarchState:
    """The state of a march: segment k and phase u in it, the edge the body is on, y and
    y', the force if it is known to more digits than the drive tells, and the largest y
    so far in the unit of the first side.
    """

    def __init__(
        self,
        lane: Lane,
        cells: Cells,
        edges: dict[float, LaneEdge],
        peaks: bool,
        listener: Listener | None,
        most: int,
    ) -> None:
        self.lane = lane
        self.cells = cells
        self.edges = edges  # edge of each side, +1 and -1
        self.listener = listener
        self.most = most  # number of steps, and of impacts, that are too many
        self.equation, self.contact = lane.system.equation, lane.system.contact
        self.segments, self.drive_lists = lane.segments, lane.drive_lists
        self.watched = peaks or listener is not None  # True if peaks are followed
        # The state, as in `Lanes`; the force is None where it follows from the drive.
        self.segment, self.phase, self.y, self.v = 0, 0.0, 0.0, 0.0
        self.force: float | None = None
        self.edge = edges[1.0]
        # largest sizes for which series of degree 3, 4 ... hold, by side
        self.limits = {
            side: lane.size_limits(edge.omega) for side, edge in edges.items()
        }
        # Largest y so far; no peak exceeds infinity.
        self.peak = 0.0 if self.watched else math.inf
        # second moments of an error (`condition`), where they are carried: of the
        # present state, and of |theta|/alpha at the largest peak
        self.carries = peaks and listener is None
        self.moments: Moments = (0.0, 0.0, 0.0)
        self.peak_moment = 0.0
        self.carried = (
            0.0,
            0.0,
            0.0,
        )  # y, y' up to which they hold, and time since [tau]
        self.impacts = self.steps = 0
        self.bounced = False  # True after the first impact
        self.reach = LONGEST  # longest step that the last series allowed [tau]
        # largest size of the last terms over the step
        self.least = WITHIN * self.equation.tolerance
        self.end: Ended | None = None  # None while the march goes on
        self.free_fall = FreeFall.of(lane.segments, cells, lane.shaken)

    def _lanes(self) -> Lanes:
        """Return this body as `Lanes` with one lane."""
        lanes = self.lane.lanes(self.cells, self.edge.side)
        lanes.segment[0] = self.segment
        lanes.phase[0] = self.phase
        lanes.y[0] = self.y
        lanes.v[0] = self.v
        lanes.force[0] = (
            self._net(self.edge, self.segment, self.phase) - 1.0
            if self.force is None
            else self.force
        )
        lanes.peak[0] = self._from_first(self.peak)
        lanes.moments[:3, 0] = self.moments
        return lanes

    def _carried(self, start: State, end: State, h: float) -> Moments:
        """The moments after an arc of duration h [tau] between two states (y, v)."""
        zeta = self.lane.zeta
        slope = slope_between(self.edge.equation, start, end, h)
        rate = math.sqrt(max(float(np.ravel(slope)[0]), STEEP) + zeta * zeta)
        return along(self.moments, math.exp(rate * h), h, rate, math.exp(-zeta * h))

    def _carry_on(self, state: State, h: float, now: bool = False) -> None:
        """Carry the moments on by h [tau] to this state (y, v), at once or with the
        lines to come: they change slowly.
        """
        y, v, time = self.carried
        time += h
        if self.carries and time and (now or time > _CARRIED):
            self.moments, time = self._carried((y, v), state, time), 0.0
            y, v = state
        self.carried = y, v, time

    def _at_peak(self, moment: float, y: float) -> None:
        """Keep the second moment of y at the largest peak so far, at y."""
        equation = self.equation.on(np.array([self.edge.side]))
        rate = float(equation.rotation_rate(np.array([y]), np.ones(1))[0])
        self.peak_moment = rate * rate * moment

    def _onto_first(self, y: float) -> float:
        """The displacement on the first side that is as large a part of alpha as y on
        the present side.
        """
        if self.equation.proportional:
            return y * self.edge.unit
        return self._between(y, self.edge.side, 1.0)

    def _from_first(self, y: float) -> float:
        """The inverse of `_onto_first`."""
        if self.equation.proportional:
            return y / self.edge.unit
        return self._between(y, 1.0, self.edge.side)

    def _between(self, y: float, side: float, to: float) -> float:
        if side == to:
            return y
        own, here, there = (np.array([x]) for x in (y, side, to))
        cell = np.zeros(1, dtype=np.int64)
        return float(self.contact.converted(own, here, there, cell)[0])

    def _net(self, edge: LaneEdge, k: int, u: float) -> float:
        """The net drive c at phase u of segment k; 0 on the still ground after the
        motion.
        """
        if k >= self.drive_lists.count:
            return 0.0
        return edge.net(*self.drive_lists.value(k, u))

    def _impact(self, v: float) -> None:
        """Apply an impact with velocity v <= 0 by the rule of the contact."""
        edge = self.edge
        self._note("impact", 0.0, v)
        if self.segment < self.lane.shaken:
            self.impacts += 1
        self.bounced = True
        # A one-sided body has one edge and comes back onto it.
        to = self.edges.get(-edge.side, edge)
        self.edge, self.y, self.v = to, 0.0, -edge.speed_ratio * v
        fall = 1.0 - self._net(to, self.segment, self.phase)
        self.force = -fall
        if self.carries:
            drag = 2.0 * self.lane.zeta
            before = self._net(edge, self.segment, self.phase) - 1.0
            self.moments = through_impact(
                self.moments,
                (v, before - drag * v),
                (self.v, self.force - drag * self.v),
                edge.omega / to.omega,
            )
        # Ask now and then, each time the number of impacts has doubled, whether they
        # would never end.
        if (
            self.impacts > 15
            and self.impacts & (self.impacts - 1) == 0
            and self._bounces_too_often()
        ):
            self._finish(Outcome.FAILED)
        elif self.segment < self.drive_lists.count and (
            self.v < STILL or self._may_rest(to, fall)
        ):
            lanes = self._lanes()
            ends = (
                self.v < STILL
                or self.contact.sequence_ends(self.segments, lanes, self.equation)[0]
            )
            if ends and (self.listener is None or self.listener.may_close(lanes)):
                self._uplift(before=lanes)

    def _bounces_too_often(self) -> bool:
        """True if the body would need more steps than allowed within this segment."""
        if (
            self.segment >= self.lane.shaken
            or self.lane.zeta
            or not self.contact.alike
            or self.segments.weighed is not None
        ):
            return False
        lanes = self._lanes()
        lanes.steps[0] = self.impacts
        return bool(too_many_impacts(self.segments, lanes, self.most)[0])

    def _may_rest(self, edge: LaneEdge, fall: float) -> bool:
        """The part of the test of Lemma 7 that needs no arrays: False if the lemma
        cannot prove that the bounces end in this segment.
        """
        v = self.v
        if (
            fall <= 0.0
            or v * v >= 0.05 * fall * fall
            or (self.listener is not None and v >= self.listener.visible)
        ):
            return False
        if v < BELOW_ROUNDING or edge.cycle_ratio >= 1.0:
            return v < BELOW_ROUNDING
        # 3 v/(1 - q) [1/f + eta r/f_other] must fit into the rest of the segment: the
        # lemma tries no shorter duration.
        there = self.edges.get(-edge.side)
        lasts = 1.0 / fall
        if there is not None:
            beyond = 1.0 - self._net(there, self.segment, self.phase)
            if beyond <= 0.0:
                return False
            lasts += edge.speed_ratio * there.omega / (edge.omega * beyond)
        block = self.drive_lists.at(self.segment)
        return 3.0 * v * lasts * edge.omega <= (1.0 - edge.cycle_ratio) * (
            block.length[self.segment - block.first] - self.phase
        )

    def _uplift(self, first: bool = False, before: Lanes | None = None) -> None:
        """Go from rest to the next uplift; end the march if there is none. before: this
        body as it came to rest.
        """
        at = np.array([self.segment]), np.array([self.phase])
        lift: Uplift = self.contact.uplift(
            self.cells, self.segments, np.zeros(1, dtype=np.int64), *at
        )
        k, u = place(self.segments, lift.segment, lift.phase)
        self.segment = int(k[0])
        self.phase = float(u[0])
        self.y = 0.0
        self.v = 0.0
        self.force = float(lift.force[0])
        self.moments = 0.0, 0.0, 0.0
        self.edge = self.edges.get(float(lift.side[0]), self.edge)
        lifts = self.segment < self.drive_lists.count
        if self.listener is not None and before is not None:
            self.listener.rest(before, self._lanes())
        elif lifts and first:
            self._note("uplift", 0.0, 0.0)
        if not lifts:
            fallen = self.free_fall is not None and self.free_fall.occurs[0]
            self._finish(
                Outcome.LOST_CONTACT
                if fallen
                else Outcome.NO_UPLIFT
                if first
                else Outcome.ROCKED
            )

    def _check_overturned(self) -> None:
        """End the march of a body beyond the unstable equilibrium if no later drive can
        bring it back (Lemma 6).
        """
        seg, edge = self.segments, self.edge
        side, k = np.array([edge.side]), np.array([min(self.segment, len(seg) - 1)])
        amplitude = np.array([abs(edge.drive)])
        inward = seg.strongest_inward(side, amplitude, k)
        y, v = np.array([self.y]), np.array([self.v])
        if bool(
            self.equation.on(side).certainly_overturns(
                y, v, inward, not self.lane.weighed
            )[0]
        ):
            self._finish(self._overturned())

    def _overturned(self) -> Outcome:
        return (
            Outcome.OVERTURNED_AFTER_IMPACT
            if self.bounced
            else Outcome.OVERTURNED_NO_IMPACT
        )

    def _settled(self) -> bool:
        """True, and the march ends, if a damped body on still ground would even without
        damping pass neither the barrier nor its peak.
        """
        lanes, equation = self._lanes(), self.equation.on(np.array([self.edge.side]))
        peak = equation.damped_peak(lanes.y, lanes.v)
        if np.isfinite(peak[0]):
            lanes.y[:], lanes.v[:] = peak, 0.0
            self.peak = max(self.peak, self._onto_first(float(peak[0])))
        if float(equation.rotation(lanes.y)[0]) >= 1.0:
            return False
        # Lemma 8: the undamped peaks are above those of this body.
        most = self.contact.free_motion(
            self.equation, lanes, np.array([0]), lanes.y, lanes.v
        )
        if (
            most.overturns[0]
            or most.overturns_after_impact[0]
            or self._onto_first(float(most.peak[0])) > self.peak
        ):
            return False
        self._finish(Outcome.ROCKED)
        return True

    def _free(self) -> None:
        """End the march on still ground: undamped by the closed form of the free motion
        (Lemma 8).
        """
        if self.lane.zeta:
            # the march does not test this before if a listener is present
            if not self._settled():
                self._finish(Outcome.FAILED)
            return
        lanes = self._lanes()
        if self.listener is not None:
            self.listener.free(lanes)
        free = self.contact.free_motion(
            self.equation, lanes, np.array([0]), lanes.y, lanes.v
        )
        if free.overturns[0]:
            self._finish(self._overturned())
        elif free.overturns_after_impact[0]:
            self._finish(Outcome.OVERTURNED_AFTER_IMPACT)
        else:
            highest = self._onto_first(float(free.peak[0]))
            if self.carries and highest > self.peak:
                moment = at_free_peak(
                    lanes.moments[:3],
                    lanes.y,
                    lanes.v,
                    lambda y, v: (
                        self.contact.free_motion(
                            self.equation, lanes, np.array([0]), y, v
                        ).peak
                    ),
                )
                self._at_peak(float(moment[0]), float(free.peak[0]))
            self.peak = max(self.peak, highest)
            self._finish(Outcome.ROCKED)

    def _note(self, event: str, y: float, v: float) -> None:
        if self.listener is not None:
            self.listener.note(
                self.lane.tau(self.segment, self.phase), event, self.edge.side, y, v
            )

    def _finish(self, outcome: Outcome) -> Ended:
        """End the march with this outcome. A body that would rock where the ground
        falls away from it has lost contact.
        """
        ratio = math.nan
        if outcome == Outcome.NO_UPLIFT:
            ratio = 0.0
        elif outcome == Outcome.ROCKED and math.isfinite(self.peak):
            ratio = float(
                np.ravel(self.equation.on(np.ones(1)).rotation(np.array([self.peak])))[
                    0
                ]
            )
        if (
            outcome == Outcome.ROCKED
            and self.free_fall is not None
            and self.free_fall.occurs[0]
        ):
            outcome, ratio = Outcome.LOST_CONTACT, math.nan
        lost = None
        if outcome == Outcome.LOST_CONTACT and self.free_fall is not None:
            lost = self.lane.tau(
                int(self.free_fall.segment[0]), float(self.free_fall.phase[0])
            )
        condition = math.sqrt(self.peak_moment)
        self.end = Ended(outcome, ratio, self.impacts, lost, condition)
        return self.end
