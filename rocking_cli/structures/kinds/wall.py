"""A wall that rocks out of its plane, as a block whose width is its thickness; openings are ignored, as is what it is bonded to."""

from __future__ import annotations

import math

from ...documents.document import Document
from ..mechanics.single_body import rigid_body
from ..parameters import RockingParameters
from ..sketch import Sketch, rectangle, rocker

REPORTS = ("length",)
SIZES = ("thickness", "height")


def build(document: Document, name: str) -> RockingParameters:
    """thickness and height; length, which changes nothing but is reported; one_sided: true where it stands against others.

    One-sided it meets them at its top, as the block does: e = (1 - 3/2 sin^2 alpha)^2 (1 - 3/2 cos^2 alpha).
    """
    thickness, height = document.length("thickness"), document.length("height")
    radius, alpha = 0.5 * math.hypot(thickness, height), math.atan2(thickness, height)
    details = {"length": document.length("length")} if document.has("length") else {}
    return rigid_body(
        document, "wall", name, radius=radius, alpha=alpha, inertia=4.0 / 3.0, limit="a wall thinner than 1.414 times its height",
        backing=1.0 - 1.5 * math.cos(alpha) ** 2, details=details,
    )  # fmt: skip


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """Its section."""
    half, height = 0.5 * document.length("thickness"), document.length("height")
    return rocker([rectangle(-half, half, 0.0, height)], (-half, 0.0), (half, 0.0), (0.0, 0.5 * height))
