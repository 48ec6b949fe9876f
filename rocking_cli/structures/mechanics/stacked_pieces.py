"""Stacks of pieces that are circular or rectangular in plan.

A stack rocks on the interface with the least uplift acceleration, and the pieces above
it move as one body. A piece may be offset, for example after an earthquake; the edges
are then the ends of the overlap with the piece below.
"""

import math
from collections.abc import Sequence
from functools import partial
from itertools import accumulate
from typing import Any, NamedTuple, Self

from ...documents.document import Document
from ...documents.keys import Key, Keys, length
from ..shared_keys import gravity_of, has_loads, mass_of, restraints_in
from ..sketch import Outline, Point, Sketch, rocker
from .moments import Moments, edges_of
from .single_body import RigidBody
from .toe import Foot, RingBase, Strip, toe_of


class StackPiece(NamedTuple):
    """A piece of a stack."""

    foot: float  # half width of its base [m]
    head: float  # half width of its top [m]
    height: float  # [m]
    axis: float  # x of its axis [m]
    body: Moments  # its moments about the middle of its base
    depth: float | None = None  # across the rocking [m], None for a round piece
    dense: bool = False  # True if its moments have its density, False for 1

    def of_density(self, density: float | None) -> Self:
        """Return the piece of unit density with this one [kg/m3]; itself for None."""
        if density is None:
            return self
        return self._replace(body=self.body.times(density), dense=True)


def frustum_moments(low: float, high: float, height: float) -> Moments:
    """Return the moments of a solid frustum of a cone of unit density on z = 0; low,
    high: radii at its base and top [m]. The integrals over z of R^2, R^2 z, R^2 z^2 and
    R^4 are polynomials in the two radii.
    """
    a, b = low, high
    area = math.pi * height * (a * a + a * b + b * b) / 3.0
    first = math.pi * height**2 * (a * a + 2.0 * a * b + 3.0 * b * b) / 12.0
    second = math.pi * height**3 * (a * a + 3.0 * a * b + 6.0 * b * b) / 30.0
    # int x^2 = int pi R^4 / 4 dz
    across = (
        math.pi * height * (a**4 + a**3 * b + a * a * b * b + a * b**3 + b**4) / 20.0
    )
    return Moments(area, 0.0, first, second + across)


# ways to state a round piece
ROUND = (
    Keys({"radius": length(), "height": length()}),
    Keys(
        {
            "base_radius": length(),
            "top_radius": Key("length", least=0.0),
            "height": length(),
        }
    ),
)
OFFSET = {"offset": Key("length", "of its axis towards +x", default=0.0)}
ROCKS_ON = {
    "rocks_on": Key(
        "whole", "its interface, 0 for the base; absent: the weakest", least=0
    )
}


def round_piece(document: Document) -> StackPiece:
    """A piece from the keys radius and height, or base_radius, top_radius and height;
    and offset of its axis. Raises DocumentError.
    """
    height, offset = document.length("height"), document.quantity("offset")
    if document.has("radius"):
        base = top = document.length("radius")
    else:
        top, base = document.quantity("top_radius"), document.length("base_radius")
    return StackPiece(base, top, height, offset, frustum_moments(base, top, height))


class Interface(NamedTuple):
    """The plane on which a piece stands, with the pieces above it."""

    left: float  # x of its left edge [m]
    right: float  # x of its right edge [m]
    body: Moments  # moments of the pieces above it about (0, its level)

    @property
    def margin(self) -> float:
        """Uplift acceleration over g on the weaker edge [-]; negative if the body falls
        under its own weight.
        """
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

    def numbers(self, gravity: float) -> dict[str, float | None]:
        """Return the parameters on the weaker edge; eta is None if the body is too
        squat to rock on it.
        """
        edge = min(
            edges_of(self.centred, self.half, gravity), key=lambda edge: edge.uplift
        )
        return {
            "p": edge.p,
            "alpha": edge.alpha,
            "eta": edge.eta if edge.eta >= 0.0 else None,
            "lambda": edge.uplift,
        }


