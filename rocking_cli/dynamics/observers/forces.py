"""The forces between a rigid body and the ground, and their extremes along a stretch of the motion.

With z = alpha - u, u = |theta| [rad], ' by tau of the side, w = 1 + zg''/g and kappa = m R^2/I, the outward Fx and Fz over m g are

    Fx = kappa (u'' cos z + u'^2 sin z) - push,   Fz = w + kappa (u'' sin z - u'^2 cos z)

and their slopes are known too. On a stretch of length h a force f is near the cubic through its values and slopes at both ends: the error
is at most M x^2 (h - x)^2/24, M the largest |f''''|. Cubic and error are a quartic, which stays below its Bernstein coefficients

    f0,  f0 + h f0'/4,  (f0 + f1)/2 + h (f0' - f1')/6 + M h^4/144,  f1 - h f1'/4,  f1

M is estimated from the rate at which the motion bends, so that an extreme is found to 1e-6, not proved.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Self

import numpy as np

from ..body import Body, Edge
from ..march.ground import Shaking
from .extremes import Extremes

Array = np.ndarray

WITHIN = 1e-7  # of an extreme: error at which a search ends
_ROUNDS = 40
_CLEAR = 0.5  # of what a stretch may exceed its extreme by: where the error is larger, the peak of the cubic is not the place to look
_TALL = 1.0  # times the size of the forces and the fourth power of the rate: the estimate of M
PUSH, PULL, LIFT = 1, -1, 0  # what is searched for: the largest Fx/Fz, the largest -Fx/Fz, the largest -Fz


class Forces(NamedTuple):
    """Outward Fx and Fz over m g [-], and their slopes by the time of the stretch; arrays of one shape."""

    fx: Array
    fz: Array
    fx_slope: Array
    fz_slope: Array

    def take(self, at: Array) -> Self:
        """Those at these indices."""
        return type(self)(*(x[at] for x in self))

    @property
    def friction(self) -> Array:
        """|Fx|/Fz [-], infinite where Fz <= 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.fz > 0.0, np.abs(self.fx) / self.fz, np.inf)


class Stretches(NamedTuple):
    """Parts of a motion: start and end [tau, or another time], the forces at both, and the rate at which these bend [1/time]."""

    low: Array
    high: Array
    start: Forces
    end: Forces
    rate: Array

    def take(self, at: Array) -> Self:
        """Those at these indices."""
        return type(self)(self.low[at], self.high[at], self.start.take(at), self.end.take(at), self.rate[at])


Along = Callable[[Array, Array], Forces]  # the forces on stretches of these indices, at these times


def forces_on(body: Body, edge: Edge, shaking: Shaking, u: Array, rate: Array) -> Forces:
    """Forces of a body at u, u' [rad, by tau] on an edge under this push and weight over m g; arrays of one shape."""
    push, push_slope, weight, weight_slope = shaking
    z = edge.alpha - u
    sin, cos = np.sin(z), np.cos(z)
    if body.linear:
        bend, jerk = push - weight * z, push_slope + weight * rate - weight_slope * z
    else:
        bend = push * cos - weight * sin
        jerk = push_slope * cos + rate * (weight * cos + push * sin) - weight_slope * sin
    if body.damping:
        bend = bend - 2.0 * body.damping * rate
        jerk = jerk - 2.0 * body.damping * bend
    square, turns = rate * rate, 3.0 * rate * bend
    jerk = jerk - rate * square
    return Forces(
        edge.kappa * (bend * cos + square * sin) - push,
        weight + edge.kappa * (bend * sin - square * cos),
        edge.kappa * (jerk * cos + turns * sin) - push_slope,
        weight_slope + edge.kappa * (jerk * sin - turns * cos),
    )


def forces_on_still_ground(body: Body, edge: Edge, square: Array, u: Array) -> Forces:
    """Forces of an undamped body at u [rad] on still ground, whose u'^2 at the ground is `square`; slopes by u."""
    z = edge.alpha - u
    sin, cos = np.sin(z), np.cos(z)
    bend, slope = (-z, np.ones(z.shape)) if body.linear else (-sin, cos)
    left = square - body.fall(edge, u)  # u'^2
    return Forces(
        edge.kappa * (bend * cos + left * sin),
        1.0 + edge.kappa * (bend * sin - left * cos),
        edge.kappa * (slope * cos + 3.0 * bend * sin - left * cos),
        edge.kappa * (slope * sin - 3.0 * bend * cos - left * sin),
    )


def note_extremes(friction: Extremes, lift: Extremes, cell: Array, along: Along, found: Stretches, one_way: bool = False) -> None:
    """Take the largest |Fx|/Fz and the largest -Fz of stretches of these cells into their extremes, each to `WITHIN`.

    along: the forces inside the stretches; one_way: whether only an outward Fx counts. The result of a stretch does not depend on other
    stretches, nor on the extremes so far.
    """
    ends = found.start, found.end
    worst = [np.where(f.fx > 0.0, f.friction, np.where(f.fz > 0.0, 0.0, np.inf)) if one_way else f.friction for f in ends]
    friction.offer(cell, np.maximum(*worst))
    lift.offer(cell, -np.minimum(found.start.fz, found.end.fz))
    with np.errstate(all="ignore"):
        up, across = _hopeful(found, lift.largest[cell], friction.largest[cell])
        kind = np.repeat([LIFT, PUSH] if one_way else [LIFT, PUSH, PULL], [up.size] + [across.size] * (1 if one_way else 2))
        own = np.concatenate([up, across] if one_way else [up, across, across])
        if not own.size:
            return
        largest = _search(along, found, own, kind)
    at = kind == LIFT
    lift.offer(cell[own[at]], largest[at])
    friction.offer(cell[own[~at]], largest[~at])


