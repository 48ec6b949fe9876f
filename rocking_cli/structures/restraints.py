"""Ties, a tendon and dampers of a rigid body: their statics, and their keys in a document.

A tie is anchored at the height h above the pivot and x behind it, and stays horizontal. At the rotation theta it has

    u = x (1 - cos theta) + h sin theta,   lever = h cos theta + x sin theta,   F = min(P0 + K u, F_y), 0 from u = u_ult on

A tendon on the centre line, at the distance b from the pivot, has the elongation 2 b sin(theta/2) and the lever b cos(theta/2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from .parameters import MOST_DAMPING, RockingParameters, Side
from .shared_keys import damping_of, mass_of, restraints_in

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..documents.document import Document
    from .sketch import Sketch

SIDES = {"left": ("left",), "right": ("right",), "both": ("left", "right")}
_POINTS = 1000  # of the search for an equilibrium
_STIFFEST = 1e9  # m g R, of the restraints after uplift
_TIES = "a list of ties, each with height, stiffness (or length, area and modulus), and prestress, yield, ultimate, behind, side"


@dataclass(frozen=True)
class Tie:
    """A horizontal tie, elastic-plastic, in tension only; the side on which it acts is "left", "right" or "both".
    height, behind: h and x of its anchor [m]; stiffness: K [N/m]; prestress: P0 [N]; yield_force: F_y [N]; ultimate: u_ult [m]."""

    height: float
    stiffness: float
    prestress: float = 0.0
    yield_force: float = math.inf
    ultimate: float = math.inf
    behind: float = 0.0
    side: str = "both"

    def elongation(self, theta: float) -> float:
        """Return u [m] at a rotation [rad]."""
        return self.behind * (1.0 - math.cos(theta)) + self.height * math.sin(theta)

    def lever(self, theta: float) -> float:
        """Return du/dtheta [m] at a rotation [rad]."""
        return self.height * math.cos(theta) + self.behind * math.sin(theta)

    def breaks_at(self) -> float:
        """Return the rotation [rad] of u_ult, or infinity: u = R_t (sin a - sin(a - theta)), a being the angle of the anchor."""
        reach, start = math.hypot(self.behind, self.height), math.atan2(self.behind, self.height)
        sine = math.sin(start) - self.ultimate / reach
        return start - math.asin(sine) if sine >= -1.0 else math.inf

    def moment(self, theta: float) -> float:
        """Return the moment about the pivot [N m] at a rotation [rad] of a body that has not turned back before."""
        u = self.elongation(theta)
        return 0.0 if u >= self.ultimate else min(self.prestress + self.stiffness * u, self.yield_force) * self.lever(theta)


class Strand(Tie):
    """A tendon seen from one edge, as a tie of the height b."""

    def elongation(self, theta: float) -> float:
        return 2.0 * self.height * math.sin(0.5 * theta)

    def lever(self, theta: float) -> float:
        return self.height * math.cos(0.5 * theta)

    def breaks_at(self) -> float:
        sine = 0.5 * self.ultimate / self.height
        return 2.0 * math.asin(sine) if sine <= 1.0 else math.inf


@dataclass(frozen=True)
class Tendon:
    """An unbonded vertical tendon through the base; stiffness: k = EA/L [N/m]; prestress: P0 [N]; rupture: F_u [N]."""

    stiffness: float
    prestress: float = 0.0
    rupture: float = math.inf

    def at(self, lever: float) -> Strand:
        """Return the tendon at the distance `lever` [m] from an edge."""
        ultimate = (self.rupture - self.prestress) / self.stiffness if self.stiffness else math.inf
        return Strand(lever, self.stiffness, self.prestress, ultimate=ultimate)


class Stand(NamedTuple):
    """A body on one edge: its side, alpha [rad], m g R [N m], and the distance from the pivot to the centre line [m]."""

    side: str
    alpha: float
    moment: float
    lever: float


@dataclass(frozen=True)
class Restraints:
    """The ties and the tendon of a body; stands: the body on its left and on its right edge."""

    ties: tuple[Tie, ...] = ()
    tendon: Tendon | None = None
    stands: tuple[Stand, ...] = ()

    def on(self, side: str, lever: float) -> list[Tie]:
        """Return the ties of a side, and the tendon at the distance `lever` [m] from its edge."""
        return [tie for tie in self.ties if side in SIDES[tie.side]] + ([self.tendon.at(lever)] if self.tendon else [])

    def row(self) -> dict[str, Any]:
        """Return the restraints as a document states them, in SI units, with the further keys that a spectra file needs."""
        found: dict[str, Any] = {"ties": [_stated(tie) for tie in self.ties]} if self.ties else {}
        return found | ({"tendon": _stated(self.tendon)} if self.tendon else {}) | {"stands": [one._asdict() for one in self.stands]}

    @classmethod
    def from_row(cls, row: Mapping[str, Any]) -> Restraints:
        """Return the restraints of a row of parameters, whose heights count from the pivots. Raises KeyError or TypeError."""
        ties = (Tie(**{"yield_force" if key == "yield" else key: x for key, x in one.items()}) for one in row.get("ties", ()))
        tendon = Tendon(**row["tendon"]) if "tendon" in row else None
        return cls(tuple(ties), tendon, tuple(Stand(**one) for one in row["stands"]))

    def statics(self, stand: Stand) -> dict[str, Any]:
        """Return lambda, the linear stiffness after uplift over m g R (-1 for the free body), and the equilibrium that replaces alpha: the
        first rotation [rad], up to a right angle, from which the body does not return; "none" without one."""
        ties = self.on(stand.side, stand.lever)
        pull, stiff = sum(tie.prestress * tie.height for tie in ties), sum(tie.stiffness * tie.height**2 for tie in ties)

        def returns(theta: float) -> bool:
            return stand.moment * math.sin(stand.alpha - theta) + sum(tie.moment(theta) for tie in ties) > 0.0

        low, high, step = 0.0, 0.0, 0.5 * math.pi / _POINTS
        while (stays := returns(high)) and high < 0.5 * math.pi:
            low, high = high, high + step
        for _ in range(60):  # bisection, which also ends at a rupture
            middle = 0.5 * (low + high)
            low, high = (middle, high) if returns(middle) else (low, middle)
        uplift = math.tan(stand.alpha) + pull / (stand.moment * math.cos(stand.alpha))
        return {"lambda": uplift, "stiffness": stiff / stand.moment - 1.0, "equilibrium": "none" if stays else high}

    def drawn(self, drawing: Sketch) -> Sketch:
        """Return the drawing with the tendon and the ties added; a tie goes from its anchor across the body and beyond it."""
        (_, (left, level)), (_, (right, _)) = drawing.pivots[0], drawing.pivots[-1]
        x, z = zip(*(point for body in drawing.bodies for point in body), strict=True)
        ends = {"left": (left, 1.0, max(x)), "right": (right, -1.0, min(x))}
        lines = []
        for one, (pivot, away, end) in [(tie, ends[side]) for tie in self.ties for side in SIDES[tie.side]]:
            height = level + one.height
            course = (pivot + away * one.behind, height), (end + away * 0.15 * (max(z) - level), height)
            lines.append(("tie", tuple(sorted(course))))
        if self.tendon:
            lines.append(("tendon", ((0.5 * (left + right), level), (0.5 * (left + right), max(z)))))
        return replace(drawing, lines=(*lines, *drawing.lines))


def _stated(one: Tie | Tendon) -> dict[str, Any]:
    return {key.removesuffix("_force"): value for key, value in vars(one).items() if value != math.inf}


def restrained(
    document: Document, body: RockingParameters, *, crown: float = math.inf, level: float = 0.0, inset: float = 0.0,
    width: float = math.inf, radius: float | None = None, share: float = 1.0,
) -> RockingParameters:  # fmt: skip
    """Return the body with the ties, the tendon and the dampers of its document, and their statics in its details. Raises DocumentError.
    crown, width: of the body [m]; level, inset: of its pivots [m]; radius: R of a body without an arm [m]; share: m g R over mass g R."""
    mass, given = mass_of(document) or body.details.get("mass"), restraints_in(document)
    if mass is None:
        raise document.missing("mass", f"the mass [kg], which {given[0]} need")
    both: tuple[Side | RockingParameters, ...] = body.sides or (body, body)
    stands = []
    for side, of in zip(SIDES["both"], both, strict=True):
        if (arm := of.arm or radius) is None:
            raise document.fault(given[0], f"{given[0]} of a body whose arm is not known", "arm as well")
        stands.append(Stand(side, of.alpha, mass * body.gravity * arm * share, arm * math.sin(of.alpha)))
    for key in ("tendon", "dampers"):
        if key in given and (body.sides or body.arm is None):
            found = "two unequal sides" if body.sides else "other parts on each edge"
            raise document.fault(key, f"{key} of a body with {found}", "a body that rocks alike and as a whole on both edges")
    if "dampers" in given:
        body = replace(body, damping=_damping(document, body.p, stands[0].moment, (width - inset) ** 2 + inset**2))
    ties = _ties(document, crown, level, inset, width) if "ties" in given else ()
    held = Restraints(ties, _tendon(document) if "tendon" in given else None, tuple(stands))
    if not (held.ties or held.tendon):
        return body
    if document.has("friction"):
        raise document.fault("friction", f"friction of a body with {given[0]}, whose ground forces are not computed", "no friction")
    rows = [{"side": stand.side, **held.statics(stand)} for stand in (stands[1:] if body.one_sided else stands)]
    if not (stiffest := max(row["stiffness"] for row in rows)) < _STIFFEST:
        found = f"{given[0]} that add {stiffest:.3g} m g R to the stiffness after uplift"
        raise document.fault(given[0], found, f"up to {_STIFFEST:g} m g R: the march of a stiffer body takes minutes")
    if len(rows) == 2 and rows[0] == {**rows[1], "side": "left"}:
        rows = [{**rows[0], "side": "both"}]
    return replace(body, restraints=held, details={**body.details, "restrained": rows})


def _ties(document: Document, crown: float, level: float, inset: float, width: float) -> tuple[Tie, ...]:
    one_sided, ties = document.flag("one_sided"), []
    for part in document.parts("ties", _TIES):
        where = f"a height above the ground, and up to {crown:g} m, the top of the body (of the columns of a frame)"
        height = part.quantity("height", "length", above=0.0, most=crown * (1.0 + 1e-9), where=where) - level
        where, least = f"a length from 0 to {width:g} m, the width of the body", 0.0 if width < math.inf else -math.inf
        behind = part.quantity("behind", "length", least=least, most=width, where=where, default=0.0)
        stiffness, prestress = _stiffness(part), _force(part, "prestress", 0.0)
        force = part.quantity("yield", "force", above=0.0, where="a force above 0", default=math.inf)
        if prestress >= force:
            raise part.fault("prestress", f"{prestress:g} N, not below the yield of {force:g} N", "a prestress below the yield")
        most = math.hypot(height, behind) + behind  # of any rotation
        where = f"an elongation at rupture above 0 and up to {most:g} m, which the body can reach"
        ultimate = part.quantity("ultimate", "length", above=0.0, most=most, where=where) if part.has("ultimate") else math.inf
        if stiffness and ultimate * stiffness < force - prestress < math.inf:
            found = f"{ultimate:g} m, below the elongation at yield of {(force - prestress) / stiffness:g} m"
            raise part.fault("ultimate", found, "an elongation from the yield on")
        side = part.choice("side", list(SIDES), "right" if one_sided else "both")
        if one_sided and side == "left":
            raise part.fault("side", "left on a one-sided body, which never leans there", "right")
        if height > 0.0:  # a tie below the interface on which a stack rocks does not hold the pieces above
            ties.append(Tie(height, stiffness, prestress, force, ultimate, behind - inset, side))
    return tuple(ties)


def _tendon(document: Document) -> Tendon:
    part = document.part("tendon", document.values["tendon"])
    tendon = Tendon(_stiffness(part), _force(part, "prestress", 0.0), _force(part, "rupture", math.inf))
    if tendon.prestress >= tendon.rupture:
        found = f"{tendon.rupture:g} N, not above the prestress of {tendon.prestress:g} N"
        raise part.fault("rupture", found, "a force above the prestress")
    part.finish()
    return tendon


def _damping(document: Document, p: float, moment: float, levers: float) -> float:
    """Return zeta = c levers p/(2 m g R) of two dashpots; levers: the sum of their squared distances from the pivot [m2]."""
    part = document.part("dampers", document.values["dampers"])
    if levers == math.inf:
        raise document.fault("dampers", "dampers of a body whose width is not known", "damping")
    zeta = part.quantity("coefficient", "damping coefficient", least=0.0, where="a coefficient from 0") * levers * p / (2.0 * moment)
    part.finish()
    if not zeta + damping_of(document) < MOST_DAMPING:
        raise document.fault("dampers", f"dampers of zeta = {zeta:.4g}", f"zeta below {MOST_DAMPING:g}, with the damping of the document")
    return zeta


def _stiffness(part: Document) -> float:
    """Return the stiffness K [N/m], or E A/L of a rod."""
    rod = {"length": "length", "area": "area", "modulus": "stress"}
    given = [key for key in rod if part.has(key)]
    if given and part.has("stiffness"):
        raise part.fault(given[0], f"{given[0]} together with stiffness", "stiffness, or length, area and modulus, not both")
    if not given:
        return part.quantity("stiffness", "stiffness", least=0.0, where="a stiffness from 0")
    length, area, modulus = (part.quantity(key, rod[key], above=0.0, where="a positive value") for key in rod)
    return modulus * area / length


def _force(part: Document, key: str, default: float) -> float:
    return part.quantity(key, "force", least=0.0, where="a force from 0", default=default)
