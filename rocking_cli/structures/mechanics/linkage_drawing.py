"""The sketch of a mechanism in one direction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..sketch import Lines, Outline, Point, Sketch, circle
from .assembly import Assembly, Load, Slide
from .linkage import Linkage
from .plane import mirrored

if TYPE_CHECKING:
    from ..parameters import RockingParameters


def linkages_of(built: RockingParameters) -> tuple[Linkage, Linkage | None]:
    """Return the mechanisms to the right and to the left, None for its mirror image."""
    left, right = (side.mechanism for side in built.left_and_right)
    assert left is not None
    assert right is not None
    return right, left if built.sides else None


def drawn(
    built: RockingParameters,
    right: Linkage,
    left: Linkage | None,
    *,
    axis: float | None = None,
    slides: str = "slides",
) -> Sketch:
    """Return a sketch of the bodies at rest and at alpha in the direction that moves
    first, with numbered hinges, sliders, and the loads in kN.

    slides: the text of a slider; right, left: the mechanisms of both directions, left
    None for the mirror image of the right one about x = axis [m], None for the middle
    of the outlines. A body without an outline is the circle of its radius of gyration.
    """
    linkage = min(
        (right, left) if built.sides and left is not None else (right,),
        key=lambda one: one.at_rest.lift / abs(one.at_rest.push),
    )
    about = right.assembly.middle if axis is None else axis
    assembly = linkage.assembly
    bodies, still = _posed(linkage, 0.0)
    moved, _ = _posed(linkage, built.alpha)

    def pose(theta: float) -> tuple[list[Outline], list[Outline]]:
        if theta >= 0.0:
            return _posed(right, theta)
        if left is not None:
            return _posed(left, -theta)
        posed = _posed(right, -theta)
        one, other = (
            [tuple(mirrored(corner, about) for corner in x) for x in outlines]
            for outlines in posed
        )
        return one, other

    return Sketch(
        tuple(bodies),
        still=tuple(still),
        moved=tuple(moved),
        pivots=tuple((str(i), hinge.at) for i, hinge in enumerate(linkage.hinges, 1)),
        lines=_slide_lines(linkage.sliders, assembly, slides),
        arrows=load_arrows(assembly.loads, built.gravity, 0.08 * assembly.size),
        pose=pose,
    )


def _posed(linkage: Linkage, phi: float) -> tuple[list[Outline], list[Outline]]:
    """Return the outlines of the bodies that move, at phi, and of those that stay."""
    moved, still = [], []
    end = linkage.reach_to(min(phi, 0.5 * math.pi))
    at = linkage.positions(np.array([(1.0 - 1e-6) * end]))
    for body in linkage.assembly.bodies:
        outline = body.outline or circle(
            body.centre, math.sqrt(body.inertia / body.mass)
        )
        if not linkage.link_of[body.name]:
            still.append(outline)
            continue
        chains = linkage.chains([(body.name, corner) for corner in outline])
        places = linkage.motion(at, chains).place[0]
        moved.append(tuple((float(p.real), float(p.imag)) for p in places))
    return moved, still


def load_arrows(
    loads: Sequence[Load], gravity: float, length: float
) -> tuple[tuple[str, tuple[Point, Point]], ...]:
    """Return an arrow of this length [m] down to the bearing of each load, with its
    weight in words.
    """
    return tuple(
        (
            f"{load.mass * gravity / 1e3:.4g} kN",
            ((load.at[0], load.at[1] + length), load.at),
        )
        for load in loads
    )


def _slide_lines(sliders: Sequence[Slide], assembly: Assembly, label: str) -> Lines:
    """A line along the direction of each slider."""
    found: list[tuple[str, Outline]] = []
    for slider in sliders:
        scale = 0.04 * assembly.size / math.hypot(*slider.along)
        x, z = scale * slider.along[0], scale * slider.along[1]
        ends = tuple((slider.at[0] + s * x, slider.at[1] + s * z) for s in (1.0, -1.0))
        found.append((label, ends))
    return tuple(found)
