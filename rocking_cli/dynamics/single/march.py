"""The march of one body on floats, from event to event.

The drive here is the net drive c (`weight`). A step lies in one window: it ends at the
latest where its segment ends or c = 1. Where c < 1, the sign of y at its end decides
whether the body struck the ground (Lemma 1). Where c > 1, there is no impact while y'
>= 0 (Lemma 2). For y' < 0 and c > 1, and for the time of an impact, the march goes on
by the time for which y + y' t - K t^2/2 stays positive (Lemma 12).
"""

import math
from bisect import bisect_left
from collections.abc import Sequence
from operator import mul
from typing import NamedTuple

import numpy as np

from ..equations.recurrence import motion_terms
from ..equations.taylor import LONGEST, MOST_TERMS
from ..outcome import FALLEN, Outcome
from .lane import Lane, LaneEdge
from .series_roots import first_root, only_root, turns, value
from .state import Ended, Listener, MarchState
from .straight_lines import RECIPROCALS, StraightLines

_INSTANT = 1e-12  # share of a step: a shorter part of it is rounding of its ends
_SHORTEST = 1e-14  # tau: a body that needs a shorter step fails
_ROOM = 0.9  # part of the step that the last terms allow, for the next attempt
_DEGREE = 18  # degree of series under sinusoids
_NUMBERS = [float(n) for n in range(MOST_TERMS + 1)]
_CHORD_ERRORS = [0.125 * n * (n - 1) * (n - 2) for n in range(MOST_TERMS + 1)]


def march(
    lane: Lane,
    amplitude: float,
    *,
    peaks: bool = True,
    listener: Listener | None = None,
    release: float = 0.0,
    most: int = 1 << 62,
) -> Ended:
    """The outcome of a body under A = amplitude, from rest or released to the right
    from theta/alpha = release.

    peaks: True if the largest rotation is wanted; most: number of steps and of impacts
    beyond which the outcome is FAILED.
    """
    cells = lane.system.contact.cells(
        lane.system.equation, np.array([amplitude]), lane.omega, lane.eta
    )
    return _March(lane, cells, lane.edges(amplitude), peaks, listener, most).run(
        release
    )


class WindowStep(NamedTuple):
    """A step within one window of the net drive, with its series."""

    h: float  # length [tau of the side]
    to: float  # phase of its end in the segment [rad]
    start: tuple[float, float]  # s and the vertical s_v at its start [-]
    stop: tuple[float, float]  # s and the vertical s_v at its end [-]
    terms: list[float]  # Taylor terms of y, in powers of the time over h


