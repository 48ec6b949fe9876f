"""An independent answer for a single cell: SciPy's DOP853 at the limit of double precision, no code shared with the engine.

It integrates y'' = y - 1 + a in short pieces between the drive's quarter turns, looks for impacts by sign changes on
dense output, and applies the contact rules in plain Python.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def _ground(t: float, z: np.ndarray) -> float:
    return z[0]


def _turn(t: float, z: np.ndarray) -> float:
    return z[1]


_ground.terminal, _ground.direction, _turn.direction = True, -1, -1


def integrate(
    s: Callable[[float], float],
    phase_end: float,
    amplitude: float,
    omega: float,
    eta: float,
    breaks: tuple[float, ...] = (),
    pieces_a_turn: int = 16,
) -> tuple[str, float, int]:
    """Outcome flag, max |theta|/alpha (NaN where overturned) and impacts during the shaking.

    `s(phase)` is the motion, `breaks` the phases where it jumps (s is then evaluated just inside each piece).
    """

    def excess(phase: float) -> float:
        return amplitude * abs(s(phase)) - 1.0

    fine = np.linspace(0.0, phase_end, 40_001)
    marks = sorted({0.0, phase_end, *breaks, *np.arange(0.0, phase_end, 2 * math.pi / pieces_a_turn)})
    end = phase_end / omega
    time, side, y, v, peak, impacts = 0.0, 0, 0.0, 0.0, 0.0, 0
    while True:
        if side == 0:  # at rest: find the next uplift
            now = [x for x in fine if x / omega > time] if time > 0.0 else list(fine)
            lift = None
            before = time * omega
            for x in now:
                inside = min(max(x, 1e-13), phase_end * (1 - 1e-15))
                if amplitude * abs(s(inside)) > 1.0:
                    lift = brentq(excess, before, x, xtol=1e-15) if x > before and excess(before) < 0.0 else before
                    side = -int(np.sign(s(inside)))
                    break
                before = x
            if lift is None:
                return ("rocked" if peak > 0.0 else "no_uplift"), peak, impacts
            time, y, v = lift / omega, 0.0, 0.0
        nxt = next((m / omega for m in marks if m / omega > time * (1 + 1e-14) + 1e-15), None)
        if nxt is None:
            break
        low, high = time * omega, nxt * omega

        def rate(t: float, z: np.ndarray, low: float = low, high: float = high, side: int = side) -> list[float]:
            phase = min(max(omega * t, low + 1e-14 * high), high * (1 - 1e-15))
            return [z[1], z[0] - 1.0 - side * amplitude * s(phase)]

        part = solve_ivp(rate, (time, nxt), [y, v], method="DOP853", rtol=2.3e-14, atol=1e-18,
                         events=[_ground, _turn], max_step=(nxt - time) / 4)  # fmt: skip
        assert part.success, part.message
        for at in part.t_events[1]:  # dense output has a lower order: integrate again to the event, then correct
            z, accel = _state(rate, time, at, y, v)
            peak = max(peak, z[0] - z[1] ** 2 / (2 * accel))
        if part.status == 1:
            at = part.t_events[0][0]
            z, accel = _state(rate, time, at, y, v)
            time, v = at - z[0] / z[1], z[1] - accel * z[0] / z[1]
            impacts += 1
            side, y, v = -side, 0.0, -eta * v
            drive = -side * amplitude * s(time * omega)
            if v == 0.0 or (eta < 1.0 and v < 1e-9 and abs(drive) < 0.999):
                side, v = 0, 0.0
        else:
            time, y, v = nxt, *part.y[:, -1]
            if y - 1 + v > 1e3 * (1 + amplitude):
                return ("overturned_after_impact" if impacts else "overturned_no_impact"), math.nan, impacts
        if time >= end * (1 - 1e-15):
            break
    if side == 0:
        return "rocked", peak, impacts
    if y - 1 + v > 0.0:
        return ("overturned_after_impact" if impacts else "overturned_no_impact"), math.nan, impacts
    energy = v * v - (1 - y) ** 2
    if v > 0.0:
        peak = max(peak, 1 - math.sqrt(-energy))
    rebound = eta * eta * (1 + energy)
    if rebound > 1.0:
        return "overturned_after_impact", math.nan, impacts
    return "rocked", max(peak, 1 - math.sqrt(1 - rebound)), impacts


def _state(rate: Callable[[float, np.ndarray], list[float]], start: float, stop: float, y: float, v: float) -> tuple[np.ndarray, float]:
    if stop <= start:
        return np.array([y, v]), rate(stop, np.array([y, v]))[1]
    part = solve_ivp(rate, (start, stop), [y, v], method="DOP853", rtol=2.3e-14, atol=1e-18, max_step=(stop - start) / 4)
    return part.y[:, -1], rate(stop, part.y[:, -1])[1]
