"""The response of one body in time: every arc with its exact flow or series, and what happened when.

It is the engine's own run of a single cell, watched: nothing is closed early but the last, invisible part of a chatter, and the
ground goes on standing still after the motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..dynamics.equations.equation import Flow, Model
from ..dynamics.march.advance import Event, crests
from ..dynamics.march.engine import Run
from ..dynamics.march.lanes import Lanes
from ..dynamics.outcome import Outcome
from ..motions.motion import Motion, Piece

Array = np.ndarray

_INVISIBLE = 1e-4  # speed of a bounce, y' by tau: its height is below 1e-8
LONGEST = 1e9  # tau: beyond, doubles do not tell the times of an arc apart
_FALLEN = 3.0  # |theta|/alpha to which an overturning body is followed, unless it lies on its side before


class Stretch(NamedTuple):
    """One arc: between two times tau, on one side, along one flow."""

    start: float
    stop: float
    side: float
    flow: Flow


class Moment(NamedTuple):
    """What happened at a time tau: uplift, impact, peak, rest or overturning; theta/alpha and its rate (before an impact)."""

    tau: float
    event: str
    theta_ratio: float
    rate: float


@dataclass(frozen=True)
class History:
    """A response in time: arcs, moments, the time tau at which it ends, and what became of the body (as far as that)."""

    model: Model
    stretches: tuple[Stretch, ...]
    moments: tuple[Moment, ...]
    end: float
    outcome: Outcome

    def at(self, tau: Array) -> tuple[Array, Array]:
        """theta/alpha [-] and its derivative by tau [-] at times tau, arrays of one shape; zero at rest, NaN after the end."""
        tau = np.asarray(tau, dtype=float)
        ratio, rate = np.zeros(tau.shape), np.zeros(tau.shape)
        for stretch in self.stretches:
            inside = np.flatnonzero((tau >= stretch.start) & (tau <= stretch.stop * (1.0 + 1e-14)))
            if inside.size:
                point = stretch.flow.take(np.zeros(inside.size, dtype=np.int64)).at(tau[inside] - stretch.start)
                ratio[inside] = stretch.side * self.model.rotation(point.y)
                rate[inside] = stretch.side * self.model.rotation_rate(point.y, point.v)
        ratio, rate = ratio + 0.0, rate + 0.0  # no -0
        ratio[tau > self.end] = rate[tau > self.end] = np.nan
        return ratio, rate

    def steps(self) -> Array:
        """The ends of the solver's own arcs, with the moments, in tau."""
        marks = {0.0, self.end, *(s.start for s in self.stretches), *(s.stop for s in self.stretches), *(m.tau for m in self.moments)}
        return np.array(sorted(marks))

    @property
    def peak(self) -> Moment | None:
        """The moment of the largest |theta|; None where the body never left the ground, or overturned."""
        if self.outcome != Outcome.ROCKED:
            return None
        found = [m for m in self.moments if m.event in ("peak", "release")]
        return max(found, key=lambda m: abs(m.theta_ratio)) if found else None


def history(model: Model, motion: Motion, amplitude: float, omega: float, eta: float, *, release: float = 0.0, duration: float) -> History:
    """The response of one body at rest, or released from theta/alpha = release, up to tau = duration.

    Parameters as in `response`; amplitude 0 is free rocking. Raises ValueError when a number is out of range.
    """
    numbers = {"amplitude": amplitude, "omega": omega, "eta": eta, "release": release, "duration": duration}
    for name, x in numbers.items():
        if not (math.isfinite(x) and x >= 0.0):
            raise ValueError(f"{name} is {x:g}, accepted is a finite number that is not negative")
    if not (omega > 0.0 and eta <= 1.0 and duration > 0.0 and release < 1.0):
        raise ValueError("omega and duration must be positive, eta at most 1 and release below 1")
    if motion.duration / omega > LONGEST:
        raise ValueError(f"omega is {omega:g}, accepted is one with which the shaking ends before tau = {LONGEST:g}")
    end = max(motion.duration / omega, duration) * 1.001
    run = _Watched(model, motion.still_until(end * omega), amplitude, omega, eta, release)
    return run.record(duration)


