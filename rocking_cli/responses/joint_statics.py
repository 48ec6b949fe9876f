"""The forces at the joints of a mechanism along a history, by Eq. 3.4."""

from __future__ import annotations

from dataclasses import dataclass

from ..structures.mechanics.joint_forces import JointForces, Moving
from ..structures.mechanics.measured import Measured
from ..structures.mechanics.ring import ArchLinkage
from ..structures.mechanics.ring_forces import RingForces
from ..structures.parameters import RockingParameters, Side
from .force_history import Instants


def joints_of(structure: RockingParameters) -> dict[float, JointStatics] | None:
    """Return the forces of each side; None of a structure without such joints."""
    if structure.mechanism is None:
        return None
    g, (left, right) = structure.gravity, structure.left_and_right
    edges, joints = {1.0: right, -1.0: left}, dict[float, JointForces]()
    for side, edge in edges.items():
        linkage = edge.mechanism
        assert linkage is not None
        if isinstance(linkage, ArchLinkage):
            joints[side] = RingForces(linkage, g, side < 0.0)
        else:
            joints[side] = JointForces(linkage, g)
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
