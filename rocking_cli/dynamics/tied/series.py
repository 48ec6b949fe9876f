"""The Taylor series of tied bodies within one phase of their restraints, and the stretches on which y is monotone.

Linear: y'' = -k y - c + a. Nonlinear, with y = theta/sin(alpha) on the present side,

    y'' = -sin(alpha - theta)/sin(alpha) + a cos(alpha - theta)/cos(alpha) - M(theta)/(m g R sin(alpha))

M is a sum of cos theta, sin theta, cos 2 theta, sin 2 theta, cos(theta/2) within a phase, whose series follow from that of theta.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..drive import segment_value
from ..equations.taylor import LONGEST, MOST_TERMS, WITHIN, degrees, factors_for, last_terms
from ..lanes import Array, Lanes
from ..march.roots import bernstein_form
from .devices import Devices, Phase

_TERMS_RATE = 1.3  # the rate for which `degrees` counts terms
_HALVINGS = 40
_ROUNDS = 100
_CLOSE, _CLOSEST = 1e-9, 1e-16  # of the root and of the bracket: a Newton step this short leaves nothing


class Stretch(NamedTuple):
    """A stretch on which y is monotone. terms: of y in powers of the share of the unit [tau]; share: its length over the unit; outward: 1,
    -1 or, of bodies that do not move, 0; turns: True if y' = 0 at its end."""

    terms: Array
    unit: Array
    share: Array
    outward: Array
    turns: Array


class Law:
    """An equation of tied bodies. alpha: of the right and the left side [rad], which the linear one does not use; damping: zeta [-];
    tolerance: of y."""

    def __init__(self, devices: Devices, alpha: Array, damping: float, tolerance: float) -> None:
        self.devices, self.damping, self.tolerance = devices, damping, tolerance
        self.sin, self.tan = np.sin(alpha), np.tan(alpha)

    def force(self, row: Array, now: Phase, y: Array, a: Array) -> Array:
        """y'' without damping, (lanes,)."""
        if self.devices.linear:
            fixed, rate = self.devices.linear_terms(row, now)
            return y * (1.0 - rate) - 1.0 - fixed + a
        found = self._coefficients(row, now) * _circular(self.sin[row] * y, 6 if self.devices.tendon.any() else 4)
        cos, sin = _circular(self.sin[row] * y, 2)
        return np.asarray(found.sum(axis=0) + a * (cos + self.tan[row] * sin))

    def stretch(self, segments: Segments, lanes: Lanes, row: Array, now: Phase, exact: Array) -> Stretch:
        """The next monotone stretch of lanes within their segment; exact: True where y'' is exactly 0 now."""
        if lanes.y.size == 1:  # NumPy sums a single lane in another order: no digit may depend on a lane's neighbours
            both = np.zeros(2, dtype=np.int64)
            phase = Phase(*(x[..., both] for x in now))
            found = self.stretch(segments, lanes.take(both), row[both], phase, exact[both])
            return Stretch(found.terms[:, :1], *(x[:1] for x in found[1:]))
        left = (segments.length[lanes.k] - lanes.u) / lanes.omega
        w = segments.frequency.take(lanes.k, axis=1) * lanes.omega
        fastest = _TERMS_RATE + self._stiffest(row, now) + (w.max(axis=0) if len(w) else 0.0)
        unit = np.minimum(left, 2.0 * LONGEST * _TERMS_RATE / fastest)
        drive = _drive(segments, lanes, unit)
        size = 2.0 + np.abs(drive[0]) + np.abs(lanes.v) * fastest + np.abs(self.force(row, now, lanes.y, drive[0]))
        degree = degrees(size, unit * fastest / _TERMS_RATE, self.tolerance)
        terms = self._terms(lanes, row, now, drive, unit, degree, exact)
        last = last_terms(terms, degree * unit.size + np.arange(unit.size), unit)
        with np.errstate(divide="ignore"):
            short = (WITHIN * self.tolerance * unit / last) ** (1.0 / (degree - 1.0))
        return _monotone(terms, unit, np.minimum(short, 1.0))

    def _stiffest(self, row: Array, now: Phase) -> Array:
        """A rate [1/tau] of the phase: the root of the stiffness of the restraints."""
        return np.sqrt(self.devices.linear_terms(row, now)[1])

    def _coefficients(self, row: Array, now: Phase) -> Array:
        found = self.devices.circular_terms(row, now)
        found[0] -= 1.0
        found[1] += 1.0 / self.tan[row]
        return found

    def _terms(self, lanes: Lanes, row: Array, now: Phase, drive: Array, unit: Array, degree: Array, exact: Array) -> Array:
        factors = factors_for(unit, degree)
        terms = np.zeros((len(factors) + 2, unit.size))
        terms[0], terms[1] = lanes.y, lanes.v * unit
        term = self._linear(terms, row, now) if self.devices.linear else self._nonlinear(terms, row, now)
        drag = 2.0 * self.damping / unit
        for n, factor in enumerate(factors):
            own, by = term(n)
            if by is None:
                own += drive[n] if n < len(drive) else 0.0
            else:
                most = min(n, len(drive) - 1)
                own += np.einsum("il,il->l", drive[: most + 1], by[n - most : n + 1][::-1])
            if self.damping:
                own -= drag * ((n + 1) * terms[n + 1])
            if n == 0:
                own[exact] = 0.0
            terms[n + 2] = own * factor
        return terms

    def _linear(self, terms: Array, row: Array, now: Phase) -> Callable[[int], tuple[Array, Array | None]]:
        fixed, rate = self.devices.linear_terms(row, now)

        def term(n: int) -> tuple[Array, Array | None]:
            own = terms[n] * (1.0 - rate)
            return own - 1.0 - fixed if n == 0 else own, None

        return term

    def _nonlinear(self, terms: Array, row: Array, now: Phase) -> Callable[[int], tuple[Array, Array | None]]:
        factor = self._coefficients(row, now)
        count, sin, tan = len(factor), self.sin[row], self.tan[row]
        waves, by, rate = np.empty((len(terms), count, row.size)), np.empty((len(terms), row.size)), np.empty_like(terms)
        both, times = np.empty((count, row.size)), np.repeat([1.0, 2.0, 0.5], 2)[:count, None]

        def term(n: int) -> tuple[Array, Array | None]:
            if n == 0:
                waves[0] = _circular(sin * terms[0], count)
            else:
                np.multiply(terms[n], n * sin, out=rate[n])
                np.einsum("il,ijl->jl", rate[1 : n + 1], waves[n - 1 :: -1], out=both)
                np.multiply(both, times / n, out=both)
                waves[n, 0::2], waves[n, 1::2] = -both[1::2], both[0::2]
            by[n] = waves[n, 0] + tan * waves[n, 1]
            return np.einsum("jl,jl->l", factor, waves[n]), by

        return term


