"""A single rigid body that rocks about the ends of its base: the paper's section 2 for any section."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..documents.document import Document
from .kinematics import Moments
from .parameters import RockingParameters
from .shared_keys import gravity_of, restitution_of


def rigid_body(
    document: Document,
    kind: str,
    name: str,
    *,
    radius: float,
    alpha: float,
    inertia: float,
    limit: str,
    eta: float | None = None,
    details: Mapping[str, Any] | None = None,
) -> RockingParameters:
    """Parameters of one rigid body from its distance R to the centroid, critical angle and inertia about the pivot.

    radius R [m]; alpha [rad]; inertia I_P / (M R^2) [-]; limit: the words for where eta < 0; eta: from momentum, where it
    is not that of a body which rocks as a whole on two edges, 1 - (M R^2/I_P)(1 - cos 2 alpha) (Eqs. 2.6, 3.3).
    p^2 = M g R / I_P, lambda = tan alpha (Eq. 2.2), a_scale = 1 (Eq. 2.4).
    """
    gravity = gravity_of(document)
    momentum = 1.0 - 2.0 * math.sin(alpha) ** 2 / inertia if eta is None else eta
    restitution, source = restitution_of(document, momentum, limit)
    return RockingParameters(
        name=name,
        structure=kind,
        p=math.sqrt(gravity / (radius * inertia)),
        alpha=alpha,
        eta=restitution,
        uplift=math.tan(alpha),
        a_scale=1.0,
        eta_source=source,
        gravity=gravity,
        details=details or {},
    )


def body_on_edge(
    document: Document,
    kind: str,
    name: str,
    body: Moments,
    pivot: float,
    *,
    limit: str,
    eta: float | None = None,
    details: Mapping[str, Any] | None = None,
) -> RockingParameters:
    """The same from a body's moments and the distance [m] of the pivots (+pivot, 0) and (-pivot, 0) from x = 0.

    The body rocks first about the pivot nearer to its centroid. Raises DocumentError when the centroid is beyond it.
    """
    x, z = pivot - abs(body.x) / body.mass, body.z / body.mass
    if not x > 0.0:
        raise document.fault(None, "a centroid that is not above the base", f"a {kind} that stands")
    radius = math.hypot(x, z)
    inertia = body.about(math.copysign(pivot, body.x), 0.0) / (body.mass * radius**2)
    alpha = math.atan2(x, z)
    return rigid_body(document, kind, name, radius=radius, alpha=alpha, inertia=inertia, limit=limit, eta=eta, details=details)


def radius_and_alpha(document: Document, half_width: float, centroid_height: float) -> tuple[float, float]:
    """(R, alpha) from radius and alpha, or from width and height.

    `half_width`, `centroid_height`: the centroid's distance from the pivot as parts of width and of height.
    """
    sizes = [key for key in ("width", "height") if document.has(key)]
    polar = [key for key in ("radius", "alpha") if document.has(key)]
    if sizes and polar:
        raise document.fault(polar[0], f"{polar[0]} beside {sizes[0]}", "width and height, or radius and alpha, not both")
    if sizes or not polar:
        x = half_width * document.length("width")
        z = centroid_height * document.length("height")
        return math.hypot(x, z), math.atan2(x, z)
    below = "an angle between 0 and 90 deg"
    return document.length("radius"), document.quantity("alpha", "angle", above=0.0, below=math.pi / 2, where=below)
