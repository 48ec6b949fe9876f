"""What a body asks of the ground, from an integration that shares no code: forces by
the equation of motion along its steps, extremes by Brent's method between samples.

    Fx/m = xg + s R (u'' cos z + u'^2 sin z)
    Fz/m = g + zg + R (u'' sin z - u'^2 cos z),   z = alpha - u
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from oracles.collocation import Answer, Body, Shaking, Step, integrate
from scipy.optimize import minimize_scalar

from rocking_cli import RockingParameters

STILL = 80  # impacts after the shaking that are followed at most


def pendulum(eta: float = 0.9, **more: Any) -> RockingParameters:
    """A point mass on wide feet: kappa = 1, alpha = 1."""
    return RockingParameters(
        name="m",
        structure="point_mass",
        p=2.0,
        alpha=1.0,
        eta=eta,
        uplift=math.tan(1.0),
        a_scale=1.0,
        arm=9.81 / 4.0,
        **more,
    )


def shenton(a: float, slenderness: float) -> float:
    """Shenton's boundary between rocking and slide-rocking of a block of height over
    width H that a = xg''/g sets off [-]: [a (4 + H^2) + 3 H]/(3 a H + 4 H^2 + 1)
    (Shenton 1996). At a = 1/H, where it just lifts, it is 1/H.
    """
    h = slenderness
    return (a * (4.0 + h * h) + 3.0 * h) / (3.0 * a * h + 4.0 * h * h + 1.0)


def lifting(omega: float) -> float:
    """A from which the linear point mass leaves the ground as it comes down after a
    rectangular push of 2 pi/Omega: with y and y' at its end (A - 1)(cosh - 1) and (A -
    1) sinh, u'^2 = alpha^2 (y'^2 + 2 y - y^2) at the impact, and Fz = 1 - alpha sin -
    u'^2 cos(alpha).
    """
    cosh, sinh = math.cosh(2.0 * math.pi / omega), math.sinh(2.0 * math.pi / omega)
    square = (1.0 - math.sin(1.0)) / math.cos(1.0)
    a, b = sinh**2 - (cosh - 1.0) ** 2, 2.0 * (cosh - 1.0)
    return 1.0 + (-b + math.sqrt(b * b + 4.0 * a * square)) / (2.0 * a)


class Asked(NamedTuple):
    """The answer of the integration, max |Fx|/Fz [-] (infinite where Fz <= 0) and min
    Fz/(m g) [-].
    """

    answer: Answer
    friction: float
    fz_min: float


def asked(
    body: Body, arm: float, shaking: Shaking, left_arm: float | None = None
) -> Asked:
    """Of a body at rest; arm: from its edges to its mass centre [m], left_arm: from the
    left one if that is another.
    """
    arms = {1: arm, -1: arm if left_arm is None else left_arm}
    least = {"fz": 1.0, "grip": 0.0}  # Fz/(m g) and -|Fx|/Fz

    def take(
        forces: Callable[[Any], tuple[Any, Any]], low: float, high: float, count: int
    ) -> None:
        """Keep the extremes of forces (Fx, Fz), over m, between two instants."""
        for start, stop in pairwise(
            [low, *(m for m in shaking.marks if low < m < high), high]
        ):
            inset = 1e-11 * (stop - start)
            ends = start + inset, stop - inset, count
            least["fz"] = extreme(
                lambda t: forces(t)[1] / body.gravity, *ends, least["fz"]
            )
            if least["fz"] > 0.0:
                least["grip"] = extreme(
                    lambda t: -abs(forces(t)[0]) / forces(t)[1], *ends, least["grip"]
                )

    def seen(side: int, step: Step) -> None:
        edge = body.edge(side)

        def forces(t: Any) -> tuple[Any, Any]:
            across, up = shaking.at(t)
            u, v = step(t)
            angular, z = body.acceleration(side, u, v, across, up), edge.alpha - u
            along = angular * np.cos(z) + v * v * np.sin(z)
            rise = angular * np.sin(z) - v * v * np.cos(z)
            fx = across + side * arms[side] * along
            return fx, body.gravity + up + arms[side] * rise

        take(forces, step.t, step.t + step.h, 12 + int(30.0 * edge.p * step.h))

    def forces_at_rest(t: Any) -> tuple[Any, Any]:
        across, up = shaking.at(t)
        return (
            np.minimum(0.0, across) if body.left is None else across
        ), body.gravity + up

    def rested(low: float, high: float) -> None:
        if high > low:
            take(forces_at_rest, low, high, 120)

    answer = integrate(body, shaking, seen=seen, rested=rested, still_impacts=STILL)
    return Asked(answer, -least["grip"] if least["fz"] > 0.0 else math.inf, least["fz"])


def extreme(
    function: Callable[[Any], Any], low: float, high: float, count: int, least: float
) -> float:
    """The least value of a function, met between samples, or `least` where that is
    lower.
    """
    times = np.linspace(low, high, count)
    values = function(times)
    least = min(least, float(values.min()))
    for i in range(count):
        left, right = max(i - 1, 0), min(i + 1, count - 1)
        rise = max(values[left], values[right]) - values[i]
        if (
            rise > 0.0
            and values[i] <= min(values[left], values[right])
            and values[i] < least + 0.3 * rise + 1e-9
        ):
            found = minimize_scalar(
                function,
                bounds=(times[left], times[right]),
                method="bounded",
                options={"xatol": 1e-9 * (times[right] - times[left])},
            )
            least = min(least, float(found.fun))
    return least
