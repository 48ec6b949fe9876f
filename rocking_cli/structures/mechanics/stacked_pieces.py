"""Stacks of pieces that are circular or rectangular in plan.

A stack rocks on the interface with the least uplift acceleration, and the pieces above it move as one body. A piece may be
offset, for example after an earthquake; the edges are then the ends of the overlap with the piece below.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import accumulate
from typing import Any, NamedTuple

from ...documents.document import Document
from ..parameters import RockingParameters
from ..shared_keys import gravity_of
from ..sketch import Outline, Sketch, rocker
from .kinematics import Moments
from .single_body import body_on_edges, edges_of, symmetric_body

NOTHING = Moments(0.0, 0.0, 0.0, 0.0)


class Piece(NamedTuple):
    """A piece of a stack: half widths of its base (foot) and top (head) [m], height [m], x of its axis [m], and its moments about
    the middle of its base."""

    foot: float
    head: float
    height: float
    axis: float
    body: Moments


def frustum_moments(low: float, high: float, height: float) -> Moments:
    """Moments of a solid frustum of a cone of unit density on z = 0; low, high: radii at its base and top [m].

    int R^2, int R^2 z, int R^2 z^2 and int R^4 over z are polynomials in the two radii.
    """
    a, b = low, high
    area = math.pi * height * (a * a + a * b + b * b) / 3.0
    first = math.pi * height**2 * (a * a + 2.0 * a * b + 3.0 * b * b) / 12.0
    second = math.pi * height**3 * (a * a + 3.0 * a * b + 6.0 * b * b) / 30.0
    across = math.pi * height * (a**4 + a**3 * b + a * a * b * b + a * b**3 + b**4) / 20.0  # int x^2 = int pi R^4 / 4 dz
    return Moments(area, 0.0, first, second + across)


def cuboid_moments(width: float, depth: float, height: float) -> Moments:
    """Moments of a cuboid of unit density on z = 0; width [m] in the direction of rocking, depth [m] across it."""
    mass = width * depth * height
    return Moments(mass, 0.0, 0.5 * mass * height, mass * (width * width / 12.0 + height * height / 3.0))


def round_piece(document: Document) -> Piece:
    """A piece from the keys radius and height, or base_radius, top_radius and height; and offset of its axis. Raises DocumentError."""
    height, offset = document.length("height"), offset_of(document)
    if document.has("radius"):
        for key in ("base_radius", "top_radius"):
            if document.has(key):
                raise document.fault(key, f"{key} beside radius", "radius, or base_radius and top_radius, not both")
        radius = document.length("radius")
        return Piece(radius, radius, height, offset, frustum_moments(radius, radius, height))
    top = document.quantity("top_radius", "length", least=0.0, where="a length from 0")
    base = document.length("base_radius")
    return Piece(base, top, height, offset, frustum_moments(base, top, height))


def offset_of(document: Document) -> float:
    """The document's offset in x [m], 0 by default."""
    return document.quantity("offset", "length", default=0.0)


class Bed(NamedTuple):
    """An interface: x of its left and right edge [m], and the moments of the pieces above it about (0, its level)."""

    left: float
    right: float
    body: Moments

    @property
    def margin(self) -> float:
        """Uplift acceleration over g on the weaker edge [-]; negative if the body falls under its own weight."""
        mass, x, z, _ = self.body
        return min(self.right * mass - x, x - self.left * mass) / z

    @property
    def half(self) -> float:
        """Half the width [m]."""
        return 0.5 * (self.right - self.left)

    @property
    def centred(self) -> Moments:
        """The moments about the middle between the edges."""
        return self.body.shifted(-0.5 * (self.left + self.right))


def beds_of(document: Document, key: str, word: str, pieces: Sequence[Piece]) -> list[Bed]:
    """Every interface from the ground upwards. Raises DocumentError if a piece does not stand on the one below it."""
    beds: list[Bed] = []
    body = NOTHING
    for i in range(len(pieces) - 1, -1, -1):
        piece = pieces[i]
        body = piece.body.shifted(x=piece.axis).plus(body.shifted(z=piece.height))
        left, right = piece.axis - piece.foot, piece.axis + piece.foot
        if i:
            below = pieces[i - 1]
            left, right = max(left, below.axis - below.head), min(right, below.axis + below.head)
        if not right > left:
            found = f"{word} {i + 1} from below beside the one that it should stand on"
            raise document.fault(key, found, f"{word}s that stand on each other")
        beds.append(Bed(left, right, body))
    return beds[::-1]


def weakest_of(beds: Sequence[Bed]) -> int:
    """The number of the interface with the least margin, the lowest if several are equal."""
    return min(range(len(beds)), key=lambda i: beds[i].margin)


def name_of(interface: int, word: str) -> str:
    """The support below an interface, in words."""
    return "its base" if interface == 0 else f"{word} {interface} from below"


def stacked(document: Document, kind: str, name: str, key: str, word: str, pieces: Sequence[Piece]) -> RockingParameters:
    """The parameters of a stack of pieces. Raises DocumentError if it does not stand."""
    beds = beds_of(document, key, word, pieces)
    weakest = weakest_of(beds)
    bed = beds[weakest]
    if not bed.margin > 0.0:
        raise document.fault(key, f"{word} {weakest + 1} from below and what is on it beyond its edge", "a stack that stands")
    last = pieces[-1]
    top = (last.axis - last.head - 0.5 * (bed.left + bed.right), sum(piece.height for piece in pieces[weakest:]))
    details: dict[str, Any] = {}
    if len(pieces) > 1:
        gravity = gravity_of(document)
        details["rocks_on"] = name_of(weakest, word)
        details["interfaces"] = [{"on": name_of(i, word), **_numbers(bed, gravity)} for i, bed in enumerate(beds)]
    rock = body_on_edges if bed.centred.x else symmetric_body
    limit = f"a {word} more slender than this one"
    return rock(document, kind, name, bed.centred, bed.half, limit=limit, top=top, details=details)


def _numbers(bed: Bed, gravity: float) -> dict[str, float | None]:
    """The parameters on the weaker edge of an interface; eta is None if the body is too squat to rock on it."""
    p, alpha, uplift, eta, _ = min(edges_of(bed.centred, bed.half, gravity).values(), key=lambda edge: edge[2])
    return {"p": p, "alpha": alpha, "eta": eta if eta >= 0.0 else None, "lambda": uplift}


def sketch_of_pieces(document: Document, key: str, word: str, pieces: Sequence[Piece]) -> Sketch:
    """The pieces above and below the weakest interface."""
    levels = list(accumulate((piece.height for piece in pieces), initial=0.0))
    outlines = [outline_of(piece, piece.axis, level) for piece, level in zip(pieces, levels, strict=False)]
    beds = beds_of(document, key, word, pieces)
    weakest = weakest_of(beds)
    bed, base = beds[weakest], levels[weakest]
    centre = (bed.body.x / bed.body.mass, base + bed.body.z / bed.body.mass)
    return rocker(outlines[weakest:], (bed.left, base), (bed.right, base), centre, still=tuple(outlines[:weakest]))


def outline_of(piece: Piece, axis: float, level: float) -> Outline:
    """The section of a piece whose axis is at x = `axis` and whose base is at z = `level` [m]."""
    foot, head, top = piece.foot, piece.head, level + piece.height
    return ((axis - foot, level), (axis + foot, level), (axis + head, top), (axis - head, top))
