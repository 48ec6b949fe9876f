"""The march of one body on floats, from event to event.

The drive here is the net drive c (`weight`). A step lies in one window: it ends at the latest where its segment ends or c = 1. Where c < 1,
the sign of y at its end decides whether the body struck the ground (Lemma 1). Where c > 1, there is no impact while y' >= 0 (Lemma 2). For
y' < 0 and c > 1, and for the time of an impact, the march goes on by the time for which y + y' t - K t^2/2 stays positive (Lemma 12).
"""

import math
from functools import partial

import numpy as np

from ..equations.taylor import LONGEST
from ..outcome import FALLEN, Outcome
from .lane import Edge, Lane
from .series_roots import first_root, only_root, turns, value
from .state import Body, Ended, Listener

_INSTANT = 1e-12  # share of a step: a shorter part of it is rounding of its ends
_ROOM = 0.9  # part of the step that the last terms allow, for the next attempt


def march(
    lane: Lane, amplitude: float, *, peaks: bool = True, listener: Listener | None = None, release: float = 0.0, most: int = 1 << 62
) -> Ended:
    """The outcome of a body under A = amplitude, from rest or released to the right from theta/alpha = release.

    peaks: True if the largest rotation is wanted; most: number of steps and of impacts beyond which the outcome is FAILED.
    """
    cells = lane.system.contact.cells(lane.system.equation, np.array([amplitude]), lane.omega, lane.eta)
    return _March(lane, cells, lane.edges(amplitude), peaks, listener, most).run(release)


