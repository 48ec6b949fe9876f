"""A body whose edges are worn: its pivots lie inside them."""

import math
from dataclasses import replace
from typing import Any

from ..parameters import RockingParameters, Side
from .moments import Moments, edges_of


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
    left, right = ((side.arm or 0.0) * math.sin(side.alpha) for side in sides)
    arm, half = sides[1].arm or 0.0, (0.5 - share) * (left + right)
    centre = 0.5 * (left - right), arm * math.cos(sides[1].alpha)
    # I/m about the edge is g R/p^2
    inertia = body.gravity * arm / sides[1].p ** 2 - arm**2
    moments = Moments.of(1.0, centre, inertia)
    if not abs(moments.x) < half:
        return None
    kept = body.one_sided or body.eta_source == "given"
    there = [
        Side(name, **edge._replace(eta=abs(side.eta) if kept else edge.eta)._asdict())
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
