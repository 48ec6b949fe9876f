"""The rigid rectangular block (Fig. 1 left, Eqs. 2.1-2.6)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...documents.document import Document
from ..mechanics.single_body import radius_and_alpha, rectangular_block
from ..parameters import RockingParameters

if TYPE_CHECKING:
    from ..sketch import Sketch

REPORTS = ()
SIZES = ("width", "height")


def build(document: Document, name: str) -> RockingParameters:
    """The parameters of a block. Keys: width and height, or radius (half the diagonal) and alpha. Raises DocumentError."""
    limit = "a block with alpha up to 54.7 deg (width/height up to 1.414)"
    return rectangular_block(document, name, *radius_and_alpha(document), limit=limit)


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """The rectangle."""
    from ..sketch import standing_rectangle

    return standing_rectangle(*radius_and_alpha(document))
