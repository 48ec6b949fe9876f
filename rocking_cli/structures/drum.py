"""A solid of revolution on the edge of its base circle: a cylinder, the frustum of a cone, or drums stacked.

Stacked drums rock on the interface with the least uplift acceleration, and what is above it as one body: on the base of a
tapered column, on the plinth of a statue. Drums that an earthquake has moved stand off the line of the others; what rocks
then has two sides, the edges of the overlap that it stands on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from ..documents.document import Document
from .kinematics import Moments
from .parameters import RockingParameters
from .single_body import body_on_edges, symmetric_body

REPORTS = ("rocks_on", "direction")


def frustum_moments(low: float, high: float, height: float) -> Moments:
    """Moments of a solid frustum of unit density on z = 0: radii at its base and top, and height [m].

    With q = high/low and R(z) linear, int R^2, int R^2 z, int R^2 z^2 and int R^4 are polynomials in the two radii.
    """
    a, b = low, high
    area = math.pi * height * (a * a + a * b + b * b) / 3.0
    first = math.pi * height**2 * (a * a + 2.0 * a * b + 3.0 * b * b) / 12.0
    second = math.pi * height**3 * (a * a + 3.0 * a * b + 6.0 * b * b) / 30.0
    across = math.pi * height * (a**4 + a**3 * b + a * a * b * b + a * b**3 + b**4) / 20.0  # int x^2 = int pi R^4 / 4 dz
    return Moments(area, 0.0, first, second + across)


def raised(body: Moments, by: float) -> Moments:
    """The same body, `by` higher."""
    return Moments(body.mass, body.x, body.z + by * body.mass, body.polar + by * (2.0 * body.z + by * body.mass))


def moved(body: Moments, by: float) -> Moments:
    """The same body, `by` further in x."""
    return Moments(body.mass, body.x + by * body.mass, body.z, body.polar + by * (2.0 * body.x + by * body.mass))


class Drum(NamedTuple):
    """A frustum [m]: radius at its base and top, height, and the place of its axis in x."""

    low: float
    high: float
    height: float
    axis: float


def build(document: Document, name: str) -> RockingParameters:
    """radius and height (cylinder); base_radius, top_radius and height (frustum); or drums: a list of such, from below.

    offset: towards +x, of the mass centre of a single drum from its axis, or of a drum's axis from the line of the stack.
    """
    limit = "a drum more slender than this one"
    if not document.has("drums"):
        drum = _drum(document)
        if not abs(drum.axis) < drum.low:
            raise document.fault(
                "offset", str(document.values["offset"]), f"a length between -{drum.low:g} and {drum.low:g} m, above its base"
            )
        body, top = moved(frustum_moments(drum.low, drum.high, drum.height), drum.axis), (-drum.high, drum.height)
        rock = body_on_edges if drum.axis else symmetric_body
        return rock(document, "drum", name, body, drum.low, limit=limit, top=top)
    drums = _drums(document)
    stacks = [_stack(drums[i:]) for i in range(len(drums))]
    beds = [_bed(document, drums, i) for i in range(len(drums))]
    # lambda over the nearer edge of what is above each bed
    margins = [min(right * s.mass - s.x, s.x - left * s.mass) / s.z for s, (left, right) in zip(stacks, beds, strict=True)]
    weakest = min(range(len(drums)), key=margins.__getitem__)
    if not margins[weakest] > 0.0:
        raise document.fault("drums", f"drum {weakest + 1} from below and what is on it beyond its edge", "a stack that stands")
    left, right = beds[weakest]
    middle = 0.5 * (left + right)
    top = (drums[-1].axis - drums[-1].high - middle, sum(drum.height for drum in drums[weakest:]))
    details = {"rocks_on": "its base" if weakest == 0 else f"drum {weakest} from below"} if len(drums) > 1 else {}
    body = moved(stacks[weakest], -middle)
    rock = body_on_edges if body.x else symmetric_body
    return rock(document, "drum", name, body, 0.5 * (right - left), limit=limit, top=top, details=details)


def _drums(document: Document) -> list[Drum]:
    value = document.values["drums"]
    if not isinstance(value.content, list) or not value.content:
        raise document.fault("drums", str(value), "a list of drums from below, each with radius, or base_radius and top_radius, and height")
    drums = []
    for child in value.content:
        part = document.part("drums", child)
        drums.append(_drum(part))
        part.finish()
    return drums


def _bed(document: Document, drums: Sequence[Drum], i: int) -> tuple[float, float]:
    """Left and right edge of what drum i stands on: its base, or where that overlaps the drum below."""
    drum = drums[i]
    left, right = drum.axis - drum.low, drum.axis + drum.low
    if i:
        below = drums[i - 1]
        left, right = max(left, below.axis - below.high), min(right, below.axis + below.high)
    if not right > left:
        raise document.fault("drums", f"drum {i + 1} from below beside the one that it should stand on", "drums that stand on each other")
    return left, right


def _stack(drums: Sequence[Drum]) -> Moments:
    """Moments of drums on top of each other."""
    body, top = Moments(0.0, 0.0, 0.0, 0.0), 0.0
    for low, high, height, axis in drums:
        body, top = body.plus(moved(raised(frustum_moments(low, high, height), top), axis)), top + height
    return body


def _drum(document: Document) -> Drum:
    height = document.length("height")
    offset = document.quantity("offset", "length") if document.has("offset") else 0.0
    if document.has("radius"):
        for key in ("base_radius", "top_radius"):
            if document.has(key):
                raise document.fault(key, f"{key} beside radius", "radius, or base_radius and top_radius, not both")
        radius = document.length("radius")
        return Drum(radius, radius, height, offset)
    top = document.quantity("top_radius", "length", least=0.0, where="a length from 0")
    return Drum(document.length("base_radius"), top, height, offset)
