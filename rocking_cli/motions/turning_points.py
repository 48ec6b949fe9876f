"""Extremes of a sum of sinusoids and a ramp. The method proves that it misses none, however close two extremes are.

An interval of half width d about m is tested with the Taylor series of r = ds/dphase, T_n = r^(n)(m) d^n/n!. Its remainder follows
from the bound sum_j |C_j| w_j^(n+1) of the derivatives:

    free      |T_0| > sum_{n>=1} |T_n|               r has no root
    monotone  |T_1| > sum_{n>=2} n |T_n|             r has one root or none; its signs at the ends decide
    flat      sum |T_n| below rounding               s is constant

An interval that passes no test is halved. Ends at which r is zero within rounding decide nothing: two extremes about 1e-7 apart, or an
inflection with a level tangent, are no extremes, and s is monotone there in double precision.
"""

import math

import numpy as np

from .motion import Piece

Array = np.ndarray

_TERMS = 12  # of the Taylor series
_CELLS = 4  # first intervals for each period of the fastest sinusoid
_HALVINGS = 64


def isolated_extremes(piece: Piece) -> Array:
    """Phases [rad], in order, at which the acceleration s has extremes within the piece; the piece must have sinusoids."""
    fastest = max(h.frequency for h in piece.harmonics)
    edges = np.linspace(piece.start, piece.stop, math.ceil((piece.stop - piece.start) * fastest / (2.0 * math.pi) * _CELLS) + 2)
    low, high = edges[:-1], edges[1:]
    ends = [edges]
    n = np.arange(float(_TERMS))[:, None]
    for _ in range(_HALVINGS):
        terms, rest, rounding = _series(piece, low, high)
        size = np.abs(terms)
        free = size[0] > size[1:].sum(axis=0) + rest + rounding[0]
        monotone = size[1] > (n * size)[2:].sum(axis=0) + _TERMS * rest + rounding[1]
        flat = size.sum(axis=0) + rest <= 4.0 * rounding[0]
        open_ = ~(free | monotone | flat)
        if not open_.any():
            break
        middle = 0.5 * (low[open_] + high[open_])
        ends.append(middle)
        low, high = np.concatenate([low[open_], middle]), np.concatenate([middle, high[open_]])
    at = np.unique(np.concatenate(ends))
    terms, _, rounding = _series(piece, at, at)
    at, rises = (x[np.abs(terms[0]) > rounding[0]] for x in (at, terms[0] > 0.0))
    change = np.flatnonzero(rises[1:] != rises[:-1])
    return _bisected(piece, at[change], at[change + 1])


def _series(piece: Piece, low: Array, high: Array) -> tuple[Array, Array, Array]:
    """T_n (terms, intervals); bound of the remainder (intervals); bound of rounding in r and r' d (2, intervals)."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    terms, rest, rounding = np.zeros((_TERMS, middle.size)), np.zeros(middle.size), np.zeros((2, middle.size))
    terms[0] = piece.slope
    for h in piece.harmonics:
        argument, x = h.frequency * middle + h.phase, h.frequency * half
        cos, sin = np.cos(argument), np.sin(argument)
        size = np.full(middle.size, h.amplitude * h.frequency)
        error = 4.0 * np.finfo(float).eps * np.abs(size) * (1.0 + np.abs(argument))
        for n in range(_TERMS):
            terms[n] += size * (cos, -sin, -cos, sin)[n % 4]
            size = size * x / (n + 1)
        rest += np.abs(size)
        rounding += error * x ** np.arange(2.0)[:, None]
    rounding[0] += 4.0 * np.finfo(float).eps * abs(piece.slope)
    return terms, rest, rounding


def _bisected(piece: Piece, low: Array, high: Array) -> Array:
    """Phases [rad] where ds/dphase changes its sign between two ends, to the last bit; without a change one of the ends."""
    amplitude, w, f = np.array([(h.amplitude, h.frequency, h.phase) for h in piece.harmonics]).T[:, :, None]

    def rises(phase: Array) -> Array:
        return np.asarray((amplitude * w * np.cos(w * phase + f)).sum(axis=0) + piece.slope >= 0.0)

    sign = rises(low)
    for _ in range(_HALVINGS if low.size else 0):
        middle = 0.5 * (low + high)
        before = rises(middle) == sign
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return high
