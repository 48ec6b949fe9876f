"""Forces between a rigid body and the ground, and the friction and weight that a
response needs from it.

With s = sgn theta, phi = alpha - |theta|, R from the edge to the mass centre and kappa
= R p^2/g = m R^2/I,

    Fx/(m g) = xg''/g + kappa (s u'' cos phi + s u'^2 sin phi)
    Fz/(m g) = 1 + zg''/g + kappa (u'' sin phi - u'^2 cos phi),
    u = |theta| [rad], ' = d/d(p t)

for any equation of motion, since they are the forces that move the mass centre as in
the response. At rest they are xg''/g and 1 + zg''/g. Ties and a tendon with the forces
F_i and T on the side s add

    s (sum F_i + T sin(|theta|/2))/(m g) to Fx/(m g),   T cos(theta/2)/(m g) to Fz/(m g)

where the tendon pulls along the line between both ends of its gap. At rest the ties of
either side pull, and Fx bears their difference. The base needs a coefficient of
friction of max |Fx|/Fz, and Fz > 0 at all times. The impulses of the ground in an
impact are

    Jx = s m R cos(alpha) w (1 - eta),   Jz = m w (R sin(alpha) + eta R' sin(alpha')),
    w = |theta'| before

where R' and alpha' belong to the other edge. Jx/Jz is the friction that the impact
needs.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.body import ground_reaction
from ..errors import UsageError
from ..structures.mechanics.measured import Measured, ratio_of
from ..structures.parameters import RockingParameters
from .arcs import FREE, Resultant
from .force_history import Instants


class Forces(NamedTuple):
    """The force of the ground on the body over its weight m g; or its impulse in an
    impact over m g, times p, which is in s when divided by p.
    """

    fx: Any  # horizontal, towards +x [-]
    fz: Any  # vertical [-]

    @property
    def friction(self) -> float:
        """|Fx|/Fz of one instant, or of an impact: the friction with which the base
        does not slide; infinite where Fz <= 0.
        """
        return abs(self.fx) / self.fz if self.fz > 0.0 else math.inf


class RequiredFriction(NamedTuple):
    """A required coefficient of friction [-] and its time [tau]."""

    friction: float  # required coefficient [-], infinite if Fz <= 0
    tau: float  # its time [-]


@dataclass(frozen=True)
class GroundForceExtremes:
    """The friction and the vertical force that a response needs from the ground. A
    friction is None if the response has no such time, and infinite if Fz <= 0.
    """

    resting: RequiredFriction | None  # the largest while the body is at rest
    # just after the first uplift (Shenton's boundary, if the ground acceleration jumps
    # there)
    lifting: RequiredFriction | None
    rocking: RequiredFriction | None  # the largest while the body rocks
    impact: RequiredFriction | None  # the largest of the impulses
    fz_min: float  # least Fz over m g [-]
    fz_min_tau: float  # time of fz_min [tau]

    @property
    def friction(self) -> RequiredFriction:
        """The largest friction that the forces need, impulses apart."""
        return max(
            (d for d in (self.resting, self.rocking) if d is not None),
            key=lambda d: d.friction,
            default=RequiredFriction(0.0, 0.0),
        )

    def slides(self, friction: float) -> str | None:
        """Return when a base with this coefficient of friction slides first: "before
        rocking" (at rest, or at the first uplift), "rocking" or "impact"; None if it
        never slides.
        """
        for word, required in (
            ("before rocking", self.resting),
            ("before rocking", self.lifting),
            ("rocking", self.rocking),
        ):
            if required is not None and required.friction > friction:
                return word
        return (
            "impact"
            if self.impact is not None and self.impact.friction > friction
            else None
        )


def body_forces(
    edge: Any,
    side: Any,
    u: Array,
    rate: Array,
    acceleration: Array,
    ground: Array,
    vertical: Array,
    pull: Resultant = FREE,
) -> Forces:
    """Return the forces over m g on one side, +1 or -1, whose edge has these numbers: u
    = |theta| [rad], its first and second derivative by tau = p t of the side, the
    ground acceleration xg''/g and zg''/g [-], and what ties and a tendon pull, arrays
    of one shape.
    """
    outward, up = ground_reaction(
        edge, u, rate, acceleration, -side * ground, 1.0 + vertical
    )
    return Forces(side * (outward + pull.inward), up + pull.down)


@dataclass(frozen=True)
class ForceEdge:
    """An edge and the body that stands on it."""

    alpha: float  # critical angle [rad]
    kappa: float  # R p^2/g = m R^2/I [-]
    arm: float  # R [m]
    p: float  # frequency parameter [rad/s]
    eta: float  # restitution on leaving the edge [-]

    def forces_at(self, at: Instants) -> Measured:
        """Return the forces of the ground at instants; the rotation is linear in y."""
        u, rate, acceleration = (
            self.alpha * at.equation.rotation(x)
            for x in (at.point.y, at.point.v, at.point.b)
        )
        ground = at.across, at.up
        fx, fz = body_forces(self, at.side, u, rate, acceleration, *ground, at.pull)
        measures = {"fz_min": -fz, "friction": ratio_of(np.abs(fx), fz)}
        return Measured(
            {"fx_ratio": fx, "fz_ratio": fz},
            {name: values[:, None] for name, values in measures.items()},
        )


def edges_of(structure: RockingParameters) -> dict[float, ForceEdge]:
    """Return the right (+1) and the left (-1) edge. Raises UsageError if the structure
    is no rigid body, or if its mass centre is not known.
    """
    if structure.arm is None:
        raise UsageError(
            f"{structure.name}: forces need a single rigid body, and `arm`, the"
            " distance from its mass centre to its edges"
        )
    edges = []
    for side in reversed(structure.left_and_right):
        if side.arm is None:
            raise UsageError(
                f"{structure.name}: forces need arm, the distance of the mass centre,"
                " of both edges"
            )
        edges.append(
            ForceEdge(
                side.alpha,
                side.arm * side.p * side.p / structure.gravity,
                side.arm,
                side.p,
                side.eta,
            )
        )
    return {1.0: edges[0], -1.0: edges[1]}
