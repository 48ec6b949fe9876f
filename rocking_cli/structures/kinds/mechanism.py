"""Any planar mechanism of rigid bodies with one degree of freedom: bodies, joints and
loads, in both directions.
"""

import math
from collections.abc import Sequence

from ...documents.document import Document
from ...documents.keys import Key, Keys, length, positive
from ...errors import DocumentError
from ..load_keys import require_still
from ..mechanics.admissibility import place
from ..mechanics.assembly import (
    GROUND,
    NEAR,
    Assembly,
    Hinge,
    Joint,
    Load,
    MechanismFault,
    PlanarBody,
    Rigid,
    Slide,
    on_outline,
)
from ..mechanics.linkage_drawing import drawn, linkages_of
from ..mechanics.moments import BOTH
from ..mechanics.planar_mechanism import PlanarMechanism, find_mechanism
from ..mechanics.plane import polygon_moments
from ..parameters import RockingParameters
from ..shared_keys import (
    DENSITY,
    LOADS_ON_BODIES,
    POINT,
    friction_of,
    given_restitution,
    gravity_of,
    mass_of_load,
)
from ..sketch import Point, Sketch
from .prism import CORNERS, corners_of

REPORTS = (
    "a_scale_3_7",
    "energy_kept",
    "impulses_inside",
    "joints",
    "joints_other",
    "joints_source",
    "lambda_governing",
    "top_reaction",
)
_BODY = (
    Keys({**CORNERS, "density": DENSITY}, {"length": length(usual=None)}),
    Keys(
        {"mass": positive("mass"), "centre": Key("pair"), "gyration": length()}, CORNERS
    ),
)
_JOINT = Keys(
    ways=(
        (
            Keys({"hinge": Key("names"), **POINT}),
            Keys({"slide": Key("name"), **POINT}, {"along": Key("pair", of="number")}),
            Keys({"rigid": Key("names")}),
        ),
    )
)
_JOINTS = Key("parts", inner=_JOINT)
KEYS = Keys(
    {"bodies": Key("named", "in section", inner=Keys(ways=(_BODY,)))},
    {
        "joints": _JOINTS.narrowed(doc="towards +x; without a hinge they are searched"),
        "other_side": _JOINTS.narrowed(doc="towards -x", words=("mirrored",)),
        "loads": Key("parts", "floors, roofs and others", inner=LOADS_ON_BODIES),
        "rotation_of": Key(
            "name", "theta is its rotation; absent: the first that turns"
        ),
        "rotation_of_other": Key("name", "on the other side"),
        "ground": Key("length", "its level; absent: that of the lowest corner"),
        "axis": Key("length", "x of the mirror; absent: the middle of the outlines"),
        "one_sided": Key("flag", "true: towards +x only"),
    },
)
_POINT = "a point [x, z], lengths in m or with a unit"


def build(document: Document, name: str) -> RockingParameters:
    """Return the parameters of a mechanism. Raises DocumentError. Keys: bodies, joints,
    other_side, loads, rotation_of, rotation_of_other, ground, axis.
    """
    gravity, (friction, _) = gravity_of(document), friction_of(document)
    try:
        return _found(document, gravity).parameters(
            name,
            "mechanism",
            gravity=gravity,
            restitution=given_restitution(document),
            friction=friction,
        )
    except MechanismFault as fault:
        raise _placed(document, fault) from None


def _placed(document: Document, fault: MechanismFault) -> DocumentError:
    """Return the error for a fault, at the place of the key that states it."""
    value, key = document.value_at(fault.path), fault.path.partition(".")[0]
    where = value.place if value else document.keys.get(key, document.place)
    return DocumentError(f"{where}: {fault}")


def _found(document: Document, gravity: float) -> PlanarMechanism:
    """Return the mechanism of a document. Raises DocumentError and MechanismFault."""
    bodies = _bodies(document)
    level = document.optional("ground")
    assembly = Assembly(bodies, _loads(document, bodies, gravity), level)
    joints = _joints(document, "joints", assembly) if document.has("joints") else ()
    one_sided = document.flag("one_sided")
    stated = document.has("other_side")
    if stated and one_sided:
        raise document.fault(
            "other_side", "a one-sided mechanism", "other_side or one_sided, not both"
        )
    other = None
    if stated and document.values["other_side"].content != "mirrored":
        other = _joints(document, "other_side", assembly)
    return find_mechanism(
        assembly,
        joints,
        other=other,
        axis=document.optional("axis"),
        coordinate=_turning(document, "rotation_of", assembly),
        other_coordinate=_turning(document, "rotation_of_other", assembly),
        one_sided=one_sided,
    )


def _turning(document: Document, key: str, assembly: Assembly) -> str | None:
    """Return the name of a body that a key states, None without it."""
    if not document.has(key):
        return None
    return _body_name(document, key, assembly.names)


def _body_name(document: Document, key: str, names: Sequence[str]) -> str:
    return document.reference(key, document.values[key], names, "a body")


