"""A single rigid body that rocks about the two edges of its base (section 2 of the paper, extended to unequal edges).

The mass centre is at the horizontal distances l and r from the left and right edge, at height z; I_G is the moment of inertia
about it. The body stands on its right edge while theta > 0. An impact keeps the angular momentum about the new edge:

    eta_right = (I_G + m (z^2 - l r)) / (I_G + m (z^2 + l^2)),   eta_left = (I_G + m (z^2 - l r)) / (I_G + m (z^2 + r^2))

A one-sided body rocks on its right edge only. It returns, hits its base, then the backing, then its base again. With the vectors
r_L from its left edge and r_T from the impact point on the backing to the mass centre, its restitution is
e = eta_right eta_left (I_G + m r_L.r_T) / (I_G + m r_T^2) (Sorrentino et al. 2011).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from ...documents.document import Document
from ..parameters import RockingParameters, Side
from ..shared_keys import gravity_of, mass_of, one_sided_restitution_of, restitution_of
from .kinematics import Moments, spin_about

if TYPE_CHECKING:
    from ..sketch import Point


def rigid_body(
    document: Document,
    name: str,
    radius: float,
    alpha: float,
    inertia: float,
    *,
    limit: str,
    eta: float | None = None,
    backing: float | None = None,
    whole: bool = True,
    details: Mapping[str, Any] | None = None,
) -> RockingParameters:
    """The parameters of a rigid body with equal edges: p^2 = M g R/I_P, lambda = tan alpha (Eq. 2.2), a_scale = 1 (Eq. 2.4).

    radius: R, from the edge to the mass centre [m]; alpha [rad]; inertia: I_P/(M R^2) about the edge [-]; limit: states for which
    bodies eta >= 0; eta: from angular momentum, by default 1 - (M R^2/I_P)(1 - cos 2 alpha) (Eqs. 2.6, 3.3); backing: the factor of
    the impact on a backing, None if the geometry does not define it; whole: true if the same body rocks on both edges, so that its
    ground forces are known; details: as in `RockingParameters`. Raises DocumentError.
    """
    gravity = gravity_of(document)
    p, momentum = math.sqrt(gravity / (radius * inertia)), 1.0 - 2.0 * math.sin(alpha) ** 2 / inertia if eta is None else eta
    if one_sided := document.flag("one_sided"):
        eta, source = one_sided_restitution_of(document, (momentum, momentum), backing)
    else:
        eta, source = restitution_of(document, momentum, limit)
    kind, uplift, arm, details = _kind(document), math.tan(alpha), radius if whole else None, _with_mass(document, details)
    return RockingParameters(name, kind, p, alpha, eta, uplift, 1.0, source, gravity, details, one_sided=one_sided, arm=arm)


def rectangular_block(document: Document, name: str, radius: float, alpha: float, *, limit: str, **more: Any) -> RockingParameters:
    """The parameters of a rectangle of half diagonal `radius` [m]: p^2 = 3g/(4R), eta = 1 - 3/2 sin^2 alpha.

    One-sided, it hits its backing at its top: e = (1 - 3/2 sin^2 alpha)^2 (1 - 3/2 cos^2 alpha). Raises DocumentError.
    """
    return rigid_body(document, name, radius, alpha, 4.0 / 3.0, limit=limit, backing=1.0 - 1.5 * math.cos(alpha) ** 2, **more)


def symmetric_body(
    document: Document, name: str, body: Moments, half: float, *, top: Point | None = None, **more: Any
) -> RockingParameters:
    """The parameters of a body on its right edge (half, 0) [m]; the body that rocks on the left edge is its mirror image.

    top: (x, z) [m] of the impact point on a backing, None if the geometry does not define it; more: as for `rigid_body`.
    Raises DocumentError if the mass centre is not above the base.
    """
    _demand_above_base(document, body, half)
    right, z = half - body.x / body.mass, body.z / body.mass
    radius = math.hypot(right, z)
    inertia, alpha = body.about(half, 0.0) / (body.mass * radius**2), math.atan2(right, z)
    return rigid_body(document, name, radius, alpha, inertia, backing=_against_backing(body, half, top), **more)


def body_on_edges(
    document: Document,
    name: str,
    body: Moments,
    half: float,
    *,
    limit: str,
    top: Point | None = None,
    details: Mapping[str, Any] | None = None,
) -> RockingParameters:
    """The parameters of a body that rocks as a whole on the edges (-half, 0) and (half, 0) [m]; arguments as for `symmetric_body`."""
    _demand_above_base(document, body, half)
    if abs(body.x) <= 1e-13 * math.sqrt(body.mass * body.polar):  # the offset is rounding
        body = body._replace(x=0.0)
    gravity, kind = gravity_of(document), _kind(document)
    left, right = edges_of(body, half, gravity)
    if body.x == 0.0:
        return symmetric_body(document, name, body, half, limit=limit, eta=right.eta, top=top, details=details)
    more = _with_mass(document, details)
    if document.flag("one_sided"):
        e, source = one_sided_restitution_of(document, (right.eta, left.eta), _against_backing(body, half, top))
        return RockingParameters(
            name, kind, right.p, right.alpha, e, right.uplift, 1.0, source, gravity, more, one_sided=True, arm=right.arm
        )
    eta_left, source = restitution_of(document, left.eta, limit)
    eta_right, _ = restitution_of(document, right.eta, limit)
    more["direction"] = "over the left edge" if body.x < 0.0 else "over the right edge"
    return RockingParameters.of_sides(
        name, kind, left.side("left", eta_left), right.side("right", eta_right), eta_source=source, gravity=gravity, details=more
    )


def _kind(document: Document) -> str:
    return str(document.values["kind"].content)


def _with_mass(document: Document, details: Mapping[str, Any] | None) -> dict[str, Any]:
    """The details of a body, and its mass [kg] if the document states it."""
    mass = mass_of(document)
    return {**(details or {}), **({} if mass is None else {"mass": mass})}


class Edge(NamedTuple):
    """A body on one edge: p [rad/s], alpha [rad], lambda [-], eta from angular momentum at the impact that leaves this edge
    (negative if the body is too squat to rock), and the distance R to the mass centre [m]."""

    p: float
    alpha: float
    uplift: float
    eta: float
    arm: float

    def side(self, name: str, eta: float) -> Side:
        """The parameters on this edge with the restitution `eta`."""
        return Side(name, self.p, self.alpha, self.uplift, 1.0, eta, self.arm)


def edges_of(body: Moments, half: float, gravity: float) -> tuple[Edge, Edge]:
    """The parameters on the left edge (-half, 0) and the right edge (half, 0) [m]; the mass centre must be above the base."""
    z = body.z / body.mass
    shared = spin_about(half, 0.0).product(spin_about(-half, 0.0), body)  # I_G + m (z^2 - l r)

    def on(edge: float) -> Edge:
        distance = abs(edge - body.x / body.mass)
        arm = math.hypot(distance, z)
        p = math.sqrt(gravity * arm * body.mass / body.about(edge, 0.0))
        return Edge(p, math.atan2(distance, z), distance / z, shared / body.about(-edge, 0.0), arm)

    return on(-half), on(half)


def _demand_above_base(document: Document, body: Moments, half: float) -> None:
    """Raise DocumentError if the mass centre is not above the base."""
    if not (abs(body.x / body.mass) < half and body.z > 0.0):
        raise document.fault(None, "a centroid that is not above the base", f"a {_kind(document)} that stands")


def _against_backing(body: Moments, half: float, top: Point | None) -> float | None:
    """(I_G + m r_L.r_T)/(I_G + m r_T^2), the factor of the impact on the backing at T = `top`; None without `top`."""
    if top is None:
        return None
    x, z = body.x / body.mass, body.z / body.mass
    central = body.about(x, z)
    return (central + body.mass * ((x + half) * (x - top[0]) + z * (z - top[1]))) / body.about(*top)


def radius_and_alpha(document: Document, centroid: float = 0.5) -> tuple[float, float]:
    """(R [m], alpha [rad]) from radius and alpha, or from width and height. Raises DocumentError.

    The mass centre is at width/2 from the edge and at `centroid` x height.
    """
    sizes = [key for key in ("width", "height") if document.has(key)]
    polar = [key for key in ("radius", "alpha") if document.has(key)]
    if sizes and polar:
        raise document.fault(polar[0], f"{polar[0]} together with {sizes[0]}", "width and height, or radius and alpha, not both")
    if sizes or not polar:
        x, z = 0.5 * document.length("width"), centroid * document.length("height")
        return math.hypot(x, z), math.atan2(x, z)
    below = "an angle between 0 and 90 deg"
    return document.length("radius"), document.quantity("alpha", "angle", above=0.0, below=math.pi / 2, where=below)
