"""One rigid body on two edges as a mechanism of the general form, which the package has
in closed form.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from rocking_cli.structures.mechanics.kinematics import Coefficients
from rocking_cli.structures.mechanics.moments import Moments


@dataclass(frozen=True)
class EdgeRocker:
    """One rigid body that rocks about (pivot, 0) and, after an impact, about (-pivot,
    0).

    shared: the part that moves before and after the impact, None for the whole body.
    """

    body: Moments
    pivot: float
    shared: Moments | None = None

    springs = False

    def reach_to(self, phi: float) -> float:
        """At most pi/2: the body lies on its side."""
        return min(phi, math.pi / 2)

    def beyond_lock(self):
        return self, math.pi / 2, np.asarray

    def coefficients(self, phi: Any) -> Coefficients:
        """M, V'/g and B at rotations phi [rad], of any shape (Eq. 2.1)."""
        x, z = self.pivot * self.body.mass - self.body.x, self.body.z
        sin, cos = np.sin(phi), np.cos(phi)
        return Coefficients(
            self.body.about(self.pivot, 0.0) + 0.0 * sin,
            x * cos - z * sin,
            z * cos + x * sin,
        )

    def lift_slope(self, phi: float) -> float:
        """V''/g at phi [kg m]."""
        x, z = self.pivot * self.body.mass - self.body.x, self.body.z
        return -x * math.sin(phi) - z * math.cos(phi)

    def overlap(self) -> tuple[float, float]:
        """(int rho u.w, int rho w.w): u is a rotation about one edge before the
        impact, w one about the other edge after it.
        """
        left, right = (-self.pivot, 0.0), (self.pivot, 0.0)
        shared = self.shared or self.body
        return shared.between(left, right), self.body.about(*right)
