"""The response of one body in time: every arc as a series, and the events.

`history` listens to the march of one body on floats. Only the last, invisible part of a sequence of impacts is summed; all else is
followed in time. After the motion the ground is at rest.
"""

import math
from array import array
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.drive import drive_change
from ..dynamics.equations.equation import Equation, Point
from ..dynamics.equations.taylor import TaylorSeries
from ..dynamics.lanes import Lanes
from ..dynamics.march.batch import MAX_STEPS
from ..dynamics.outcome import FALLEN, LOST, Outcome
from ..dynamics.single.lane import Lane
from ..dynamics.single.march import march
from ..dynamics.single.state import Listener
from ..dynamics.system import System
from ..motions.blocks import blocks
from ..motions.motion import Motion, Piece
from ..motions.segments import Segments

Array = np.ndarray

INVISIBLE = 1e-4  # speed of a bounce, y' by tau: its height is below 1e-8
_SUMMED, _UNSEEN = 1e-3, 1000  # part of that speed at which the rest of a bouncing is summed, and bounces until then at most
LONGEST = 1e9  # tau: beyond, doubles do not tell the times of an arc apart
_KNOWN = (Outcome.ROCKED, Outcome.LEANING)  # outcomes with a largest rotation
LATE = 1.0 + 1e-14  # of a time: what still belongs to the arc that ends there


class Arcs(NamedTuple):
    """All arcs in the order of time, arrays (arcs,). An arc is the motion on one side between two times tau, given by one series, a lane of
    `flow`. pace: tau of the side over tau of the history."""

    start: Array
    stop: Array
    side: Array
    flow: TaylorSeries
    pace: Array

    def at(self, tau: Array) -> tuple[Array, Array]:
        """Return (the indices of the times that lie on an arc, the index of the arc of each)."""
        arc = np.searchsorted(self.start, tau, side="right") - 1
        inside = np.flatnonzero((arc >= 0) & (tau <= self.stop.take(arc) * LATE)) if self.start.size else np.zeros(0, dtype=np.int64)
        return inside, arc[inside]

    def points(self, arc: Array, tau: Array) -> Point:
        """Return y and its derivatives at times tau; arc: the index of the arc of each time."""
        return self.flow.take(arc).at((tau - self.start[arc]) * self.pace[arc])


class Event(NamedTuple):
    """An event at a time tau: release, uplift, impact, peak, rest, overturning, lost contact, or an event of a tie or tendon.

    theta/alpha and its rate by tau (before an impact), with alpha of the side on which the body is and tau = p t of the edge that lifts
    first; side: +1 or -1; device: the tie or tendon, "" without one."""

    tau: float
    event: str
    theta_ratio: float
    rate: float
    side: float
    device: str = ""


@dataclass(frozen=True)
class History:
    """A response in time: arcs, events, the time tau at which they end; the outcome and the largest |theta|/alpha of the whole motion,
    which may come later (NaN if the body overturned); devices: a row for each tie and tendon (`tied_history`)."""

    equation: Equation
    arcs: Arcs
    events: tuple[Event, ...]
    end: float
    outcome: Outcome
    highest: float
    devices: tuple[dict[str, Any], ...] = ()

    def at(self, tau: Array) -> tuple[Array, Array]:
        """Return theta/alpha [-] and its derivative by tau [-] at times tau, in the shape of tau; zero at rest, NaN after the end."""
        tau = np.asarray(tau, dtype=float)
        ratio, rate = np.zeros(tau.size), np.zeros(tau.size)
        for part in blocks(tau.size):
            here = tau.ravel()[part]
            inside, arc = self.arcs.at(here)
            if inside.size:
                side, pace = self.arcs.side[arc], self.arcs.pace[arc]
                point = self.arcs.points(arc, here[inside])
                equation = self.equation.on(side)
                ratio[part][inside] = side * equation.rotation(point.y)
                rate[part][inside] = side * equation.rotation_rate(point.y, point.v) * pace
        over = tau.ravel() > self.end
        ratio[over] = rate[over] = np.nan
        return (ratio + 0.0).reshape(tau.shape), (rate + 0.0).reshape(tau.shape)  # no -0

    def sides(self, tau: Array) -> Array:
        """Return the side, +1 or -1, on which the body is at times tau; +1 at rest."""
        side: Array = np.ones(np.size(tau))
        inside, arc = self.arcs.at(np.ravel(tau))
        side[inside] = self.arcs.side[arc]
        return side.reshape(np.shape(tau))

    def steps(self) -> Array:
        """Return the times tau of the ends of all arcs and of the events."""
        return np.unique(np.concatenate([[0.0, self.end], self.arcs.start, self.arcs.stop, [e.tau for e in self.events]]))

    @property
    def theta_ratio(self) -> float | None:
        """max |theta|/alpha [-]: 0 if the body never lifted, None if it overturned, lost contact or has no outcome."""
        if self.outcome == Outcome.NO_UPLIFT:
            return 0.0
        if self.outcome not in _KNOWN:
            return None
        return self.highest if self.peak is None else max(self.highest, abs(self.peak.theta_ratio))

    @cached_property
    def peak(self) -> Event | None:
        """The event of the largest |theta|/alpha up to the end; None if the body never lifted, or overturned."""
        if self.outcome not in _KNOWN:
            return None
        found = [e for e in self.events if e.event in ("peak", "release")]
        return max(found, key=lambda e: abs(e.theta_ratio)) if found else None


