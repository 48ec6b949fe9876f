"""The march of one body on floats, from event to event.

A step is a Taylor series on which y' changes its sign at most once (`step`), so the
signs of y at its end and at its turn tell whether the body struck the ground. It ends
where the series no longer holds, or where the motion has another closed form: at the
end of a straight line, or of a piece of sinusoids, across whose peaks it goes.
"""

import math
from bisect import bisect_left
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..batch import INSTANT
from ..condition import lifted_at_once, through_impact
from ..contacts.contact import rebound
from ..contacts.sequences import BELOW_ROUNDING, sequence_ends, sequence_time
from ..drive import place
from ..equations.recurrence import motion_terms
from ..equations.taylor import LONGEST, MOST_TERMS, RECIPROCALS
from ..lanes import Lanes
from ..outcome import Outcome
from .lane import LaneEdge
from .state import Ended, MarchState
from .step import (
    after_turn,
    bulge,
    end_of,
    keeps_its_sign,
    one_turn,
    only_fall,
    root,
    shorter,
    turn_of,
    value,
)

_LONGEST = 4.0  # tau: longest step along sinusoids
_SHORTEST = 1e-14  # tau: a body whose series holds no longer than this fails
# tau: moments of an error are carried over no longer arcs, and over several lines of a
# record at once as long as these together are no longer
_SLOWLY, _WAITS = 0.5, 0.25
# part of the speed `visible` at which the rest of a bouncing is summed, and bounces
# until then at most
_SUMMED, _UNSEEN = 1e-3, 1000


class Stop(NamedTuple):
    """An event that ends a step."""

    at: float  # its x in the step, from 0 to 1
    y: float  # displacement there
    event: Callable[[float], None]  # applies the event, with the velocity there


