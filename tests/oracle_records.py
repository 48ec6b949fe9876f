"""An independent answer for many cells under a record: plain steps in lockstep, no code shared with the engine.

Every interval between samples is cut into equal parts, and where the outward drive rises through 1. On each the state follows from
cosh, sinh and the ramp as they stand in a textbook; an impact is a sign change of y between the ends of a part or at a minimum in it, a
crest one of v, both found by Newton's method in a bracket. Nothing is jumped, closed or proved: a bounce goes on until its speed is 1e-11.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

NO_UPLIFT, ROCKED, NO_IMPACT, AFTER_IMPACT = 1, 2, 3, 4
AT_REST = 1e-11


def _flow(y, v, a, rate, h):
    """y and v after h under the outward drive a + rate h."""
    pull, sinh, cosh1 = y - 1.0 + a, np.sinh(h), 2.0 * np.sinh(0.5 * h) ** 2
    return y + (v * sinh + pull * cosh1 + rate * (sinh - h)), v + ((v + rate) * cosh1 + pull * sinh)


def _first(y, v, a, rate, h, which):
    """The h at which y (which = 0) or v (which = 1) becomes negative: Newton's method in a bracket that only shrinks."""
    fall = 1.0 - np.minimum(a, a + rate * h)
    low, high, at = np.where((y == 0.0) & (fall > 0.0), 0.5 * v / fall, 0.0), h.copy(), h.copy()  # the start is a root of y too
    for _ in range(100 if h.size else 0):
        there = _flow(y, v, a, rate, at)
        slope = there[1] if which == 0 else there[0] - 1.0 + a + rate * at
        after = there[which] < 0.0
        low, high = np.where(after, low, at), np.where(after, at, high)
        newton = at - there[which] / slope
        following = np.where((newton > low) & (newton < high) & (slope < 0.0), newton, 0.5 * (low + high))
        settled = np.abs(following - at) <= 1e-15 * at
        at = following
        if settled.all():
            break
    return at


def lockstep(samples, step, amplitude, omega, eta, parts=1):
    """(outcome codes, max |theta|/alpha or NaN) of symmetric linear oscillators, all arguments but samples and step of shape (cells,)."""
    cells = amplitude.size
    side, y, v, peak = np.zeros(cells), np.zeros(cells), np.zeros(cells), np.zeros(cells)
    bounced, outcome = np.zeros(cells, dtype=bool), np.full(cells, NO_UPLIFT)
    strongest = np.abs(samples).max()
    with np.errstate(all="ignore"):
        for s0, s1 in pairwise(samples):
            for part in range(parts):
                left = np.full(cells, step / parts) / omega
                slope = amplitude * (s1 - s0) * omega / step
                drive = amplitude * (s0 + (s1 - s0) * part / parts)  # of the ground; outwards it is -side drive
                lanes = np.flatnonzero(outcome < NO_IMPACT)
                while lanes.size:
                    resting = lanes[side[lanes] == 0.0]
                    lifts = resting[np.abs(drive[resting]) > 1.0 + 1e-13]
                    later = resting[np.abs(drive[resting]) <= 1.0 + 1e-13]
                    ends = drive[later] + slope[later] * left[later]
                    wait = (np.sign(ends) - drive[later]) / slope[later]
                    rises = (np.abs(ends) > 1.0 + 1e-13) & (wait >= 0.0)
                    up = later[rises]
                    drive[up], left[up] = np.sign(ends[rises]), left[up] - wait[rises]
                    lifted = np.zeros(cells, dtype=bool)
                    lifted[up] = True  # and rising: no impact, whatever the last digit of y says
                    up = np.concatenate([lifts, up])
                    side[up], y[up], v[up], outcome[up] = -np.sign(drive[up]), 0.0, 0.0, ROCKED
                    lanes = lanes[side[lanes] != 0.0]
                    now = (y[lanes], v[lanes], -side[lanes] * drive[lanes], -side[lanes] * slope[lanes])
                    one = (1.0 - now[2]) / now[3]  # where the drive rises through 1 a body may fall and lift between the ends
                    span = np.where((now[2] < 1.0) & (one > 0.0) & (one < left[lanes]), one, left[lanes])
                    end_y, end_v = _flow(*now, span)
                    down = (end_y < 0.0) & ~lifted[lanes]
                    reach = span.copy()
                    dips = np.flatnonzero((now[1] < 0.0) & (end_v > 0.0) & ~down)  # a minimum within the part may touch the ground
                    there = [x[dips] for x in now]
                    low, high = np.zeros(dips.size), reach[dips]
                    for _ in range(50 if dips.size else 0):
                        middle = 0.5 * (low + high)
                        sinks = _flow(*there, middle)[1] < 0.0
                        low, high = np.where(sinks, middle, low), np.where(sinks, high, middle)
                    touches = _flow(*there, low)[0] < 0.0
                    reach[dips[touches]], down[dips[touches]] = low[touches], True
                    reach[down] = _first(*(x[down] for x in now), reach[down], 0)
                    falls = np.flatnonzero((now[1] >= 0.0) & (_flow(*now, reach)[1] < 0.0))
                    there = [x[falls] for x in now]
                    top = _flow(*there, _first(*there, reach[falls], 1))[0]
                    peak[lanes[falls]] = np.maximum(peak[lanes[falls]], top)
                    peak[lanes] = np.maximum(peak[lanes], np.where(down, 0.0, end_y))
                    hit, free = lanes[down], lanes[~down]
                    y[free], v[free] = end_y[~down], end_v[~down]
                    v[hit] = -eta[hit] * _flow(*(x[down] for x in now), reach[down])[1]
                    left[lanes] -= reach
                    drive[lanes] += slope[lanes] * reach
                    y[hit], side[hit], bounced[hit] = 0.0, -side[hit], True
                    still = hit[v[hit] < AT_REST]
                    side[still] = 0.0
                    over = free[y[free] - 1.0 + v[free] > amplitude[free] * strongest]
                    outcome[over] = np.where(bounced[over], AFTER_IMPACT, NO_IMPACT)
                    lanes = np.concatenate([hit, free[left[free] > 1e-14]])
    air = np.flatnonzero((outcome == ROCKED) & (side != 0.0))
    over = y[air] - 1.0 + v[air] > 0.0
    outcome[air[over]] = np.where(bounced[air[over]], AFTER_IMPACT, NO_IMPACT)
    air = air[~over]
    energy = v[air] ** 2 - (1.0 - y[air]) ** 2  # constant on still ground
    rebound = eta[air] ** 2 * (1.0 + energy)
    outward = np.where(v[air] > 0.0, 1.0 - np.sqrt(-energy), y[air])
    outcome[air[rebound > 1.0]] = AFTER_IMPACT
    with np.errstate(invalid="ignore"):
        peak[air] = np.maximum(peak[air], np.maximum(outward, 1.0 - np.sqrt(1.0 - rebound)))
    return outcome, np.where(outcome >= NO_IMPACT, np.nan, peak)
