"""The forces of bodies at rest: xg''/g across and 1 + zg''/g upwards, over m g, from one position of the motion to another."""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..body import Body
from ..lanes import Cells
from ..march.ground_push import value_and_slope
from .extremes import Stretches
from .forces import ForceExtremes, Forces

Array = np.ndarray

_TOGETHER = 1 << 16  # stretches at a time


class Resting:
    """Bodies at rest under a motion. Positions are (k, u), segment and phase in it; rests last from one to another, (rests,), whose segment
    is the number of segments where they last to the end."""

    def __init__(self, body: Body, segments: Segments, cells: Cells) -> None:
        self.body, self.segments, self.cells = body, segments, cells

    def note(self, extremes: ForceExtremes, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Take rests into the extremes of their cells; of a one-sided body only an outward Fx counts."""
        last = len(self.segments) - 1
        to_k, to_u = np.minimum(to_k, last), np.where(to_k > last, self.segments.length[last], to_u)
        push = self.cells.amplitude[0, cell] * self.body.edges[0].uplift  # outward, over g, of s = -1 on the right edge
        if self.segments.weighed is None:
            largest, least = _range(self.segments, k, u, to_k, to_u)
            extremes.offer(cell, push * (-least if self.body.one_sided else np.maximum(-least, largest)))
            return
        most = max(1, _TOGETHER // (last + 1))  # whole rests at a time, so that no digit depends on other cells
        for first in range(0, cell.size, most):
            some = slice(first, first + most)
            self._weighed(extremes, *(x[some] for x in (cell, push, k, u, to_k, to_u)))

    def _weighed(self, extremes: ForceExtremes, cell: Array, push: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Search every segment of these rests."""
        seg = self.segments.weighed
        assert seg is not None
        count = np.maximum(to_k - k + (to_u > 0.0), 0) * ((k < to_k) | (u < to_u))
        rest = np.repeat(np.arange(cell.size), count)
        at = k[rest] + np.arange(rest.size) - np.repeat(np.cumsum(count) - count, count)
        low, high = np.where(at == k[rest], u[rest], 0.0), np.where(at == to_k[rest], to_u[rest], seg.length[at])
        cell, push = cell[rest], -push[rest]
        sway = seg.sway(np.ones(cell.size), self.cells.amplitude[0, cell])

        def along(own: Array, phase: Array) -> Forces:
            (s, slope), (rise, rise_slope) = (value_and_slope(x, at[own], phase) for x in (seg, seg.vertical))
            return Forces(push[own] * s, 1.0 + sway[own] * rise, push[own] * slope, sway[own] * rise_slope)

        every, rate = np.arange(cell.size), np.zeros(cell.size)
        if not seg.straight:  # of straight lines the ends have the extremes
            rate = np.maximum(*(x.frequency[:, at].max(axis=0, initial=0.0) for x in (seg, seg.vertical)))
        whole = Stretches(every, low, high, rate)
        extremes.take_in_along(cell, along, whole, along(every, low), along(every, high), self.body.one_sided)


def _range(segments: Segments, k: Array, u: Array, to_k: Array, to_u: Array) -> tuple[Array, Array]:
    """The largest s and the least, and 0, between two positions: just after the first and just before the last."""
    over, enters = to_k > k, to_u > 0.0
    ends = (
        np.where(over | (u < to_u), value_and_slope(segments, k, u)[0], 0.0),
        np.where(over, segments.s_end[k], 0.0),
        np.where(over & enters, segments.s_start[to_k], 0.0),
        np.where(enters & (over | (u < to_u)), value_and_slope(segments, to_k, to_u)[0], 0.0),
    )
    largest, least = segments.extent(k + 1, to_k)
    return np.maximum(np.maximum(largest, 0.0), np.max(ends, axis=0)), np.minimum(np.minimum(least, 0.0), np.min(ends, axis=0))
