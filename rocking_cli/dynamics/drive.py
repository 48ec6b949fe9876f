"""The drive along a motion: its value and its crossings of a level inside a segment,
positions (k, u) from segment to segment, and the integral of its size to the end of the
motion.
"""

from typing import NamedTuple, Self

import numpy as np

from ..arrays import Array
from ..motions.segments import Segments

# a step relative to every scale of the drive: after a step of Halley's method this
# short the error is below rounding
_SHORT = 3e-6
# rounding error over the terms that an integral over a segment is summed from
_ROUNDING = 1e-13
# for R^2 - x^2, which rounding may make 0 or less at an extremum of the sinusoid
_LEAST_SQUARE = 1e-300


def crossing(segments: Segments, k: Array, level: Array) -> Array:
    """Phase u in segment k where s = level, for lanes whose level lies between the
    segment's end values: the instant of an uplift.
    """
    length = segments.length[k]
    if not segments.harmonics:  # a ramp, or a constant s
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.clip(
                np.nan_to_num((level - segments.s_start[k]) / segments.slope[k]),
                0.0,
                length,
            )
    if segments.harmonics != 1 or segments.sloped:
        return _bracketed_crossing(segments, k, level, length)
    # A falling segment is computed as its rising mirror image: mirrored motions give
    # mirrored bits. The angle is arcsin(level/R) by an arctangent, which is exact near
    # an extremum.
    wave = segments.wave
    x = level - wave.offset[k]
    x *= wave.sign[k]
    cos2 = x * x  # becomes (R cos)^2
    np.subtract(wave.radius2[k], cos2, out=cos2)
    np.maximum(cos2, _LEAST_SQUARE, out=cos2)
    x /= np.sqrt(cos2, out=cos2)
    np.arctan(x, out=x)
    x -= wave.angle[k]
    early = np.flatnonzero(x < 0.0)
    x[early] = np.where(x[early] < -1e-9, x[early] + 2.0 * np.pi, 0.0)
    x /= segments.frequency[0, k]
    return np.minimum(x, length, out=x)


def summed(rows: Array) -> Array:
    """Sum of the terms in their order, from (terms, lanes) to (lanes,): the order of
    NumPy's own sum depends on the number of lanes.
    """
    total = rows[0].copy() if len(rows) else np.zeros(rows.shape[1:])
    for row in rows[1:]:
        total += row
    return total


def turn(angle: Array) -> tuple[Array, Array]:
    """(sin, 1 - cos) of angles [rad], by the tangent of the half angle."""
    sin = np.tan(0.5 * angle)
    cosm = sin * sin
    over = 2.0 / (cosm + 1.0)
    cosm *= over
    sin *= over
    return sin, cosm


def segment_value(segments: Segments, k: Array, u: Array) -> tuple[Array, Array, Array]:
    """s - s(segment start), and the harmonics' sine and cosine parts (harmonics,
    lanes), at phase u of segment k.
    """
    # `take` keeps rows of lanes contiguous; x[:, k] would not
    sin, cos, w = (
        x.take(k, axis=1) for x in (segments.sin, segments.cos, segments.frequency)
    )
    sinw, cosm = turn(w * u)
    into, from_ = cos * sinw, sin * cosm
    change = summed(into - from_)
    if segments.sloped:
        change += segments.slope[k] * u
    return change, sin - from_ + into, cos - cosm * cos - sinw * sin


def drive_change(segments: Segments, k: Array, u: Array) -> Array:
    """s - s(segment start) at phase u of segment k, without the sine
    and cosine parts.
    """
    return (
        segment_value(segments, k, u)[0]
        if segments.table is None
        else segments.table.change_at(k, u)[0]
    )


def _change_at(segments: Segments, k: Array, u: Array) -> tuple[Array, Array, Array]:
    """s - s(segment start) and its first two derivatives by phase, at phase u of
    segment k.
    """
    if segments.table is not None:
        return segments.table.change_at(k, u)
    change, sin, cos = segment_value(segments, k, u)
    w = segments.frequency.take(k, axis=1)
    return change, summed(w * cos) + segments.slope[k], -summed(w * w * sin)


def _bracketed_crossing(
    segments: Segments, k: Array, level: Array, length: Array
) -> Array:
    """The phase at which a monotone segment of any shape meets a level: Halley's method
    inside a bracket that only shrinks.
    """
    start, end = segments.s_start[k], segments.s_end[k]
    low, high = np.zeros_like(length), length.copy()
    u = _between_extremes(start, end, level, length)
    lanes = np.flatnonzero((level != start) & (length > 0.0))
    for _ in range(80):
        if not lanes.size:
            break
        there = u[lanes]
        change, *derivatives = _change_at(segments, k[lanes], there)
        gap = start[lanes] + change - level[lanes]
        before = np.where(end[lanes] > start[lanes], gap, -gap) < 0.0
        low[lanes] = np.where(before, there, low[lanes])
        high[lanes] = np.where(before, high[lanes], there)

        target, close = _halley(there, gap, *derivatives)
        inside = (target >= low[lanes]) & (target <= high[lanes])
        target = np.where(inside, target, 0.5 * (low[lanes] + high[lanes]))
        u[lanes] = np.where(gap == 0.0, there, target)
        still = np.abs(u[lanes] - there) <= 2e-16 * length[lanes]
        lanes = lanes[~((inside & close) | still)]
    return u


