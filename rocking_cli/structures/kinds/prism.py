"""A rigid block with a polygonal section, on the two ends of its base.

An unsymmetric section has two sides. A one-sided block hits its backing at its highest
corner, the leftmost of several.
"""

import math
from collections.abc import Sequence

from ...documents.document import Document
from ...documents.keys import OF_BUILDINGS, Key, Keys, length
from ..mechanics.plane import crosses_itself, polygon_moments, top_of
from ..mechanics.single_body import RigidBody
from ..mechanics.toe import foot_of
from ..shared_keys import DENSITY
from ..sketch import Point, rocker

REPORTS = ("direction",)
_PLACES = OF_BUILDINGS._replace(least=-30.0)
CORNERS = {"corners": Key("pairs", "[x, z] in order around the section", usual=_PLACES)}
KEYS = Keys(
    CORNERS,
    {"density": DENSITY, "length": length("across the rocking, with a density", None)},
)


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
    moments = polygon_moments(placed)
    x, z = moments.centre
    if not (abs(x) < half and z > 0.0):
        raise document.fault(
            None, "a centroid that is not above the base", "a prism that stands"
        )
    drawing = rocker(
        [tuple(corners)],
        (left, lowest),
        (right, lowest),
        (middle + x, lowest + z),
    )
    foot, details = foot_of(document, right - left, moments.mass)
    return RigidBody(
        moments=moments,
        half=half,
        top=min(top_of(placed)),
        limit="a section more slender than this one",
        drawing=drawing,
        foot=foot,
        details=details,
    )


def _base(
    document: Document, corners: Sequence[Point], lowest: float, tolerance: float
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


def corners_of(document: Document) -> list[Point]:
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
    if crosses_itself(corners):
        raise document.fault(
            "corners",
            "a section that crosses itself",
            "corners in order around the section",
        )
    area = polygon_moments(corners).mass
    if abs(area) <= 1e-12 * max(math.dist(a, b) for a in corners for b in corners) ** 2:
        raise document.fault("corners", "a section without area", wanted)
    return corners if area > 0.0 else corners[::-1]
