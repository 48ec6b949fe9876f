"""Mass, first and second moments of the section of a body, and what follows from them
for a body that rocks on its edges (section 2 of the paper, extended to unequal edges).

The mass centre is at the horizontal distances l and r from the left and right edge, at
height z; I_G is the moment of inertia about it. The body stands on its right edge while
theta > 0. An impact keeps the angular momentum about the new edge:

    eta_right = (I_G + m (z^2 - l r)) / (I_G + m (z^2 + l^2))
    eta_left  = (I_G + m (z^2 - l r)) / (I_G + m (z^2 + r^2))
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Self

Point = tuple[float, float]

# how a load takes part in the motion
BOTH, VERTICAL, NONE = "both", "vertical", "none"
INERTIAS = (BOTH, VERTICAL, NONE)


class Moments(NamedTuple):
    """Integrals over the section of a body."""

    mass: Any  # [kg]
    x: Any  # first moment [kg m]
    z: Any  # first moment [kg m]
    polar: Any  # moment of x^2 + z^2 [kg m2]

    @classmethod
    def of(cls, mass: float, centre: Point, inertia: float) -> Self:
        """Return the moments of a body with this moment of inertia about its mass
        centre [kg m2].
        """
        x, z = centre
        return cls(mass, mass * x, mass * z, inertia + mass * (x * x + z * z))

    @property
    def centre(self) -> Point:
        """The mass centre (x, z) [m]."""
        return self.x / self.mass, self.z / self.mass

    @property
    def central(self) -> float:
        """The moment of inertia about the mass centre [kg m2]."""
        return float(self.about(*self.centre))

    def times(self, factor: float) -> Self:
        """Return the moments of a body with another density."""
        return type(self)(*(factor * a for a in self))

    def plus(self, other: Moments) -> Moments:
        """Return the moments of two bodies together."""
        return Moments(*(a + b for a, b in zip(self, other, strict=True)))

    def minus(self, other: Moments) -> Moments:
        """Return the moments of this body without another one that is cut out of it."""
        return self.plus(other.times(-1.0))

    def shifted(self, x: float = 0.0, z: float = 0.0) -> Moments:
        """Return the moments of the body moved by x and z [m]."""
        polar = (
            self.polar
            + x * (2.0 * self.x + x * self.mass)
            + z * (2.0 * self.z + z * self.mass)
        )
        return Moments(self.mass, self.x + x * self.mass, self.z + z * self.mass, polar)

    def about(self, x: Any, z: Any) -> Any:
        """Return the moment of inertia about the point (x, z) [kg m2]."""
        return (
            self.polar - 2.0 * (x * self.x + z * self.z) + (x * x + z * z) * self.mass
        )

    def between(self, a: Point, b: Point) -> Any:
        """Return int (r - a).(r - b) dm [kg m2]: the angular momentum about b of a unit
        rotation about a.
        """
        (ax, az), (bx, bz) = a, b
        first = (ax + bx) * self.x + (az + bz) * self.z
        return self.polar - first + (ax * bx + az * bz) * self.mass


class BodyOnEdge(NamedTuple):
    """A body on one edge."""

    p: float  # frequency parameter [rad/s]: p^2 = M g R/I_P (Eq. 2.3)
    alpha: float  # critical angle [rad]
    uplift: float  # lambda [-]: tan alpha (Eq. 2.2)
    arm: Any  # R, distance to the mass centre [m]; None if it is not told
    # from angular momentum at the impact that leaves this edge [-] (Eqs. 2.6, 3.3),
    # negative if the body is too squat to rock
    eta: float = math.nan
    a_scale: float = 1.0  # [-] (Eq. 2.4)


def edge_at(
    body: Moments, pivot: Point, gravity: float, eta: float = math.nan
) -> BodyOnEdge:
    """Return the parameters of a body on a pivot (x, z) [m] below its mass centre; eta:
    its restitution, if it is known.
    """
    (x, z), (across, level) = pivot, body.centre
    distance, height = abs(x - across), level - z
    arm = math.hypot(distance, height)
    p = math.sqrt(gravity * arm * body.mass / body.about(x, z))
    return BodyOnEdge(p, math.atan2(distance, height), distance / height, arm, eta)


def edges_of(
    body: Moments, half: float, gravity: float
) -> tuple[BodyOnEdge, BodyOnEdge]:
    """Return the parameters on the left edge (-half, 0) and the right edge (half, 0)
    [m]; the mass centre must be above the base.
    """
    left, right = (-half, 0.0), (half, 0.0)
    # I_G + m (z^2 - l r), the angular momentum about one edge of a turn about the other
    shared = body.between(right, left)
    one = edge_at(body, left, gravity, shared / body.about(*right))
    if body.x == 0.0:
        return one, one
    return one, edge_at(body, right, gravity, shared / body.about(*left))
