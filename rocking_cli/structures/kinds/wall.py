"""A wall that rocks out of its plane, as a block as wide as the wall is thick; without openings and without bonded walls."""

from __future__ import annotations

import math

from ...documents.document import Document
from ..mechanics.single_body import rectangular_block
from ..parameters import RockingParameters
from ..sketch import Sketch, standing_rectangle

REPORTS = ("length",)
SIZES = ("thickness", "height")


def build(document: Document, name: str) -> RockingParameters:
    """The parameters of a wall. Keys: thickness, height, and length (only reported). Raises DocumentError."""
    details = {"length": document.length("length")} if document.has("length") else {}
    limit = "a wall thinner than 1.414 times its height"
    return rectangular_block(document, name, *_radius_and_alpha(document), limit=limit, details=details)


def _radius_and_alpha(document: Document) -> tuple[float, float]:
    thickness, height = document.length("thickness"), document.length("height")
    return 0.5 * math.hypot(thickness, height), math.atan2(thickness, height)


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """The section."""
    return standing_rectangle(*_radius_and_alpha(document))