def stacked(
    document: Document, word: str, pieces: Sequence[StackPiece], inset: float = 0.0
) -> RigidBody:
    """Return the body that rocks on the interface of the key `rocks_on`, by default on
    the one with the least margin, on the lowest one of equal margins. pieces: from
    below; word: for one of them, and with an s the key of their list; inset: from the
    edges of every interface [m], of a body with `strength` that of its toe there.
    Raises DocumentError if a piece does not stand on the one below it, or the stack
    does not stand, or if it has restraints and no `rocks_on`: they hold each interface
    in another way, so that the least margin does not tell which one overturns first.
    """
    whole = _interfaces(document, word, pieces)
    supports = ["its base", *(f"{word} {i} from below" for i in range(1, len(whole)))]
    feet = [_foot(document, pieces, i, one) for i, one in enumerate(whole)]
    insets = [inset] * len(feet)
    if document.has("strength"):
        pairs = zip(feet, supports, strict=True)
        insets = [toe_of(document, foot, name).inset for foot, name in pairs]
    interfaces = [
        _moved_in(document, word, i, one, inwards)
        for i, (one, inwards) in enumerate(zip(whole, insets, strict=True))
    ]
    lowest = _weakest_standing(document, word, interfaces, inset)
    details: dict[str, Any] = {}
    if len(pieces) > 1:
        lowest = _lowest_rocking(document, word, interfaces, lowest)
        gravity, rows = gravity_of(document), zip(supports, interfaces, strict=True)
        details = {
            "rocks_on": supports[lowest],
            "interfaces": [{"on": on, **one.numbers(gravity)} for on, one in rows],
        }
    if pieces[0].dense and document.has("strength"):
        details["mass"] = whole[lowest].body.mass
    # Without an inset the body is the geometry itself.
    interface, inwards = (
        (interfaces[lowest], insets[lowest]) if inset else (whole[lowest], 0.0)
    )
    only = pieces[0]
    return RigidBody(
        moments=interface.centred,
        half=interface.half,
        top=_top_corner(pieces, lowest, interface),
        limit=f"a {word} more slender than this one",
        details=details,
        drawing=_drawing(pieces, lowest, interface, inwards),
        moved=partial(stacked, document, word, pieces),
        foot=feet[lowest],
        shaft=only.height if len(pieces) == 1 and only.foot == only.head else None,
    )


def _foot(
    document: Document,
    pieces: Sequence[StackPiece],
    i: int,
    interface: Interface,
) -> Foot | str:
    """Return the foot on an interface: the smaller one of its two faces; a text where
    it is not known.
    """
    faces = [(pieces[i].foot, pieces[i].depth)]
    faces += [(pieces[i - 1].head, pieces[i - 1].depth)] if i else []
    offset = i > 0 and pieces[i].axis != pieces[i - 1].axis
    depths = [depth for _, depth in faces if depth is not None]
    radii = [half for half, depth in faces if depth is None]
    area: Strip | RingBase = Strip(2.0 * interface.half, min(depths, default=1.0))
    if radii and offset:
        return "a stack with a round piece that is offset from the one below it"
    if radii and not depths:
        area = RingBase(min(radii))
    elif radii:
        half = next(half for half, depth in faces if depth is not None)
        if radii[0] <= min(half, 0.5 * depths[0]):
            area = RingBase(radii[0])
        elif radii[0] < math.hypot(half, 0.5 * depths[0]):
            return (
                "a stack of round and rectangular pieces that cover each other partly"
            )
    if pieces[0].dense:
        return Foot(area, interface.body.mass)
    return Foot(area, mass_of(document) if len(pieces) == 1 else None)


def _moved_in(
    document: Document, word: str, i: int, interface: Interface, inwards: float
) -> Interface:
    """Return the interface with its pivots inside its edges by a length [m]. Raises
    DocumentError.
    """
    left, right = interface.left + inwards, interface.right - inwards
    if not right > left:
        raise document.fault(
            "inset",
            f"an inset beyond half the base of {word} {i + 1} from below",
            "a shorter one",
        )
    return interface._replace(left=left, right=right)


