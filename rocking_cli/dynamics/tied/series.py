"""The motion of tied bodies within one phase of their restraints: its Taylor series and its first turn.

Linear: y'' = -k y - c + a. Nonlinear, with y = theta/sin(alpha) on the present side,

    y'' = -sin(alpha - theta)/sin(alpha) + a cos(alpha - theta)/cos(alpha) - M(theta)/(m g R sin(alpha))

M is a sum of cos theta, sin theta, cos 2 theta, sin 2 theta, cos(theta/2) within a phase, whose series follow from that of theta. The
second harmonics are rho cos(2 theta - 2 phi) = rho (2 u^2 - 1) with u = cos(theta - phi), so that they take one product of series.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...motions.blocks import blocks
from ...motions.segments import Segments
from ..drive import segment_value
from ..equations import taylor
from ..equations.equation import Point
from ..equations.taylor import TaylorSeries
from ..lanes import Array, Lanes
from ..march.roots import bernstein_form, impact_root, sense
from .devices import Devices, Phase

_HALVINGS = 40


class Step(NamedTuple):
    """A step with at most one turn. arc: the motion from its start; h: its length [tau]; end: the state at its end; outward: direction of
    the motion at its start, 1 outwards, -1 inwards, 0 for bodies that do not move; turn: the time at which y' = 0, NaN without a turn;
    fastest, largest_acceleration: bounds of |y'| and |y''| in the step."""

    arc: TaylorSeries
    h: Array
    end: Point
    outward: Array
    turn: Array
    fastest: Array
    largest_acceleration: Array


