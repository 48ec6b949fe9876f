"""Bodies, joints and loads of a planar mechanism, and the faces on which its bodies
touch. Lengths are in m, x to the right and z up.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import combinations
from typing import NamedTuple, Self

from ...errors import StructureError
from ..sketch import Outline, Point
from .moments import BOTH, Moments
from .plane import Line, apart, distance_to, mirrored, sides_of

GROUND = "ground"
NEAR = 1e-6  # of the size: points that are so close are one point


class MechanismFault(StructureError):
    """A mechanism that the theory does not cover; `path` is the path of the key that
    states it, such as `joints.1`.
    """

    def __init__(self, path: str, text: str) -> None:
        super().__init__(text)
        self.path = path


class PlanarBody(NamedTuple):
    """A rigid body."""

    name: str  # of the body
    mass: float  # [kg]
    centre: Point  # mass centre at rest [m]
    inertia: float  # moment of inertia about the mass centre [kg m2]
    outline: Outline = ()  # corners at rest, counterclockwise [m]; empty if not known

    @classmethod
    def of(cls, name: str, moments: Moments, outline: Outline) -> Self:
        """Return a body with these moments and this outline."""
        x, z = (float(a) for a in moments.centre)
        return cls(name, float(moments.mass), (x, z), moments.central, outline)


class Hinge(NamedTuple):
    """A joint about which two bodies turn."""

    bodies: tuple[str, str]  # their names; `ground` may be one
    at: Point  # its place at rest [m]


class Slide(NamedTuple):
    """A point of a body that moves along a straight line only."""

    body: str  # its name
    at: Point  # the point at rest [m]
    along: Point = (0.0, 1.0)  # direction of the line

    @property
    def bodies(self) -> tuple[str]:
        """The name of the body alone."""
        return (self.body,)


class Rigid(NamedTuple):
    """Bodies that move as one; with `ground`, bodies that stay."""

    bodies: tuple[str, ...]  # their names


Joint = Hinge | Slide | Rigid


class Load(NamedTuple):
    """A weight that bears on a body."""

    body: str  # its name
    at: Point  # the bearing at rest [m]
    mass: float  # weight over g [kg]
    # both: a mass fixed to the body; vertical: it rises with the bearing and is held
    # horizontally elsewhere; none: a weight without mass
    inertia: str = BOTH
    # True if it bears on the mirrored point while the other side moves
    mirrored: bool = False


class Face(NamedTuple):
    """A stretch on which two bodies touch."""

    bodies: tuple[str, str]  # (i, j): names; `ground` may be j
    ends: Line  # at rest [m]
    normal: Point  # unit vector from j into i


@dataclass(frozen=True)
class Assembly:
    """Bodies and loads on the ground."""

    bodies: tuple[PlanarBody, ...]  # all bodies, also those that stay
    loads: tuple[Load, ...] = ()  # weights on bodies
    level: float | None = None  # of the ground [m]; None for the lowest corner

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of the bodies."""
        return tuple(body.name for body in self.bodies)

    @cached_property
    def size(self) -> float:
        """The largest extent of the bodies [m]."""
        points = [p for body in self.bodies for p in (*body.outline, body.centre)]
        across = [max(p[i] for p in points) - min(p[i] for p in points) for i in (0, 1)]
        return math.hypot(*across) or math.hypot(*self.bodies[0].centre) or 1.0

    @cached_property
    def ground_level(self) -> float:
        """The level of the ground [m]."""
        corners = [z for body in self.bodies for _, z in body.outline]
        return self.level if self.level is not None else min(corners, default=0.0)

    @cached_property
    def middle(self) -> float:
        """x of the middle of the outlines [m]."""
        xs = [x for body in self.bodies for x, _ in (body.outline or (body.centre,))]
        return 0.5 * (min(xs) + max(xs))

    def links(self, joints: Sequence[Joint]) -> list[list[str]]:
        """Return the names of the bodies that move as one, a list for each link; the
        first link is the ground with all bodies that stay.
        """
        named = {name for joint in joints for name in joint.bodies}
        group = {name: {name} for name in (GROUND, *self.names)}
        groups = [joint.bodies for joint in joints if isinstance(joint, Rigid)]
        free = tuple(name for name in self.names if name not in named)
        for together in (*groups, (GROUND, *free)):
            whole = set().union(*(group[name] for name in together))
            group |= dict.fromkeys(whole, whole)
        found = [[name for name in self.names if name in group[GROUND]]]
        first = [
            name
            for name in self.names
            if name not in group[GROUND] and name == min(group[name], key=self._place)
        ]
        return found + [[x for x in self.names if x in group[name]] for name in first]

    def _place(self, name: str) -> int:
        return self.names.index(name)

    def faces(self, hinges: Iterable[Hinge] = ()) -> list[Face]:
        """Return the stretches on which outlines touch each other or the ground. Edges
        at the level of the ground touch it, and at a hinge on the ground the edge that
        faces down most.
        """
        near = NEAR * self.size
        edges = {body.name: sides_of(body.outline) for body in self.bodies}
        down = {
            (name, edge)
            for name, of_body in edges.items()
            for edge in of_body
            if max(abs(z - self.ground_level) for _, z in edge) <= near
            and _inward(edge)[1] > 0.0
        }
        for hinge in hinges:
            if GROUND in hinge.bodies:
                name = next(name for name in hinge.bodies if name != GROUND)
                at = [e for e in edges[name] if distance_to(e, hinge.at) <= near]
                if at:
                    down.add((name, max(at, key=lambda edge: _inward(edge)[1])))
        order = sorted(down, key=lambda found: (self._place(found[0]), found[1]))
        on_ground = [Face((name, GROUND), edge, _inward(edge)) for name, edge in order]
        return [*_touching(self.bodies, near), *on_ground]

    def images(self, axis: float) -> dict[str, str]:
        """Return the name of the mirror image about x = axis of each body that has
        one.
        """
        near, image = NEAR * self.size, {GROUND: GROUND}
        for body in self.bodies:
            turned = _image(body, axis)
            found = [x.name for x in self.bodies if _alike(turned, x, near)]
            if found:
                image[body.name] = found[0]
        return image

    def body(self, name: str) -> PlanarBody:
        """Return the body with this name."""
        return self.bodies[self._place(name)]

    def with_bearings(self, axis: float) -> Assembly:
        """Return the assembly with each mirrored load on its mirrored point."""
        loads = tuple(
            load._replace(at=mirrored(load.at, axis)) if load.mirrored else load
            for load in self.loads
        )
        return replace(self, loads=loads)


