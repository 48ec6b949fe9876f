"""A solid of revolution on the edge of its base circle: a cylinder, a frustum of a
cone, or a stack of drums.
"""

from ...documents.document import Document
from ..mechanics.moments import Moments
from ..mechanics.single_body import RigidBody
from ..mechanics.stacked_pieces import StackPiece, round_piece, stacked
from ..mechanics.toe import density_of

REPORTS = ("rocks_on", "interfaces", "direction")
SIZES = ("radius", "height")


def body(document: Document) -> RigidBody:
    """Return a drum or a stack of drums. Raises DocumentError. Keys: radius and height
    (cylinder); base_radius, top_radius and height (frustum); or drums: a list of these,
    from below. offset [m, towards +x]: of the mass centre of a single drum from its
    axis, or of a drum of a stack from the line of the stack. density: of all drums, for
    `strength`.
    """
    density = density_of(document)
    if document.has("drums"):
        wanted = (
            "a list of drums from below, each with radius, or base_radius and"
            " top_radius, and height"
        )
        pieces = [round_piece(part) for part in document.parts("drums", wanted)]
        return stacked(
            document,
            "drums",
            "drum",
            [_dense(piece, density) for piece in pieces],
            dense=density is not None,
        )
    drum = _dense(round_piece(document), density)
    if not abs(drum.axis) < drum.foot:
        wanted = f"a length between -{drum.foot:g} and {drum.foot:g} m, above its base"
        raise document.fault("offset", str(document.values["offset"]), wanted)
    return stacked(
        document,
        "drums",
        "drum",
        [drum._replace(axis=0.0, body=drum.body.shifted(drum.axis))],
        dense=density is not None,
    )


def _dense(piece: StackPiece, density: float | None) -> StackPiece:
    """Return the piece with this density [kg/m3], None for that of the document."""
    if density is None:
        return piece
    return piece._replace(body=Moments(*(density * moment for moment in piece.body)))
