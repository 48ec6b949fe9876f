"""The few numbers that govern rocking, and the document kind that states them directly."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..documents.document import Document
from ..documents.quantities import DEFAULT_GRAVITY
from ..errors import DocumentError, StructureError
from .kinematics import Mechanism

DIMENSIONLESS = "dimensionless"  # the structure word of an oscillator without units
MOST_DAMPING = 1.0  # zeta below this; motions of masonry are damped by a few per cent


def _check_numbers(p: float, alpha: float, uplift: float, a_scale: float) -> None:
    for label, x in (("p", p), ("alpha", alpha), ("lambda", uplift), ("a_scale", a_scale)):
        if not (math.isfinite(x) and x > 0.0):
            raise StructureError(f"{label} is {x:g}, accepted is a positive finite number")


@dataclass(frozen=True)
class Side:
    """What an unequal body is while it stands on one of its edges.

    side: that edge, "right" for theta > 0 and "left" for theta < 0; p frequency parameter [rad/s]; alpha critical angle
    [rad]; uplift lambda [-]; a_scale [-]; eta: angular speed after over before, on leaving this edge for the other [-].
    Raises StructureError when a number is not finite or out of range.
    """

    side: str
    p: float
    alpha: float
    uplift: float
    a_scale: float
    eta: float

    def __post_init__(self) -> None:
        if self.side not in ("left", "right"):
            raise StructureError(f"side is {self.side!r}, accepted is left or right")
        _check_numbers(self.p, self.alpha, self.uplift, self.a_scale)
        if not 0.0 <= self.eta <= 1.0:
            raise StructureError(f"eta is {self.eta:g}, accepted is a number from 0 to 1")

    def record(self) -> dict[str, Any]:
        """As `rocking params --json` prints it."""
        return {"side": self.side, **self.numbers()}

    def numbers(self) -> dict[str, float]:
        """The parameters by the names under which they are printed."""
        return {"p": self.p, "alpha": self.alpha, "lambda": self.uplift, "a_scale": self.a_scale, "eta": self.eta}


@dataclass(frozen=True)
class RockingParameters:
    """What a rocking structure comes to (section 4 of the paper: p, alpha, eta, lambda, and a_scale).

    name; structure: the kind it came from; p frequency parameter [rad/s]; alpha critical angle [rad]; eta restitution
    [-]; uplift lambda, the static uplift acceleration over g [-]; a_scale [-]; eta_source: where eta comes from; gravity
    [m/s2]; details: what else the kind reports; mechanism: where it is no rigid body, for the nonlinear model.

    sides: (left, right) of a body whose edges differ, and then the numbers above are those of the edge with the least
    lambda; one_sided: free for theta > 0 only, on its right edge, and then eta is the restitution against what stands
    behind it, from above -1 to 0, negative as the literature prints it; damping: zeta of the moment -2 zeta p theta' [-].
    Raises StructureError when a number is not finite or out of range, or the sides do not fit the rest.
    """

    name: str
    structure: str
    p: float
    alpha: float
    eta: float
    uplift: float
    a_scale: float
    eta_source: str = "momentum"
    gravity: float = DEFAULT_GRAVITY
    details: Mapping[str, Any] = field(default_factory=dict)
    mechanism: Mechanism | None = field(default=None, repr=False, compare=False)
    sides: tuple[Side, ...] = ()
    one_sided: bool = False
    damping: float = 0.0

    def __post_init__(self) -> None:
        _check_numbers(self.p, self.alpha, self.uplift, self.a_scale)
        if self.one_sided and not -1.0 < self.eta <= 0.0:
            raise StructureError(f"eta is {self.eta:g}, accepted for a one-sided body is a number above -1 and up to 0")
        if not self.one_sided and not 0.0 <= self.eta <= 1.0:
            raise StructureError(f"eta is {self.eta:g}, accepted is a number from 0 to 1")
        if not 0.0 <= self.damping < MOST_DAMPING:
            raise StructureError(f"damping is {self.damping:g}, accepted is a number from 0 to below {MOST_DAMPING:g}")
        if not self.sides:
            return
        if [side.side for side in self.sides] != ["left", "right"]:
            raise StructureError("sides are not the left one and the right one, in this order")
        if self.one_sided:
            raise StructureError("a one-sided body has one side")
        weaker = weaker_side(self.sides)
        if weaker.numbers() != {"p": self.p, "alpha": self.alpha, "lambda": self.uplift, "a_scale": self.a_scale, "eta": self.eta}:
            raise StructureError(f"p, alpha, lambda, a_scale and eta are not those of the {weaker.side} edge, which lifts first")

    @classmethod
    def of_sides(cls, name: str, structure: str, left: Side, right: Side, **more: Any) -> RockingParameters:
        """A body of two edges; where their numbers are equal it is a symmetric one, without sides. `more`: the other fields."""
        sides = () if left.numbers() == right.numbers() else (left, right)
        weaker = weaker_side((left, right))
        return cls(name, structure, weaker.p, weaker.alpha, weaker.eta, weaker.uplift, weaker.a_scale, sides=sides, **more)

    @property
    def dimensionless(self) -> bool:
        """Whether this is the oscillator of a dimensionless spectrum, which has no units."""
        return self.structure == DIMENSIONLESS

    def record(self) -> dict[str, Any]:
        """The record that `rocking params --json` prints, itself a document of kind `parameters`."""
        return {
            "name": self.name,
            "kind": "parameters",
            "structure": self.structure,
            "p": self.p,
            "alpha": self.alpha,
            "eta": self.eta,
            "lambda": self.uplift,
            "a_scale": self.a_scale,
            "eta_source": self.eta_source,
            "gravity": self.gravity,
            **({"sides": [side.record() for side in self.sides]} if self.sides else {}),
            **({"one_sided": True} if self.one_sided else {}),
            **({"damping": self.damping} if self.damping else {}),
            **self.details,
        }

    def dimensionless_amplitude(self, a_g: Any) -> Any:
        """A = a_scale a_g / (alpha g) for a ground acceleration a_g [m/s2]."""
        return self.a_scale * a_g / (self.alpha * self.gravity)

    def ground_acceleration(self, amplitude: Any) -> Any:
        """a_g [m/s2] for a dimensionless amplitude A."""
        return amplitude * (self.alpha * self.gravity) / self.a_scale


def weaker_side(sides: Sequence[Side]) -> Side:
    """The side that lifts first, the left one if both lift at once."""
    return min(sides, key=lambda side: side.uplift)


def dimensionless_oscillator(eta: float) -> RockingParameters:
    """The oscillator of a dimensionless spectrum: p, alpha, lambda, a_scale and gravity are 1, so a_g is A and omega_g Omega.

    Raises StructureError when eta is not within [0, 1].
    """
    return RockingParameters(f"eta={eta:g}", DIMENSIONLESS, 1.0, 1.0, eta, 1.0, 1.0, "given", 1.0)


REPORTED = (
    "structure",
    "eta_source",
    "hinges",
    "a_scale_3_7",
    "direction",
    "lambda_governing",
    "tip_height",
    "crack_height",
    "cap_ratio",
    "rocks_on",
    "varied",
)
"""Keys that a record may carry along and that do not change the parameters."""


ONE_SIDED_RESTITUTION = "a number above -1 and up to 0 (one_sided: it returns to the side it came from)"


def gravity_of(document: Document) -> float:
    """The document's gravity [m/s2], 9.81 unless given."""
    if not document.has("gravity"):
        return DEFAULT_GRAVITY
    return document.quantity("gravity", "acceleration", above=0.0, where="a positive acceleration")


