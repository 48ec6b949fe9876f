"""The peak within a propagation on which the body is pulled back all the time, so that there is one at the most (Lemma 11)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Arrays
from ..march.roots import turning_point
from .propagation import ExactLanes
from .ramp import RampFlow

Array = np.ndarray

_GUESSES = 8  # Newton's, before the samples between which the peak lies are halved


@dataclass
class Rise(Arrays):
    """Propagations with a peak: lanes at a sample where y' > 0; a later sample, where y' < 0, and that y'."""

    lanes: ExactLanes
    to: Array
    end_v: Array


def peak_heights(rise: Rise, bounded: Array, samples: Array) -> Array:
    """y at the peaks of these propagations, (lanes,)."""
    lanes, to, end_v = rise.lanes, rise.to, rise.end_v
    y, v, low, high = lanes.y.copy(), lanes.v.copy(), lanes.k.copy(), to.copy()
    n = low + ((to - low) * (v / (v - end_v))).astype(np.int64)
    going, guesses = np.flatnonzero(high - low > 1), 0
    while going.size:
        some = lanes.take(going)
        i = np.clip(n[going], low[going] + 1, high[going] - 1)
        there_y, there_v = some.at(i, bounded)
        later = there_v >= 0.0
        rises = going[later]
        low[rises], y[rises], v[rises] = i[later], there_y[later], there_v[later]
        high[going[~later]] = i[~later]
        pull = there_y - 1.0 + some.drive * samples.take(i)
        guesses += 1
        n[going] = i + np.floor(there_v / (-pull * some.pace)).astype(np.int64) if guesses < _GUESSES else (low[going] + high[going]) >> 1
        going = going[high[going] - low[going] > 1]
    now = samples.take(low)
    arc = RampFlow(y, v, y - 1.0 + lanes.drive * now, lanes.drive * (samples.take(low + 1) - now) / lanes.pace)
    guess = np.clip(v / -arc.b, 0.0, lanes.pace)
    return turning_point(arc, np.zeros(low.size), lanes.pace, guess, 1.0)[1]