def history(
    system: System, motion: Motion, amplitude: float, omega: float, eta: float, *, release: float = 0.0, duration: float
) -> History:
    """Return the response of a body that begins at rest, or at theta/alpha = release, up to tau = duration or the end of the shaking.

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
            raise ValueError(f"{name}: found {x:g}; expected a finite number that is not negative")
    if not (omega > 0.0 and duration > 0.0 and release < 1.0):
        raise ValueError("omega and duration must be positive and release below 1")
    if motion.duration / omega > LONGEST:
        raise ValueError(f"omega: found {omega:g}; expected a value with which the shaking ends before tau = {LONGEST:g}")
    duration = max(motion.duration / omega, duration)
    if system.devices is not None:
        from .tied_history import tied_history

        return tied_history(system, motion, amplitude, omega, eta, release, duration)
    segments = system.segments(motion.coarsest.still_until(1.001 * duration * omega))
    return _Writer(system, segments, omega, eta).record(amplitude, release, duration)


class _Writer:
    """Writes down the arcs and events of the march of one body; times are tau of the history, which is the phase over omega."""

    def __init__(self, system: System, segments: Segments, omega: float, eta: float) -> None:
        self.system, self.equation, self.omega = system, system.equation, omega
        self.lane = Lane(system, segments, omega, eta)
        self.segments = self.lane.segments
        self.numbers, self.terms, self.lengths = array("d"), array("d"), array("l")
        self.events = list[Event]()

    def _fallen(self, side: float) -> float:
        """Return the y at which a body counts as fallen: theta/alpha = `FALLEN`, or the rotation at which it lies on the ground."""
        equation = self.equation.on(np.array([side]))
        return min(float(np.min(equation.limit)), float(equation.displacement(np.array([FALLEN]))[0]))

    def record(self, amplitude: float, release: float, duration: float) -> History:
        listener = Listener(self._keep, self._note, self._rest, INVISIBLE, (self._fallen(1.0), self._fallen(-1.0)))
        self.cells = self.system.contact.cells(self.equation, np.array([amplitude]), self.lane.omega, self.lane.eta)
        with np.errstate(all="ignore"):
            ended = march(self.lane, amplitude, listener=listener, release=release, most=MAX_STEPS + 40 * len(self.segments))
            arcs = self._arcs()
            if ended.outcome.overturned:
                self._overturn(arcs)
            if ended.outcome == Outcome.LOST_CONTACT and ended.lost is not None:
                self._lose(arcs, ended.lost)
        end = min([duration, *(e.tau for e in self.events if e.event in ("overturning", LOST))])
        events = tuple(e for e in self.events if e.tau <= end)
        kept = int(np.searchsorted(arcs.start, end, side="right"))
        flow = arcs.flow.take(np.arange(kept))
        arcs = Arcs(arcs.start[:kept], np.minimum(arcs.stop[:kept], end), arcs.side[:kept], flow, arcs.pace[:kept])
        return History(self.equation, arcs, events, end, self._became(ended.outcome), ended.theta_ratio)

    def _became(self, outcome: Outcome) -> Outcome:
        words = [e.event for e in self.events]
        if outcome.overturned and "overturning" in words:
            return Outcome.OVERTURNED_AFTER_IMPACT if "impact" in words else Outcome.OVERTURNED_NO_IMPACT
        if outcome in (Outcome.ROCKED, Outcome.NO_UPLIFT):
            return Outcome.ROCKED if words else Outcome.NO_UPLIFT
        return outcome

    def _arcs(self) -> Arcs:
        """Return the arcs that were kept; each series gets as many terms as the longest one."""
        start, reach, side, pace, unit = np.array(self.numbers).reshape(-1, 5).T
        lengths, most = np.array(self.lengths, dtype=np.int64), max(self.lengths, default=5)
        terms = np.zeros((start.size, most))
        terms[np.arange(most) < lengths[:, None]] = self.terms
        flow = TaylorSeries(np.ascontiguousarray(terms.T), unit, unit, np.ones(unit.size), self.lane.zeta)
        return Arcs(start, start + reach / pace, side, flow, pace)

    def _keep(self, start: float, reach: float, side: float, pace: float, h: float, terms: tuple[float, ...]) -> None:
        self.numbers.extend((start, reach, side, pace, h))
        self.terms.extend(terms)
        self.lengths.append(len(terms))

    def _note(self, tau: float, event: str, side: float, y: float, v: float) -> None:
        tau = max(tau, self.events[-1].tau if self.events else 0.0)  # in order, whatever the last digit
        equation, pace = self.equation.on(np.array([side])), self.omega / self.lane.omega_of(side)
        rotation, rate = equation.rotation(np.array([y])), equation.rotation_rate(np.array([y]), np.array([v]))
        self.events.append(Event(tau, event, float(side * rotation[0]) + 0.0, float(side * rate[0]) * pace + 0.0, float(side)))  # no -0

    def _overturn(self, arcs: Arcs) -> None:
        """Note the overturning at the last time at which the body passes y of `_fallen`, which may be many arcs before the march is certain
        of the fall."""
        i = arcs.start.size - 1
        fallen = self._fallen(float(arcs.side[i]))
        while i and arcs.flow.terms[0, i] >= fallen:
            i -= 1
        start, length, arc = float(arcs.start[i]), float(arcs.stop[i] - arcs.start[i]), np.array([i])
        share = np.linspace(0.0, 1.0, 65)  # beyond it, and perhaps back within this arc
        beyond = np.flatnonzero(arcs.flow.take(np.full(65, i)).at(share * (length * arcs.pace[i])).y >= fallen)
        low, high = start, start + float(share[beyond[0]] if beyond.size else 1.0) * length
        for _ in range(80):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if arcs.points(arc, np.array([middle])).y[0] >= fallen else (middle, high)
        point = arcs.points(arc, np.array([high]))
        if float(point.y[0]) >= fallen * (1.0 - 1e-9):
            self.events = [e for e in self.events if e.tau <= high]
            self._note(high, "overturning", float(arcs.side[i]), float(point.y[0]), float(point.v[0]))

    def _lose(self, arcs: Arcs, tau: float) -> None:
        """Note the loss of contact at tau, when the ground begins to fall as fast as the body."""
        self.events = [e for e in self.events if e.tau <= tau]
        found = History(self.equation, arcs, (), tau, Outcome.LOST_CONTACT, math.nan)
        ratio, rate = (float(x[0]) for x in found.at(np.array([tau])))
        self.events.append(Event(tau, LOST, ratio, rate, float(arcs.side[-1]) if arcs.side.size else 1.0))

    def _rest(self, before: Lanes, after: Lanes) -> None:
        """Note the rest at the end of the bounces, and the uplift after it."""
        rest, lifts = self._bounced(before), after.k[0] < len(self.segments)
        if not lifts or self._tau(after) > rest:
            self._note(rest, "rest", 1.0, 0.0, 0.0)
        if lifts:
            self._note(self._tau(after), "uplift", float(after.side[0]), 0.0, 0.0)

    def _tau(self, lanes: Lanes) -> float:
        return self.lane.tau(int(lanes.k[0]), float(lanes.u[0]))

    def _bounced(self, lanes: Lanes) -> float:
        """Return the tau at which bounces too low to be seen come to rest: each bounce under a force linear in time, the last ones by the
        sum of a series."""
        lanes, contact = lanes.take(np.zeros(1, dtype=np.int64)), self.system.contact
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
            contact.strike(self.cells, lanes, fall, force)
            lanes.b = self._lying(lanes, np.zeros(1))
        weight = self.segments.weight(lanes.side, lanes.amplitude, lanes.k, lanes.u)
        rest = contact.sequence_time(lanes, weight) * lanes.omega / self.omega
        return self._tau(lanes) + float(rest[0])

    def _lying(self, lanes: Lanes, h: Array) -> Array:
        """Return the force on a body at theta = 0 after a time h [tau of its side]."""
        seg, u = self.segments, lanes.u + lanes.omega * h
        k = np.minimum(lanes.k, len(seg) - 1)  # the ground is still at the end
        b = -lanes.side * lanes.amplitude * (seg.s_start[k] + drive_change(seg, k, u)) - 1.0
        return seg.force_at_impact(lanes.side, lanes.amplitude, k, u, b)


def quarter_period(system: System, release: float) -> float:
    """Return the time tau [-] from the release at theta/alpha = release to the first impact, on still ground. Raises ValueError."""
    reach = 4.0 * math.acosh(1.0 / (1.0 - release)) + 10.0
    free = history(system, Motion("still", (Piece(0.0, reach),)), 0.0, 1.0, 0.0, release=release, duration=reach)
    return next((e.tau for e in free.events if e.event == "impact"), math.inf)
