"""Any mechanism of one degree of freedom: what it takes to be one, and what it comes to (section 3.2 of the paper).

Rigid links are moved by one coordinate phi >= 0, which is 0 at rest. With the velocity field u = dx/dphi,

    M(phi) = int rho u.u dV,   V'(phi) = g int rho u_z dV,   B(phi) = int rho u_x dV
    M phi'' + M'/2 phi'^2 + V' = -B xg''                                                          (Eq. 3.4)

A new mechanism is a class with `coefficients` and `overlap`; a single rigid body has closed forms (`single_body`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from ...errors import StructureError

# Central differences of eighth order: weights of the values at 1 ... 4 steps on either side.
_WEIGHTS = (4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0)


class Moments(NamedTuple):
    """Integrals of a body over its section: mass [kg], first moments of x and z [kg m], of x^2 + z^2 [kg m2]; any density."""

    mass: Any
    x: Any
    z: Any
    polar: Any

    def plus(self, other: Moments) -> Moments:
        """Of two bodies together."""
        return Moments(*(a + b for a, b in zip(self, other, strict=True)))

    def minus(self, other: Moments) -> Moments:
        """Of the body that is left when another is cut out."""
        return Moments(*(a - b for a, b in zip(self, other, strict=True)))

    def about(self, x: Any, z: Any) -> Any:
        """Moment of inertia about the point (x, z)."""
        return self.polar - 2.0 * (x * self.x + z * self.z) + (x * x + z * z) * self.mass


class Spin(NamedTuple):
    """Velocity field of a rigid link, u = (x0 + omega z, z0 - omega x), omega positive when it leans towards +x."""

    x0: Any
    z0: Any
    omega: Any

    def product(self, other: Spin, body: Moments) -> Any:
        """int rho u.w dV over a body that moves in both fields."""
        straight = self.x0 * other.x0 + self.z0 * other.z0
        along_x = self.z0 * other.omega + other.z0 * self.omega
        along_z = self.x0 * other.omega + other.x0 * self.omega
        return straight * body.mass - along_x * body.x + along_z * body.z + self.omega * other.omega * body.polar


def spin_about(x: float, z: float, omega: float = 1.0) -> Spin:
    """Rotation about the point (x, z)."""
    return Spin(-omega * z, omega * x, omega)


class Coefficients(NamedTuple):
    """M(phi) [kg m2], V'(phi)/g [kg m] and B(phi) [kg m] of Eq. 3.4, for any density; B > 0."""

    inertia: Any
    lift: Any
    push: Any


class Mechanism(Protocol):
    """What a mechanism has to provide; immutable, so that what follows from it is computed once. It may raise StructureError."""

    def __hash__(self) -> int: ...

    @property
    def reach(self) -> float:
        """Largest rotation phi [rad] at which the links still fit together."""
        ...

    def coefficients(self, phi: Any) -> Coefficients:
        """M, V'/g and B at rotations phi [rad], of any shape."""
        ...

    def overlap(self) -> tuple[float, float]:
        """(int u.w over the material that moves before and after an impact, int w.w after it), from momentum."""
        ...


@dataclass(frozen=True)
class Linearised:
    """A mechanism linearised at its unstable equilibrium (Eqs. 3.5-3.9).

    alpha [rad]; uplift lambda [-]; stiffness: G_eq/I_eq [1/m], p^2 = g times it; a_scale (Eq. 3.9) and a_scale_3_7
    (Eq. 3.7) [-]; eta from momentum [-].
    """

    alpha: float
    uplift: float
    stiffness: float
    a_scale: float
    a_scale_3_7: float
    eta: float


def linearise(mechanism: Mechanism) -> Linearised:
    """Parameters of a mechanism from its coefficients. Raises StructureError when it does not stand or never becomes unstable."""
    at_rest = mechanism.coefficients(0.0)
    uplift = float(at_rest.lift / at_rest.push)
    if not uplift > 0.0:
        raise StructureError(f"does not stand: its uplift acceleration lambda is {uplift:.4g}")
    alpha = equilibrium(mechanism)
    falling = -_slope_of_lift(mechanism, alpha)
    if not falling > 0.0:
        raise StructureError("reaches its unstable equilibrium where the links lock, and has no linear form there")
    there = mechanism.coefficients(alpha)
    shared, own = mechanism.overlap()
    return Linearised(
        alpha=alpha,
        uplift=uplift,
        stiffness=falling / float(there.inertia),
        a_scale=alpha / uplift,
        a_scale_3_7=float(there.push) / falling,
        eta=float(shared / own),
    )


def _slope_of_lift(mechanism: Mechanism, alpha: float) -> float:
    """V''(alpha)/g. The step is a hundredth of the way to rest or to where the links lock, on which the lift is smooth."""
    step = 0.01 * min(alpha, mechanism.reach - alpha)
    if not step > 1e-9 * alpha:
        return 0.0
    return sum(
        weight * float(mechanism.coefficients(alpha + i * step).lift - mechanism.coefficients(alpha - i * step).lift) / step
        for i, weight in enumerate(_WEIGHTS, 1)
    )


def equilibrium(mechanism: Mechanism) -> float:
    """alpha: the first rotation at which V' = 0 [rad]. Raises StructureError when there is none within reach."""
    import numpy as np
    from scipy.optimize import brentq

    def lift(phi: float) -> float:
        return float(mechanism.coefficients(phi).lift)

    scan = np.linspace(0.0, mechanism.reach, 513)
    lifts = np.asarray(mechanism.coefficients(scan).lift)
    below = np.flatnonzero(lifts <= 0.0)
    if not below.size:
        raise StructureError("never reaches an unstable equilibrium within the reach of its links")
    first = int(below[0])
    return float(brentq(lift, scan[first - 1], scan[first], xtol=1e-16, rtol=8.9e-16, maxiter=500))


@dataclass(frozen=True)
class EdgeRocker:
    """The mechanism of one rigid body that rocks about (pivot, 0) and, after an impact, about (-pivot, 0)."""

    body: Moments
    pivot: float
    shared: Moments | None = None

    @property
    def reach(self) -> float:
        """A body may turn until it lies on its side."""
        return math.pi / 2

    def coefficients(self, phi: Any) -> Coefficients:
        """M R^2-like constants times the sine and cosine of alpha - phi (Eq. 2.1)."""
        import numpy as np

        x, z = self.pivot * self.body.mass - self.body.x, self.body.z
        sin, cos = np.sin(phi), np.cos(phi)
        return Coefficients(self.body.about(self.pivot, 0.0) + 0.0 * sin, x * cos - z * sin, z * cos + x * sin)

    def overlap(self) -> tuple[float, float]:
        """Rotation back about one edge against rotation on about the other, over what moves in both."""
        back, onward = spin_about(self.pivot, 0.0, -1.0), spin_about(-self.pivot, 0.0, -1.0)
        return back.product(onward, self.shared or self.body), onward.product(onward, mirrored(self.body))


def mirrored(body: Moments) -> Moments:
    """The mirror image in x."""
    return Moments(body.mass, -body.x, body.z, body.polar)
