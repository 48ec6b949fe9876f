"""A point mass on rigid struts (Fig. 1 right): p^2 = g/R1, eta = 1 - 2 sin^2 alpha."""

import math

from ...documents.document import Document
from ...documents.keys import Keys
from ..mechanics.moments import Moments
from ..mechanics.single_body import RigidBody, half_and_height, sizes
from ..sketch import circle, rocker

REPORTS = ()
SIZES = ("width", "height")
KEYS = Keys(
    ways=(
        sizes(
            "distance of the two supports",
            "of the mass above them",
            "length of a strut",
        ),
    )
)


def body(document: Document) -> RigidBody:
    """Return a mass on two struts from width (distance of the supports) and height, or
    from radius (length of a strut) and alpha. Raises DocumentError.
    """
    half, height = half_and_height(document, 1.0)
    mass = (0.0, height)
    feet = (-half, 0.0), (half, 0.0)
    drawing = rocker(
        [
            (feet[0], mass),
            (feet[1], mass),
            circle(mass, 0.05 * math.hypot(half, height)),
        ],
        *feet,
        mass,
    )
    return RigidBody(
        moments=Moments.of(1.0, mass, 0.0),
        half=half,
        limit="a point mass with alpha up to 45 deg",
        foot="a point mass, whose struts have no contact area",
        drawing=drawing,
    )
