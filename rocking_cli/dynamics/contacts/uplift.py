"""The next uplift of bodies that rest on the ground."""

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..drive import crossing, drive_change


class Uplift(NamedTuple):
    """The next uplift of bodies at rest. Every array is (lanes,)."""

    segment: Array  # index of the segment; their number if nothing lifts the body
    phase: Array  # phase in the segment [rad]
    side: Array  # +1 right, -1 left
    force: Array  # y'' + 2 zeta y' at uplift, in the unit of the side


def first_uplift(
    segments: Segments, k: Array, u: Array, right: Array, left: Array
) -> Uplift:
    """First instant at or after (k, u) that lifts bodies at rest: -right s > 1 lifts
    them onto the right edge, left s > 1 onto the left. right, left: amplitudes in units
    of each edge's uplift, 0 for an edge that does not exist. The force is 0 at uplift
    unless the drive jumps. If the weight varies, each edge has its own effective
    motion, and the earlier uplift counts.
    """
    if (weighed := segments.weighed) is not None:
        one = first_uplift(weighed.right, k, u, right, np.zeros_like(right))
        other = first_uplift(weighed.left, k, u, np.zeros_like(left), left)
        before = (one.segment < other.segment) | (
            (one.segment == other.segment) & (one.phase <= other.phase)
        )
        return Uplift(
            *(np.where(before, a, b) for a, b in zip(one, other, strict=True))
        )
    size, last = k.size, len(segments)
    found = Uplift(k.copy(), u.copy(), np.ones(size), np.zeros(size))
    waiting = np.arange(size)
    while waiting.size:
        # Bodies that no drive to come lifts go to the end of the motion.
        here = np.minimum(found.segment[waiting], last - 1)
        strongest = np.maximum(
            left[waiting] * segments.later_max[here],
            right[waiting] * -segments.later_min[here],
        )
        over = (found.segment[waiting] >= last) | (strongest <= 1.0)
        found.segment[waiting[over]] = last
        waiting = waiting[~over]

        # The others are lifted in this segment, or go on to the next one whose drive
        # exceeds 1.
        lifted = _lift(segments, found, waiting, right[waiting], left[waiting])
        waiting = waiting[~lifted]
        with np.errstate(divide="ignore"):
            found.segment[waiting] = segments.next_beyond(
                found.segment[waiting] + 1, 1.0 / left[waiting], 1.0 / right[waiting]
            )
        found.phase[waiting] = 0.0
    return found


def _lift(
    segments: Segments, found: Uplift, at: Array, right: Array, left: Array
) -> Array:
    """Lift those of the bodies `at` that the rest of their segment lifts: set their
    `found`, and return True for them. right, left: amplitudes of these bodies.
    """
    k, u = found.segment[at], found.phase[at]
    s_now, s_end = segments.s_start[k], segments.s_end[k]
    inside = np.flatnonzero(u > 0.0)
    s_now[inside] += drive_change(segments, k[inside], u[inside])

    # The drive lifts the body now: it has jumped, and the force is not zero.
    drive_now = np.where(s_now > 0.0, left, right) * np.abs(s_now)
    now = drive_now > 1.0
    hit = np.flatnonzero(now)
    found.side[at[hit]] = -np.sign(s_now[hit])
    found.force[at[hit]] = drive_now[hit] - 1.0

    # s is monotone: the drive lifts the body later if it does so at the segment's end.
    amplitude = np.where(s_end > 0.0, left, right)
    later = ~now & (amplitude * np.abs(s_end) > 1.0)
    hit = np.flatnonzero(later)
    found.side[at[hit]] = -np.sign(s_end[hit])
    level = np.sign(s_end[hit]) / amplitude[hit]
    found.phase[at[hit]] = np.maximum(u[hit], crossing(segments, k[hit], level))
    return now | later
