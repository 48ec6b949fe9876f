"""A lower bound: the engine's algorithm for one sine cycle and the linear equation, as
a scalar kernel compiled by numba.

Same windows, same flow, same roots, cell by cell in threads. It knows nothing but this
one motion.
"""

import math

import numpy as np
from numba import njit, prange

PI = math.pi


@njit(cache=False, inline="always")
def _flow(y0, v0, b, s, c, w, h):
    """y, v, b, j after h; the drive is a(0) + s sin(w h) - c (1 - cos(w h))."""
    half = math.sinh(0.5 * h)
    half2 = half * half
    cosh1, sinh = 2.0 * half2, 2.0 * half * math.sqrt(1.0 + half2)
    wh = w * h
    t = math.tan(0.5 * wh)
    t2 = t * t
    sin2 = t2 / (1.0 + t2)
    cosm, sinw = 2.0 * sin2, 2.0 * t / (1.0 + t2)
    over = 1.0 / (1.0 + w * w)
    f2 = 2.0 * w * (half2 + sin2) * over
    if max(h, wh) < 0.5:
        h2, w2, g = h * h, w * w, 1.0
        odd, even = w * h * h2 / 6.0, w2 * h2 * h2 / 24.0
        f3, f4 = odd, even
        for n in range(2, 9):
            g = 1.0 - w2 * g
            odd *= h2 / ((2 * n) * (2 * n + 1))
            even *= h2 / ((2 * n + 1) * (2 * n + 2))
            f3 += odd * g
            f4 += even * g
    else:
        f3, f4 = (w * sinh - sinw) * over, (w * w * cosh1 - cosm) * over
    y = y0 + v0 * sinh + b * cosh1 + s * f3 - c * f4
    v = v0 + v0 * cosh1 + b * sinh + s * f2 - c * w * f3
    return y, v, b + (y - y0) + s * sinw - c * cosm, v + w * (s - s * cosm - c * sinw)


@njit(cache=False)
def _impact(y0, v0, b0, s, c, w, low, high, h):
    """First h with y = 0 in (low, high], and v there."""
    for _ in range(200):
        y, v, b, j = _flow(y0, v0, b0, s, c, w, h)
        if y <= 0.0:
            high = h
        else:
            low = h
        r, e = y / v, b / v
        step = -r * (1.0 - 0.5 * r * e) / (1.0 - r * e + r * r * j / (6.0 * v))
        inside = v < 0.0 and low < h + step <= high
        size = abs(step)
        short = (
            size <= 1e-5 * h
            and size * (1.0 + w) <= 1e-5
            and size * abs(b) <= 1e-5 * abs(v)
        )
        if (
            (inside and short)
            or high - low <= 4e-16 * high
            or (v < 0.0 and size <= 4e-16 * h)
        ):
            d = step if inside else 0.0
            return h + d, min(0.0, v + d * (b + 0.5 * d * j))
        h = h + step if inside else 0.5 * (low + high)
    return math.nan, math.nan


@njit(cache=False)
def _turn(y0, v0, b0, s, c, w, low, high, sense):
    """y at the turning point in (low, high), and where it is."""
    h = 0.5 * (low + high)
    for _ in range(200):
        y, v, b, j = _flow(y0, v0, b0, s, c, w, h)
        if sense * v <= 0.0:
            high = h
        else:
            low = h
        step = -v / (b - 0.5 * v * j / b) if b != 0.0 else math.inf
        inside = sense * b < 0.0 and low <= h + step <= high
        if (
            inside
            and abs(step) * (1.0 + w) <= 1e-4
            and abs(step * j) <= 1e-3 * abs(b)
            and abs(step) <= 1e-3 * h
        ):
            return y + step * (v + step * (0.5 * b + step * j / 6.0)), h + step
        if high - low <= 4e-16 * high:
            return y, h
        h = h + step if inside else 0.5 * (low + high)
    return math.nan, math.nan


