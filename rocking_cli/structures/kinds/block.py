"""The rigid rectangular block (Fig. 1 left, Eqs. 2.1-2.6)."""

import math

from ...documents.document import Document
from ...documents.keys import Keys, length
from ..mechanics.single_body import (
    RigidBody,
    radius_and_alpha,
    rectangle_body,
    sizes,
)
from ..mechanics.toe import strip_foot
from ..shared_keys import DENSITY

REPORTS = ()
SIZES = ("width", "height")
KEYS = Keys(
    optional={
        "density": DENSITY,
        "depth": length("across the rocking, with a density"),
    },
    ways=(sizes("full width at the base", "full height", "half the diagonal"),),
)


def body(document: Document) -> RigidBody:
    """Return a block from width and height, or from radius (half the diagonal) and
    alpha; density and depth (across the rocking) give its mass. Raises DocumentError.
    """
    radius, alpha = radius_and_alpha(document)
    width, height = 2.0 * radius * math.sin(alpha), 2.0 * radius * math.cos(alpha)
    foot, details = strip_foot(document, width, width * height, "depth")
    return rectangle_body(
        radius,
        alpha,
        limit="a block with alpha up to 54.7 deg (width/height up to 1.414)",
        foot=foot,
        details=details,
    )
