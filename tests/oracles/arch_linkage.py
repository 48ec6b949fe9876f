"""An arch as a linkage by another hand: links placed by circles that meet, energies from differences of their places, DOP853 in time.

Of the package only the rest geometry is taken: hinge points, and mass, first and polar moments of the links. A link's place follows from
its two hinges; M = sum m |c'|^2 + I r'^2 and the work of the weight and of the ground from the mass centres c and rotations r, all by
eighth-order differences over phi, and the sums kept as Chebyshev series. M phi'' + M'/2 phi'^2 + (g + z'') Z' + side x'' X' = 0: a sway
to the left is the mirror image.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.polynomial import Chebyshev
from oracles.vertical_motion import Crossing, Shaking
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

FIRST = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}  # derivatives: weights over the step, +- so many steps off
SECOND = {0: -205 / 72, 1: 8 / 5, 2: -1 / 5, 3: 8 / 315, 4: -1 / 560}


def places(points: np.ndarray, phi: float) -> np.ndarray:
    """(4, 2): the hinges when the first link has turned by phi towards +x."""
    a, b, c, d = (complex(*p) for p in points)
    moved = a + (b - a) * np.exp(-1j * phi)
    r, s, gap = abs(c - b), abs(d - c), abs(d - moved)
    along = (r * r - s * s + gap * gap) / (2.0 * gap)
    across = math.sqrt(r * r - along * along) * (1.0 if ((c - b) / (d - b)).imag > 0.0 else -1.0)
    third = moved + (along + 1j * across) * (d - moved) / gap
    return np.array([[z.real, z.imag] for z in (a, moved, third, d)])


def carried(points: np.ndarray, masses: list[tuple[float, float, float, float]], phi: float) -> np.ndarray:
    """(3, 3): x and z of the mass centres and rotations, clockwise, of the links; masses: (mass, first x, first z, polar about 0)."""
    now, found = places(points, phi), []
    for i, (m, x, z, _) in enumerate(masses):
        before, after = (complex(*(p[i + 1] - p[i])) for p in (points, now))
        turn = after / before
        centre = complex(*now[i]) + (complex(x, z) / m - complex(*points[i])) * turn
        found.append([centre.real, centre.imag, -np.angle(turn)])
    return np.array(found)


class Linkage:
    """What the equation of motion needs of phi, and the restitution of phi' at an impact."""

    def __init__(
        self, points: np.ndarray, masses: list[tuple[float, float, float, float]], most: float, gravity: float, eta: float
    ) -> None:
        self.gravity, self.eta, self.most = gravity, eta, most
        self.mass = np.array([m for m, *_ in masses])
        self.spin = np.array([polar - (x * x + z * z) / m for m, x, z, polar in masses])

        def sums(phi: float, h: float = 2e-3) -> list[float]:
            slope = sum(w * (carried(points, masses, phi + i * h) - carried(points, masses, phi - i * h)) / h for i, w in FIRST.items())
            inertia = float((self.mass * (slope[:, 0] ** 2 + slope[:, 1] ** 2) + self.spin * slope[:, 2] ** 2).sum())
            return [inertia, float((self.mass * slope[:, 1]).sum()), float((self.mass * slope[:, 0]).sum())]

        nodes = 0.5 * most * (1.0 - np.cos(np.pi * (np.arange(24) + 0.5) / 24))
        values = np.array([sums(phi) for phi in nodes])
        self.inertia, self.lift, self.push = (Chebyshev.fit(nodes, v, 23, domain=[0.0, most]) for v in values.T)
        self.growth = self.inertia.deriv()

    def bend(self, phi: float, rate: float, across: float, up: float) -> float:
        """phi'' of a sway towards +x."""
        work = (self.gravity + up) * self.lift(phi) + across * self.push(phi)
        return float(-(work + 0.5 * self.growth(phi) * rate**2) / self.inertia(phi))

    def lifted(self, shaking: Shaking, start: float) -> tuple[float, int]:
        """Instant and side, +1 or -1, of the first uplift after `start` [s]; infinite where there is none."""

        def force(t: float, side: int) -> float:
            return self.bend(0.0, 0.0, side * shaking.across(t), shaking.up(t))

        for low, high in pairwise([start, *(m for m in shaking.marks if m > start)]):
            times = np.linspace(low + 1e-13, high - 1e-13, 300)
            for n, t in enumerate(times):
                for side in (1, -1):
                    if force(t, side) > 0.0:
                        return (t if n == 0 else brentq(force, times[n - 1], t, (side,), xtol=1e-15)), side
        return math.inf, 0

    def swing(self, shaking: Shaking) -> float:
        """The largest phi of an arch at rest until nothing larger can come; NaN where it passes `most`."""
        (t, side), phi, rate, peak, after = self.lifted(shaking, 0.0), 0.0, 0.0, 0.0, 0
        while after < 2 and math.isfinite(t):
            still = t >= shaking.end * (1.0 - 1e-12)
            stop = t + 20.0 if still else min(m for m in shaking.marks if m > t * (1.0 + 1e-12) + 1e-12)

            def flow(x: float, state: np.ndarray, side: int = side, still: bool = still) -> list[float]:
                ground = (0.0, 0.0) if still else (side * shaking.across(x), shaking.up(x))
                return [state[1], self.bend(state[0], state[1], *ground)]

            events = (Crossing(0, 0.0, -1, True), Crossing(1, 0.0, -1, False), Crossing(0, self.most, 1, True))
            slope = flow(t, np.array([phi, rate]))[1]
            first = min(0.01, stop - t, 0.3 * rate / abs(slope) if phi == 0.0 < rate and slope < 0.0 else math.inf)
            path = solve_ivp(flow, (t, stop), [phi, rate], "DOP853", rtol=1e-12, atol=1e-15, events=events, first_step=first, max_step=0.05)
            peak = max([peak, *(state[0] for state in path.y_events[1])])
            if path.t_events[2].size:
                return math.nan
            if not path.t_events[0].size:
                t, (phi, rate) = float(path.t[-1]), path.y[:, -1]
                continue
            t, rate, phi, side = float(path.t_events[0][0]), -self.eta * path.y_events[0][0][1], 0.0, -side
            after += still
            if rate < 1e-9:
                (t, side), rate = self.lifted(shaking, t), 0.0
        return peak
