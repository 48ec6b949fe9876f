"""The static theorem for a voussoir arch: the largest horizontal acceleration that a thrust without tension can carry.

A linear program over the force and moment on every radial joint gives a lower bound of lambda; the mechanism gives an upper
bound. They are equal where four hinges govern: the thrust through the hinges then stays inside every joint. They differ for short
thick arches, whose joints open over their whole depth.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .fourbar import FACES, Ring

_ROUNDING = 1e-9  # of the thickness, by which rounding may move the thrust out of a joint


def carried_through(ring: Ring, joints: np.ndarray, hinges: Sequence[float]) -> bool:
    """True if the thrust through four hinges [rad] stays inside every joint [rad]: then their mechanism governs.

    Force and moment at the left springing and lambda are four unknowns; that the thrust passes through the hinges gives four
    linear equations. The equilibrium of the arch up to a joint gives the thrust there.
    """
    unit = np.eye(5)  # Fx, Fz and moment about the centre at the left springing, lambda, and 1: every force is linear in them

    def thrust(s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        part = ring.sector(np.zeros(s.size), s)
        mass, x, z = (np.asarray(moment)[:, None] for moment in part[:3])
        return unit[0] + mass * unit[3], unit[1] - mass * unit[4], unit[2] - z * unit[3] - x * unit[4]

    places = np.array(hinges)
    x, z = (np.array(c)[:, None] for c in zip(*(ring.point(s, face) for s, face in zip(places, FACES, strict=True)), strict=True))
    fx, fz, moment = thrust(places)
    equations = moment + z * fx - x * fz
    try:
        found = np.append(np.linalg.solve(equations[:, :4], -equations[:, 4]), 1.0)
    except np.linalg.LinAlgError:
        return False
    polar = 0.5 * np.pi + 0.5 * ring.angle - joints
    fx, fz, moment = (force @ found for force in thrust(joints))
    normal = np.sin(polar) * fx - np.cos(polar) * fz
    eccentric = moment + ring.radius * (np.sin(polar) * fx - np.cos(polar) * fz)
    return bool(np.all(normal > 0.0) and np.all(np.abs(eccentric) <= (0.5 + _ROUNDING) * ring.thickness * normal))


def static_uplift(ring: Ring, joints: np.ndarray) -> float | None:
    """lambda [-] of the arch with these joints [rad] by the linear program, None if no thrust carries its own weight."""
    from scipy.optimize import linprog
    from scipy.sparse import csr_array

    ring = Ring(1.0, ring.thickness / ring.radius, ring.angle)  # lambda does not depend on the scale, but the solver's tolerances do
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
    inside = np.zeros((2 * (count + 1), unknowns))  # |moment| <= thickness/2 times the thrust
    j = np.arange(count + 1)
    for side, sign in ((0, 1.0), (1, -1.0)):
        inside[2 * j + side, 3 * j] = -0.5 * ring.thickness * np.sin(polar)
        inside[2 * j + side, 3 * j + 1] = 0.5 * ring.thickness * np.cos(polar)
        inside[2 * j + side, 3 * j + 2] = sign
    goal = np.zeros(unknowns)
    goal[-1] = -1.0
    found = linprog(goal, csr_array(inside), np.zeros(2 * (count + 1)), csr_array(balance), load, [(None, None)] * unknowns, method="highs")
    return float(found.x[-1]) if found.status == 0 else None
