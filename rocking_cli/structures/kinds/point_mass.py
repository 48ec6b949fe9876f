"""A point mass on rigid struts (Fig. 1 right): p^2 = g/R1, eta = 1 - 2 sin^2 alpha."""

from __future__ import annotations

import math

from ...documents.document import Document
from ..mechanics.single_body import radius_and_alpha, rigid_body
from ..parameters import RockingParameters
from ..sketch import Sketch, circle, rocker

REPORTS = ()
SIZES = ("width", "height")


def build(document: Document, name: str) -> RockingParameters:
    """The parameters of a point mass. Raises DocumentError.

    Keys: width: distance of the two supports; height: of the mass above them; or radius (length of a strut) and alpha.
    """
    radius, alpha = radius_and_alpha(document, 0.5, 1.0)
    return rigid_body(document, "point_mass", name, radius=radius, alpha=alpha, inertia=1.0, limit="a point mass with alpha up to 45 deg")


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """Two struts and the mass."""
    radius, alpha = radius_and_alpha(document, 0.5, 1.0)
    half, height = radius * math.sin(alpha), radius * math.cos(alpha)
    feet, mass = ((-half, 0.0), (half, 0.0)), (0.0, height)
    return rocker([(feet[0], mass), (feet[1], mass), circle(mass, 0.05 * radius)], *feet, mass)
