"""Between what the forces on the ground stay along a step, from the series of the motion: most steps are known to hold no record.

The mass centre is at kappa^-1 (sin z, cos z) of the edge, in the unit of m g and tau, so that with the terms of its series

    -s Fx = push + kappa (sin z)'',   Fz = w + kappa (cos z)''

are series too. Of each the polynomial of degree d through its values at Chebyshev's extrema is taken, which leaves out of x^n no more than
2^-2d h_(n-d-1)(nodes, 1), h the complete homogeneous sums; on a step no polynomial leaves the range of its Bernstein coefficients. So no
step that is left out holds a record, and none that is looked at a crest higher than the one found by more than twice what is left out.
The polynomials are those of the whole reach of a series, where sin z and cos z are at hand; a step that ends before has their beginning.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import comb
from typing import NamedTuple, Self

import numpy as np

from ..equations.taylor import Turn, powers

Array = np.ndarray
SINGLE = np.float32  # is enough to tell which steps are not worth a look

_DEGREE, _STEPS = 5, 3  # of the polynomials, of Newton's method to a crest of one
_ROWS = 16  # terms of the forces at the most: the six more of a series for 1e-9 move a hull by 2e-6 of m g, its slack is 1.5 times
_CARRIED = 10.0  # times the tolerance of y: what the drive at the start of a step, known from the force that is carried, may be off
_STEEP = 2.0 * _DEGREE  # times what values may be off: what differences of coefficients at an end may be, slopes over the degree (Markov)
_ROUNDING = 1e-5  # of every term, 80 units in the last place of a single, where powers are wrong by 20 and sums by another 20
_TAIL = 2.0  # times the largest of the last four terms: what comes after them, of which each is below two thirds of the one before


class Crests(NamedTuple):
    """Where some forces are largest, (forces,): whether the hull has but one place for that; which part of the step that is, and the
    second derivative there by that part."""

    plain: Array
    x: Array
    bend: Array


class Hull(NamedTuple):
    """Of each step the Bernstein coefficients of -Fx and Fz over m g, (degree + 1, 2, steps), and what either may differ from them,
    (2, steps); reached, possible: of -Fz and |Fx|/Fz what the largest is at least, and at most, (2, steps)."""

    forces: Array
    slack: Array
    reached: Array
    possible: Array

    def take(self, at: Array) -> Self:
        """Of some steps."""
        return type(self)(*(x.take(at, axis=-1) for x in self))

    def join(self, others: Sequence[Self]) -> Self:
        """These and others."""
        return type(self)(*(np.concatenate(parts, axis=-1) for parts in zip(self, *others, strict=True)))

    def crests(self, row: Array) -> Crests:
        """Where -Fz (row 0) or |Fx|/Fz (row 1) is largest in each step."""
        across, up = self.forces.swapaxes(0, 1)
        held = np.where(row, self.reached[1], SINGLE(1.0))
        slack = np.where(row, self.slack[0], SINGLE(0.0)) + held * self.slack[1]
        held_up = held * up
        outward, inward = (across - held_up).max(axis=0), (-across - held_up).max(axis=0)
        sense = np.where(row, np.where(outward >= inward, SINGLE(1.0), SINGLE(-1.0)), SINGLE(0.0))
        beyond = sense * across - held_up
        rises = beyond[1:] > beyond[:-1]
        turns = rises[:-1] & ~rises[1:]
        steep = _STEEP * slack
        begins = np.where(beyond[1] - beyond[0] > steep, -np.inf, beyond[0])
        ends = np.where(beyond[-1] - beyond[-2] < -steep, -np.inf, beyond[-1])
        inside, x, bend = _crest(beyond, turns)
        best = np.maximum(np.maximum(begins, ends), inside)
        near = best - 2.0 * slack
        plain = ((begins >= near).astype(np.int8) + (ends >= near) + (inside >= near) == 1) & (turns.sum(axis=0) <= 1)
        plain &= (row == 0) | (np.minimum(outward, inward) + slack <= 0.0)
        x = np.nan_to_num(np.where(begins == best, 0.0, np.where(ends == best, 1.0, x)))  # NaN: the slope vanished with its rate
        bend /= np.where(row, _polynomial(_mixed(_to_powers().T, up.astype(float)), x), 1.0)
        return Crests(plain, x, bend)


def _crest(coefficients: Array, turns: Array) -> tuple[Array, Array, Array]:
    """Height, place and second derivative of the crest of polynomials whose coefficients fall after having risen once; minus infinity
    where they do not."""
    shape = turns.shape[1:]
    height, place, bend = np.full(shape, -np.inf), np.zeros(shape), np.zeros(shape)
    (lane,) = np.nonzero(turns.any(axis=0))
    own, first, some = coefficients.take(lane, axis=1), turns.take(lane, axis=1).argmax(axis=0), np.arange(lane.size)
    before, middle, after = (own[first + i, some] for i in range(3))
    x = (first + (middle - before) / (2.0 * middle - before - after)) / (_DEGREE - 1.0)
    terms = _mixed(_to_powers().T, own.astype(float))
    n = np.arange(1.0, _DEGREE + 1.0)[:, None]
    slope = n * terms[1:]
    rate = n[:-1] * slope[1:]
    for _ in range(_STEPS):
        x = np.clip(x - _polynomial(slope, x) / _polynomial(rate, x), 0.0, 1.0)
    height[lane], place[lane], bend[lane] = _polynomial(terms, x), x, _polynomial(rate, x)
    return height, place, bend


def _polynomial(terms: Array, x: Array) -> Array:
    """Of terms, (terms, lanes), at x."""
    total = terms[-1]
    for term in terms[-2::-1]:
        total = total * x + term
    return np.asarray(total)


def hull_of(turn: Turn, kappa: Array | float, tolerance: float) -> tuple[Array, Array]:
    """Forces and slack (`Hull`) of whole steps of series on edges of this kappa."""
    rows = min(len(turn.push), _ROWS)
    interpolants, left = _matrices(rows)
    unit = turn.unit
    x = powers((turn.longest / unit).astype(SINGLE), rows)
    x *= (1.0 / (unit * unit)).astype(SINGLE)
    terms = turn.turn[2 : rows + 2].astype(SINGLE)
    terms *= _twice(rows)[:, None, None] * np.asarray(kappa, dtype=SINGLE)
    terms[:, 0] -= turn.push[:rows].astype(SINGLE)
    if turn.weight is not None:
        terms[:, 1] += turn.weight[:rows].astype(SINGLE)
    terms *= x[:, None]
    forces = _mixed(interpolants, terms)
    if turn.weight is None:
        forces[:, 1] += 1.0
    np.abs(terms, out=terms)
    slack = _mixed(left, terms)[0]
    slack += _TAIL * terms[-4:].max(axis=0)
    slack += SINGLE(_CARRIED * tolerance + _ROUNDING)
    return forces, slack


def hulls_of(shown: Sequence[tuple[Array, Array]], share: Array) -> Hull:
    """Of steps that end at some part of their series, from what `hull_of` shows of these, block by block."""
    found = Hull(*(np.empty((*shape, 2, share.size), dtype=SINGLE) for shape in ((_DEGREE + 1,), (), (), ())))
    values, end = _values().astype(SINGLE), 0
    for forces, slack in shown:
        part = slice(end, end := end + slack.shape[1])
        (short,) = (share[part] < 1.0).nonzero()
        forces[:, :, short] = _begin(forces.take(short, axis=2), share[part][short].astype(SINGLE))
        found.forces[:, :, part], found.slack[:, part] = forces, slack
        found.possible[:, part] = _largest(forces, slack)
        found.reached[:, part] = _largest(_mixed(values, forces), -slack)
    return found


def _begin(coefficients: Array, share: Array) -> Array:
    """Those of polynomials over that share of their steps (de Casteljau)."""
    row, found = coefficients, [coefficients[0]]
    while len(row) > 1:
        row = row[:-1] + share * (row[1:] - row[:-1])
        found.append(row[0])
    return np.array(found)


def _largest(forces: Array, by: Array) -> Array:
    """The largest -Fz and |Fx|/Fz of (values, 2, steps) whose Fx is larger, and whose Fz smaller, by (2, steps)."""
    up = forces[:, 1] - by[1]
    least = up.min(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = ((np.abs(forces[:, 0]) + by[0]) / up).max(axis=0)
    ratio[least <= 0.0] = np.inf
    return np.array([-least, ratio])


def _mixed(matrix: Array, rows: Array) -> Array:
    """The matrix times rows, (rows, 2, steps); of two columns at least, since NumPy sums a single one in another order."""
    columns = rows.reshape(len(rows), -1)
    if columns.shape[1] == 1:
        columns = np.repeat(columns, 2, axis=1)
    return np.einsum("dn,nl->dl", matrix, columns)[:, : rows[0].size].reshape(len(matrix), *rows.shape[1:])


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
    """Of x^n, n below `rows`: the Bernstein coefficients of the interpolants, (degree + 1, rows), and what these leave out,
    (1, rows)."""
    x, n = _nodes(), np.arange(float(rows))
    sums = np.zeros(rows)  # of x^m over the nodes and 1, m = 0, 1 ...
    sums[0] = 1.0
    for node in (*x, 1.0):
        for m in range(1, rows):
            sums[m] += node * sums[m - 1]
    left = np.zeros(rows)
    left[_DEGREE + 1 :] = 0.25**_DEGREE * sums[: max(0, rows - _DEGREE - 1)]
    return np.linalg.solve(_values(), x[:, None] ** n).astype(SINGLE), (left + _ROUNDING).astype(SINGLE)[None]


@lru_cache(maxsize=64)
def _twice(rows: int) -> Array:
    """(n + 1)(n + 2), n below `rows`."""
    n = np.arange(rows)
    return ((n + 1) * (n + 2)).astype(SINGLE)
