"""Integrals over the section of a body, and velocity fields of rigid links."""

from __future__ import annotations

from typing import Any, NamedTuple


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


class Spin(NamedTuple):
    """The velocity field of a rigid link, u = (x0 + omega z, z0 - omega x)."""

    x0: Any  # horizontal velocity at the origin
    z0: Any  # vertical velocity at the origin
    omega: Any  # positive clockwise, towards +x

    def product(self, other: Spin, body: Moments) -> Any:
        """Return int rho u.w dV over a body, where u is this field and w
        the other one.
        """
        straight = self.x0 * other.x0 + self.z0 * other.z0
        along_x = self.z0 * other.omega + other.z0 * self.omega
        along_z = self.x0 * other.omega + other.x0 * self.omega
        return (
            straight * body.mass
            - along_x * body.x
            + along_z * body.z
            + self.omega * other.omega * body.polar
        )


def spin_about(x: float, z: float, omega: float = 1.0) -> Spin:
    """Return the velocity field of a rotation about the point (x, z)."""
    return Spin(-omega * z, omega * x, omega)
