"""A wall whose top a floor holds horizontally: it cracks and bulges between its base
and its top, as two bodies with one degree of freedom.

While it bulges towards +x the lower body turns about the right edge of the base, the
crack opens at the right face and turns about the left one, and the top moves up and
down only. With h1 the height of the crack, r = h1/(h - h1), W the weight of the wall
and P each load at x from the left face of the upper body (small rotations are exact at
rest):

    lambda = 2 [W t + sum P (t + r x)]/(W h1)
           = (2/h) [a/beta + b/(1 - beta)]      a = t (1 + sum P/W), b = sum P x/W

which is least at beta = h1/h = 1/(1 + sqrt(b/a)). Without loads, or with loads over the
left face alone, it falls up to the top.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from ..sketch import rectangle
from .assembly import GROUND, Assembly, Hinge, Joint, Load, PlanarBody, Slide
from .mechanism_side import MechanismSide
from .planar_mechanism import PlanarMechanism

LOWER, UPPER = "lower", "upper"
_LOWEST_CRACK = 0.25  # of the height: a lower crack is not searched


class HeldWall(NamedTuple):
    """A wall on the ground whose top moves up and down only; x is from its middle."""

    thickness: float  # t [m]
    height: float  # h [m]
    mass: float  # [kg]
    # its loads, at their bearings while it bulges towards +x (1) and -x (-1), or
    # towards +x alone
    loads: Mapping[float, tuple[Load, ...]]

    def weakest_crack(self) -> tuple[float, float, bool] | None:
        """Return (height of the crack of the least lambda between h/4 and h - t [m],
        this lambda, True if it ends on a bound of this range); None without this range.
        All loads must bear on the top. Of two directions it is the one with the smaller
        lambda.
        """
        t, h = self.thickness, self.height
        low, high = _LOWEST_CRACK * h, h - t
        if low >= high:
            return None
        found = []
        for side, loads in self.loads.items():
            shares = [(load.mass / self.mass, load.at[0] * side) for load in loads]
            a = t * (1.0 + math.fsum(share for share, _ in shares))
            b = math.fsum(share * (x + 0.5 * t) for share, x in shares)
            free = h / (1.0 + math.sqrt(b / a))
            crack = min(max(free, low), high)
            beta = crack / h
            uplift = 2.0 / h * (a / beta + b / (1.0 - beta))
            found.append((uplift, crack, crack != free))
        uplift, crack, bound = min(found)
        return crack, uplift, bound

    def mechanism(self, crack: float, searched: bool) -> PlanarMechanism:
        """Return the wall with its crack at this height [m] as a mechanism."""
        half, bodies = 0.5 * self.thickness, []
        for name, low, high in ((LOWER, 0.0, crack), (UPPER, crack, self.height)):
            depth, centre = high - low, (0.0, 0.5 * (low + high))
            mass = self.mass * depth / self.height
            inertia = mass * (self.thickness**2 + depth**2) / 12.0
            outline = rectangle(-half, half, low, high)
            bodies.append(PlanarBody(name, mass, centre, inertia, outline))
        parts = tuple(bodies)
        sides = {side: self._side(parts, crack, side * half) for side in self.loads}
        return PlanarMechanism(sides[1.0], sides.get(-1.0), searched)

    def _side(
        self, bodies: tuple[PlanarBody, ...], crack: float, face: float
    ) -> MechanismSide:
        """The wall while it bulges towards the face at this x. Its top is held at the
        bearing of the first load on it, or else at the corner that rises.
        """
        loads = self.loads[math.copysign(1.0, face)]
        placed = tuple(
            load._replace(body=UPPER if load.at[1] > crack else LOWER) for load in loads
        )
        on_top = [load.at for load in loads if load.at[1] == self.height]
        joints: tuple[Joint, ...] = (
            Hinge((GROUND, LOWER), (face, 0.0)),
            Hinge((LOWER, UPPER), (-face, crack)),
            Slide(UPPER, (*on_top, (face, self.height))[0]),
        )
        return MechanismSide(Assembly(bodies, placed), joints, LOWER)
