"""The extremes of forces along stretches, between quartics that enclose them.

With a bound M of |f''''| a function f lies within M x^2 (h - x)^2/24 of the cubic through its values and slopes at the ends of a stretch of
length h. Cubic and room together are a quartic, which is nowhere above its Bernstein coefficients

    b0 = f0,  b1 = f0 + h f0'/4,  b2 = (f0 + f1)/2 + h (f0' - f1')/6 + M h^4/144,  b3 = f1 - h f1'/4,  b4 = f1

and where b0, b2 and b4 are below 0, nowhere above (4/3) (b1^2 + b3^2)/|b2|, of b1 and b3 only what is above 0 (of either one and half of
b2: 4 b1 x (1 - x)^3 + 3 b2 x^2 (1 - x)^2 <= x (4 b1 + 3 b2 x)).

|Fx|/Fz exceeds r where |Fx| - r Fz > 0. A stretch of which this does not say that it holds no record is parted, at the crest of its
cubic or in the middle, until it is said of all its parts. What is found of a stretch hangs on nothing but the stretch.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from .bends import Forces
from .extremes import Records

Array = np.ndarray

_MARGIN = 1e-9  # of forces and m g: far more than rounding adds to what is found in a stretch
_NEAR, _FLOOR = 1e-10, 1e-13  # of an extreme, what may be missed of it; of the forces, what rounding may add
_ROUNDS, _SIFTS = 60, 1
_LEVEL = 0.5  # of what a stretch may exceed its record by: where the room is more, the cubic does not say where

Along = Callable[[Array, Array], Forces]  # the forces of stretches of these indices, at these times


class Spans(NamedTuple):
    """Parts of stretches: the index of the stretch, from when to when, bounds of |Fx''''| and |Fz''''|, (2, spans), and the forces at
    either end."""

    own: Array
    low: Array
    high: Array
    fourth: Array
    one: Forces
    other: Forces

    def take(self, at: Array) -> Self:
        """Some of them."""
        return type(self)(self.own[at], self.low[at], self.high[at], self.fourth[:, at], self.one.take(at), self.other.take(at))

    def parted(self, x: Array, there: Forces) -> Self:
        """Their parts before x and then those behind it."""
        own, fourth = np.tile(self.own, 2), np.tile(self.fourth, 2)
        low, high = np.concatenate([self.low, x]), np.concatenate([x, self.high])
        return type(self)(own, low, high, fourth, self.one.join(there), there.join(self.other))

    @property
    def size(self) -> Array:
        """Of the forces at the ends, with 1."""
        return 1.0 + np.maximum(np.abs(self.one.fx) + np.abs(self.one.fz), np.abs(self.other.fx) + np.abs(self.other.fz))


def ratio_of(forces: Forces, one_sided: bool) -> Array:
    """|Fx|/Fz, infinite without a hold; of a body at rest against its backing what it takes of that."""
    fx = np.maximum(forces.fx, 0.0) if one_sided else np.abs(forces.fx)
    return np.where(forces.fz > 0.0, fx / forces.fz, np.inf)


def search(records: Records, cell: Array, along: Along, spans: Spans, one_sided: bool = False) -> None:
    """Take in stretches, of which these are all; cell: of each of them."""
    for end in (spans.one, spans.other):
        records.note(cell, end.fz, ratio_of(end, one_sided))
    maybe = _hopeful(records, cell, spans, one_sided)
    row, own = np.nonzero(maybe)
    if not own.size:
        return
    cell, spans = cell[own], spans.take(own)
    best = np.where(
        row == 0, -np.minimum(spans.one.fz, spans.other.fz), np.maximum(ratio_of(spans.one, one_sided), ratio_of(spans.other, one_sided))
    )
    spans = spans._replace(own=np.arange(own.size))
    for i in range(_ROUNDS):
        at, x = _doubtful(spans, row[spans.own], best[spans.own], one_sided)
        if not at.size:
            return
        spans = spans.take(at)
        there = along(own[spans.own], x)
        ratio = ratio_of(there, one_sided)
        asked = row[spans.own]
        np.maximum.at(best, spans.own, np.where(asked == 0, -there.fz, ratio))
        records.note_row(asked, cell[spans.own], there.fz, ratio)
        spans = spans.parted(x, there)
        if i < _SIFTS:  # by what other stretches have shown in the meantime, all of a stretch or nothing
            alive = np.zeros(own.size, dtype=bool)
            hopeful = _hopeful(records, cell[spans.own], spans, one_sided)[row[spans.own], np.arange(spans.own.size)]
            alive[spans.own[hopeful]] = True
            spans = spans.take(np.flatnonzero(alive[spans.own]))


def _hopeful(records: Records, cell: Array, spans: Spans, one_sided: bool) -> Array:
    """(2, spans): which may beat the records of their cells, or come near them."""
    room, fz_min, friction = _MARGIN * spans.size, records.fz_min[cell], records.friction[cell]
    with np.errstate(invalid="ignore"):
        across, up = _coefficients(spans)
        lift = spans.fourth * (spans.high - spans.low) ** 4 / 144.0
        low = np.minimum(np.minimum(up[1], up[3]), up[2] - lift[1])
        pull = (across if one_sided else np.abs(across)) - friction * up
        pull[2] += lift[0] + friction * lift[1]
        return np.array([~(low >= fz_min + room), ~(pull.max(axis=0) <= -room * (1.0 + friction)) & (friction < np.inf)])


def _coefficients(spans: Spans) -> tuple[Array, Array]:
    """Those of the cubics through Fx and Fz as quartics, (5, spans)."""
    h, one, other = spans.high - spans.low, spans.one, spans.other
    return _bernstein(h, one.fx, other.fx, one.fx_slope, other.fx_slope), _bernstein(h, one.fz, other.fz, one.fz_slope, other.fz_slope)


def _bernstein(h: Array, f0: Array, f1: Array, slope0: Array, slope1: Array) -> Array:
    return np.array([f0, f0 + 0.25 * h * slope0, 0.5 * (f0 + f1) + h * (slope0 - slope1) / 6.0, f1 - 0.25 * h * slope1, f1])


def _doubtful(spans: Spans, row: Array, best: Array, one_sided: bool) -> tuple[Array, Array]:
    """Spans that may hold more than the best of their stretch, by index, and where to part them; row: 0 of -Fz, 1 of |Fx|/Fz."""
    _, low, high, fourth, one, other = spans
    h, level = high - low, np.where(row == 0, best, 0.0)
    with np.errstate(all="ignore"):
        rise = np.where(row == 0, 1.0, best)
        pull = _bernstein(h, row * one.fx, row * other.fx, row * one.fx_slope, row * other.fx_slope)
        down = _bernstein(h, -rise * one.fz - level, -rise * other.fz - level, -rise * one.fz_slope, -rise * other.fz_slope)
        lift = (row * fourth[0] + rise * fourth[1]) * h**4 / 144.0
        both = down + (pull if one_sided else np.abs(pull))
        least = np.clip(np.minimum(one.fz, other.fz), 0.0, 1.0)
        scale = 1.0 + row * best
        near = scale * np.maximum(_NEAR * np.where(row == 0, 1.0, least), _FLOOR * spans.size)
        both[2] += lift
        excess, rises = both[1:4].max(axis=0), np.maximum(both[1:4:2], 0.0)
        excess = np.where(both[2] < 0.0, np.minimum(excess, (rises[0] ** 2 + rises[1] ** 2) / (-0.75 * both[2])), excess)
        at = np.flatnonzero(~(excess <= near) & (best < np.inf))
        pull, low, h = pull[:, at], low[at], h[at]
        sense = 1.0 if one_sided else np.where(pull[2] < 0.0, -1.0, 1.0)
        f = down[:, at] + sense * pull
        c1, d1, gain = 4.0 * (f[1] - f[0]), 4.0 * (f[4] - f[3]), f[4] - f[0]
        c2, c3 = 3.0 * gain - 2.0 * c1 - d1, c1 + d1 - 2.0 * gain
        root = np.sqrt(c2 * c2 - 3.0 * c1 * c3)
        x = np.where(c2 > 0.0, -(c2 + root) / (3.0 * c3), c1 / (root - c2))
        most = f[0] + x * (c1 + x * (c2 + x * c3))
        crest = (x > 0.0) & (x < 1.0) & (most > 0.0) & ((both[2] < 0.0) | (lift <= _LEVEL * excess))[at]
    x = low + np.where(crest, x, 0.5) * h
    return at, np.where((x > low) & (x < low + h), x, low + 0.5 * h)
