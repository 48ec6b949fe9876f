"""A solid of revolution on the edge of its base circle: a cylinder, the frustum of a cone, or drums stacked.

Stacked drums rock on the interface with the least uplift acceleration, and what is above it as one body: on the base of a
tapered column, on the plinth of a statue.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..documents.document import Document
from .kinematics import Moments
from .parameters import RockingParameters
from .single_body import body_on_edge

REPORTS = ("rocks_on",)


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


def build(document: Document, name: str) -> RockingParameters:
    """radius and height (cylinder); base_radius, top_radius and height (frustum); or drums: a list of such, from below."""
    if document.has("drums"):
        value = document.values["drums"]
        if not isinstance(value.content, list) or not value.content:
            raise document.fault(
                "drums", str(value), "a list of drums from below, each with radius, or base_radius and top_radius, and height"
            )
        sections = []
        for child in value.content:
            part = document.part("drums", child)
            sections.append(_section(part))
            part.finish()
    else:
        sections = [_section(document)]
    stacks = [_stack(sections[i:]) for i in range(len(sections))]
    edges = [min(low, below[1]) for (low, _, _), below in zip(sections, [(0.0, math.inf, 0.0), *sections[:-1]], strict=True)]
    weakest = min(range(len(sections)), key=lambda i: edges[i] * stacks[i].mass / stacks[i].z)  # tan alpha of what is above
    details = {"rocks_on": "its base" if weakest == 0 else f"drum {weakest} from below"} if len(sections) > 1 else {}
    limit = "a drum more slender than this one"
    return body_on_edge(document, "drum", name, stacks[weakest], edges[weakest], limit=limit, details=details)


def _stack(sections: Sequence[tuple[float, float, float]]) -> Moments:
    """Moments of sections on top of each other."""
    body, top = Moments(0.0, 0.0, 0.0, 0.0), 0.0
    for low, high, height in sections:
        body, top = body.plus(raised(frustum_moments(low, high, height), top)), top + height
    return body


def _section(document: Document) -> tuple[float, float, float]:
    """(radius at the base, radius at the top, height)."""
    height = document.length("height")
    if document.has("radius"):
        for key in ("base_radius", "top_radius"):
            if document.has(key):
                raise document.fault(key, f"{key} beside radius", "radius, or base_radius and top_radius, not both")
        radius = document.length("radius")
        return radius, radius, height
    top = document.quantity("top_radius", "length", least=0.0, where="a length from 0")
    return document.length("base_radius"), top, height