def _circular(theta: Array, count: int) -> Array:
    """cos and sin of theta, 2 theta and theta/2, as many rows as asked."""
    return np.array([f(times * theta) for times in (1.0, 2.0, 0.5)[: count // 2] for f in (np.cos, np.sin)])


def _drive(segments: Segments, lanes: Lanes, unit: Array) -> Array:
    """Terms of the outward drive in powers of the share of the unit, (terms, lanes)."""
    change, sin, cos = segment_value(segments, lanes.k, lanes.u)
    outward = -lanes.side * lanes.amplitude
    found = np.zeros((2 if segments.straight else MOST_TERMS, unit.size))
    found[0] = segments.s_start[lanes.k] + change
    found[1] = segments.slope[lanes.k] * lanes.omega * unit
    for s, c, w in zip(sin, cos, segments.frequency.take(lanes.k, axis=1) * lanes.omega * unit, strict=True):
        power = np.ones(unit.size)
        for n in range(1, len(found)):
            power = power * (w / n)
            found[n] += (c, -s, -c, s)[(n - 1) % 4] * power
    return np.asarray(found * outward)


def _monotone(terms: Array, unit: Array, share: Array) -> Stretch:
    """The stretch of a series up to its first turn, at most this share: between two zeros of y' that the signs of its Bernstein
    coefficients tell apart."""
    n = np.arange(1.0, len(terms))[:, None]
    share, outward, turns = share.copy(), np.zeros(share.size), np.zeros(share.size, dtype=bool)
    lanes = np.arange(share.size)
    for halving in range(_HALVINGS + 1):
        rate = n * terms[1:, lanes] * share[lanes] ** n
        signs = np.sign(bernstein_form(rate))
        changes, first = _changes(signs)
        outward[lanes] = first
        one = (changes == 1) | ((changes > 1) & (halving == _HALVINGS))
        turns[lanes] = one
        lanes = lanes[changes > 1]
        if not lanes.size:
            break
        if halving < _HALVINGS:
            share[lanes] *= 0.5
    at = np.flatnonzero(turns)
    if at.size:
        rate = n * terms[1:, at]
        share[at] = root(rate * outward[at], np.zeros(at.size), share[at], np.zeros(at.size))
    return Stretch(terms, unit, share, outward, turns)


def _changes(signs: Array) -> tuple[Array, Array]:
    """(number of sign changes of each column, zeros apart, its first sign that is not 0)."""
    changes, first = np.zeros(signs.shape[1], dtype=np.int64), np.zeros(signs.shape[1])
    last = first.copy()
    for row in signs:
        moved = row != 0.0
        changes += moved & (last != 0.0) & (row != last)
        first = np.where(first == 0.0, row, first)
        last = np.where(moved, row, last)
    return changes, first


def value(terms: Array, x: Array) -> tuple[Array, Array]:
    """A series and its slope at x, (lanes,)."""
    y, slope = terms[-1].copy(), np.zeros(x.size)
    for c in terms[-2::-1]:
        slope = slope * x + y
        y = y * x + c
    return y, slope


def root(terms: Array, low: Array, high: Array, level: Array) -> Array:
    """Where series that fall once through a level between `low` and `high` meet it, (lanes,): Newton's steps in a bracket that shrinks. A
    lane leaves when it has converged, so that its digits do not depend on its neighbours."""
    found, lanes, low, high, least = high.copy(), np.arange(high.size), low.copy(), high.copy(), _CLOSEST * high
    start, end = value(terms, low)[0] - level, value(terms, high)[0] - level
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where((start > 0.0) & (end < 0.0), start / (start - end), 0.5)  # a series may begin at its level
        x = low + (high - low) * share
        for _ in range(_ROUNDS):
            y, slope = value(terms, x)
            y -= level
            low, high = np.where(y > 0.0, x, low), np.where(y > 0.0, high, x)
            target = x - y / slope
            inside = (target >= low) & (target <= high)
            close = np.abs(target - x) <= np.maximum(_CLOSE * x, least)
            x = np.where(y == 0.0, x, np.where(inside, target, 0.5 * (low + high)))
            done = (inside & close) | (y == 0.0) | (high - low <= least)
            if done.any():
                found[lanes[done]] = x[done]
                terms, lanes = terms[:, ~done], lanes[~done]
                x, low, high, least, level = (of[~done] for of in (x, low, high, least, level))
                if not lanes.size:
                    break
    return found
