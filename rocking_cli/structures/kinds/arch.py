"""The masonry arch (Figs. 5-7): its governing four-hinge mechanism and rocking
parameters, from the geometry.

lambda is the least uplift acceleration of all admissible mechanisms. The other
parameters follow from the linkage, linearised at its unstable equilibrium (Eqs.
3.5-3.9).
"""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ...documents.composition import Value
from ...documents.document import Document
from ...documents.quantities import SMALLEST_LENGTH, parse_quantity
from ...errors import ArgumentError
from ..mechanics.fourbar import EXTRADOS, FACES, INTRADOS, FourBar, Ring
from ..mechanics.hinges import (
    carried_through,
    search_continuous,
    search_joints,
    static_uplift,
)
from ..mechanics.kinematics import linearise
from ..parameters import RockingParameters
from ..shared_keys import gravity_of, restitution_of
from ..sketch import Outline, Sketch

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
PAIRS = (("radius", "angle"), ("span", "rise"))
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
    shared, own = mechanism.overlap()
    limit = "an arch whose mechanism does not throw it backwards"
    eta, source = restitution_of(document, float(shared / own), limit)
    # from the centre of the ring
    hinges = [
        {
            "angle": s,
            "face": face,
            "x": float(x),
            "z": float(z),
        }
        for s, face, (x, z) in zip(
            mechanism.hinges, FACES, mechanism.points, strict=True
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


def find_mechanism(document: Document) -> tuple[FourBar, float | None]:
    """Return (mechanism, governing lambda). The mechanism has the hinges of the
    document, or else the governing ones. Raises DocumentError if the arch does not
    stand, the given hinges are not admissible, or no linkage of four hinges governs.
    """
    ring = ring_of(document)
    voussoirs = (
        document.integer("voussoirs", 4, MOST_VOUSSOIRS)
        if document.has("voussoirs")
        else None
    )
    joints = None if voussoirs is None else np.linspace(0.0, ring.angle, voussoirs + 1)
    found = search_continuous(ring) if joints is None else search_joints(ring, joints)
    carried = found[1] if found else None
    if joints is not None and not (found and carried_through(ring, joints, found[0])):
        carried = static_uplift(ring, joints)
    if (joints is not None and carried is None) or (
        found is not None and not found[1] > 0.0
    ):
        raise document.fault(
            "thickness",
            f"{document.values['thickness']}: the arch cannot carry its own weight",
            "a thicker arch",
        )
    if document.has("hinges"):
        return replace(_given(document, ring, joints), voussoirs=voussoirs), carried
    # If the static bound is below that of the linkage, joints open over their whole
    # depth before four hinges form.
    if (
        found is None
        or carried is None
        or found[1] > carried + 1e-6
        or any(a == b for a, b in pairwise(found[0]))
    ):
        wanted = "an arch longer or thinner, which rocks before its joints part"
        raise document.fault(None, "no linkage of four hinges that governs", wanted)
    return FourBar(ring, found[0], voussoirs), found[1]


def ring_of(document: Document) -> Ring:
    """Return the ring from radius and angle, or from span and rise: R = (span^2/4 +
    rise^2)/(2 rise), angle = 4 atan(2 rise/span). The key `measured` states the line to
    which radius, span and rise refer. Springings are radial. Raises DocumentError.
    """
    outward = MEASURED[document.choice("measured", list(MEASURED), "centre-line")]
    pairs = [pair for pair in PAIRS if any(document.has(key) for key in pair)] or [
        PAIRS[0]
    ]
    if len(pairs) > 1 or not all(document.has(key) for key in pairs[0]):
        found = (
            " and ".join(key for pair in pairs for key in pair if document.has(key))
            or "none of them"
        )
        raise document.fault(
            None, found, ", or ".join(" and ".join(pair) for pair in PAIRS)
        )
    if pairs == [PAIRS[1]]:
        span, rise = document.length("span"), document.length("rise")
        radius = 0.5 * (0.25 * span * span / rise + rise)
        angle = 4.0 * math.atan2(2.0 * rise, span)
    else:
        radius = document.length("radius")
        angle = document.quantity(
            "angle",
            "angle",
            above=0.0,
            below=2.0 * math.pi,
            where="an angle between 0 and 360 deg",
        )
    # The centre line has the radius measured + outward x thickness, which exceeds
    # thickness/2.
    most = radius / (0.5 - outward) if outward < 0.5 else math.inf
    where = (
        f"a length between {SMALLEST_LENGTH:g} m and {most:g} m, where the intrados has"
        " no radius left"
    )
    thickness = document.quantity(
        "thickness", "length", above=SMALLEST_LENGTH, below=most, where=where
    )
    return Ring(radius + outward * thickness, thickness, angle)


def _given(document: Document, ring: Ring, joints: np.ndarray | None) -> FourBar:
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
    mechanism = FourBar(
        ring,
        tuple((hinges if first == FACES[0] else ring.angle - hinges[::-1]).tolist()),
    )
    at = mechanism.at_rest()
    require(
        at.admissible and at.push > 0.0,
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
        found = (
            part.quantity("angle", "angle"),
            part.choice("face", [INTRADOS, EXTRADOS]),
        )
        part.finish()
        return found
    try:
        return parse_quantity(str(value.content), "angle"), face
    except ArgumentError:
        raise document.fault("hinges", str(value), _HINGES) from None


def sketch(document: Document, built: RockingParameters) -> Sketch:
    """Return a sketch with the voussoirs (or the links of a continuous arch), the
    numbered hinges, and the linkage at alpha.
    """
    mechanism = built.mechanism
    assert isinstance(mechanism, FourBar)
    ring, count = mechanism.ring, mechanism.voussoirs or 0
    ends = sorted(
        {
            0.0,
            ring.angle,
            *mechanism.hinges,
            *(ring.angle * i / count for i in range(1, count)),
        }
    )
    links = list(
        zip(
            mechanism.hinges[:-1],
            mechanism.hinges[1:],
            mechanism.displaced(built.alpha),
            strict=True,
        )
    )
    bodies, still, moved = [], [], []
    for start, stop in pairwise(ends):
        if stop - start <= 1e-9:
            continue
        outline = _sector(ring, start, stop)
        move = next(
            (move for low, high, move in links if low - 1e-9 <= start < high - 1e-9),
            None,
        )
        if move is None:  # beside the linkage
            still.append(outline)
        else:
            bodies.append(outline)
            moved.append(tuple(move(x, z) for x, z in outline))
    pivots = tuple(
        (str(i), (float(x), float(z))) for i, (x, z) in enumerate(mechanism.points, 1)
    )
    return Sketch(
        bodies=tuple(bodies), still=tuple(still), moved=tuple(moved), pivots=pivots
    )


def _sector(ring: Ring, start: float, stop: float) -> Outline:
    """Return the outline of a part of the ring between two angles [rad]."""
    along = np.linspace(start, stop, max(2, math.ceil((stop - start) / 0.03)) + 1)
    faces = (ring.point(along, INTRADOS), ring.point(along[::-1], EXTRADOS))
    return tuple(
        zip(
            *(np.concatenate(values).tolist() for values in zip(*faces, strict=True)),
            strict=True,
        )
    )
