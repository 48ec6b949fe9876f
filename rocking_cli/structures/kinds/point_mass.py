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
    return rigid_body(document, name, *radius_and_alpha(document, 1.0), 1.0, limit="a point mass with alpha up to 45 deg")


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """Two struts and the mass."""
    radius, alpha = radius_and_alpha(document, 1.0)
    half, mass = radius * math.sin(alpha), (0.0, radius * math.cos(alpha))
    feet = (-half, 0.0), (half, 0.0)
    return rocker([(feet[0], mass), (feet[1], mass), circle(mass, 0.05 * radius)], *feet, mass)
