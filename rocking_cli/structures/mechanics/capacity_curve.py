"""The capacity curve of a mechanism, by virtual work in its displaced positions
(Circolare 7/2019, section C8.7.1.2.1).

With the displacements of the mechanism in its present position, of every weight P and
of the forces F of ties:

    alpha = (sum P delta_y - sum F delta_F)/sum P delta_x                  (C8.7.1.1)
    e*    = (sum P delta_x)^2/(sum P sum P delta_x^2) at rest              (C8.7.1.5)

The control point is the mass centre of all that moves. So d = d_C sum P
delta_x^2/(delta_C sum P delta_x) (C8.7.1.4) is d_C/e*. The weight of a body acts at its
mass centre: e* = 1 for one body, and a mechanism has the weights of its links.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...errors import UsageError
from ..parameters import RockingParameters, Side
from ..restraints import SIDES, Restraints

_POINTS = 2001
_AROUND_BREAK = 1e-9  # relative distance of the points on either side of a break


class CapacityCurve(NamedTuple):
    """The multiplier of the weights over the displacement of the equivalent oscillator,
    from rest to d0, where the weights alone have no capacity left; a tie that still
    holds beyond d0 is ignored, which is safe.
    """

    displacement: Array  # d [m], (n,)
    multiplier: Array  # alpha [-], (n,)
    e_star: float  # mass of the oscillator over that of the mechanism [-]
    # index of the last point before each break of a tie or a tendon
    breaks: tuple[int, ...] = ()

    @property
    def vanishes(self) -> float:
        """The displacement d0 [m] at which the weights alone have no capacity left."""
        return float(self.displacement[-1])

    def limit(self, share: float) -> tuple[float, float, bool]:
        """Return (d [m], multiplier [-], True if a break decides) at `share` of d0, or
        at the first earlier break of a tie or a tendon that leaves less than half of
        the largest multiplier before it.
        """
        d = share * self.vanishes
        for i in self.breaks:
            before = float(self.displacement[i])
            if (
                before < d
                and self.multiplier[i + 1] < 0.5 * self.multiplier[: i + 1].max()
            ):
                return before, float(self.multiplier[i]), True
        return d, float(np.interp(d, self.displacement, self.multiplier)), False


def require_geometry(structures: Sequence[RockingParameters]) -> None:
    """Raise UsageError with the names of all structures that have no curve, since their
    geometry is not known.
    """

    def known(structure: RockingParameters) -> bool:
        return structure.mechanism is not None or all(
            edge.arm is not None for edge in structure.edges
        )

    if found := [
        f"{one.name} (kind {one.structure})" for one in structures if not known(one)
    ]:
        found_text = f"found {', '.join(found)} without the place of one mass centre"
        raise UsageError(
            f"{found_text}; expected the geometry of a rigid body or of a mechanism"
        )


def capacity_curves(structure: RockingParameters) -> list[CapacityCurve]:
    """Return a curve for each direction in which a structure can fall, one if both are
    alike. Raises UsageError without its geometry.

    >>> (curve,) = capacity_curves(load_structures('block:0.5x2')[0])
    >>> curve.e_star, curve.vanishes, float(curve.multiplier[0])
    (1.0, 0.25, 0.25)
    """
    require_geometry([structure])
    if structure.mechanism is not None:
        edges: Sequence[Side | RockingParameters] = structure.sides or [structure]
        return [_of_mechanism(edge.mechanism, edge.alpha) for edge in edges]
    if structure.sides:
        return [_of_body(side, side.side, structure) for side in structure.sides]
    ties = structure.restraints.ties if structure.restraints else ()
    sides = (
        ["right"]
        if structure.one_sided or all(tie.side == "both" for tie in ties)
        else list(SIDES["both"])
    )
    return [_of_body(structure, side, structure) for side in sides]


def _of_body(
    edge: Side | RockingParameters, side: str, structure: RockingParameters
) -> CapacityCurve:
    """Return the curve of a body that turns about one edge up to alpha: d = R (sin
    alpha - sin(alpha - theta)); the multiplier is tan(alpha - theta) plus the part of
    ties and of the tendon.
    """
    alpha, arm, held = edge.alpha, edge.arm or 0.0, structure.restraints or Restraints()
    ties = held.on(side, arm * math.sin(alpha))
    breaks = sorted({x for tie in ties if (x := tie.breaks_at()) < alpha})
    theta = np.unique(
        [
            *np.linspace(0.0, alpha, _POINTS),
            *(x * (1.0 + sign * _AROUND_BREAK) for x in breaks for sign in (-1.0, 1.0)),
        ]
    )
    moment = np.array([sum(tie.moment(x) for tie in ties) for x in theta.tolist()])
    weight = (
        structure.details["mass"] * structure.gravity * arm
        if structure.restraints
        else 1.0
    )
    multiplier = np.tan(alpha - theta) + moment / (weight * np.cos(alpha - theta))
    before = tuple((np.searchsorted(theta, breaks) - 1).tolist())
    return CapacityCurve(
        arm * (math.sin(alpha) - np.sin(alpha - theta)), multiplier, 1.0, before
    )


def _of_mechanism(mechanism: Any, alpha: float) -> CapacityCurve:
    """Return the curve of a linkage up to its unstable equilibrium; d of its mass
    centre is the integral of push over the mass. Loads that only rise, or have no mass,
    are part of the multiplier and not of e*.
    """
    phi = np.linspace(0.0, alpha, _POINTS)
    _, lift, push = mechanism.coefficients(phi)
    masses, across = mechanism.sway()
    e_star = float((masses @ across) ** 2 / (masses.sum() * (masses @ across**2)))
    steps = 0.5 * (push[1:] + push[:-1]) * np.diff(phi)
    d = np.concatenate([[0.0], np.cumsum(steps)]) / (masses.sum() * e_star)
    return CapacityCurve(d, lift / push, e_star)
