"""A solid of revolution on the edge of its base circle: a cylinder, a frustum of a
cone, or a stack of drums.
"""

from ...documents.document import Document
from ...documents.keys import Key, Keys
from ..mechanics.single_body import RigidBody
from ..mechanics.stacked_pieces import (
    OFFSET,
    ROCKS_ON,
    ROUND,
    StackPiece,
    round_piece,
    stacked,
)
from ..mechanics.toe import density_of
from ..shared_keys import DENSITY

REPORTS = ("rocks_on", "interfaces", "direction")
SIZES = ("radius", "height")
_DRUMS = {"drums": Key("parts", "from below", inner=Keys({}, OFFSET, (ROUND,)))}
KEYS = Keys(
    optional={**OFFSET, "density": DENSITY, **ROCKS_ON},
    ways=((*ROUND, Keys(_DRUMS)),),
)


def body(document: Document) -> RigidBody:
    """Return a drum or a stack of drums. Raises DocumentError. Keys: radius and height
    (cylinder); base_radius, top_radius and height (frustum); or drums: a list of these,
    from below. offset [m, towards +x]: of the mass centre of a single drum from its
    axis, or of a drum of a stack from the line of the stack. density: of all drums, for
    `strength`.
    """
    alone, density = not document.has("drums"), density_of(document)
    pieces = [
        round_piece(part).of_density(density)
        for part in ([document] if alone else document.parts("drums"))
    ]
    return stacked(document, "drum", [_centred(document, *pieces)] if alone else pieces)


def _centred(document: Document, drum: StackPiece) -> StackPiece:
    """Return a drum whose mass centre may be beside its axis. Raises DocumentError."""
    if not abs(drum.axis) < drum.foot:
        wanted = f"a length between -{drum.foot:g} and {drum.foot:g} m, above its base"
        raise document.fault("offset", str(document.values["offset"]), wanted)
    return drum._replace(axis=0.0, body=drum.body.shifted(drum.axis))
