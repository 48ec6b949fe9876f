"""A body whose edges are worn: its pivots lie inside them."""

import math
from dataclasses import replace
from typing import Any

from ..parameters import RockingParameters, Side
from .moments import Moments
from .single_body import edges_of


def worn(
    body: RockingParameters, share: float
) -> tuple[float, RockingParameters] | None:
    """Return (inset [m], parameters) of the body with its pivots inside the edges by
    this share of the distance between the edges. A given restitution, and one that
    includes the impact on a backing, stays. None if the mass centre would lie beyond a
    pivot, and for a body with ties or a tendon, whose levers change too.
    """
    if body.restraints:
        return None
    sides = body.left_and_right
    left, right = (math.sin(side.alpha) * (side.arm or 0.0) for side in sides)
    half = (0.5 - share) * (left + right)
    moments = _moments(sides[1], body.gravity, 0.5 * (left - right))
    if not abs(moments.x) < half:
        return None
    kept = body.one_sided or body.eta_source == "given"
    there = [
        edge.side(name, abs(side.eta) if kept else edge.eta)
        for name, edge, side in zip(
            ("left", "right"),
            edges_of(moments, half, body.gravity),
            sides,
            strict=True,
        )
    ]
    moved = RockingParameters.of_sides(body.name, body.structure, *there)
    eta = body.eta if kept and not body.sides else moved.eta
    numbers: dict[str, Any] = {
        "p": moved.p,
        "alpha": moved.alpha,
        "uplift": moved.uplift,
        "eta": eta,
    }
    return share * (left + right), replace(
        body, **numbers, arm=moved.arm, sides=moved.sides, details={}
    )


def _moments(side: Side | RockingParameters, gravity: float, x: float) -> Moments:
    """Return the moments per mass of a body about the middle between its edges; side:
    its right edge, x: of its mass centre [m].
    """
    right = math.sin(side.alpha) * (side.arm or 0.0)
    z = math.cos(side.alpha) * (side.arm or 0.0)
    square = right * right + z * z  # R^2
    inertia = gravity * math.sqrt(square) / side.p**2  # I/m about the edge = g R/p^2
    return Moments(1.0, x, z, inertia - square + x * x + z * z)  # the parallel axis