def _bodies(document: Document) -> tuple[PlanarBody, ...]:
    """Return the bodies of a document. Raises DocumentError."""
    wanted = "a mapping of names to bodies, each with corners and density"
    if not document.has("bodies"):
        raise document.missing("bodies", wanted)
    value = document.values["bodies"]
    if not isinstance(value.content, dict) or not value.content:
        raise document.fault("bodies", str(value), wanted)
    found = []
    for name, child in value.content.items():
        if name == GROUND or not name.strip() or "." in name:
            raise DocumentError(
                f"{child.place}: bodies: found the name {name!r}; expected another"
                f" name, without dots: {GROUND} is what the bodies stand on"
            )
        found.append(_body(document.part("bodies", child, f"bodies.{name}"), name))
    return tuple(found)


def _body(part: Document, name: str) -> PlanarBody:
    """Return a body from corners, density and length, or from mass, centre and
    gyration.
    """
    outline = tuple(corners_of(part)) if part.has("corners") else ()
    if part.has("mass"):
        mass = part.quantity("mass")
        centre, gyration = _point(part, "centre"), part.length("gyration")
        return PlanarBody(name, mass, centre, mass * gyration**2, outline)
    if not outline:
        raise part.missing("corners", "the outline, with density; or mass and centre")
    density, across = part.quantity("density"), part.optional("length") or 1.0
    x, z = polygon_moments(outline).centre
    # moments lose digits far from the centroid: move the outline there
    central = polygon_moments([(a - x, b - z) for a, b in outline])
    body = PlanarBody.of(name, central.times(density * across), outline)
    return body._replace(centre=(x + body.centre[0], z + body.centre[1]))


def _point(part: Document, key: str) -> Point:
    if not part.has(key):
        raise part.missing(key, _POINT)
    return part.pair(key, part.values[key], "length", "point", _POINT)


def _loads(
    document: Document, bodies: Sequence[PlanarBody], gravity: float
) -> tuple[Load, ...]:
    """Return the loads of a document. Raises DocumentError."""
    if not document.has("loads") or document.values["loads"].content == []:
        return ()
    names = [body.name for body in bodies]
    found = []
    for i, part in enumerate(document.parts("loads")):
        if not part.has("body"):
            raise part.missing("body", "the body on which the load bears")
        body = _body_name(part, "body", names)
        inertia = part.choice("inertia")
        mirrored, mass = part.flag("mirrored"), mass_of_load(part, gravity)
        found.append(Load(body, _point(part, "at"), mass, inertia, mirrored))
        if mirrored and inertia == BOTH:
            require_still(part, f"loads.{i}", "mirrored")
    return tuple(found)


def _joints(document: Document, key: str, assembly: Assembly) -> tuple[Joint, ...]:
    """Return the joints of a key. Raises DocumentError."""
    return tuple(
        _joint(part, f"{key}.{i}", assembly)
        for i, part in enumerate(document.parts(key))
    )


def _joint(part: Document, path: str, assembly: Assembly) -> Joint:
    kind = next((key for key in ("hinge", "slide", "rigid") if part.has(key)), None)
    if kind is None:
        raise part.missing("hinge", _JOINT.in_words())
    value = part.values[kind]
    if kind == "slide":
        body = _body_name(part, "slide", assembly.names)
        along = (0.0, 1.0)
        if part.has("along"):
            wanted = "a direction [x, z] that is not [0, 0]"
            along = part.pair("along", part.values["along"], "number", "pair", wanted)
            if not math.hypot(*along) > 0.0:
                raise part.fault("along", str(part.values["along"]), wanted)
        return Slide(body, _point(part, "at"), along)
    names = (GROUND, *assembly.names)
    listed = value.content if isinstance(value.content, list) else []
    bodies = tuple(part.reference(kind, v, names, "a body") for v in listed)
    if len(set(bodies)) != len(bodies) or len(bodies) < 2:
        raise part.fault(kind, str(value), "a list of two or more different bodies")
    if kind == "rigid":
        return Rigid(bodies)
    if len(bodies) != 2:
        raise part.fault(kind, str(value), "two bodies")
    at = _point(part, "at")
    for name in bodies:
        if name != GROUND and not on_outline(
            assembly.body(name), at, NEAR * assembly.size
        ):
            raise DocumentError(
                f"{part.values['at'].place}: {path}.at: {place(at)} is not on the"
                f" outline of {name!r}."
            )
    return Hinge((bodies[0], bodies[1]), at)


def sketch(document: Document, built: RockingParameters) -> Sketch:
    """Return a sketch of the bodies at rest and at alpha in the direction that moves
    first, with numbered hinges, loads and sliders.
    """
    if built.mechanism is not None:
        right, left = linkages_of(built)
    else:  # one rigid body
        found = _found(document, built.gravity)
        right, left = found.right, found.left
    return drawn(built, right, left, axis=document.optional("axis"))
