"""Turning points of a power series, isolated by proof: the signs of its Bernstein coefficients on the step.

A polynomial has in (0, 1) as many roots as its Bernstein coefficients there change sign, or fewer by an even number: none where they do
not, one where they do once; a stretch with more changes is halved. Nothing is asked of the drive, so this holds under a weight that varies.
Most steps need none of it: their y' is too near the straight line between its ends for a root, or their y'' for a second one (`Sense`).
"""

from __future__ import annotations

from functools import lru_cache
from math import comb
from typing import NamedTuple

import numpy as np

from ...motions.blocks import blocks
from ..equations.equation import Flow, Point
from ..equations.taylor import CACHED, TaylorSeries, powers

Array = np.ndarray

_HALVINGS = 40  # two turns closer than 1e-12 of a step are none: the height between them is the same to every digit


class Sense(NamedTuple):
    """Of each step whether y' is proved to have no zero, and whether y' is proved to be monotone."""

    kept: Array
    monotone: Array


def sense(arc: Flow, h: Array, end: Point, bent: Array) -> Sense:
    """What follows for steps of h from both their ends and how far they are bent in between (`TaylorSeries.bent`)."""
    speed, rate = (np.array([at_start * part, at_end * part]) for at_start, at_end, part in ((arc.v, end.v, h), (arc.b, end.b, h * h)))
    return Sense(*((x.min(axis=0) > most) | (x.max(axis=0) < -most) for x, most in zip((speed, rate), bent, strict=True)))


def falls_through_zero(arc: Flow, reach: Array, lanes: Array, once: Array) -> tuple[Array, Array, Array]:
    """Where y' falls through zero on (0, reach): (lane, low, high) of every such turn, one in each bracket [tau]; of the lanes `once` it is
    known to do so once."""
    if not isinstance(arc, TaylorSeries):
        raise TypeError("turns of a series only")
    found: list[tuple[Array, Array, Array]] = [(once, np.zeros(once.size), np.ones(once.size))]
    parts = [_speed(arc.take(lanes[part]), reach[lanes[part]]) for part in blocks(lanes.size, CACHED)]
    speed = np.concatenate([np.zeros((len(arc.terms) - 1, 0)), *parts], axis=1)
    own = lanes
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
    return which, low * reach[which], high * reach[which]


def _speed(arc: TaylorSeries, span: Array) -> Array:
    """span y' in powers of time over it, (terms, lanes)."""
    terms = powers(span / arc.unit, len(arc.terms))
    terms *= arc.terms
    terms *= np.arange(float(len(terms)))[:, None]
    return np.asarray(terms[1:])


@lru_cache(maxsize=64)
def _from_powers(count: int) -> Array:
    """(count, count): Bernstein coefficients on [0, 1] of the powers."""
    return np.array([[comb(i, n) / comb(count - 1, n) for n in range(count)] for i in range(count)])


def _bernstein(terms: Array) -> Array:
    """Bernstein coefficients on [0, 1] of polynomials, (terms, lanes), each summed in the same order whatever its neighbours."""
    if terms.shape[1] == 1:  # NumPy sums a single lane in another order
        return _bernstein(np.repeat(terms, 2, axis=1))[:, :1]
    parts = [np.einsum("in,nl->il", _from_powers(len(terms)), terms[:, block]) for block in blocks(terms.shape[1], CACHED)]
    return np.concatenate([terms[:, :0], *parts], axis=1)


def _halves(bernstein: Array) -> tuple[Array, Array]:
    """The coefficients on either half (de Casteljau)."""
    left, right, row = np.empty_like(bernstein), np.empty_like(bernstein), bernstein
    for i in range(len(bernstein)):
        left[i], right[-1 - i] = row[0], row[-1]
        row = 0.5 * (row[:-1] + row[1:])
    return left, right
