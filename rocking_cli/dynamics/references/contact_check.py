"""Loss of contact of a rigid body on the reference path, from instants along its steps; it shares nothing with the proof of `body`.

The mass centre is R cos(alpha - u) above the edge, u = |theta|, so that over m g, with ' by the tau of the path and the weight w over m g,

    Fz = w + rise (cos(alpha - u))'',   rise = R p^2/g
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ...structures.parameters import RockingParameters, Side

_NEAR, _PART = 0.1, 0.1  # the least force of a step is searched for if it may be below the first plus the second times its variation
_ROUNDS = 32  # of the search; each leaves two thirds of the interval


class Arm(NamedTuple):
    """An edge. alpha [rad]; rise: R p^2/g with the p of the path [-]."""

    alpha: float
    rise: float

    def fz(self, u: float, rate: float, bend: float, weight: float) -> float:
        """Fz/(m g) at u [rad] with these derivatives by tau, under this weight over m g."""
        z = self.alpha - u
        return weight + self.rise * (bend * math.sin(z) - rate * rate * math.cos(z))


def arms_of(structure: RockingParameters) -> tuple[Arm, Arm] | None:
    """The arms from the right edge and the left one of a rigid body; None if its forces are not known."""
    edges: tuple[Side | RockingParameters, ...] = structure.sides or (structure, structure)
    arms = [Arm(e.alpha, e.arm * structure.p**2 / structure.gravity) for e in edges if e.arm is not None]
    return (arms[1], arms[0]) if len(arms) == len(edges) else None


def lets_go(rough: tuple[float, float, float], force: Callable[[float], float]) -> bool:
    """True if a force falls to zero on a step, which holds at most one minimum.

    rough: the force at the start, about the middle and at the end; force: function of the part of the step. The search is skipped if the
    parabola through the three stays well above zero.
    """
    first, middle, last = rough
    if first <= 0.0 or last <= 0.0:
        return True
    slope, bend = 0.5 * (last - first), first - 2.0 * middle + last
    dip = middle - 0.5 * slope * slope / bend if bend > abs(slope) else min(rough)
    low, high = 0.0, 1.0
    for _ in range(_ROUNDS if dip <= _NEAR + _PART * (max(rough) - min(rough)) else 0):
        third = (high - low) / 3.0
        one, other = force(low + third), force(high - third)
        if one <= 0.0 or other <= 0.0:
            return True
        low, high = (low, high - third) if one < other else (low + third, high)
    return False
