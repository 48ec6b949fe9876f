"""The toe of a body at the verge of overturning: its edge crushes until the area that
is left carries the vertical force N at the strength f of a rectangular block of stress.

The pivot is the centroid of the crushed area N/f at the edge, so the edge moves inwards
by `inset`:

    rectangle of the length L across the rocking    inset = N/(2 f L)
    circle or ring                                  the chord that cuts off N/f

A static inset is enough: with one that follows Fz(t) the capacity changes by less than
0.1 % under a sine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from ..shared_keys import gravity_of, mass_of, weight_of_loads

if TYPE_CHECKING:
    from ...documents.document import Document

LARGE = 0.1  # of the half width: a larger inset is remarked on


class Strip(NamedTuple):
    """A rectangular contact area."""

    width: float  # in the direction of rocking [m]
    length: float  # across it [m]; 1 where forces are those of a metre

    @property
    def area(self) -> float:
        """[m2]."""
        return self.width * self.length

    @property
    def half(self) -> float:
        """Half the width [m]."""
        return 0.5 * self.width

    @property
    def gyration(self) -> float:
        """Radius of gyration about the axis across the rocking [m]."""
        return self.width / math.sqrt(12.0)

    def inset(self, crushed: float) -> float:
        """Return the distance of the centroid of a crushed area [m2] from the edge."""
        return 0.5 * crushed / self.length


class RingBase(NamedTuple):
    """A circular contact area, with a hole of the same centre."""

    outer: float  # radius [m]
    inner: float = 0.0  # radius of the hole [m]

    @property
    def gyration(self) -> float:
        """Radius of gyration about a diameter [m]."""
        return 0.5 * math.hypot(self.outer, self.inner)

    @property
    def area(self) -> float:
        """[m2]."""
        return math.pi * (self.outer**2 - self.inner**2)

    @property
    def half(self) -> float:
        """Half the width [m]."""
        return self.outer

    def inset(self, crushed: float) -> float:
        """Return the distance of the centroid of a crushed area [m2], cut off by a
        chord, from the edge.
        """
        from scipy.optimize import brentq

        def cut_off(half_angle: float) -> tuple[float, float]:
            x = self.outer * math.cos(half_angle)
            area, moment = _segment(self.outer, half_angle)
            if not self.inner or x >= self.inner:
                return area, moment
            hole = _segment(self.inner, math.acos(max(-1.0, x / self.inner)))
            return area - hole[0], moment - hole[1]

        # the angle, not the chord: a small segment grows with its third power
        half_angle = brentq(
            lambda angle: cut_off(angle)[0] - crushed,
            0.0,
            math.pi,
            xtol=1e-300,
            rtol=1e-14,
        )
        return self.outer - cut_off(half_angle)[1] / crushed


def _segment(r: float, half_angle: float) -> tuple[float, float]:
    """Return (area [m2], first moment about the centre [m3]) of the segment of a circle
    of radius r within a half angle psi: r^2 (psi - sin psi cos psi) and 2/3 (r sin
    psi)^3.
    """
    twice = 2.0 * half_angle
    if half_angle < 0.05:  # by its series, where the difference cancels
        terms = (twice**3 / 6.0, -(twice**5) / 120.0, twice**7 / 5040.0)
        difference = 0.5 * sum(terms)
    else:
        difference = half_angle - 0.5 * math.sin(twice)
    return r * r * difference, 2.0 / 3.0 * (r * math.sin(half_angle)) ** 3


@dataclass(frozen=True)
class Foot:
    """The contact area on which a body rocks, and the mass on it."""

    area: Strip | RingBase  # of the whole foot
    mass: float | None  # on it [kg]; of a metre where the length is not known
    per_metre: bool = False  # True if forces and mass are those of a metre
    missing: str = "density"  # the key that would give the mass


def density_of(document: Document) -> float | None:
    """Return the document's density [kg/m3], None if absent. Raises DocumentError for
    one beside a mass.
    """
    if not document.has("density"):
        return None
    if document.has("mass"):
        raise document.fault("density", "density together with mass", "one of them")
    return document.quantity("density")


def foot_of(
    document: Document,
    base: float | RingBase,
    volume: float,
    across: str = "length",
) -> tuple[Foot, dict[str, float]]:
    """Return (the foot of a body, its mass as a detail if a density gives it). base:
    its area, or its width [m] and then `across` the key of its length; volume: of the
    body [m3], or then of a metre. Raises DocumentError for a density from which no
    mass, stress or frequency follows.
    """
    density, mass = density_of(document), mass_of(document)
    length = 1.0 if isinstance(base, RingBase) else document.optional(across)
    area = base if isinstance(base, RingBase) else Strip(base, length or 1.0)
    if density is None:
        known = mass is not None and length is not None
        missing = "density" if "density" in document.table else "mass"
        if mass is not None:
            missing = across
        return Foot(area, mass if known else None, missing=missing), {}
    mass = density * volume * (length or 1.0)
    if length is not None:
        return Foot(area, mass), {"mass": mass}
    if not (document.has("strength") or document.has("youngs_modulus")):
        raise document.missing(across, f"{across}, which gives the mass with density")
    return Foot(area, mass, per_metre=True), {}


class Toe(NamedTuple):
    """The toe of a body."""

    inset: float  # of its pivots from the edges [m]
    stress: float  # mean stress on the foot [Pa]
    remarks: tuple[str, ...]  # sentences on a large inset


def vertical_force(document: Document, foot: Foot) -> float:
    """Return the force N on a foot [N]: the weight of the body and of its loads, and
    the prestress of its tendon. Raises DocumentError.
    """
    mass = foot.mass
    if mass is None:
        key = foot.missing
        raise document.missing(key, f"{key}, which gives the weight on the toe")
    loads = weight_of_loads(document)
    force = mass * gravity_of(document) + loads
    if foot.per_metre and (loads or document.has("tendon")):
        raise document.missing(
            "length",
            "the length across the rocking, as the forces of loads and of a tendon need"
            " it",
        )
    if document.has("tendon"):
        part = document.part("tendon", document.values["tendon"])
        force += part.quantity("prestress")
    return force


def toe_of(document: Document, foot: Foot | str, name: str = "") -> Toe:
    """Return the toe of a body whose document states `strength`; foot: a text for a
    body whose toe is not known; name: of the interface. Raises DocumentError for that,
    for a strength that the mean stress exceeds, and for one beside `inset`.
    """
    if isinstance(foot, str):
        raise document.fault(
            "strength", f"strength of {foot}", "no strength, or an inset"
        )
    if document.has("inset"):
        raise document.fault("strength", "strength together with inset", "one of them")
    strength = document.quantity("strength")
    force = vertical_force(document, foot)
    stress = force / foot.area.area
    if not strength > stress:
        at = f" on {name}" if name else ""
        raise document.fault(
            "strength",
            f"{strength:.6g} Pa, not above the stress under the weight{at},"
            f" {stress / 1e6:.3g} MPa ({stress:.6g} Pa)",
            "a larger strength",
        )
    inset = foot.area.inset(force / strength)
    share = inset / foot.area.half
    remark = (
        f"{document.values['strength'].place}: strength: the pivots lie"
        f" {1e3 * inset:.3g} mm inside the edges, {100.0 * share:.2g} % of half the"
        " width; cracking and splitting are not in this model"
    )
    return Toe(inset, stress, (remark,) * (share > LARGE))
