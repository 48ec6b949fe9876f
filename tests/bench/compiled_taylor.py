"""The engine's algorithm for one sine cycle and a rigid body (Eq. 2.3) as a scalar kernel compiled by numba: Taylor series, cell by cell.

Same windows, same recurrences, same control of the step, same roots; order and arithmetic are what is fastest for one cell at a time. It
knows nothing but this one motion and finds no turn that hides between two ends of a step.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

PI = math.pi
LOCAL = 3e-2  # of the tolerance, as in `dynamics.equations.taylor`


@njit(cache=False, fastmath=True)
def _series(c, sin, cos, rate, push, order, y, v, b, side, amplitude, omega, phase, sa, ca, alpha, tol):
    """Fill c with the terms of y in powers of (1 + omega) h; returns how far they reach.

    sin and cos stand from the last place downwards, so that all rows of a sum are read forwards.
    """
    last = order
    unit = 1.0 / (1.0 + omega)
    z = alpha - sa * y
    sin[last], cos[last] = math.sin(z), math.cos(z)
    outward = -side * amplitude
    x = omega * unit
    push[0] = (b + sin[last] / sa) * ca / cos[last]
    push[1] = outward * math.cos(phase) * x
    push[2] = -0.5 * outward * math.sin(phase) * x * x
    for n in range(3, order):
        push[n] = -push[n - 2] * x * x / (n * (n - 1))
    unit2 = unit * unit
    back, forth = unit2 / sa, unit2 / ca
    c[0], c[1] = y, v * unit
    for n in range(order - 1):
        at = last - n
        f = 0.0
        if n:
            rate[n] = -sa * n * c[n]
            s, t = 0.0, 0.0
            for i in range(1, n + 1):
                s += rate[i] * cos[at + i]
                t += rate[i] * sin[at + i]
                f += push[i] * cos[at + i]
            sin[at], cos[at] = s / n, -t / n
        f += push[0] * cos[at]
        c[n + 2] = (forth * f - back * sin[at]) / ((n + 1) * (n + 2))
    reach = 4.0 / unit
    for n in range(order - 3, order + 1):
        size = n * abs(c[n]) / unit
        if size > 0.0:
            reach = min(reach, math.exp(math.log(LOCAL * tol / size) / (n - 1)))
    return reach * unit


@njit(cache=False, inline="always")
def _at(c, order, unit, h):
    """y, v, b, j after h, by Horner's rule."""
    x = h / unit
    y, v, b, j = c[order], 0.0, 0.0, 0.0
    for n in range(order - 1, -1, -1):
        j = j * x + b
        b = b * x + v
        v = v * x + y
        y = y * x + c[n]
    return y, v / unit, 2.0 * b / unit**2, 6.0 * j / unit**3


@njit(cache=False)
def _impact(c, order, unit, low, high, h, fastest):
    """First h with y = 0 in (low, high], with v and b there."""
    for _ in range(200):
        y, v, b, j = _at(c, order, unit, h)
        if y <= 0.0:
            high = h
        else:
            low = h
        r, e = y / v, b / v
        step = -r * (1.0 - 0.5 * r * e) / (1.0 - r * e + r * r * j / (6.0 * v))
        inside = v < 0.0 and low < h + step <= high
        size = abs(step)
        short = size <= 3e-6 * h and size * fastest <= 3e-6 and size * abs(b) <= 3e-6 * abs(v)
        if (inside and short) or high - low <= 4e-16 * high or (v < 0.0 and size <= 4e-16 * h):
            d = step if inside else 0.0
            return h + d, min(0.0, v + d * (b + 0.5 * d * j)), b + d * j
        h = h + step if inside else 0.5 * (low + high)
    return math.nan, math.nan, math.nan


@njit(cache=False)
def _turn(c, order, unit, low, high, sense, fastest):
    """y at the turning point in (low, high), and where it is."""
    h = 0.5 * (low + high)
    for _ in range(200):
        y, v, b, j = _at(c, order, unit, h)
        if sense * v <= 0.0:
            high = h
        else:
            low = h
        step = -v / (b - 0.5 * v * j / b) if b != 0.0 else math.inf
        inside = sense * b < 0.0 and low <= h + step <= high
        if inside and abs(step) * fastest <= 1e-3 and abs(step * j) <= 1e-2 * abs(b) and abs(step) <= 3e-3 * h:
            return y + step * (v + step * (0.5 * b + step * j / 6.0)), h + step
        if high - low <= 4e-16 * high:
            return y, h
        h = h + step if inside else 0.5 * (low + high)
    return math.nan, math.nan


