"""The response of one body in time: every arc with its exact flow or series, and what happened when.

It listens to the march of a single cell: nothing is closed early but the last, invisible part of a chatter, and the ground goes on
standing still after the motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..dynamics.drive import drive_change
from ..dynamics.equations.equation import Equation, Flow
from ..dynamics.lanes import Lanes
from ..dynamics.march.account import Rests, Round, Watch
from ..dynamics.march.engine import Run
from ..dynamics.outcome import FALLEN, Outcome
from ..dynamics.system import System
from ..dynamics.weight import WeighedSegments
from ..motions.motion import Motion
from ..motions.piece import Piece
from ..motions.segments import Segments

Array = np.ndarray

_INVISIBLE = 1e-4  # speed of a bounce, y' by tau: its height is below 1e-8
_SUMMED, _UNSEEN = 1e-3, 1000  # part of that speed at which the rest of a bouncing is summed, and bounces until then at most
LONGEST = 1e9  # tau: beyond, doubles do not tell the times of an arc apart
LOST = "lost contact"


class Arc(NamedTuple):
    """The motion between two times tau on one side, along one flow; pace: tau of the side over tau of the history."""

    start: float
    stop: float
    side: float
    flow: Flow
    pace: float


class Event(NamedTuple):
    """At a time tau: release, uplift, impact, peak, rest, overturning or lost contact; theta/alpha and its rate by tau (before
    an impact), and the side, +1 or -1. alpha is that of the side the body is on, tau = p t that of the edge that lifts first."""

    tau: float
    event: str
    theta_ratio: float
    rate: float
    side: float


@dataclass(frozen=True)
class History:
    """A response in time: arcs, events, the time tau at which it ends, what became of the body, also after that, and the largest
    |theta|/alpha of all, also after that (NaN where it overturned)."""

    equation: Equation
    arcs: tuple[Arc, ...]
    events: tuple[Event, ...]
    end: float
    outcome: Outcome
    highest: float

    def at(self, tau: Array) -> tuple[Array, Array]:
        """theta/alpha [-] and its derivative by tau [-] at times tau, arrays of one shape; zero at rest, NaN after the end."""
        tau = np.asarray(tau, dtype=float)
        ratio, rate = np.zeros(tau.shape), np.zeros(tau.shape)
        for arc in self.arcs:
            inside = np.flatnonzero((tau >= arc.start) & (tau <= arc.stop * (1.0 + 1e-14)))
            if inside.size:
                point = arc.flow.take(np.zeros(inside.size, dtype=np.int64)).at((tau[inside] - arc.start) * arc.pace)
                equation = self.equation.on(np.full(inside.size, arc.side))
                ratio[inside] = arc.side * equation.rotation(point.y)
                rate[inside] = arc.side * equation.rotation_rate(point.y, point.v) * arc.pace
        ratio, rate = ratio + 0.0, rate + 0.0  # no -0
        ratio[tau > self.end] = rate[tau > self.end] = np.nan
        return ratio, rate

    def sides(self, tau: Array) -> Array:
        """The side, +1 or -1, that the body is on at times tau; +1 at rest."""
        tau = np.asarray(tau, dtype=float)
        side = np.ones(tau.shape)
        for arc in self.arcs:
            side[(tau >= arc.start) & (tau <= arc.stop * (1.0 + 1e-14))] = arc.side
        return side

    def steps(self) -> Array:
        """The ends of the solver's own arcs, with the events, in tau."""
        marks = {0.0, self.end, *(a.start for a in self.arcs), *(a.stop for a in self.arcs), *(e.tau for e in self.events)}
        return np.array(sorted(marks))

    @property
    def theta_ratio(self) -> float | None:
        """max |theta|/alpha [-]: 0 where the body never left the ground, None where it overturned or was given up."""
        if self.outcome == Outcome.NO_UPLIFT:
            return 0.0
        if self.outcome != Outcome.ROCKED:
            return None
        return self.highest if self.peak is None else max(self.highest, abs(self.peak.theta_ratio))

    @property
    def peak(self) -> Event | None:
        """The event of the largest |theta|/alpha up to the end; None where the body never left the ground, or overturned."""
        if self.outcome != Outcome.ROCKED:
            return None
        found = [e for e in self.events if e.event in ("peak", "release")]
        return max(found, key=lambda e: abs(e.theta_ratio)) if found else None


