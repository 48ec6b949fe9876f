"""The rigid rectangular block (Fig. 1 left, Eqs. 2.1-2.6)."""

from ...documents.document import Document
from ..mechanics.single_body import RigidBody, radius_and_alpha, rectangle_body

REPORTS = ()
SIZES = ("width", "height")


def body(document: Document) -> RigidBody:
    """Return a block from width and height, or from radius (half the diagonal) and
    alpha. Raises DocumentError.
    """
    return rectangle_body(
        *radius_and_alpha(document),
        limit="a block with alpha up to 54.7 deg (width/height up to 1.414)",
    )
