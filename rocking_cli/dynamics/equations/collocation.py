"""Collocation: a polynomial whose y'' meets Eq. 3.4 at Chebyshev's points gives a mechanism's motion over a step, without Taylor series.

A sweep integrates y'' at the points twice, first with parabolas of F and G about the start, then with their series about the marks nearest
to y, then with the slope of the equation at these y. It costs no more than a Taylor step and is twice as long.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...motions.blocks import blocks
from ...motions.segments import Segments
from ..drive import segment_value
from ..lanes import Array, Lanes
from .patches import Marks
from .taylor import CACHED, LOCAL, TaylorSeries, order_for

_POINTS = 0.57  # number of points over -log(error of a step)
_COARSE = 2  # sweeps with parabolas: after them 99 % of the steps are near their marks
_PACE = 0.17  # largest product of step and pace of the drive, per point
_STIFF = 0.8  # largest square of a step times the slope of the force: each sweep leaves a tenth of the error or less
_FAR = 2.0  # largest change of y in a step, in half widths of a patch; y may also fall to half the lowest mark
_HALVED = 8  # how often a step is halved before Taylor series replace it
_NEAR = 2.0  # largest distance of y from the mark of its series, in steps of marks
_INSIDE = 3.0  # error of y' inside a step over that at its end, where the points are exact for twice as many powers


class Points(NamedTuple):
    """Chebyshev's points of a step of length 1, and matrices that act on the values of y'' at the start and at the points. at: the points,
    with the end and without the start, (points, 1); twice: gives the double integral at the points; chebyshev: gives the Chebyshev
    coefficients; terms: converts these to the coefficients of time^2, time^3 ... of y."""

    at: Array
    twice: Array
    chebyshev: Array
    terms: Array


@lru_cache(maxsize=16)
def points(count: int) -> Points:
    """Return the rule with `count` points besides the start."""
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
    """Return (the motion of undamped lanes under a constant weight, each over a step of its own length; the indices of lanes whose error is
    too large even on the shortest step). marks: points y at which the functions F and G of the equation are tabulated as series."""
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

    for block in blocks(lanes.y.size, CACHED):
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
    """(terms of y in powers of time over `length`; True where they hold), of two lanes or more: NumPy sums one in another order."""
    rule = points(order_for(tolerance, _POINTS))
    count = len(rule.at)
    time = rule.at * length
    a = drive + _change(segments, lanes, w, time)
    square = length * length
    f = np.empty((count + 1, lanes.y.size))  # y'' at the start and at the points
    f[0], later = lanes.b, f[1:]
    straight = lanes.y + lanes.v * time

    def swept() -> Array:
        return np.einsum("kj,jl->kl", rule.twice, f) * square + straight

    y = straight + (0.5 * lanes.b) * (time * time)
    falls, pushes = start[:, ::-1, None]  # highest power first
    force = a * pushes - falls
    for _ in range(_COARSE):
        later[:] = np.polyval(force, y - lanes.y)
        y = swept()
    at, near = marks.nearest(y)
    falls, pushes = marks.rows[:, ::-1].take(at, axis=2)
    force = a * pushes - falls
    for _ in range(2):
        x = y - near
        later[:] = np.polyval(force, x)
        before, y = y, swept()
    change = y - before
    slope = (1.5 * x * force[-4] + force[-3]) * (2.0 * x) + force[-2]  # without the last power
    second_order = np.abs(change).max(axis=0)
    second_order *= second_order * (np.abs(start[0, 2]) + np.abs(lanes.amplitude * start[1, 2]))
    for _ in range((count - 1) // 4):
        change *= slope
        later += change
        change = np.einsum("kj,jl->kl", rule.twice[:, 1:], change) * square
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
    """By how much the drive has changed at these times [tau], (points, lanes)."""
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
