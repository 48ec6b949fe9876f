"""What bodies at rest ask of the ground: xg''/g across and 1 + zg''/g upwards, over m g, from one position of the motion to another."""

from __future__ import annotations

import numpy as np

from ...motions.blocks import blocks
from ...motions.segments import Segments
from ..body import Body
from ..lanes import Cells
from ..weight import WeighedSegments
from .bends import Forces
from .closing import Bounds
from .extremes import Records
from .ground import amplitudes, value_and_slope
from .quartics import Spans, search

Array = np.ndarray


class Resting:
    """Bodies at rest under a motion. Positions are (k, u), segment and phase in it; rests last from one to another, (rests,), whose segment
    is their number where they last to the end."""

    def __init__(self, body: Body, segments: Segments, cells: Cells) -> None:
        self.body, self.segments, self.cells = body, segments, cells
        self._steepest = max(edge.uplift for edge in body.edges)

    def note(self, records: Records, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Take rests into the records of their cells."""
        seg = self.segments
        to_k, to_u = _within(seg, to_k, to_u)
        if isinstance(seg, WeighedSegments):
            with np.errstate(all="ignore"):  # where the ground falls away there is no weight to divide by
                self._weighed(records, seg, cell, k, u, to_k, to_u)
        else:
            np.maximum.at(records.friction, cell, self._friction(cell, k, u, to_k, to_u))

    def bounds(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> Bounds:
        """Of rests."""
        seg = self.segments
        to_k, to_u = _within(seg, to_k, to_u)
        if not isinstance(seg, WeighedSegments):
            return Bounds(np.ones(cell.size), self._friction(cell, k, u, to_k, to_u))
        largest, least = _range(seg.vertical, k, u, to_k, to_u)
        sway = self._sway(seg, cell)
        return Bounds(1.0 + np.minimum(sway * largest, sway * least), np.full(cell.size, self._steepest))

    def _push(self, cell: Array) -> Array:
        """The outward push over g of s = -1 on the right edge."""
        return self.cells.amplitude[0, cell] * self.body.edges[0].uplift

    def _sway(self, seg: WeighedSegments, cell: Array) -> Array:
        """zg''/g of a vertical s = 1."""
        return seg.sway(np.ones(cell.size), self.cells.amplitude[0, cell])

    def _friction(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> Array:
        """Where the weight is steady; of a one-sided body as far as it leans on no backing."""
        largest, least = _range(self.segments, k, u, to_k, to_u)
        return self._push(cell) * (-least if self.body.one_sided else np.maximum(-least, largest))

    def _weighed(self, records: Records, seg: WeighedSegments, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Segment after segment, on each of which Fz is monotone and Fx/Fz is not."""
        while True:
            going = np.flatnonzero((k < to_k) | ((k == to_k) & (u < to_u)))
            if not going.size:
                return
            cell, k, u, to_k, to_u = (x[going] for x in (cell, k, u, to_k, to_u))
            stop = np.where(k < to_k, seg.length[k], to_u)

            def along(own: Array, phase: Array, cell: Array = cell, k: Array = k) -> Forces:
                return self._forces(seg, cell[own], k[own], phase)

            every = np.arange(cell.size)
            sizes = np.array(
                [
                    np.abs(self._push(cell)) * amplitudes(seg, k, 4),
                    np.abs(self._sway(seg, cell)) * amplitudes(seg.vertical, k, 4),
                ]
            )
            search(records, cell, along, Spans(every, u, stop, sizes, along(every, u), along(every, stop)), self.body.one_sided)
            k, u = k + 1, np.zeros(k.size)

    def _forces(self, seg: WeighedSegments, cell: Array, k: Array, phase: Array) -> Forces:
        """By the phase; outwards is to the right edge."""
        (s, slope), (rise, rise_slope) = value_and_slope(seg, k, phase), value_and_slope(seg.vertical, k, phase)
        sway, push = self._sway(seg, cell), -self._push(cell)
        return Forces(np.zeros(k.size), push * s, 1.0 + sway * rise, push * slope, sway * rise_slope)


class LineResting(Resting):
    """The same under straight lines, on which both forces are lines and their ratio is monotone while there is a weight."""

    def _weighed(self, records: Records, seg: WeighedSegments, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """All segments at once, by their ends."""
        count = np.maximum(to_k - k + (to_u > 0.0), 0) * ((k < to_k) | (u < to_u))
        ends = np.cumsum(count)
        for part in blocks(int(ends[-1]) if ends.size else 0):
            flat = np.arange(part.start, part.stop)
            lane = np.searchsorted(ends, flat, side="right")
            at = k[lane] + flat - (ends - count)[lane]
            begins, stops = np.where(at == k[lane], u[lane], 0.0), np.where(at == to_k[lane], to_u[lane], seg.length[at])
            push, sway = -self._push(cell[lane]), self._sway(seg, cell[lane])
            for phase in (begins, stops):
                across, up = (x.s_start[at] + x.slope[at] * phase for x in (seg, seg.vertical))
                weight = 1.0 + sway * up
                ratio = push * across / weight
                records.note(cell[lane], weight, np.maximum(ratio, 0.0) if self.body.one_sided else np.abs(ratio))


def _within(segments: Segments, k: Array, u: Array) -> tuple[Array, Array]:
    last = len(segments) - 1
    return np.minimum(k, last), np.where(k > last, segments.length[last], u)


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
