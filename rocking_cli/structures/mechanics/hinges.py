"""The hinges of an arch: the admissible four-hinge mechanism with the least uplift
acceleration (kinematic theorem).

For n voussoirs the search tries every choice of four of the n + 1 joints. For a
continuous arch it starts from the best of a coarse set of joints, and refines until the
gradient is zero for every hinge that can move.

The static theorem gives the largest horizontal acceleration that a thrust without
tension can carry, a lower bound of lambda. Both bounds are equal where four hinges
govern: the thrust through the hinges then stays inside every joint. They differ for
short thick arches, whose joints open over their whole depth.
"""

from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np

from .fourbar import FACES, LinkRates, Ring, rates

Hinges = tuple[float, ...]  # angles of A, B, C, D [rad]

# joints of the coarse set; the neighbourhood of a minimum is several joints wide
_COARSE = 36
_LATTICE = np.array(list(product((-1.0, -0.5, 0.0, 0.5, 1.0), repeat=4)))
# part of the thickness by which rounding may move the thrust out of a joint
_ROUNDING = 1e-9
# step of the complex-step derivative, which subtracts nothing and so loses no digits
_STEP = 1e-30


def search_joints(ring: Ring, joints: np.ndarray) -> tuple[Hinges, float] | None:
    """Return (hinges, lambda) of the governing mechanism with hinges on these joints
    [rad], None if no mechanism is admissible. If lambda <= 0 the arch does not stand. A
    joint with two hinges opens over its whole depth, which may govern short thick
    arches.
    """
    count = joints.size
    inner = np.array(ring.point(joints, FACES[0]))
    outer = np.array(ring.point(joints, FACES[1]))
    upto = ring.sector(0.0, joints)  # a link is the difference of two of these
    least, best = np.inf, [0]
    for a in range(count):  # for each pair (A, B) all pairs (C, D) at once
        for b in range(a, count):
            c, d = np.arange(b, count)[:, None], np.arange(b, count)[None, :]
            links = [
                (
                    upto.mass[j] - upto.mass[i],
                    upto.x[j] - upto.x[i],
                    upto.z[j] - upto.z[i],
                )
                for i, j in ((a, b), (b, c), (c, d))
            ]
            with np.errstate(all="ignore"):
                found = rates(
                    (inner[:, a], outer[:, b], inner[:, c], outer[:, d]), links
                )
                uplift = np.where(
                    (d >= c) & found.admissible & (found.push > 0.0),
                    found.lift / found.push,
                    np.inf,
                )
            at = int(np.argmin(uplift))
            if uplift.flat[at] < least:
                i, j = divmod(at, uplift.shape[1])
                least, best = float(uplift.flat[at]), [a, b, b + i, b + j]
    return (tuple(joints[best].tolist()), least) if np.isfinite(least) else None


def search_continuous(ring: Ring) -> tuple[Hinges, float] | None:
    """Return (hinges, lambda) of the governing mechanism of a continuous arch, angles
    to 1e-10 rad. None if no mechanism is admissible, or if two hinges converge, as in
    short thick arches, where no mechanism has the least lambda.
    """
    start = search_joints(ring, np.linspace(0.0, ring.angle, _COARSE + 1))
    if start is None:
        return None
    s, least, width = np.array(start[0]), start[1], ring.angle / _COARSE

    # Pattern search: the lattice moves to its best point, or shrinks.
    while width > 1e-7 * ring.angle:
        tried = np.clip(s + width * _LATTICE, 0.0, ring.angle)
        values = _uplifts(ring, tried)
        at = int(np.argmin(values))
        if values[at] < least:
            s, least = tried[at], float(values[at])
        else:
            width *= 0.5
    if np.min(np.diff(s)) < 1e-3 * ring.angle:
        return None
    rough = s

    # Newton's method for a zero gradient. A hinge on a springing stays there while
    # lambda falls only beyond it.
    for _ in range(30):
        slope = _gradient(ring, s)
        free = ~(((s <= 0.0) & (slope > 0.0)) | ((s >= ring.angle) & (slope < 0.0)))
        move = np.zeros(4)
        move[free] = -np.linalg.lstsq(
            _curvature(ring, s)[np.ix_(free, free)], slope[free], rcond=None
        )[0]
        # A long step: the minimum lies on the boundary of the admissible mechanisms.
        if np.max(np.abs(move)) > 1e-3 * ring.angle:
            break
        before, s = s, np.clip(s + move, 0.0, ring.angle)
        if np.max(np.abs(s - before)) < 1e-12:
            break
    polished = float(_uplifts(ring, s[None, :])[0])
    return (
        (tuple(s.tolist()), polished)
        if polished <= least + 1e-15
        else (tuple(rough.tolist()), least)
    )


