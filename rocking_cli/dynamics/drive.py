"""The drive along a motion: its value and its crossings of a level inside a segment, and positions from segment to segment.

A position in the motion is a segment k and the phase u since that segment's start.
"""

from __future__ import annotations

import numpy as np

from ..motions.motion import Segments

Array = np.ndarray

_LEAST_SQUARE = 1e-300  # R^2 - x^2 at an extremum of the sinusoid, where rounding may leave 0 or less


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


def place(segments: Segments, k: Array, u: Array) -> tuple[Array, Array]:
    """The same position with the phase inside its segment; k is the number of segments at the end of the motion."""
    last = len(segments)
    over = np.flatnonzero((k < last) & (u >= segments.length[np.minimum(k, last - 1)]))
    if over.size:
        k, u = k.copy(), u.copy()
    while over.size:
        u[over] -= segments.length[k[over]]
        k[over] += 1
        u[over[k[over] >= last]] = 0.0
        over = over[(k[over] < last)]
        over = over[u[over] >= segments.length[k[over]]]
    return k, u


def phase_between(segments: Segments, k: Array, u: Array, to_k: Array, to_u: Array) -> Array:
    """Phase from one position to a later one, summed over whole segments so that 10^4 cycles lose no digits."""
    phase = to_u - u
    at = k
    behind = np.flatnonzero(at < to_k)
    if behind.size:
        at = at.copy()
    while behind.size:
        phase[behind] += segments.length[at[behind]]
        at[behind] += 1
        behind = behind[at[behind] < to_k[behind]]
    return phase
