"""Whether the joints of a mechanism open as it moves, and whether its bodies meet.

A face between two links must not close: n.(u_i - u_j) >= 0 at both of its ends at rest,
and a gap >= 0 later on, with n turned with body j.
"""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

from ...arrays import Array
from .assembly import GROUND, Assembly, Face, Hinge, MechanismFault
from .linkage import Linkage
from .loop_closure import Positions
from .plane import apart

_POSITIONS = 40  # between rest and alpha at which outlines are looked at
_DEEP = 1e-5  # of the size: outlines that lie deeper in each other meet
_RATE = 1e-5  # of the fastest point: a face that closes more slowly stays closed


def check_opening(linkage: Linkage) -> None:
    """Raise MechanismFault if a face closes at rest."""
    closing = _closing(linkage, 1.0)
    if not closing:
        return
    if not _closing(linkage, -1.0):
        raise MechanismFault(
            linkage.path,
            "it does not stand: its weight moves it in the direction in which the"
            " joints open.",
        )
    face, end = closing[0]
    number = _joint_of(linkage, face)
    where = linkage.path if number is None else f"{linkage.path}.{number}"
    raise MechanismFault(
        where,
        f"{where}: the joint between {_in_order(linkage, face)} closes at"
        f" {place(end)} instead of opening: move its hinge to the other face.",
    )


def _in_order(linkage: Linkage, face: Face) -> str:
    """The bodies of a face in words, the ground first."""
    names = sorted(face.bodies, key=(GROUND, *linkage.assembly.names).index)
    return " and ".join(repr(name) if name != GROUND else name for name in names)


def _joint_of(linkage: Linkage, face: Face) -> int | None:
    """Return the number of the hinge between the bodies of a face, or their links."""
    names, links = set(face.bodies), {linkage.link_of[name] for name in face.bodies}
    joints = enumerate(linkage.joints)
    hinges = [(i, joint.bodies) for i, joint in joints if isinstance(joint, Hinge)]
    own = [i for i, bodies in hinges if set(bodies) == names]
    theirs = [
        i for i, (a, b) in hinges if {linkage.link_of[a], linkage.link_of[b]} == links
    ]
    return next(iter(own + theirs), None)


def place(point: tuple[float, float]) -> str:
    """Return a point in words."""
    x, z = (round(value, 9) + 0.0 for value in point)
    return f"[{x:.6g}, {z:.6g}]"


def _openings(linkage: Linkage, faces: list[Face]) -> tuple[Array, float]:
    """Return (how fast the ends of faces open at rest, (faces, 2); the fastest
    velocity) for phi' = 1 [m].
    """
    rest = linkage.positions(np.zeros(1))
    rates = np.zeros((len(faces), 2))
    fastest = 0.0
    for i, face in enumerate(faces):
        ends = [(name, end) for name in face.bodies for end in face.ends]
        u = linkage.motion(rest, linkage.chains(ends)).rate[0]
        normal = np.conj(complex(*face.normal))
        rates[i] = (normal * (u[:2] - u[2:])).real
        fastest = max(fastest, float(np.abs(u).max()))
    return rates, fastest


def opening_ends(linkage: Linkage, faces: list[Face]) -> Array:
    """True for the ends of faces that open at rest, (faces, 2)."""
    rates, fastest = _openings(linkage, faces)
    return rates > _RATE * fastest


def _closing(linkage: Linkage, sense: float) -> list[tuple[Face, tuple[float, float]]]:
    """The faces that close at rest, each with the end that closes fastest."""
    faces = linkage.faces
    rates, fastest = _openings(linkage, faces)
    return [
        (face, face.ends[int((sense * pair).argmin())])
        for face, pair in zip(faces, rates, strict=True)
        if (sense * pair).min() < -_RATE * fastest
    ]


def check_path(linkage: Linkage, alpha: float) -> None:
    """Raise MechanismFault if bodies meet before alpha."""
    phi = np.linspace(0.0, alpha, _POSITIONS + 1)[1:]
    at = linkage.positions(phi)
    met = _gaps_close(linkage, at)
    for one, other in _near(linkage, at):
        first = _overlap(linkage, at, one, other)
        if first is not None:
            met.append((first, one, other))
    if met:
        first, one, other = min(met)
        one, other = (other, one) if not linkage.link_of[one] else (one, other)
        raise MechanismFault(
            linkage.path,
            f"{one!r} meets {other!r} at {math.degrees(phi[first]):.3g} deg, before the"
            f" unstable equilibrium at {math.degrees(alpha):.3g} deg.",
        )


