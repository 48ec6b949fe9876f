"""The largest angular speed of rocking, beside the response.

Within a step of the march |v| is largest at an end, at the impact, or where the acceleration is zero. Under straight lines the
acceleration of the undamped linear oscillator between samples is a sum of exp(tau) and exp(-tau), which has at most one zero; the
nonlinear equations differ little from it over one sample. After the shaking the speed is largest at the next impact: by the energy.
"""

from __future__ import annotations

import numpy as np

from ..motions.motion import Motion
from .drive import place
from .equations.equation import Flow
from .lanes import Lanes
from .march.advance import Passage
from .march.engine import Round, Run
from .outcome import Outcome
from .response import Response
from .system import System

Array = np.ndarray

_ROUNDS = 60  # halvings of a bracket at most; Newton's steps need four


class SpeedRun(Run):
    """A run that keeps the largest speed of each cell."""

    def __init__(self, system: System, motion: Motion, amplitude: Array, omega: Array, eta: Array) -> None:
        super().__init__(system, motion.segments, amplitude, omega, eta, True, system.equation.pool)
        self.fastest = np.zeros(amplitude.size)

    def round(self, lanes: Lanes) -> Round:
        """One step for every lane, and how fast it was in it."""
        done = super().round(lanes)
        self._raise(lanes, done.passage)
        return done

    def _raise(self, lanes: Lanes, passage: Passage) -> None:
        arc, reach, hit = passage.arc, passage.reach, passage.hit
        equation = self.equation.on(lanes.side)
        y, v = np.where(hit, 0.0, passage.end.y), np.where(hit, passage.impact_v, passage.end.v)
        b = np.where(hit, passage.impact_b, passage.end.b)
        fastest = np.maximum(self.fastest[lanes.cell], np.abs(equation.rotation_rate(y, v)))
        within = np.maximum(np.abs(arc.v), np.abs(v)) + 0.5 * reach * np.maximum(np.abs(arc.b), np.abs(b))
        at = np.flatnonzero((arc.b * b < 0.0) & (np.abs(equation.rotation_rate(y, within)) > fastest))
        if at.size:
            y_at, v_at = _even(arc.take(at), reach[at])
            fastest[at] = np.maximum(fastest[at], np.abs(self.equation.on(lanes.side[at]).rotation_rate(y_at, v_at)))
        k, _ = place(self.segments, passage.step.k, passage.step.u)
        last = np.flatnonzero(~hit & (k >= self.shaken))
        if last.size:
            there = self.equation.on(lanes.side[last])
            zero = np.zeros(last.size)
            at_ground = np.sqrt(there.fall(passage.end.y[last], passage.end.v[last])[1] / there.fall(zero, zero + 1.0)[1])
            fastest[last] = np.fmax(fastest[last], there.rotation_rate(zero, at_ground))
        self.fastest[lanes.cell] = fastest


def _even(arc: Flow, high: Array) -> tuple[Array, Array]:
    """(y, v) where the acceleration passes through zero between 0 and `high`: Newton's method inside a bracket."""
    low, high, falls = np.zeros_like(high), high.copy(), arc.at(np.zeros_like(high)).b > 0.0
    h = 0.5 * high
    for _ in range(_ROUNDS):
        point = arc.at(h)
        before = (point.b > 0.0) == falls
        low, high = np.where(before, h, low), np.where(before, high, h)
        with np.errstate(divide="ignore", invalid="ignore"):
            target = h - point.b / point.j
        following = np.where((target > low) & (target < high), target, 0.5 * (low + high))
        if np.all(np.abs(following - h) <= 1e-8 * high):  # the speed is flat there: squared, this is below rounding
            break
        h = following
    point = arc.at(following)
    return point.y, point.v


def response_with_speed(system: System, motion: Motion, amplitude: Array, omega: Array, eta: Array | float) -> tuple[Response, Array]:
    """`response`, and max over time of |d theta/d tau|/alpha [-], tau = p t, of bodies of two like edges (or one) without damping under
    straight lines; NaN where theta_ratio is, and for other bodies. Parameters as of `response`."""
    amplitude, omega, eta = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (amplitude, omega, eta)))
    run = SpeedRun(system, motion, amplitude.ravel(), omega.ravel(), eta.ravel())
    run.all()
    shape = amplitude.shape
    kept = (run.outcome == Outcome.ROCKED) | (run.outcome == Outcome.NO_UPLIFT)
    if system.equation.damping or len(run.cells.amplitude) > 1:
        kept = np.zeros_like(kept)
    rate = np.where(kept, run.fastest, np.nan).reshape(shape)
    return Response(run.theta_ratio.reshape(shape), run.outcome.reshape(shape), run.impacts.reshape(shape), run.work), rate
