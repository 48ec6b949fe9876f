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

import numpy as np

from ..equations.recurrence import motion_terms
from ..equations.taylor import LONGEST, MOST_TERMS
from ..outcome import FALLEN, Outcome
from .lane import Lane, LaneEdge
from .series_roots import first_root, only_root, turns, value
from .state import Ended, Listener, MarchState

_INSTANT = 1e-12  # share of a step: a shorter part of it is rounding of its ends
_ROOM = 0.9  # part of the step that the last terms allow, for the next attempt
_DEGREE = 18  # degree of series under sinusoids
_NUMBERS = [float(n) for n in range(MOST_TERMS + 1)]
_RECIPROCALS = [1.0 / ((n + 1) * (n + 2)) for n in range(MOST_TERMS)]
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
            if self.k >= count:
                self._free()
                break
            if self.k >= self.lane.shaken and self.listener is None and self._settled():
                break
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
        block, edge, equation = (
            self.drive_lists.at(self.k),
            self.edge,
            self.edge.equation,
        )
        starts, rises, lengths = block.start, block.rise, block.length
        last = len(lengths)
        if (
            equation.composed
            or (lengths[self.k - block.first] - self.u) / edge.omega > self.reach
        ):
            return False
        if self.free_fall is not None and self.free_fall.occurs[0]:
            last = min(last, max(0, int(self.free_fall.k[0]) - block.first))
        peak = -math.inf if self.listener is not None else self.peak / edge.unit
        top, fall, drag, least = self._top(edge), edge.fall, self.lane.zeta, self.least
        limits, weight, lifts, lifts_then = self.limits[edge.side], None, 1.0, 1.0
        push, pace, factors, built = edge.drive, 1.0 / edge.omega, [], (0.0, 0)
        k, u, y, v = self.k - block.first, self.u, self.y, self.v
        while k < last:
            # The drive and the weight along the line, or along the rest of it.
            h, drive, gain = lengths[k] * pace, push * starts[k], push * rises[k]
            over = u / lengths[k] if u else 0.0
            if self.lane.weighed:
                lifts, heavier = (
                    1.0 + edge.sway * block.up[k],
                    edge.sway * block.up_rise[k],
                )
                lifts, heavier = lifts + heavier * over, heavier - heavier * over
                lifts_then, weight = lifts + heavier, [lifts, heavier]
            if over:
                drive, gain, h = drive + gain * over, gain - gain * over, h - h * over

            # Lemma 12: no impact within the line; otherwise the net drive must stay
            # below 1 for Lemma 1.
            first, square = v * h, h * h
            clear = y + first - drag * h * abs(first) > 0.5 * fall * square
            if not clear and (drive > lifts or drive + gain > lifts_then):
                break

            size = (
                2.0
                + abs(drive)
                + abs(v)
                + (abs(gain) if weight is None else abs(gain) + abs(heavier)) / h
                + lifts
            )
            degree = 3 + bisect_left(limits, size)
            if built != (h, degree):  # most lines are as long as the one before
                factors, built = (
                    [square * c for c in _RECIPROCALS[: degree - 1]],
                    (h, degree),
                )
            terms = motion_terms(
                equation, y, v, h, factors, [drive, gain], weight, self.force
            )
            if abs(terms[-1]) + 0.25 * h * abs(terms[-2]) > least * h:
                break
            end, speed = sum(terms), sum(map(mul, _NUMBERS, terms))
            if end >= top and speed > 0.0:
                break
            if max(y, end) + 0.125 * fall * square * (
                math.exp(2.0 * drag * h) if drag else 1.0
            ) > peak and self._may_turn(terms, speed):
                break

            if not clear and end <= 0.0:
                hit = only_root(terms, h, fall, drag)
                self._keep(block.first + k, u, hit, h, terms)
                _, v = value(terms, hit / h, h)
                u += hit * edge.omega
                self.k, self.u = (
                    (block.first + k, u)
                    if u < lengths[k]
                    else (block.first + k + 1, 0.0)
                )
                self._impact(min(v, 0.0))
                return True
            self._keep(block.first + k, u, h, h, terms)
            k, u, y, v, self.force = k + 1, 0.0, end, speed / h, None
        self.k, self.u, self.y, self.v = k + block.first, u, y, v
        return self.k >= self.drive_lists.count

    @staticmethod
    def _may_turn(terms: list[float], speed: float) -> bool:
        """True if the body may turn inwards in a step; speed: h y' at its end.

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
        """Take one step within one window."""
        edge, k, u = self.edge, self.k, self.u
        block = self.drive_lists.at(k)
        length = block.length[k - block.first]
        whole = (length - u) / edge.omega
        h = min(whole, LONGEST, self.reach)
        if self.free_fall is not None and self.free_fall.occurs[0]:
            left = float(self.free_fall.time_left(self._lanes())[0])
            if self.free_fall.has_begun(self._lanes())[0]:
                fallen = (
                    float(
                        self.equation.on(np.array([edge.side])).rotation(
                            np.array([self.y])
                        )[0]
                    )
                    >= FALLEN
                )
                self._finish(self._overturned() if fallen else Outcome.LOST_CONTACT)
                return
            h = min(h, left)
        s0, up0 = self.drive_lists.value(k, u)
        while True:
            to = length if h == whole else u + h * edge.omega
            s1, up1 = self.drive_lists.value(k, to)
            c0, c1 = (
                edge.drive * s0 - edge.sway * up0,
                edge.drive * s1 - edge.sway * up1,
            )
            share = (
                self._window(edge, k, u, h, c0, c1)
                if (c0 - 1.0) * (c1 - 1.0) < 0.0
                else 0.0
            )
            if _INSTANT < share < 1.0 - _INSTANT:
                h *= share
                to = u + h * edge.omega
                s1, up1 = self.drive_lists.value(k, to)
                c1 = edge.drive * s1 - edge.sway * up1
            terms, allowed = self._terms(edge, k, u, h, (s0, up0), (s1, up1))
            if allowed >= h:
                self.reach = min(LONGEST, 2.0 * h if h >= self.reach else self.reach)
                break
            h = self.reach = _ROOM * allowed if allowed > 0.0 else 0.5 * h
            if not h > 1e-14:
                self._finish(Outcome.FAILED)
                return
        y, v = value(terms, 1.0, h)
        if not math.isfinite(y):
            self._finish(Outcome.FAILED)
            return
        hit = None
        if c0 + c1 < 2.0:
            if y <= 0.0:
                inward = (
                    -min(edge.drive * s0, edge.drive * s1)
                    if self.drive_lists.straight
                    else abs(edge.drive) * self.lane.largest
                )
                hit = only_root(
                    terms, h, edge.lift + edge.push * max(0.0, inward), self.lane.zeta
                )
        elif self.v < 0.0:
            hit = first_root(terms, h, edge.fall, self.lane.zeta)
        reach = h if hit is None else hit
        if hit is not None:
            y, v = value(terms, hit / h, h)
            v = min(v, 0.0)
        self._peaks(terms, h, reach, v)
        if reach > 0.0:
            self._keep(k, u, reach, h, terms)
        if hit is not None:
            to = u + hit * edge.omega
            self.k, self.u = (k, to) if hit < whole and to < length else (k + 1, 0.0)
            self._impact(v)
            return
        self.k, self.u = (k, to) if to < length else (k + 1, 0.0)
        self.y, self.v, self.force = y, v, None
        if self.end is None and (y >= edge.limit or (y >= self._top(edge) and v > 0.0)):
            self._check_overturned()

    def _window(
        self, edge: LaneEdge, k: int, u: float, h: float, c0: float, c1: float
    ) -> float:
        """The share of a step at which c, which is monotone, passes 1."""
        if self.drive_lists.straight:
            return (1.0 - c0) / (c1 - c0)
        low, high, rises = 0.0, 1.0, c1 > c0
        while high - low > 1e-15:
            middle = 0.5 * (low + high)
            beyond = (self._net(edge, k, u + middle * h * edge.omega) > 1.0) == rises
            low, high = (low, middle) if beyond else (middle, high)
        return high

    def _terms(
        self,
        edge: LaneEdge,
        k: int,
        u: float,
        h: float,
        start: tuple[float, float],
        stop: tuple[float, float],
    ) -> tuple[list[float], float]:
        """(Taylor terms of y over a step h, the time for which they hold)."""
        equation, degree, weight = edge.equation, _DEGREE, None
        if self.drive_lists.straight:
            (s0, up0), (s1, up1) = start, stop
            drive = [edge.drive * s0, edge.drive * (s1 - s0)]
            size = 2.0 + abs(drive[0]) + abs(self.v) + abs(drive[1]) / h
            if self.lane.weighed:
                weight = [1.0 + edge.sway * up0, edge.sway * (up1 - up0)]
                size += abs(weight[0]) + abs(weight[1]) / h
            degree = 3 + bisect_left(self.limits[edge.side], size)
        else:
            waves = self.drive_lists.waves(k)
            drive, *up = (wave.terms(u, h * edge.omega, degree - 2) for wave in waves)
            drive[0] = start[0]
            drive = [edge.drive * x for x in drive]
            if up:
                weight = [edge.sway * x for x in up[0]]
                weight[0] = 1.0 + edge.sway * start[1]
        degree = min(degree, equation.composed or MOST_TERMS)
        factors = [h * h * c for c in _RECIPROCALS[: degree - 1]]
        terms = motion_terms(
            equation, self.y, self.v, h, factors, drive, weight, self.force
        )
        error = abs(terms[-1]) + 0.25 * h * abs(terms[-2])
        held = (
            h
            if error <= self.least * h
            else h * (self.least * h / error) ** (1.0 / (degree - 1.0))
        )
        room = equation.room(self.y)
        moved = sum(map(abs, terms[1:]))
        return terms, min(held, h * room / moved) if moved > room else held

    def _peaks(self, terms: list[float], h: float, reach: float, v: float) -> None:
        """Find turning points where y' falls through 0, up to `reach`, at which y' is
        v.
        """
        if not self.watched:
            return
        start, stop = terms[1], v * h
        # y' leaves its chord by at most h^2/8 of its second derivative, most of it from
        # the first terms
        if not start > 0.0 >= stop:
            chord_error = (
                1.5 * abs(terms[3])
                + 6.0 * abs(terms[4])
                + 15.0 * abs(terms[5])
                + 30.0 * abs(terms[6])
            )
            if min(abs(start), abs(stop)) >= chord_error:
                return
        if (
            self.listener is None
            and self._onto_first(terms[0] + sum(map(abs, terms[1:]))) <= self.peak
        ):
            return
        for x in turns(terms, reach / h):
            y, _ = value(terms, x, h)
            self.peak = max(self.peak, self._onto_first(y))
            if y >= self.edge.limit:
                self._finish(self._overturned())
            elif self.listener is not None:
                self.listener.note(
                    self.lane.tau(self.k, self.u + x * h * self.edge.omega),
                    "peak",
                    self.edge.side,
                    y,
                    0.0,
                )
