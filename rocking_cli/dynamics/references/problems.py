"""The equations as the paper writes them, on each edge of a structure, for the general
solver.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from .general_solver import Problem, RockingEdge

if TYPE_CHECKING:
    from ...structures.parameters import RockingParameters, Side

    Edge = Side | RockingParameters  # with p, alpha and a_scale


def linear_rates(structure: RockingParameters, edge: Edge) -> RockingEdge:
    """The rates of Eq. 2.4 or 3.6 on an edge: theta'' = theta - alpha - a_scale push -
    2 zeta theta', time by p of the edge.
    """
    alpha, a_scale = edge.alpha, edge.a_scale
    pace = edge.p / structure.p
    drag = 2.0 * structure.damping * pace

    def rates(
        theta: float, w: float, push: float, weight: float
    ) -> tuple[float, float]:
        force = weight * (theta - alpha) - a_scale * push
        return w, pace**2 * force - drag * w

    return RockingEdge(alpha, alpha / a_scale, math.inf, rates)


def rigid_body_rates(structure: RockingParameters, edge: Edge) -> RockingEdge:
    """The rates of Eq. 2.3 on an edge: theta'' = -sin(alpha - theta) - push cos(alpha -
    theta) - 2 zeta theta', time by p of the edge.
    """
    alpha = edge.alpha
    pace = edge.p / structure.p
    drag = 2.0 * structure.damping * pace

    def rates(
        theta: float, w: float, push: float, weight: float
    ) -> tuple[float, float]:
        z = alpha - theta
        force = -weight * math.sin(z) - push * math.cos(z)
        return w, pace**2 * force - drag * w

    return RockingEdge(alpha, math.tan(alpha), 0.5 * math.pi, rates)


def mechanism_rates(structure: RockingParameters, edge: Edge) -> RockingEdge:
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
    return RockingEdge(edge.alpha, lift / thrust, end, rates, returns=False)


def problem_of(
    structure: RockingParameters,
    equation: Callable[[RockingParameters, Edge], RockingEdge],
) -> Problem:
    """Return the problem of a structure; equation: function that gives the equation on
    an edge, such as `linear_rates`.
    """
    own: dict[int, Edge] = dict(zip((-1, 1), structure.left_and_right, strict=True))
    if structure.one_sided:
        del own[-1]
    known = all(e.arm is not None for e in own.values())
    edges = {
        i: equation(structure, e)._replace(
            eta=abs(e.eta),
            rise=e.arm * structure.p**2 / structure.gravity
            if known and e.arm
            else None,
        )
        for i, e in own.items()
    }
    scale, body = structure.alpha / structure.a_scale, None
    if structure.restraints:
        from .held_body import TiedBody

        body = partial(
            TiedBody,
            structure.restraints,
            {i: e.p / structure.p for i, e in own.items()},
            own[1].arm or math.nan,
            equation is linear_rates,
        )
    return Problem(edges, scale, body)