def _gaps_close(linkage: Linkage, at: Positions) -> list[tuple[int, str, str]]:
    """(first position, body, body) of each face that has closed again."""
    found = []
    turned = linkage.turned(at.q)
    for face in linkage.faces:
        one, other = face.bodies
        normal = np.conj(complex(*face.normal) * turned[:, linkage.link_of[other]])
        ends = [(name, end) for name in face.bodies for end in face.ends]
        places = linkage.motion(at, linkage.chains(ends)).place
        gaps = (normal[:, None] * (places[:, :2] - places[:, 2:3])).real
        shut = np.flatnonzero(gaps.min(axis=1) < -_DEEP * linkage.assembly.size)
        if shut.size:
            found.append((int(shut[0]), one, other))
    return found


def _near(linkage: Linkage, at: Positions) -> list[tuple[str, str]]:
    """Pairs of bodies of different links whose circles come to overlap."""
    bodies = linkage.assembly.bodies
    centres = linkage.motion(at, linkage.chains([(b.name, b.centre) for b in bodies]))
    reach = [
        max((math.dist(b.centre, p) for p in b.outline), default=0.0) for b in bodies
    ]
    found = []
    for i, j in combinations(range(len(bodies)), 2):
        one, other = bodies[i].name, bodies[j].name
        apart = np.abs(centres.place[:, i] - centres.place[:, j]).min()
        if (
            linkage.link_of[one] != linkage.link_of[other]
            and apart < reach[i] + reach[j]
        ):
            found.append((one, other))
    return found


def _overlap(linkage: Linkage, at: Positions, one: str, other: str) -> int | None:
    """The first position at which a point of one outline is inside the other one."""
    corners = [
        [(name, p) for p in linkage.assembly.body(name).outline]
        for name in (one, other)
    ]
    if not all(corners):
        return None
    a, b = (linkage.motion(at, linkage.chains(points)).place for points in corners)
    first = np.flatnonzero(_meet(a, b, _DEEP * linkage.assembly.size))
    return int(first[0]) if first.size else None


def _meet(one: Array, other: Array, deep: float) -> Array:
    """True where a corner, or the middle of an edge, of one outline lies deeper than
    `deep` [m] in the other one, (n,); outlines: corners in order, (n, corners).
    """
    met = np.zeros(len(one), dtype=bool)
    for inner, outer in ((one, other), (other, one)):
        middles = 0.5 * (inner + np.roll(inner, -1, axis=1))
        points = np.concatenate([inner, middles], axis=1)
        met |= _depth(points, outer).max(axis=1) > deep
    return met


def _depth(points: Array, outline: Array) -> Array:
    """How deep points lie inside an outline, negative outside [m], (n, points);
    outline: its corners in order, (n, corners).
    """
    start, side = outline[:, None], (np.roll(outline, -1, axis=1) - outline)[:, None]
    off = points[:, :, None] - start
    share = np.clip((np.conj(side) * off).real / np.abs(side) ** 2, 0.0, 1.0)
    distance = np.abs(off - share * side).min(axis=2)
    above = off.imag >= 0.0
    crosses = above != np.roll(above, -1, axis=2)
    with np.errstate(all="ignore"):
        right = off.real < side.real * off.imag / side.imag
    inside = np.sum(crosses & right, axis=2) % 2 == 1
    return np.where(inside, distance, -distance)


def overlapping_at_rest(assembly: Assembly) -> tuple[str, str] | None:
    """Return the names of two bodies whose outlines overlap at rest, None without."""
    deep = _DEEP * assembly.size
    outlined = [body for body in assembly.bodies if body.outline]
    for one, other in combinations(outlined, 2):
        parted = apart(one.outline, other.outline, -deep)
        if parted:
            continue
        a, b = (np.array([[complex(*p) for p in x.outline]]) for x in (one, other))
        if _meet(a, b, deep).any() or abs(a.mean() - b.mean()) <= deep:
            return one.name, other.name
    return None
