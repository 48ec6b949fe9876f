"""The hinges of an arch, by the static theorem: lambda is the largest horizontal
acceleration over g under which a thrust without tension stays inside every joint.

The forces at the left springing and lambda are four unknowns x. In each joint the
moment of the thrust about the intrados is not positive, that about the extrados not
negative: lambda is the optimum of a linear programme, and the four joints that decide
it are the hinges of the mechanism that governs. In short thick arches joints open over
their whole depth before four hinges form.
"""

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...errors import StructureError
from .ring import FACES, INTRADOS, Ring

_FAR = 1e6  # bound of the unknowns at the start, for an arch of radius 1
_ROUNDING = 1e-11  # of the unknowns: a thrust that is so far out of a joint is inside
# joints of a continuous arch at first, and in a window about each joint that decides
_COARSE, _FINE = 72, 20
_NARROWER = 4  # times that such windows are looked at
_APART = 1e-3  # of the arch: hinges that are closer run together
# step of the complex-step derivative, which subtracts nothing and so loses no digits
_STEP = 1e-30
_PIVOTS = 10_000  # of the programme; 110 are the most in 12,000 arches
# of the rows of the hinges A, B, C, D: 1 for the intrados, -1 for the extrados
_SIGNS = np.array([1.0 if face == INTRADOS else -1.0 for face in FACES])


class GoverningJoints(NamedTuple):
    """What governs an arch."""

    uplift: float  # lambda [-], infinite if every acceleration is carried
    joints: Array  # angles of the four joints that decide [rad], rising
    four_hinges: bool  # True if they are the hinges A, B, C, D of a linkage


def search_joints(ring: Ring, joints: Array) -> GoverningJoints | None:
    """Return what governs an arch with these joints [rad]; None if no thrust carries
    its weight under any acceleration.
    """
    (inner, low), (outer, high) = (_rows(ring, joints, sign) for sign in (1.0, -1.0))
    found = _largest(np.vstack([inner, outer]), np.append(low, high))
    if found is None:
        return None
    x, rows = found
    if rows.max() >= 2 * joints.size:
        return GoverningJoints(np.inf, joints[:0], False)
    place, face = rows % joints.size, rows // joints.size
    order = np.lexsort((face, place))
    place, face = place[order], face[order]
    four = np.all(np.diff(place) > 0) and np.array_equal(1 - 2 * face, _SIGNS)
    return GoverningJoints(float(x[3]), joints[place], bool(four))


def _largest(rows: Array, limits: Array) -> tuple[Array, Array] | None:
    """Return (x, (4,); indices of the four rows that decide) for the largest x[3] with
    rows x <= limits, by the dual simplex method; None if there is no such x. Indices
    beyond the rows are those of the bounds x <= _FAR, the first basis. Raises
    StructureError if it does not end.
    """
    rows, limits = np.vstack([rows, np.eye(4)]), np.append(limits, np.full(4, _FAR))
    basis = np.arange(limits.size - 4, limits.size)
    for _ in range(_PIVOTS):
        x = np.linalg.solve(rows[basis], limits[basis])
        out = rows @ x - limits
        enters = int(out.argmax())
        if out[enters] <= _ROUNDING * max(1.0, np.abs(x).max()):
            return x, basis
        # lambda and the row that enters, as sums of rows of the basis
        both = np.stack([np.eye(4)[3], rows[enters]], axis=1)
        price, share = np.linalg.solve(rows[basis].T, both).T
        with np.errstate(all="ignore"):
            ratio = np.where(share > 1e-12, np.maximum(price, 0.0) / share, np.inf)
        if ratio.min() == np.inf:
            return None
        basis[ratio.argmin()] = enters
    raise StructureError("the hinges of the arch are not found")


def _rows(ring: Ring, s: Array, sign: float | Array) -> tuple[Array, Array]:
    """Return (rows, (joints, 4); limits, (joints,)) of the programme for the joints at
    s [rad], for an arch of radius 1; sign: 1 for the intrados, -1 for the extrados.
    """
    ring = Ring(1.0, ring.thickness / ring.radius, ring.angle)
    sign = np.broadcast_to(sign, s.shape)[:, None]
    polar = (0.5 * np.pi + 0.5 * ring.angle - s)[:, None]
    unit, part = np.eye(5), ring.sector(0.0 * s, s)
    mass, x, z = (moment[:, None] for moment in part[:3])

    # Fx, Fz and the moment about the centre in each joint, by the equilibrium of the
    # arch up to it: coefficients of those at the left springing, of lambda, and of 1
    fx, fz = unit[0] + mass * unit[3], unit[1] - mass * unit[4]
    moment = unit[2] - z * unit[3] - x * unit[4]
    normal = np.sin(polar) * fx - np.cos(polar) * fz
    found = sign * (moment + (ring.radius - sign * 0.5 * ring.thickness) * normal)
    return found[:, :4], -found[:, 4]


def search_continuous(ring: Ring) -> GoverningJoints | None:
    """Return what governs an arch that can hinge anywhere, hinges to 1e-10 rad, as
    `search_joints`.
    """
    coarse = np.linspace(0.0, ring.angle, _COARSE + 1)
    found, width = search_joints(ring, coarse), ring.angle / _COARSE
    for _ in range(_NARROWER):
        if found is None or found.four_hinges:
            break
        near = np.add.outer(width * np.linspace(-1.0, 1.0, 2 * _FINE + 1), found.joints)
        joints = np.append(coarse, np.clip(near, 0.0, ring.angle))
        found, width = search_joints(ring, np.unique(joints)), width / _FINE
    if found is None or not found.four_hinges:
        return found

    # Newton's method for hinges where the thrust touches the faces
    s = found.joints
    for _ in range(30):
        x = np.linalg.solve(*_rows(ring, s, _SIGNS))
        slope, bend = _along(ring, s, x)
        held = ((s <= 0.0) & (slope < 0.0)) | ((s >= ring.angle) & (slope > 0.0))
        move = np.where(held, 0.0, np.clip(-slope / bend, -width, width))
        before, s = s, np.clip(s + move, 0.0, ring.angle)
        if np.abs(s - before).max() < 1e-12:
            break
    four = bool(np.diff(s).min() > _APART * ring.angle)
    return GoverningJoints(float(x[3]), s, four)


def _along(ring: Ring, s: Array, x: Array) -> tuple[Array, Array]:
    """Return the first and the second derivative along the arch of how far the thrust
    is out at the hinges s [rad], (4,) each.
    """

    def slope(s: Array) -> Array:
        rows, limits = _rows(ring, s + 1j * _STEP, _SIGNS)
        found: Array = (rows @ x - limits).imag / _STEP
        return found

    step = 1e-5  # rad
    return slope(s), (slope(s + step) - slope(s - step)) / (2.0 * step)
