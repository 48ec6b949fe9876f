"""A wall that rocks out of its plane, as a block as wide as the wall is thick; without openings and without bonded walls."""

from __future__ import annotations

import math

from ...documents.document import Document
from ..mechanics.single_body import rigid_body
from ..parameters import RockingParameters
from ..sketch import Sketch, standing_rectangle

REPORTS = ("length",)
SIZES = ("thickness", "height")


def build(document: Document, name: str) -> RockingParameters:
    """The parameters of a wall. Raises DocumentError.

    Keys: thickness, height, and length (only reported). A one-sided wall hits its backing at its top, as a block does:
    e = (1 - 3/2 sin^2 alpha)^2 (1 - 3/2 cos^2 alpha).
    """
    thickness, height = document.length("thickness"), document.length("height")
    radius, alpha = 0.5 * math.hypot(thickness, height), math.atan2(thickness, height)
    details = {"length": document.length("length")} if document.has("length") else {}
    return rigid_body(
        document, "wall", name, radius=radius, alpha=alpha, inertia=4.0 / 3.0, limit="a wall thinner than 1.414 times its height",
        backing=1.0 - 1.5 * math.cos(alpha) ** 2, details=details,
    )  # fmt: skip


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """The section."""
    return standing_rectangle(0.5 * document.length("thickness"), document.length("height"))
