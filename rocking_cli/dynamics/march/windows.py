"""Windows of the drive: stretches of time on which one sign test proves whether y has a root.

On one side y'' - y = a - 1 (linear), and the sign of a - 1 decides what y can do: Lemma 1 where a < 1, Lemma 2 where a >= 1. A window
with a < 1 ends at any inner maximum of a, so that a falls and then rises once along it (Lemma 3).

A position in the motion is a segment k and the phase u since its start. Boundaries are the crossings of a = 1 and the ends of pieces.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..drive import crossing

Array = np.ndarray


class Windows(NamedTuple):
    """Where the present window ends, for every lane: segment and phase in it, whether the drive is supercritical, and the phase of the
    whole segments that lie between."""

    k: Array
    u: Array
    supercritical: Array
    over: Array

    def phase(self, u: Array) -> Array:
        """How far it is from phase u of the present segment."""
        return self.u - u + self.over


def window_end(segments: Segments, k: Array, u: Array, side: Array, amplitude: Array) -> Windows:
    """The end of the window that (k, u) lies in; a boundary belongs to the window that it begins. Where the weight varies the windows are
    those of the net drive on the body's side."""
    if (weighed := segments.weighed) is not None:
        offset = weighed.offset(side)
        there = _beyond_cuts(weighed.edges, window_end(weighed.edges, k + offset, u, side, amplitude), side, amplitude)
        return there._replace(k=there.k - offset)
    inverse = 1.0 / amplitude

    def cut_at(lanes: Array, k: Array) -> Array:
        return crossing(segments, k, -side[lanes] * inverse[lanes])

    from_s, to_s = segments.s_start[k], segments.s_end[k]  # outwards
    from_s *= -side
    to_s *= -side
    start, end = from_s > inverse, to_s > inverse
    length = segments.length[k]
    cut = length.copy()
    cuts = np.flatnonzero(start != end)
    cut[cuts] = cut_at(cuts, k[cuts])  # where a = 1
    here = u < cut
    supercritical = np.where(here, start, end)
    here &= start != end
    # Past the crossing (or with none) the window runs to the segment's end, and on into the next segment where that one
    # continues the closed form and turns the other way.
    falling = to_s < from_s
    to_k, to_u, over = k, np.where(here, cut, length), np.zeros(length.shape)
    lanes = np.flatnonzero(~here & segments.joins[k] & (supercritical != falling))
    if lanes.size:
        to_k = k.copy()
        to_k[lanes] = nk = k[lanes] + 1
        n_cut = segments.length[nk]
        n_cuts = np.flatnonzero(supercritical[lanes] != (-side[lanes] * segments.s_end[nk] > inverse[lanes]))
        n_cut[n_cuts] = cut_at(lanes[n_cuts], nk[n_cuts])
        to_u[lanes] = n_cut
        over[lanes] = length[lanes]
    return Windows(to_k, to_u, supercritical, over)


def _beyond_cuts(segments: Segments, window: Windows, side: Array, amplitude: Array) -> Windows:
    """The same windows further on where a segment ends without a turn of this edge's drive, which is cut for the other one's too; a
    subcritical window still ends at an inner maximum, so that its drive is largest at an end."""
    k, u, supercritical, over = window
    lanes = np.arange(k.size)
    while True:
        ends = lanes[(u[lanes] >= segments.length[k[lanes]]) & segments.joins[k[lanes]]]
        rises, falls = (
            sense * side[ends] * (segments.s_end[at] - segments.s_start[at]) < 0.0 for sense, at in ((1.0, k[ends]), (-1.0, k[ends] + 1))
        )
        ends = ends[supercritical[ends] | ~(rises & falls)]
        if not ends.size:
            return Windows(k, u, supercritical, over)
        following = window_end(segments, k[ends] + 1, np.zeros(ends.size), side[ends], amplitude[ends])
        same = following.supercritical == supercritical[ends]
        lanes = ends[same]
        k, u, over = k.copy(), u.copy(), over.copy()
        over[lanes] += segments.length[k[lanes]] + following.over[same]
        k[lanes], u[lanes] = following.k[same], following.u[same]
