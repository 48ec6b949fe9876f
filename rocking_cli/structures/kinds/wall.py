"""A wall that rocks out of its plane, as a block as wide as the wall is thick; without
openings and without bonded walls.
"""

import math

from ...documents.document import Document
from ..mechanics.single_body import RigidBody, rectangle_body
from ..mechanics.toe import strip_foot

REPORTS = ("length",)
SIZES = ("thickness", "height")


def body(document: Document) -> RigidBody:
    """Return a wall from thickness, height, and length; density and length give its
    mass. Raises DocumentError.
    """
    thickness, height = document.length("thickness"), document.length("height")
    details = {"length": document.length("length")} if document.has("length") else {}
    foot, mass = strip_foot(document, thickness, thickness * height)
    details |= mass
    limit = "a wall thinner than 1.414 times its height"
    return rectangle_body(
        0.5 * math.hypot(thickness, height),
        math.atan2(thickness, height),
        limit=limit,
        details=details,
        foot=foot,
    )
