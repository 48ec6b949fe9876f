"""The forces between a rigid body and the ground.

With z = alpha - u, u = |theta| [rad], ' by tau of the side, w = 1 + zg''/g and kappa = m R^2/I, the outward Fx and Fz over m g are

    Fx = kappa (u'' cos z + u'^2 sin z) - push,   Fz = w + kappa (u'' sin z - u'^2 cos z)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..body import Body, Edge, Shaking
from ..lanes import Array, Arrays
from .extremes import Extremes, Ratio, Stretches, parts


@dataclass
class Forces(Arrays):
    """Outward Fx and Fz over m g [-], and their slopes by the time of the stretch; arrays of one shape."""

    fx: Array
    fz: Array
    fx_slope: Array
    fz_slope: Array

    def ratio(self, kind: Array) -> Ratio:
        """-Fz for the kind 0, Fx/Fz for 1, -Fx/Fz for -1."""
        up = kind == 0
        return Ratio(
            np.where(up, -self.fz, kind * self.fx), np.where(up, 1.0, self.fz),
            np.where(up, -self.fz_slope, kind * self.fx_slope), np.where(up, 0.0, self.fz_slope),
        )  # fmt: skip


Along = Callable[[Array, Array], Forces]  # the forces in motions of given indices, at given times


def forces_on(body: Body, edge: Edge, shaking: Shaking, u: Array, rate: Array) -> Forces:
    """Forces of a body at u, u' [rad, by tau] on an edge under this push and weight over m g; arrays of one shape."""
    push, push_slope, weight, weight_slope = shaking
    z = edge.alpha - u
    sin, cos = np.sin(z), np.cos(z)
    if body.linear:
        bend, jerk = push - weight * z, push_slope + weight * rate - weight_slope * z
    else:
        bend = push * cos - weight * sin
        jerk = push_slope * cos + rate * (weight * cos + push * sin) - weight_slope * sin
    if body.damping:
        bend = bend - 2.0 * body.damping * rate
        jerk = jerk - 2.0 * body.damping * bend
    square, turns = rate * rate, 3.0 * rate * bend
    jerk = jerk - rate * square
    return Forces(
        edge.kappa * (bend * cos + square * sin) - push,
        weight + edge.kappa * (bend * sin - square * cos),
        edge.kappa * (jerk * cos + turns * sin) - push_slope,
        weight_slope + edge.kappa * (jerk * sin - turns * cos),
    )


class ForceExtremes(Extremes):
    """The largest |Fx|/Fz of each cell, then the largest -Fz/(m g) of each, (2 cells,); at first those of a body at rest."""

    def __init__(self, cells: int) -> None:
        super().__init__(np.repeat([0.0, -1.0], cells))
        self.cells = cells

    def take_in(self, cell: Array, fx: Array, fz: Array) -> None:
        """Forces of these cells, (..., n)."""
        self.offer(np.broadcast_to(cell, fx.shape), _friction(fx, fz))
        self.offer(np.broadcast_to(self.cells + cell, fz.shape), -fz)

    def can_be_beaten(self, cell: Array, fx: Array, fz: Array) -> Array:
        """True where any of the forces of these cells, (..., n), exceeds the extremes so far, or is not known, (n,)."""
        beat = self.can_beat(cell, _friction(fx, fz)) | self.can_beat(self.cells + cell, -fz)
        return np.any(beat, axis=tuple(range(beat.ndim - 1)))

    def take_in_along(self, cell: Array, along: Along, whole: Stretches, start: Forces, end: Forces, one_way: bool = False) -> None:
        """Forces on stretches of motions of these cells. along: the forces inside the motions; start, end: those at the ends of each
        stretch; one_way: True if only an outward Fx counts."""
        s, one, other = parts(along, whole, start, end)
        kinds = np.array([0, 1] if one_way else [0, 1, -1])
        kind, own = np.repeat(kinds, s.own.size), np.tile(s.own, kinds.size)
        every = np.tile(np.arange(s.own.size), kinds.size)
        s, one, other = s.take(every), one.take(every), other.take(every)
        s.own = np.arange(own.size)

        def of_kind(at: Array, x: Array) -> Ratio:
            return along(own[at], x).ratio(kind[at])

        self.search(cell[own] + np.where(kind == 0, self.cells, 0), of_kind, s, one.ratio(kind), other.ratio(kind))


def _friction(fx: Array, fz: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.isnan(fz), np.nan, np.where(fz > 0.0, np.abs(fx) / fz, np.inf))
