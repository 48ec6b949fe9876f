"""Mechanisms of one degree of freedom, and their rocking parameters (section 3.2 of the
paper).

One coordinate phi >= 0 moves rigid links; phi = 0 at rest. With the velocity field u =
dx/dphi,

    M(phi) = int rho u.u dV,   V'(phi) = g int rho u_z dV,   B(phi) = int rho u_x dV
    M phi'' + M'/2 phi'^2 + V' = -B xg''                                    (Eq. 3.4)

A `Linkage` moves so. A single rigid body has closed forms (`single_body`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from ...errors import StructureError

if TYPE_CHECKING:
    from .linkage import Linkage

_FIRST_SCAN = 0.1  # rad, where an equilibrium is looked for first


class Coefficients(NamedTuple):
    """Coefficients of Eq. 3.4 at a rotation phi, for any density."""

    inertia: Any  # M [kg m2]
    lift: Any  # V'/g [kg m]
    push: Any  # B > 0 [kg m]


class Linearised(NamedTuple):
    """A mechanism linearised at its unstable equilibrium (Eqs. 3.5-3.9)."""

    alpha: float  # critical angle [rad]
    uplift: float  # lambda [-]
    stiffness: float  # p^2/g [1/m]
    a_scale: float  # by Eq. 3.9 [-]
    a_scale_3_7: float  # by Eq. 3.7 [-]


def linearise(mechanism: Linkage) -> Linearised:
    """Return the parameters of a mechanism. Raises StructureError if it does not stand
    or has no unstable equilibrium.
    """
    at_rest = mechanism.coefficients(0.0)
    uplift = float(at_rest.lift / at_rest.push)
    if not uplift > 0.0:
        raise StructureError(
            f"does not stand: its uplift acceleration lambda is {uplift:.4g}"
        )
    alpha = equilibrium(mechanism)
    negative_stiffness = -mechanism.lift_slope(alpha)
    if not negative_stiffness > 0.0:
        raise StructureError(
            "reaches its unstable equilibrium where the links lock, and has no linear"
            " form there"
        )
    there = mechanism.coefficients(alpha)
    return Linearised(
        alpha=alpha,
        uplift=uplift,  # Eq. 3.8: V'/(g B) at rest
        stiffness=negative_stiffness / float(there.inertia),  # Eq. 3.5
        a_scale=alpha / uplift,  # Eq. 3.9: the linear form lifts at lambda too
        a_scale_3_7=float(there.push) / negative_stiffness,
    )


def equilibrium(mechanism: Linkage) -> float:
    """Return alpha, the first rotation with V' = 0 [rad]. Raises StructureError if
    there is none within the reach of the mechanism.
    """
    import numpy as np

    low, end = 0.0, _FIRST_SCAN
    high = mechanism.reach_to(end)
    while True:  # sections: each round of one call narrows the bracket 512 times
        scan = np.linspace(low, high, 513)
        below = np.flatnonzero(np.asarray(mechanism.coefficients(scan).lift) <= 0.0)
        if below.size:
            first = int(below[0])
            if high - low <= 1e-15 * high:
                return float(scan[first])
            low, high = float(scan[first - 1]), float(scan[first])
            continue
        if high < end or end >= 0.5 * math.pi:
            raise StructureError(
                "the mechanism reaches no unstable equilibrium: its blocks collide or"
                " come apart before"
            )
        low, end = high, min(2.0 * end, 0.5 * math.pi)
        high = mechanism.reach_to(end)
