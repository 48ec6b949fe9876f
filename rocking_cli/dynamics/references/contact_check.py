"""Whether a rigid body presses on the ground, as the slower paths see it: from instants along their own steps.

Its mass centre is R cos(alpha - u) above the edge, u = |theta|, so that over m g and with ' by the tau of the path

    Fz = w + rise (cos(alpha - u))'',   rise = R p^2/g

w being the weight over m g. Nothing here is shared with the engine's own look at it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ...structures.parameters import RockingParameters, Side

_NEAR, _PART = 0.1, 0.1  # a least force within this, and this part of how it varies on a step, is looked for more closely
_CLOSER = 24  # golden sections of a step
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class Arm(NamedTuple):
    """Of an edge: alpha [rad], and rise, R p^2/g with the p of the path [-]."""

    alpha: float
    rise: float

    def fz(self, u: float, rate: float, bend: float, weight: float) -> float:
        """Fz/(m g) at u [rad] with these derivatives by tau, under this weight over m g."""
        z = self.alpha - u
        return weight + self.rise * (bend * math.sin(z) - rate * rate * math.cos(z))


def arms_of(structure: RockingParameters) -> tuple[Arm, Arm] | None:
    """The arms from the right edge and the left one of a rigid body; None where its forces are not known."""
    edges: tuple[Side | RockingParameters, ...] = structure.sides or (structure, structure)
    arms = [Arm(e.alpha, e.arm * structure.p**2 / structure.gravity) for e in edges if e.arm is not None]
    return (arms[1], arms[0]) if len(arms) == len(edges) else None


def lets_go(rough: tuple[float, float, float], force: Callable[[float], float]) -> bool:
    """Whether a force falls to zero on a step; rough: at its start, about its middle and at its end; force: by the part of the step.

    Steps are too short for more than one minimum. Where the parabola through the three stays well above zero nothing more is asked.
    """
    first, middle, last = rough
    if first <= 0.0 or last <= 0.0:
        return True
    slope, bend = 0.5 * (last - first), first - 2.0 * middle + last
    dip = middle - 0.5 * slope * slope / bend if bend > abs(slope) else min(rough)
    if dip > _NEAR + _PART * (max(rough) - min(rough)):
        return False
    low, high = 0.0, 1.0
    one, other = high - _GOLDEN, low + _GOLDEN
    at_one, at_other = force(one), force(other)
    for _ in range(_CLOSER):
        if at_one <= 0.0 or at_other <= 0.0:
            return True
        if at_one < at_other:
            high, other, at_other = other, one, at_one
            one = high - _GOLDEN * (high - low)
            at_one = force(one)
        else:
            low, one, at_one = one, other, at_other
            other = low + _GOLDEN * (high - low)
            at_other = force(other)
    return False
