"""The few numbers that govern rocking."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ..documents.quantities import DEFAULT_GRAVITY
from ..errors import StructureError

if TYPE_CHECKING:
    from .mechanics.kinematics import Mechanism

VARIED = ("varied", "varied_units")  # details of a member of a family: by key the value in SI, and the name of its unit
DIMENSIONLESS = "dimensionless"  # the structure word of an oscillator without units
MOST_DAMPING = 1.0  # zeta below this; motions of masonry are damped by a few per cent
LEAST_ALPHA = 1e-30  # rad; theta/alpha of a body on its side is 1/alpha, and the march takes the more steps up to there


def _check_arm(arm: float | None) -> None:
    if arm is not None and not (math.isfinite(arm) and arm > 0.0):
        raise StructureError(f"arm is {arm:g}, accepted is a positive finite length")


def _check_numbers(p: float, alpha: float, uplift: float, a_scale: float) -> None:
    for label, x in (("p", p), ("alpha", alpha), ("lambda", uplift), ("a_scale", a_scale)):
        if not (math.isfinite(x) and x > 0.0):
            raise StructureError(f"{label} is {x:g}, accepted is a positive finite number")
    if alpha < LEAST_ALPHA:
        raise StructureError(f"alpha is {alpha:g} rad, accepted is an angle from {LEAST_ALPHA:g} rad")


@dataclass(frozen=True)
class Side:
    """What an unequal body is while it stands on one of its edges.

    side: that edge, "right" for theta > 0 and "left" for theta < 0; p frequency parameter [rad/s]; alpha critical angle
    [rad]; uplift lambda [-]; a_scale [-]; eta: angular speed after over before, on leaving this edge for the other [-];
    arm: as in `RockingParameters`. Raises StructureError when a number is not finite or out of range.
    """

    side: str
    p: float
    alpha: float
    uplift: float
    a_scale: float
    eta: float
    arm: float | None = None

    def __post_init__(self) -> None:
        if self.side not in ("left", "right"):
            raise StructureError(f"side is {self.side!r}, accepted is left or right")
        _check_numbers(self.p, self.alpha, self.uplift, self.a_scale)
        if not 0.0 <= self.eta <= 1.0:
            raise StructureError(f"eta is {self.eta:g}, accepted is a number from 0 to 1")
        _check_arm(self.arm)

    def record(self) -> dict[str, Any]:
        """As `rocking params --json` prints it."""
        return {"side": self.side, **self.numbers(), **({} if self.arm is None else {"arm": self.arm})}

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
    behind it, from above -1 to 0, negative as the literature prints it; damping: zeta of the moment -2 zeta p theta' [-];
    friction: coefficient of the base or of the joints [-], None where it is not stated; arm: R, the distance of the mass centre from
    the edge [m] of what rocks as one rigid body, None of everything else (its forces on the ground then are not known).
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
    friction: float | None = None
    arm: float | None = None

    def __post_init__(self) -> None:
        _check_numbers(self.p, self.alpha, self.uplift, self.a_scale)
        if self.one_sided and not -1.0 < self.eta <= 0.0:
            raise StructureError(f"eta is {self.eta:g}, accepted for a one-sided body is a number above -1 and up to 0")
        if not self.one_sided and not 0.0 <= self.eta <= 1.0:
            raise StructureError(f"eta is {self.eta:g}, accepted is a number from 0 to 1")
        if not 0.0 <= self.damping < MOST_DAMPING:
            raise StructureError(f"damping is {self.damping:g}, accepted is a number from 0 to below {MOST_DAMPING:g}")
        if self.friction is not None and not (math.isfinite(self.friction) and self.friction > 0.0):
            raise StructureError(f"friction is {self.friction:g}, accepted is a positive finite number")
        _check_arm(self.arm)
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
        numbers = (weaker.p, weaker.alpha, weaker.eta, weaker.uplift, weaker.a_scale)
        return cls(name, structure, *numbers, sides=sides, arm=weaker.arm, **more)

    @property
    def plain(self) -> bool:
        """Whether this is the paper's body: two edges alike, no damping."""
        return not (self.sides or self.one_sided or self.damping)

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> RockingParameters:
        """The parameters that `record` states, as files keep them. Raises KeyError, TypeError or ValueError where it is none."""
        sides = tuple(
            Side(s["side"], s["p"], s["alpha"], s["lambda"], s["a_scale"], s["eta"], s.get("arm")) for s in record.get("sides", ())
        )
        names = {"eta": "eta", "lambda": "uplift", "a_scale": "a_scale", "eta_source": "eta_source", "gravity": "gravity"}
        more = {name: record[key] for key, name in names.items()}
        more["details"] = {key: record[key] for key in VARIED if key in record}
        more |= {key: record[key] for key in ("one_sided", "damping", "friction", "arm") if key in record}
        kind = record["structure_kind"] if "structure_kind" in record else record["structure"]  # its name in files of earlier versions
        return cls(record["name"], kind, record["p"], record["alpha"], sides=sides, **more)

    @property
    def linear_uplift(self) -> float:
        """The ground acceleration over g at which the linear oscillator leaves the ground, alpha/a_scale; the body does at lambda [-]."""
        return self.alpha / self.a_scale

    def lifting_at_lambda(self) -> RockingParameters:
        """A rigid body with a_scale = alpha/lambda (Eq. 3.9) on every edge, so that its linear oscillator lifts where the body does;
        any other mechanism (a_scale not 1) unchanged."""
        if self.a_scale != 1.0:
            return self
        sides = tuple(replace(side, a_scale=side.alpha / side.uplift) for side in self.sides)
        return replace(self, a_scale=self.alpha / self.uplift, sides=sides)

    def with_restitution(self, eta: float) -> RockingParameters:
        """The same body with another restitution, on both edges. Raises ValueError when it is out of range."""
        if self.sides:
            left, right = (replace(side, eta=eta) for side in self.sides)
            return replace(self, eta=eta, eta_source="given", sides=(left, right))
        return replace(self, eta=eta, eta_source="given")

    @property
    def dimensionless(self) -> bool:
        """Whether this is the oscillator of a dimensionless spectrum, which has no units."""
        return self.structure == DIMENSIONLESS

    def record(self) -> dict[str, Any]:
        """The record that `rocking params --json` prints, itself a document of kind `parameters`."""
        return {
            "name": self.name,
            "kind": "parameters",
            "structure_kind": self.structure,
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
            **({} if self.friction is None else {"friction": self.friction}),
            **({} if self.arm is None else {"arm": self.arm}),
            **self.details,
        }

    def alpha_on(self, side: Any) -> Any:
        """alpha [rad] on the side +1 (right edge) or -1, of any shape."""
        if not self.sides:
            return self.alpha + 0.0 * side
        left, right = self.sides
        return left.alpha + (right.alpha - left.alpha) * (side > 0.0)

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

    >>> dimensionless_oscillator(0.9).eta
    0.9
    """
    return RockingParameters(f"eta={eta:g}", DIMENSIONLESS, 1.0, 1.0, eta, 1.0, 1.0, "given", 1.0)
