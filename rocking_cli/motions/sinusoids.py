"""Sums of sinusoids and a ramp: their extremes, and Taylor polynomials, which are
faster than a sine and a cosine for each sinusoid.

The search misses no extreme, however close two are. An interval of half width d about m
is tested with the Taylor series of r = ds/dphase, T_n = r^(n)(m) d^n/n!, whose
remainder follows from |r^(n)| <= sum_j |C_j| w_j^(n+1), and is halved if it passes no
test:

    free      |T_0| > sum_{n>=1} |T_n|               r has no root
    monotone  |T_1| > sum_{n>=2} n |T_n|             r has one root or none; its signs
                                                     at the ends decide
    flat      sum |T_n| below rounding               s is constant

Ends at which r is zero within rounding decide nothing: an inflection, or two extremes
about 1e-7 apart, between which s is constant in double precision. On a patch of half
width d the remainder of a polynomial, sum_j |C_j| (w_j d)^(n+1)/(n+1)!, is below
rounding.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array

_TERMS = 12  # of the Taylor series
_CELLS = 4  # first intervals for each period of the fastest sinusoid
_HALVINGS = 64
DEGREE = 17
_MOST_PATCHES = 50_000  # above it there is no table


def isolated_extremes(start: float, stop: float, slope: float, waves: Array) -> Array:
    """Return the phases [rad] of the extremes of s; slope: of the ramp [1/rad]; waves:
    amplitude, frequency, phase [rad], (sinusoids, 3).
    """
    periods = (stop - start) * waves[:, 1].max() / (2.0 * math.pi)
    edges = np.linspace(start, stop, math.ceil(periods * _CELLS) + 2)
    low, high = edges[:-1], edges[1:]
    ends = [edges]
    for _ in range(_HALVINGS):
        open_ = _undecided(*_series(slope, waves, low, high))
        if not open_.any():
            break
        middle = 0.5 * (low[open_] + high[open_])
        ends.append(middle)
        low = np.concatenate([low[open_], middle])
        high = np.concatenate([middle, high[open_]])

    # The signs of r at all ends, except where r is zero within rounding.
    at = np.unique(np.concatenate(ends))
    terms, _, rounding = _series(slope, waves, at, at)
    at, rises = (x[np.abs(terms[0]) > rounding[0]] for x in (at, terms[0] > 0.0))
    change = np.flatnonzero(rises[1:] != rises[:-1])
    return _bisected(slope, waves, at[change], at[change + 1])


def _undecided(terms: Array, rest: Array, rounding: Array) -> Array:
    """True for intervals that pass none of the tests free, monotone and flat."""
    n = np.arange(float(_TERMS))[:, None]
    size = np.abs(terms)
    free = size[0] > size[1:].sum(axis=0) + rest + rounding[0]
    monotone = size[1] > (n * size)[2:].sum(axis=0) + _TERMS * rest + rounding[1]
    flat = size.sum(axis=0) + rest <= 4.0 * rounding[0]
    return np.asarray(~(free | monotone | flat))


def _series(
    slope: float, waves: Array, low: Array, high: Array
) -> tuple[Array, Array, Array]:
    """T_n (terms, intervals); bound of the remainder (intervals); bound of rounding in
    r and r' d (2, intervals).
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    terms = np.zeros((_TERMS, middle.size))
    rest = np.zeros(middle.size)
    rounding = np.zeros((2, middle.size))
    terms[0] = slope
    for amplitude, w, f in waves:
        argument, x = w * middle + f, w * half
        cos, sin = np.cos(argument), np.sin(argument)
        size = np.full(middle.size, amplitude * w)
        error = 4.0 * np.finfo(float).eps * np.abs(size) * (1.0 + np.abs(argument))
        for n in range(_TERMS):
            terms[n] += size * (cos, -sin, -cos, sin)[n % 4]
            size = size * x / (n + 1)
        rest += np.abs(size)
        rounding += error * x ** np.arange(2.0)[:, None]
    rounding[0] += 4.0 * np.finfo(float).eps * abs(slope)
    return terms, rest, rounding


