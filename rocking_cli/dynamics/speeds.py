"""The largest angular speed of rocking, beside the response.

Within a step of the march |v| is largest at an end, at the impact, or where the acceleration is zero. Under straight lines the
acceleration of the linear oscillator between samples is a sum of two exponentials, which has at most one zero; the
nonlinear equations differ little from it over one sample. A jump of the flight is halved while the bounds of y'' leave room for a larger
speed in it; a stride is left to the march where y'' >= -K leaves it (Lemma 12) and y'' changes its sign. After the shaking the speed is
largest before the next impact: by the energy, or with damping by marching on to it.
"""

from __future__ import annotations

import numpy as np

from ..motions.motion import Motion
from ..motions.segments import Samples
from .drive import place
from .equations.equation import Equation, Flow, Point, Ramp
from .flight.jump import Jumpers, Leap
from .flight.ramp import RampFlow
from .flight.run import Flight, Flights
from .flight.walk import Walk
from .lanes import Lanes
from .march.account import Round
from .march.batch import Landing
from .march.engine import Run
from .outcome import Outcome
from .response import Response, flies, look_at_forces
from .system import System

Array = np.ndarray

_ROUNDS = 60  # halvings of a bracket at most; Newton's steps need four


class _Speeds(Run):
    """A run that keeps the largest speed of each cell, in `fastest`."""

    fastest: Array

    def round(self, lanes: Lanes) -> Round:
        """One step for every lane, and how fast it was in it."""
        done = super().round(lanes)
        passage = done.passage
        end, hit = passage.end, passage.hit
        self._raise(
            lanes, passage.arc, passage.reach,
            np.where(hit, 0.0, end.y), np.where(hit, passage.impact_v, end.v), np.where(hit, passage.impact_b, end.b),
        )  # fmt: skip
        k, _ = place(self.segments, passage.step.k, passage.step.u)
        self._fall(lanes, np.flatnonzero(~hit & (k >= self.shaken)), end.y, end.v)
        return done

    def _speed(self, side: Array, cell: Array, y: Array, v: Array) -> Array:
        """d|theta|/dtau over alpha, tau and alpha of the reference, of lanes of these cells on these sides."""
        return self.contact.speed(side, self.equation.on(side, cell).rotation_rate(y, v))

    def _raise(self, lanes: Lanes, arc: Flow, reach: Array, y: Array, v: Array, b: Array) -> None:
        """The speeds of these arcs, which come to y, v, b after `reach`."""
        side, cell = lanes.side, lanes.cell
        fastest = np.maximum(self.fastest[cell], np.abs(self._speed(side, cell, y, v)))
        within = np.maximum(np.abs(arc.v), np.abs(v)) + 0.5 * reach * np.maximum(np.abs(arc.b), np.abs(b))
        at = np.flatnonzero((arc.b * b < 0.0) & (np.abs(self._speed(side, cell, y, within)) > fastest))
        if at.size:
            y_at, v_at = _even(arc.take(at), reach[at])
            fastest[at] = np.maximum(fastest[at], np.abs(self._speed(side[at], cell[at], y_at, v_at)))
        self.fastest[lanes.cell] = fastest

    def _shaken(self, lanes: Lanes, last: Array) -> None:
        """The fate of lanes, and their speed at the next impact."""
        self._fall(lanes, last, lanes.y, lanes.v)
        super()._shaken(lanes, last)

    def _settle(self, lanes: Landing) -> Landing:
        """Damped lanes that fall for the first time on still ground are followed to the impact."""
        falls = (lanes.k >= self.shaken) & (lanes.y > 0.0) & ~self.bounced[lanes.cell]
        if not falls.any():
            return super()._settle(lanes)
        return super()._settle(lanes.take(np.flatnonzero(~falls))).join(lanes.take(np.flatnonzero(falls)))

    def _fall(self, lanes: Lanes, last: Array, y: Array, v: Array) -> None:
        """The speed at the next impact of undamped lanes that are at y, v when the shaking is over."""
        if last.size and not self.equation.damping:
            side, cell, zero = lanes.side[last], lanes.cell[last], np.zeros(last.size)
            there = self.equation.on(side, cell)
            at_ground = np.sqrt(there.fall(y[last], v[last])[1] / there.fall(zero, zero + 1.0)[1])
            self.fastest[cell] = np.fmax(self.fastest[cell], self._speed(side, cell, zero, at_ground))


class SpeedRun(_Speeds):
    """A march that keeps the largest speed of each cell."""

    def __init__(self, system: System, motion: Motion, amplitude: Array, omega: Array, eta: Array) -> None:
        super().__init__(system, system.segments(motion), amplitude, omega, eta, True, system.equation.pool)
        self.fastest = np.zeros(amplitude.size)


