"""The masonry arch (Figs. 5-7): its governing four-hinge mechanism and rocking
parameters, from the geometry.

lambda is the least uplift acceleration of all admissible mechanisms. The other
parameters follow from the linkage, linearised at its unstable equilibrium (Eqs.
3.5-3.9).
"""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from ...documents.composition import Value
from ...documents.document import Document
from ...documents.keys import Key, Keys, length
from ...documents.quantities import SMALLEST_LENGTH, parse_quantity
from ...errors import ArgumentError
from ..mechanics.hinges import search_continuous, search_joints
from ..mechanics.joint_forces import momentum_restitution
from ..mechanics.kinematics import linearise
from ..mechanics.linkage_drawing import drawn
from ..mechanics.ring import (
    EXTRADOS,
    FACES,
    INTRADOS,
    ArchLinkage,
    Ring,
    arch_linkage,
)
from ..parameters import RockingParameters
from ..shared_keys import gravity_of, restitution_of
from ..sketch import Dimension, Sketch

REPORTS = ("a_scale_3_7", "hinges", "direction", "lambda_governing")
SIZES = ("radius", "thickness", "angle")
MOST_VOUSSOIRS = 200
DIRECTION = (
    "sways towards +x, away from springing A; the mirror image has the same parameters"
)
# distance outwards to the centre line, over the thickness
MEASURED = {
    "centre-line": 0.0,
    "intrados": 0.5,
    "extrados": -0.5,
}
_HINGE = {"angle": Key("angle"), "face": Key("choice", words=(INTRADOS, EXTRADOS))}
KEYS = Keys(
    {"thickness": length("of the ring")},
    {
        "measured": Key(
            "choice",
            "line of radius, span and rise",
            words=tuple(MEASURED),
            default="centre-line",
        ),
        "voussoirs": Key(
            "whole",
            "between the joints where it can hinge; absent: anywhere",
            least=4,
            most=MOST_VOUSSOIRS,
        ),
        "hinges": Key(
            "any",
            "four angles from springing A, intrados first; absent: searched",
            inner=Keys(_HINGE),
        ),
        "one_sided": Key("flag", "false: an arch sways to both sides"),
    },
    (
        (
            Keys(
                {
                    "radius": length("of the centre line"),
                    "angle": Key(
                        "angle", "inclusion angle", above=0.0, below=2.0 * math.pi
                    ),
                }
            ),
            Keys(
                {
                    "span": length("between the springings"),
                    "rise": length("from the springings to the crown"),
                }
            ),
        ),
    ),
)
_HINGES = (
    "four angles from springing A, rising, or four of {angle, face} with faces intrados"
    " and extrados in turn"
)


def build(document: Document, name: str) -> RockingParameters:
    """Return the parameters of an arch. Raises DocumentError. Keys: thickness; radius
    and angle (inclusion), or span and rise; measured: centre-line (default), intrados
    or extrados; voussoirs (absent: a continuous arch); hinges (absent: the governing
    ones).
    """
    if document.flag("one_sided"):
        raise document.fault("one_sided", "true", "false: an arch sways to both sides")
    mechanism, governing = find_mechanism(document)
    found = linearise(mechanism)
    gravity = gravity_of(document)
    limit = "an arch whose mechanism does not throw it backwards"
    momentum, _ = momentum_restitution(mechanism, mechanism.mirrored)
    eta, source = restitution_of(document, momentum, limit)
    hinges = [  # from the centre of the ring
        {"angle": s, "face": face, "x": hinge.at[0], "z": hinge.at[1]}
        for s, face, hinge in zip(
            mechanism.angles, FACES, mechanism.hinges, strict=True
        )
    ]
    details = {
        "a_scale_3_7": found.a_scale_3_7,
        "hinges": hinges,
        "direction": DIRECTION,
    }
    if document.has("hinges"):
        details["lambda_governing"] = governing
    return RockingParameters(
        name=name,
        structure="arch",
        p=math.sqrt(gravity * found.stiffness),
        alpha=found.alpha,
        eta=eta,
        uplift=found.uplift,
        a_scale=found.a_scale,
        eta_source=source,
        gravity=gravity,
        details=details,
        mechanism=mechanism,
    )


def find_mechanism(document: Document) -> tuple[ArchLinkage, float]:
    """Return (mechanism, governing lambda). The mechanism has the hinges of the
    document, or else the governing ones. Raises DocumentError if the arch does not
    stand, the given hinges are not admissible, or no linkage of four hinges governs.
    """
    ring, joints = ring_of(document), None
    voussoirs = document.integer("voussoirs") if document.has("voussoirs") else None
    if voussoirs is not None:
        joints = np.linspace(0.0, ring.angle, voussoirs + 1)
    found = search_continuous(ring) if joints is None else search_joints(ring, joints)
    if found is None or not found.uplift > 0.0:
        raise document.fault(
            "thickness",
            f"{document.values['thickness']}: the arch cannot carry its own weight",
            "a thicker arch",
        )
    if document.has("hinges"):
        return _given(document, ring, joints, voussoirs), found.uplift
    if not found.four_hinges:
        wanted = "an arch longer or thinner, which rocks before its joints part"
        raise document.fault(None, "no linkage of four hinges that governs", wanted)
    return arch_linkage(ring, found.joints.tolist(), voussoirs), found.uplift