class Law:
    """The equation of motion of tied bodies. alpha: of the right and the left side [rad], not used by the linear equation; damping: zeta
    [-]; tolerance: of y."""

    def __init__(self, devices: Devices, alpha: Array, damping: float, tolerance: float) -> None:
        self.devices, self.damping, self.tolerance, self.order = devices, damping, tolerance, taylor.order_for(tolerance)
        self.sin, self.tan = np.sin(alpha), np.tan(alpha)

    def force(self, row: Array, now: Phase, y: Array, a: Array) -> Array:
        """y'' under the outward drive a, without damping, (lanes,)."""
        if self.devices.linear:
            return a - 1.0 + y - self.devices.pulled(row, now, y)
        cos, sin, tan = np.cos(self.sin[row] * y), np.sin(self.sin[row] * y), self.tan[row]
        return a * (cos + tan * sin) - (cos - sin / tan) - self.devices.pulled(row, now, y)

    def flow(self, segments: Segments, lanes: Lanes, row: Array, now: Phase, exact: Array) -> TaylorSeries:
        """The series of lanes from their present state; exact: True where y'' is exactly 0 now."""
        if lanes.y.size == 1:  # NumPy sums a single lane in another order: no digit may depend on a lane's neighbours
            both = np.zeros(2, dtype=np.int64)
            return self.flow(segments, lanes.take(both), row[both], now.take(both), exact[both]).take(both[:1])
        lanes = Lanes.joined([lanes])
        terms, fastest = np.empty((self.order + 1, lanes.y.size)), np.empty(lanes.y.size)
        for block in blocks(lanes.y.size, taylor.CACHED):
            fastest[block] = self._fill(terms[:, block], segments, lanes.take(block), row[block], now.take(block), exact[block])
        return taylor.series(terms, fastest, self.tolerance, self.damping)

    def _fill(self, terms: Array, segments: Segments, lanes: Lanes, row: Array, now: Phase, exact: Array) -> Array:
        """Fill `terms`, (terms, lanes), with the Taylor terms of y in powers of (rate times h), h the time from now; return the rate
        [1/tau]."""
        stiffest = np.sqrt(self.devices.linear_terms(row, now)[1])
        known = taylor.drive_series(segments, lanes, self.order - 2, rate=1.0 + stiffest)
        drive, unit, unit2 = known.terms, known.unit, known.unit**2
        push = -lanes.side * lanes.amplitude * (segments.s_start[lanes.k] + segment_value(segments, lanes.k, lanes.u)[0])
        drive[0] = push * unit2
        terms[0], terms[1] = lanes.y, lanes.v * unit
        start = np.where(exact, 0.0, unit2 * self.force(row, now, lanes.y, push))
        later = (self._linear if self.devices.linear else self._nonlinear)(terms, row, now, drive, unit2)
        for n in range(self.order - 1):
            own = later(n)
            if n == 0:
                own = start
            if self.damping:
                own -= 2.0 * self.damping * unit * ((n + 1) * terms[n + 1])
            np.multiply(own, 1.0 / ((n + 1) * (n + 2)), out=terms[n + 2])
        return known.fastest

    def _linear(self, terms: Array, row: Array, now: Phase, drive: Array, unit2: Array) -> Callable[[int], Array]:
        """Return a function of n that gives unit^2 times term n of y'', from n = 1 on."""
        soft = unit2 * (1.0 - self.devices.linear_terms(row, now)[1])
        return lambda n: soft * terms[n] + drive[n] if n < len(drive) else soft * terms[n]

    def _nonlinear(self, terms: Array, row: Array, now: Phase, drive: Array, unit2: Array) -> Callable[[int], Array]:
        """As `_linear`; the caller calls the function for n = 0, 1 ... in this order."""
        factor, sin, tan = unit2 * self.devices.circular_terms(row, now), self.sin[row], self.tan[row]
        factor[0] -= unit2
        factor[1] += unit2 / tan
        second, turned = 2.0 * np.hypot(factor[2], factor[3]), 0.5 * np.arctan2(factor[3], factor[2])
        count, stretched = len(factor) - 2, second.any()
        mix = np.zeros((3, count, row.size))  # of the waves: the linear part of y'', the lever of the drive, u
        mix[0], mix[1, 0], mix[1, 1] = np.delete(factor, (2, 3), axis=0), 1.0, tan
        mix[2, 0], mix[2, 1] = np.cos(turned), np.sin(turned)
        waves, rate, mixed = np.empty((len(terms), count, row.size)), np.empty(terms.shape), np.empty((len(terms), 3, row.size))
        both, half = np.empty((count, row.size)), np.array([[1.0], [0.5]])[: count // 2]

        def term(n: int) -> Array:
            if n == 0:
                theta = half * (sin * terms[0])
                waves[0, ::2], waves[0, 1::2] = np.cos(theta), np.sin(theta)
            else:
                np.multiply(terms[n], n * sin, out=rate[n])
                np.einsum("il,ijl->jl", rate[1 : n + 1], waves[n - 1 :: -1], out=both)
                np.multiply(both[1::2], half / -n, out=waves[n, ::2])
                np.multiply(both[::2], half / n, out=waves[n, 1::2])
            np.einsum("kjl,jl->kl", mix, waves[n], out=mixed[n])
            most = min(n + 1, len(drive))
            own = np.einsum("il,il->l", drive[:most], mixed[n - most + 1 : n + 1, 1][::-1])
            own += mixed[n, 0]
            if stretched:
                own += second * np.einsum("il,il->l", mixed[: n + 1, 2], mixed[n::-1, 2])
            return own

        return term


def one_turn(arc: TaylorSeries, left: Array) -> Step:
    """The longest step of lanes, at most `left` [tau], that ends before the second turn of their series."""
    h = np.minimum(arc.longest, left)
    end, chord_errors = arc.at_with_chord_errors(h)
    kept, monotone = sense(arc, h, end, chord_errors)
    fastest = np.maximum(np.abs(arc.v), np.abs(end.v)) + chord_errors[0] / h
    largest_acceleration = np.maximum(np.abs(arc.b), np.abs(end.b)) + chord_errors[1] / (h * h)
    outward = np.sign(np.where(arc.v != 0.0, arc.v, arc.b))
    turns = ~kept & monotone & (arc.v != 0.0) & (end.v * outward <= 0.0)
    doubtful = np.flatnonzero(~kept & ~monotone)
    if doubtful.size:
        h[doubtful], outward[doubtful], turns[doubtful] = _bernstein(arc.take(doubtful), h[doubtful])
        end = Point(*(np.array(x) for x in end))
        for whole, x in zip(end, arc.take(doubtful).at(h[doubtful]), strict=True):
            whole[doubtful] = x
    turn, at = np.full(h.size, np.nan), np.flatnonzero(turns)
    if at.size:
        n = np.arange(1.0, len(arc.terms))[:, None]
        speed = TaylorSeries(n * arc.terms[1:, at] * outward[at], arc.unit[at], h[at], arc.fastest[at])
        turn[at] = falls(speed, np.zeros(at.size), h[at])[0]
    return Step(arc, h, end, outward, turn, fastest, largest_acceleration)


def _bernstein(arc: TaylorSeries, h: Array) -> tuple[Array, Array, Array]:
    """(shorter steps with at most one turn, direction of the motion at their start, True where there is a turn), from the signs of the
    Bernstein coefficients of y'."""
    terms = np.zeros((max(len(arc.terms), taylor.MOST_TERMS + 1), h.size))  # as many as with any neighbours
    terms[: len(arc.terms)] = arc.terms
    n, share, lanes = np.arange(1.0, len(terms))[:, None], h / arc.unit, np.arange(h.size)
    outward, turns = np.zeros(h.size), np.zeros(h.size, dtype=bool)
    for halving in range(_HALVINGS + 1):
        signs = np.sign(bernstein_form(n * terms[1:, lanes] * share[lanes] ** n))
        changes, outward[lanes] = _changes(signs)
        turns[lanes] = (changes == 1) | ((changes > 1) & (halving == _HALVINGS))
        lanes = lanes[changes > 1]
        if not lanes.size or halving == _HALVINGS:
            break
        share[lanes] *= 0.5
    return share * arc.unit, outward, turns


def _changes(signs: Array) -> tuple[Array, Array]:
    """(number of sign changes in each column, without zeros; first sign in the column that is not 0)."""
    last = np.maximum.accumulate(np.where(signs != 0.0, np.arange(len(signs))[:, None], 0), axis=0)
    filled = np.take_along_axis(signs, last, axis=0)
    first = np.take_along_axis(signs, np.argmax(signs != 0.0, axis=0)[None], axis=0)[0]
    return np.count_nonzero(filled[1:] * filled[:-1] < 0.0, axis=0), first


def falls(arc: TaylorSeries, low: Array, high: Array) -> tuple[Array, Array]:
    """(h, y' at h) where series fall through zero; there is one such h between `low` and `high`."""
    fall = np.sqrt(np.maximum(arc.v * arc.v - 2.0 * arc.b * arc.y, 0.0))
    guess = np.where(arc.v < 0.0, 2.0 * arc.y / (fall - arc.v), -(arc.v + fall) / arc.b)  # by the first three terms
    return impact_root(arc, low, high, np.where((guess > low) & (guess < high), guess, 0.5 * (low + high)))