def _hopeful(s: Stretches, lift: Array, friction: Array) -> tuple[Array, Array]:
    """Stretches on which -Fz may exceed `lift`, and those on which |Fx|/Fz may exceed `friction`, by index."""
    h, one, other = s.high - s.low, s.start, s.end
    error = _error(s.rate, h)
    low, sides = np.minimum(one.fz, other.fz), np.maximum(np.abs(one.fx) - friction * one.fz, np.abs(other.fx) - friction * other.fz)
    size = np.maximum(np.abs(one.fz), np.abs(other.fz))
    fz = _inner(h, one.fz, other.fz, one.fz_slope, other.fz_slope)
    fx = _inner(h, one.fx, other.fx, one.fx_slope, other.fx_slope)
    fz[1] -= error * size
    up = np.flatnonzero(np.minimum(low, fz.min(axis=0)) < -lift)
    pull = np.abs(fx) - friction * fz
    pull[1] += error * np.maximum(np.abs(one.fx), np.abs(other.fx))
    return up, np.flatnonzero((np.maximum(sides, pull.max(axis=0)) > 0.0) & (friction < np.inf))


def _inner(h: Array, f0: Array, f1: Array, slope0: Array, slope1: Array) -> Array:
    """The three inner Bernstein coefficients of the cubic, (3, stretches)."""
    return np.array([f0 + 0.25 * h * slope0, 0.5 * (f0 + f1) + h * (slope0 - slope1) / 6.0, f1 - 0.25 * h * slope1])


def _error(rate: Array, h: Array) -> Array:
    """M h^4/144 over the size of the forces."""
    square = rate * h
    square *= square
    return _TALL / 144.0 * square * square


def _bound(s: Stretches, kind: Array, level: Array) -> Array:
    """Bernstein coefficients (5, stretches) of what exceeds a level: -Fz - level, or +-Fx - level Fz, with the error of the cubic."""
    hold, off = np.where(kind == LIFT, 1.0, level), np.where(kind == LIFT, level, 0.0)
    f0, f1 = (kind * f.fx - hold * f.fz - off for f in (s.start, s.end))
    h, slopes = s.high - s.low, (kind * f.fx_slope - hold * f.fz_slope for f in (s.start, s.end))
    inner = _inner(h, f0, f1, *slopes)
    inner[1] += _error(s.rate, h) * np.maximum(*(np.abs(kind * f.fx) + np.abs(hold * f.fz) for f in (s.start, s.end)))
    return np.array([f0, *inner, f1])


def _search(along: Along, found: Stretches, own: Array, kind: Array) -> Array:
    """The largest values of these kinds on the stretches `own`, (pairs,): stretches are parted, at the peak of the cubic or in the middle,
    until none can exceed the largest value found on it by more than `WITHIN`."""
    ends = np.where(kind == LIFT, -np.minimum(found.start.fz, found.end.fz)[own], -np.inf)
    for f in (found.start, found.end):
        ends = np.maximum(ends, _value(f.take(own), kind))
    largest, pair, s = ends, np.arange(own.size), found.take(own)
    for _ in range(_ROUNDS):
        level, asked = largest[pair], kind[pair]
        b = _bound(s, asked, level)
        excess = b[1:4].max(axis=0)
        held = np.where(asked == LIFT, 1.0, np.clip(np.minimum(s.start.fz, s.end.fz), 0.0, 1.0))
        at = np.flatnonzero((excess > WITHIN * held * (1.0 + np.abs(level))) & (level < np.inf))
        if not at.size:
            break
        pair, s, b, excess = pair[at], s.take(at), b[:, at], excess[at]
        x = _crest(s, kind[pair], largest[pair], excess)
        there = along(own[pair], x)
        np.fmax.at(largest, pair, _value(there, kind[pair]))
        pair = np.concatenate([pair, pair])
        before, after = s._replace(high=x, end=there), s._replace(low=x, start=there)
        s = Stretches(*(_joined(a, b) for a, b in zip(before, after, strict=True)))
    return largest


def _joined(a: Any, b: Any) -> Any:
    return np.concatenate([a, b]) if isinstance(a, np.ndarray) else Forces(*map(_joined, a, b))


def _value(f: Forces, kind: Array) -> Array:
    """-Fz, Fx/Fz or -Fx/Fz; the latter infinite where Fz <= 0."""
    return np.where(kind == LIFT, -f.fz, np.where(f.fz > 0.0, kind * f.fx / f.fz, np.inf))


def _crest(s: Stretches, kind: Array, level: Array, excess: Array) -> Array:
    """Where to part stretches: at the peak of the cubic where it has one and the error is small against the excess, else in the middle."""
    h, exact = s.high - s.low, s._replace(rate=np.zeros(s.rate.shape))
    f = _bound(exact, kind, level)
    error = _bound(s, kind, level)[2] - f[2]
    c1, d1, gain = 4.0 * (f[1] - f[0]), 4.0 * (f[4] - f[3]), f[4] - f[0]  # slopes over the stretch
    c2, c3 = 3.0 * gain - 2.0 * c1 - d1, c1 + d1 - 2.0 * gain
    root = np.sqrt(c2 * c2 - 3.0 * c1 * c3)
    x = np.where(c2 > 0.0, -(c2 + root) / (3.0 * c3), c1 / (root - c2))
    use = (x > 0.0) & (x < 1.0) & (error <= _CLEAR * excess)
    x = s.low + np.where(use, x, 0.5) * h
    return np.where((x > s.low) & (x < s.high), x, s.low + 0.5 * h)