def numbered(groups: Sequence[Sequence[str]]) -> dict[str, int]:
    """Return the index of the group of each body; that of the ground is 0."""
    found = {name: i for i, group in enumerate(groups) for name in group}
    return {GROUND: 0} | found


def mirror_image(
    joints: Sequence[Joint], image: dict[str, str], axis: float
) -> tuple[Joint, ...]:
    """Return the joints mirrored about x = axis, on the mirror images of their
    bodies.
    """
    found: list[Joint] = []
    for joint in joints:
        if isinstance(joint, Hinge):
            first, second = (image[name] for name in joint.bodies)
            found.append(Hinge((first, second), mirrored(joint.at, axis)))
        elif isinstance(joint, Slide):
            along = (-joint.along[0], joint.along[1])
            at = mirrored(joint.at, axis)
            found.append(Slide(image[joint.body], at, along))
        else:
            found.append(Rigid(tuple(image[name] for name in joint.bodies)))
    return tuple(found)


def on_outline(body: PlanarBody, point: Point, near: float) -> bool:
    """True if a point lies on the outline of a body, and for a body without one."""
    edges = sides_of(body.outline)
    return not edges or min(distance_to(edge, point) for edge in edges) <= near


def _inward(edge: Line) -> Point:
    """Return the unit vector from an edge into its body."""
    (ax, az), (bx, bz) = edge
    length = math.hypot(bx - ax, bz - az)
    return ((az - bz) / length, (bx - ax) / length)


@lru_cache(maxsize=16)
def _touching(bodies: tuple[PlanarBody, ...], near: float) -> tuple[Face, ...]:
    """The stretches on which the outlines of bodies touch."""
    found = []
    for one, other in combinations([b for b in bodies if b.outline], 2):
        if apart(one.outline, other.outline, near):
            continue
        found += [
            Face((one.name, other.name), ends, _inward(a))
            for a in sides_of(one.outline)
            for b in sides_of(other.outline)
            if (ends := _shared(a, b, near))
        ]
    return tuple(found)


def _shared(a: Line, b: Line, near: float) -> Line | None:
    """Return the stretch that edges of two bodies have in common, None without one."""
    (x, z), (dx, dz) = a[0], (a[1][0] - a[0][0], a[1][1] - a[0][1])
    length = math.hypot(dx, dz)
    dx, dz = dx / length, dz / length
    places = [((px - x) * dx + (pz - z) * dz, px, pz) for px, pz in b]
    off = [abs((pz - z) * dx - (px - x) * dz) for px, pz in b]
    # Opposite senses: the bodies lie on the two sides of the edge.
    if max(off) > near or not places[0][0] > places[1][0]:
        return None
    low, high = max(0.0, places[1][0]), min(length, places[0][0])
    if high - low <= near:
        return None
    ends = [(s, p) for s, *p in places] + [(0.0, list(a[0])), (length, list(a[1]))]
    start, stop = (min(ends, key=lambda end: abs(end[0] - s))[1] for s in (low, high))
    return (start[0], start[1]), (stop[0], stop[1])


def _image(body: PlanarBody, axis: float) -> PlanarBody:
    outline = tuple(mirrored(corner, axis) for corner in reversed(body.outline))
    return body._replace(centre=mirrored(body.centre, axis), outline=outline)


def _alike(one: PlanarBody, other: PlanarBody, near: float) -> bool:
    """True if two bodies have the same mass, inertia and place."""
    share = 1e-9
    if not (
        math.isclose(one.mass, other.mass, rel_tol=share)
        and math.isclose(one.inertia, other.inertia, rel_tol=share)
        and math.dist(one.centre, other.centre) <= near
        and len(one.outline) == len(other.outline)
    ):
        return False
    return all(min(math.dist(p, q) for q in other.outline) <= near for p in one.outline)
