"""Segments of many sinusoids as Taylor polynomials, patch by patch: one short polynomial in place of a sine and a cosine a harmonic.

A segment is cut into equal patches, so short that what a polynomial leaves out is below rounding: its remainder is at most
sum_j |C_j| (w_j d)^(n+1)/(n+1)! on a patch of half width d. The inverse, the phase at which a monotone segment has a value, is
looked up: with t the root of the value's share of the segment's rise, counted from the nearer end, the phase is a smooth function of t
at an extremum (where the share grows as the square of the phase) as well as at an end that is none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from .segments import Segments

Array = np.ndarray

DEGREE = 17
_LEFT_OUT = 1e-17  # of a polynomial, over the peak of the motion
_MOST_PATCHES = 50_000  # beyond them the sinusoids are summed one by one
_NODES = 64  # of the inverse, from each end of a segment to the middle of its rise
_HALVINGS, _SHORT = 50, 1e-9  # at most, and a step of Halley's method, over the segment, that leaves nothing


class Near(NamedTuple):
    """s - s(segment start) and its first two derivatives by phase, (lanes,)."""

    change: Array
    rate: Array
    bend: Array


@dataclass(frozen=True)
class Table:
    """Of K segments and P patches. first: (K,) a segment's first patch; last: (K,) its last; half: (K,) half width of its patches
    [rad]; terms: (DEGREE + 1, P) of powers of (u - centre)/half; phases: (K, 2, _NODES + 2) the inverse, from the start and from the
    end."""

    first: Array
    last: Array
    half: Array
    terms: Array
    phases: Array

    def near(self, k: Array, u: Array) -> Near:
        """The drive about phase u of segment k."""
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
        """s - s(segment start) alone, to the same digits."""
        rows, x, _ = self._patch(k, u)
        value: Array = rows[-1].copy()
        for row in rows[-2::-1]:
            value *= x
            value += row
        return value

    def _patch(self, k: Array, u: Array) -> tuple[Array, Array, Array]:
        """The terms of the patches that hold these phases, the places in them from -1 to 1, and their half widths."""
        half = self.half[k]
        x = 0.5 * u / half
        patch = x.astype(np.int64)
        np.minimum(patch, self.last[k] - self.first[k], out=patch)
        x -= patch
        x += x
        x -= 1.0
        patch += self.first[k]
        return self.terms.take(patch, axis=1), x, half

    def join(self, other: Table) -> Table:
        """Of these segments and then others."""
        more = self.terms.shape[1]
        half, phases = np.concatenate([self.half, other.half]), np.concatenate([self.phases, other.phases])
        first, last = (np.concatenate([a, b + more]) for a, b in ((self.first, other.first), (self.last, other.last)))
        return Table(first, last, half, np.concatenate([self.terms, other.terms], axis=1), phases)

    def phase(self, k: Array, share: Array) -> Array:
        """About where the drive has gone this share, from 0 to 1, of segment k; to a part of 1e-3 or so."""
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


def table_of(segments: Segments) -> Table | None:
    """The table of a motion; None where one closed form does without it, or where it would be too large."""
    counts = patches_of(segments)
    if counts is None:
        return None
    half = 0.5 * segments.length / counts
    k = np.repeat(np.arange(len(segments)), counts)
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
    table = Table(first, last, half, terms, np.zeros((len(segments), 2, _NODES + 2)))
    return Table(first, last, half, terms, _inverse(segments, table))


def patches_of(segments: Segments) -> Array | None:
    """(K,) how many patches each segment is cut into; None where there is no table."""
    if segments.harmonics == 0 or (segments.harmonics == 1 and not segments.sloped):
        return None
    size, w = np.hypot(segments.sin, segments.cos), segments.frequency  # (harmonics, K)
    peak = max(segments.later_max[0], -segments.later_min[0])
    counts = np.ones(len(segments), dtype=np.int64)
    over = float(np.prod(np.arange(2.0, DEGREE + 2.0)))
    for _ in range(64):
        half = 0.5 * segments.length / counts
        wide = (size * (w * half) ** (DEGREE + 1)).sum(axis=0) > _LEFT_OUT * peak * over
        if not wide.any():
            break
        counts[wide] = counts[wide] * 5 // 4 + 1
        if counts.sum() > _MOST_PATCHES:
            return None
    return counts


def _inverse(segments: Segments, table: Table) -> Array:
    """(K, 2, _NODES + 2) phases at the nodes, by Halley's method inside brackets."""
    t = np.sqrt(0.5) / _NODES * np.arange(_NODES + 2.0)
    at = 2.0 / np.pi * np.arcsin(t)  # between two extremes of one sinusoid
    at, share = (np.stack([x, 1.0 - x]) * np.ones((len(segments), 1, 1)) for x in (at, t * t))
    k = np.broadcast_to(np.arange(len(segments))[:, None, None], share.shape).ravel()
    length, rise = segments.length[k], segments.s_end[k] - segments.s_start[k]
    at, wanted, sense = at.ravel() * length, share.ravel() * np.abs(rise), np.sign(rise)
    low, high = np.where(share.ravel() == 1.0, length, 0.0), np.where(share.ravel() == 0.0, 0.0, length)  # the ends are known
    found, lanes = at.copy(), np.arange(k.size)
    for _ in range(_HALVINGS):
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
