"""The rules at contact: uplift from rest, and the end of a chatter.

A body at rest leaves the ground at the first instant with A |s| > 1, on the side -sgn s. A body that bounces while
|a| < 1 comes to rest after infinitely many impacts in a finite time; that series is closed in one step as soon as
bounds on its duration prove that it ends before anything else can happen.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.motion import Segments
from ..march.lanes import Lanes
from ..march.windows import crossing, segment_value

Array = np.ndarray


# Without loss at impacts a bounce never ends; one this slow is 1e-24 high, and to be at rest is the same to every digit.
BELOW_ROUNDING = 1e-12


class Uplift(NamedTuple):
    """Where bodies at rest leave the ground: segment (the number of segments where they never do), phase, side, y''."""

    k: Array
    u: Array
    side: Array
    b: Array


def uplift(segments: Segments, k: Array, u: Array, amplitude: Array) -> Uplift:
    """First instant at or after (k, u) with A |s| > 1, for bodies at rest; y'' is 0 there unless the drive jumps."""
    k, u = k.copy(), u.copy()
    side, b = np.ones_like(amplitude), np.zeros_like(amplitude)
    last = len(segments)
    strongest = np.maximum(segments.later_max, -segments.later_min)
    waiting = np.arange(k.size)
    while waiting.size:
        over = (k[waiting] >= last) | (amplitude[waiting] * strongest[np.minimum(k[waiting], last - 1)] <= 1.0)
        k[waiting[over]] = last
        waiting = waiting[~over]
        kk, uu, a = k[waiting], u[waiting], amplitude[waiting]
        s_now = segments.s_start[kk]
        inside = np.flatnonzero(uu > 0.0)
        s_now[inside] += segment_value(segments, kk[inside], uu[inside])[0]
        now = a * np.abs(s_now) > 1.0
        s_end = segments.s_end[kk]
        later = ~now & (a * np.abs(s_end) > 1.0)
        hit = np.flatnonzero(now)
        side[waiting[hit]] = -np.sign(s_now[hit])
        b[waiting[hit]] = a[hit] * np.abs(s_now[hit]) - 1.0
        hit = np.flatnonzero(later)
        side[waiting[hit]] = -np.sign(s_end[hit])
        u[waiting[hit]] = np.maximum(uu[hit], crossing(segments, kk[hit], np.sign(s_end[hit]) / a[hit]))
        waiting = waiting[~(now | later)]
        k[waiting] += 1
        u[waiting] = 0.0
    return Uplift(k, u, side, b)


def chatter_ends(segments: Segments, lanes: Lanes, gain: float) -> Array:
    """Lanes just after an impact whose bouncing is proved to end in rest within the segment, before |a| reaches 1.

    With a between a_- and a_+ until the end, the series of arcs lasts at most
    2 v / (1 - eta^2) [1/(1 - a_+ - g y) + eta/(1 + a_- - g y)], y the largest height and g the model's gain, and no arc
    rises above v^2 / (2 (1 - max |a| - g y)). Lanes whose arcs could rise above their peak so far are left to go on.
    """
    drive, v = 1.0 + lanes.b, lanes.v
    gap = 1.0 - np.abs(drive)
    proved = (lanes.eta == 1.0) & (v < BELOW_ROUNDING * gap)
    maybe = np.flatnonzero((gap > 0.0) & (v * v < 0.05 * gap * gap) & (lanes.eta < 1.0))
    if not maybe.size:
        return proved
    k, u, v, n, a0 = lanes.k[maybe], lanes.u[maybe], v[maybe], lanes.eta[maybe], drive[maybe]
    scale = 2.0 * v / (1.0 - n * n)
    trial = 1.5 * scale * (1.0 / (1.0 - a0) + n / (1.0 + a0))
    later = np.minimum(u + lanes.omega[maybe] * trial, segments.length[k])
    outward = -lanes.side[maybe] * lanes.amplitude[maybe]
    a1 = a0 + outward * (segment_value(segments, k, later)[0] - segment_value(segments, k, u)[0])
    highest, lowest = np.maximum(a0, a1), np.minimum(a0, a1)  # s is monotone on a segment
    margin = 1.0 - np.maximum(highest, -lowest)
    height = gain * v * v / margin  # bounds what y adds to the acceleration
    up, down = 1.0 - highest - height, 1.0 + lowest - height
    ends = (margin > 0.0) & (height < 0.5 * margin) & (up > 0.0) & (down > 0.0)
    ends &= (later < segments.length[k]) & (scale * (1.0 / up + n / down) <= trial) & (height <= gain * lanes.peak[maybe])
    proved[maybe[ends]] = True
    return proved
