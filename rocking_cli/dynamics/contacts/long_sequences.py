"""Sequences of impacts that take more steps than the march allows (Lemma 7 (b))."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...motions.segments import Segments
from ..drive import drive_change
from ..equations.equation import Equation
from ..lanes import Lanes
from .sequences import BELOW_ROUNDING

Array = np.ndarray

_EVERY = 32  # steps of a lane from one test to the next
_SHARES = (0.003, 0.01, 0.03, 0.1, 0.25, 0.5)  # of the rest of the segment: ends of the stretches that bounces fill


def outlasts(segments: Segments, lanes: Lanes, equation: Equation, most: int) -> Array:
    """True for lanes with equal sides, just after an impact, that need more than `most` steps.

    G^2 is the last over the first force on the side whose force grows, G'^2 on the other. A sequence ends early only within the segment:
    with a speed below (1 - eta^2) M times the time left, M the largest 1 - |a|, or below rounding. `most` impacts leave eta^most v/G'.
    """
    found = np.zeros(lanes.v.shape, dtype=bool)
    at = np.flatnonzero((lanes.steps % _EVERY == 0) & (lanes.v > 0.0) & (lanes.y == 0.0) & (lanes.b < 0.0) & (lanes.b > -2.0))
    kept = lanes.eta[at] ** most
    at, kept = at[kept > 0.0], kept[kept > 0.0]  # others have come to rest by then
    if not at.size or equation.damping:
        return found
    k, u, v, eta, a0 = lanes.k[at], lanes.u[at], lanes.v[at], lanes.eta[at], 1.0 + lanes.b[at]
    left, gain = segments.length[k] - u, equation.on(lanes.side[at], lanes.cell[at]).gain
    outward, now = -lanes.side[at] * lanes.amplitude[at], drive_change(segments, k, u)
    begins = a0 + outward * (drive_change(segments, k, u + _SHARES[0] * left) - now)
    for share, to in pairwise(_SHARES):
        ends = a0 + outward * (drive_change(segments, k, u + to * left) - now)
        rises, here, there = ends > a0, (1.0 - ends) / (1.0 - a0), (1.0 + ends) / (1.0 + a0)
        fastest, slowest = v * np.sqrt(np.where(rises, there, here)), v * kept * np.sqrt(np.where(rises, here, there))
        least, first = 1.0 - np.maximum(np.abs(begins), np.abs(ends)), 1.0 - np.abs(a0)
        most_force = np.where(a0 * ends > 0.0, np.maximum(first, 1.0 - np.abs(ends)), 1.0)  # of the weaker side, until the stretch ends
        many = (to - share) * left / lanes.omega[at] * (0.5 * least) / (2.0 * fastest) > most
        goes_on = np.where(eta < 1.0, 3.0 * slowest * lanes.omega[at] > (1.0 - eta * eta) * left * most_force, True)
        goes_on &= slowest > BELOW_ROUNDING
        gap = np.minimum(least, first)
        found[at] |= (gap > 0.0) & (20.0 * gain * fastest**2 < gap**2) & many & goes_on
        begins = ends
    return found