def history(
    system: System, motion: Motion, amplitude: float, omega: float, eta: float, *, release: float = 0.0, duration: float
) -> History:
    """The response of one body at rest, or released from theta/alpha = release, up to tau = duration or the end of the shaking.

    Parameters as in `response`; amplitude 0 is free rocking. A body is released to its right side. Raises ValueError when a
    number is out of range.

    >>> (column,) = load_structures('configs/block.yaml')
    >>> found = history(Method().system_of(column), sine(), 2.0, 6.0, column.eta, duration=40.0)
    >>> [e.event for e in found.events][:3]
    ['uplift', 'peak', 'impact']
    """
    numbers = {"amplitude": amplitude, "omega": omega, "release": release, "duration": duration}
    for name, x in numbers.items():
        if not (math.isfinite(x) and x >= 0.0):
            raise ValueError(f"{name} is {x:g}, accepted is a finite number that is not negative")
    if not (omega > 0.0 and duration > 0.0 and release < 1.0):
        raise ValueError("omega and duration must be positive and release below 1")
    if motion.duration / omega > LONGEST:
        raise ValueError(f"omega is {omega:g}, accepted is one with which the shaking ends before tau = {LONGEST:g}")
    duration = max(motion.duration / omega, duration)
    listener = _Listener(system, system.segments(motion.still_until(1.001 * duration * omega)), amplitude, omega, eta)
    return listener.record(release, duration)


