"""Segments of many sinusoids as Taylor polynomials: one polynomial is faster than a sine and a cosine for each sinusoid.

A segment is cut into equal patches. On a patch of half width d the remainder is at most sum_j |C_j| (w_j d)^(n+1)/(n+1)!, which is
below rounding.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .motion import Near

Array = np.ndarray

DEGREE = 17
_REMAINDER = 1e-17  # of a polynomial, over the largest |s|
_MOST_PATCHES = 50_000  # above it there is no table


@dataclass(frozen=True)
class Table:
    """The polynomials of K segments with P patches. first, last: first and last patch of a segment, (K,); half: half width of its patches
    [rad], (K,); terms: coefficients of the powers of (u - centre)/half, (DEGREE + 1, P)."""

    first: Array
    last: Array
    half: Array
    terms: Array

    def near(self, k: Array, u: Array) -> Near:
        """Return s - s_start and its derivatives at phase u [rad] from the start of segment k."""
        half = self.half[k]
        x = 0.5 * u / half
        patch = x.astype(np.int64)
        np.minimum(patch, self.last[k] - self.first[k], out=patch)
        x -= patch  # then from -1 to 1
        x += x
        x -= 1.0
        patch += self.first[k]
        rows = self.terms.take(patch, axis=1)
        value, rate, bend = rows[-1].copy(), np.zeros(x.shape), np.zeros(x.shape)
        for row in rows[-2::-1]:  # Horner's rule for the value and both derivatives
            bend *= x
            bend += rate
            rate *= x
            rate += value
            value *= x
            value += row
        rate /= half
        bend *= 2.0
        bend /= half
        bend /= half
        return Near(value, rate, bend)


def table_of(segments: Any) -> Table | None:
    """Return the table of `Segments`; None if the table would be too large."""
    size, w = np.hypot(segments.sin, segments.cos), segments.frequency  # (harmonics, K)
    peak = max(segments.later_max[0], -segments.later_min[0])
    counts, over = np.ones(segments.length.size, dtype=np.int64), float(np.prod(np.arange(2.0, DEGREE + 2.0)))
    for _ in range(64):
        half = 0.5 * segments.length / counts
        wide = (size * (w * half) ** (DEGREE + 1)).sum(axis=0) > _REMAINDER * peak * over
        if not wide.any():
            break
        counts[wide] = counts[wide] * 5 // 4 + 1
        if counts.sum() > _MOST_PATCHES:
            return None
    half = 0.5 * segments.length / counts
    k = np.repeat(np.arange(segments.length.size), counts)
    last = np.cumsum(counts) - 1
    first = last - counts + 1
    centre = (2.0 * (np.arange(k.size) - first[k]) + 1.0) * half[k]
    terms = np.zeros((DEGREE + 1, k.size))
    for s, c, f in zip(segments.sin[:, k], segments.cos[:, k], segments.frequency[:, k], strict=True):
        sin, cos = np.sin(f * centre), np.cos(f * centre)
        now, grows = s * cos + c * sin, c * cos - s * sin
        factor = np.ones(k.size)
        for n in range(DEGREE + 1):
            terms[n] += factor * (now - s if n == 0 else (now, grows, -now, -grows)[n % 4])
            factor *= f * half[k] / (n + 1)
    terms[0] += segments.slope[k] * centre
    terms[1] += segments.slope[k] * half[k]
    return Table(first, last, half, terms)
