"""The march of one body on floats, from event to event.

The drive here is the net drive c (`weight`), which is the outward drive a under a constant weight. A step ends at the latest where its
segment ends, on which c is monotone, or where c = 1; so it lies in one window. Where c < 1, the sign of y at its end decides whether the
body struck the ground (Lemma 1). Where c > 1, there is no impact while y' >= 0 (Lemma 2). Where y' < 0 and c > 1, and to find the time of
an impact, the march goes on by the time for which y + y' t - K t^2/2 stays positive (Lemma 12), and so reaches the first root from the
left. Compiled code (`recurrence`) takes whole segments of straight lines on which this bound stays positive.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from ..equations.taylor import LONGEST
from ..outcome import FALLEN, Outcome
from .lane import Face, Lane
from .series_roots import first_root, only_root, turns, value
from .state import Body, Ended, Listener

_INSTANT = 1e-12  # share of a step: a shorter part of it is rounding of its ends
_ROOM = 0.9  # part of the step that the last terms allow, for the next trial


def march(
    lane: Lane, amplitude: float, *, peaks: bool = True, listener: Listener | None = None, release: float = 0.0, most: int = 1 << 62
) -> Ended:
    """The outcome of a body under A = amplitude, from rest or released to the right from theta/alpha = release.

    peaks: True if the largest rotation is wanted; most: number of steps and of impacts beyond which the outcome is FAILED.
    """
    cells = lane.system.contact.cells(lane.system.equation, np.array([amplitude]), lane.omega, lane.eta)
    return _March(lane, cells, lane.faces(amplitude), peaks, listener, most).run(release)


class _March(Body):
    """The march of one body from event to event."""

    def run(self, release: float) -> Ended:
        count = self.reel.count
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
            if not (self.reel.straight and (self.y > 0.0 or self.v > 0.0) and self._coast()):
                self._step()
            if self.steps > self.most:
                self._finish(Outcome.FAILED)
        return self.end or self._finish(Outcome.FAILED)

    def _coast(self) -> bool:
        """March over straight lines by compiled code, up to an impact, which is applied; False where it leaves a step to its caller."""
        block, face = self.reel.at(self.k), self.face
        k, last = self.k - block.first, len(block.length)
        if face.code.coast is None or (block.length[k] - self.u) / face.omega > self.reach:
            return False
        if self.drop is not None and self.drop.ever[0]:
            last = min(last, max(0, int(self.drop.k[0]) - block.first))
        keep = None if self.listener is None else partial(self._kept, block.first)
        peak = -math.inf if self.listener is not None else self.peak / face.unit
        lists, sway = ((block.up, block.up_rise), {"sway": face.sway}) if self.lane.weighed else ((), {})
        after, u, self.y, v, struck = face.code.coast(
            k, self.u, last, self.y, self.v, self.force, block.start, block.rise, block.length, *lists, face.drive, 1.0 / face.omega,
            face.fall, self._top(face), peak, self.least, keep, **sway,
        )  # fmt: skip
        if after != k or struck:
            self.force = None
        self.k, self.u, self.v = (after + block.first, u, v) if u == 0.0 or u < block.length[after] else (after + block.first + 1, 0.0, v)
        if struck:
            self._impact(v)
        return struck or self.k >= self.reel.count

    def _kept(self, first: int, k: int, u: float, reach: float, h: float, terms: tuple[float, ...]) -> None:
        assert self.listener is not None
        self.listener.keep(self.lane.tau(first + k, u), reach, self.face.side, float(self.lane.omega[0]) / self.face.omega, h, terms)

    def _top(self, face: Face) -> float:
        """The y beyond which the march tests whether a body that moves outwards can come back."""
        return face.top if self.listener is None else self.listener.fallen[0 if face.side > 0.0 else 1]

    def _step(self) -> None:
        """Take one step within one window."""
        face, k, u = self.face, self.k, self.u
        block = self.reel.at(k)
        length = block.length[k - block.first]
        whole = (length - u) / face.omega
        h = min(whole, LONGEST, self.reach)
        if self.drop is not None and self.drop.ever[0]:
            left = float(self.drop.until(self._lanes())[0])
            if self.drop.now(self._lanes())[0]:
                fallen = float(self.equation.on(np.array([face.side])).rotation(np.array([self.y]))[0]) >= FALLEN
                self._finish(self._overturned() if fallen else Outcome.LOST_CONTACT)
                return
            h = min(h, left)
        s0, up0 = self.reel.value(k, u)
        while True:
            to = length if h == whole else u + h * face.omega
            s1, up1 = self.reel.value(k, to)
            c0, c1 = face.drive * s0 - face.sway * up0, face.drive * s1 - face.sway * up1
            share = self._window(face, k, u, h, c0, c1) if (c0 - 1.0) * (c1 - 1.0) < 0.0 else 0.0
            if _INSTANT < share < 1.0 - _INSTANT:
                h *= share
                to = u + h * face.omega
                s1, up1 = self.reel.value(k, to)
                c1 = face.drive * s1 - face.sway * up1
            terms, allowed = self._terms(face, k, u, h, (s0, up0), (s1, up1))
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
                inward = -min(face.drive * s0, face.drive * s1) if self.reel.straight else abs(face.drive) * self.lane.largest
                hit = only_root(terms, h, face.lift + face.push * max(0.0, inward), self.lane.zeta)
        elif self.v < 0.0:
            hit = first_root(terms, h, face.fall, self.lane.zeta)
        reach = h if hit is None else hit
        if hit is not None:
            y, v = value(terms, hit / h, h)
            v = min(v, 0.0)
        self._peaks(terms, h, reach, v)
        if self.listener is not None and reach > 0.0:
            self._kept(0, k, u, reach, h, terms)
        if hit is not None:
            to = u + hit * face.omega
            self.k, self.u = (k, to) if hit < whole and to < length else (k + 1, 0.0)
            self._impact(v)
            return
        self.k, self.u = (k, to) if to < length else (k + 1, 0.0)
        self.y, self.v, self.force = y, v, None
        if self.end is None and (y >= face.limit or (y >= self._top(face) and v > 0.0)):
            self._doubt()

    def _window(self, face: Face, k: int, u: float, h: float, c0: float, c1: float) -> float:
        """The share of a step at which c, which is monotone, passes 1."""
        if self.reel.straight:
            return (1.0 - c0) / (c1 - c0)
        low, high, rises = 0.0, 1.0, c1 > c0
        while high - low > 1e-15:
            middle = 0.5 * (low + high)
            beyond = (self._net(face, k, u + middle * h * face.omega) > 1.0) == rises
            low, high = (low, middle) if beyond else (middle, high)
        return high

    def _terms(
        self, face: Face, k: int, u: float, h: float, start: tuple[float, float], stop: tuple[float, float]
    ) -> tuple[tuple[float, ...], float]:
        """(Taylor terms of y over a step h, the time for which they hold)."""
        local, room, order, expand = None, math.inf, face.code.order, self.lane.laws[face.side].local
        if expand is not None:
            room, local = expand(self.y, order - 1)
        if self.reel.straight:
            (s0, up0), (s1, up1) = start, stop
            given = [face.drive * s0, face.drive * (s1 - s0)]
            if self.lane.weighed:
                given += [1.0 + face.sway * up0, face.sway * (up1 - up0)]
            terms = face.code.terms(self.y, self.v, h, *given, self.force, local)
        else:
            waves = self.reel.waves(k)
            lists = [wave.terms(u, h * face.omega, order - 2) for wave in waves]
            for values, s, factor, level in zip(lists, start, (face.drive, face.sway), (0.0, 1.0), strict=False):
                values[0] = s
                values[:] = [factor * x for x in values]
                values[0] += level
            terms = face.code.terms(self.y, self.v, h, *lists, self.force, local)
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
        unit = self.face.unit
        start, stop = terms[1], v * h
        if not start > 0.0 >= stop:  # y' leaves its chord by at most h^2/8 of its second derivative, most of it from the first terms
            bend = 1.5 * abs(terms[3]) + 6.0 * abs(terms[4]) + 15.0 * abs(terms[5]) + 30.0 * abs(terms[6])
            if min(abs(start), abs(stop)) >= bend:
                return
        if self.listener is None and (terms[0] + sum(map(abs, terms[1:]))) * unit <= self.peak:
            return
        for x in turns(terms, reach / h):
            y, _ = value(terms, x, h)
            self.peak = max(self.peak, y * unit)
            if y >= self.face.limit:
                self._finish(self._overturned())
            elif self.listener is not None:
                self.listener.note(self.lane.tau(self.k, self.u + x * h * self.face.omega), "peak", self.face.side, y, 0.0)
