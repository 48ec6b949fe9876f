"""A mechanism under one cycle of a sine, by another hand: bodies placed by explicit
geometry, M, V' and B from eighth-order differences of their places, DOP853 from event
to event, and the energy after the shaking.

Towards +x the rotation is theta > 0. M phi'' + M'/2 phi'^2 + V' = -B xg''.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

G = 9.81
WEIGHTS = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}  # of a first derivative
STEP = 2e-3  # rad
SLOW = 1e-7  # rad/s: a slower body rests


@dataclass
class Part:
    """A body: `place` returns (x, z, rotation) of its mass centre at phi."""

    mass: float
    inertia: float
    place: Callable[[float], Sequence[float]]
    pushed: bool = True  # False: a weight that rises and is held horizontally
    heavy: bool = True  # False: a weight without mass


class OneWay:
    """A mechanism in one direction: M, V' and B as Chebyshev series."""

    def __init__(self, parts: Sequence[Part], most: float) -> None:
        nodes = 0.5 * most * (1.0 - np.cos(np.pi * (np.arange(48) + 0.5) / 48))
        self.parts = parts
        rows = np.array([self.at(phi) for phi in nodes])
        self.m, self.lift, self.push = (
            Chebyshev.fit(nodes, row, 40, domain=[0.0, most]) for row in rows.T
        )
        self.m_slope, self.work = self.m.deriv(), self.lift.integ()
        self.alpha = brentq(self.lift, 1e-9, most)
        self.uplift = self.lift(0.0) / abs(self.push(0.0)) / G
        self.p = math.sqrt(-self.lift.deriv()(self.alpha) / self.m(self.alpha))
        self.top = self.work(self.alpha) - self.work(0.0)
        self.end = most  # it overturns beyond

    def at(self, phi: float) -> tuple[float, float, float]:
        """M, V' and B."""
        m = lift = push = 0.0
        for part in self.parts:
            x, z, turn = (
                sum(
                    w
                    * (
                        np.array(part.place(phi + i * STEP))
                        - part.place(phi - i * STEP)
                    )
                    for i, w in WEIGHTS.items()
                )
                / STEP
            )
            mass = part.mass if part.heavy else 0.0
            m += mass * (z * z + x * x * part.pushed) + part.inertia * turn * turn
            lift += part.mass * G * z
            push += mass * x * part.pushed
        return m, lift, push

    def rates(self, phi: float, w: float, a: float) -> list[float]:
        pull = self.lift(phi) + self.push(phi) * a
        return [w, -(0.5 * self.m_slope(phi) * w * w + pull) / self.m(phi)]


def peak(
    sides: dict[int, OneWay], eta: dict[int, float], a_g: float, period: float
) -> float | None:
    """max |theta|/alpha, None if it overturns; eta: on leaving each side."""

    def ground(t: float) -> float:
        return a_g * math.sin(2.0 * math.pi * t / period) if t < period else 0.0

    t, side, w, largest = 0.0, 0, 0.0, 0.0
    while t < period:
        if not side:
            instants = np.linspace(t, period, 20001)
            drive = a_g * np.sin(2.0 * np.pi * instants / period)
            lifts = {s: -s * drive > one.uplift * G for s, one in sides.items()}
            first = {s: int(x.argmax()) for s, x in lifts.items() if x.any()}
            if not first:
                return largest
            side = min(first, key=lambda s: first[s])
            at, one = first[side], sides[side]

            def excess(x: float, s: int = side, u: float = one.uplift) -> float:
                return -s * ground(x) - u * G

            if at:
                t = brentq(excess, instants[at - 1], instants[at], xtol=1e-14)
            w = 0.0
        one = sides[side]

        def falls(_: float, y: np.ndarray) -> float:
            return float(y[0])

        def ends(_: float, y: np.ndarray, end: float = one.end) -> float:
            return float(y[0]) - end

        falls.terminal, falls.direction = True, -1
        ends.terminal = True
        start = [0.0, w]
        found = solve_ivp(
            lambda x, y, one=one: one.rates(y[0], y[1], ground(x)),
            (t, period),
            start,
            method="DOP853",
            rtol=1e-11,
            atol=1e-14,
            events=[falls, lambda _, y: y[1], ends],
        )
        turns = [y[0] for y in found.y_events[1]] + [float(found.y[0].max())]
        largest = max(largest, max(turns) / one.alpha)
        if found.t_events[2].size:
            return None
        t, (phi, w) = float(found.t[-1]), found.y[:, -1]
        if not found.t_events[0].size:
            break
        w *= -eta[side]
        side = -side if w > SLOW else 0
    return _free(sides, eta, side, phi, w, largest) if side else largest


def _free(
    sides: dict[int, OneWay],
    eta: dict[int, float],
    side: int,
    phi: float,
    w: float,
    largest: float,
) -> float | None:
    """The peak after the shaking: this arc by its energy, then the next two."""
    one = sides[side]
    energy = 0.5 * one.m(phi) * w * w + one.work(phi) - one.work(0.0)
    for _ in range(3):
        one = sides[side]
        beyond = phi > one.alpha  # it comes back only over the barrier
        if (w > 0.0 or energy < one.top) if beyond else (w > 0.0 and energy > one.top):
            return None
        if w > 0.0:
            crest = brentq(
                lambda x, one=one, e=energy: one.work(x) - one.work(0.0) - e,
                0.0,
                one.alpha,
                xtol=1e-15,
            )
            largest = max(largest, crest / one.alpha)
        speed = eta[side] * math.sqrt(2.0 * energy / one.m(0.0))
        side, phi, w = -side, 0.0, speed
        energy = 0.5 * sides[side].m(0.0) * speed * speed
    return largest
