"""A solid of revolution on the edge of its base circle: a cylinder, the frustum of a cone, or drums stacked (`pieces`)."""

from __future__ import annotations

from ...documents.document import Document
from ..mechanics.single_body import body_on_edges, symmetric_body
from ..mechanics.stacked_pieces import moved, outline_of, round_piece, sketch_of_pieces, stacked
from ..parameters import RockingParameters
from ..sketch import Sketch, rocker

REPORTS = ("rocks_on", "interfaces", "direction")
SIZES = ("radius", "height")


def build(document: Document, name: str) -> RockingParameters:
    """radius and height (cylinder); base_radius, top_radius and height (frustum); or drums: a list of such, from below.

    offset: towards +x, of the mass centre of a single drum from its axis, or of a drum's axis from the line of the stack.
    """
    if document.has("drums"):
        wanted = "a list of drums from below, each with radius, or base_radius and top_radius, and height"
        drums = [round_piece(part) for part in document.parts("drums", wanted)]
        return stacked(document, "drum", name, "drums", "drum", drums)
    drum = round_piece(document)
    if not abs(drum.axis) < drum.foot:
        raise document.fault(
            "offset", str(document.values["offset"]), f"a length between -{drum.foot:g} and {drum.foot:g} m, above its base"
        )
    body, top = moved(drum.body, drum.axis), (-drum.head, drum.height)
    rock = body_on_edges if drum.axis else symmetric_body
    return rock(document, "drum", name, body, drum.foot, limit="a drum more slender than this one", top=top)


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """The drum in section, or the drums."""
    if document.has("drums"):
        return sketch_of_pieces(document, "drums", "drum", [round_piece(part) for part in document.parts("drums", "")])
    drum = round_piece(document)
    centre = (drum.axis, drum.body.z / drum.body.mass)
    return rocker([outline_of(drum, 0.0, 0.0)], (-drum.foot, 0.0), (drum.foot, 0.0), centre)
