"""The geometry of a structure for a drawing."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

Point = tuple[float, float]
Outline = tuple[Point, ...]
Lines = tuple[tuple[str, Outline], ...]


class Dimension(NamedTuple):
    """A length that the document states, from a point to another, (x, z) [m]."""

    start: Point
    end: Point
    beside: bool = True  # its line stands below the body or left of it


@dataclass(frozen=True)
class Sketch:
    """Geometry to draw; points are (x, z) [m]."""

    bodies: tuple[Outline, ...]  # outlines of the rocking bodies at rest
    still: tuple[Outline, ...] = ()  # outlines of the parts that do not move
    moved: tuple[Outline, ...] = ()  # outlines of the bodies at theta = alpha
    hollows: tuple[Outline, ...] = ()  # outlines of cavities
    pivots: tuple[tuple[str, Point], ...] = ()  # name and place
    centre: Point | None = None  # mass centre of the rocking body, None for a linkage
    lines: Lines = ()  # label and points of other lines, such as a crack
    # label, tail and head of arrows, such as a load
    arrows: tuple[tuple[str, tuple[Point, Point]], ...] = ()
    # function of theta [rad] that returns the outlines of the bodies that then move and
    # of those that stay; None for a body on two edges
    pose: Callable[[float], tuple[list[Outline], list[Outline]]] | None = field(
        default=None, repr=False, compare=False
    )
    # True if the first of the bodies is the circle of the radius of gyration
    gyration: bool = False
    # the lengths that the document states; none for those at the foot and of the height
    dimensions: tuple[Dimension, ...] = ()
    remark: str = ""  # what it states besides, such as a radius and an angle

    def in_unit(self, metre: float) -> "Sketch":
        """Return the same with its points in a unit of length [m]."""

        def of(value: Any) -> Any:
            if isinstance(value, float | int) and not isinstance(value, bool):
                return value / metre
            if isinstance(value, Dimension):
                return Dimension(*map(of, value))
            return tuple(map(of, value)) if isinstance(value, tuple) else value

        return replace(self, **{key: of(x) for key, x in vars(self).items()})

    def posed(self, theta: float) -> tuple[Sequence[Outline], Sequence[Outline]]:
        """Return the outlines at theta [rad]: of what then moves, and of what stays."""
        if self.pose is not None:
            return self.pose(theta)
        about = dict(self.pivots)["right" if theta > 0.0 else "left"]
        return [turned(outline, about, theta) for outline in self.bodies], self.still


def rocker(
    bodies: Iterable[Outline],
    left: Point,
    right: Point,
    centre: Point,
    *,
    inset: float = 0.0,
    lines: Lines = (),
    **more: Any,
) -> Sketch:
    """Return the sketch of a rigid body on two edges, at rest and turned by alpha about
    the right pivot. more: other fields of the sketch; inset: the distance of the pivots
    inside the edges [m].
    """
    bodies, edges = tuple(bodies), (left, right)
    if inset:
        left, right = (left[0] + inset, left[1]), (right[0] - inset, right[1])
        lines = (("inset", (right, edges[1])), ("_inset", (edges[0], left)), *lines)
    alpha = math.atan2(right[0] - centre[0], centre[1] - right[1])
    moved = tuple(turned(outline, right, alpha) for outline in bodies)
    return Sketch(
        bodies,
        moved=moved,
        pivots=(("left", left), ("right", right)),
        centre=centre,
        lines=lines,
        **more,
    )


def redrawn(drawn: Sketch, inset: float) -> Sketch:
    """Return a sketch that `rocker` has made, with its pivots moved inside the edges by
    a length [m].
    """
    assert drawn.centre is not None
    (_, left), (_, right) = drawn.pivots
    return rocker(
        drawn.bodies,
        left,
        right,
        drawn.centre,
        inset=inset,
        still=drawn.still,
        hollows=drawn.hollows,
        lines=drawn.lines,
        gyration=drawn.gyration,
    )


def rectangle(left: float, right: float, low: float, high: float) -> Outline:
    """Return the four corners of a rectangle."""
    return ((left, low), (right, low), (right, high), (left, high))


def turned(outline: Sequence[Point], about: Point, angle: float) -> Outline:
    """Turn an outline clockwise (towards +x) about a point by an angle [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)
    offsets = [(x - about[0], z - about[1]) for x, z in outline]
    return tuple(
        (about[0] + cos * x + sin * z, about[1] + cos * z - sin * x) for x, z in offsets
    )


def circle(centre: Point, radius: float) -> Outline:
    """Return a circle as a polygon of 48 corners."""
    steps = (2.0 * math.pi * i / 48 for i in range(48))
    return tuple(
        (centre[0] + radius * math.cos(s), centre[1] + radius * math.sin(s))
        for s in steps
    )
