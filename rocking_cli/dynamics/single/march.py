"""The march of one body on floats, from event to event.

A step goes no further than one segment of the motion, where the net drive c (`weight`; a where the weight is steady) is monotone, nor
beyond c = 1, so that it lies in one window. In a valley (c < 1) the sign of y at its end decides whether the ground was struck (Lemma 1);
in a ridge nothing is struck while y' >= 0 (Lemma 2). Where y' < 0 in a ridge, and to find the instant of an impact, the march goes from
where it is by the time for which y + y' t - K t^2/2 stays positive (Lemma 12): so it comes to the first root from the left. Whole
segments of straight lines on which that bound is positive throughout are taken by compiled code (`recurrence`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from ..contacts.contact import Uplift
from ..contacts.sequences import BELOW_ROUNDING
from ..drive import place
from ..equations.ramp import LONGEST, WITHIN
from ..lanes import Cells, Lanes
from ..march.free_fall import FreeFall
from ..outcome import FALLEN, Outcome
from .lane import Face, Lane
from .roots import first_root, only_root, turns, value

_STILL = 1e-100  # a speed whose square a double does not hold is none
_INSTANT = 1e-12  # of a step: what is only the rounding of where it begins or ends
_ROOM = 0.9  # of the step that the last terms allow
Keep = Callable[[float, float, float, float, float, tuple[float, ...]], None]  # start [tau], reach [tau of the side], side, pace, h, terms
Note = Callable[[float, str, float, float, float], None]  # tau, event, side, y, y'


class Listener(NamedTuple):
    """What a march that is listened to tells, and does not leave out: bounces are followed down to the speed `visible`, and a body that
    falls to y = fallen (right, left)."""

    keep: Keep
    note: Note
    rest: Callable[[Lanes, Lanes], None]
    visible: float
    fallen: tuple[float, float]


class Ended(NamedTuple):
    """What became of the body: outcome, max |theta|/alpha (NaN where it fell), impacts during the shaking; lost: tau at which the ground
    falls away from it, where it does."""

    outcome: Outcome
    theta_ratio: float
    impacts: int
    lost: float | None = None


def march(
    lane: Lane, amplitude: float, *, peaks: bool = True, listener: Listener | None = None, release: float = 0.0, most: int = 1 << 62
) -> Ended:
    """What becomes of a body under A = amplitude, from rest or released to the right from theta/alpha = release.

    peaks: whether the largest rotation is wanted; most: steps and impacts, after which the body has failed.
    """
    cells = lane.system.contact.cells(lane.system.equation, np.array([amplitude]), lane.omega, lane.eta)
    return _Body(lane, cells, lane.faces(amplitude), peaks, listener, most).run(release)


class _Body:
    """The state of a march: segment k and phase u in it, the face it is on, y and y' there, the force where it is known to more digits than
    the drive tells, and the largest y so far in units of the first side."""

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
        """This body as a lane of one."""
        lanes = self.lane.lanes(self.cells, self.face.side)
        lanes.k[0], lanes.u[0], lanes.y[0], lanes.v[0] = self.k, self.u, self.y, self.v
        lanes.b[0] = self._net(self.face, self.k, self.u) - 1.0 if self.force is None else self.force
        lanes.peak[0] = self.peak / self.face.unit
        return lanes

    def _net(self, face: Face, k: int, u: float) -> float:
        """c at a place of the motion; of still ground after its end 0."""
        if k >= self.reel.count:
            return 0.0
        s, up = self.reel.value(k, u)
        return face.drive * s - face.sway * up

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
        """The straight segments that compiled code takes, and the impact that it comes to; True if it came to one or to the end."""
        block, face = self.reel.at(self.k), self.face
        k, last = self.k - block.first, len(block.length)
        if face.code.coast is None or (block.length[k] - self.u) / face.omega > self.reach:
            return False
        if self.drop is not None and self.drop.ever[0]:
            last = min(last, max(0, int(self.drop.k[0]) - block.first))
        keep = None if self.listener is None else partial(self._kept, block.first)
        top = face.top if self.listener is None else self._fallen(face)
        peak = -math.inf if self.listener is not None else self.peak / face.unit
        lists, sway = ((block.up, block.up_rise), {"sway": face.sway}) if self.lane.weighed else ((), {})
        after, u, self.y, v, struck = face.code.coast(
            k, self.u, last, self.y, self.v, self.force, block.start, block.rise, block.length, *lists, face.drive, 1.0 / face.omega,
            face.fall, top, peak, self.least, keep, **sway,
        )  # fmt: skip
        if after != k or struck:
            self.force = None
        self.k, self.u, self.v = after + block.first, u, v
        if struck:
            self._impact(v)
        return struck or self.k >= self.reel.count

    def _kept(self, first: int, k: int, u: float, reach: float, h: float, terms: tuple[float, ...]) -> None:
        assert self.listener is not None
        self.listener.keep(self.lane.tau(first + k, u), reach, self.face.side, float(self.lane.omega[0]) / self.face.omega, h, terms)

    def _fallen(self, face: Face) -> float:
        assert self.listener is not None
        return self.listener.fallen[0 if face.side > 0.0 else 1]

    def _step(self) -> None:
        """One step in one window."""
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
            self.listener.keep(self.lane.tau(k, u), reach, face.side, float(self.lane.omega[0]) / face.omega, h, terms)
        if hit is not None:
            to = u + hit * face.omega
            self.k, self.u = (k, to) if hit < whole and to < length else (k + 1, 0.0)
            self._impact(v)
            return
        self.k, self.u = (k, to) if to < length else (k + 1, 0.0)
        self.y, self.v, self.force = y, v, None
        top = face.top if self.listener is None else self._fallen(face)
        if self.end is None and (y >= face.limit or (y >= top and v > 0.0)):
            self._doubt()

    def _window(self, face: Face, k: int, u: float, h: float, c0: float, c1: float) -> float:
        """The share of a step until c, monotone, is 1."""
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
        """The terms over h, and the time for which they hold."""
        local, room, order = None, math.inf, face.code.order
        if self.lane.composed:
            room, local = self.lane.laws[face.side].local(self.y, order - 1)  # type: ignore[misc]
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
        """Turning points outwards until `reach`, where y' is v."""
        if not self.watched:
            return
        unit = self.face.unit
        start, stop = terms[1], v * h
        if not start > 0.0 >= stop:  # y' leaves the chord of its ends by at most h^2/8 of its bend, most of that from the first terms
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

    def _impact(self, v: float) -> None:
        """Impact with velocity v <= 0, by the rule of the contact."""
        face = self.face
        self._note("impact", 0.0, v)
        if self.k < self.lane.shaken:
            self.impacts += 1
        self.bounced = True
        to = self.faces.get(-face.side, face)
        self.face, self.y, self.v = to, 0.0, -face.keeps * v
        fall = 1.0 - self._net(to, self.k, self.u)
        self.force = -fall
        if self.k < self.reel.count and (self.v < _STILL or self._may_rest(to, fall)):
            lanes = self._lanes()
            if self.v < _STILL or self.contact.sequence_ends(self.segments, lanes, self.equation)[0]:
                self._uplift(lanes=lanes)

    def _may_rest(self, face: Face, fall: float) -> bool:
        """Whether Lemma 7 may prove that the bouncing ends in rest within this segment: what it asks that takes no arrays."""
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
        """From rest to the next uplift, if any."""
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
        """Beyond the unstable equilibrium and going on: whether nothing brings the body back (Lemma 6)."""
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
        """Whether a damped body on still ground can do nothing larger: without damping it would have more energy, and even so neither pass
        the barrier nor rise above its peak."""
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
        """On still ground, undamped: the free motion in closed form (Lemma 8)."""
        if self.lane.zeta:
            if not self._settled():  # asked here of a body that is listened to
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
