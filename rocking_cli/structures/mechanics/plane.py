"""Geometry of outlines in the plane of rocking: corners (x, z) [m], in order."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import combinations, pairwise

from .moments import Moments, Point

Line = tuple[Point, Point]


def sides_of(outline: Sequence[Point]) -> list[Line]:
    """Return the sides of a closed outline, from each corner to the next."""
    return list(pairwise((*outline, outline[0]))) if outline else []


def mirrored(point: Point, axis: float) -> Point:
    """Return the mirror image of a point about x = axis."""
    return (2.0 * axis - point[0], point[1])


def polygon_moments(corners: Sequence[Point]) -> Moments:
    """Return mass, first moments and polar moment of a polygon of unit density, by
    Green's theorem; in clockwise order all four have the opposite sign.
    """
    mass = x = z = polar = 0.0
    for (x1, z1), (x2, z2) in sides_of(corners):
        cross = x1 * z2 - x2 * z1
        mass += cross / 2.0
        x += cross * (x1 + x2) / 6.0
        z += cross * (z1 + z2) / 6.0
        polar += (
            cross * (x1 * x1 + x1 * x2 + x2 * x2 + z1 * z1 + z1 * z2 + z2 * z2) / 12.0
        )
    return Moments(mass, x, z, polar)


def crosses_itself(corners: Sequence[Point]) -> bool:
    """True if two sides that are not neighbours touch, or if a side runs back along its
    neighbour.
    """
    sides = sides_of(corners)
    last = len(sides) - 1
    for (a, b), (_, c) in pairwise((*sides, sides[0])):
        if (
            _turn(a, b, c) == 0.0
            and (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0.0
        ):
            return True
    return any(
        _touch(*sides[i], *sides[j])
        for i, j in combinations(range(last + 1), 2)
        if 1 < j - i < last
    )


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _touch(a: Point, b: Point, c: Point, d: Point) -> bool:
    """True if the sides a-b and c-d have a common point."""
    return (
        not apart((a, b), (c, d), 0.0)
        and _turn(a, b, c) * _turn(a, b, d) <= 0.0
        and _turn(c, d, a) * _turn(c, d, b) <= 0.0
    )


def apart(one: Sequence[Point], other: Sequence[Point], near: float) -> bool:
    """True if a vertical or horizontal gap wider than `near` parts two outlines."""
    return any(
        max(p[i] for p in a) < min(p[i] for p in b) - near
        for i in (0, 1)
        for a, b in ((one, other), (other, one))
    )


def distance_to(line: Line, point: Point) -> float:
    """Return the distance of a point from a straight line between two points [m]."""
    (ax, az), (bx, bz) = line
    dx, dz, px, pz = bx - ax, bz - az, point[0] - ax, point[1] - az
    share = min(1.0, max(0.0, (px * dx + pz * dz) / (dx * dx + dz * dz)))
    return math.hypot(px - share * dx, pz - share * dz)


def top_of(points: Sequence[Point]) -> list[Point]:
    """Return the points of the highest level, none of none."""
    if not points:
        return []
    levels = [z for _, z in points]
    near = 1e-9 * (max(levels) - min(levels))
    return [point for point in points if max(levels) - point[1] <= near]


def top_arms(points: Sequence[Point], pivots: Iterable[Point]) -> tuple[float, ...]:
    """Return the distance of each pivot from the farthest point of the top [m], none
    without a top.
    """
    top = top_of(points)
    return tuple(max(math.dist(at, p) for p in top) for at in pivots if top)
