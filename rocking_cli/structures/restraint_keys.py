"""The keys `ties`, `tendon` and `dampers` of a document."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from .parameters import MOST_DAMPING, RockingParameters
from .restraints import SIDES, Restraints, Stand, Tendon, Tie
from .shared_keys import damping_of, mass_of, restraints_in

if TYPE_CHECKING:
    from ..documents.document import Document

_STIFFEST = 1e9  # m g R, of the restraints after uplift


def restrained(
    document: Document,
    body: RockingParameters,
    *,
    crown: float = math.inf,
    level: float = 0.0,
    inset: float = 0.0,
    width: float = math.inf,
    radius: float | None = None,
    share: float = 1.0,
) -> RockingParameters:
    """Return the body with the ties, the tendon and the dampers of its document, and
    their statics in its details. Raises DocumentError. crown, width: of the body [m];
    level, inset: of its pivots [m]; radius: R of a body without an arm [m]; share: m g
    R over mass g R.
    """
    mass, given = mass_of(document) or body.details.get("mass"), restraints_in(document)
    if mass is None:
        raise document.missing("mass", f"the mass [kg], which {given[0]} need")
    stands = _stands(document, body, mass, radius, share)
    _require_alike(document, body)
    if "dampers" in given:
        levers = (width - inset) ** 2 + inset**2
        zeta = _damping(document, body.p, stands[0].moment, levers)
        body = replace(body, damping=zeta)
    held = Restraints(
        _ties(document, crown, level, inset, width) if "ties" in given else (),
        _tendon(document) if "tendon" in given else None,
        tuple(stands),
    )
    if not (held.ties or held.tendon):
        return body
    rows = _statics(document, held, stands[1:] if body.one_sided else stands)
    return replace(body, restraints=held, details={**body.details, "restrained": rows})


def _stands(
    document: Document,
    body: RockingParameters,
    mass: float,
    radius: float | None,
    share: float,
) -> list[Stand]:
    """Return the body on each of its edges; the other arguments as of `restrained`.
    Raises DocumentError if the arm R is not known.
    """
    both = body.left_and_right
    found = []
    for name, side in zip(SIDES["both"], both, strict=True):
        if (arm := side.arm or radius) is None:
            first = restraints_in(document)[0]
            raise document.fault(
                first, f"{first} of a body whose arm is not known", "arm as well"
            )
        moment = mass * body.gravity * arm * share
        found.append(Stand(name, side.alpha, moment, arm * math.sin(side.alpha)))
    return found


def _require_alike(document: Document, body: RockingParameters) -> None:
    """Raise DocumentError for a tendon or dampers of a body whose edges differ."""
    for key in ("tendon", "dampers"):
        if key in restraints_in(document) and (body.sides or body.arm is None):
            found = "two unequal sides" if body.sides else "other parts on each edge"
            raise document.fault(
                key,
                f"{key} of a body with {found}",
                "a body that rocks alike and as a whole on both edges",
            )


def _statics(
    document: Document, held: Restraints, stands: Sequence[Stand]
) -> list[dict[str, Any]]:
    """Return the statics on each edge as rows, one row for equal edges. Raises
    DocumentError for restraints that are too stiff, and for a friction: the sliding of
    a tied body is not computed.
    """
    first = restraints_in(document)[0]
    if document.has("friction"):
        raise document.fault(
            "friction",
            f"friction of a body with {first}, whose sliding is not computed",
            "no friction",
        )
    rows = [{"side": stand.side, **held.statics(stand)} for stand in stands]
    if not (stiffest := max(row["stiffness"] for row in rows)) < _STIFFEST:
        raise document.fault(
            first,
            f"{first} that add {stiffest:.3g} m g R to the stiffness after uplift",
            f"up to {_STIFFEST:g} m g R: the march of a stiffer body takes minutes",
        )
    if len(rows) == 2 and rows[0] == {**rows[1], "side": "left"}:
        return [{**rows[0], "side": "both"}]
    return rows


def _ties(
    document: Document, crown: float, level: float, inset: float, width: float
) -> tuple[Tie, ...]:
    """Return the ties that hold the rocking part, their heights and levers from its
    pivots; the arguments are those of `restrained`. Raises DocumentError.
    """
    one_sided, ties = document.flag("one_sided"), []
    for part in document.parts("ties"):
        where = (
            f"a height above the ground, and up to {crown:g} m, the top of the body (of"
            " the columns of a frame)"
        )
        height = part.quantity("height", most=crown * (1.0 + 1e-9), where=where) - level
        where = f"a length from 0 to {width:g} m, the width of the body"
        least = 0.0 if width < math.inf else -math.inf
        behind = part.quantity("behind", least=least, most=width, where=where)
        stiffness, prestress = _stiffness(part), part.quantity("prestress")
        force = part.quantity("yield")
        if prestress >= force:
            raise part.fault(
                "prestress",
                f"{prestress:g} N, not below the yield of {force:g} N",
                "a prestress below the yield",
            )
        most = math.hypot(height, behind) + behind  # of any rotation
        where = (
            f"an elongation at rupture above 0 and up to {most:g} m, which the body can"
            " reach"
        )
        ultimate = part.quantity("ultimate", most=most, where=where, default=math.inf)
        if stiffness and ultimate * stiffness < force - prestress < math.inf:
            found = (
                f"{ultimate:g} m, below the elongation at yield of"
                f" {(force - prestress) / stiffness:g} m"
            )
            raise part.fault("ultimate", found, "an elongation from the yield on")
        side = part.choice("side", default="right" if one_sided else "both")
        if one_sided and side == "left":
            raise part.fault(
                "side", "left on a one-sided body, which never leans there", "right"
            )
        # a tie below the interface on which a stack rocks does not hold the pieces
        # above
        if height > 0.0:
            ties.append(
                Tie(height, stiffness, prestress, force, ultimate, behind - inset, side)
            )
    return tuple(ties)


def _tendon(document: Document) -> Tendon:
    """Return the tendon. Raises DocumentError."""
    part = document.part("tendon", document.values["tendon"])
    tendon = Tendon(
        _stiffness(part), part.quantity("prestress"), part.quantity("rupture")
    )
    if tendon.prestress >= tendon.rupture:
        found = (
            f"{tendon.rupture:g} N, not above the prestress of {tendon.prestress:g} N"
        )
        raise part.fault("rupture", found, "a force above the prestress")
    return tendon


def _damping(document: Document, p: float, moment: float, levers: float) -> float:
    """Return zeta = c levers p/(2 m g R) of two dashpots; levers: the sum of their
    squared distances from the pivot [m2].
    """
    part = document.part("dampers", document.values["dampers"])
    if levers == math.inf:
        raise document.fault(
            "dampers", "dampers of a body whose width is not known", "damping"
        )
    zeta = part.quantity("coefficient") * levers * p / (2.0 * moment)
    if not zeta + damping_of(document) < MOST_DAMPING:
        raise document.fault(
            "dampers",
            f"dampers of zeta = {zeta:.4g}",
            f"zeta below {MOST_DAMPING:g}, with the damping of the document",
        )
    return zeta


def _stiffness(part: Document) -> float:
    """Return the stiffness K [N/m], or E A/L of a rod."""
    rod = ("length", "area", "modulus")
    if not any(map(part.has, rod)):
        return part.quantity("stiffness")
    length, area, modulus = map(part.quantity, rod)
    return modulus * area / length