def restitution_of(document: Document, momentum: float, limit: str) -> tuple[float, str]:
    """(eta, where it comes from): the document's value, or the given one from momentum.

    `limit` says in words when the momentum model stops to hold (eta < 0), which is an error unless eta is given.
    """
    if document.has("restitution") and document.values["restitution"].content != "auto":
        wanted = "a number from 0 to 1, or auto"
        try:
            return abs(document.quantity("restitution", "number", least=0.0, most=1.0, where=wanted)), "given"
        except DocumentError:
            raise document.fault("restitution", str(document.values["restitution"]), wanted) from None
    if momentum < 0.0:
        raise document.fault(None, f"a restitution of {momentum:.4g} from momentum", f"{limit}; or give restitution")
    return momentum, "momentum"


def one_sided_of(document: Document) -> bool:
    """Whether the body leaves the ground on its right edge only, false unless the document says so."""
    return document.flag("one_sided")


def damping_of(document: Document) -> float:
    """The document's viscous damping zeta [-], 0 unless given."""
    if not document.has("damping"):
        return 0.0
    where = f"a number from 0 to below {MOST_DAMPING:g} (zeta)"
    return document.quantity("damping", "number", least=0.0, below=MOST_DAMPING, where=where)


def build(document: Document, name: str) -> RockingParameters:
    """The parameters as a document of kind `parameters` states them; lambda and a_scale give each other (Eq. 3.9)."""
    details = {key: document.values[key].plain() for key in document.values if key in REPORTED and document.has(key)}
    structure = str(details.pop("structure", "parameters"))
    if structure == DIMENSIONLESS:
        raise document.fault("structure", structure, "the kind of a structure, which has units")
    source = str(details.pop("eta_source", "given"))
    more: dict[str, Any] = {"eta_source": source, "gravity": gravity_of(document), "details": details}
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
