"""An independent answer for a single cell: SciPy's DOP853 at the limit of double precision, no code shared with the engine.

It integrates y'' = y - 1 + a in short pieces between the drive's quarter turns, looks for impacts by sign changes on
dense output, and applies the contact rules in plain Python.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rocking_cli import linear_response
from rocking_cli.dynamics.response import Response
from rocking_cli.motions import Motion, Piece

# One sine cycle, linear, eta = 0.9: overturning after impact from, to; without impact from (traced by two independent
# programs and the closed form of Fig. 2; given to the digits shown).
INTERVALS = [
    (2.0, 1.2252, 2.3144, 2.3499, 1e-4),
    (3.0, 1.4036, 3.4847, 3.6311, 1e-4),
    (4.0, 1.7954, 4.8501, 5.2390, 1e-4),
    (5.0, 3.01860, 6.31807, 7.16813, 1e-5),
    (6.0, 5.1642, 7.6699, 9.4170, 1e-4),
]

LADDER = Motion("ladder", (Piece(0, 1, (), 0.5, -1.2), Piece(1, 2.5, (), 1.0), Piece(2.5, 4, (), -0.5), Piece(4, 6, (), -0.9, 0.9)))


def ladder(q: float) -> float:
    """The motion LADDER by its formula: a ramp, two plateaus, a ramp."""
    return 0.5 - 1.2 * q if q < 1 else 1.0 if q < 2.5 else -0.5 if q < 4 else -0.9 + 0.9 * (q - 4)


RTOL = 2.3e-14  # of the oracle's steps, the least that SciPy takes


def condition(
    motion: Motion, amplitude: np.ndarray, omega: np.ndarray, eta: np.ndarray, respond: Callable[..., Response] = linear_response
) -> np.ndarray:
    """|theta| + |dtheta/dlog A| + |dtheta/dlog Omega| + |dtheta/dlog eta|, theta over alpha, of cells by `respond`.

    What relative errors of the size e, made anywhere on the way, may come to at the end is this times e: with it a tolerance
    follows from the cell. Central differences over 1e-7; NaN next to a boundary of outcome.
    """
    cell = np.broadcast_arrays(amplitude, omega, eta)
    total = np.abs(respond(motion, *cell).theta_ratio)
    for k in range(3):
        low, high = list(cell), list(cell)
        low[k], high[k] = cell[k] * (1.0 - 1e-7), cell[k] * (1.0 + 1e-7)
        if k == 2:
            high[k] = np.minimum(high[k], 1.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            slope = (respond(motion, *high).theta_ratio - respond(motion, *low).theta_ratio) / (high[k] - low[k])
        total = total + np.abs(np.where(cell[k] == 0.0, 0.0, slope * cell[k]))
    return total


def _inside(phase: float, phase_end: float) -> float:
    return min(max(phase, 1e-13), phase_end * (1 - 1e-15))


@lru_cache(maxsize=8)
def _samples(s: Callable[[float], float], phase_end: float) -> tuple[np.ndarray, np.ndarray]:
    """40,001 phases from 0 to the end, and |s| there."""
    fine = np.linspace(0.0, phase_end, 40_001)
    return fine, np.array([abs(s(_inside(float(x), phase_end))) for x in fine])


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

    fine, strength = _samples(s, phase_end)
    marks = sorted({0.0, phase_end, *breaks, *np.arange(0.0, phase_end, 2 * math.pi / pieces_a_turn)})
    end = phase_end / omega
    time, side, y, v, peak, impacts = 0.0, 0, 0.0, 0.0, 0.0, 0
    while True:
        if side == 0:  # at rest: find the next uplift
            lift = None
            after = np.flatnonzero((amplitude * strength > 1.0) & ((fine / omega > time) | (time == 0.0)))
            if after.size:
                x, before = fine[after[0]], max(time * omega, fine[max(after[0] - 1, 0)])
                lift = brentq(excess, before, x, xtol=1e-15) if x > before and excess(before) < 0.0 else before
                side = -int(np.sign(s(_inside(x, phase_end))))
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

        part = solve_ivp(rate, (time, nxt), [y, v], method="DOP853", rtol=RTOL, atol=1e-18,
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
    part = solve_ivp(rate, (start, stop), [y, v], method="DOP853", rtol=RTOL, atol=1e-18, max_step=(stop - start) / 4)
    return part.y[:, -1], rate(stop, part.y[:, -1])[1]


def integrate_rigid_body(
    s: Callable[[np.ndarray], np.ndarray], phase_end: float, amplitude: float, omega: float, eta: float, alpha: float
) -> tuple[str, float]:
    """Outcome flag and max |theta|/alpha by DOP853 at the limit of double precision on theta itself."""
    drive, end, turn = amplitude * alpha, phase_end / omega, math.pi / (8 * omega)
    fine = np.linspace(0.0, phase_end, 100_001)
    over = drive * np.abs(s(fine)) > math.tan(alpha)
    time, side, y, v, peak, bounced = 0.0, 0, 0.0, 0.0, 0.0, False
    tight = {"method": "DOP853", "rtol": RTOL, "atol": 1e-17}
    while time < end * (1 - 1e-14):
        if side == 0:
            after = np.flatnonzero(over & (fine >= time * omega))
            if not after.size:
                return ("rocked" if peak else "no_uplift"), peak / alpha
            i, at = after[0], fine[after[0]]
            if i and not over[i - 1]:
                at = brentq(lambda q: drive * abs(s(q)) - math.tan(alpha), fine[i - 1], at, xtol=1e-15)
            time, side, y, v = at / omega, -int(np.sign(s(min(at + 1e-9, phase_end - 1e-12)))), 0.0, 0.0
        stop = min(end, (math.floor(time / turn + 1e-9) + 1) * turn)

        def rate(t, z, side=side):
            return [z[1], -math.sin(alpha - z[0]) - side * drive * s(omega * t) * math.cos(alpha - z[0])]

        ground, crest = (lambda t, z: z[0]), (lambda t, z: z[1])
        ground.terminal, ground.direction, crest.direction = True, -1, -1
        path = solve_ivp(rate, (time, stop), [y, v], events=[ground, crest], max_step=(stop - time) / 6, **tight)

        def state(at, time=time, y=y, v=v, rate=rate):
            return solve_ivp(rate, (time, at), [y, v], max_step=(at - time) / 6, **tight).y[:, -1]

        for at in path.t_events[1][path.t_events[1] > time]:
            z = state(at)
            peak = max(peak, z[0] - z[1] ** 2 / (2 * rate(at, z)[1]))
        if path.status == 1:
            at = path.t_events[0][0]
            z = state(at)
            time, v = at - z[0] / z[1], -eta * (z[1] - rate(at, z)[1] * z[0] / z[1])
            y, side, bounced = 0.0, -side, True
            if v < 1e-10 and drive * abs(s(omega * time)) < 0.999 * math.tan(alpha):
                side, v = 0, 0.0
        else:
            time, (y, v) = stop, path.y[:, -1]
        if y > math.pi / 2:
            return ("overturned_after_impact" if bounced else "overturned_no_impact"), math.nan
    if side == 0:
        return "rocked", peak / alpha
    level = v * v / 2 + math.cos(alpha - y)
    if (y < alpha and v > 0 and level > 1) or (y > alpha and (v > 0 or level < 1)):
        return ("overturned_after_impact" if bounced else "overturned_no_impact"), math.nan
    back = math.cos(alpha) + eta**2 * (level - math.cos(alpha))
    if back > 1:
        return "overturned_after_impact", math.nan
    crests = [peak, alpha - math.acos(back)] + ([alpha - math.acos(level)] if v > 0 else [])
    return "rocked", max(crests) / alpha
