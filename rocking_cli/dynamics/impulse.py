"""int |s| dphi from any place in a motion of sinusoids to its end; it bounds overturning of undamped linear oscillators (Lemma 9)."""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from ..motions.segments import Segments
from .drive import crossing, segment_value, summed
from .lanes import Array, Lanes

_ROUNDING = 1e-13  # of the terms that an integral over a segment is summed from
_SURELY = 1.0 - 1e-9


class ImpulseAhead(NamedTuple):
    """int |s| dphi to the end of the motion; arrays over segments.

    zero: the phase at which s changes its sign in a segment, 0 if it does not; sign: of s after that; turn, last: an antiderivative of s
    at `zero` and at the segment's end; later: the integral after the segment, with room for rounding.
    """

    segments: Segments
    zero: Array
    sign: Array
    turn: Array
    last: Array
    later: Array

    @classmethod
    def of(cls, segments: Segments) -> Self:
        """The integral of a motion."""
        k = np.arange(len(segments))
        changes = segments.s_start * segments.s_end < 0.0
        zero = np.where(changes, crossing(segments, k, np.zeros(k.size)), 0.0)
        sign = np.sign(np.where(changes, segments.s_end, segments.s_start + segments.s_end))
        first, turn, last = (_antiderivative(segments, k, u) for u in (np.zeros(k.size), zero, segments.length))
        size = np.abs(segments.s_start) * segments.length + (np.hypot(segments.sin, segments.cos) / segments.frequency).sum(axis=0)
        whole = np.abs(turn - first) + np.abs(last - turn) + _ROUNDING * size
        return cls(segments, zero, sign, turn, last, np.append(np.cumsum(whole[::-1])[::-1][1:], 0.0) + _ROUNDING * size)

    def after(self, k: Array, u: Array) -> Array:
        """The integral from phase u of segment k on, 0 at the end of the motion; (lanes,)."""
        found = np.zeros(k.shape)
        at = np.flatnonzero(k < len(self.segments))
        k, u = k[at], u[at]
        here = _antiderivative(self.segments, k, u)
        before = u < self.zero[k]
        to_come = self.sign[k] * (self.last[k] - np.where(before, self.turn[k], here))
        found[at] = to_come + np.where(before, np.abs(self.turn[k] - here), 0.0) + self.later[k]
        return found

    def cannot_overturn(self, lanes: Lanes) -> Array:
        """True for lanes at y = 0 that nothing to come overturns: |v| + A int |s| dphi/Omega < 1 (Lemma 9)."""
        return lanes.amplitude * self.after(lanes.k, lanes.u) < _SURELY * (1.0 - np.abs(lanes.v)) * lanes.omega


def _antiderivative(segments: Segments, k: Array, u: Array) -> Array:
    """An antiderivative of s at phase u of segment k."""
    _, _, cos = segment_value(segments, k, u)
    level = segments.s_start[k] - summed(segments.sin.take(k, axis=1))
    return (level + 0.5 * segments.slope[k] * u) * u - summed(cos / segments.frequency.take(k, axis=1))