@njit(cache=False)
def _cell(amplitude, omega, eta):
    """(outcome, peak): 1 no uplift, 2 rocked, 3 and 4 overturned without and after
    impact.
    """
    if amplitude <= 1.0:
        return 1, 0.0
    psi = math.asin(1.0 / amplitude)
    phase, side, y, v, b, peak, impacts = psi, -1.0, 0.0, 0.0, 0.0, 0.0, 0
    end = 2.0 * PI
    while True:
        # On side -1 the drive lifts in the first half cycle, on side +1 in the second.
        first, last = (psi, PI - psi) if side < 0.0 else (PI + psi, 2.0 * PI - psi)
        on = phase if side < 0.0 else phase - PI
        ridge = first <= phase < last
        valley_at = 0.0
        if ridge and v >= 0.0:
            target, valley_at = end, (last - phase) / omega
            ridge = False
        else:
            target = last if ridge else (first if phase < first else end)
        # A valley whose drive rises at its end may hold a trough: stop where the drive
        # turns.
        bottom = 1.5 * PI if side < 0.0 else 0.5 * PI
        if not ridge and phase < bottom < target and bottom - phase > valley_at * omega:
            target = bottom
        h = (target - phase) / omega
        a, da = amplitude * math.sin(on), amplitude * math.cos(on)
        ye, ve, be, _ = _flow(y, v, b, da, a, omega, h)
        hit, reach = ye <= 0.0, h
        if ridge and not hit and v < 0.0 and ve > 0.0:
            low_y, at = _turn(y, v, b, da, a, omega, 0.0, h, -1.0)
            if not low_y > 0.0:
                hit, reach = True, at
        if hit:
            start = valley_at
            reach, vi = _impact(
                y, v, b, da, a, omega, start, reach, 0.5 * (start + reach)
            )
        if not ridge and (valley_at > 0.0 or v > 0.0) and (hit or ve <= 0.0):
            top, _ = _turn(y, v, b, da, a, omega, valley_at, reach, 1.0)
            peak = max(peak, top)
        if hit:
            phase += omega * reach
            side, y, v = -side, 0.0, -eta * vi
            impacts += 1
            on = phase if side < 0.0 else phase - PI
            drive = amplitude * math.sin(on)
            b = drive - 1.0
            gap = 1.0 - abs(drive)
            if v < 1e-100 or (gap > 0.0 and v < 1e-6 * gap):  # it comes to rest
                if phase < PI + psi and amplitude * abs(math.sin(phase)) <= 1.0:
                    phase, side, y, v, b = max(phase, PI + psi), 1.0, 0.0, 0.0, 0.0
                elif amplitude * abs(math.sin(phase)) > 1.0:
                    side = -1.0 if math.sin(phase) > 0.0 else 1.0
                    y, v, b = 0.0, 0.0, amplitude * abs(math.sin(phase)) - 1.0
                else:
                    return 2, peak
            if phase >= end:
                ye, ve = y, v
            else:
                continue
        elif target < end:
            phase, y, v, b = target, ye, ve, be
            inward = (
                amplitude
                if (side < 0.0 and phase <= 1.5 * PI)
                or (side > 0.0 and phase < 0.5 * PI)
                else 0.0
            )
            if side < 0.0 and phase > 1.5 * PI:
                inward = amplitude * abs(math.sin(phase))
            if y - 1.0 + v > inward:
                return (4 if impacts else 3), math.nan
            continue
        if ye - 1.0 + ve > 0.0:
            return (4 if impacts else 3), math.nan
        drop = ve * ve + ye * (2.0 - ye)
        rebound = eta * eta * drop
        if rebound > 1.0:
            return 4, math.nan
        crest = ye if ve <= 0.0 else drop / (1.0 + math.sqrt(max(0.0, 1.0 - drop)))
        return 2, max(peak, crest, rebound / (1.0 + math.sqrt(max(0.0, 1.0 - rebound))))


@njit(parallel=True, cache=False)
def sweep(amplitude, omega, eta):
    """theta_ratio and outcome, (frequencies, amplitudes)."""
    theta = np.empty((omega.size, amplitude.size))
    outcome = np.empty((omega.size, amplitude.size), dtype=np.uint8)
    for i in prange(omega.size):
        for j in range(amplitude.size):
            outcome[i, j], theta[i, j] = _cell(amplitude[j], omega[i], eta)
    return theta, outcome
