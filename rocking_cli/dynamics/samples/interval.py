"""One interval of a lane between samples, where the drive is a ramp, with the sign tests of the march."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..equations.equation import Point
from ..lanes import Lanes
from ..march.roots import hidden_turn, impact_root, turning_point
from .ramp import RampFlow, impact_guess

Array = np.ndarray

_SURELY = 1.0 - 1e-6  # part of a tangent's reach that is used as proof


class Passage(NamedTuple):
    """Lanes through an interval, (lanes,).

    arc: their motion; reach: how far they go [tau], to the interval's end, to where the drive passes 1 (`cut`) or to an impact (`hit`);
    end: their state there; low: where a subcritical stretch ends, else 0; rises: whether y rises at first, from there on; bare: whether the
    arc is supercritical throughout, so that it has no peak.
    """

    arc: RampFlow
    reach: Array
    cut: Array
    hit: Array
    end: Point
    low: Array
    rises: Array
    bare: Array


def through_interval(lanes: Lanes, drive: Array, sample: Array, gain: Array, step: float) -> Passage:
    """These lanes through their present intervals; drive: outward, of s = 1; sample: s where the interval begins; gain: what it grows by;
    step: between samples. A force that is not known is NaN in `lanes`."""
    y, v, pace = lanes.y, lanes.v, step / lanes.omega
    b = y - 1.0 + drive * sample
    known = np.flatnonzero(lanes.b == lanes.b)  # not NaN
    b[known] = lanes.b[known]
    left = pace - lanes.u / lanes.omega
    rate = drive * gain / pace
    arc = RampFlow(y, v, b, rate)
    one = (y - b) / rate  # when the drive is 1
    supercritical = (b > y) | ((b == y) & (rate > 0.0))
    rises = (v > 0.0) | (supercritical & (v >= 0.0))
    crosses = (one > 0.0) & (one < left)
    cut = crosses & ~(supercritical & rises)
    cuts, low_at = np.flatnonzero(cut), np.flatnonzero(crosses & supercritical & rises)
    reach, low = left.copy(), np.zeros(y.size)
    reach[cuts], low[low_at] = one[cuts], one[low_at]
    end = arc.at(reach)
    hit, high = end.y <= 0.0, reach.copy()
    dips = np.flatnonzero(supercritical & ~hit & (v < 0.0) & (end.v > 0.0))
    if dips.size:
        h_min, y_min = turning_point(arc.take(dips), np.zeros(dips.size), reach[dips], 0.5 * reach[dips], -1.0)
        touched = ~(y_min > 0.0)
        hit[dips[touched]], high[dips[touched]] = True, h_min[touched]
    at = np.flatnonzero(hit)
    falling, lowest, highest = arc.take(at), low[at], high[at]
    guess = impact_guess(falling, Point(*(x[at] for x in end)), reach[at], lowest, highest)
    reach[at], impact_v = impact_root(falling, lowest, highest, guess)
    end.y[at], end.v[at], end.b[at] = 0.0, impact_v, falling.at_ground(reach[at])
    return Passage(arc, reach, cut, hit, end, low, rises, supercritical & ~(rises & crosses))


def raise_peaks(peak: Array, passage: Passage) -> None:
    """Raise the peaks to the turning points of these intervals (Lemmas 3 and 4)."""
    arc, end, low, high = passage.arc, passage.end, passage.low, passage.reach
    fall = np.maximum(arc.y - arc.b, arc.y - arc.b - arc.rate * high)
    at = np.flatnonzero((np.maximum(arc.y, end.y) + 0.125 * fall * high * high > peak) & ~passage.bare)
    if not at.size:
        return
    arc, low, high, up = arc.take(at), low[at], high[at], passage.rises[at]
    down = passage.hit[at] | (end.v[at] <= 0.0)
    sure = up & down
    slope = end.b[at]  # where v is convex its tangent at the end may prove that it keeps its sign
    hidden = np.flatnonzero(up & ~down & (arc.rate > 0.0) & (slope * (high - low) > _SURELY * end.v[at]))
    turn = hidden_turn(arc.take(hidden), low[hidden], high[hidden], 1.0)
    found = np.isfinite(turn)
    high[hidden[found]], sure[hidden[found]] = turn[found], True
    hidden = np.flatnonzero(~up & down & (arc.rate < 0.0) & (arc.v + arc.b * high > 0.0))
    turn = hidden_turn(arc.take(hidden), low[hidden], high[hidden], -1.0)
    found = np.isfinite(turn)
    low[hidden[found]], sure[hidden[found]] = turn[found], True
    turns = np.flatnonzero(sure)
    _, top = turning_point(arc.take(turns), low[turns], high[turns], 0.5 * (low[turns] + high[turns]), 1.0)
    peak[at[turns]] = np.maximum(peak[at[turns]], top)
