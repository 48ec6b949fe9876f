"""A rigid body whose pivots have moved inside its edges (rounding, wear, crushing), from its parameters alone."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ..parameters import RockingParameters, Side
from .kinematics import Moments
from .single_body import edges_of


def worn(body: RockingParameters, share: float) -> tuple[float, RockingParameters] | None:
    """(inset [m], parameters) of a rigid body whose pivots lie inside the edges by this share of the distance between them.

    A restitution that is given, or that includes the impact on a backing, stays. None if the mass centre is not known, or would be
    beyond an edge.
    """
    sides: tuple[Side | RockingParameters, ...] = body.sides or (body, body)
    if any(side.arm is None for side in sides):
        return None
    (left, z), (right, _) = ((side.arm * math.sin(side.alpha), side.arm * math.cos(side.alpha)) for side in sides if side.arm is not None)
    width, x, arm = left + right, 0.5 * (left - right), math.hypot(right, z)
    half = (0.5 - share) * width
    if not abs(x) < half:
        return None
    central = body.gravity * arm / sides[1].p ** 2 - arm * arm  # I_G/m
    edges = edges_of(Moments(1.0, x, z, central + x * x + z * z), half, body.gravity)
    kept = body.one_sided or body.eta_source == "given"
    found = [edge.side(name, abs(side.eta) if kept else edge.eta) for name, edge, side in zip(("left", "right"), edges, sides, strict=True)]
    if body.sides:
        fields: dict[str, Any] = {
            "eta_source": body.eta_source,
            "gravity": body.gravity,
            "damping": body.damping,
            "friction": body.friction,
        }
        return share * width, RockingParameters.of_sides(body.name, body.structure, *found, **fields)
    one = found[1]
    eta = body.eta if kept else one.eta
    return share * width, replace(body, p=one.p, alpha=one.alpha, uplift=one.uplift, eta=eta, arm=one.arm, details={})