class _March(MarchState):
    """The march of one body from event to event."""

    def run(self, release: float) -> Ended:
        count = self.drive_lists.count
        if release:
            self.y = float(
                self.equation.on(np.ones(1)).displacement(np.array([release]))[0]
            )
            self.peak = max(self.peak, self.y)
            self._note("release", self.y, 0.0)
        else:
            self._uplift(first=True)
        while self.end is None:
            if self.segment >= count:
                self._free()
                break
            # Only damped bodies march on over still ground, until they have settled.
            if (
                self.segment >= self.lane.shaken
                and self.listener is None
                and self._settled()
            ):
                break
            # Whole lines of a record if possible, else one step.
            self.steps += 1
            if not (
                self.drive_lists.straight
                and (self.y > 0.0 or self.v > 0.0)
                and self._march_lines()
            ):
                self._step()
            if self.steps > self.most:
                self._finish(Outcome.FAILED)
        return self.end or self._finish(Outcome.FAILED)

    def _march_lines(self) -> bool:
        """March over whole straight lines of a record until an impact, and apply it.
        Return True after an impact or at the end of the motion; otherwise the caller
        makes the next step.

        A line is taken if its series holds, Lemma 12 or the sign of y at its end (Lemma
        1) decides on an impact, and no turn is above the peak so far.
        """
        block, edge = self.drive_lists.at(self.segment), self.edge
        first, lengths = block.first, block.length
        if (
            edge.equation.composed
            or (lengths[self.segment - first] - self.phase) / edge.omega > self.reach
        ):
            return False
        lines = StraightLines(block, edge, self.lane.zeta, self.limits[edge.side])
        last = len(lengths)
        if self.free_fall is not None and self.free_fall.occurs[0]:
            last = min(last, max(0, int(self.free_fall.segment[0]) - first))
        top = self._top(edge)
        peak = -math.inf if self.listener is not None else self.peak / edge.unit

        k, u, y, v = self.segment - first, self.phase, self.y, self.v
        self.carried = y, v, 0.0
        while k < last:
            # Lemma 12: no impact within the line; otherwise the net drive must stay
            # below 1 for Lemma 1.
            h, drive, weight = lines.shaking(k, u)
            clear = lines.is_clear(y, v, h)
            if not clear and lines.supercritical(drive, weight):
                break

            # The last terms must show that the series holds over the whole line.
            terms = lines.terms(y, v, h, drive, weight, self.force)
            if abs(terms[-1]) + 0.25 * h * abs(terms[-2]) > self.least * h:
                break

            # No overturning, and no turn that may be above the peak so far.
            end, speed = sum(terms), sum(map(mul, _NUMBERS, terms))  # y and h y'
            if end >= top and speed > 0.0:
                break
            if lines.highest(y, end, h) > peak and self._may_turn(terms, speed):
                break

            # Lemma 1: y <= 0 at the end of a subcritical line means one impact in it.
            if not clear and end <= 0.0:
                self._impact_on_line(first + k, u, h, terms)
                return True
            self._keep(first + k, u, h, h, terms)
            k, u, y, v, self.force = k + 1, 0.0, end, speed / h, None
            self._carry_on((y, v), h)
        self._carry_on((y, v), 0.0, now=True)
        self.segment, self.phase, self.y, self.v = k + first, u, y, v
        return self.segment >= self.drive_lists.count

    def _impact_on_line(self, k: int, u: float, h: float, terms: list[float]) -> None:
        """Go from phase u of segment k to the only impact before its end, h [tau]
        later, and apply it.
        """
        hit = only_root(terms, h, self.edge.largest_fall, self.lane.zeta)
        self._keep(k, u, hit, h, terms)
        _, v = value(terms, hit / h, h)
        self._carry_on((0.0, v), hit, now=True)
        self._go_to(k, u + hit * self.edge.omega)
        self._impact(min(v, 0.0))

    def _go_to(self, k: int, u: float) -> None:
        """Set the position to phase u of segment k, or to the start of the next segment
        if u is beyond its end.
        """
        block = self.drive_lists.at(k)
        inside = u < block.length[k - block.first]
        self.segment, self.phase = (k, u) if inside else (k + 1, 0.0)

    @staticmethod
    def _may_turn(terms: list[float], speed: float) -> bool:
        """True if the body may turn inwards in a step; speed: h y' at its end, or at an
        earlier impact.

        h y' leaves its chord by at most n (n - 1)(n - 2)/8 of term n.
        """
        if terms[1] > 0.0 >= speed:
            return True
        chord_error = sum(
            c * abs(term) for c, term in zip(_CHORD_ERRORS, terms, strict=False)
        )
        return abs(terms[1]) < chord_error or abs(speed) < chord_error

    def _keep(
        self, k: int, u: float, reach: float, h: float, terms: Sequence[float]
    ) -> None:
        """Show a step from phase u of segment k to the listener, if there is one."""
        if self.listener is not None:
            self.listener.keep(
                self.lane.tau(k, u),
                reach,
                self.edge.side,
                float(self.lane.omega[0]) / self.edge.omega,
                h,
                terms,
            )

    def _top(self, edge: LaneEdge) -> float:
        """The y beyond which the march tests whether a body that moves outwards can
        come back.
        """
        return (
            edge.top
            if self.listener is None
            else self.listener.fallen[0 if edge.side > 0.0 else 1]
        )

    def _step(self) -> None:
        """Take one step within one window of the net drive, or to the impact in it."""
        edge, k, u = self.edge, self.segment, self.phase
        length, whole = self._ahead()
        h = min(whole, LONGEST, self.reach)

        # The ground falls away from the body now, or ends the step.
        if self.free_fall is not None and self.free_fall.occurs[0]:
            left = float(self.free_fall.time_left(self._lanes())[0])
            if self.free_fall.has_begun(self._lanes())[0]:
                self._fall_freely()
                return
            h = min(h, left)

        step = self._held_step(h)
        y, v = (math.nan, math.nan) if step is None else value(step.terms, 1.0, step.h)
        if step is None or not math.isfinite(y):
            self._finish(Outcome.FAILED)
            return

        # The first impact in the step, then the peaks before it or before its end.
        hit = self._impact_time(step, y)
        reach = step.h if hit is None else hit
        if hit is not None:
            y, v = value(step.terms, hit / step.h, step.h)
            v = min(v, 0.0)
        self._peaks(step.terms, step.h, reach, v)
        if reach > 0.0:
            self._keep(k, u, reach, step.h, step.terms)
            if self.carries:
                self.moments = self._carried((self.y, self.v), (y, v), reach)

        # The position and the state at the impact or at the end of the step.
        if hit is not None:
            to = u + hit * edge.omega
            inside = hit < whole and to < length
            self.segment, self.phase = (k, to) if inside else (k + 1, 0.0)
            self._impact(v)
            return
        self._go_to(k, step.to)
        self.y, self.v, self.force = y, v, None
        if self.end is None and (y >= edge.limit or (y >= self._top(edge) and v > 0.0)):
            self._check_overturned()

    def _ahead(self) -> tuple[float, float]:
        """(length of the present segment [rad], time to its end [tau])."""
        block = self.drive_lists.at(self.segment)
        length = block.length[self.segment - block.first]
        return length, (length - self.phase) / self.edge.omega

    def _fall_freely(self) -> None:
        """End the march of a body from which the ground falls away now."""
        equation = self.equation.on(np.array([self.edge.side]))
        fallen = float(equation.rotation(np.array([self.y]))[0]) >= FALLEN
        self._finish(self._overturned() if fallen else Outcome.LOST_CONTACT)

    def _held_step(self, h: float) -> WindowStep | None:
        """The longest step, at most h [tau], within one window of the net drive and
        with a series that holds; None if there is none.
        """
        edge, k, u = self.edge, self.segment, self.phase
        length, whole = self._ahead()
        start = self.drive_lists.value(k, u)
        while True:
            to = length if h == whole else u + h * edge.omega
            stop = self.drive_lists.value(k, to)

            # The window of Lemmas 1 and 2 ends where the net drive passes 1.
            share = self._window(h, edge.net(*start), edge.net(*stop))
            if _INSTANT < share < 1.0 - _INSTANT:
                h *= share
                to = u + h * edge.omega
                stop = self.drive_lists.value(k, to)

            # A step for which the series does not hold is made shorter.
            terms, allowed = self._terms(h, start, stop)
            if allowed >= h:
                self.reach = min(LONGEST, 2.0 * h if h >= self.reach else self.reach)
                return WindowStep(h, to, start, stop, terms)
            h = self.reach = _ROOM * allowed if allowed > 0.0 else 0.5 * h
            if not h > _SHORTEST:
                return None

    def _impact_time(self, step: WindowStep, y: float) -> float | None:
        """The time in a step [tau] of its first impact, None without one; y: at the end
        of the step.
        """
        edge, zeta = self.edge, self.lane.zeta
        if edge.net(*step.start) + edge.net(*step.stop) < 2.0:
            # Subcritical: an impact lies in the step if y <= 0 at its end (Lemma 1).
            if y > 0.0:
                return None
            if self.drive_lists.straight:
                inward = -min(edge.drive * step.start[0], edge.drive * step.stop[0])
            else:
                inward = abs(edge.drive) * self.lane.largest
            fall = edge.largest_lift + edge.largest_push * max(0.0, inward)
            return only_root(step.terms, step.h, fall, zeta)
        # Supercritical: no impact while the body moves outwards (Lemma 2).
        return (
            first_root(step.terms, step.h, edge.largest_fall, zeta)
            if self.v < 0.0
            else None
        )

    def _window(self, h: float, c0: float, c1: float) -> float:
        """The share of a step of length h at which the net drive, which is monotone
        from c0 to c1, passes 1; 0 if it does not.
        """
        if not (c0 - 1.0) * (c1 - 1.0) < 0.0:
            return 0.0
        if self.drive_lists.straight:
            return (1.0 - c0) / (c1 - c0)
        edge, low, high, rises = self.edge, 0.0, 1.0, c1 > c0
        while high - low > 1e-15:
            middle = 0.5 * (low + high)
            net = self._net(edge, self.segment, self.phase + middle * h * edge.omega)
            low, high = (low, middle) if (net > 1.0) == rises else (middle, high)
        return high

    def _terms(
        self, h: float, start: tuple[float, float], stop: tuple[float, float]
    ) -> tuple[list[float], float]:
        """(Taylor terms of y over a step h, the time for which they hold [tau]); start,
        stop: s and s_v at its ends.
        """
        equation = self.edge.equation
        if self.drive_lists.straight:
            drive, weight, degree = self._line(h, start, stop)
        else:
            drive, weight, degree = self._waves(h, start)
        degree = min(degree, equation.composed or MOST_TERMS)
        factors = [h * h * c for c in RECIPROCALS[: degree - 1]]
        terms = motion_terms(
            equation, self.y, self.v, h, factors, drive, weight, self.force
        )

        # The last two terms show for how long the series keeps the tolerance.
        error = abs(terms[-1]) + 0.25 * h * abs(terms[-2])
        held = h
        if error > self.least * h:
            held = h * (self.least * h / error) ** (1.0 / (degree - 1.0))

        # F and G hold up to a distance from y.
        room, moved = equation.room(self.y), sum(map(abs, terms[1:]))
        return terms, min(held, h * room / moved) if moved > room else held

    def _line(
        self, h: float, start: tuple[float, float], stop: tuple[float, float]
    ) -> tuple[list[float], list[float] | None, int]:
        """(series of the outward drive, series of the weight, degree that the motion
        needs) along a straight line.
        """
        edge, (s0, up0), (s1, up1) = self.edge, start, stop
        drive, weight = [edge.drive * s0, edge.drive * (s1 - s0)], None
        size = 2.0 + abs(drive[0]) + abs(self.v) + abs(drive[1]) / h
        if self.lane.weighed:
            weight = [1.0 + edge.sway * up0, edge.sway * (up1 - up0)]
            size += abs(weight[0]) + abs(weight[1]) / h
        return drive, weight, 3 + bisect_left(self.limits[edge.side], size)

    def _waves(
        self, h: float, start: tuple[float, float]
    ) -> tuple[list[float], list[float] | None, int]:
        """As `_line`, along sinusoids."""
        edge, weight = self.edge, None
        drive, *up = (
            wave.terms(self.phase, h * edge.omega, _DEGREE - 2)
            for wave in self.drive_lists.waves(self.segment)
        )
        drive[0] = start[0]
        drive = [edge.drive * x for x in drive]
        if up:
            weight = [edge.sway * x for x in up[0]]
            weight[0] = 1.0 + edge.sway * start[1]
        return drive, weight, _DEGREE

    def _peaks(self, terms: list[float], h: float, reach: float, v: float) -> None:
        """Find turning points where y' falls through 0, up to `reach`, at which y' is
        v.
        """
        if not self.watched:
            return
        # No turn: h y' keeps its sign.
        if not self._may_turn(terms, v * h):
            return

        # No turn of interest: the step stays below the peak so far.
        highest = self._onto_first(terms[0] + sum(map(abs, terms[1:])))
        if self.listener is None and highest <= self.peak:
            return

        for x in turns(terms, reach / h):
            y, _ = value(terms, x, h)
            top = self._onto_first(y)
            if self.carries and top >= self.peak:
                start = terms[0], terms[1] / h
                self._at_peak(self._carried(start, (y, 0.0), x * h)[0], y)
            self.peak = max(self.peak, top)
            if y >= self.edge.limit:
                self._finish(self._overturned())
            elif self.listener is not None:
                self.listener.note(
                    self.lane.tau(self.segment, self.phase + x * h * self.edge.omega),
                    "peak",
                    self.edge.side,
                    y,
                    0.0,
                )
