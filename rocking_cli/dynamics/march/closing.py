"""Bounds of the forces of what a march closes early: bouncing on the way to rest, and rocking on over still ground.

**Bouncing** (Lemma 7) under outward pushes P and weights w, whose first and last values are its extremes, from edge to edge. Its speeds
grow by no more than the root of the largest over the least force of both edges; with V and U the largest |u'| and u on an edge,

    |Fx - Fx_0|, |Fz - Fz_0| <= kappa [(|P| + 2 w) U + V^2 + 2 zeta V]

of the forces Fx_0, Fz_0 of bounces without speed, which are linear in P and w, and their ratio monotone in each.

**Still ground.** With S = sin z (linear: z) and u'^2 = q at the next impact Fz >= 1 - kappa (S sin z + u'^2 cos z), falling towards the
ground while 3 cos z > cos(alpha) + q/2 (linear: q < 1), and |Fx| <= kappa max(S cos z, q sin z). While q <= cos(alpha) (linear: q <=
alpha/tan(alpha)) the first of these is the larger, and at a given z |Fx|/Fz falls as q grows (linear: where kappa z < sin z), so that
none exceeds that of bounces without speed, in which it grows with z (nonlinear: while (1 - kappa) tan^2 z < 1, linear: z tan z < 1).
Damping takes energy, and adds at most 2 zeta kappa u' to either force.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..body import Body, Edge
from ..lanes import Lanes

Array = np.ndarray

_LEVEL = 0.86  # rad; z cos z has its largest value, 0.5611, at z tan z = 1
_HIGHEST = 0.5611
_LASTS = 1.5  # times the sum of the series under the drive of now: no bouncing that is proved to end lasts longer
_DRIFT = 1e-9  # square of the push's change over the least force, from which the end of a bouncing is known as if it were constant


class Bounds(NamedTuple):
    """The least Fz over m g and the largest |Fx|/Fz of what is to come."""

    fz: Array
    friction: Array

    def take(self, at: Array) -> Bounds:
        """Of some lanes."""
        return Bounds(self.fz[at], self.friction[at])

    def worst(self, other: Bounds) -> Bounds:
        """Of both."""
        return Bounds(np.minimum(self.fz, other.fz), np.maximum(self.friction, other.friction))


def free_bounds(body: Body, edge: Edge, square: Array) -> Bounds:
    """Of rocking over still ground that comes to the next impact on this edge with u'^2 of no more than `square`, |z| <= alpha before;
    undamped the least Fz is that of the impact."""
    alpha, kappa, sin, cos = edge.alpha, edge.kappa, np.sin(edge.alpha), np.cos(edge.alpha)
    drag = 2.0 * body.damping * np.sqrt(square)
    least = body.at_impact(edge, square) - kappa * drag * sin
    if body.linear:
        falls, pulls = square <= 1.0, np.where(alpha < _LEVEL, alpha * cos, _HIGHEST)
        settles = (square <= alpha * cos / sin) & (kappa * alpha <= sin) & (alpha < _LEVEL)
    else:
        falls, pulls = square <= 4.0 * cos, np.where(alpha < 0.25 * np.pi, sin * cos, 0.5)
        settles = (square <= cos) & ((1.0 - kappa) * sin * sin <= cos * cos)
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.where(least > 0.0, kappa * (np.maximum(pulls, square * sin) + drag) / least, np.inf)
    if not body.damping:
        most = np.where(settles & (least > 0.0), bouncing(body, edge, 0.0, 1.0).friction, most)
    return Bounds(np.where(falls, least, -np.inf), np.where(falls, most, np.inf))


def still_bounds(body: Body, lanes: Lanes) -> Bounds:
    """Of lanes on still ground; undamped, what is to come has the least Fz itself."""
    here, there = body.on(lanes.side), body.on(-lanes.side)
    u = here.unit * lanes.y
    square = (here.unit * lanes.v) ** 2 + body.fall(here, u)
    found = free_bounds(body, here, square)
    if len(body.alpha) > 1:
        beyond = free_bounds(body, there, square * (lanes.eta * there.unit / here.unit) ** 2)
        found = Bounds(*(np.where(lanes.eta > 0.0, both, one) for both, one in zip(found.worst(beyond), found, strict=True)))
    inside = u <= 2.0 * here.alpha
    return Bounds(np.where(inside, found.fz, -np.inf), np.where(inside, found.friction, np.inf))


def bouncing(body: Body, edge: Edge, push: Array | float, weight: Array | float, by: Array | float = 0.0) -> Bounds:
    """Of bounces on an edge that have no speed, under this outward push [g] and weight over m g; by: what either force may differ by."""
    fz = body.lying(edge, push, weight) - by
    fx = np.abs(edge.kappa * body.lifting(edge, push, weight) * np.cos(edge.alpha) - push) + by
    with np.errstate(divide="ignore", invalid="ignore"):
        return Bounds(fz, np.where(fz > 0.0, fx / fz, np.inf))