class _Watched(Run):
    """A run of one cell that keeps its arcs."""

    def __init__(self, model: Model, motion: Motion, amplitude: float, omega: float, eta: float, release: float) -> None:
        a, w, n = (np.array([x]) for x in (amplitude / model.initiation, omega, eta))
        super().__init__(model, motion.segments, a, w, n, True, 1)
        self.release, self.stretches, self.moments = release, list[Stretch](), list[Moment]()
        self.summit = 0.0  # tau up to which the last arc is looked at for an overturning
        self.fallen = min(model.limit, float(model.displacement(np.array(_FALLEN))))

    def record(self, duration: float) -> History:
        lanes = self._first()
        with np.errstate(all="ignore"):
            while lanes.cell.size and self._tau(lanes) < duration:
                lanes = self._round(lanes)
        end = min([duration, *(m.tau for m in self.moments if m.event == "overturning")])
        moments = [m for m in self.moments if m.tau <= end]
        stretches = tuple(s._replace(stop=min(s.stop, end)) for s in self.stretches if s.start <= end)
        return History(self.model, stretches, tuple(moments), end, self._became(moments))

    def _became(self, moments: list[Moment]) -> Outcome:
        if self.outcome[0] == Outcome.FAILED:
            return Outcome.FAILED
        events = [m.event for m in moments]
        if "overturning" in events:
            return Outcome.OVERTURNED_AFTER_IMPACT if "impact" in events else Outcome.OVERTURNED_NO_IMPACT
        return Outcome.ROCKED if events else Outcome.NO_UPLIFT

    def _first(self) -> Lanes:
        """The body before its first step: about to lift off, or released."""
        lanes = self._start(np.array([0]))
        if self.release == 0.0:
            if lanes.k[0] >= len(self.segments):
                return lanes.take(np.zeros(0, dtype=np.int64))
            self._note(self._tau(lanes), "uplift", lanes.side[0], 0.0, 0.0)
            return lanes
        lanes.k[:], lanes.u[:], lanes.side[:], lanes.v[:] = 0, 0.0, 1.0, 0.0
        lanes.y[:] = self.model.displacement(np.array([self.release]))
        drive = -lanes.side * lanes.amplitude * self.segments.s_start[0]
        lanes.b[:] = self.model.acceleration(lanes.y, drive)
        self._note(0.0, "release", 1.0, lanes.y[0], 0.0)
        return lanes

    def _tau(self, lanes: Lanes) -> float:
        k = min(int(lanes.k[0]), len(self.segments) - 1)
        whole = float(self.segments.length[k]) if lanes.k[0] >= len(self.segments) else float(lanes.u[0])
        return (float(self.segments.start[k]) + whole) / float(lanes.omega[0])

    def _note(self, tau: float, event: str, side: float, y: float, v: float) -> None:
        tau = max(tau, self.moments[-1].tau if self.moments else 0.0)  # in order, whatever the last digit
        rotation, rate = self.model.rotation(np.array([y])), self.model.rotation_rate(np.array([y]), np.array([v]))
        self.moments.append(Moment(tau, event, float(side * rotation[0]) + 0.0, float(side * rate[0]) + 0.0))  # no -0

    def _observe(self, lanes: Lanes, event: Event) -> None:
        start, side, reach = self._tau(lanes), float(lanes.side[0]), float(event.reach[0])
        self.stretches.append(Stretch(start, start + reach, side, event.arc))
        _, h, y = crests(self.segments, lanes, event, np.array([True]))
        self.summit = start + reach
        if h.size and y[0] >= self.model.limit:
            self.summit = start + float(h[0])  # beyond its limit, and perhaps back within this step
        elif h.size:
            self._note(start + float(h[0]), "peak", side, float(y[0]), 0.0)
        if event.hit[0]:
            self._note(start + reach, "impact", side, 0.0, float(event.impact_v[0]))

    def _certainly_overturns(self, lanes: Lanes, k: Array, event: Event) -> Array:
        certain = super()._certainly_overturns(lanes, k, event)
        return certain & (event.end.y >= self.fallen)

    def _overturn(self, lanes: Lanes, at: Array) -> None:
        if at.size:
            last = self.stretches[-1]
            low, high = last.start, self.summit
            for _ in range(80):
                middle = 0.5 * (low + high)
                beyond = float(last.flow.at(np.array([middle - last.start])).y[0]) >= self.fallen
                low, high = (low, middle) if beyond else (middle, high)
            point = last.flow.at(np.array([high - last.start]))
            if float(point.y[0]) >= self.fallen * (1.0 - 1e-9):
                self._note(high, "overturning", last.side, float(point.y[0]), float(point.v[0]))
        super()._overturn(lanes, at)

    def _chatter_ends(self, lanes: Lanes) -> Array:
        return super()._chatter_ends(lanes) & (lanes.v < _INVISIBLE)

    def _rest(self, lanes: Lanes) -> Lanes:
        if not lanes.cell.size:
            return lanes
        before, speed, drive, eta = self._tau(lanes), float(lanes.v[0]), 1.0 + float(lanes.b[0]), float(lanes.eta[0])
        rests = self.work.rests_skipped
        lanes = super()._rest(lanes)
        if self.work.rests_skipped > rests:
            wait = 2.0 * speed / (1.0 - eta * eta) * (1.0 / (1.0 - drive) + eta / (1.0 + drive)) if speed > 0.0 and eta < 1.0 else 0.0
            if lanes.cell.size == 0 or self._tau(lanes) > before + wait:
                self._note(before + wait, "rest", 1.0, 0.0, 0.0)
            if lanes.cell.size:
                self._note(self._tau(lanes), "uplift", float(lanes.side[0]), 0.0, 0.0)
        return lanes


def quarter_period(model: Model, release: float) -> float:
    """Time tau [-] from release at theta/alpha to the first impact, on still ground. Raises ValueError."""
    reach = 4.0 * math.acosh(1.0 / (1.0 - release)) + 10.0
    free = history(model, Motion("still", (Piece(0.0, reach),)), 0.0, 1.0, 0.0, release=release, duration=reach)
    return next((m.tau for m in free.moments if m.event == "impact"), math.inf)
