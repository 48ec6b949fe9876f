"""The line of thrust of an arch of radial joints: a second opinion on where it hinges,
from equilibrium alone.

The reaction at the left springing (two forces and a moment) and the tilt are four
unknowns; weight and inertia of what lies to the left of a joint then give the force in
it, and where it passes. Weights and centroids are summed over points in the material.
"""

import math

import numpy as np
from scipy.optimize import linprog

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


def largest_tilt(
    radius: float, thickness: float, angle: float, voussoirs: int
) -> float | None:
    """lambda by the static theorem: the largest horizontal acceleration over g under
    which a line of thrust fits the joints.

    radius of the centre line, thickness [same unit], angle of inclusion [rad]. A joint
    takes what passes between its faces: of all that acts on its left, the moment about
    its inner edge is not positive, that about its outer edge not negative. None where
    no line fits under any tilt.
    """
    polar = math.pi / 2 + angle / 2 - np.linspace(0.0, angle, voussoirs + 1)
    inner, outer = radius - thickness / 2, radius + thickness / 2
    rho = radius + thickness / 2 * _NODES[:, None]
    mass, x, z = np.zeros(
        (3, voussoirs + 1)
    )  # of all voussoirs on the left of each joint
    for i in range(voussoirs):
        half = (polar[i] - polar[i + 1]) / 2
        phi = (polar[i] + polar[i + 1]) / 2 + half * _NODES[None, :]
        element = rho * thickness / 2 * half * _WEIGHTS[:, None] * _WEIGHTS[None, :]
        mass[i + 1] = mass[i] + element.sum()
        x[i + 1] = x[i] + (element * rho * np.cos(phi)).sum()
        z[i + 1] = z[i] + (element * rho * np.sin(phi)).sum()
    start = radius * np.array([math.cos(polar[0]), math.sin(polar[0])])
    rows, limits = [], []
    for edge, sign in ((inner, 1.0), (outer, -1.0)):
        px, pz = edge * np.cos(polar), edge * np.sin(polar)
        # Moments, counter-clockwise, about (px, pz): of the reaction (H, V, M), of the
        # inertia lambda m to the right, of the weight.
        moment = np.array(
            [-(start[1] - pz), start[0] - px, np.ones_like(px), -(z - mass * pz)]
        ).T
        rows.append(sign * moment)
        limits.append(sign * (x - mass * px))
    found = linprog(
        [0.0, 0.0, 0.0, -1.0],
        np.vstack(rows),
        np.concatenate(limits),
        bounds=[(None, None)] * 4,
        method="highs",
    )
    return float(found.x[3]) if found.status == 0 else None
