"""What a body asks of the ground, from an integration by DOP853 that shares no code: forces by the equation of motion along its dense
output, extremes by Brent's method between samples.

    Fx/m = xg + s R (u'' cos z + u'^2 sin z),   Fz/m = g + zg + R (u'' sin z - u'^2 cos z),   z = alpha - u
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from oracles.collocation import Body
from oracles.vertical_motion import Answer, Shaking, acceleration, swing
from scipy.integrate import OdeSolution
from scipy.optimize import minimize_scalar

from rocking_cli import RockingParameters

STILL = 80  # impacts after the shaking that are followed at most


def pendulum(eta: float = 0.9, **more: Any) -> RockingParameters:
    """A point mass on wide feet: kappa = 1, alpha = 1."""
    return RockingParameters("m", "point_mass", 2.0, 1.0, eta, math.tan(1.0), 1.0, arm=9.81 / 4.0, **more)


def shenton(a: float, slenderness: float) -> float:
    """Shenton's boundary between rocking and slide-rocking of a block of height over width H that a = xg''/g sets off [-]:
    [a (4 + H^2) + 3 H]/(3 a H + 4 H^2 + 1) (Shenton 1996). At a = 1/H, where it just lifts, it is 1/H."""
    h = slenderness
    return (a * (4.0 + h * h) + 3.0 * h) / (3.0 * a * h + 4.0 * h * h + 1.0)


def lifting(omega: float) -> float:
    """A from which the linear point mass leaves the ground as it comes down after a rectangular push of 2 pi/Omega: with y and y' at its
    end (A - 1)(cosh - 1) and (A - 1) sinh, u'^2 = alpha^2 (y'^2 + 2 y - y^2) at the impact, and Fz = 1 - alpha sin - u'^2 cos(alpha)."""
    cosh, sinh = math.cosh(2.0 * math.pi / omega), math.sinh(2.0 * math.pi / omega)
    square = (1.0 - math.sin(1.0)) / math.cos(1.0)
    a, b = sinh**2 - (cosh - 1.0) ** 2, 2.0 * (cosh - 1.0)
    return 1.0 + (-b + math.sqrt(b * b + 4.0 * a * square)) / (2.0 * a)


class Asked(NamedTuple):
    """The answer of the integration, max |Fx|/Fz [-] (infinite where Fz <= 0) and min Fz/(m g) [-]."""

    answer: Answer
    friction: float
    fz_min: float


def asked(body: Body, arms: tuple[float, float], shaking: Shaking) -> Asked:
    """Of a body at rest; arms: from the right edge and the left one to its mass centre [m]."""
    friction, fz_min = [0.0], [1.0]

    def take(fz: Callable[[float], float], fx: Callable[[float], float], low: float, high: float, count: int) -> None:
        for start, stop in pairwise([low, *(m for m in (*shaking.marks, shaking.end) if low < m < high), high]):
            inset = 1e-11 * (stop - start)
            least = extreme(fz, start + inset, stop - inset, count)
            fz_min.append(least)
            if least <= 0.0:
                friction.append(math.inf)
                continue
            friction.append(-extreme(lambda t: -fx(t) / fz(t), start + inset, stop - inset, count))
            friction.append(-extreme(lambda t: fx(t) / fz(t), start + inset, stop - inset, count))

    def seen(side: int, path: OdeSolution) -> None:
        edge, arm = body.edge(side), arms[0 if side > 0 else 1]

        def forces(t: float) -> tuple[float, float]:
            still = t >= shaking.end
            across, up = (0.0, 0.0) if still else (shaking.across(t), shaking.up(t))
            u, v = path(t)
            bend, z = acceleration(body, side, u, v, across, up), edge.alpha - u
            fx = across + side * arm * (bend * math.cos(z) + v * v * math.sin(z))
            return fx, body.gravity + up + arm * (bend * math.sin(z) - v * v * math.cos(z))

        low, high = path.t_min, path.t_max
        if high > low:
            take(
                lambda t: forces(t)[1] / body.gravity,
                lambda t: forces(t)[0] / body.gravity,
                low,
                high,
                12 + int(30.0 * edge.p * (high - low)),
            )

    def rested(low: float, high: float) -> None:
        if high > low:
            one = body.left is None

            def pushed(t: float) -> float:
                return min(0.0, shaking.across(t)) if one else shaking.across(t)

            take(lambda t: 1.0 + shaking.up(t) / body.gravity, lambda t: pushed(t) / body.gravity, low, high, 120)

    answer = swing(body, shaking, seen, rested, STILL)
    return Asked(answer, max(friction), min(fz_min))


def extreme(function: Callable[[float], float], low: float, high: float, count: int) -> float:
    """The least value of a function, met between samples."""
    times = np.linspace(low, high, count)
    values = np.array([function(float(t)) for t in times])
    least = float(values.min())
    for i in range(count):
        left, right = max(i - 1, 0), min(i + 1, count - 1)
        rise = max(values[left], values[right]) - values[i]
        if values[i] <= min(values[left], values[right]) and values[i] < least + 0.3 * rise + 1e-9:
            found = minimize_scalar(function, bounds=(times[left], times[right]), method="bounded",
                                    options={"xatol": 1e-9 * (times[right] - times[left])})  # fmt: skip
            least = min(least, float(found.fun))
    return least