def _interfaces(
    document: Document, word: str, pieces: Sequence[StackPiece]
) -> list[Interface]:
    """Return the interfaces from below. Raises DocumentError if a piece does not stand
    on the one below it.
    """
    above = Moments(0.0, 0.0, 0.0, 0.0)  # of the pieces above the interface
    found: list[Interface] = []
    for i in range(len(pieces) - 1, -1, -1):
        piece = pieces[i]
        above = piece.body.shifted(x=piece.axis).plus(above.shifted(z=piece.height))
        left, right = _overlap(pieces, i)
        if not right > left:
            raise document.fault(
                f"{word}s",
                f"{word} {i + 1} from below apart from the one below it",
                f"{word}s that stand on each other",
            )
        found.insert(0, Interface(left, right, above))
    return found


def _overlap(pieces: Sequence[StackPiece], i: int) -> tuple[float, float]:
    """Return the ends in x [m] of the contact of a piece with the one below it."""
    piece = pieces[i]
    left, right = piece.axis - piece.foot, piece.axis + piece.foot
    if i == 0:  # it stands on the ground
        return left, right
    below = pieces[i - 1]
    return max(left, below.axis - below.head), min(right, below.axis + below.head)


def _weakest_standing(
    document: Document, word: str, interfaces: Sequence[Interface], inset: float
) -> int:
    """Return the index of the interface with the least margin. Raises DocumentError if
    the pieces above it fall under their own weight.
    """
    weakest = min(range(len(interfaces)), key=lambda i: interfaces[i].margin)
    if not interfaces[weakest].margin > 0.0:
        found = (
            f"{word} {weakest + 1} from below, with the pieces on it, beyond its edge"
        )
        moved = (
            "strength" if document.has("strength") else "inset" if inset else f"{word}s"
        )
        raise document.fault(moved, found, "a stack that stands")
    return weakest


def _lowest_rocking(
    document: Document, word: str, interfaces: Sequence[Interface], weakest: int
) -> int:
    """Return the index of the lowest piece that rocks, from the key `rocks_on` or, by
    default, `weakest`. Raises DocumentError.
    """
    if document.has("rocks_on"):
        return document.integer("rocks_on", most=len(interfaces) - 1)
    if held := restraints_in(document) or ["loads"] * has_loads(document):
        raise document.missing(
            "rocks_on",
            f"0 for its base, or the number from below of the {word} on which it"
            f" rocks: {held[0]} hold each interface differently, so check each one",
        )
    return weakest


def _top_corner(
    pieces: Sequence[StackPiece], lowest: int, interface: Interface
) -> Point:
    """Return (x, z) [m] of the left corner of the top, from the middle between the
    edges; a backing stands on the left.
    """
    last = pieces[-1]
    return (
        last.axis - last.head - 0.5 * (interface.left + interface.right),
        sum(piece.height for piece in pieces[lowest:]),
    )


def _drawing(
    pieces: Sequence[StackPiece], lowest: int, interface: Interface, inset: float
) -> Sketch:
    """Return the stack on the ground; the pieces below `lowest` stay."""
    levels = list(accumulate((piece.height for piece in pieces), initial=0.0))
    outlines = [
        _outline(piece, low, high)
        for piece, low, high in zip(pieces, levels, levels[1:], strict=False)
    ]
    base, (x, z) = levels[lowest], interface.body.centre
    return rocker(
        outlines[lowest:],
        (interface.left - inset, base),
        (interface.right + inset, base),
        (x, base + z),
        inset=inset,
        still=tuple(outlines[:lowest]),
    )


def _outline(piece: StackPiece, low: float, high: float) -> Outline:
    """Return the section of a piece between two levels [m]."""
    return (
        (piece.axis - piece.foot, low),
        (piece.axis + piece.foot, low),
        (piece.axis + piece.head, high),
        (piece.axis - piece.head, high),
    )
