"""The joints of a mechanism that a document does not state: hinges of the least lambda,
and those of the other direction.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from .assembly import Assembly, Joint, MechanismFault, Rigid, Slide, mirror_image
from .linkage import Linkage
from .mechanism_side import MechanismSide
from .statics import Governing, Statics, bodies_alone

_SAME = 1e-8  # relative difference of lambda of two mechanisms that govern together
_EQUAL = 1e-10  # relative difference of lambda of two mechanisms that are one


def searched_joints(
    assembly: Assembly, joints: Sequence[Joint], side: float
) -> tuple[Joint, ...]:
    """Return the joints of the mechanism of the least lambda towards +x (side = 1) or
    -x; joints: the sliders and rigid groups that are given. Raises MechanismFault.
    """
    links = assembly.links((*joints, *(Rigid((name,)) for name in assembly.names)))
    sliders = tuple(joint for joint in joints if isinstance(joint, Slide))
    statics = Statics(assembly, tuple(tuple(link) for link in links), sliders)
    found = statics.governing(side)
    if found is None or not statics.stands(side):
        raise MechanismFault(
            "bodies",
            "it does not stand: the bodies do not carry their weight without tension at"
            f" a joint (edges at z = {assembly.ground_level:g} m stand on the ground).",
        )
    if not found.joints:
        raise MechanismFault(
            "joints",
            "joints: the bodies cannot move: take a joint away, or a rigid group"
            " apart.",
        )
    _require_one(assembly, sliders, found, side)
    return found.joints


def _require_one(
    assembly: Assembly, sliders: tuple[Slide, ...], found: Governing, side: float
) -> None:
    """Raise MechanismFault if other bodies move from the same lambda on."""
    links = assembly.links(found.joints)
    moving = [name for link in links[1:] for name in link]
    rest = [name for name in links[0] if assembly.body(name).outline]
    groups = bodies_alone(assembly, [n for n in assembly.names if n in moving])
    if not rest:
        return
    others = Statics(assembly, groups, sliders).governing(side)
    if others is not None and others.uplift <= found.uplift * (1.0 + _SAME):
        raise MechanismFault(
            "joints",
            f"joints: two mechanisms move from {found.uplift:.4g} g on; list the joints"
            " of one of them.",
        )


def mirrored_joints(
    assembly: Assembly, first: Linkage, axis: float, free: tuple[Joint, ...] | None
) -> tuple[tuple[Joint, ...], str]:
    """Return (joints in the other direction, body of its coordinate): the mirror image,
    or where hinges are searched and another mechanism governs there, that one. free:
    the given sliders and rigid groups if hinges are searched, else None. Raises
    MechanismFault.
    """
    turning, image = first.turning, assembly.images(axis)
    named = {name for joint in first.joints for name in joint.bodies}
    lacking = [name for name in assembly.names if name in named - image.keys()]
    again: tuple[Joint, ...] = ()
    if not lacking:
        again = mirror_image(first.joints, image, axis)
        turning = image.get(turning, turning)
    if free is not None:
        there = assembly.with_bearings(axis)
        own = searched_joints(there, free, -first.direction)
        if lacking or not _same_uplift(there, again, own):
            return own, first.turning
    elif lacking:
        raise MechanismFault(
            "other_side",
            f"other_side: {lacking[0]!r} has no mirror image about x = {axis:g} m: list"
            " the joints of the other side.",
        )
    return again, turning


def _same_uplift(
    assembly: Assembly, one: tuple[Joint, ...], other: tuple[Joint, ...]
) -> bool:
    """True if two mechanisms of the same bodies have the same lambda."""
    rests = [Linkage(assembly, joints).at_rest for joints in (one, other)]
    first, second = (abs(rest.lift / rest.push) for rest in rests)
    return math.isclose(first, second, rel_tol=_EQUAL)


def with_coordinate(
    linkage: MechanismSide, stated: str | None, turning: str
) -> MechanismSide:
    """Return the mechanism with the stated coordinate; or else with that of the other
    direction, if this body turns here.
    """
    if stated is not None:
        if not linkage.turns(stated):
            raise MechanismFault(
                "rotation_of_other",
                f"rotation_of_other: {stated!r} does not rotate: name another body.",
            )
        return replace(linkage, coordinate=stated)
    return replace(linkage, coordinate=turning) if linkage.turns(turning) else linkage
