"""The forces along a history that a structure gives: those of the ground on a rigid
body, or those at the joints of a mechanism.
"""

from __future__ import annotations

from ..errors import UsageError
from ..structures.parameters import RockingParameters
from .arcs import History
from .contact_forces import ContactForces
from .force_history import ForceHistory
from .ground_forces import edges_of
from .ground_history import GroundMotion


def forces_of(
    structure: RockingParameters, model: str, ground: GroundMotion, found: History
) -> ForceHistory:
    """Return the forces along a response by the equation `model`. Raises UsageError if
    they are not known: damping has no place in those at joints, which may not be
    unique.
    """
    name, statics = structure.name, None
    if structure.mechanism is not None:
        from .joint_statics import joints_of

        statics = joints_of(structure)
    if statics is None:
        return ContactForces(structure, ground, found, edges_of(structure))
    if model != "nonlinear":
        raise UsageError(
            f"{name}: the forces at the joints of a mechanism follow from the nonlinear"
            " equation: give `model` nonlinear"
        )
    if structure.damping:
        raise UsageError(
            f"{name}: found damping; expected none for the forces at the joints of a"
            " mechanism"
        )
    if not all(one.joints.unique for one in statics.values()):
        raise UsageError(
            f"{name}: the forces at the joints are not unique (more than two columns)"
        )
    return ForceHistory(structure, ground, found, statics)
