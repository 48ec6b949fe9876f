"""The rigid rectangular block (Fig. 1 left, Eqs. 2.1-2.6)."""

from ...documents.document import Document
from ...documents.keys import Keys, length
from ..mechanics.single_body import (
    RigidBody,
    half_and_height,
    rectangle_body,
    sizes,
)
from ..mechanics.toe import foot_of
from ..shared_keys import DENSITY

REPORTS = ()
SIZES = ("width", "height")
KEYS = Keys(
    optional={
        "density": DENSITY,
        "depth": length("across the rocking, with a density", None),
    },
    ways=(sizes("full width at the base", "full height", "half the diagonal"),),
)


def body(document: Document) -> RigidBody:
    """Return a block from width and height, or from radius (half the diagonal) and
    alpha; density and depth (across the rocking) give its mass. Raises DocumentError.
    """
    width, height = (2.0 * x for x in half_and_height(document))
    foot, details = foot_of(document, width, width * height, "depth")
    return rectangle_body(
        width,
        height,
        limit="a block with alpha up to 54.7 deg (width/height up to 1.414)",
        foot=foot,
        details=details,
    )
