"""The rigid rectangular block (Fig. 1 left, Eqs. 2.1-2.6)."""

from __future__ import annotations

import math

from ...documents.document import Document
from ..mechanics.single_body import radius_and_alpha, rigid_body
from ..parameters import RockingParameters
from ..sketch import Sketch, rectangle, rocker

REPORTS = ()
SIZES = ("width", "height")


def build(document: Document, name: str) -> RockingParameters:
    """width and height are full dimensions, radius half the diagonal: p^2 = 3g/(4R), eta = 1 - 3/2 sin^2 alpha.

    One-sided it meets its backing at its top: e = (1 - 3/2 sin^2 alpha)^2 (1 - 3/2 cos^2 alpha).
    """
    radius, alpha = radius_and_alpha(document, 0.5, 0.5)
    limit = "a block with alpha up to 54.7 deg (width/height up to 1.414)"
    backing = 1.0 - 1.5 * math.cos(alpha) ** 2
    return rigid_body(document, "block", name, radius=radius, alpha=alpha, inertia=4.0 / 3.0, limit=limit, backing=backing)


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """The rectangle."""
    radius, alpha = radius_and_alpha(document, 0.5, 0.5)
    half, height = radius * math.sin(alpha), 2.0 * radius * math.cos(alpha)
    return rocker([rectangle(-half, half, 0.0, height)], (-half, 0.0), (half, 0.0), (0.0, 0.5 * height))
