"""A rigid body, its forces on the ground, and the proof that it keeps contact (Lemma
13).

With z = alpha - u, u = |theta|, s the side, tau = p t of the side and w = 1 + zg''/g
the weight over m g, the acceleration of the mass centre gives

    s Fx/(m g) = s xg''/g + kappa (u'' cos z + u'^2 sin z)
    Fz/(m g) = w + kappa (u'' sin z - u'^2 cos z)

Every arc that does not overturn the body begins or ends at rest, at a peak. With P the
strongest |xg''|/g and u_m the largest u, the energy on the way to that peak, or on the
way back from it, bounds the speed at u by

    u'^2 <= 2 int_u^u_m (w_+ sin z + P cos z) du        (linear: w_+ z + P)

(with damping u' <= 2 zeta u_m + sqrt((2 zeta u_m)^2 + that))

and the speed bounds Fz from below. `observers.contact_watch` watches Fz of bodies for
which this bound does not prove Fz > 0.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from .lanes import of_each_cell

# parts of the path from the ground to the peak; on each part the bound takes the worst
# value of every term
_PARTS = 32
# ground accelerations [g] for which the proof is tried
_ACCELERATIONS = np.geomspace(1e-2, 1e2, 256)
_LOWEST = -0.5 * np.pi  # least z for which the bound is computed


class Edge(NamedTuple):
    """Numbers of one edge of the base, floats or (lanes,) arrays."""

    alpha: Any  # critical angle [rad]
    kappa: Any  # m R^2/I [-]
    theta_per_y: Any  # |theta| at y = 1 [rad]
    uplift: Any  # static uplift acceleration lambda of the equation [-]
    damping: Any = 0.0  # zeta [-]


def ground_reaction(
    edge: Any, u: Any, v: Any, b: Any, push: Any, weight: Any
) -> tuple[Any, Any]:
    """(outward Fx, Fz) of the ground on a body, over m g [-], on an edge with an alpha
    [rad] and a kappa [-]: u = |theta| [rad], its first and second derivative v and b by
    tau = p t of the edge, the outward push over g and the weight over m g, floats or
    arrays of one shape.

    >>> edge = Edge(np.arctan(0.2), 0.75, 1.0, 0.2)
    >>> across, up = ground_reaction(edge, 0.0, 0.0, 0.0, 0.2, 1.0)  # at uplift
    >>> round(float(-across / up), 12)  # tan(alpha)
    0.2
    """
    sin, cos = np.sin(edge.alpha - u), np.cos(edge.alpha - u)
    return edge.kappa * (b * cos + v * v * sin) - push, weight + edge.kappa * (
        b * sin - v * v * cos
    )


def relief(edge: Any, y: Any, v: Any, b: Any) -> Any:
    """An upper bound of the part of the weight m g [-] that the motion takes from Fz,
    where y, |y'| and |y''| are at most y, v and b [units of the edge]: |z| is at most
    alpha, or u - alpha. Floats or arrays.
    """
    turned = edge.theta_per_y * y
    lean = 0.5 * (turned + abs(2.0 * edge.alpha - turned))
    return edge.kappa * edge.theta_per_y * (lean * b + edge.theta_per_y * v * v)


class Body(NamedTuple):
    """A rigid body, or the body of each cell. Tuples hold one value for each edge,
    right and left, or a single value if the edges are alike; a value is a float, or an
    array (cells,). A push [g] is a_scale times the ground acceleration over g, outward
    if it lifts the body on its edge. Under a push the linear equation and Fz are those
    of a_scale 1.
    """

    alpha: tuple[Any, ...]  # critical angle [rad], (edges,)
    kappa: tuple[Any, ...]  # m R^2/I [-], (edges,)
    linear: bool  # True for the linear equation
    damping: Any = 0.0  # zeta [-], float or (cells,)
    one_sided: bool = False  # True if the body stands on its right edge only
    # push over ground acceleration [-], (edges,); empty for 1
    a_scale: tuple[Any, ...] = ()

    @property
    def cellwise(self) -> tuple[str, ...]:
        """The fields that may differ from cell to cell in one march."""
        return "alpha", "kappa", "a_scale", "damping"

    @classmethod
    def of_each_cell(cls, bodies: Sequence["Body"], counts: Sequence[int]) -> "Body":
        """Return the body of each cell, for so many cells of each of these bodies."""
        if len(set(bodies)) == 1:
            return bodies[0]
        return bodies[0]._replace(**of_each_cell(bodies, counts))

    @property
    def alike(self) -> bool:
        """True if the body has one set of edge numbers: both edges are equal, or there
        is only one edge.
        """
        return len(self.alpha) == 1

    @property
    def edges(self) -> tuple[Edge, ...]:
        """The `Edge` of each edge of the base, right first."""
        return tuple(
            self._edge(*pair, self.damping)
            for pair in zip(self.alpha, self.kappa, strict=True)
        )

    def _edge(self, alpha: Any, kappa: Any, damping: Any) -> Edge:
        if self.linear:
            return Edge(alpha, kappa, alpha, alpha, damping)
        functions = math if isinstance(alpha, float) else np
        return Edge(alpha, kappa, functions.sin(alpha), functions.tan(alpha), damping)

    def on(self, side: Array, cell: Array) -> Edge:
        """The numbers of the edges of lanes that are on these sides, +1 right and -1
        left; cell: the cells of the lanes.
        """
        if self.alike and isinstance(self.alpha[0], float):
            return self.edges[0]

        def there(pair: tuple[Any, ...]) -> Any:
            own = [x if isinstance(x, float) else x[cell] for x in pair]
            return own[0] if len(own) == 1 else np.where(side > 0.0, *own)

        return self._edge(there(self.alpha), there(self.kappa), there((self.damping,)))

    def pull(self, edge: Edge) -> Any:
        """-u'' just above the ground under the weight m g alone, without a push."""
        return edge.alpha if self.linear else np.sin(edge.alpha)

    def fall(self, edge: Edge, u: Array) -> Array:
        """Return by how much u'^2 grows on the way down from u to the impact, on still
        ground, undamped.
        """
        z = edge.alpha - u
        return (
            edge.alpha**2 - z * z
            if self.linear
            else 2.0 * (np.cos(z) - np.cos(edge.alpha))
        )

    def squared_speed_at_ground(self, edge: Edge, y: Array, v: Array) -> Array:
        """Return u'^2 at the next impact of bodies that are now at y, v [units of the
        edge], on still ground, undamped.
        """
        return (edge.theta_per_y * v) ** 2 + self.fall(edge, edge.theta_per_y * y)

    def fz_in_bounces(
        self,
        edge: Edge,
        weight: Array | float,
        inward: Array,
        fastest: Array,
        top: Array,
    ) -> Array:
        """Return a lower bound of Fz/(m g) of bounces on this edge.

        Above the ground -u'' is at most cos(alpha - u)/cos(alpha) times that at the
        ground, under the linear equation at most that at the ground.

        Parameters:
            weight: least force downwards over m g [-]
            inward: largest -u'' at the ground without damping [rad]
            fastest: largest |u'| [rad]
            top: largest u [rad]
        """
        # c of Lemma 13: the largest -u'' above the ground over its value at the ground.
        steepest = np.cos(np.maximum(edge.alpha - top, 0.0))
        growth = 1.0 if self.linear else steepest / np.cos(edge.alpha)
        force = np.maximum(inward, 0.0) * growth + 2.0 * edge.damping * fastest
        return np.asarray(
            weight
            - edge.kappa * (force * np.sin(edge.alpha) + fastest * fastest * steepest)
        )

    def contact_proved(
        self,
        edge: Edge,
        push: Array,
        turn: Array,
        sway: Array | float = 0.0,
        fastest: Array | float = np.inf,
    ) -> Array:
        """Return True where contact (Fz > 0) is proved for every push up to `push` [g]
        of either sign, every |theta| up to `turn` [rad], every |dtheta/dtau| up to
        `fastest` [rad], and every weight over m g from 1 - sway to 1 + sway.
        """
        lowest = edge.alpha - turn
        kept = (1.0 - sway > 0.0) & (lowest >= _LOWEST)
        slowed = 2.0 * edge.damping * turn
        for n in range(_PARTS):
            # z on a part of the path, and the worst value of each of its functions.
            low, high = (
                lowest + (edge.alpha - lowest) * (n + i) / _PARTS for i in (0, 1)
            )
            cos = np.where(
                (low < 0.0) & (high > 0.0), 1.0, np.maximum(np.cos(low), np.cos(high))
            )
            steepest = np.maximum(np.abs(low), np.abs(high))
            sin = np.sin(np.minimum(steepest, 0.5 * np.pi))

            # The speed by the work of weight and push, then Fz at this speed.
            square = self._largest_square(lowest, high, push, 1.0 + sway)
            speed = np.minimum(
                slowed + np.sqrt(slowed**2 + np.maximum(square, 0.0)), fastest
            )
            still = self._fz_without_speed(edge, push, sway, steepest, sin, cos)
            downwards = speed * speed * cos + 2.0 * edge.damping * speed * sin
            kept &= still - edge.kappa * downwards > 0.0
        return kept

    def _largest_square(
        self, lowest: Array, high: Array, push: Array, heavy: Array | float
    ) -> Array:
        """The largest u'^2 at z up to `high`, undamped: the work of the largest push
        and weight on the way to the peak, at z = `lowest`.
        """
        down, bottom = np.maximum(high, 0.0), np.maximum(lowest, 0.0)
        if self.linear:
            return heavy * (down**2 - bottom**2) + 2.0 * push * (high - lowest)
        return np.asarray(
            2.0
            * (
                heavy * (np.cos(bottom) - np.cos(down))
                + push * (np.sin(high) - np.sin(lowest))
            )
        )

    def _fz_without_speed(
        self,
        edge: Edge,
        push: Array,
        sway: Array | float,
        steepest: Array,
        sin: Array,
        cos: Array,
    ) -> Array:
        """A bound of Fz/(m g) of a body without speed, where |z|, |sin z| and cos z are
        at most steepest, sin and cos.
        """
        light, heavy = 1.0 - sway, 1.0 + sway
        if self.linear:
            return light - edge.kappa * (heavy * steepest * sin + push * sin)
        return light * (1.0 - edge.kappa * sin * sin) - edge.kappa * push * sin * cos


def safe_acceleration(body: Body, edge: int, ratio: float, low: bool = False) -> Any:
    """Return the largest ground acceleration [g], times a_scale, of either sign, under
    which a body that does not overturn is proved to keep contact (Fz > 0), a float or
    (cells,). edge: 0 right, 1 left; ratio: the largest |w - 1| over this acceleration,
    w the weight over m g; low: True for a body whose energy stays below the barrier.
    """
    alpha = body.alpha[edge]
    if isinstance(alpha, float):
        return _safe_acceleration(body, edge, ratio, low)
    numbers = np.array([alpha, body.kappa[edge], body.damping])
    kinds, which = np.unique(numbers, axis=1, return_inverse=True)
    return _safe(body, body._edge(*kinds), ratio, low)[which.ravel()]


@lru_cache(maxsize=4096)
def _safe_acceleration(body: Body, edge: int, ratio: float, low: bool) -> float:
    return float(_safe(body, body.edges[edge], ratio, low)[0])


def _safe(body: Body, edge: Edge, ratio: float, low: bool) -> Array:
    """The largest of `_ACCELERATIONS` for which contact is proved on these edges, 0 if
    there is none, (edges,). A proof holds for all smaller ones too: of every 16th one
    first, then of those between.
    """
    last = _ACCELERATIONS.size - 1
    found = np.full(np.size(edge.alpha), -1)
    # Below the barrier no body turns farther than alpha, or faster than a fall from it.
    fastest = np.sqrt(body.fall(edge, edge.alpha)) if low else np.inf
    for step in (16, 1):
        tried = np.minimum(found + step * np.arange(1, 17)[:, None], last)
        push = _ACCELERATIONS[tried]
        sway = ratio * push
        with np.errstate(all="ignore"):
            # Without overturning u stays below the equilibrium.
            slope = np.where(sway < 1.0, push / (1.0 - sway), np.inf)
            turn = edge.alpha + (slope if body.linear else np.arctan(slope))
            if low:
                turn = np.broadcast_to(edge.alpha, push.shape)
            kept = body.contact_proved(edge, push, turn, sway, fastest)
        found = found + step * np.logical_and.accumulate(kept).sum(axis=0)
    found = np.minimum(found, last)
    return np.where(found < 0, 0.0, _ACCELERATIONS[np.maximum(found, 0)])