def _uplifts(ring: Ring, s: np.ndarray) -> np.ndarray:
    """Return lambda [-] of mechanisms with hinge angles s, shape (count, 4); infinity
    for a mechanism that is not admissible.
    """
    ordered = np.all(np.diff(s, axis=1) > 0.0, axis=1)
    with np.errstate(all="ignore"):
        found = _rates(ring, s.T)
        return np.where(
            ordered & found.admissible & (found.push > 0.0),
            found.lift / found.push,
            np.inf,
        )


def _rates(ring: Ring, s: np.ndarray) -> LinkRates:
    """Return the rates of the mechanism with these hinge angles, (4, ...)."""
    points = [ring.point(x, face) for x, face in zip(s, FACES, strict=True)]
    return rates(points, [ring.sector(a, b)[:3] for a, b in pairwise(s)])


def _gradient(ring: Ring, s: np.ndarray) -> np.ndarray:
    """Return the derivatives d lambda/ds [1/rad], shape (4,)."""
    moved = [_rates(ring, s + 1j * _STEP * unit) for unit in np.eye(4)]
    return np.array([(found.lift / found.push).imag / _STEP for found in moved])


def _curvature(ring: Ring, s: np.ndarray) -> np.ndarray:
    """Return the second derivatives of lambda, shape (4, 4)."""
    step = 1e-5  # rad
    rows = [
        (_gradient(ring, s + step * unit) - _gradient(ring, s - step * unit))
        / (2.0 * step)
        for unit in np.eye(4)
    ]
    return 0.5 * (np.array(rows) + np.array(rows).T)


def carried_through(ring: Ring, joints: np.ndarray, hinges: Sequence[float]) -> bool:
    """True if the thrust through four hinges [rad] stays inside every joint [rad]: then
    their mechanism governs.
    """
    places = np.array(hinges)
    x, z = (
        np.array(c)[:, None]
        for c in zip(
            *(ring.point(s, face) for s, face in zip(places, FACES, strict=True)),
            strict=True,
        )
    )
    fx, fz, moment = _thrust(ring, places)
    equations = moment + z * fx - x * fz  # no moment about each of the hinges
    try:
        found = np.append(np.linalg.solve(equations[:, :4], -equations[:, 4]), 1.0)
    except np.linalg.LinAlgError:
        return False
    normal, eccentric = (forces @ found for forces in _in_joints(ring, joints))
    return bool(
        np.all(normal > 0.0)
        and np.all(np.abs(eccentric) <= (0.5 + _ROUNDING) * ring.thickness * normal)
    )


def static_uplift(ring: Ring, joints: np.ndarray) -> float | None:
    """Return lambda [-] by the static theorem for these joints [rad], by a linear
    program; None if no thrust carries the arch's weight.
    """
    from scipy.optimize import linprog

    # lambda does not depend on the scale, but the tolerances of the solver do.
    ring = Ring(1.0, ring.thickness / ring.radius, ring.angle)
    normal, eccentric = _in_joints(ring, joints)

    # The largest lambda with |M| <= N t/2 on every joint.
    outside = np.vstack(
        [side * eccentric - 0.5 * ring.thickness * normal for side in (1.0, -1.0)]
    )
    found = linprog(
        [0.0, 0.0, 0.0, -1.0],
        outside[:, :4],
        -outside[:, 4],
        bounds=[(None, None)] * 4,
        method="highs",
    )
    return float(found.x[3]) if found.status == 0 else None


def _thrust(ring: Ring, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return Fx, Fz and the moment about the centre in the joints at s [rad], by the
    equilibrium of the arch up to each joint, as coefficients, shape (joints, 5), of Fx,
    Fz and moment at the left springing, lambda, and 1.
    """
    unit, part = np.eye(5), ring.sector(np.zeros(s.size), s)
    mass, x, z = (np.asarray(moment)[:, None] for moment in part[:3])
    return (
        unit[0] + mass * unit[3],
        unit[1] - mass * unit[4],
        unit[2] - z * unit[3] - x * unit[4],
    )


def _in_joints(ring: Ring, joints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the normal force and its moment about the middle of each joint, as
    coefficients like those of `_thrust`.
    """
    polar = (0.5 * np.pi + 0.5 * ring.angle - joints)[:, None]
    fx, fz, moment = _thrust(ring, joints)
    normal = np.sin(polar) * fx - np.cos(polar) * fz
    return normal, moment + ring.radius * normal