def _between_extremes(start: Array, end: Array, level: Array, length: Array) -> Array:
    """The phase at which a segment meets a level if it runs from start to end between
    two extremes of one sinusoid: a first guess for the others.
    """
    rise = np.where(end == start, 1.0, end - start)
    share = np.clip((level - start) / rise, 0.0, 1.0)
    u = length * (2.0 / np.pi) * np.arcsin(np.sqrt(share))
    return np.minimum(u, length, out=u)


def _halley(
    u: Array, gap: Array, rate: Array, second_derivative: Array
) -> tuple[Array, Array]:
    """(the next u, True where the step to it is short over every scale of the drive) of
    Halley's method for a root of `gap`.
    """
    with np.errstate(all="ignore"):
        step = -gap / (rate - 0.5 * gap * second_derivative / rate)
        scale = np.minimum(u, np.abs(rate / second_derivative))
        return u + step, np.abs(step) <= _SHORT * scale


def place(segments: Segments, k: Array, u: Array) -> tuple[Array, Array]:
    """The same position, written so that the phase lies inside its segment; k is the
    number of segments at the end of the motion.
    """
    k, u, over = k.copy(), u.copy(), np.arange(k.size)
    while over.size:
        over = over[k[over] < len(segments)]
        over = over[u[over] >= segments.length[k[over]]]
        u[over] -= segments.length[k[over]]
        k[over] += 1
    ended = segments.ended(k)
    k[ended], u[ended] = len(segments), 0.0
    return k, u


def inside_piece(segments: Segments, k: Array, u: Array) -> tuple[Array, Array]:
    """The same position within a piece, written so that the phase lies inside its
    segment; k may be the number of segments or more.
    """
    k, u = np.minimum(k, len(segments) - 1), u.copy()
    over = np.flatnonzero(segments.joins[k] & (u > segments.length[k]))
    while over.size:
        u[over] -= segments.length[k[over]]
        k[over] += 1
        at = k[over]
        over = over[segments.joins[at] & (u[over] > segments.length[at])]
    return k, u


class RemainingImpulse(NamedTuple):
    """int |s| dphi to the end of a motion of sinusoids, which bounds overturning (Lemma
    9). Every array is (segments,).
    """

    segments: Segments  # segments of the motion
    # phase at which s changes its sign in a segment [rad], 0 if it does not
    zero: Array
    sign: Array  # sign of s after `zero`
    turn: Array  # an antiderivative of s at `zero` [rad]
    last: Array  # the same antiderivative at the end of the segment [rad]
    later: Array  # the integral after the segment, with room for rounding [rad]

    @classmethod
    def of(cls, segments: Segments) -> Self:
        """Build the integral for the segments of a motion."""
        k = np.arange(len(segments))
        changes = segments.s_start * segments.s_end < 0.0
        zero = np.where(changes, crossing(segments, k, np.zeros(k.size)), 0.0)
        sign = np.sign(
            np.where(changes, segments.s_end, segments.s_start + segments.s_end)
        )
        first, turn, last = (
            _antiderivative(segments, k, u)
            for u in (np.zeros(k.size), zero, segments.length)
        )
        size = np.abs(segments.s_start) * segments.length + (
            np.hypot(segments.sin, segments.cos) / segments.frequency
        ).sum(axis=0)
        whole = np.abs(turn - first) + np.abs(last - turn) + _ROUNDING * size
        return cls(
            segments,
            zero,
            sign,
            turn,
            last,
            np.append(np.cumsum(whole[::-1])[::-1][1:], 0.0) + _ROUNDING * size,
        )

    def after(self, k: Array, u: Array) -> Array:
        """int |s| dphi from phase u of segment k on, (lanes,); 0 at the end of the
        motion.
        """
        found = np.zeros(k.shape)
        at = np.flatnonzero(k < len(self.segments))
        k, u = k[at], u[at]
        here = _antiderivative(self.segments, k, u)
        before = u < self.zero[k]
        to_come = self.sign[k] * (self.last[k] - np.where(before, self.turn[k], here))
        found[at] = (
            to_come + np.where(before, np.abs(self.turn[k] - here), 0.0) + self.later[k]
        )
        return found


def _antiderivative(segments: Segments, k: Array, u: Array) -> Array:
    """An antiderivative of s at phase u of segment k."""
    _, _, cos = segment_value(segments, k, u)
    level = segments.s_start[k] - summed(segments.sin.take(k, axis=1))
    return (level + 0.5 * segments.slope[k] * u) * u - summed(
        cos / segments.frequency.take(k, axis=1)
    )
