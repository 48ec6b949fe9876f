"""The equations as the paper writes them, on each edge of a structure, for the general
solver.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from .general_solver import Arm, Problem, Rates

if TYPE_CHECKING:
    from ...structures.parameters import RockingParameters, Side

    Edge = Side | RockingParameters  # with p, alpha and a_scale


def linear_rates(structure: RockingParameters, edge: Edge) -> Rates:
    """The rates of Eq. 2.4 or 3.6 on an edge: theta'' = theta - alpha - a_scale push -
    2 zeta theta', time by p of the edge.
    """
    pace = edge.p / structure.p
    alpha = edge.alpha
    a_scale = edge.a_scale
    damping = structure.damping

    def rates(
        theta: float, w: float, push: float, weight: float
    ) -> tuple[float, float]:
        return (
            w,
            pace**2 * (weight * (theta - alpha) - a_scale * push)
            - 2.0 * damping * pace * w,
        )

    return Rates(alpha, alpha / a_scale, math.inf, rates)


def rigid_body_rates(structure: RockingParameters, edge: Edge) -> Rates:
    """The rates of Eq. 2.3 on an edge: theta'' = -sin(alpha - theta) - push cos(alpha -
    theta) - 2 zeta theta', time by p of the edge.
    """
    pace, alpha, damping = edge.p / structure.p, edge.alpha, structure.damping

    def rates(
        theta: float, w: float, push: float, weight: float
    ) -> tuple[float, float]:
        z = alpha - theta
        return (
            w,
            pace**2 * (-weight * math.sin(z) - push * math.cos(z))
            - 2.0 * damping * pace * w,
        )

    return Rates(alpha, math.tan(alpha), 0.5 * math.pi, rates)


def mechanism_rates(structure: RockingParameters, edge: Edge) -> Rates:
    """The rates of Eq. 3.4 on a side: theta' = w/sqrt(m) and w' = -(L + push B)/(M0
    sqrt(m)) - 2 zeta w, with g/p^2 of the structure, m = M/M0 and M0 = M at rest.
    """
    from .tabulated import tabulated

    assert edge.mechanism is not None  # called only for mechanisms
    mechanism = edge.mechanism
    coefficients = tabulated(mechanism, edge.alpha)
    pull = structure.gravity / structure.p**2
    drag = 2.0 * structure.damping * edge.p / structure.p

    def rates(
        theta: float, w: float, push: float, weight: float
    ) -> tuple[float, float]:
        slowness, lift, thrust = coefficients(theta)
        return (slowness * w, -pull * (weight * lift + push * thrust) - drag * w)

    end = mechanism.reach_to(0.5 * math.pi)
    _, lift, thrust = coefficients(0.0)
    return Rates(edge.alpha, lift / thrust, end, rates, returns=False)


def problem_of(
    structure: RockingParameters, rates: Callable[[RockingParameters, Edge], Rates]
) -> Problem:
    """Return the problem of a structure; rates: function that gives the equation on an
    edge, such as `linear_rates`.
    """
    sides: dict[int, Edge] = dict(zip((-1, 1), structure.sides, strict=False))
    scale = structure.alpha / structure.a_scale
    own = sides or dict.fromkeys((1,) if structure.one_sided else (1, -1), structure)
    eta = {i: abs(e.eta) for i, e in own.items()}
    arms = {
        i: Arm(e.alpha, e.arm * structure.p**2 / structure.gravity)
        for i, e in own.items()
        if e.arm is not None
    }
    arms = arms if len(arms) == len(own) else {}
    body = None
    if structure.restraints:
        from .held_body import body_with

        body = body_with(
            structure.restraints,
            {i: e.p / structure.p for i, e in own.items()},
            own[1].arm,
            linear=rates is linear_rates,
        )
    if sides:
        return Problem(
            {i: rates(structure, s) for i, s in sides.items()},
            scale,
            eta,
            arms,
            body,
        )
    return Problem(
        dict.fromkeys(own, rates(structure, structure)), scale, eta, arms, body
    )
