"""Segments of many sinusoids as Taylor polynomials: one polynomial is faster than a sine and a cosine for each sinusoid.

A segment is cut into equal patches. On a patch of half width d the remainder is at most sum_j |C_j| (w_j d)^(n+1)/(n+1)!, which is
below rounding. A second table holds the inverse, the phase at which s has a value. Its argument t is the square root of the share
of the segment's rise, counted from the nearer end: near an extreme the share grows with the square of the phase, so the phase is a
smooth function of t there too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .piece import Near

Array = np.ndarray

DEGREE = 17
_REMAINDER = 1e-17  # of a polynomial, over the largest |s|
_MOST_PATCHES = 50_000  # above it there is no table
_NODES = 64  # of the inverse, from each end of a segment to half of its rise
_STEPS, _SHORT = 50, 1e-9  # Halley's method stops after so many steps, or after a step below this part of the segment


@dataclass(frozen=True)
class Table:
    """The polynomials of K segments with P patches.

    first, last: first and last patch of a segment, (K,); half: half width of its patches [rad], (K,); terms: coefficients of the
    powers of (u - centre)/half, (DEGREE + 1, P); phases: the inverse from the start and from the end [rad], (K, 2, _NODES + 2).
    """

    first: Array
    last: Array
    half: Array
    terms: Array
    phases: Array

    def near(self, k: Array, u: Array) -> Near:
        """s - s_start and its derivatives at phase u [rad] from the start of segment k."""
        rows, x, half = self._patch(k, u)
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

    def change(self, k: Array, u: Array) -> Array:
        """s - s_start alone, equal to `near(k, u).change` to the last bit."""
        rows, x, _ = self._patch(k, u)
        value: Array = rows[-1].copy()
        for row in rows[-2::-1]:
            value *= x
            value += row
        return value

    def _patch(self, k: Array, u: Array) -> tuple[Array, Array, Array]:
        """(terms, place from -1 to 1, half width [rad]) of the patches that hold these phases."""
        half = self.half[k]
        x = 0.5 * u / half
        patch = x.astype(np.int64)
        np.minimum(patch, self.last[k] - self.first[k], out=patch)
        x -= patch
        x += x
        x -= 1.0
        patch += self.first[k]
        return self.terms.take(patch, axis=1), x, half

    def phase(self, k: Array, share: Array) -> Array:
        """The phase [rad] in segment k at which s has gone this share (0 to 1) of its rise, to about 1e-3."""
        late = share > 0.5
        place = np.sqrt(np.where(late, 1.0 - share, share))
        place *= _NODES / np.sqrt(0.5)
        node = place.astype(np.int64)
        place -= node
        at = (2 * k + late) * (_NODES + 2) + node
        low, high = self.phases.take(at), self.phases.take(at + 1)
        high -= low
        high *= place
        low += high
        return low


def table_of(segments: Any) -> Table | None:
    """The table of `Segments`; None if it is too large."""
    counts = _patches_of(segments)
    if counts is None:
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
    table = Table(first, last, half, terms, np.zeros((segments.length.size, 2, _NODES + 2)))
    return Table(first, last, half, terms, _inverse(segments, table))


def _patches_of(segments: Any) -> Array | None:
    """The number of patches of each segment, (K,); None if there are too many."""
    size, w = np.hypot(segments.sin, segments.cos), segments.frequency  # (harmonics, K)
    peak = max(segments.later_max[0], -segments.later_min[0])
    counts = np.ones(segments.length.size, dtype=np.int64)
    over = float(np.prod(np.arange(2.0, DEGREE + 2.0)))
    for _ in range(64):
        half = 0.5 * segments.length / counts
        wide = (size * (w * half) ** (DEGREE + 1)).sum(axis=0) > _REMAINDER * peak * over
        if not wide.any():
            break
        counts[wide] = counts[wide] * 5 // 4 + 1
        if counts.sum() > _MOST_PATCHES:
            return None
    return counts


def _inverse(segments: Any, table: Table) -> Array:
    """Phases [rad] at the nodes by Halley's method inside brackets, (K, 2, _NODES + 2)."""
    t = np.sqrt(0.5) / _NODES * np.arange(_NODES + 2.0)
    at = 2.0 / np.pi * np.arcsin(t)  # between two extremes of one sinusoid
    at, share = (np.stack([x, 1.0 - x]) * np.ones((segments.length.size, 1, 1)) for x in (at, t * t))
    k = np.broadcast_to(np.arange(segments.length.size)[:, None, None], share.shape).ravel()
    length, rise = segments.length[k], segments.s_end[k] - segments.s_start[k]
    at, wanted, sense = at.ravel() * length, share.ravel() * np.abs(rise), np.sign(rise)
    low, high = np.where(share.ravel() == 1.0, length, 0.0), np.where(share.ravel() == 0.0, 0.0, length)  # the ends are known
    found, lanes = at.copy(), np.arange(k.size)
    for _ in range(_STEPS):
        near = table.near(k[lanes], at)
        gap = near.change * sense[lanes] - wanted[lanes]
        low, high = np.where(gap < 0.0, at, low), np.where(gap < 0.0, high, at)
        with np.errstate(all="ignore"):
            target = at - gap / (near.rate * sense[lanes] - 0.5 * gap * near.bend / near.rate)
        before, at = at, np.where((target >= low) & (target <= high), target, 0.5 * (low + high))
        found[lanes] = at
        (going,) = (np.abs(at - before) > _SHORT * length[lanes]).nonzero()
        if not going.size:
            break
        lanes, at, low, high = lanes[going], at[going], low[going], high[going]
    return found.reshape(share.shape)
