"""A solid of revolution on the edge of its base circle: a cylinder, a frustum of a cone, or a stack of drums."""

from __future__ import annotations

from ...documents.document import Document
from ..mechanics.single_body import body_on_edges, symmetric_body
from ..mechanics.stacked_pieces import outline_of, round_piece, sketch_of_pieces, stacked
from ..parameters import RockingParameters
from ..sketch import Sketch, rocker

REPORTS = ("rocks_on", "interfaces", "direction")
SIZES = ("radius", "height")


def build(document: Document, name: str) -> RockingParameters:
    """The parameters of a drum or a stack of drums. Raises DocumentError.

    Keys: radius and height (cylinder); base_radius, top_radius and height (frustum); or drums: a list of these, from below.
    offset [m, towards +x]: of the mass centre of a single drum from its axis, or of a drum of a stack from the line of the stack.
    """
    if document.has("drums"):
        wanted = "a list of drums from below, each with radius, or base_radius and top_radius, and height"
        drums = [round_piece(part) for part in document.parts("drums", wanted)]
        return stacked(document, "drum", name, "drums", "drum", drums)
    drum = round_piece(document)
    if not abs(drum.axis) < drum.foot:
        wanted = f"a length between -{drum.foot:g} and {drum.foot:g} m, above its base"
        raise document.fault("offset", str(document.values["offset"]), wanted)
    body, top = drum.body.shifted(drum.axis), (-drum.head, drum.height)
    rock = body_on_edges if drum.axis else symmetric_body
    return rock(document, "drum", name, body, drum.foot, limit="a drum more slender than this one", top=top)


def sketch(document: Document, _: RockingParameters) -> Sketch:
    """The section of the drum or drums."""
    if document.has("drums"):
        return sketch_of_pieces(document, "drums", "drum", [round_piece(part) for part in document.parts("drums", "")])
    drum = round_piece(document)
    centre = (drum.axis, drum.body.z / drum.body.mass)
    return rocker([outline_of(drum, 0.0, 0.0)], (-drum.foot, 0.0), (drum.foot, 0.0), centre)