class March(MarchState):
    """The march of one body, from event to event."""

    def run(self, release: float) -> Ended:
        if release:
            self._release(release)
        else:
            self._lift(first=True)
        while self.end is None:
            if self.segment >= self.motion.count:
                self._leave_on_still_ground()
            # Only damped bodies march on over still ground, until they have settled.
            elif (
                self.segment < self.lane.shaken
                or self.listener is not None
                or not self._settled()
            ):
                self.steps += 1
                self._step()
                if self.steps > self.lane.most and self.end is None:
                    self._finish(Outcome.FAILED)
        return self.end

    def _release(self, release: float) -> None:
        """Put the body on its right side at theta/alpha = release."""
        self.doubtful = self.lane.body is not None
        first = self.equation.on(np.ones(1))
        self.y = float(first.displacement(np.array([release]))[0])
        self.peak = max(self.peak, self.y)
        self._note("release", self.y, 0.0)

    def _step(self) -> None:
        """Take one step, to its end or to an event in it."""
        edge, block = self.edge, self.motion.at(self.segment)
        left = whole = (
            block.ahead[self.segment - block.first] - self.phase
        ) / edge.omega
        if self.free_fall is not None and self.free_fall.occurs[0]:
            left = min(whole, float(self.free_fall.time_left(self._lanes())[0]))
            if left <= INSTANT:
                self._fall_freely()
                return
        terms, h = self._series(left)
        y, speed = end_of(terms)
        if not math.isfinite(speed) or h < min(left, _SHORTEST):
            self._finish(Outcome.FAILED)
            return

        # One turn at most, by the chord of y' or by its Bernstein coefficients.
        outward, turns = terms[1] > 0.0, False
        if not keeps_its_sign(terms, speed):
            share, outward, turns = one_turn(terms)
            if share < 1.0:
                h *= share
                terms = shorter(terms, share)
                y, speed = end_of(terms)
        if not outward and terms[0] == terms[1] == 0.0:
            # Rounding has lifted the body at the peak of the drive.
            self.segment, self.phase = self.segment + 1, 0.0
            self._lift()
            return

        stop = self._stop(terms, h, y, outward, turns)
        reach = h if stop is None else stop.at * h
        self._keep(reach, h, terms)
        if reach == whole:
            self.segment, self.phase = block.after[self.segment - block.first], 0.0
        else:
            self._go(reach * edge.omega)
        v = speed / h if stop is None else value(terms, stop.at, h)[1]
        if stop is not None:
            y = stop.y
        if self.carries:
            if reach > _SLOWLY:
                self._carry_along(terms, h, reach)
                reach = math.fmod(reach, _SLOWLY)
            self._carry_on(y, v, reach, _WAITS)
        self.y, self.v, self.force = y, v, None
        if stop is not None:
            self._carry_on(y, v, 0.0)
            stop.event(v)
        elif self.end is None:
            self._test_overturning()

    def _carry_along(self, terms: list[float], h: float, reach: float) -> None:
        """Carry the moments over the part `reach` [tau] of a long step, in parts over
        which they change slowly, but for the rest of the last one.
        """
        for i in range(1, int(reach / _SLOWLY) + 1):
            self._carry_on(*value(terms, i * _SLOWLY / h, h), _SLOWLY, _WAITS)

    def _series(self, left: float) -> tuple[list[float], float]:
        """(terms over a step as long as the series holds, at most `left`; its length
        [tau]).
        """
        equation, straight = self.law, self.motion.straight
        drive, weight, unit, degree = self._line(left) if straight else self._waves()
        self.weight = weight
        if equation.composed:
            degree = min(degree, equation.composed)
        if self.factors_of != (unit, degree):  # most steps have those of the one before
            square = unit * unit
            self.factors = [square * c for c in RECIPROCALS[: degree - 1]]
            self.factors_of = unit, degree
        terms = motion_terms(
            equation, self.y, self.v, unit, self.factors, drive, weight, self.force
        )

        # The last two terms tell for how long the series holds the tolerance.
        h = unit if straight else min(left, _LONGEST)
        error = abs(terms[-1]) + 0.25 * unit * abs(terms[-2])
        allowed = self.least * unit
        if not straight or error > allowed:
            if error:
                h = min(h, unit * (allowed / error) ** (1.0 / (degree - 1)))
            terms = shorter(terms, h / unit)

        # F and G of a table hold up to a distance from y.
        if equation.composed:
            room, moved = equation.room(self.y), sum(map(abs, terms[1:]))
            if moved > room:
                h *= room / moved
                terms = shorter(terms, room / moved)
        return terms, h

    def _line(self, left: float) -> tuple[list[float], list[float] | None, float, int]:
        """(series of the outward drive, series of the weight, unit of time, degree that
        the motion needs) along a straight line.
        """
        edge, block, unit = self.edge, self.motion.block, min(left, LONGEST)
        i = self.segment - block.first
        length = block.length[i]
        over, part = self.phase / length, unit * edge.omega / length
        gain, weight = edge.drive * block.rise[i], None
        drive = [edge.drive * block.start[i] + gain * over, gain * part]
        shaking = 2.0 + abs(drive[0]) + abs(drive[1]) / unit
        if block.up:
            gain = edge.sway * block.up_rise[i]
            weight = [1.0 + edge.sway * block.up[i] + gain * over, gain * part]
            shaking += abs(weight[0]) + abs(weight[1]) / unit
        return drive, weight, unit, self._degree(shaking)

    def _degree(self, shaking: float) -> int:
        """The degree that a series along a straight line needs; shaking: size of the
        acceleration without that of the body.
        """
        return 3 + bisect_left(self.limits[self.edge.side], shaking + abs(self.v))

    def _waves(self) -> tuple[list[float], list[float] | None, float, int]:
        """As `_line`, along a piece of sinusoids."""
        edge, weight = self.edge, None
        waves = self.motion.waves(self.segment)
        unit = 1.0 / (self.rate + edge.omega * max(wave.fastest for wave in waves))
        drive, *up = (
            wave.terms(self.phase, unit * edge.omega, MOST_TERMS - 1) for wave in waves
        )
        s, rise = self.motion.value(self.segment, self.phase)
        drive = [edge.drive * x for x in drive]
        drive[0] = edge.drive * s
        if up:
            weight = [edge.sway * x for x in up[0]]
            weight[0] = 1.0 + edge.sway * rise
        return drive, weight, unit, MOST_TERMS

    def _stop(
        self, terms: list[float], h: float, y: float, outward: bool, turns: bool
    ) -> Stop | None:
        """The event that ends a step with this y at its end, the only impact in it;
        None without one. A peak in the step is recorded.
        """
        hit = self._hit(terms, h, y, outward, turns)
        return None if hit is None else Stop(hit, 0.0, self._impact)

    def _hit(
        self, terms: list[float], h: float, y: float, outward: bool, turns: bool
    ) -> float | None:
        """The x of the only impact in a step with this y at its end; None without one.
        A peak in the step is recorded.
        """
        if not turns:
            return only_fall(terms, 1.0) if y <= 0.0 and not outward else None
        if outward:
            if not self._matters(max(terms[0], y) + bulge(terms)):
                return after_turn(terms) if y <= 0.0 else None
            turn = turn_of(terms)
            top = value(terms, turn)[0]
            self._record_peak(turn * h, top)
            if top >= self.edge.limit:  # it lies on its side
                self._cannot_return(top, 0.0)  # raises if a drive could bring it back
                self._finish(self._overturned())
            else:
                self._note("peak", top, 0.0, turn * h * self.edge.omega)
            return root(terms, turn, 1.0, 2.0 * turn) if y <= 0.0 else None
        if min(terms[0], y) > bulge(terms):
            return None
        turn = turn_of(terms)
        return only_fall(terms, turn) if value(terms, turn)[0] <= 0.0 else None

    def _matters(self, highest: float) -> bool:
        """True if a peak of at most this y may change a result."""
        return (
            self.listener is not None
            or highest >= self.edge.limit
            or (self.watched and self._onto_first(highest) > self.peak)
        )

    def _record_peak(self, t: float, y: float) -> None:
        """Record a peak t [tau of the side] after the present instant."""
        top = self._onto_first(y)
        if self.carries and top >= self.peak:
            self._at_peak(self._moments_at(y, 0.0, t)[0], y)
        if self.watched:
            self.peak = max(self.peak, top)

    def _go(self, phase: float) -> None:
        """Go on by a phase [rad] within the piece, or to the start of the next one."""
        k, u = self.segment, self.phase + phase
        block = self.motion.at(k)
        i = k - block.first
        while u >= block.length[i]:
            if block.after[i] == k + 1:
                k, u = k + 1, 0.0
                break
            u -= block.length[i]
            i, k = i + 1, k + 1
        self.segment, self.phase = k, u

    def _impact(self, v: float) -> None:
        """Apply an impact with velocity v by the rule of the contact."""
        edge, v = self.edge, min(v, 0.0)
        self._note("impact", 0.0, v)
        if self.segment < self.lane.shaken and not self.ending:
            self.impacts += 1
        self.bounced = True
        force = self._at_ground(edge)
        # A one-sided body has one edge and comes back onto it.
        to = self.edges.get(-edge.side, edge)
        self.y, self.v = 0.0, rebound(edge.speed_ratio, v)
        self._onto(to)
        self.force = self._at_ground(to)
        fall = -self.force
        if self.carries:
            drag = 2.0 * self.lane.zeta
            self.moments = through_impact(
                self.moments,
                (v, force - drag * v),
                (self.v, self.force - drag * self.v),
                edge.omega / to.omega,
            )
            self.carried = 0.0, self.v, 0.0
        if self.ending:
            self.unseen += 1
            if self.v <= self.ending or self.unseen >= _UNSEEN:
                self._rest()
        elif self.segment < self.motion.count and self._comes_to_rest(to, fall):
            if self.listener is not None and math.isfinite(self.listener.visible):
                self.ending, self.unseen = _SUMMED * self.v, 0
            if not self.ending:
                self._rest()

    def _comes_to_rest(self, edge: LaneEdge, fall: float) -> bool:
        """True if the bounces are proved to end in rest before any other event, and
        need not be shown (Lemma 7).
        """
        if self.v >= self.still and not self._slow_enough(edge, fall):
            return False
        lanes = self._lanes()
        ends = self.v < self.still or self._sequence_ends(lanes)
        return ends and (not self.doubtful or bool(self.watch.may_rest(lanes)[0]))

    def _sequence_ends(self, lanes: Lanes) -> bool:
        """True if Lemma 7 proves that the bounces end in rest."""
        there = self.contact.other_side(lanes)
        return bool(sequence_ends(self.segments, lanes, self.equation, there)[0])

    def _sequence_time(self, lanes: Lanes) -> float:
        """How long the bounces last [tau of the side]."""
        there = self.contact.other_side(lanes)
        return float(sequence_time(self.segments, lanes, there)[0])

    def _slow_enough(self, edge: LaneEdge, fall: float) -> bool:
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
        lasts, there = 1.0 / fall, self.edges.get(-edge.side)
        if there is not None:
            beyond = -self._at_ground(there)
            if beyond <= 0.0:
                return False
            lasts += edge.speed_ratio * there.omega / (edge.omega * beyond)
        block = self.motion.at(self.segment)
        left = block.length[self.segment - block.first] - self.phase
        return 3.0 * v * lasts * edge.omega <= (1.0 - edge.cycle_ratio) * left

    def _rest(self) -> None:
        """Let the body rest, and go to the next uplift."""
        rest = 0.0
        if self.listener is not None:
            pace = self.edge.omega / float(self.lane.omega[0])
            lasts = self._sequence_time(self._lanes()) * pace
            rest = self.lane.tau(self.segment, self.phase) + lasts
        self.ending = 0.0
        self._lift(rest=rest)

    def _lift(self, first: bool = False, rest: float = math.inf) -> None:
        """Go from rest to the next uplift; end the march if there is none. rest:
        instant at which the body has come to rest [tau].
        """
        at = np.array([self.segment]), np.array([self.phase])
        lift = self.contact.uplift(
            self._lifted(), self.segments, np.zeros(1, dtype=np.int64), *at
        )
        k, u = place(self.segments, lift.segment, lift.phase)
        left, force = (self.force, self.edge.omega), float(lift.force[0])
        now = lift.segment[0] == self.segment and lift.phase[0] == self.phase
        at_once = now and force > 0.0 and not first
        self.segment, self.phase, self.y, self.v = int(k[0]), float(u[0]), 0.0, 0.0
        self.force, self.carried = force, (0.0, 0.0, 0.0)
        lifts = self.segment < self.motion.count
        if self.listener is not None:
            tau = self.lane.tau(self.segment, self.phase)
            if rest < math.inf and (not lifts or tau > rest):
                self._note_rest(rest)
        self._onto(self.edges.get(float(lift.side[0]), self.edge))
        vv = self.moments[2]
        if at_once:
            vv = float(lifted_at_once(vv, left, (force, self.edge.omega)))
        self.moments = 0.0, 0.0, at_once * vv
        if lifts:
            self._note("uplift", 0.0, 0.0)
            return
        fallen = self.free_fall is not None and self.free_fall.occurs[0]
        self._finish(
            Outcome.LOST_CONTACT
            if fallen
            else Outcome.NO_UPLIFT
            if first
            else Outcome.ROCKED
        )
