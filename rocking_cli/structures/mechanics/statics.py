"""The static theorem for a voussoir arch: the largest horizontal acceleration that some thrust without tension can carry.

A linear program over the force and moment on every radial joint. It bounds lambda from below where the mechanism bounds it
from above; the two meet where four hinges govern, and part where an arch is so short and thick that its joints open whole.
"""

from __future__ import annotations

import numpy as np

from .fourbar import Ring


def static_uplift(ring: Ring, joints: np.ndarray) -> float | None:
    """lambda of the arch cut by these joints [rad], None if no thrust carries even its own weight."""
    from scipy.optimize import linprog
    from scipy.sparse import csr_array

    ring = Ring(1.0, ring.thickness / ring.radius, ring.angle)  # lambda has no scale, the solver's tolerances have one
    count = joints.size - 1
    polar = 0.5 * np.pi + 0.5 * ring.angle - joints
    x, z = ring.radius * np.cos(polar), ring.radius * np.sin(polar)
    body = ring.sector(joints[:-1], joints[1:])
    i, unknowns = np.arange(count), 3 * (count + 1) + 1  # (force x, force z, moment) of each joint, and lambda
    balance, load = np.zeros((3 * count, unknowns)), np.zeros(3 * count)
    for joint, sign in ((i, 1.0), (i + 1, -1.0)):
        balance[3 * i, 3 * joint] = balance[3 * i + 1, 3 * joint + 1] = balance[3 * i + 2, 3 * joint + 2] = sign
        balance[3 * i + 2, 3 * joint], balance[3 * i + 2, 3 * joint + 1] = -sign * z[joint], sign * x[joint]
    balance[3 * i, -1], balance[3 * i + 2, -1] = body.mass, -body.z
    load[3 * i + 1], load[3 * i + 2] = body.mass, body.x
    inside = np.zeros((2 * (count + 1), unknowns))  # |moment| <= half the thickness times the thrust
    j = np.arange(count + 1)
    for side, sign in ((0, 1.0), (1, -1.0)):
        inside[2 * j + side, 3 * j] = -0.5 * ring.thickness * np.sin(polar)
        inside[2 * j + side, 3 * j + 1] = 0.5 * ring.thickness * np.cos(polar)
        inside[2 * j + side, 3 * j + 2] = sign
    goal = np.zeros(unknowns)
    goal[-1] = -1.0
    found = linprog(goal, csr_array(inside), np.zeros(2 * (count + 1)), csr_array(balance), load, [(None, None)] * unknowns, method="highs")
    return float(found.x[-1]) if found.status == 0 else None
