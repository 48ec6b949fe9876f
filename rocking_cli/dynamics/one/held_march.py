"""The march of one body with ties or a tendon on floats (`tied` has their laws).

A step lies within one branch of the restraints. It has one turn at most, so the signs
of y less an end of the branch, at its end and at its turn, tell whether the body passes
that end. On still ground the body goes on until `tied.tied_march` proves its outcome.
"""

import math

import numpy as np

from ..condition import in_tolerances, sheared
from ..lanes import Cells, Lanes
from ..outcome import Outcome
from ..tied.cuts import SLOWEST
from ..tied.devices import BROKEN, ELASTIC, SLACK, YIELDING
from ..tied.tied_lanes import STILL, TiedLanes
from ..tied.transitions import leave, pass_end, release, unload
from .free_march import Stop
from .held_state import HeldState
from .lane import LaneEdge
from .lane_restraints import ONE
from .step import after_turn, bulge, only_fall, root, turn_of, value

_WORDS = {SLACK: "slack", ELASTIC: "engagement", YIELDING: "yield", BROKEN: "rupture"}


class HeldMarch(HeldState):
    """The march of one body with restraints, from event to event."""

    still = STILL

    # From branch to branch.

    def _hold(self) -> None:
        """Take the branches that the devices are on now."""
        side, limit = self.edge.side, self.edge.limit
        self.held = self.restraints.on(side, limit, self.ties)
        self.rate = 1.0 + math.sqrt(max(0.0, self.held.stiffness))
        if self.segment < self.motion.count:
            row, now = int(self.held.row[0]), self.held.now
            tau = self.lane.tau(self.segment, self.phase)
            self._show_law(tau, row, now.fixed[:, 0], now.rate[:, 0])

    def _onto(self, edge: LaneEdge) -> None:
        super()._onto(edge)
        self.ties.side[0] = edge.side
        leave(self.devices, self.ties, ONE)
        self._hold()

    def _release(self, rotation: float) -> None:
        super()._release(rotation)
        self.ties.y[0] = self.y
        release(self.devices, self.ties)
        self.reached[0] = self.y
        self._hold()

    def _lift(self, first: bool = False, rest: float = math.inf) -> None:
        """Lift the body from rest, which leaves no error, as `tied.tied_march` does."""
        super()._lift(first, rest)
        self.moments = 0.0, 0.0, 0.0
        if self.force:  # in the unit of the free body
            self.force = None

    def _pass_end(self, limits: np.ndarray, sign: float) -> None:
        """Move the devices that are at an end of their branch to the next one."""
        before, branch = self.held, self.ties.branch[self.held.row[0], :, 0].copy()
        self.ties.y[0] = self.y
        broken = pass_end(self.devices, self.ties, ONE, before.row, limits, sign)
        self._hold()
        self._note_changes(branch)
        if broken.size and self.carries:
            jump = before.law.moment.at(self.y) - self.held.law.moment.at(self.y)
            yy, yv, vv = sheared(self.moments, jump, self.v).tolist()
            self.moments = yy, yv, vv

    def _note_changes(self, before: np.ndarray) -> None:
        """Show the devices whose branch was another one before to the listener."""
        if self.listener is None:
            return
        now = self.ties.branch[self.held.row[0], :, 0]
        for i in np.flatnonzero(now != before).tolist():
            unloads = before[i] == YIELDING and now[i] == ELASTIC
            word = "unloading" if unloads else _WORDS[int(now[i])]
            name = self.devices.names[i]
            self._note(word, self.y, self.v, device=name)

    # Events in a step.

    def _stop(
        self, terms: list[float], h: float, y: float, outward: bool, turns: bool
    ) -> Stop | None:
        """The event that ends a step: an end of the branch of the restraints, a peak
        where one of them yields, a lowest point.
        """
        held = self.held
        if turns and not outward:
            return self._about_lowest(terms, y)
        if turns:
            return self._about_peak(terms, h, y)
        if outward:
            return self._up(terms, 1.0) if y >= self._above_branch() else None
        return self._down(terms, 0.0, 1.0) if y <= held.low else None

    def _above_branch(self) -> float:
        """The y that is certainly above the branch: a constant drive leads a body back
        to its upper end, and no further.
        """
        return self.held.high + self._largest_touch()

    def _up(self, terms: list[float], stop: float) -> Stop:
        """The body passes the upper end of the branch before x = stop."""
        above = [terms[0] - self.held.high, *terms[1:]]
        x = 0.0
        if above[0] < 0.0:
            x = root(above, 0.0, stop, -above[0] / terms[1] if terms[1] else stop)
        return Stop(x, self.held.high, self._pass_upper_end)

    def _down(self, terms: list[float], start: float, stop: float) -> Stop:
        """The body passes the lower end between x = start, its peak, and stop; start is
        0 for a step without a peak.
        """
        above = [terms[0] - self.held.low, *terms[1:]]
        # a parabola comes down as long after its peak as it began before it
        x = root(above, start, stop, 2.0 * start) if start else only_fall(above, stop)
        return Stop(x, self.held.low, self._pass_lower_end)

    def _about_peak(self, terms: list[float], h: float, y: float) -> Stop | None:
        held, highest = self.held, max(terms[0], y) + bulge(terms)
        if highest < held.high and not held.yields and not self._matters(highest):
            if y > held.low:
                return None
            above = [terms[0] - held.low, *terms[1:]]
            return Stop(after_turn(above), held.low, self._pass_lower_end)
        turn = turn_of(terms)
        top = value(terms, turn)[0]
        if top >= self._above_branch():
            return self._up(terms, turn)
        self._record_peak(turn * h, top)
        if held.yields or self.listener is not None:
            return Stop(turn, top, self._peaked)
        return self._down(terms, turn, 1.0) if y <= held.low else None

    def _about_lowest(self, terms: list[float], y: float) -> Stop | None:
        held = self.held
        touch = self._largest_touch()
        above = min(terms[0], y) - bulge(terms) > held.low + touch
        if above and y < held.high and self.segment < self.lane.shaken:
            return None
        turn = turn_of(terms)
        bottom = value(terms, turn)[0]
        if held.low <= 0.0 and abs(bottom) < touch:
            return Stop(turn, 0.0, self._touch_ground)
        if bottom <= held.low:
            return self._down(terms, 0.0, turn)
        return Stop(turn, bottom, self._turn_outwards)

    def _matters(self, highest: float) -> bool:
        return (
            self.segment >= self.lane.shaken
            or highest > self.reached[int(self.held.row[0])]
            or super()._matters(highest)
        )

    def _record_peak(self, t: float, y: float) -> None:
        super()._record_peak(t, y)
        self._stretch(y)
        if self.segment >= self.lane.shaken:
            here, turned = 1 << int(self.held.row[0]), self.ties.turned
            turned[0] |= here | (turned[0] & here) << 2

    def _peaked(self, _v: float) -> None:
        self.v = 0.0
        self._note("peak", self.y, 0.0)
        if self.held.yields:
            self.yielded = max(self.yielded, self.moments[0])
            branch = self.ties.branch[self.held.row[0], :, 0].copy()
            self.ties.y[0] = self.y
            unload(self.devices, self.ties, ONE, self.held.row)
            self._hold()
            self._note_changes(branch)

    def _pass_upper_end(self, v: float) -> None:
        self.v = max(v, SLOWEST)
        self._stretch(self.y)
        if self.held.high >= self.edge.limit:
            self._finish(self._overturned())
        else:
            self._pass_end(self.held.now.high, 1.0)

    def _pass_lower_end(self, v: float) -> None:
        self.v = min(v, 0.0)
        if self.y <= 0.0:
            self._impact(self.v)
        else:
            self._pass_end(self.held.now.low, -1.0)

    def _touch_ground(self, _v: float) -> None:
        """Under a constant drive the energy leads the body back to the ground with the
        speed 0: it touches the ground without an impact.
        """
        self.v = 0.0
        yy, yv, vv = self.moments
        touch = in_tolerances(self._largest_touch(), self.equation.error_unit)
        self.moments = yy + touch**2, yv, vv

    def _largest_touch(self) -> float:
        """The error of y at the ground."""
        peak = self._between(self.peak, 1.0, self.edge.side)
        return self.touch * peak + self.least

    def _turn_outwards(self, _v: float) -> None:
        """A body that turns outwards above still ground after a peak leans."""
        self.v = 0.0
        if self.ties.turned[0] >> (int(self.held.row[0]) + self.again) & 1:
            self._finish(Outcome.LEANING)

    # At the ground.

    def _lifted(self) -> Cells:
        """The devices hold the body at rest as a larger amplitude of uplift would."""
        drive, ratios = self.cells.amplitude[:, 0], self.held.ratios
        held = np.array([[drive[0] / ratios[0]], [drive[-1] / ratios[-1]]])
        return self.cells._replace(amplitude=held)

    def _impact(self, v: float) -> None:
        # Lemma 8: after a peak on every side of still ground no peak is higher.
        known = self.segment >= self.lane.shaken
        known = known and self.ties.turned[0] & self.every == self.every
        super()._impact(v)
        if known and self.end is None:
            self._finish(Outcome.ROCKED)

    def _sequence_ends(self, lanes: Lanes) -> bool:
        """True if the bounces end in rest (Lemma 7)."""
        assert isinstance(lanes, TiedLanes)
        return bool(self.restraints.bounces.end(lanes)[0])

    def _sequence_time(self, lanes: Lanes) -> float:
        assert isinstance(lanes, TiedLanes)
        return float(self.restraints.bounces.time(lanes)[0])
