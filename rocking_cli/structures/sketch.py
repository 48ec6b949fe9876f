"""A structure as it is drawn: outlines of what rocks and of what stays, pivots, mass centre, cracks, and what rocks displaced."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

Point = tuple[float, float]
Outline = tuple[Point, ...]


@dataclass(frozen=True)
class Sketch:
    """Geometry to draw, points (x, z) [m].

    bodies: outlines of what rocks, at rest; still: of what stays; moved: of what rocks at alpha, where it stands no more; hollows: of
    what is not there; pivots: name and place; edges: the ends of the base, from which alpha is measured, with its name; centre: of mass
    of what rocks, None of a linkage; lines: label and course of what is drawn as a line, such as a crack.
    """

    bodies: tuple[Outline, ...]
    still: tuple[Outline, ...] = ()
    moved: tuple[Outline, ...] = ()
    hollows: tuple[Outline, ...] = ()
    pivots: tuple[tuple[str, Point], ...] = ()
    centre: Point | None = None
    lines: tuple[tuple[str, Outline], ...] = ()


def rocker(
    bodies: Iterable[Outline],
    left: Point,
    right: Point,
    centre: Point,
    *,
    still: Iterable[Outline] = (),
    hollows: Iterable[Outline] = (),
    lines: Iterable[tuple[str, Outline]] = (),
) -> Sketch:
    """One body on the ends of its base, displaced about the right one."""
    bodies = tuple(bodies)
    alpha = math.atan2(right[0] - centre[0], centre[1] - right[1])
    return Sketch(
        bodies=bodies,
        still=tuple(still),
        moved=tuple(turned(outline, right, alpha) for outline in bodies),
        hollows=tuple(hollows),
        pivots=(("left", left), ("right", right)),
        centre=centre,
        lines=tuple(lines),
    )


def rectangle(left: float, right: float, low: float, high: float) -> Outline:
    """A rectangle's corners."""
    return ((left, low), (right, low), (right, high), (left, high))


def turned(outline: Sequence[Point], about: Point, angle: float, then: Point = (0.0, 0.0)) -> Outline:
    """An outline turned towards +x (clockwise) about a point, and moved."""
    cos, sin = math.cos(angle), math.sin(angle)
    return tuple(
        (
            about[0] + cos * (x - about[0]) + sin * (z - about[1]) + then[0],
            about[1] + cos * (z - about[1]) - sin * (x - about[0]) + then[1],
        )
        for x, z in outline
    )  # fmt: skip


def circle(centre: Point, radius: float, corners: int = 48) -> Outline:
    """A circle by its corners."""
    steps = (2.0 * math.pi * i / corners for i in range(corners))
    return tuple((centre[0] + radius * math.cos(s), centre[1] + radius * math.sin(s)) for s in steps)
