"""A mechanism's motion over a step as a polynomial whose y'' meets Eq. 3.4 at Chebyshev's points, in place of a Taylor series.

F and G are series about marks so close to each other that four powers do. Sweeps integrate twice what the equation gives at the points: two
with parabolas of F and G about the start, two with the series about the marks that y is then near to, the last ones with the equation's
slope there. Whether that has come to its end is looked at afterwards, and a step of which it has not is halved. A step costs no
more than one of Taylor's, which is bound to where its powers converge, and goes twice as far.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..drive import segment_value
from ..lanes import Lanes
from .patches import Marks
from .taylor import LOCAL, TaylorSeries, blocks, order_for

Array = np.ndarray

_POINTS = 0.57  # points of a step for each factor e of its error
_COARSE = 2  # sweeps with parabolas: then all but one step in a hundred are near their marks
_PACE = 0.17  # a step times the drive's pace is this for each point, at the most,
_STIFF = 0.8  # the square of a step times the slope of the force this, so that each sweep leaves a tenth or less,
_FAR = 2.0  # and y comes this far in half widths of a patch, which are short against the distance to the linkage's lock-up,
# and half as deep as the lowest mark
_HALVED = 8  # times that a step is, before it is left to others
_NEAR = 2.0  # marks by which y may miss the one it was looked up at
# Inside a step the velocity may be off by so many times what it may be at the end, where the points' weights are good to twice as many
# powers and an error that grows fast along the step has hardly been summed up.
_INSIDE = 3.0


class Points(NamedTuple):
    """Chebyshev's points of a step of length 1, both ends among them, but for the start; and what follows from values at all of them: y at
    the points by integrating twice, Chebyshev coefficients, and from these terms 2 ... of y in powers of time."""

    at: Array
    twice: Array
    chebyshev: Array
    terms: Array


@lru_cache(maxsize=16)
def points(count: int) -> Points:
    """`count` points besides the start."""
    n = np.arange(count + 1.0)
    values = np.cos(np.pi / count * np.fmod(np.outer(n, n), 2.0 * count))
    values[1::2] *= -1.0  # T_n at the points and the start
    chebyshev = values * (2.0 / count)
    chebyshev[[0, -1]] *= 0.5
    chebyshev[:, [0, -1]] *= 0.5
    integrals = np.polynomial.chebyshev.chebint(np.eye(count + 1), 2, lbnd=-1, scl=0.5)
    at_points = np.polynomial.chebyshev.chebval(values[1, 1:], integrals)
    terms = np.zeros((count + 1, count + 1))  # T_n(2 t - 1) in powers of t, whole numbers
    terms[0, 0], terms[:2, 1] = 1.0, (-1.0, 2.0)
    for i in range(1, count):
        terms[:, i + 1] = -2.0 * terms[:, i] - terms[:, i - 1]
        terms[1:, i + 1] += 4.0 * terms[:-1, i]
    terms /= ((n + 1.0) * (n + 2.0))[:, None]
    return Points(0.5 * (values[1, 1:, None] + 1.0), np.einsum("nk,nj->kj", at_points, chebyshev), chebyshev, terms)


def collocated(marks: Marks, tolerance: float, segments: Segments, lanes: Lanes) -> tuple[TaylorSeries, Array]:
    """The motion of every lane over a step of its own, undamped and under a steady weight, and the lanes of which it is not known."""
    count = order_for(tolerance, _POINTS)
    w = segments.frequency.take(lanes.k, axis=1) * lanes.omega
    fastest = 1.0 + w.max(axis=0, initial=0.0)
    start, far = marks.about(lanes.y), _FAR * marks.halves.take(marks.nearest(lanes.y)[0])
    drive = (lanes.b + start[0, 0]) / start[1, 0]
    stiff = np.abs(start[0, 1]) + np.abs(lanes.amplitude * start[1, 1])
    moves = (np.abs(lanes.v) + np.sqrt(0.5 * far * np.abs(lanes.b))) / far
    deep = lanes.y - 0.5 * marks.low
    falls = (np.sqrt(lanes.v * lanes.v + 2.0 * deep * np.maximum(-lanes.b, 0.0)) - lanes.v) / (2.0 * deep)
    pace = (1.0 + segments.pace.take(lanes.k) * lanes.omega) / (_PACE * count)
    length = 1.0 / np.maximum(np.maximum(pace, np.sqrt(stiff / _STIFF)), np.maximum(moves, falls))
    terms, holds = np.empty((count + 3, lanes.y.size)), np.empty(lanes.y.size, dtype=bool)

    def fill(some: Array | slice) -> None:
        known = w[:, some], start[..., some], drive[some], length[some]
        terms[:, some], holds[some] = _step(marks, tolerance, segments, lanes.take(some), *known)

    for block in blocks(lanes.y.size):
        fill(block if block.start + 1 < lanes.y.size else np.array([block.start, block.start]))
    for _ in range(_HALVED):
        again = np.flatnonzero(~holds)
        if not again.size:
            break
        length[again] *= 0.5
        fill(again.repeat(2) if again.size == 1 else again)
    return TaylorSeries(terms, length, length.copy(), fastest), np.flatnonzero(~holds)


def _step(
    marks: Marks, tolerance: float, segments: Segments, lanes: Lanes, w: Array, start: Array, drive: Array, length: Array
) -> tuple[Array, Array]:
    """The terms of y in powers of time over `length`, (count + 3, lanes), and of which lanes they hold. At least two lanes: NumPy sums a
    single one in another order, and no digit may depend on a lane's neighbours."""
    rule = points(order_for(tolerance, _POINTS))
    count = len(rule.at)
    time = rule.at * length
    a = drive + _change(segments, lanes, w, time)
    square = length * length
    f = np.empty((count + 1, lanes.y.size))  # y'' at the start and at the points
    f[0], later = lanes.b, f[1:]
    straight = lanes.y + lanes.v * time

    def swept() -> Array:
        y = np.einsum("kj,jl->kl", rule.twice, f)
        y *= square
        y += straight
        return y

    y = straight + (0.5 * lanes.b) * (time * time)
    force = _combined(start[:, :3], a)
    for _ in range(_COARSE):
        _sum(force, y - lanes.y, later)
        y = swept()
    at, near = marks.nearest(y)
    force = _combined(marks.rows, a, at)
    for _ in range(2):
        x = y - near
        _sum(force, x, later)
        change, y = y, swept()
    np.subtract(y, change, out=change)
    slope = _slope(force, x)
    second_order = np.abs(change).max(axis=0)
    second_order *= second_order * (np.abs(start[0, 2]) + np.abs(lanes.amplitude * start[1, 2]))
    for _ in range((count - 1) // 4):
        change *= slope
        later += change
        change = np.einsum("kj,jl->kl", rule.twice[:, 1:], change)
        change *= square
    series = np.einsum("kj,jl->kl", rule.chebyshev, f)
    terms = np.empty((count + 3, lanes.y.size))
    terms[0] = lanes.y
    np.multiply(lanes.v, length, out=terms[1])
    np.einsum("kj,jl->kl", rule.terms, series, out=terms[2:])
    terms[2] = 0.5 * lanes.b
    terms[2:] *= square
    room = LOCAL * tolerance
    within = np.abs(x).max(axis=0) <= _NEAR * marks.step
    within &= np.abs(series[-2:]).max(axis=0) * length <= _INSIDE * count * room
    within &= second_order * length <= _INSIDE * room
    within &= np.abs(change).max(axis=0) <= (_INSIDE * room) * length
    return terms, within


def _change(segments: Segments, lanes: Lanes, w: Array, time: Array) -> Array:
    """What the drive gains until these times [tau], (points, lanes)."""
    _, sin, cos = segment_value(segments, lanes.k, lanes.u)
    outward = -lanes.side * lanes.amplitude
    total = np.zeros_like(time)
    if segments.sloped:
        total += (outward * segments.slope[lanes.k] * lanes.omega) * time
    for s, c, f in zip(sin, cos, w, strict=True):
        half = np.tan((0.5 * f) * time)
        share = half / (1.0 + half * half)
        half *= -2.0 * outward * s
        half += 2.0 * outward * c
        half *= share
        total += half
    return total


def _combined(rows: Array, a: Array, at: Array | None = None) -> list[Array]:
    """-F + a G in powers of what y is off, (points, lanes) each, from rows (2, powers, lanes), or (2, powers, marks) and the marks."""
    force = []
    for falls, pushes in zip(*rows, strict=True):
        both = a * (pushes if at is None else pushes.take(at))
        both -= falls if at is None else falls.take(at)
        force.append(both)
    return force


def _sum(force: list[Array], x: Array, out: Array) -> None:
    """The force at x."""
    np.multiply(force[-1], x, out=out)
    for row in force[-2:0:-1]:
        out += row
        out *= x
    out += force[0]


def _slope(force: list[Array], x: Array) -> Array:
    """Its derivative by y there, short of the last power."""
    total = (1.5 * x) * force[3]
    total += force[2]
    total *= 2.0 * x
    total += force[1]
    return total
