"""How rigid a body is: its frequency on a fixed base over p = sqrt(g/R) of its mass
centre, and by how much its flexibility lowers the first amplitude at which it falls.

The frequency follows from the key `period`, or from Young's modulus as that of a
cantilever of constant section, whose flexibilities in bending and in shear add up
(Dunkerley): 1/omega_n^2 = 1/omega_b^2 + 1/omega_s^2 with

    omega_b = 1.8751^2 i/H^2 sqrt(E/rho)        first mode (Euler and Bernoulli)
    omega_s = pi/(2 H) sqrt(kappa G/rho)        kappa of Cowper (1966)

i is the radius of gyration of the section, H the height. Without rotatory inertia
omega_n is above that of Timoshenko's beam: by 1 % if the height is 4 widths, by 3 % if
it is one. Without shear it would be above it by 4 % and 53 %.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ..documents.document import Document
from .parameters import RockingParameters
from .shared_keys import has_loads

if TYPE_CHECKING:
    from .mechanics.single_body import RigidBody

# omega_n/p, and by how much the first fall under one sine is lower than that of the
# rigid body, at most [-]: one lumped mass on its column, zeta = 0.05, alpha 0.1 and 0.2
_LOWER = {3: 0.38, 4: 0.29, 6: 0.17, 8: 0.13, 10: 0.10, 15: 0.06, 20: 0.03}
RIGIDITY = ("omega_n", "omega_n_over_p")  # what is told of a body with a period
_FIRST = 1.875104068711961  # least positive root of cos x cosh x = -1
# kappa G/E at nu = 0.2: 5/(12 + 11 nu) of a rectangle, 3/(7 + 6 nu) of a circle
_SHEAR = 0.35
_STEEPEST = 2.0  # (omega_n/p) sin(alpha) above which no table covers a body


def rigidity_of(
    document: Document, body: RockingParameters
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return (omega_n [rad/s] and omega_n_over_p [-] by their names, a sentence on a
    body that is not rigid), both empty without the keys `period` and `youngs_modulus`,
    or omega_n as params prints it. Raises DocumentError for a body whose mass centre is
    not known.
    """
    keys = ("period", "youngs_modulus", RIGIDITY[0])
    key = next(filter(document.has, keys), None)
    if key is None:
        return {}, ()
    value = document.values[key]
    if body.arm is None:
        raise document.fault(key, str(value), f"no {key} of a body without one arm")
    omega = body.details.get(RIGIDITY[0])  # stated, or by `of_cantilever`
    if omega is None:
        omega = 2.0 * math.pi / document.quantity(key)
    ratio = omega / math.sqrt(body.gravity / body.arm)
    found = dict(zip(RIGIDITY, (omega, ratio), strict=True))
    if ratio >= max(_LOWER):
        return found, ()
    told = f"{value.place}: {key}: omega_n/p = {ratio:.3g}: the body is not rigid; "
    if ratio < min(_LOWER) or ratio * math.sin(body.alpha) > _STEEPEST:
        return found, (told + "no table says what it bears",)
    lower = _LOWER[max(least for least in _LOWER if least <= ratio)]
    sentence = (
        f"it may fall from an amplitude up to {100.0 * lower:.0f} % lower on (one"
        " lumped mass under one sine)"
    )
    return found, (told + sentence,)


def of_cantilever(document: Document, body: RigidBody) -> dict[str, float]:
    """Return omega_n [rad/s] by its name of a body on a fixed base, from the key
    `youngs_modulus`; empty without the key. Raises DocumentError for a body whose
    section or density is not known, and for the key beside `period` or `loads`.
    """
    key, foot = "youngs_modulus", body.foot
    if not document.has(key):
        return {}
    if document.has("period"):
        raise document.fault(key, f"{key} together with period", "one of them")
    if body.shaft is None or isinstance(foot, str) or has_loads(document):
        of = "loads" if has_loads(document) else "no known and constant section"
        raise document.fault(
            key, f"{key} of a body with {of}", "period, on a fixed base"
        )
    if foot.mass is None:
        raise document.missing(foot.missing, f"{key} needs the mass of a volume")
    height, area = body.shaft, foot.area
    speed = document.quantity(key) * area.area * height / foot.mass  # E/rho [m2/s2]
    bending = height**2 / (_FIRST**2 * area.gyration)
    shear = height / (0.5 * math.pi * math.sqrt(_SHEAR))
    return {RIGIDITY[0]: math.sqrt(speed) / math.hypot(bending, shear)}
