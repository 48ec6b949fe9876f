"""A rigid block with a polygonal section, on the two ends of its base.

An unsymmetric section has two sides. A one-sided block hits its backing at its highest
corner, the leftmost of several.
"""

import math
from collections.abc import Sequence
from itertools import combinations, pairwise

from ...documents.document import Document
from ...documents.keys import Key, Keys, length
from ..mechanics.moments import Moments
from ..mechanics.single_body import RigidBody, body_on_edges
from ..mechanics.toe import strip_foot
from ..shared_keys import DENSITY
from ..sketch import rocker

REPORTS = ("direction",)
CORNERS = {"corners": Key("pairs", "[x, z] in order around the section")}
KEYS = Keys(
    CORNERS,
    {"density": DENSITY, "length": length("across the rocking, with a density")},
)

Corner = tuple[float, float]


def polygon_moments(corners: Sequence[Corner]) -> Moments:
    """Return mass, first moments and polar moment of a polygon of unit density, by
    Green's theorem. corners: (x, z) [m], counterclockwise; in clockwise order all four
    have the opposite sign.
    """
    mass = x = z = polar = 0.0
    for (x1, z1), (x2, z2) in pairwise([*corners, corners[0]]):
        cross = x1 * z2 - x2 * z1
        mass += cross / 2.0
        x += cross * (x1 + x2) / 6.0
        z += cross * (z1 + z2) / 6.0
        polar += (
            cross * (x1 * x1 + x1 * x2 + x2 * x2 + z1 * z1 + z1 * z2 + z2 * z2) / 12.0
        )
    return Moments(mass, x, z, polar)


def body(document: Document) -> RigidBody:
    """Return a prism from the key `corners`, [[x, z], ...] in order; its lowest corners
    are the base. density and length (across the rocking) give its mass. Raises
    DocumentError.
    """
    corners = corners_of(document)
    lowest = min(z for _, z in corners)
    tolerance = 1e-9 * max(math.dist(a, b) for a in corners for b in corners)
    left, right = _base(document, corners, lowest, tolerance)
    middle, half = 0.5 * (left + right), 0.5 * (right - left)

    # The mechanics take the middle of the base as origin, the drawing the axes of the
    # document.
    placed = [(x - middle, z - lowest) for x, z in corners]
    moments, section = polygon_moments(placed), polygon_moments(corners)
    if not (abs(moments.x / moments.mass) < half and moments.z > 0.0):
        raise document.fault(
            None, "a centroid that is not above the base", "a prism that stands"
        )
    drawing = rocker(
        [tuple(corners)],
        (left, lowest),
        (right, lowest),
        (section.x / section.mass, section.z / section.mass),
    )
    foot, details = strip_foot(document, right - left, moments.mass)
    highest = max(z for _, z in placed)
    return body_on_edges(
        moments,
        half,
        top=min(corner for corner in placed if highest - corner[1] <= tolerance),
        limit="a section more slender than this one",
        drawing=drawing,
        foot=foot,
        details=details,
    )


def _base(
    document: Document, corners: Sequence[Corner], lowest: float, tolerance: float
) -> tuple[float, float]:
    """Return the ends in x [m] of the base, on the level `lowest`. Raises DocumentError
    if the section rests on one point.
    """
    feet = [x for x, z in corners if z - lowest <= tolerance]
    left, right = min(feet), max(feet)
    if right - left <= tolerance:
        raise document.fault(
            "corners",
            "a section that rests on one point",
            "a base of two lowest corners or more",
        )
    return left, right


def corners_of(document: Document) -> list[Corner]:
    """Return the corners counterclockwise. Raises DocumentError for a section that is
    not a polygon with an area.
    """
    wanted = "a list of three or more corners [x, z], lengths in m or with a unit"
    if not document.has("corners"):
        raise document.missing("corners", wanted)
    value = document.values["corners"]
    if not isinstance(value.content, list) or len(value.content) < 3:
        raise document.fault("corners", str(value), wanted)
    corners = [
        document.pair("corners", child, "length", "corner", wanted)
        for child in value.content
    ]
    if corners[0] == corners[-1]:  # drawing programs repeat the first corner
        corners.pop()
    if len(corners) < 3 or len(set(corners)) < len(corners):
        raise document.fault("corners", "a corner given twice", wanted)
    if _crosses_itself(corners):
        raise document.fault(
            "corners",
            "a section that crosses itself",
            "corners in order around the section",
        )
    area = polygon_moments(corners).mass
    if abs(area) <= 1e-12 * max(math.dist(a, b) for a in corners for b in corners) ** 2:
        raise document.fault("corners", "a section without area", wanted)
    return corners if area > 0.0 else corners[::-1]


def _crosses_itself(corners: Sequence[Corner]) -> bool:
    """True if two edges that are not neighbours touch, or if an edge runs back along
    its neighbour.
    """
    edges = list(pairwise([*corners, corners[0]]))
    last = len(edges) - 1
    for (a, b), (_, c) in pairwise([*edges, edges[0]]):
        if (
            _turn(a, b, c) == 0.0
            and (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0.0
        ):
            return True
    return any(
        _touch(*edges[i], *edges[j])
        for i, j in combinations(range(last + 1), 2)
        if 1 < j - i < last
    )


def _turn(a: Corner, b: Corner, c: Corner) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _touch(a: Corner, b: Corner, c: Corner, d: Corner) -> bool:
    """True if the edges a-b and c-d have a common point."""
    apart = any(
        max(a[i], b[i]) < min(c[i], d[i]) or max(c[i], d[i]) < min(a[i], b[i])
        for i in (0, 1)
    )
    return (
        not apart
        and _turn(a, b, c) * _turn(a, b, d) <= 0.0
        and _turn(c, d, a) * _turn(c, d, b) <= 0.0
    )