class _March(Body):
    """The march of one body from event to event."""

    def run(self, release: float) -> Ended:
        count = self.drive_lists.count
        if release:
            self.y = float(self.equation.on(np.ones(1)).displacement(np.array([release]))[0])
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
            if not (self.drive_lists.straight and (self.y > 0.0 or self.v > 0.0) and self._march_lines()):
                self._step()
            if self.steps > self.most:
                self._finish(Outcome.FAILED)
        return self.end or self._finish(Outcome.FAILED)

    def _march_lines(self) -> bool:
        """March over the straight lines of a record by compiled code until an impact, and apply it. Return True after an impact or
        at the end of the motion; otherwise the caller makes the next step."""
        block, edge = self.drive_lists.at(self.k), self.edge
        k, last = self.k - block.first, len(block.length)
        if edge.code.march_lines is None or (block.length[k] - self.u) / edge.omega > self.reach:
            return False
        if self.free_fall is not None and self.free_fall.occurs[0]:
            last = min(last, max(0, int(self.free_fall.k[0]) - block.first))
        keep = None if self.listener is None else partial(self._kept, block.first)
        peak = -math.inf if self.listener is not None else self.peak / edge.unit
        lists, sway = ((block.up, block.up_rise), {"sway": edge.sway}) if self.lane.weighed else ((), {})
        after, u, self.y, v, struck = edge.code.march_lines(
            k, self.u, last, self.y, self.v, self.force, block.start, block.rise, block.length, *lists, edge.drive, 1.0 / edge.omega,
            edge.fall, self._top(edge), peak, self.least, keep, **sway,
        )  # fmt: skip
        if after != k or struck:
            self.force = None
        self.k, self.u, self.v = (after + block.first, u, v) if u == 0.0 or u < block.length[after] else (after + block.first + 1, 0.0, v)
        if struck:
            self._impact(v)
        return struck or self.k >= self.drive_lists.count

    def _kept(self, first: int, k: int, u: float, reach: float, h: float, terms: tuple[float, ...]) -> None:
        assert self.listener is not None
        self.listener.keep(self.lane.tau(first + k, u), reach, self.edge.side, float(self.lane.omega[0]) / self.edge.omega, h, terms)

    def _top(self, edge: Edge) -> float:
        """The y beyond which the march tests whether a body that moves outwards can come back."""
        return edge.top if self.listener is None else self.listener.fallen[0 if edge.side > 0.0 else 1]

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
                fallen = float(self.equation.on(np.array([edge.side])).rotation(np.array([self.y]))[0]) >= FALLEN
                self._finish(self._overturned() if fallen else Outcome.LOST_CONTACT)
                return
            h = min(h, left)
        s0, up0 = self.drive_lists.value(k, u)
        while True:
            to = length if h == whole else u + h * edge.omega
            s1, up1 = self.drive_lists.value(k, to)
            c0, c1 = edge.drive * s0 - edge.sway * up0, edge.drive * s1 - edge.sway * up1
            share = self._window(edge, k, u, h, c0, c1) if (c0 - 1.0) * (c1 - 1.0) < 0.0 else 0.0
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
                inward = -min(edge.drive * s0, edge.drive * s1) if self.drive_lists.straight else abs(edge.drive) * self.lane.largest
                hit = only_root(terms, h, edge.lift + edge.push * max(0.0, inward), self.lane.zeta)
        elif self.v < 0.0:
            hit = first_root(terms, h, edge.fall, self.lane.zeta)
        reach = h if hit is None else hit
        if hit is not None:
            y, v = value(terms, hit / h, h)
            v = min(v, 0.0)
        self._peaks(terms, h, reach, v)
        if self.listener is not None and reach > 0.0:
            self._kept(0, k, u, reach, h, terms)
        if hit is not None:
            to = u + hit * edge.omega
            self.k, self.u = (k, to) if hit < whole and to < length else (k + 1, 0.0)
            self._impact(v)
            return
        self.k, self.u = (k, to) if to < length else (k + 1, 0.0)
        self.y, self.v, self.force = y, v, None
        if self.end is None and (y >= edge.limit or (y >= self._top(edge) and v > 0.0)):
            self._check_overturned()

    def _window(self, edge: Edge, k: int, u: float, h: float, c0: float, c1: float) -> float:
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
        self, edge: Edge, k: int, u: float, h: float, start: tuple[float, float], stop: tuple[float, float]
    ) -> tuple[tuple[float, ...], float]:
        """(Taylor terms of y over a step h, the time for which they hold)."""
        local, room, order, expand = None, math.inf, edge.code.order, self.lane.laws[edge.side].local
        if expand is not None:
            room, local = expand(self.y, order - 1)
        if self.drive_lists.straight:
            (s0, up0), (s1, up1) = start, stop
            given = [edge.drive * s0, edge.drive * (s1 - s0)]
            if self.lane.weighed:
                given += [1.0 + edge.sway * up0, edge.sway * (up1 - up0)]
            terms = edge.code.terms(self.y, self.v, h, *given, self.force, local)
        else:
            waves = self.drive_lists.waves(k)
            lists = [wave.terms(u, h * edge.omega, order - 2) for wave in waves]
            for values, s, factor, level in zip(lists, start, (edge.drive, edge.sway), (0.0, 1.0), strict=False):
                values[0] = s
                values[:] = [factor * x for x in values]
                values[0] += level
            terms = edge.code.terms(self.y, self.v, h, *lists, self.force, local)
        error = abs(terms[-1]) + 0.25 * h * abs(terms[-2])
        held = h if error <= self.least * h else h * (self.least * h / error) ** (1.0 / (order - 1.0))
        if room < math.inf:
            moved = sum(abs(x) for x in terms[1:])
            held = min(held, h * room / moved if moved > room else held)
        return terms, held

    def _peaks(self, terms: tuple[float, ...], h: float, reach: float, v: float) -> None:
        """Find turning points where y' falls through 0, up to `reach`, at which y' is v."""
        if not self.watched:
            return
        unit = self.edge.unit
        start, stop = terms[1], v * h
        if not start > 0.0 >= stop:  # y' leaves its chord by at most h^2/8 of its second derivative, most of it from the first terms
            chord_error = 1.5 * abs(terms[3]) + 6.0 * abs(terms[4]) + 15.0 * abs(terms[5]) + 30.0 * abs(terms[6])
            if min(abs(start), abs(stop)) >= chord_error:
                return
        if self.listener is None and (terms[0] + sum(map(abs, terms[1:]))) * unit <= self.peak:
            return
        for x in turns(terms, reach / h):
            y, _ = value(terms, x, h)
            self.peak = max(self.peak, y * unit)
            if y >= self.edge.limit:
                self._finish(self._overturned())
            elif self.listener is not None:
                self.listener.note(self.lane.tau(self.k, self.u + x * h * self.edge.omega), "peak", self.edge.side, y, 0.0)