def ring_of(document: Document) -> Ring:
    """Return the ring from radius and angle, or from span and rise: R = (span^2/4 +
    rise^2)/(2 rise), angle = 4 atan(2 rise/span). The key `measured` states the line to
    which radius, span and rise refer. Springings are radial. Raises DocumentError.
    """
    outward = MEASURED[document.choice("measured")]
    if document.has("span") or document.has("rise"):
        span, rise = document.length("span"), document.length("rise")
        radius = 0.5 * (0.25 * span * span / rise + rise)
        angle = 4.0 * math.atan2(2.0 * rise, span)
    else:
        radius, angle = document.length("radius"), document.quantity("angle")
    # The centre line has the radius measured + outward x thickness, which exceeds
    # thickness/2.
    most = radius / (0.5 - outward) if outward < 0.5 else math.inf
    where = (
        f"a length between {SMALLEST_LENGTH:g} m and {most:g} m, where the intrados has"
        " no radius left"
    )
    thickness = document.quantity(
        "thickness", above=SMALLEST_LENGTH, below=most, where=where
    )
    return Ring(radius + outward * thickness, thickness, angle)


def _given(
    document: Document, ring: Ring, joints: np.ndarray | None, voussoirs: int | None
) -> ArchLinkage:
    """Return the mechanism with the hinges that the document states. Raises
    DocumentError if it is not admissible.
    """
    value = document.values["hinges"]
    if not isinstance(value.content, list) or len(value.content) != 4:
        raise document.fault("hinges", str(value), _HINGES)
    stated = [
        _hinge(document, child, face)
        for child, face in zip(value.content, FACES, strict=True)
    ]
    hinges, first = np.array([angle for angle, _ in stated]), stated[0][1]

    def require(holds: object, found: str, wanted: str = _HINGES) -> None:
        if not holds:
            raise document.fault("hinges", found, wanted)

    require(np.all(np.diff(hinges) > 0.0), "angles out of order")
    require(
        all(a != b for (_, a), (_, b) in pairwise(stated)),
        "faces that do not alternate",
    )
    within = (
        f"angles from 0 to {math.degrees(ring.angle):g} deg (a bare number is in rad)"
    )
    require(
        hinges[0] >= -1e-12 and hinges[-1] <= ring.angle * (1.0 + 1e-12),
        "a hinge beyond the springings",
        within,
    )
    if joints is not None:
        nearest = joints[np.abs(np.subtract.outer(hinges, joints)).argmin(axis=1)]
        wanted = f"multiples of {math.degrees(joints[1]):g} deg, the voussoirs' joints"
        require(
            np.max(np.abs(nearest - hinges)) <= 1e-6,
            "a hinge between two joints",
            wanted,
        )
        hinges = nearest
    hinges = np.clip(hinges, 0.0, ring.angle)
    hinges = hinges if first == FACES[0] else ring.angle - hinges[::-1]
    mechanism = arch_linkage(ring, hinges.tolist(), voussoirs)
    turns, at = mechanism.swaying
    # neighbours turn in opposite senses: each hinge opens on the face opposite to it
    require(
        np.all(np.diff(turns, prepend=0.0, append=0.0) * [1, -1, 1, -1] > 0.0)
        and at.push > 0.0,
        "hinges that do not open on their far faces",
        "hinges of a mechanism that sways",
    )
    require(
        at.lift > 0.0,
        "an arch that collapses in this mechanism under its own weight",
        "a thicker arch, or other hinges",
    )
    return mechanism


def _hinge(document: Document, value: Value, face: str) -> tuple[float, str]:
    """Return (angle [rad], face) of one hinge; the face is `face` if the document
    states only the angle. Raises DocumentError.
    """
    if isinstance(value.content, dict):
        part = document.part("hinges", value)
        return part.quantity("angle"), part.choice("face")
    try:
        return parse_quantity(str(value.content), "angle"), face
    except ArgumentError:
        raise document.fault("hinges", str(value), _HINGES) from None


def sketch(document: Document, built: RockingParameters) -> Sketch:
    """Return a sketch with the voussoirs (or the links of a continuous arch), the
    numbered hinges, and the linkage at alpha.
    """
    own = built.mechanism
    assert isinstance(own, ArchLinkage)
    ring = own.ring
    linkage = arch_linkage(ring, own.angles, own.voussoirs, images=False)
    found = drawn(built, linkage, None, axis=0.0)
    return replace(found, **_dimensions(document, ring))


def _dimensions(document: Document, ring: Ring) -> dict[str, Any]:
    """Return the fields of a sketch on the lengths that the document states: thickness
    with span and rise, or with radius and angle.
    """
    radius = ring.radius - MEASURED[document.choice("measured")] * ring.thickness
    x, z = (radius * f(0.5 * ring.angle) for f in (math.sin, math.cos))
    half = 0.5 * ring.thickness
    lengths = [Dimension((0.0, ring.radius - half), (0.0, ring.radius + half), False)]
    if document.has("span"):
        lengths += [Dimension((-x, z), (x, z)), Dimension((-x, z), (-x, radius))]
        return {"dimensions": tuple(lengths)}
    inclusion = f"{math.degrees(ring.angle):.4g}°"
    remark = f"radius {radius:.4g} m, angle {inclusion}"
    return {"dimensions": tuple(lengths), "remark": remark}
