"""Between what the forces on the ground stay along a step, from the series of the motion: most steps are known to hold no record.

The mass centre is at kappa^-1 (sin z, cos z) of the edge, in the unit of m g and tau, so that with the terms of its series

    -s Fx = push + kappa (sin z)'',   Fz = w + kappa (cos z)''

are series too. Of each the polynomial of degree d through its values at Chebyshev's extrema is taken, which leaves out of x^n no more than
2^-2d h_(n-d-1)(nodes, 1), h the complete homogeneous sums; on a step no polynomial leaves the range of its Bernstein coefficients. So no
step that is left out holds a record, and none that is looked at a crest higher than the one found by more than twice what is left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import comb
from typing import NamedTuple, Self

import numpy as np

from ..drive import summed
from ..equations.taylor import TaylorSeries, blocks, powers

Array = np.ndarray
SINGLE = np.float32  # is enough to tell which steps are not worth a look

_DEGREE, _STEPS = 5, 3  # of the polynomials, of Newton's method to a crest of one
_CARRIED = 10.0  # times the tolerance of y: what the drive at the start of a step, known from the force that is carried, may be off
_ROUNDING = 1e-5  # of every term, 80 units in the last place of a single, where powers are wrong by 20 and sums by another 20
_BLOCK = 1024  # steps, whose terms stay in the second-level cache
_TAIL = 2.0  # times the largest of the last four terms: what comes after them, of which each is below two thirds of the one before


class Crests(NamedTuple):
    """Of each step, (2, steps), of -Fz and of |Fx|/Fz: whether it may beat a record; if so, whether its hull has but one place for that;
    which part of the step that is, and the second derivative there by that part."""

    wanted: Array
    plain: Array
    x: Array
    bend: Array


class Hull(NamedTuple):
    """Of each step the Bernstein coefficients of -Fx and Fz over m g, (degree + 1, 2, steps), and what either may differ from them,
    (2, steps)."""

    forces: Array
    slack: Array

    def take(self, at: Array) -> Self:
        """Of some steps."""
        return type(self)(self.forces.take(at, axis=2), self.slack.take(at, axis=1))

    def reached(self) -> tuple[Array, Array]:
        """(Fz, |Fx|/Fz): the least and the largest that are certainly reached at some instant of each step, or worse ones."""
        across, up = _mixed(_values().astype(SINGLE), self.forces).swapaxes(0, 1)
        low = (up + self.slack[1]).min(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = (np.abs(across) - self.slack[0]) / (up + self.slack[1])
        ratio[~((up > self.slack[1]) & (ratio > 0.0))] = 0.0
        return low, ratio.max(axis=0)

    def may_beat(self, fz: Array, friction: Array) -> Array:
        """Whether a least Fz or a largest |Fx|/Fz may be beaten within each step; (steps,)."""
        across, up = self.forces.swapaxes(0, 1)
        with np.errstate(invalid="ignore"):
            beyond = (np.abs(across) - friction * up).max(axis=0) + self.slack[0] + friction * self.slack[1]
            return ~((up.min(axis=0) - self.slack[1] >= fz) & (~(beyond > 0.0) | (friction == np.inf)))

    def join(self, others: Sequence[Self]) -> Self:
        """These and others."""
        every = (self, *others)
        return type(self)(np.concatenate([x.forces for x in every], axis=2), np.concatenate([x.slack for x in every], axis=1))

    def crests(self, fz: Array, friction: Array) -> Crests:
        """Where records of Fz and |Fx|/Fz, (steps,), may be beaten most; finite ones."""
        across, up = self.forces.astype(float).swapaxes(0, 1)
        slack = np.array([self.slack[1], self.slack[0] + friction * self.slack[1]])
        held = friction * up
        outward, inward = (across - held).max(axis=0), (-across - held).max(axis=0)
        beyond = np.array([fz - up, np.where(outward >= inward, 1.0, -1.0) * across - held]).swapaxes(0, 1)  # (coefficients, 2, steps)
        wanted = beyond.max(axis=0) + slack > 0.0
        rises = np.diff(beyond, axis=0) > 0.0
        turns = rises[:-1] & ~rises[1:]
        begins, ends = np.where(rises[0], -np.inf, beyond[0]), np.where(rises[-1], beyond[-1], -np.inf)
        inside, x, bend = _crest(beyond, turns & wanted)
        best = np.maximum(np.maximum(begins, ends), inside)
        near = best - 2.0 * slack
        plain = ((begins >= near).astype(np.int8) + (ends >= near) + (inside >= near) == 1) & (turns.sum(axis=0) <= 1)
        plain[1] &= np.minimum(outward, inward) + slack[1] <= 0.0
        x = np.where(begins == best, 0.0, np.where(ends == best, 1.0, x))
        bend[1] /= _polynomial(summed(_to_powers()[:, :, None] * up[:, None]), x[1])
        return Crests(wanted, plain, x, bend)


def _crest(coefficients: Array, turns: Array) -> tuple[Array, Array, Array]:
    """Height, place and second derivative of the crest of polynomials whose coefficients fall after having risen once; minus infinity
    where they do not."""
    shape = turns.shape[1:]
    height, place, bend = np.full(shape, -np.inf), np.zeros(shape), np.zeros(shape)
    row, lane = np.nonzero(turns.any(axis=0))
    own, first, some = coefficients[:, row, lane], turns[:, row, lane].argmax(axis=0), np.arange(row.size)
    before, middle, after = (own[first + i, some] for i in range(3))
    x = (first + (middle - before) / (2.0 * middle - before - after)) / (_DEGREE - 1.0)
    terms = summed(_to_powers()[:, :, None] * own[:, None])
    n = np.arange(1.0, _DEGREE + 1.0)[:, None]
    slope = n * terms[1:]
    rate = n[:-1] * slope[1:]
    for _ in range(_STEPS):
        x = np.clip(x - _polynomial(slope, x) / _polynomial(rate, x), 0.0, 1.0)
    height[row, lane], place[row, lane], bend[row, lane] = _polynomial(terms, x), x, _polynomial(rate, x)
    return height, place, bend


def _polynomial(terms: Array, x: Array) -> Array:
    """Of terms, (terms, lanes), at x."""
    total = terms[-1]
    for term in terms[-2::-1]:
        total = total * x + term
    return np.asarray(total)


def hull_of(series: TaylorSeries, stop: Array, kappa: Array | float, tolerance: float) -> Hull | None:
    """Of steps to `stop` [tau] on edges of this kappa; None where the series have no `turn`."""
    if series.turn is None:
        return None
    turn, push, weight = series.turn
    rows = len(turn) - 2
    interpolants, left = _matrices(rows)
    found = Hull(np.empty((_DEGREE + 1, 2, stop.size), dtype=SINGLE), np.empty((2, stop.size), dtype=SINGLE))
    for part in blocks(stop.size, _BLOCK):
        terms = turn[2:, :, part] * np.asarray(kappa[part] if isinstance(kappa, np.ndarray) else kappa, dtype=SINGLE)
        terms[:, 0] += push[:, part]
        if weight is not None:
            terms[:, 1] += weight[:, part]
        unit = series.unit[part]
        x = powers((stop[part] / unit).astype(SINGLE), rows)
        x *= (1.0 / (unit * unit)).astype(SINGLE)
        terms *= x[:, None]
        found.forces[:, :, part] = _mixed(interpolants, terms)
        if weight is None:
            found.forces[:, 1, part] += 1.0
        np.abs(terms, out=terms)
        slack = _mixed(left, terms)[0]
        slack += SINGLE(_TAIL * (rows + 1) * (rows + 2)) * terms[-4:].max(axis=0)
        np.add(slack, SINGLE(_CARRIED * tolerance + _ROUNDING), out=found.slack[:, part])
    return found


def _mixed(matrix: Array, rows: Array) -> Array:
    """The matrix times rows, (rows, 2, steps); of two columns at least, since NumPy sums a single one in another order."""
    return np.einsum("dn,nl->dl", matrix, rows.reshape(len(rows), -1)).reshape(len(matrix), *rows.shape[1:])


def _nodes() -> Array:
    return 0.5 - 0.5 * np.cos(np.pi * np.arange(_DEGREE + 1.0) / _DEGREE)


@lru_cache(maxsize=1)
def _values() -> Array:
    """Values at the nodes of polynomials of these Bernstein coefficients."""
    x = _nodes()[:, None]
    n = np.arange(_DEGREE + 1)
    choose = np.array([comb(_DEGREE, int(i)) for i in n])
    return np.asarray(choose * x**n * (1.0 - x) ** (_DEGREE - n))


@lru_cache(maxsize=1)
def _to_powers() -> Array:
    """(degree + 1, degree + 1): of each Bernstein polynomial its terms."""
    n = np.arange(_DEGREE + 1)
    return np.array([[(-1.0) ** (m - i) * comb(_DEGREE, m) * comb(m, i) if m >= i else 0.0 for m in n] for i in n])


@lru_cache(maxsize=64)
def _matrices(rows: int) -> tuple[Array, Array]:
    """Of (n + 1)(n + 2) x^n, n below `rows`: the Bernstein coefficients of the interpolants, (degree + 1, rows), and what these leave out,
    (1, rows)."""
    x, n = _nodes(), np.arange(float(rows))
    sums = np.zeros(rows)  # of x^m over the nodes and 1, m = 0, 1 ...
    sums[0] = 1.0
    for node in (*x, 1.0):
        for m in range(1, rows):
            sums[m] += node * sums[m - 1]
    left = np.zeros(rows)
    left[_DEGREE + 1 :] = 0.25**_DEGREE * sums[: max(0, rows - _DEGREE - 1)]
    twice = (n + 1.0) * (n + 2.0)
    interpolants = np.linalg.solve(_values(), x[:, None] ** n) * twice
    return interpolants.astype(SINGLE), ((left + _ROUNDING) * twice).astype(SINGLE)[None]
