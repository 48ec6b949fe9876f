"""A rigid body whose pivots have moved inside its edges (rounding, wear, crushing), from its parameters alone."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ..parameters import RockingParameters, Side
from .moments import Moments
from .single_body import edges_of


def worn(body: RockingParameters, share: float) -> tuple[float, RockingParameters] | None:
    """(inset [m], parameters) of a rigid body whose pivots lie inside the edges by this share of the distance between them. A restitution
    that is given, or that includes the impact on a backing, stays. None if the mass centre is not known, or would be beyond an edge."""
    sides: tuple[Side | RockingParameters, ...] = body.sides or (body, body)
    (left, _), (right, z) = ((math.sin(side.alpha) * (side.arm or 0.0), math.cos(side.alpha) * (side.arm or 0.0)) for side in sides)
    x, half, square = 0.5 * (left - right), (0.5 - share) * (left + right), right * right + z * z
    if not abs(x) < half:
        return None
    polar = body.gravity * math.sqrt(square) / sides[1].p ** 2 - square + x * x + z * z  # I_G/m and the parallel axis
    kept = body.one_sided or body.eta_source == "given"
    edges = zip(("left", "right"), edges_of(Moments(1.0, x, z, polar), half, body.gravity), sides, strict=True)
    there = [edge.side(name, abs(side.eta) if kept else edge.eta) for name, edge, side in edges]
    moved = RockingParameters.of_sides(body.name, body.structure, *there)
    numbers: dict[str, Any] = {
        "p": moved.p,
        "alpha": moved.alpha,
        "uplift": moved.uplift,
        "eta": body.eta if kept and not body.sides else moved.eta,
    }
    return share * (left + right), replace(body, **numbers, arm=moved.arm, sides=moved.sides, details={})
