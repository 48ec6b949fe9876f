"""A stack of round and rectangular pieces, such as a statue on its plinth, drums under
a capital, or a finial on a gable.
"""

from ...documents.document import Document
from ...documents.keys import Key, Keys, length
from ..mechanics.moments import Moments
from ..mechanics.single_body import RigidBody
from ..mechanics.stacked_pieces import (
    OFFSET,
    ROCKS_ON,
    ROUND,
    StackPiece,
    round_piece,
    stacked,
)
from ..shared_keys import DENSITY

REPORTS = ("rocks_on", "interfaces", "direction")
_PIECE = Keys(
    {},
    {**OFFSET, "density": DENSITY},
    ((Keys({"width": length(), "height": length()}, {"depth": length()}), *ROUND),),
)
KEYS = Keys({"pieces": Key("parts", "from below", inner=_PIECE)}, ROCKS_ON)


def body(document: Document) -> RigidBody:
    """Return a stack from the key `pieces`, a list from below. Raises DocumentError.
    Keys of a piece: height; width (in the direction of rocking) and depth (default: the
    width), or radius, or base_radius and top_radius; offset of its axis towards +x;
    density, for all pieces or for none.
    """
    parts = document.parts("pieces")
    pieces = [_piece(part) for part in parts]
    dense = [part for part in parts if part.has("density")]
    if dense and len(dense) < len(parts):
        raise dense[0].fault(
            "density",
            "a density of some pieces only",
            "density for every piece, or for none",
        )
    return stacked(document, "piece", pieces)


def _piece(part: Document) -> StackPiece:
    """Return a piece, rectangular or round, with its density (1 by default)."""
    read = _cuboid if part.has("width") or part.has("depth") else round_piece
    return read(part).of_density(part.optional("density"))


def _cuboid(part: Document) -> StackPiece:
    """Return a rectangular piece of unit density; its depth is its width by default."""
    width, height = part.length("width"), part.length("height")
    depth = part.optional("depth") or width
    mass = width * depth * height
    moments = Moments.of(
        mass, (0.0, 0.5 * height), mass * (width**2 + height**2) / 12.0
    )
    return StackPiece(
        0.5 * width, 0.5 * width, height, part.quantity("offset"), moments, depth
    )