class SpeedFlight(_Speeds, Flight):
    """A flight that keeps the largest speed of each cell."""

    def __init__(self, system: System, motion: Motion, samples: Samples, amplitude: Array, omega: Array, eta: Array) -> None:
        Flight.__init__(self, system, motion.segments, samples, amplitude, omega, eta, True, None)
        self.fastest = np.zeros(amplitude.size)

    def _doubtful(self, lanes: Jumpers, leap: Leap, flying: Array) -> Array:
        """Leaps that may hold a larger speed too: with c - 1 <= y'' <= r, v is below the lines of slope r from the start and c - 1 to the
        end, and above those of slope c - 1 from the start and r to the end."""
        crests = super()._doubtful(lanes, leap, flying)
        at, cell, side = np.flatnonzero(flying), self.flown.cell[lanes.slot], self.flown.side[lanes.slot]
        self.fastest[cell[at]] = np.maximum(self.fastest[cell[at]], np.abs(self.contact.speed(side[at], leap.v[at])))
        fastest = self.fastest[cell] / self.contact.speed(side, np.ones(side.size))
        at = np.flatnonzero((leap.fall * leap.time + np.maximum(leap.v, -lanes.v) > fastest) & flying)
        v, end, fall, time = lanes.v[at], leap.v[at], leap.fall[at], leap.time[at]
        highest = np.maximum(lanes.y[at], leap.y[at]) + 0.125 * np.maximum(fall, 0.0) * time * time
        rise = highest - 1.0 + self._strongest(lanes, at)
        top = v + rise * (end - v + fall * time) / (rise + fall)
        bottom = v - fall * (v - end + rise * time) / (rise + fall)
        even = (rise > 0.0) & (fall > 0.0) & (np.maximum(top, -bottom) > fastest[at])  # y'' may be zero
        return np.union1d(crests, at[even])

    def _noted(self, lanes: Flights, arc: RampFlow, reach: Array, hit: Array, end: Point) -> None:
        """The speeds of intervals taken alone."""
        self._raise(lanes, arc, reach, end.y, end.v, end.b)


class SpeedWalk(_Speeds, Walk):
    """A walk that keeps the largest speed of each cell."""

    def __init__(self, system: System, motion: Motion, samples: Samples, amplitude: Array, omega: Array, eta: Array) -> None:
        Walk.__init__(self, system, motion.segments, samples, amplitude, omega, eta, True, None)
        self.fastest = np.zeros(amplitude.size)

    def _look(
        self, cell: Array, side: Array, equation: Equation, start: tuple[Array, Array], end: tuple[Array, Array], ramp: Ramp, go: Array
    ) -> None:  # fmt: skip
        """The speeds at the ends of strides; those within which a larger one may be are not taken."""
        (y, v), (end_y, end_v) = start, end
        lift, push = equation.bounds
        steepest = lift + push * np.maximum(0.0, -np.minimum(ramp.drive, ramp.drive + ramp.gain))
        within = (np.maximum(np.abs(v), np.abs(end_v)) + steepest * ramp.unit) * np.exp(2.0 * equation.damping * ramp.unit)
        speed = self.contact.speed(side, equation.rotation_rate(end_y, end_v))
        fastest = np.maximum(self.fastest[cell], np.abs(speed))
        speed = self.contact.speed(side, equation.rotation_rate(end_y, within))
        at, drag = np.flatnonzero(go & (speed > fastest)), 2.0 * equation.damping
        if at.size:
            there = self.equation.on(side[at], cell[at])
            first = there.force(y[at], ramp.drive[at]) - drag * v[at]
            last = there.force(end_y[at], ramp.drive[at] + ramp.gain[at]) - drag * end_v[at]
            go[at[first * last < 0.0]] = False
        self.fastest[cell[go]] = fastest[go]


def _even(arc: Flow, high: Array) -> tuple[Array, Array]:
    """(y, v) where the acceleration passes through zero between 0 and `high`: Newton's method inside a bracket."""
    low, high, falls = np.zeros_like(high), high.copy(), arc.at(np.zeros_like(high)).b > 0.0
    h, met = 0.5 * high, np.zeros(high.shape, dtype=bool)
    for _ in range(_ROUNDS):
        point = arc.at(h)
        before = (point.b > 0.0) == falls
        low, high = np.where(before, h, low), np.where(before, high, h)
        with np.errstate(divide="ignore", invalid="ignore"):
            target = h - point.b / point.j
        following = np.where((target > low) & (target < high), target, 0.5 * (low + high))
        close = np.abs(following - h) <= 1e-8 * high  # the speed is flat there: squared, this is below rounding
        h = np.where(met, h, following)  # each lane stops by itself, so that no digit depends on its neighbours
        met |= close
        if met.all():
            break
    point = arc.at(h)
    return point.y, point.v


def response_with_speed(system: System, motion: Motion, amplitude: Array, omega: Array, eta: Array | float) -> tuple[Response, Array]:
    """`response`, and max over time of |d theta/d tau|/alpha [-], tau = p t, under straight lines, p and alpha those that A and Omega are
    told in where the edges differ; NaN where theta_ratio is. Parameters as of `response`."""
    amplitude, omega, eta = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (amplitude, omega, eta)))
    cells, lines = (amplitude.ravel(), omega.ravel(), eta.ravel()), motion.coarsest
    run: _Speeds
    if lines.samples is None or motion.vertical is not None:
        run = SpeedRun(system, motion, *cells)
    else:
        run = (SpeedFlight if flies(system, motion) else SpeedWalk)(system, lines, lines.samples, *cells)
    run.all()
    look_at_forces(run, system, motion, cells)
    shape = amplitude.shape
    kept = (run.outcome == Outcome.ROCKED) | (run.outcome == Outcome.NO_UPLIFT)
    rate = np.where(kept, run.fastest, np.nan).reshape(shape)
    return Response(run.theta_ratio.reshape(shape), run.outcome.reshape(shape), run.impacts.reshape(shape), run.work), rate
