"""Integrals over the section of a body."""

from __future__ import annotations

from typing import Any, NamedTuple

# how a load takes part in the motion
BOTH, VERTICAL, NONE = "both", "vertical", "none"
INERTIAS = (BOTH, VERTICAL, NONE)


class Moments(NamedTuple):
    """Integrals over the section of a body."""

    mass: Any  # [kg]
    x: Any  # first moment [kg m]
    z: Any  # first moment [kg m]
    polar: Any  # moment of x^2 + z^2 [kg m2]

    def plus(self, other: Moments) -> Moments:
        """Return the moments of two bodies together."""
        return Moments(*(a + b for a, b in zip(self, other, strict=True)))

    def minus(self, other: Moments) -> Moments:
        """Return the moments of this body without another one that is cut out of it."""
        return Moments(*(a - b for a, b in zip(self, other, strict=True)))

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

    def between(self, a: tuple[float, float], b: tuple[float, float]) -> Any:
        """Return int (r - a).(r - b) dm [kg m2]: the angular momentum about b of a unit
        rotation about a.
        """
        (ax, az), (bx, bz) = a, b
        first = (ax + bx) * self.x + (az + bz) * self.z
        return self.polar - first + (ax * bx + az * bz) * self.mass
