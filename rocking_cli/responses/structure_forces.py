"""The forces along a history that a structure gives: those of the ground on a rigid
body, or those at the joints of a mechanism.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import UsageError
from ..structures.mechanics.fourbar import FourBar
from ..structures.mechanics.joint_forces import JointForces, Measured, Moving
from ..structures.mechanics.linkage import Linkage
from ..structures.mechanics.ring_forces import RingForces, linkage_of
from ..structures.parameters import RockingParameters, Side
from .arcs import History
from .contact_forces import ContactForces
from .force_history import ForceHistory, Instants
from .ground_forces import edges_of
from .ground_history import GroundMotion


def forces_of(
    structure: RockingParameters, model: str, ground: GroundMotion, found: History
) -> ForceHistory:
    """Return the forces along a response by the equation `model`. Raises UsageError if
    they are not known: ties, dampers and damping have no place in them, and those at
    joints may not be unique.
    """
    name, mechanism = structure.name, structure.mechanism
    if found.devices:
        raise UsageError(
            f"{name}: found ties or a tendon; expected a body without them, whose"
            " forces on the ground are known"
        )
    if not isinstance(mechanism, FourBar | Linkage):
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
    statics = _joints_of(structure)
    if not all(one.joints.unique for one in statics.values()):
        raise UsageError(
            f"{name}: the forces at the joints are not unique (more than two columns)"
        )
    return ForceHistory(structure, ground, found, statics)


def _joints_of(structure: RockingParameters) -> dict[float, JointStatics]:
    """Return the forces of each side."""
    g, (left, right) = structure.gravity, structure.sides or (structure, structure)
    edges, joints = {1.0: right, -1.0: left}, dict[float, JointForces]()
    linkage = None
    for side, edge in edges.items():
        mechanism = edge.mechanism
        if isinstance(mechanism, FourBar):
            linkage = linkage or linkage_of(mechanism)
            joints[side] = RingForces(linkage, g, mechanism, side < 0.0)
        else:
            assert isinstance(mechanism, Linkage)
            joints[side] = JointForces(mechanism, g)
    weight = joints[1.0].weight
    return {x: JointStatics(edges[x], joints[x], g, weight) for x in edges}


@dataclass(frozen=True)
class JointStatics:
    """The forces at the joints of a mechanism by Eq. 3.4 on one side."""

    edge: Side | RockingParameters  # the parameters of the side
    joints: JointForces  # of the side, or of the right side if that is its mirror image
    gravity: float  # g [m/s2]
    weight: float  # of an arch, or of what moves on the right side [N]

    def forces_at(self, at: Instants) -> Measured:
        """Return the forces at instants."""
        edge, linkage, g = self.edge, self.joints.linkage, self.gravity
        phi = at.equation.rotation(at.point.y) * edge.alpha
        rate = at.equation.rotation_rate(at.point.y, at.point.v)
        rate = rate * (edge.alpha * edge.p)
        across, up = linkage.direction * at.side * (g * at.across), g * at.up
        acceleration = linkage.acceleration(phi, rate, across, up, g)
        moving = Moving(phi, rate, acceleration, across, up)
        return self.joints.measured(moving, self.weight)
