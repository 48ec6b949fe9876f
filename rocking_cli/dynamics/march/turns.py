"""Turning points of a power series, isolated by proof: the signs of its Bernstein coefficients on the step.

A polynomial has in (0, 1) as many roots as its Bernstein coefficients there change sign, or fewer by an even number: none where they do
not, one where they do once; a stretch with more changes is halved. Nothing is asked of the drive, so this holds under a weight that varies.
Most steps need none of it: where what bends y' away from a straight line is too small for a root (`keeps_sense`), or for a second one.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb

import numpy as np

from ..drive import summed
from ..equations.equation import Flow
from ..equations.taylor import TaylorSeries, blocks, powers

Array = np.ndarray

_HALVINGS = 40  # two turns closer than 1e-12 of a step are none: the height between them is the same to every digit


def falls_through_zero(arc: Flow, reach: Array, lanes: Array) -> tuple[Array, Array, Array]:
    """Where y' falls through zero on (0, reach) of these lanes: (lane, low, high) of every such turn, one in each bracket [tau]."""
    if not isinstance(arc, TaylorSeries):
        raise TypeError("turns of a series only")
    none = np.zeros(0)
    if not lanes.size:
        return lanes, none, none
    span = reach[lanes]
    parts = [_plain(arc.take(lanes[part]), span[part], part.start) for part in blocks(lanes.size)]
    fall, own = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
    found: list[tuple[Array, Array, Array]] = [(fall, np.zeros(fall.size), np.ones(fall.size))]
    speed = np.concatenate([part[2] for part in parts], axis=1)
    bernstein = _bernstein(speed)
    low, high = np.zeros(own.size), np.ones(own.size)
    for _ in range(_HALVINGS):
        falls = (bernstein[:-1] > 0.0) & (bernstein[1:] <= 0.0)
        rises = (bernstein[:-1] <= 0.0) & (bernstein[1:] > 0.0)
        changes = falls.sum(axis=0) + rises.sum(axis=0)
        one = np.flatnonzero((changes == 1) & falls.any(axis=0))
        found.append((own[one], low[one], high[one]))
        more = np.flatnonzero(changes > 1)
        if not more.size:
            break
        middle = 0.5 * (low[more] + high[more])
        left, right = _halves(bernstein[:, more])
        bernstein = np.concatenate([left, right], axis=1)
        own = np.concatenate([own[more], own[more]])
        low, high = np.concatenate([low[more], middle]), np.concatenate([middle, high[more]])
    which, low, high = (np.concatenate(parts) for parts in zip(*found, strict=True))
    order = np.lexsort((low, which))
    which, low, high = which[order], low[order], high[order]
    return lanes[which], low * span[which], high * span[which]


def keeps_sense(arc: Flow, h: Array, bent: Array) -> Array:
    """Whether y' is proved to have no zero on [0, h], where it is bent so much (`TaylorSeries.bent`)."""
    begin = arc.v * h
    end = begin + arc.b * h * h
    return np.asarray((np.minimum(begin, end) > bent) | (np.maximum(begin, end) < -bent))


def _plain(arc: TaylorSeries, span: Array, first: int) -> tuple[Array, Array, Array]:
    """Of these lanes, counted from `first`: in which y' falls through zero once; in which that is open, and their y' `span` in powers of
    time over it, (terms, lanes)."""
    n = np.arange(float(len(arc.terms)))[:, None]
    speed = arc.terms * n
    speed *= powers(span / arc.unit, len(arc.terms))
    speed = speed[1:]  # v h
    bent = np.abs(speed[2:])
    bent *= n[2:-1]
    once = np.abs(speed[1]) > summed(bent)  # y' is monotone
    (fall,) = (once & (speed[0] > 0.0) & (summed(speed) <= 0.0)).nonzero()
    (own,) = (~once).nonzero()
    return fall + first, own + first, speed[:, own]


@lru_cache(maxsize=64)
def _from_powers(count: int) -> Array:
    """(count, count): Bernstein coefficients on [0, 1] of the powers."""
    return np.array([[comb(i, n) / comb(count - 1, n) for n in range(count)] for i in range(count)])


def _bernstein(terms: Array) -> Array:
    """Bernstein coefficients on [0, 1] of polynomials, (terms, lanes), each summed in the same order whatever its neighbours."""
    if terms.shape[1] == 1:  # NumPy sums a single lane in another order
        return _bernstein(np.repeat(terms, 2, axis=1))[:, :1]
    parts = [np.einsum("in,nl->il", _from_powers(len(terms)), terms[:, block]) for block in blocks(terms.shape[1])]
    return np.concatenate([terms[:, :0], *parts], axis=1)


def _halves(bernstein: Array) -> tuple[Array, Array]:
    """The coefficients on either half (de Casteljau)."""
    left, right, row = np.empty_like(bernstein), np.empty_like(bernstein), bernstein
    for i in range(len(bernstein)):
        left[i], right[-1 - i] = row[0], row[-1]
        row = 0.5 * (row[:-1] + row[1:])
    return left, right
