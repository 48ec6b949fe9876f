"""The rigid rectangular block (Fig. 1 left, Eqs. 2.1-2.6)."""

from __future__ import annotations

import math

from ...documents.document import Document
from ..mechanics.single_body import radius_and_alpha, rigid_body
from ..parameters import RockingParameters
from ..sketch import Sketch, standing_rectangle

REPORTS = ()
SIZES = ("width", "height")


def build(document: Document, name: str) -> RockingParameters:
    """The parameters of a block: p^2 = 3g/(4R), eta = 1 - 3/2 sin^2 alpha. Raises DocumentError.

    Keys: width and height (full dimensions), or radius (half the diagonal) and alpha. A one-sided block hits its backing at its
    top: e = (1 - 3/2 sin^2 alpha)^2 (1 - 3/2 cos^2 alpha).
    """
    radius, alpha = radius_and_alpha(document, 0.5, 0.5)
    limit = "a block with alpha up to 54.7 deg (width/height up to 1.414)"
    backing = 1.0 - 1.5 * math.cos(alpha) ** 2
    return rigid_body(document, "block", name, radius=radius, alpha=alpha, inertia=4.0 / 3.0, limit=limit, backing=backing)


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """The rectangle."""
    radius, alpha = radius_and_alpha(document, 0.5, 0.5)
    return standing_rectangle(radius * math.sin(alpha), 2.0 * radius * math.cos(alpha))
