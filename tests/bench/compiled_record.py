"""A scalar kernel, compiled by numba, that walks through the samples of a record: what a careful programmer would write first.

Symmetric linear oscillators. The step between samples is a constant matrix; an impact is looked for where y changes sign or where a
dip is possible, a crest where v changes sign; bodies at rest skip to their next uplift, and what nothing can bring back is left.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange


@njit(cache=False, inline="always")
def _flow(y, v, b, r, h):
    """y and v after h under the drive whose force is b now and grows by r."""
    sinh = math.sinh(h)
    half = math.sinh(0.5 * h)
    cosh1 = 2.0 * half * half
    ramp = h * h * h * (1.0 / 6.0) * (1.0 + h * h * 0.05 * (1.0 + h * h / 42.0 * (1.0 + h * h / 72.0))) if h < 0.3 else sinh - h
    return y + v * sinh + b * cosh1 + r * ramp, v + (v + r) * cosh1 + b * sinh


@njit(cache=False)
def _root(y, v, b, r, h, which):
    """The h at which y (0) or v (1) falls through zero."""
    start = 0.5 * v / max(-b, -(b + r * h)) if which == 0 and y == 0.0 and min(b, b + r * h) < 0.0 else 0.0
    low, high, at = start, h, h
    if which == 0 and b < 0.0:
        at = min(h, (v + math.sqrt(max(0.0, v * v - 2.0 * b * y))) / -b)
    for _ in range(80):
        ye, ve = _flow(y, v, b, r, at)
        value, slope = (ye, ve) if which == 0 else (ve, ye - y + b + r * at)
        if value < 0.0:
            high = at
        else:
            low = at
        following = at - value / slope if slope < 0.0 else 0.5 * (low + high)
        if not (low <= following <= high):
            following = 0.5 * (low + high)
        if abs(following - at) <= 1e-14 * at:
            return following
        at = following
    return at


@njit(cache=False)
def _cell(s, later, step, amplitude, omega, eta):
    """(outcome, peak)."""
    last = s.size - 1
    pace = step / omega
    sinh, half = math.sinh(pace), math.sinh(0.5 * pace)
    cosh1 = 2.0 * half * half
    ramp = pace**3 / 6.0 * (1.0 + pace**2 / 20.0 * (1.0 + pace**2 / 42.0 * (1.0 + pace**2 / 72.0))) if pace < 0.3 else sinh - pace
    k, x, side, y, v, peak, bounced, rocked = 0, 0.0, 0.0, 0.0, 0.0, 0.0, False, False
    while k < last:
        if side == 0.0:
            while k < last and amplitude * max(abs(s[k] + (s[k + 1] - s[k]) * x), abs(s[k + 1])) <= 1.0:
                k, x = k + 1, 0.0
            if k >= last:
                break
            now, end = s[k] + (s[k + 1] - s[k]) * x, s[k + 1]
            if amplitude * abs(now) <= 1.0:
                x = max(x, (math.copysign(1.0 / amplitude, end) - s[k]) / (end - s[k]))
                now = end
            side, rocked, y, v = (-1.0 if now > 0.0 else 1.0), True, 0.0, 0.0
        c = -side * amplitude
        r = c * (s[k + 1] - s[k]) / pace
        a = c * (s[k] + (s[k + 1] - s[k]) * x)
        b = y - 1.0 + a
        if x == 0.0:
            h, ye, ve = pace, y + v * sinh + b * cosh1 + r * ramp, v + (v + r) * cosh1 + b * sinh
        else:
            h = pace * (1.0 - x)
            ye, ve = _flow(y, v, b, r, h)
        end_a = c * s[k + 1]
        cut = False
        if (v < 0.0 and end_a > 1.0 and a < 1.0 and y + v * h < 0.5 * h * h * (1.0 - a)) or (y == 0.0 and end_a > 1.0 and a < 1.0 - 1e-12):
            one = (1.0 - a) / r  # a dip may hide where the drive rises through 1
            if one < h:
                h, cut = one, True
                ye, ve = _flow(y, v, b, r, h)
        hit = ye < 0.0 and not (y == 0.0 and v == 0.0 and r > 0.0)
        if not hit and v < 0.0 and ve > 0.0 and a >= 1.0 - 1e-12:
            low, high = 0.0, h
            for _ in range(50):
                middle = 0.5 * (low + high)
                if _flow(y, v, b, r, middle)[1] < 0.0:
                    low = middle
                else:
                    high = middle
            if _flow(y, v, b, r, low)[0] < 0.0:
                hit, h = True, low
        if hit:
            h = _root(y, v, b, r, h, 0)
            ve = _flow(y, v, b, r, h)[1]
        if v >= 0.0 and ve < 0.0 and max(y, ye) + 0.5 * v * h > peak:
            turn = _root(y, v, b, r, h, 1)
            peak = max(peak, _flow(y, v, b, r, turn)[0])
        if hit:
            x += h / pace
            v, y, side, bounced = -eta * ve, 0.0, -side, True
            a = -(a + r * h)
            gap = 1.0 - abs(a)
            if v < 1e-100 or (gap > 0.0 and v < 1e-6 * gap and eta < 1.0):
                side, v = 0.0, 0.0
            if x >= 1.0:
                k, x = k + 1, x - 1.0
            continue
        y, v = ye, ve
        peak = max(peak, y)
        if cut:
            x += h / pace
            continue
        k, x = k + 1, 0.0
        if y - 1.0 + v > 0.0 and y - 1.0 + v > amplitude * later[k]:
            return (4 if bounced else 3), math.nan
    if side == 0.0:
        return (2 if rocked else 1), peak
    if y - 1.0 + v > 0.0:
        return (4 if bounced else 3), math.nan
    drop = v * v + y * (2.0 - y)
    rebound = eta * eta * drop
    if rebound > 1.0:
        return 4, math.nan
    crest = y if v <= 0.0 else drop / (1.0 + math.sqrt(max(0.0, 1.0 - drop)))
    return 2, max(peak, crest, rebound / (1.0 + math.sqrt(max(0.0, 1.0 - rebound))))


@njit(parallel=True, cache=False)
def sweep(s, later, step, amplitude, omega, eta):
    """theta_ratio and outcome, (frequencies, amplitudes); later: max |s| from each sample on."""
    theta = np.empty((omega.size, amplitude.size))
    outcome = np.empty((omega.size, amplitude.size), dtype=np.uint8)
    for i in prange(omega.size):
        for j in range(amplitude.size):
            outcome[i, j], theta[i, j] = _cell(s, later, step, amplitude[j], omega[i], eta)
    return theta, outcome
