"""What each cell asks of the ground: the least vertical force and the largest |Fx|/Fz of a rigid body, found along with its march.

With z = alpha - u, u = |theta| and s the side, what moves the mass centre is (over m g, ' by tau)

    s Fx = s xg''/g + kappa (u'' cos z + u'^2 sin z),   Fz = 1 + kappa (u'' sin z - u'^2 cos z)

where u'' follows from the drive by the equation of motion. On every step the extremes are those of cubics through values and slopes: a
stretch is halved until they meet the value in the middle closely, and left as soon as it cannot beat what its cell has had. An extremum
inside a stretch whose cubic has none is the end's own to what the cubic there leaves out.

What the march closes adds nothing to the friction. Before an uplift the demand is below lambda, at it lambda or more, and bounces on their
way to rest, or after the shaking, need less than that while kappa (cos alpha + alpha sin alpha) <= 1, which is added otherwise. After
the shaking Fz is least at the next impact, since it falls with the energy and towards the ground.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.motion import Segments
from ..body import Body
from ..drive import segment_value, summed
from ..equations.equation import Flow
from ..lanes import Lanes

Array = np.ndarray

MOST_ALPHA = 0.6  # rad; up to it bodies that rock freely need most friction on the ground, and press on it least there
_EXACT = 1e-12  # by which a record must be beaten
_NEAR = 1e-6  # difference of a cubic from the function in its middle, from which its extremum is close enough to settle
_HALVINGS = 24


def follows(body: Body) -> bool:
    """Whether the demands of such a body are followed: of two edges alike, or one, undamped, up to MOST_ALPHA."""
    return len(body.alpha) == 1 and not body.damping and body.alpha[0] <= MOST_ALPHA


class Course(NamedTuple):
    """What is followed along a step, (2, lanes): -Fz and s Fx/Fz, and their slopes by tau."""

    value: Array
    slope: Array


class Demands:
    """The records of cells: friction [-] and fz_min, the least Fz over m g [-]."""

    def __init__(self, body: Body, segments: Segments, strongest: Array, cells: int) -> None:
        self.body, self.edge, self.segments = body, body.edges[0], segments
        self.friction = np.minimum(strongest, 1.0) * self.edge.uplift  # at rest
        self.fz_min = np.ones(cells)

    def course(self, lanes: Lanes, h: Array, y: Array, v: Array) -> Course:
        """The course of lanes that are at y, v after h; their forces follow from the drive there, not from differences of the series."""
        seg = self.segments
        change, sin, cos = segment_value(seg, lanes.k, lanes.u + lanes.omega * h)
        w = seg.frequency.take(lanes.k, axis=1)
        out = -lanes.side * lanes.amplitude * self.edge.uplift
        push = out * (seg.s_start[lanes.k] + change)  # outwards, over g
        push_slope = out * lanes.omega * (summed(w * cos) + seg.slope[lanes.k])
        alpha, k, unit, _ = self.edge
        z, rate = alpha - y * unit, v * unit
        sin, cos = np.sin(z), np.cos(z)
        if self.body.linear:
            bend, jerk = push - z, push_slope + rate
        else:
            bend, jerk = push * cos - sin, push_slope * cos + rate * (cos + push * sin)
        square = rate * rate
        fx = k * (bend * cos + square * sin) - push
        fz = 1.0 + k * (bend * sin - square * cos)
        fx_slope = k * ((jerk - rate * square) * cos + 3.0 * rate * bend * sin) - push_slope
        fz_slope = k * ((jerk - rate * square) * sin - 3.0 * rate * bend * cos)
        return Course(np.array([-fz, fx / fz]), np.array([-fz_slope, (fx_slope * fz - fx * fz_slope) / (fz * fz)]))

    def follow(self, lanes: Lanes, arc: Flow, stop: Array, y: Array, v: Array, at: Array) -> None:
        """Take in the arcs of the lanes `at` until `stop` [tau], where they are at y, v; `lanes` as they are at 0."""
        some, low, high = lanes.take(at), np.zeros(at.size), stop[at]
        one, other = self.course(some, low, some.y, some.v), self.course(some, high, y[at], v[at])
        for end in (one, other):
            self._take(some.cell, end.value)
        ends = np.maximum(one.value, other.value)
        ends[1] = np.maximum(np.abs(one.value[1]), np.abs(other.value[1]))
        most, x, bend = _extremes(one, other, high - low)
        with np.errstate(invalid="ignore"):
            doubt = (most - ends) + 0.05 * np.abs(other.value - one.value)  # a cubic's rise is met to much less than itself
        for _ in range(_HALVINGS):
            record = np.array([-self.fz_min[some.cell], self.friction[some.cell]])
            maybe = most + doubt > record + _EXACT
            for row in (0, 1):
                near = np.flatnonzero(maybe[row] & (doubt[row] <= _NEAR))
                self._settle(row, some.take(near), arc.take(at[near]), low[near] + x[row, near] * (high[near] - low[near]), bend[row, near])
            more = np.flatnonzero(np.any(maybe & (doubt > _NEAR), axis=0))
            if not more.size:
                return
            at, low, high, some = at[more], low[more], high[more], some.take(more)
            one, other = (Course(c.value[:, more], c.slope[:, more]) for c in (one, other))
            half = 0.5 * (low + high)
            there = arc.take(at).at(half)
            middle = self.course(some, half, there.y, there.v)
            self._take(some.cell, middle.value)
            guess = 0.5 * (one.value + other.value) + 0.125 * (high - low) * (one.slope - other.slope)
            gap = 0.25 * np.abs(middle.value - guess)  # halves of a stretch are met 16 times as closely
            at, some, doubt = np.tile(at, 2), some.join(some), np.tile(gap, 2)
            low, high = np.concatenate([low, half]), np.concatenate([half, high])
            one, other = (
                Course(np.concatenate([a.value, b.value], axis=1), np.concatenate([a.slope, b.slope], axis=1))
                for a, b in ((one, middle), (middle, other))
            )
            most, x, bend = _extremes(one, other, high - low)

    def _settle(self, row: int, lanes: Lanes, arc: Flow, h: Array, bend: Array) -> None:
        """An extremum near h, with what a parabola of this second derivative still rises from there: its place then has an error of the
        square of its distance."""
        if not h.size:
            return
        point = arc.at(h)
        there = self.course(lanes, h, point.y, point.v)
        value, slope = there.value[row], there.slope[row]
        value = value - np.where(bend * (np.sign(value) if row else 1.0) < 0.0, 0.5 * slope**2 / bend, 0.0)
        if row:
            np.maximum.at(self.friction, lanes.cell, np.abs(value))
        else:
            np.minimum.at(self.fz_min, lanes.cell, -value)

    def _take(self, cell: Array, value: Array) -> None:
        """Values of a course at some instant."""
        np.minimum.at(self.fz_min, cell, -value[0])
        np.maximum.at(self.friction, cell, np.where(value[0] < 0.0, np.abs(value[1]), np.inf))

    def free(self, cell: Array, y: Array, v: Array) -> None:
        """Bodies at y, v that rock on over still ground."""
        edge = self.edge
        square = (edge.unit * v) ** 2 + self.body.fall(edge, edge.unit * y)  # u'^2 at the next impact
        self.fz_min[cell] = np.minimum(self.fz_min[cell], self.body.at_impact(edge, square))
        pull = edge.kappa * self.body.pull(edge)
        settling = pull * np.cos(edge.alpha) / (1.0 - pull * np.sin(edge.alpha))  # the demand of bounces that come to rest
        self.friction[cell] = np.maximum(self.friction[cell], settling)


def _extremes(one: Course, other: Course, h: Array) -> tuple[Array, Array, Array]:
    """(2, stretches): the largest -Fz, and the largest |Fx|/Fz, of the cubics through these ends inside stretches of length h, and the
    part of the stretch at which it is, and the second derivative there; minus infinity where they have none."""
    rise = other.value - one.value
    c1, c2, c3 = h * one.slope, 3.0 * rise - h * (2.0 * one.slope + other.slope), h * (one.slope + other.slope) - 2.0 * rise
    most, where = np.full(rise.shape, -np.inf), np.full(rise.shape, 0.5)
    with np.errstate(all="ignore"):
        root = np.sqrt(c2 * c2 - 3.0 * c1 * c3)
        q = -(c2 + np.copysign(root, c2))
        for x in (q / (3.0 * c3), c1 / q):
            value = one.value + x * (c1 + x * (c2 + x * c3))
            value[1] = np.abs(value[1])
            better = (x > 0.0) & (x < 1.0) & (value > most)
            most, where = np.where(better, value, most), np.where(better, x, where)
    return most, where, (2.0 * c2 + 6.0 * c3 * where) / (h * h)
