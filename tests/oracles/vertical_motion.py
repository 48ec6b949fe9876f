"""An independent answer for a body whose weight varies: SciPy's DOP853 with events, in SI units, no code of the package.

    nonlinear   u'' = -p^2 [w sin(alpha - u) + s xg/g cos(alpha - u)] - 2 zeta p u'
    linear      u'' = -p^2 [w (alpha - u) + s a_scale xg/g] - 2 zeta p u',   w = 1 + zg/g

with u = |theta| and s its sign. The bodies are those of `oracle_systems`.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from oracles.collocation import Body
from scipy.integrate import OdeSolution, solve_ivp
from scipy.optimize import brentq

REST = 1e-8  # of alpha p
MOST_ARCS = 800


class Shaking(NamedTuple):
    """xg and zg [m/s2] as functions of t [s], which end at `end` and jump, or bend, at `marks`."""

    across: Callable[[float], float]
    up: Callable[[float], float]
    end: float
    marks: tuple[float, ...]


class Crossing(NamedTuple):
    """Event: a component of the state passes a level."""

    component: int
    level: float
    direction: int
    terminal: bool

    def __call__(self, _t: float, state: np.ndarray) -> float:
        return float(state[self.component]) - self.level


class Answer(NamedTuple):
    """Outcome flag, max of |theta|/alpha of the side it is on (NaN unless it stays), impacts during the shaking."""

    outcome: str
    rotation: float
    impacts: int


def acceleration(body: Body, side: int, u: float, v: float, across: float, up: float) -> float:
    edge, weight = body.edge(side), 1.0 + up / body.gravity
    if body.nonlinear:
        push = weight * math.sin(edge.alpha - u) + side * across / body.gravity * math.cos(edge.alpha - u)
    else:
        push = weight * (edge.alpha - u) + side * edge.a_scale * across / body.gravity
    return -(edge.p**2) * push - 2.0 * body.damping * edge.p * v


def lifted(body: Body, shaking: Shaking, t: float) -> tuple[float, int] | None:
    """Instant and side of the first uplift at or after t."""
    sides = [1] if body.left is None else [1, -1]

    def excess(x: float, side: int) -> float:
        return acceleration(body, side, 0.0, 0.0, shaking.across(x), shaking.up(x))

    for stop in (*(m for m in shaking.marks if m > t), shaking.end):
        times = np.linspace(t, stop, 400)
        times[0], times[-1] = t + 1e-13 * (stop - t), stop - 1e-13 * (stop - t)
        found = []
        for side in sides:
            over = np.array([excess(x, side) for x in times])
            first = int(np.argmax(over > 0.0))
            if over[first] > 0.0:
                found.append((t if first == 0 else brentq(excess, times[first - 1], times[first], (side,), xtol=1e-15), side))
        if found:
            return min(found)
        t = stop
    return None


def swing(
    body: Body,
    shaking: Shaking,
    seen: Callable[[int, OdeSolution], None] | None = None,
    rested: Callable[[float, float], None] | None = None,
    still_impacts: int = 2,
) -> Answer:
    """What becomes of a body at rest; seen: called with the side and (u, u') over t of every stretch of it, rested: with the ends of its
    rests; still_impacts: to be followed after the shaking."""
    t, side, u, v, peak, impacts, after = 0.0, 0, 0.0, 0.0, 0.0, 0, 0
    for _ in range(MOST_ARCS):
        if side == 0:
            lift = lifted(body, shaking, t)
            if rested is not None:
                rested(t, shaking.end if lift is None else lift[0])
            if lift is None:
                return Answer("rocked" if peak else "no_uplift", peak, impacts)
            (t, side), u, v = lift, 0.0, 0.0
        edge = body.edge(side)
        still = t >= shaking.end * (1.0 - 1e-12)
        stop = t + 40.0 / edge.p if still else min(m for m in (*shaking.marks, shaking.end) if m > t * (1.0 + 1e-13) + 1e-13)

        def rate(x: float, state: np.ndarray, side: int = side, still: bool = still) -> list[float]:
            ground = (0.0, 0.0) if still else (shaking.across(x), shaking.up(x))
            return [state[1], acceleration(body, side, state[0], state[1], *ground)]

        limit = 0.5 * math.pi if body.nonlinear else 40.0 * edge.alpha
        events = (Crossing(0, 0.0, -1, True), Crossing(1, 0.0, -1, False), Crossing(0, limit, 1, True))
        slope = rate(t, np.array([u, v]))[1]
        first = min(0.02 / edge.p, stop - t, 0.3 * v / abs(slope) if u == 0.0 < v and slope < 0.0 else math.inf)
        path = solve_ivp(rate, (t, stop), [u, v], method="DOP853", rtol=1e-13, atol=1e-16, events=events,
                         first_step=first, max_step=0.1 / edge.p, dense_output=seen is not None)  # fmt: skip
        if seen is not None:
            seen(side, path.sol)
        peak = max([peak, *(state[0] / edge.alpha for state in path.y_events[1])])
        if path.t_events[2].size or (still and u > edge.alpha and v > 0.0):
            return Answer("overturned_after_impact" if impacts else "overturned_no_impact", math.nan, impacts)
        if not path.t_events[0].size:
            t, (u, v) = float(path.t[-1]), path.y[:, -1]
            continue
        after += still
        if after > still_impacts:
            return Answer("rocked", peak, impacts)
        t, v, u, impacts = float(path.t_events[0][0]), -abs(edge.eta) * path.y_events[0][0][1], 0.0, impacts + 1
        side = side if body.left is None else -side
        if v < REST * edge.alpha * edge.p:
            side = 0
    return Answer("undecided", math.nan, impacts)
