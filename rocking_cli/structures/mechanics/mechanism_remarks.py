"""Sentences on the numbers of a mechanism that are probably wrong."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from .admissibility import place
from .joint_forces import JointForces
from .mechanism_side import MechanismSide

_GOVERNS = 1e-6  # of lambda: a difference that is not told


def remarks_on(
    side: MechanismSide,
    joints: Sequence[dict[str, Any]],
    friction: float | None,
    eta: float | None,
) -> Iterator[str]:
    """Yield a sentence on each number of one direction that is probably wrong; joints:
    its rows; friction: that of the document; eta: from momentum, of the impact with
    which this motion begins.
    """
    uplift = side.numbers(1.0)["uplift"]
    yield from _on_governing(side, uplift)
    yield from _on_sliding(side, uplift, friction)
    yield from _on_hardening(side)
    for row in joints:
        if "hinge" in row and (text := _on_onset(row, friction)):
            yield text
    if not JointForces(side, 1.0).unique:
        yield (
            "the forces at the joints are not unique (more than two columns); none are"
            " printed."
        )
    for row in joints:
        if row.get("friction_at_impact", 0.0) is None:
            yield (
                f"at the impact the joint at {place(row['at'])} would have to pull: eta"
                f" = {eta:.2g} from momentum holds it closed."
            )


def _on_governing(side: MechanismSide, uplift: float) -> list[str]:
    if side.governing is None or not side.governing[0] < uplift * (1.0 - _GOVERNS):
        return []
    least, hinges = side.governing
    if not hinges:
        return [
            "the bodies do not stand under their weight without tension at a joint."
        ]
    where = ", ".join(place(at) for at in hinges)
    return [
        f"it moves from {least:.3g} g on, in another mechanism (hinges at {where});"
        f" lambda = {uplift:.3g} is that of the joints given."
    ]


def _on_sliding(
    side: MechanismSide, uplift: float, friction: float | None
) -> list[str]:
    """A sentence on bodies that slide before they turn, with the friction of the
    document or of 1.
    """
    given = 1.0 if friction is None else friction
    limit = side.slides_from(given)
    if limit is None or side.governing is None:
        return []
    if not limit < min(uplift, side.governing[0]) * (1.0 - _GOVERNS):
        return []
    return [
        f"with a friction of {given:g} at its joints it slides from {limit:.3g} g on,"
        f" or before; lambda = {uplift:.3g} is that without sliding."
    ]


def _on_hardening(side: MechanismSide) -> list[str]:
    if side.single or not side.lift_slope(0.0) > 0.0:
        return []
    return [
        "the weight's resistance grows with the rotation at first: lambda is not the"
        " largest acceleration that it resists."
    ]


def _on_onset(row: dict[str, Any], friction: float | None) -> str:
    """A sentence on a hinge that lifts off or slides at the onset, else an empty
    text.
    """
    where, compression = place(row["at"]), row.get("compression")
    if compression is None:
        return ""
    if not compression > 0.0:
        return (
            f"the hinge at {where} is in tension at the onset"
            f" ({compression / 1e3:.3g} kN): it lifts off before."
        )
    needed = row["friction_needed"]
    if friction is not None and needed > friction:
        return f"the joint at {where} needs a friction of {needed:.2g} at the onset."
    return ""
