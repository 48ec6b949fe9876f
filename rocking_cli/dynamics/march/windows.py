"""Windows of the drive: stretches of time on which one sign test proves whether y has a root.

On one side y'' - y = a - 1, and the sign of a - 1 decides what y can do:

- **valley**, a < 1 (Lemma 1): once y has crossed zero downwards y'' = y - (1 - a) stays negative, so y never comes back inside the
  window. Hence y(end) > 0 proves that there was no impact, and y(end) <= 0 that there was exactly one. Where a falls and
  then rises once (a valley ends at any inner maximum of a), y' has at most one zero downwards: at most one peak.
- **ridge**, a >= 1 (Lemma 2): y is convex while y >= 0. With y' >= 0 at the start nothing can happen; with y' < 0 y has a single
  minimum, and its sign decides.

A position in the motion is a segment k and the phase u since that segment's start. The boundaries are the crossings of
a = 1, found in closed form on a monotone segment, and the ends of pieces.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.motion import Segments

Array = np.ndarray


_LEAST_SQUARE = 1e-300  # R^2 - x^2 at an extremum of the sinusoid, where rounding may leave 0 or less


class Windows(NamedTuple):
    """Where the present window ends, for every lane: segment and phase in it, and whether it is a ridge."""

    k: Array
    u: Array
    ridge: Array


def crossing(segments: Segments, k: Array, level: Array) -> Array:
    """Phase u in segment k where s = level, for lanes whose level lies between the segment's end values."""
    length = segments.length[k]
    if segments.harmonics != 1 or segments.sloped:
        return _bracketed_crossing(segments, k, level, length)
    # A falling stretch is its rising mirror image, so that mirrored motions give mirrored bits. The angle is
    # arcsin(level/R); the arctangent with the complement keeps its distance to the extremum exact where level is near R.
    wave = segments.wave
    x = level - wave.offset[k]
    x *= wave.sign[k]
    beside = x * x
    np.subtract(wave.radius2[k], beside, out=beside)
    np.maximum(beside, _LEAST_SQUARE, out=beside)
    x /= np.sqrt(beside, out=beside)
    np.arctan(x, out=x)
    x -= wave.angle[k]
    early = np.flatnonzero(x < 0.0)
    x[early] = np.where(x[early] < -1e-9, x[early] + 2.0 * np.pi, 0.0)
    x /= segments.frequency[0, k]
    return np.minimum(x, length, out=x)


def summed(rows: Array) -> Array:
    """Sum of (terms, lanes) over the terms, one after the other: NumPy's own order depends on the number of lanes."""
    total = np.zeros(rows.shape[1:])
    for row in rows:
        total = total + row
    return total


def segment_value(segments: Segments, k: Array, u: Array) -> tuple[Array, Array, Array]:
    """s - s(segment start), and the harmonics' sine and cosine parts (harmonics, lanes), at phase u of segment k."""
    sin, cos, w = segments.sin[:, k], segments.cos[:, k], segments.frequency[:, k]
    half = np.tan(0.5 * (w * u))
    half2 = half * half
    over = 1.0 / (1.0 + half2)
    cosm, sinw = 2.0 * half2 * over, 2.0 * half * over
    change = summed(cos * sinw - sin * cosm)
    if segments.sloped:
        change = change + segments.slope[k] * u
    return change, sin - sin * cosm + cos * sinw, cos - cos * cosm - sin * sinw


def _bracketed_crossing(segments: Segments, k: Array, level: Array, length: Array) -> Array:
    """The crossing on a monotone segment of any shape: Newton's method inside a bracket that only shrinks."""
    low, high = np.zeros_like(length), length.copy()
    start, rising = segments.s_start[k], segments.s_end[k] > segments.s_start[k]
    share = (level - start) / np.where(segments.s_end[k] == start, 1.0, segments.s_end[k] - start)
    u = np.clip(share, 0.0, 1.0) * length
    slope, w = segments.slope[k], segments.frequency[:, k]
    lanes = np.flatnonzero((level != start) & (length > 0.0))
    for _ in range(80):
        if not lanes.size:
            break
        at, there = k[lanes], u[lanes]
        change, _, cos = segment_value(segments, at, there)
        gap = np.where(rising[lanes], 1.0, -1.0) * (start[lanes] + change - level[lanes])
        rate = np.abs(summed(w[:, lanes] * cos) + slope[lanes])
        low[lanes], high[lanes] = np.where(gap < 0.0, there, low[lanes]), np.where(gap < 0.0, high[lanes], there)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = there - gap / rate
        inside = (newton > low[lanes]) & (newton < high[lanes])
        following = np.where(gap == 0.0, there, np.where(inside, newton, 0.5 * (low[lanes] + high[lanes])))
        u[lanes] = following
        lanes = lanes[np.abs(following - there) > 2e-16 * length[lanes]]
    return u


def window_end(segments: Segments, k: Array, u: Array, side: Array, amplitude: Array) -> Windows:
    """The end of the window that (k, u) lies in; a boundary belongs to the window that it begins."""
    inverse = 1.0 / amplitude
    from_s, to_s = segments.s_start[k], segments.s_end[k]  # outwards
    from_s *= -side
    to_s *= -side
    start, end = from_s > inverse, to_s > inverse
    length = segments.length[k]
    cut = length.copy()
    cuts = np.flatnonzero(start != end)
    cut[cuts] = crossing(segments, k[cuts], -side[cuts] * inverse[cuts])  # s where a = 1
    here = u < cut
    ridge = np.where(here, start, end)
    here &= start != end
    # Past the crossing (or with none) the window runs to the segment's end, and on into the next segment where that one
    # continues the closed form and turns the other way.
    falling = to_s < from_s
    to_k, to_u = k, np.where(here, cut, length)
    lanes = np.flatnonzero(~here & segments.joins[k] & (ridge != falling))
    if lanes.size:
        to_k = k.copy()
        to_k[lanes] = nk = k[lanes] + 1
        n_cut = segments.length[nk]
        n_cuts = np.flatnonzero(ridge[lanes] != (-side[lanes] * segments.s_end[nk] > inverse[lanes]))
        n_cut[n_cuts] = crossing(segments, nk[n_cuts], -side[lanes[n_cuts]] * inverse[lanes[n_cuts]])
        to_u[lanes] = n_cut
    return Windows(to_k, to_u, ridge)
