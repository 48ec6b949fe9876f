"""The key `loads` of a body: floors, roofs and other weights that bear on it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import DocumentError
from .mechanics import plane
from .mechanics.assembly import (
    GROUND,
    Assembly,
    Hinge,
    Load,
    MechanismFault,
    PlanarBody,
)
from .mechanics.linkage_drawing import load_arrows
from .mechanics.mechanism_side import MechanismSide
from .mechanics.moments import BOTH
from .mechanics.planar_mechanism import PlanarMechanism
from .shared_keys import (
    BEARINGS,
    friction_of,
    given_restitution,
    gravity_of,
    has_loads,
    mass_of_load,
    restraints_in,
)
from .sketch import Point, Sketch, turned

if TYPE_CHECKING:
    from ..documents.document import Document
    from .mechanics.single_body import RigidBody
    from .parameters import RockingParameters

BODY = "body"  # name of a rigid body among the bodies of a mechanism
FAR, CENTRE, NEAR_EDGE = BEARINGS
_POINT = "a point [x, z], lengths in m or with a unit"


class Top(NamedTuple):
    """The flat top of a body."""

    far: tuple[float, float]  # x of `far` while theta > 0 and while theta < 0 [m]
    level: float  # z [m]


def loads_of(
    document: Document, top: Top | None, axis: float
) -> tuple[tuple[Load, ...], tuple[Load, ...]]:
    """Return the loads of a body, each with its bearing while theta > 0, and while
    theta < 0. Raises DocumentError. top: None for a body without a flat top; axis: x
    of the mirror of bearings [m].
    """
    if not has_loads(document):
        return (), ()
    gravity = gravity_of(document)
    right, left = list[Load](), list[Load]()
    for i, part in enumerate(document.parts("loads")):
        mass, inertia = mass_of_load(part, gravity), part.choice("inertia")
        stated = part.has("bearing")
        here, there = _on_top(part, top) if stated else _at(part, axis)
        if here != there and inertia == BOTH:
            require_still(part, f"loads.{i}", "bearing" if stated else "mirrored")
        right.append(Load(BODY, here, mass, inertia))
        left.append(Load(BODY, there, mass, inertia))
    return tuple(right), tuple(left)


def require_still(part: Document, path: str, key: str) -> None:
    """Raise DocumentError: a carried load would change its place."""
    raise DocumentError(
        f"{part.values[key].place}: {path}: a carried load (inertia: both) cannot"
        f" change its place; leave out {key}."
    )


def _on_top(part: Document, top: Top | None) -> tuple[Point, Point]:
    """Return the two places of a load that bears on the flat top."""
    where = part.choice("bearing")
    if top is None:
        raise part.fault(
            "bearing", "a bearing on a body without a flat top", f"at: {_POINT}"
        )
    (right, left), z = top.far, top.level
    if where == CENTRE:
        right = left = 0.5 * (right + left)
    elif where == NEAR_EDGE:
        right, left = left, right
    return (right, z), (left, z)


def _at(part: Document, axis: float) -> tuple[Point, Point]:
    """Return the two places of a load at a stated point."""
    if not part.has("at"):
        wanted = f"{_POINT}; or bearing: one of {', '.join(BEARINGS)}"
        raise part.missing("at", wanted)
    at = part.pair("at", part.values["at"], "length", "point", _POINT)
    return at, plane.mirrored(at, axis) if part.flag("mirrored") else at


def loaded(
    document: Document, body: RigidBody, more: dict[str, Any], on_edges: RigidBody
) -> RockingParameters:
    """Return the parameters of a rigid body with loads, by the equation of a mechanism
    (Eq. 3.4); with carried loads alone it is one rigid body (Eq. 2.3). more: fields of
    the parameters as without loads; on_edges: the body on pivots at its edges. Raises
    DocumentError.
    """
    if held := restraints_in(document):
        raise document.fault(
            held[0],
            f"{held[0]} of a body with loads, whose equation has no such part",
            f"no {held[0]}, or no loads",
        )
    mass = more["details"].get("mass")
    if mass is None:
        raise document.missing("mass", "the mass [kg] of the body, which loads need")
    planar = _mechanism(document, body, mass)
    found = parameters_of(document, planar, more["name"], more["structure"])
    remarks = (*more.get("remarks", ()), *found.remarks)
    details = dict(more["details"])
    if "alpha_geometric" in details:
        sides = _mechanism(document, on_edges, mass)
        numbers = [side.numbers(1.0) for side in (sides.right, sides.left) if side]
        weaker = min(numbers, key=lambda side: side["uplift"])
        details["alpha_geometric"] = weaker["alpha"]
    return replace(found, details=details, remarks=remarks, top=more["top"])


def parameters_of(
    document: Document,
    planar: PlanarMechanism,
    name: str,
    structure: str,
) -> RockingParameters:
    """Return the parameters of a mechanism that a document of another kind describes,
    with its gravity, restitution and friction; name, structure: as
    `PlanarMechanism.parameters` takes them. Raises DocumentError.
    """
    restitution, (friction, _) = given_restitution(document), friction_of(document)
    try:
        planar.right.require()
        if planar.left is not None:
            planar.left.require()
        return planar.parameters(
            name,
            structure,
            gravity=gravity_of(document),
            restitution=restitution,
            friction=friction,
        )
    except MechanismFault as fault:
        key = fault.path if fault.path in document.keys else "loads"
        place = document.keys.get(key, document.place)
        raise DocumentError(f"{place}: {fault}") from None


def _mechanism(document: Document, body: RigidBody, mass: float) -> PlanarMechanism:
    """Return a rigid body with its loads as a mechanism. Raises DocumentError."""
    (_, left), *_, (_, right) = body.drawing.pivots
    centre = body.drawing.centre
    if body.eta is not None or centre is None:
        raise document.fault(
            "loads",
            "loads on a body with other parts on each edge",
            "a body that rocks as a whole on both edges",
        )
    inertia = mass / body.moments.mass * max(0.0, body.moments.central)
    # its base between the pivots: its only face
    whole = PlanarBody(BODY, mass, centre, inertia, (left, right, centre))
    bearings = loads_of(document, top_of(body.drawing), 0.5 * (left[0] + right[0]))
    sides = []
    for name, pivot, loads in zip(
        ("right", "left"), (right, left), bearings, strict=True
    ):
        _require_standing(document, whole, pivot, loads, name)
        assembly = Assembly((whole,), loads)
        joints = (Hinge((GROUND, BODY), pivot),)
        sides.append(MechanismSide(assembly, joints, BODY))
    one_sided = document.flag("one_sided")
    return PlanarMechanism(sides[0], None if one_sided else sides[1], False)


def _require_standing(
    document: Document,
    body: PlanarBody,
    pivot: Point,
    loads: Sequence[Load],
    side: str,
) -> None:
    """Raise DocumentError if the weights turn the body over an edge at rest."""
    weights = [(body.mass, body.centre), *((load.mass, load.at) for load in loads)]
    moments = [mass * (pivot[0] - x) for mass, (x, _) in weights]
    resisting = math.fsum(moments) * (1.0 if side == "right" else -1.0)
    if not resisting > 1e-9 * sum(map(abs, moments)):
        raise DocumentError(
            f"{document.keys['loads']}: loads: it does not stand: its weight and its"
            f" loads turn it over its {side} edge."
        )


def top_of(drawing: Sketch) -> Top | None:
    """Return the flat top of a body on two edges, None without one. Far from the edge
    on which it stands is the corner that rises.
    """
    top = plane.top_of([point for outline in drawing.bodies for point in outline])
    far = min(x for x, _ in top), max(x for x, _ in top)
    return Top(far, max(z for _, z in top)) if far[1] > far[0] else None


def drawn_with_loads(
    document: Document, drawing: Sketch, built: RockingParameters
) -> Sketch:
    """Return the drawing of a rigid body with its loads as arrows, turned by alpha
    about its right edge.
    """
    (_, left), *_, (_, right) = drawing.pivots
    loads, _ = loads_of(document, top_of(drawing), 0.5 * (left[0] + right[0]))
    alpha = built.sides[1].alpha if built.sides else built.alpha
    size = max(z for outline in drawing.bodies for _, z in outline)
    assert drawing.centre is not None
    carried = [(load.mass, load.at) for load in loads if load.inertia == BOTH]
    parts = [(built.details["mass"], drawing.centre), *carried]
    whole = math.fsum(mass for mass, _ in parts)
    x, z = (math.fsum(mass * at[i] for mass, at in parts) / whole for i in (0, 1))
    return replace(
        drawing,
        centre=(x, z),
        moved=tuple(turned(outline, right, alpha) for outline in drawing.bodies),
        arrows=load_arrows(loads, built.gravity, 0.12 * size),
    )
