"""Extremes of a sum of sinusoids and a ramp. The method proves that it misses none, however close two extremes are.

An interval of half width d about m is tested with the Taylor series of r = ds/dphase, T_n = r^(n)(m) d^n/n!. Its remainder follows
from the bound sum_j |C_j| w_j^(n+1) of the derivatives:

    free      |T_0| > sum_{n>=1} |T_n|               r has no root
    monotone  |T_1| > sum_{n>=2} n |T_n|             r has one root or none; its signs at the ends decide
    curved    2 |T_2| > sum_{n>=3} n (n-1) |T_n|     r has one turning point, whose sign decides between two roots, one and none
    flat      sum |T_n| below rounding               s is constant

An interval that passes no test is halved. A turning point of r that is zero within rounding (an inflection with a level tangent, or
two extremes about 1e-7 apart) is no extreme: s is monotone there in double precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from .piece import Piece

Array = np.ndarray

_TERMS = 12  # of the Taylor series
_CELLS = 4  # first intervals for each period of the fastest sinusoid
_HALVINGS = 64


def extremes(piece: Piece) -> list[float]:
    """Phases [rad] strictly inside the piece where s has an extreme, in order."""
    if not piece.harmonics:
        return []
    if len(piece.harmonics) == 1 and piece.slope == 0.0:
        h = piece.harmonics[0]
        first = np.ceil((h.frequency * piece.start + h.phase) / np.pi - 0.5)
        last = np.floor((h.frequency * piece.stop + h.phase) / np.pi - 0.5)
        found = (((np.arange(first, last + 1) + 0.5) * np.pi - h.phase) / h.frequency).tolist()
    else:
        found = isolated_extremes(piece).tolist()
    margin = 1e-12 * (piece.stop - piece.start)
    return [float(x) for x in found if piece.start + margin < x < piece.stop - margin]


def isolated_extremes(piece: Piece) -> Array:
    """Phases [rad] of the extremes of s within the piece, in order; the piece must have sinusoids."""
    fastest = max(h.frequency for h in piece.harmonics)
    edges = np.linspace(piece.start, piece.stop, math.ceil((piece.stop - piece.start) * fastest / (2.0 * math.pi) * _CELLS) + 2)
    low, high = edges[:-1], edges[1:]
    ends: list[tuple[Array, Array]] = []
    n = np.arange(float(_TERMS))[:, None]
    for _ in range(_HALVINGS):
        terms, rest, rounding = _series(piece, low, high)
        size = np.abs(terms)
        free = size[0] > size[1:].sum(axis=0) + rest + rounding[0]
        monotone = size[1] > (n * size)[2:].sum(axis=0) + _TERMS * rest + rounding[1]
        curved = 2.0 * size[2] > (n * (n - 1.0) * size)[3:].sum(axis=0) + _TERMS * (_TERMS - 1) * rest + rounding[2]
        flat = size.sum(axis=0) + rest <= 4.0 * rounding[0]
        single = (monotone | flat) & ~free
        turning = curved & ~(free | single)
        ends += [(low[single], high[single]), *_about_turns(piece, low[turning], high[turning], rounding[0, turning])]
        open_ = ~(free | single | curved)
        if not open_.any():
            break
        middle = 0.5 * (low[open_] + high[open_])
        low, high = np.concatenate([low[open_], middle]), np.concatenate([middle, high[open_]])
    before, after = (np.concatenate(x) for x in zip(*ends, strict=True))
    change = (_rate(piece, before) >= 0.0) != (_rate(piece, after) >= 0.0)  # zero counts as positive in both neighbours
    return np.unique(_bisected(partial(_rate, piece), before[change], after[change]))


def _series(piece: Piece, low: Array, high: Array) -> tuple[Array, Array, Array]:
    """T_n (terms, intervals); bound of the remainder (intervals); bound of rounding in r, r' d and r'' d^2 (3, intervals)."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    terms, rest, rounding = np.zeros((_TERMS, middle.size)), np.zeros(middle.size), np.zeros((3, middle.size))
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
        rounding += error * x ** np.arange(3.0)[:, None]
    rounding[0] += 4.0 * np.finfo(float).eps * abs(piece.slope)
    return terms, rest, rounding


def _about_turns(piece: Piece, low: Array, high: Array, rounding: Array) -> list[tuple[Array, Array]]:
    """The parts before and after the turning point of r in each interval, if r changes its sign in the interval."""
    if not low.size:
        return []
    turn = _bisected(partial(_rate, piece, order=1), low, high)
    deep = (np.abs(_rate(piece, turn)) > rounding) | ((_rate(piece, low) >= 0.0) != (_rate(piece, high) >= 0.0))
    return [(low[deep], turn[deep]), (turn[deep], high[deep])]


def _rate(piece: Piece, phase: Array, order: int = 0) -> Array:
    """ds/dphase (order 0) or its derivative (order 1) at phases [rad], one-dimensional."""
    amplitude, w, f = np.array([(h.amplitude, h.frequency, h.phase) for h in piece.harmonics]).T[:, :, None]
    argument = w * phase + f
    total = (amplitude * w * np.cos(argument) if order == 0 else -amplitude * w * w * np.sin(argument)).sum(axis=0)
    return total + piece.slope if order == 0 else np.asarray(total)


def _bisected(function: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Points where a function changes its sign between two ends, to the last bit; without a change one of the ends."""
    sign = function(low) >= 0.0
    for _ in range(_HALVINGS if low.size else 0):
        middle = 0.5 * (low + high)
        before = (function(middle) >= 0.0) == sign
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return high