def _bisected(slope: float, waves: Array, low: Array, high: Array) -> Array:
    """Phases [rad] where ds/dphase changes its sign between two ends, to
    the last bit.
    """
    amplitude, w, f = waves.T[:, :, None]

    def rises(phase: Array) -> Array:
        return np.asarray(
            (amplitude * w * np.cos(w * phase + f)).sum(axis=0) + slope >= 0.0
        )

    sign = rises(low)
    for _ in range(_HALVINGS if low.size else 0):
        middle = 0.5 * (low + high)
        before = rises(middle) == sign
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return high


@dataclass(frozen=True)
class PolynomialTable:
    """The polynomials of K segments in P patches."""

    first: Array  # index of the first patch of each segment, (K,)
    last: Array  # index of the last patch of each segment, (K,)
    half: Array  # half width of the patches of each segment [rad], (K,)
    terms: Array  # coefficients of the powers of (u - centre)/half, (DEGREE + 1, P)

    def change_at(self, k: Array, u: Array) -> tuple[Array, Array, Array]:
        """Return s - s_start and its derivatives at phase u [rad] from the start of
        segment k.
        """
        half = self.half[k]
        x = 0.5 * u / half
        patch = x.astype(np.int64)
        np.minimum(patch, self.last[k] - self.first[k], out=patch)
        x -= patch  # then from -1 to 1
        x += x
        x -= 1.0
        patch += self.first[k]
        rows = self.terms.take(patch, axis=1)
        value = rows[-1].copy()
        rate = np.zeros(x.shape)
        second_derivative = np.zeros(x.shape)
        for row in rows[-2::-1]:  # Horner's rule for the value and both derivatives
            second_derivative *= x
            second_derivative += rate
            rate *= x
            rate += value
            value *= x
            value += row
        rate /= half
        second_derivative *= 2.0
        second_derivative /= half
        second_derivative /= half
        return value, rate, second_derivative


def table_of(segments: Any) -> PolynomialTable | None:
    """Return the table of `Segments`; None if the table would be too large."""
    # Ground that stays at rest has polynomials of zeros.
    length = np.where(np.isinf(segments.length), 1.0, segments.length)
    counts = _patches(segments, length)
    if counts is None:
        return None
    half = 0.5 * length / counts
    k = np.repeat(np.arange(length.size), counts)
    last = np.cumsum(counts) - 1
    first = last - counts + 1
    centre = (2.0 * (np.arange(k.size) - first[k]) + 1.0) * half[k]

    terms = np.zeros((DEGREE + 1, k.size))
    for s, c, f in zip(
        segments.sin[:, k], segments.cos[:, k], segments.frequency[:, k], strict=True
    ):
        sin, cos = np.sin(f * centre), np.cos(f * centre)
        now, grows = s * cos + c * sin, c * cos - s * sin
        factor = np.ones(k.size)
        for n in range(DEGREE + 1):
            derivative = now - s if n == 0 else (now, grows, -now, -grows)[n % 4]
            terms[n] += factor * derivative
            factor *= f * half[k] / (n + 1)
    terms[0] += segments.slope[k] * centre
    terms[1] += segments.slope[k] * half[k]
    return PolynomialTable(first, last, half, terms)


def _patches(segments: Any, length: Array) -> Array | None:
    """The number of patches of each segment with which the remainders are below
    rounding, (K,); None if they are too many.
    """
    size = np.hypot(segments.sin, segments.cos)
    largest = max(segments.later_max[0], -segments.later_min[0])
    factorial = float(np.prod(np.arange(2.0, DEGREE + 2.0)))
    counts = np.ones(length.size, dtype=np.int64)
    for _ in range(64):
        half = 0.5 * length / counts
        remainder = (size * (segments.frequency * half) ** (DEGREE + 1)).sum(axis=0)
        wide = remainder > 1e-17 * largest * factorial
        if not wide.any():
            break
        counts[wide] = counts[wide] * 5 // 4 + 1
        if counts.sum() > _MOST_PATCHES:
            return None
    return counts
