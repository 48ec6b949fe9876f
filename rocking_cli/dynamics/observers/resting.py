"""The forces of bodies at rest: xg''/g across and 1 + zg''/g upwards, over m g, from one position of the motion to another."""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..body import Body
from ..lanes import Cells
from ..march.ground import value_and_slope
from ..weight import WeighedSegments
from .extremes import Extremes
from .forces import Forces, Stretches, note_extremes

Array = np.ndarray

_TOGETHER = 1 << 16  # stretches at a time


class Resting:
    """Bodies at rest under a motion. Positions are (k, u), segment and phase in it; rests last from one to another, (rests,), whose segment
    is the number of segments where they last to the end."""

    def __init__(self, body: Body, segments: Segments, cells: Cells) -> None:
        self.body, self.segments, self.cells = body, segments, cells

    def note(self, friction: Extremes, lift: Extremes, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Take rests into the largest |Fx|/Fz and -Fz of their cells; of a one-sided body Fx counts as far as it leans on no backing."""
        to_k, to_u = self._within(to_k, to_u)
        weighed = self.segments.weighed
        if weighed is None:
            friction.offer(cell, self._steady(cell, k, u, to_k, to_u))
            return
        count = np.maximum(to_k - k + (to_u > 0.0), 0) * ((k < to_k) | (u < to_u))
        ends = np.cumsum(count)
        for first in range(0, int(ends[-1]) if ends.size else 0, _TOGETHER):
            part = np.arange(first, min(first + _TOGETHER, int(ends[-1])))
            rest = np.searchsorted(ends, part, side="right")
            at = k[rest] + part - (ends - count)[rest]
            begin, stop = np.where(at == k[rest], u[rest], 0.0), np.where(at == to_k[rest], to_u[rest], self.segments.length[at])
            with np.errstate(all="ignore"):  # where the ground falls away there is no weight to divide by
                self._weighed(weighed, friction, lift, cell[rest], at, begin, stop)

    def bounds(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> tuple[Array, Array]:
        """Upper bounds of the |Fx|/Fz and the -Fz of rests, (rests,)."""
        to_k, to_u = self._within(to_k, to_u)
        weighed = self.segments.weighed
        if weighed is None:
            return self._steady(cell, k, u, to_k, to_u), np.full(cell.size, -1.0)
        largest, least = _range(weighed.vertical, k, u, to_k, to_u)
        sway = self._sway(weighed, cell)
        steepest = max(edge.uplift for edge in self.body.edges)
        return np.full(cell.size, steepest), -1.0 - np.minimum(sway * largest, sway * least)

    def _within(self, k: Array, u: Array) -> tuple[Array, Array]:
        last = len(self.segments) - 1
        return np.minimum(k, last), np.where(k > last, self.segments.length[last], u)

    def _push(self, cell: Array) -> Array:
        """The outward push over g of s = -1 on the right edge."""
        return self.cells.amplitude[0, cell] * self.body.edges[0].uplift

    def _sway(self, seg: WeighedSegments, cell: Array) -> Array:
        """zg''/g of a vertical s = 1."""
        return seg.sway(np.ones(cell.size), self.cells.amplitude[0, cell])

    def _steady(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> Array:
        """The largest |Fx|/Fz under a constant weight."""
        largest, least = _range(self.segments, k, u, to_k, to_u)
        return self._push(cell) * (-least if self.body.one_sided else np.maximum(-least, largest))

    def _weighed(self, seg: WeighedSegments, friction: Extremes, lift: Extremes, cell: Array, k: Array, low: Array, high: Array) -> None:
        """Stretches from one phase to another of segments k, cut where they bend; of straight lines both ends have the extremes."""

        def along(own: Array, phase: Array) -> Forces:
            (s, slope), (rise, rise_slope) = (value_and_slope(x, k[own], phase) for x in (seg, seg.vertical))
            sway, push = self._sway(seg, cell[own]), -self._push(cell[own])
            return Forces(push * s, 1.0 + sway * rise, push * slope, sway * rise_slope)

        every = np.arange(cell.size)
        rate = np.zeros(cell.size)
        if not seg.straight:
            rate = np.maximum(*(x.frequency[:, k].max(axis=0, initial=0.0) for x in (seg, seg.vertical)))
        found = Stretches(low, high, along(every, low), along(every, high), rate)
        note_extremes(friction, lift, cell, along, found, self.body.one_sided)


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