class _Listener:
    """Runs one cell round by round and writes down what it hears; times are tau of the history, phase over its omega."""

    def __init__(self, system: System, segments: Segments, amplitude: float, omega: float, eta: float) -> None:
        self.equation, self.segments, self.omega = system.equation, segments, omega
        right, left = (self._fallen(side) for side in (1.0, -1.0))
        watch = Watch((right, left), _INVISIBLE)
        a, w, n = (np.array([x]) for x in (amplitude, omega, eta))
        self.run = Run(system, segments, a, w, n, True, 1, watch)
        self.arcs, self.events = list[Arc](), list[Event]()

    def _fallen(self, side: float) -> float:
        """y at which a body on a side is lost: at `FALLEN`, or where it lies on its side."""
        equation = self.equation.on(np.array([side]))
        return min(float(np.min(equation.limit)), float(equation.displacement(np.array([FALLEN]))[0]))

    def record(self, release: float, duration: float) -> History:
        lanes = self._first(release)
        with np.errstate(all="ignore"):
            while lanes.cell.size:
                heard = self.run.round(lanes)
                self._hear(heard)
                lanes = heard.going
        if self.run.outcome[0] == Outcome.LOST_CONTACT and self.run.drops is not None:
            drop = self.run.drops
            self._lose(float(self.segments.start[drop.k[0]] + drop.u[0]) / self.omega)
        if self._doomed and not any(e.event == "overturning" for e in self.events):
            self._overturn(self.arcs[-1].stop)  # decided at the end of the shaking, and then left to fall
        end = min([duration, *(e.tau for e in self.events if e.event in ("overturning", LOST))])
        events = [e for e in self.events if e.tau <= end]
        arcs = tuple(a._replace(stop=min(a.stop, end)) for a in self.arcs if a.start <= end)
        return History(self.equation, arcs, tuple(events), end, self._became(), float(self.run.theta_ratio[0]))

    @property
    def _doomed(self) -> bool:
        """Whether the shaking is over and the body falls for certain."""
        return Outcome(int(self.run.outcome[0])).overturned

    def _became(self) -> Outcome:
        if self.run.outcome[0] == Outcome.FAILED:
            return Outcome.FAILED
        words = [e.event for e in self.events]
        if LOST in words:
            return Outcome.LOST_CONTACT
        if "overturning" in words:
            return Outcome.OVERTURNED_AFTER_IMPACT if "impact" in words else Outcome.OVERTURNED_NO_IMPACT
        if self._doomed:  # though not yet fallen as far as it is followed
            return Outcome(int(self.run.outcome[0]))
        return Outcome.ROCKED if words else Outcome.NO_UPLIFT

    def _first(self, release: float) -> Lanes:
        """The body before its first step: about to lift off, or released."""
        lanes = self.run.start(np.array([0]))
        if release == 0.0:
            if lanes.k[0] >= len(self.segments):
                return lanes.take(np.zeros(0, dtype=np.int64))
            self._note(self._tau(lanes), "uplift", lanes.side[0], 0.0, 0.0)
            return lanes
        lanes.k[:], lanes.u[:], lanes.v[:] = 0, 0.0, 0.0
        self.run.contact.turn(self.run.cells, lanes, np.array([0]), np.ones(1))
        equation = self.equation.on(lanes.side)
        lanes.y[:] = equation.displacement(np.array([release]))
        lanes.b[:] = equation.force(lanes.y, -lanes.side * lanes.amplitude * self.segments.s_start[0], self._weight(lanes))
        self._note(0.0, "release", 1.0, lanes.y[0], 0.0)
        return lanes

    def _weight(self, lanes: Lanes) -> Array | float:
        """The weight over m g [-] where and when the body is."""
        seg = self.segments
        return seg.weight(lanes.side, lanes.amplitude, lanes.k, lanes.u) if isinstance(seg, WeighedSegments) else 1.0

    def _tau(self, lanes: Lanes) -> float:
        k = min(int(lanes.k[0]), len(self.segments) - 1)
        whole = float(self.segments.length[k]) if lanes.k[0] >= len(self.segments) else float(lanes.u[0])
        return (float(self.segments.start[k]) + whole) / self.omega

    def _note(self, tau: float, event: str, side: float, y: float, v: float, pace: float = 1.0) -> None:
        tau = max(tau, self.events[-1].tau if self.events else 0.0)  # in order, whatever the last digit
        equation = self.equation.on(np.array([side]))
        rotation, rate = equation.rotation(np.array([y])), equation.rotation_rate(np.array([y]), np.array([v]))
        self.events.append(Event(tau, event, float(side * rotation[0]) + 0.0, float(side * rate[0]) * pace + 0.0, float(side)))  # no -0

    def _hear(self, heard: Round) -> None:
        """Write down the arc of a round, its crest, and how it ended."""
        before, passage = heard.lanes, heard.passage
        side, reach, start = float(before.side[0]), float(passage.reach[0]), self._tau(heard.lanes)
        pace = float(before.omega[0]) / self.omega  # tau of the history over tau of the side: omega is omega_g over p
        stop = summit = start + reach * pace
        self.arcs.append(Arc(start, stop, side, passage.arc, 1.0 / pace))
        limit = float(np.min(self.equation.on(np.array([side])).limit))
        for h, y in zip(heard.crests.h, heard.crests.y, strict=True):
            if y >= limit:
                summit = start + float(h) * pace  # beyond its limit, and perhaps back within this step
            else:
                self._note(start + float(h) * pace, "peak", side, float(y), 0.0)
        if passage.hit[0]:
            self._note(stop, "impact", side, 0.0, float(passage.impact_v[0]), 1.0 / pace)
        if heard.overturned[0]:
            self._overturn(summit)
        if heard.rests is not None:
            self._rest(heard.rests)

    def _overturn(self, summit: float) -> None:
        """The last time up to the summit at which the body passes the height to which it is followed; it may be many steps before it is
        certain that it falls."""
        arc, high = self.arcs[-1], summit
        fallen = self._fallen(arc.side)
        for before in self.arcs[-2::-1]:
            if float(arc.flow.at(np.zeros(1)).y[0]) < fallen:
                break
            arc, high = before, before.stop
        low = arc.start
        for _ in range(80):
            middle = 0.5 * (low + high)
            beyond = float(arc.flow.at(np.array([(middle - arc.start) * arc.pace])).y[0]) >= fallen
            low, high = (low, middle) if beyond else (middle, high)
        point = arc.flow.at(np.array([(high - arc.start) * arc.pace]))
        if float(point.y[0]) >= fallen * (1.0 - 1e-9):
            self.events = [e for e in self.events if e.tau <= high]
            self._note(high, "overturning", arc.side, float(point.y[0]), float(point.v[0]), arc.pace)

    def _lose(self, tau: float) -> None:
        """The instant from which the ground falls as fast as the body."""
        self.events = [e for e in self.events if e.tau <= tau]
        found = History(self.equation, tuple(self.arcs), (), tau, Outcome.LOST_CONTACT, math.nan)
        ratio, rate = (float(x[0]) for x in found.at(np.array([tau])))
        self.events.append(Event(tau, LOST, ratio, rate, self.arcs[-1].side if self.arcs else 1.0))

    def _rest(self, rests: Rests) -> None:
        """The end of the bouncing, by the sum of its series, and the uplift after it."""
        before, after = rests
        rest, lifts = self._bounced(before), after.k[0] < len(self.segments)
        if not lifts or self._tau(after) > rest:
            self._note(rest, "rest", 1.0, 0.0, 0.0)
        if lifts:
            self._note(self._tau(after), "uplift", float(after.side[0]), 0.0, 0.0)

    def _bounced(self, lanes: Lanes) -> float:
        """When bouncing too low to be seen comes to rest: bounce by bounce under forces that change evenly in each, and at last by the sum
        of its series."""
        lanes, contact = lanes.take(np.zeros(1, dtype=np.int64)), self.run.contact
        least = _SUMMED * lanes.v
        for _ in range(_UNSEEN):
            if lanes.v <= least:
                break
            h, change = -2.0 * lanes.v / lanes.b, np.zeros(1)
            for _ in range(3):
                change = self._lying(lanes, h) - lanes.b
                h = -2.0 * lanes.v / (lanes.b + change / 3.0)
            fall, force = lanes.v + h * (lanes.b + 0.5 * change), lanes.b + change
            lanes.u += lanes.omega * h
            contact.strike(self.run.cells, lanes, fall, force)
            lanes.b = self._lying(lanes, np.zeros(1))
        rest = contact.bouncing_time(lanes, self._weight(lanes)) * lanes.omega / self.omega
        return self._tau(lanes) + float(rest[0])

    def _lying(self, lanes: Lanes, h: Array) -> Array:
        """The force on a body on the ground after h [tau of its side]."""
        seg, u = self.segments, lanes.u + lanes.omega * h
        k = np.minimum(lanes.k, len(seg) - 1)  # the ground is still at the end
        if isinstance(seg, WeighedSegments):
            return seg.net(lanes.side, lanes.amplitude, k, u) - 1.0
        return -lanes.side * lanes.amplitude * (seg.s_start[k] + drive_change(seg, k, u)) - 1.0


def quarter_period(system: System, release: float) -> float:
    """Time tau [-] from release at theta/alpha to the first impact, on still ground. Raises ValueError."""
    reach = 4.0 * math.acosh(1.0 / (1.0 - release)) + 10.0
    free = history(system, Motion("still", (Piece(0.0, reach),)), 0.0, 1.0, 0.0, release=release, duration=reach)
    return next((e.tau for e in free.events if e.event == "impact"), math.inf)
