"""The friction of a base, and the bodies that it keeps from rocking."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import UsageError

if TYPE_CHECKING:
    from .parameters import RockingParameters


@dataclass(frozen=True)
class Friction:
    """The friction of a base. Its static coefficient is the larger one."""

    static: float  # mu_s [-]
    kinetic: float  # mu_k [-]


def friction_that_slides(structure: RockingParameters) -> Friction | None:
    """Return the friction of a body that slides and never rocks, because its static
    friction is below lambda of each edge; None for another structure, and where the
    argument does not hold: of an arch, a frame, a body with several joints or a backing
    or ties, or of stated parameters without an arm.
    """
    if structure.friction is None or not covers_sliding(structure):
        return None
    if not structure.friction < least_lambda(structure):
        return None
    kinetic = structure.kinetic_friction
    return Friction(
        structure.friction, structure.friction if kinetic is None else kinetic
    )


def covers_sliding(structure: RockingParameters) -> bool:
    """True for a rigid body on its whole base, whose sliding is known."""
    return (
        structure.arm is not None
        and structure.mechanism is None
        and not structure.one_sided
        and structure.restraints is None
    )


def least_lambda(structure: RockingParameters) -> float:
    """Return lambda [-] of the edge that lifts first, of a stack of the interface that
    lifts first.
    """
    interfaces = structure.details.get("interfaces") or ()
    return min([structure.uplift, *(one["lambda"] for one in interfaces)])


def refuse_range(structures: Iterable[RockingParameters], what: str) -> None:
    """Raise UsageError if a structure slides and never rocks, whose worst case in a
    range of frequencies or directions is not that of rocking.
    """
    if names := [s.name for s in sliders(structures)]:
        raise UsageError(
            f"{what} does not go with a body that slides and never rocks, because its"
            f" friction is below lambda: {names[0]}; expected one value (at a lower"
            " frequency a pulse slides it further, by 1/f2)"
        )


def sliders(structures: Iterable[RockingParameters]) -> list[RockingParameters]:
    """Return the structures that slide and never rock."""
    return [s for s in structures if friction_that_slides(s) is not None]
