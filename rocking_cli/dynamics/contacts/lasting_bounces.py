"""Bounces that need more steps than the march follows."""

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..lanes import Lanes
from .sequences import BELOW_ROUNDING, forces_at_ground

# eta above which bodies are tested for lasting bounces: bodies with a smaller eta come
# to rest soon
NEARLY_ELASTIC = 0.99
_FIRST = 16  # steps of a lane before the first test
# largest part of its speed that such a body may lose: a body that loses all of it could
# come to rest
_MOST_LOSS = 0.1
# instants as parts of the rest of a segment: now, and the middles of its quarters
_SHARES = (0.0, 0.125, 0.375, 0.625, 0.875)


def too_many_impacts(segments: Segments, lanes: Lanes, most: int) -> Array:
    """Return True for undamped lanes on equal edges, just after an impact, that would
    have more than `most` impacts until their segment ends; the march then gives them
    up. This is an estimate, not a proof, so it requires twice as many: two arcs last 4
    v/(1 - a^2), and bounces without loss under a drive that changes slowly keep the
    action v^3/(1 - a^2).
    """
    found = np.zeros(lanes.v.shape, dtype=bool)
    at = _tested(lanes)
    if not at.size:
        return found
    lanes = lanes.take(at)
    # 1 - a^2 now and at instants to come: v is proportional to its cube root.
    left = segments.length[lanes.segment] - lanes.phase
    now, *later = (
        1.0
        - (1.0 - forces_at_ground(segments, lanes, None, lanes.phase + share * left)[0])
        ** 2
        for share in _SHARES
    )
    # The number of arcs is the integral of (1 - a^2)/(2 v) over the time that is left.
    pace = np.mean([np.cbrt(np.maximum(still, 0.0)) ** 2 for still in later], axis=0)
    impacts = 0.5 * pace * np.cbrt(now) * left / lanes.omega / lanes.v
    found[at] = (
        (impacts > 2.0 * most)
        & (impacts * (1.0 - lanes.eta) < _MOST_LOSS)
        & (lanes.v > 10.0 * BELOW_ROUNDING)
    )
    return found


def _tested(lanes: Lanes) -> Array:
    """Indices of lanes at the ground that lose almost no speed, under |a| < 1: after
    `_FIRST` steps, then each time these have doubled.
    """
    tested = (
        (lanes.steps >= _FIRST)
        & (lanes.steps & (lanes.steps - 1) == 0)
        & (lanes.eta > NEARLY_ELASTIC)
        & (lanes.v > 0.0)
    )
    return np.flatnonzero(tested & (lanes.force < 0.0) & (lanes.force > -2.0))
