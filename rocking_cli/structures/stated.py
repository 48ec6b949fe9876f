"""Rocking parameters stated directly: what `rocking params --json` prints, whatever kind it came from."""

from __future__ import annotations

import math
from typing import Any

from ..documents.document import Document
from .parameters import DIMENSIONLESS, RockingParameters, Side, weaker_side
from .shared_keys import ONE_SIDED_RESTITUTION, gravity_of, one_sided_of

REPORTS = ()


def build(document: Document, name: str) -> RockingParameters:
    """The parameters as a document of kind `parameters` states them; lambda and a_scale give each other (Eq. 3.9)."""
    from .kinds import reports_of

    structure = document.word("structure_kind", "parameters")
    if structure == DIMENSIONLESS:
        raise document.fault("structure_kind", structure, "the kind of a structure, which has units")
    reported = (*reports_of(structure), "varied")
    more: dict[str, Any] = {
        "eta_source": document.word("eta_source", "given"),
        "gravity": gravity_of(document),
        "details": {key: document.values[key].plain() for key in document.values if key in reported and document.has(key)},
    }
    one_sided = one_sided_of(document)
    if not document.has("sides"):
        return RockingParameters(name, structure, **_numbers(document, one_sided), one_sided=one_sided, **more)
    if one_sided:
        raise document.fault("one_sided", "a one-sided body of two sides", "sides, or one_sided: true, not both")
    left, right = _sides(document)
    weaker = weaker_side((left, right))
    for key, number in weaker.numbers().items():
        dimension = {"p": "frequency parameter", "alpha": "angle"}.get(key, "number")
        if document.has(key) and document.quantity(key, dimension) != number:
            raise document.fault(key, str(document.values[key]), f"{number!r} as in sides, where the {weaker.side} edge lifts first")
    return RockingParameters.of_sides(name, structure, left, right, **more)


def _numbers(document: Document, one_sided: bool = False) -> dict[str, Any]:
    p = document.quantity("p", "frequency parameter", above=0.0, where="a positive number")
    alpha = document.quantity("alpha", "angle", above=0.0, below=math.pi, where="an angle between 0 and 180 deg")
    if one_sided:
        eta = document.quantity("eta", "number", above=-1.0, most=0.0, where=ONE_SIDED_RESTITUTION)
    else:
        eta = document.quantity("eta", "number", least=0.0, most=1.0, where="a number from 0 to 1")
    given = {
        key: document.quantity(key, "number", above=0.0, where="a positive number") for key in ("lambda", "a_scale") if document.has(key)
    }
    if not given:
        raise document.fault(None, "neither lambda nor a_scale", "one of them, or both")
    return {
        "p": p,
        "alpha": alpha,
        "eta": eta,
        "uplift": given.get("lambda", alpha / given.get("a_scale", 1.0)),
        "a_scale": given.get("a_scale", alpha / given.get("lambda", 1.0)),
    }


def _sides(document: Document) -> tuple[Side, Side]:
    wanted = "a list of two, one with side: left and one with side: right, each with p, alpha, eta, and lambda or a_scale"
    value = document.values["sides"]
    if not isinstance(value.content, list) or len(value.content) != 2:
        raise document.fault("sides", str(value), wanted)
    found: dict[str, Side] = {}
    for child in value.content:
        part = document.part("sides", child)
        side = part.choice("side", ["left", "right"])
        found[side] = Side(side, **_numbers(part))
        part.finish()
    if len(found) < 2:
        raise document.fault("sides", f"the {next(iter(found))} side twice", wanted)
    return found["left"], found["right"]
