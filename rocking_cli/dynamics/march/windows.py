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

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...motions.motion import Segments
from ..drive import crossing
from ..weight import WeighedSegments

Array = np.ndarray
CutAt = Callable[[Array, Array], Array]

_MOST_CUTS, _FIRST = 100_000, 10_000  # cuts that a run looks up, more are searched for, lane by lane; cells that show what there is


class Windows(NamedTuple):
    """Where the present window ends, for every lane: segment and phase in it, and whether it is a ridge."""

    k: Array
    u: Array
    ridge: Array


class Cuts(NamedTuple):
    """Where a = 1 on each segment, for every amplitude of a run: what a search would find again in each round.

    of: index of each cell's amplitude; phase: (2, segments, amplitudes), for the sides +1 and -1, NaN where there is none.
    """

    of: Array
    phase: Array

    def at(self, cell: Array, k: Array, side: Array) -> Array:
        """Phases in segments k, where these cells' drive crosses 1 on it."""
        return self.phase[(side < 0.0).astype(np.int64), k, self.of[cell]]


def cuts_of(segments: Segments, amplitude: Array) -> Cuts | None:
    """The cuts of these amplitudes, (cells,), where each is a search; None where they are many, or not seen among the first cells as in a
    grid they are."""
    if isinstance(segments, WeighedSegments) or segments.harmonics <= (0 if segments.sloped else 1):
        return None
    different = np.unique(amplitude[:_FIRST])
    if different.size * len(segments) > _MOST_CUTS or different.size >= 0.5 * amplitude.size:
        return None
    of = np.minimum(np.searchsorted(different, amplitude), different.size - 1)
    if np.any(different[of] != amplitude):
        return None
    phase = np.full((2, len(segments), different.size), np.nan)
    with np.errstate(divide="ignore"):
        level = np.array([-1.0, 1.0])[:, None, None] / different
    start, end = segments.s_start[:, None], segments.s_end[:, None]
    at = np.nonzero((np.minimum(start, end) <= level) & (level <= np.maximum(start, end)))
    phase[at] = crossing(segments, at[1], level[at[0], 0, at[2]])
    return Cuts(of, phase)


def window_end(segments: Segments, k: Array, u: Array, side: Array, amplitude: Array, cut_at: CutAt | None = None) -> Windows:
    """The end of the window that (k, u) lies in; a boundary belongs to the window that it begins.

    cut_at: gives the phases in segments k at which the drive of lanes of these indices crosses 1, where they are known. Where the weight
    varies the windows are those of the net drive, on the side that the body is on.
    """
    if isinstance(segments, WeighedSegments):
        offset = segments.offset(side)
        there = _beyond_cuts(segments.edges, window_end(segments.edges, k + offset, u, side, amplitude), side, amplitude)
        return Windows(there.k - offset, there.u, there.ridge)
    inverse = 1.0 / amplitude
    if cut_at is None:

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
        n_cut[n_cuts] = cut_at(lanes[n_cuts], nk[n_cuts])
        to_u[lanes] = n_cut
    return Windows(to_k, to_u, ridge)


def _beyond_cuts(segments: Segments, window: Windows, side: Array, amplitude: Array) -> Windows:
    """The same windows further on where a segment ends without a turn of this edge's drive, which is cut for the other one's too; a valley
    still ends at an inner maximum, so that its drive is largest at an end."""
    k, u, ridge = window
    lanes = np.arange(k.size)
    while True:
        ends = lanes[(u[lanes] >= segments.length[k[lanes]]) & segments.joins[k[lanes]]]
        rises, falls = (
            sense * side[ends] * (segments.s_end[at] - segments.s_start[at]) < 0.0 for sense, at in ((1.0, k[ends]), (-1.0, k[ends] + 1))
        )
        ends = ends[ridge[ends] | ~(rises & falls)]
        if not ends.size:
            return Windows(k, u, ridge)
        following = window_end(segments, k[ends] + 1, np.zeros(ends.size), side[ends], amplitude[ends])
        same = following.ridge == ridge[ends]
        lanes = ends[same]
        k, u = k.copy(), u.copy()
        k[lanes], u[lanes] = following.k[same], following.u[same]
