"""The largest angular speed of each cell.

Within an arc |v| is largest at an end or where the acceleration is zero. Under straight lines the acceleration of the linear oscillator
between samples is a sum of two exponentials, which has at most one zero; the nonlinear equations differ little from it over one sample. A
propagation over samples is halved while the bounds of y'' leave room for a larger speed in it; a Taylor step is left to the march where
y'' >= -K leaves it (Lemma 12) and y'' changes its sign. After the shaking the speed is largest before the next impact: by the energy, or
with damping by following the body to it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..contacts.contact import Contact
from ..equations.equation import Equation, Flow
from ..lanes import Lanes
from ..samples.propagation import ExactLanes, Propagation
from .extremes import Extremes
from .observer import Arcs, Observer, TaylorSteps

Array = np.ndarray

_ROUNDS = 60  # halvings of a bracket at most; Newton's steps need four


class PeakSpeed(Observer):
    """max |d theta/d tau|/alpha [-] of each cell so far in `speed`, tau = p t, p and alpha those of the reference. shaken: the segment from
    which on the ground is still; cells: how many."""

    def __init__(self, equation: Equation, contact: Contact, shaken: int, cells: int) -> None:
        self.equation, self.contact, self.shaken, self.speed = equation, contact, shaken, Extremes(np.zeros(cells))

    def _speed(self, side: Array, cell: Array, y: Array, v: Array) -> Array:
        """|d theta/d tau|/alpha of lanes of these cells on these sides."""
        return np.abs(self.contact.speed(side, self.equation.on(side, cell).rotation_rate(y, v)))

    def arcs(self, arcs: Arcs) -> None:
        """The speeds at the ends of arcs, and where the acceleration is zero."""
        lanes, arc, reach, y, v, b, _ = arcs
        side, cell, slowing = lanes.side, lanes.cell, -2.0 * arc.damping
        b = b + slowing * v if arc.damping else b
        self.speed.offer(cell, self._speed(side, cell, y, v))
        within = np.maximum(np.abs(arc.v), np.abs(v)) + 0.5 * reach * np.maximum(np.abs(arc.b), np.abs(b))
        at = np.flatnonzero((arc.b * b < 0.0) & self.speed.can_beat(cell, self._speed(side, cell, y, within)))
        if at.size:
            self.speed.offer(cell[at], self._speed(side[at], cell[at], *_even(arc.take(at), reach[at])))

    def steps(self, steps: TaylorSteps, go: Array) -> None:
        """The speeds at the ends of Taylor steps; those within which a larger one may be are not taken."""
        cell, side, equation, (y, v), (end_y, end_v), ramp = steps
        lift, push = equation.bounds
        steepest = lift + push * np.maximum(0.0, -np.minimum(ramp.drive, ramp.drive + ramp.gain))
        within = (np.maximum(np.abs(v), np.abs(end_v)) + steepest * ramp.unit) * np.exp(2.0 * equation.damping * ramp.unit)
        speed = np.abs(self.contact.speed(side, equation.rotation_rate(end_y, end_v)))
        highest = self.contact.speed(side, equation.rotation_rate(end_y, within))
        at, drag = np.flatnonzero(go & (highest > speed) & self.speed.can_beat(cell, highest)), 2.0 * equation.damping
        if at.size:
            there = self.equation.on(side[at], cell[at])
            first = there.force(y[at], ramp.drive[at]) - drag * v[at]
            last = there.force(end_y[at], ramp.drive[at] + ramp.gain[at]) - drag * end_v[at]
            go[at[first * last < 0.0]] = False
        self.speed.offer(cell[go], speed[go])

    def propagates(
        self, cell: Array, side: Array, lanes: ExactLanes, step: Propagation, proved: Array, strongest: Callable[[Array], Array]
    ) -> Array:
        """Propagations that may hold a larger speed: with c - 1 <= y'' <= r, v is below the lines of slope r from the start and c - 1 to
        the end, and above those of slope c - 1 from the start and r to the end."""
        at = np.flatnonzero(proved)
        self.speed.offer(cell[at], np.abs(self.contact.speed(side[at], step.v[at])))
        fastest = self.speed.largest[cell] / self.contact.speed(side, np.ones(side.size))
        at = np.flatnonzero((step.fall * step.time + np.maximum(step.v, -lanes.v) > fastest) & proved)
        v, end, fall, time = lanes.v[at], step.v[at], step.fall[at], step.time[at]
        highest = np.maximum(lanes.y[at], step.y[at]) + 0.125 * np.maximum(fall, 0.0) * time * time
        rise = highest - 1.0 + strongest(at)
        top = v + rise * (end - v + fall * time) / (rise + fall)
        bottom = v - fall * (v - end + rise * time) / (rise + fall)
        return at[(rise > 0.0) & (fall > 0.0) & (np.maximum(top, -bottom) > fastest[at])]  # y'' may be zero

    def free(self, lanes: Lanes) -> None:
        """The speed at the next impact."""
        zero, there = np.zeros(lanes.cell.size), self.equation.on(lanes.side, lanes.cell)
        at_ground = np.sqrt(there.fall(lanes.y, lanes.v)[1] / there.fall(zero, zero + 1.0)[1])
        self.speed.offer(lanes.cell, self._speed(lanes.side, lanes.cell, zero, at_ground))

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """All but those that fall on still ground for the first time: they are followed to the impact."""
        return ~((lanes.k >= self.shaken) & (lanes.y > 0.0) & ~bounced[lanes.cell])


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