@njit(cache=False)
def _cell(a_given, omega, eta, alpha, tol, order, work):
    """(outcome, peak theta/alpha): 1 no uplift, 2 rocked, 3 and 4 overturned without and after impact."""
    sa, ca, ta = math.sin(alpha), math.cos(alpha), math.tan(alpha)
    amplitude = a_given * alpha / ta
    if amplitude <= 1.0:
        return 1, 0.0
    c, sin, cos, rate, push = work[0], work[1], work[2], work[3], work[4]
    psi = math.asin(1.0 / amplitude)
    phase, side, y, v, b, peak, impacts = psi, -1.0, 0.0, 0.0, 0.0, 0.0, 0
    end, unit, fastest = 2.0 * PI, 1.0 / (1.0 + omega), 1.0 + omega
    barrier = 1.0 / (1.0 + ca)
    while True:
        # On side -1 the drive lifts in the first half cycle, on side +1 in the second.
        first, last = (psi, PI - psi) if side < 0.0 else (PI + psi, 2.0 * PI - psi)
        ridge = first <= phase < last
        valley_at = 0.0
        longest = _series(c, sin, cos, rate, push, order, y, v, b, side, amplitude, omega, phase, sa, ca, alpha, tol)
        if ridge and v >= 0.0 and (last - phase) / omega < longest:
            target, valley_at = end, (last - phase) / omega
            ridge = False
        else:
            target = last if ridge else (first if phase < first else end)
        # A valley whose drive rises at its end may hold a trough: stop where the drive turns.
        bottom = 1.5 * PI if side < 0.0 else 0.5 * PI
        if not ridge and phase < bottom < target and bottom - phase > valley_at * omega:
            target = bottom
        h = (target - phase) / omega
        if h > longest:
            h = longest
            target = phase + h * omega
        ye, ve, be, _ = _at(c, order, unit, h)
        hit, reach = ye <= 0.0, h
        if ridge and not hit and v < 0.0 and ve > 0.0:
            low_y, at = _turn(c, order, unit, 0.0, h, -1.0, fastest)
            if not low_y > 0.0:
                hit, reach = True, at
        if hit:
            guess = 0.5 * (valley_at + reach)
            if b < 0.0:
                ballistic = (v + math.sqrt(max(0.0, v * v - 2.0 * b * y))) / -b
                if valley_at < ballistic < reach:
                    guess = ballistic
            reach, vi, bi = _impact(c, order, unit, valley_at, reach, guess, fastest)
        if not ridge and (valley_at > 0.0 or v > 0.0) and (hit or ve <= 0.0):
            top, _ = _turn(c, order, unit, valley_at, reach, 1.0, fastest)
            peak = max(peak, top)
        if hit:
            phase += omega * reach
            side, y, v = -side, 0.0, -eta * vi
            impacts += 1
            b = -2.0 - bi
            drive = 1.0 + b
            gap = 1.0 - abs(drive)
            if v < 1e-100 or (gap > 0.0 and v < 1e-6 * gap):  # it comes to rest
                s = math.sin(phase)
                if amplitude * abs(s) > 1.0:
                    side, y, v, b = (-1.0 if s > 0.0 else 1.0), 0.0, 0.0, amplitude * abs(s) - 1.0
                elif phase < PI + psi:
                    phase, side, y, v, b = PI + psi, 1.0, 0.0, 0.0, 0.0
                else:
                    return 2, peak * sa / alpha
            if phase < end:
                continue
            ye, ve = y, v
        elif target < end:
            phase, y, v, b = target, ye, ve, be
            inward = 0.0
            if (side < 0.0 and phase <= 1.5 * PI) or (side > 0.0 and phase < 0.5 * PI):
                inward = amplitude
            elif side < 0.0:
                inward = amplitude * abs(math.sin(phase))
            e = inward * ta
            left = alpha + math.atan(e) - sa * y
            half = math.sin(0.5 * left)
            if (v > 0.0 and (left <= 0.0 or 0.5 * v * v > 2.0 / sa**2 * math.sqrt(1.0 + e * e) * half * half)) or sa * y >= 0.5 * PI:
                return (4 if impacts else 3), math.nan
            continue
        turned = sa * ye
        level = 0.5 * ve * ve + 2.0 * math.sin(alpha - 0.5 * turned) * math.sin(0.5 * turned) / sa**2
        if (turned > alpha and (ve >= 0.0 or level < barrier)) or (turned <= alpha and ve > 0.0 and level > barrier):
            return (4 if impacts else 3), math.nan
        rebound = eta * eta * level
        if rebound > barrier:
            return 4, math.nan
        bottom = 2.0 * math.sin(0.5 * alpha) ** 2
        top = rebound if ve <= 0.0 else level
        crest = (alpha - 2.0 * math.asin(math.sqrt(0.5 * max(0.0, bottom - sa**2 * top)))) / sa
        return 2, max(peak, crest, ye if ve <= 0.0 else 0.0) * sa / alpha


@njit(parallel=True, cache=False)
def sweep(amplitude, omega, eta, alpha, tol, order):
    """theta_ratio and outcome, (frequencies, amplitudes)."""
    theta = np.empty((omega.size, amplitude.size))
    outcome = np.empty((omega.size, amplitude.size), dtype=np.uint8)
    for i in prange(omega.size):
        work = np.zeros((5, order + 2))
        for j in range(amplitude.size):
            outcome[i, j], theta[i, j] = _cell(amplitude[j], omega[i], eta, alpha, tol, order, work)
    return theta, outcome


ORDER = 24  # terms at a tolerance of 1e-9: 14 ... 26 tried, 20 and above are within 3 %
