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
from ..contacts.contact import Contact
from ..lanes import Lanes
from ..weight import WeighedSegments
from .ground import Ground

Array = np.ndarray

_LEVEL = 0.86  # rad; z cos z has its largest value, 0.5611, at z tan z = 1
_HIGHEST = 0.5611
_LASTS = 1.5  # times the sum of the series under the drive of now: no bouncing that is proved to end lasts longer
_DRIFT = 1e-9  # square of the push's change over the least force, from which the end of a bouncing is known as if it were constant
NO_MORE = 1e-10  # change of a force over m g that bouncing still brings, from which it is at rest


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


class Train(NamedTuple):
    """What bouncing to rest asks at most, and whether it has as good as ended: no force changes any more by NO_MORE."""

    bounds: Bounds
    ended: Array


def train_bounds(body: Body, ground: Ground, lanes: Lanes, contact: Contact) -> Train:
    """Of lanes just after an impact, whose bouncing is proved to end in rest; of those that it left no speed there is none."""
    seg, zero = ground.segments, np.zeros(lanes.v.size)
    side = lanes.side
    push, weight = ground.push(lanes, zero), ground.weight(lanes, zero)
    lasts = np.minimum(_LASTS * contact.bouncing_time(lanes, weight), (seg.length[lanes.k] - lanes.u) / lanes.omega)
    if isinstance(seg, WeighedSegments):  # the push is not monotone on its own
        spread = np.abs(lanes.amplitude * body.on(side).uplift * lanes.omega) * ground.segments.steepest[0] * lasts
        pushes = (push - spread, push + spread)
        weights: tuple[Array | float, ...] = (weight, ground.weight(lanes, lasts))
    else:
        pushes, weights = (push, ground.push(lanes, lasts)), (1.0,)
    sides = [(body.on(side), 1.0, lanes.v)]
    sides.append(sides[0] if body.one_sided else (body.on(-side), -1.0, lanes.eta * lanes.v))
    reach, growth = [], np.ones(zero.size)
    for edge, sense, _ in sides:
        forces = [-body.lifting(edge, sense * p, w) / edge.unit for p in pushes for w in weights]
        low, high = np.minimum.reduce(forces), np.maximum.reduce(forces)
        reach.append(low)
        with np.errstate(divide="ignore", invalid="ignore"):
            growth = growth * np.where(low > 0.0, high / low, np.inf)
    found, changes = None, zero
    heaviest, strongest = np.maximum.reduce([w + zero for w in weights]), np.maximum.reduce([np.abs(p) for p in pushes])
    for (edge, sense, v), low in zip(sides, reach, strict=True):
        with np.errstate(divide="ignore", invalid="ignore"):
            square = np.where(v > 0.0, v * v * growth, 0.0)
            fast, high = edge.unit * np.sqrt(square), edge.unit * np.where(square > 0.0, square / low, 0.0)
        by = edge.kappa * ((strongest + 2.0 * heaviest) * high + fast * fast + 2.0 * body.damping * fast)
        for p in pushes:
            for w in weights:
                here = bouncing(body, edge, sense * p, w, by)
                found = here if found is None else found.worst(here)
        changes = np.maximum(changes, by)
    assert found is not None
    drift = np.maximum(np.abs(pushes[1] - pushes[0]), np.abs(weights[-1] - weights[0]))
    bounces = lanes.v > 0.0
    fz, friction = np.nan_to_num(found.fz, nan=-np.inf), np.nan_to_num(found.friction, nan=np.inf)
    return Train(
        Bounds(np.where(bounces, fz, np.inf), np.where(bounces, friction, 0.0)),
        (changes <= NO_MORE) & (drift * drift <= _DRIFT * np.minimum(*reach)),
    )
