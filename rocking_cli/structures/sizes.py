"""Remarks on lengths without a unit that make a body too high to be meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import RockingError
from .kinds import KINDS, sketch_of

if TYPE_CHECKING:
    from ..documents.document import Document
    from .parameters import RockingParameters

TALL = 30.0  # m; few towers and spires of masonry are higher
_MILLIMETRES = 1000.0  # m; a body that is higher than this was probably stated in mm


def size_remarks(document: Document, built: RockingParameters) -> tuple[str, ...]:
    """Return a remark with file, line and key if lengths without a unit make the body
    of a document higher than 30 m.
    """
    if 2.0 * sum(abs(number) for number, _ in document.bare.values()) <= TALL:
        return ()
    if (height := _height_of(document, built)) <= TALL:
        return ()
    key = max(document.bare, key=lambda path: document.bare[path][0])
    number, place = document.bare[key]
    guess = "mm" if height > _MILLIMETRES else "cm"
    name = key.partition(".")[0] if key.startswith("corners") else key
    found = (
        f"{name}: {number:g} without a unit is {number:g} m, and the body is"
        f" {height:.4g} m high"
    )
    return (f"{place}: {found}; did you mean {number:g} {guess}?",)


def _height_of(document: Document, built: RockingParameters) -> float:
    """Return the height of the body [m], 0 for a kind without a geometry, or one of an
    installed package.
    """
    if document.values["kind"].content not in KINDS:
        return 0.0
    try:
        drawn = sketch_of(document, built)
    except RockingError:
        return 0.0
    levels = [z for outline in (*drawn.bodies, *drawn.still) for _, z in outline]
    return max(levels, default=0.0) - min(levels, default=0.0)
