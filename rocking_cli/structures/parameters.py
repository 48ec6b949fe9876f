"""Rocking parameters: the numbers p, alpha, eta, lambda and a_scale that govern the
rocking of a structure.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ..documents.quantities import DEFAULT_GRAVITY
from ..errors import StructureError
from ..showing import Shown
from .building_modes import FloorMode, row_of_mode
from .restraints import Restraints

if TYPE_CHECKING:
    from ..documents.document import Document
    from .mechanics.linkage import Linkage

# details of a member of a family: SI value by key, and SI unit by key
VARIED = (
    "varied",
    "varied_units",
)
# the detail of stated parameters of a stack: those on its other interfaces, each a
# document
OTHERS = "other_interfaces"
DIMENSIONLESS = "dimensionless"  # `structure` of an oscillator without units
MOST_DAMPING = 1.0  # zeta stays below it
# by the printed name
_FIELDS = {
    "p": "p",
    "alpha": "alpha",
    "eta": "eta",
    "lambda": "uplift",
    "a_scale": "a_scale",
}
# rad; a fallen body has theta/alpha = 1/alpha, so a smaller alpha costs too many steps
LEAST_ALPHA = 1e-30


def _require(label: str, value: float, holds: bool, wanted: str) -> None:
    if not (math.isfinite(value) and holds):
        raise StructureError(f"{label} is {value:g}; expected {wanted}")


def _check_numbers(of: Side | RockingParameters) -> None:
    """Raise StructureError for numbers that no body or edge has."""
    for label, x in (
        ("p", of.p),
        ("alpha", of.alpha),
        ("lambda", of.uplift),
        ("a_scale", of.a_scale),
    ):
        if not 0.0 < x < math.inf:
            _require(label, x, False, "a positive finite number")
    if of.alpha < LEAST_ALPHA:
        raise StructureError(
            f"alpha is {of.alpha:g} rad; expected {LEAST_ALPHA:g} rad or more"
        )
    if of.arm is not None:
        _require("arm", of.arm, of.arm > 0.0, "a positive finite length")


@dataclass(frozen=True)
class Side:
    """The parameters of an unsymmetric body while it stands on one of its edges. Raises
    StructureError if a number is not finite or out of range.
    """

    side: str  # "right" (theta > 0) or "left" (theta < 0)
    p: float  # frequency parameter [rad/s]
    alpha: float  # critical angle [rad]
    uplift: float  # lambda, the static uplift acceleration over g [-]
    a_scale: float  # as in `RockingParameters` [-]
    # angular speed after over before the impact with which it leaves this edge [-]
    eta: float
    # R, distance from the edge to the mass centre [m]; None if not known
    arm: float | None = None
    # for the nonlinear model, None for a rigid body
    mechanism: Linkage | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.side not in ("left", "right"):
            raise StructureError(f"side is {self.side!r}; expected left or right")
        _check_numbers(self)
        # the rotations of a mechanism on its sides may be those of different bodies
        most, wanted = (1.0, " to 1") if self.a_scale == 1.0 else (math.inf, "")
        _require("eta", self.eta, 0.0 <= self.eta <= most, f"a number from 0{wanted}")

    def row(self) -> dict[str, Any]:
        """Return the parameters as `rocking params --json` prints them."""
        return {
            "side": self.side,
            **numbers_of(self),
            **({} if self.arm is None else {"arm": self.arm}),
        }


def numbers_of(of: Side | RockingParameters) -> dict[str, float]:
    """Return the five parameters by their printed names."""
    return {key: getattr(of, name) for key, name in _FIELDS.items()}


def fields_in(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the five parameters of a row by the names of the fields."""
    return {name: row[key] for key, name in _FIELDS.items()}


@dataclass(frozen=True, repr=False, kw_only=True)
class RockingParameters(Shown):
    """The parameters of a rocking structure (sections 2 to 4 of the paper).

    `load_structures` and `build_structure` make one of a document, and
    `dimensionless_oscillator` one of a restitution alone. If the edges differ, the
    numbers are those of the edge with the smaller lambda. `row` and `from_row` write
    and read it; `dimensionless_amplitude` and `ground_acceleration` turn a_g into A and
    back; `with_restitution` returns the same body with another eta. Raises
    StructureError if a number is not finite or out of range, or if the sides do not
    agree with the rest.

    Attributes
    ----------
    structure: its kind
    p: frequency parameter [rad/s]
    alpha: critical angle [rad]
    eta: coefficient of restitution [-]; of a one-sided body in (-1, 0]
    uplift: lambda, the static uplift acceleration over g [-]
    a_scale: factor of the dimensionless amplitude A = a_scale a_g/(alpha g) [-]
    eta_source: "momentum" or "given"
    gravity: g [m/s2]
    details: further results of the kind, by name
    mechanism: for the nonlinear model, None for a rigid body
    sides: (left, right) if the edges differ, else empty
    one_sided: True if it rocks on its right edge only; eta includes the impact on its
        backing
    damping: zeta of the moment -2 zeta p theta' [-]
    friction: static coefficient of the base or joints [-], None if not stated
    kinetic_friction: coefficient of a base that slides [-], at most the static one,
        None for the same
    arm: R, distance from the edge to the mass centre [m], only for one rigid body;
        without R the ground forces are not known
    top: distances from the left and the right edge to the farthest point of the top
        [m], empty without a geometry
    restraints: ties and a tendon, which change uplift, stiffness and equilibrium; all
        other numbers are those of the free body
    building: modes of the building on whose floor it stands, empty on the ground
    labels: texts by name that a document or a table has beside its numbers
    remarks: sentences on numbers that are probably wrong

    Examples
    --------
    >>> column = RockingParameters(
    ...     name="Column", structure="parameters", p=2.67, alpha=0.245, eta=0.91,
    ...     uplift=0.25, a_scale=1.0,
    ... )
    >>> round(column.dimensionless_amplitude(0.35 * 9.81), 4)
    1.4286
    >>> column.row()["lambda"]
    0.25
    """

    name: str  # of the structure, as tables and files call it
    structure: str  # kind of the structure
    p: float  # frequency parameter [rad/s]
    alpha: float  # critical angle [rad]
    eta: float  # coefficient of restitution [-]; of a one-sided body in (-1, 0]
    uplift: float  # lambda, the static uplift acceleration over g [-]
    # factor of the dimensionless amplitude A = a_scale a_g/(alpha g) [-]
    a_scale: float
    eta_source: str = "momentum"  # "momentum" or "given"
    gravity: float = DEFAULT_GRAVITY  # g [m/s2]
    # further results of the kind, by name
    details: Mapping[str, Any] = field(default_factory=dict)
    # for the nonlinear model, None for a rigid body
    mechanism: Linkage | None = field(default=None, repr=False, compare=False)
    sides: tuple[Side, ...] = ()  # (left, right) if the edges differ, else empty
    # True if it rocks on its right edge only; eta includes the impact on its backing
    one_sided: bool = False
    damping: float = 0.0  # zeta of the moment -2 zeta p theta' [-]
    # static coefficient of the base or joints [-], None if not stated
    friction: float | None = None
    # R, distance from the edge to the mass centre [m], only for one rigid body; without
    # R the ground forces are not known
    arm: float | None = None
    # distances from the left and the right edge to the farthest point of the top [m],
    # empty without a geometry
    top: tuple[float, ...] = field(default=(), repr=False, compare=False)
    # ties and a tendon, which change uplift, stiffness and equilibrium; all other
    # numbers are those of the free body
    restraints: Restraints | None = None
    # modes of the building on whose floor it stands, empty on the ground
    building: tuple[FloorMode, ...] = ()
    # texts by name that a document or a table has beside its numbers
    labels: Mapping[str, str] = field(default_factory=dict, repr=False, compare=False)
    # sentences on numbers that are probably wrong
    remarks: tuple[str, ...] = field(default=(), repr=False, compare=False)
    # coefficient of a base that slides [-], at most the static one, None for the same
    kinetic_friction: float | None = None
    # the document that it was built from, for drawings and draws; None if it has none
    document: Document | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        _check_numbers(self)
        if self.one_sided:
            _require(
                "eta",
                self.eta,
                -1.0 < self.eta <= 0.0,
                "a number above -1 and up to 0 for a one-sided body",
            )
        elif not self.sides:
            _require("eta", self.eta, 0.0 <= self.eta <= 1.0, "a number from 0 to 1")
        _require(
            "damping",
            self.damping,
            0.0 <= self.damping < MOST_DAMPING,
            f"a number from 0 to below {MOST_DAMPING:g}",
        )
        if self.friction is not None:
            _require(
                "friction",
                self.friction,
                self.friction > 0.0,
                "a positive finite number",
            )
        if self.kinetic_friction is not None:
            most = self.friction or 0.0
            _require(
                "kinetic friction",
                self.kinetic_friction,
                0.0 < self.kinetic_friction <= most,
                f"a positive number up to the static one, {most:g}",
            )
        if not self.sides:
            return
        if [side.side for side in self.sides] != ["left", "right"]:
            raise StructureError(
                "found other `sides`; expected two, the left one first and then the"
                " right one"
            )
        if self.one_sided:
            raise StructureError("a one-sided body has one side")
        _require(
            "the product of the two eta",
            (both := self.sides[0].eta * self.sides[1].eta),
            both <= 1.0 + 1e-12,
            "a number from 0 to 1",
        )
        weaker = weaker_side(self.sides)
        if numbers_of(weaker) != numbers_of(self):
            raise StructureError(
                f"p, alpha, lambda, a_scale and eta are not those of the {weaker.side}"
                " edge, which lifts first"
            )

    @classmethod
    def of_sides(
        cls, name: str, structure: str, left: Side, right: Side, **more: Any
    ) -> RockingParameters:
        """Return a body on two edges.

        Parameters
        ----------
        name
            of the structure
        structure
            its kind
        left, right
            parameters of the body on each edge; if they are equal, `sides` is empty
        more
            the other fields

        Returns
        -------
        RockingParameters
            whose p, alpha, eta, lambda and a_scale are those of the edge with the
            smaller lambda

        Raises
        ------
        StructureError
            if a number is out of range
        """
        sides = () if numbers_of(left) == numbers_of(right) else (left, right)
        weaker = weaker_side((left, right))
        return cls(
            name=name,
            structure=structure,
            **fields_in(numbers_of(weaker)),
            sides=sides,
            arm=weaker.arm,
            mechanism=(weaker if sides else right).mechanism,
            **more,
        )

    @property
    def drawn_from(self) -> Document | None:
        """The document, if it holds numbers with a spread, at whose means all numbers
        hold; None without one.
        """
        document = self.document
        return document if document is not None and document.uncertain else None

    @property
    def edges(self) -> tuple[Side | RockingParameters, ...]:
        """The edges that differ, the right one first: the structure itself if there is
        one.
        """
        return self.sides[::-1] or (self,)

    @property
    def left_and_right(self) -> tuple[Side | RockingParameters, ...]:
        """The left and the right edge, which may be alike."""
        return self.sides or (self, self)

    @property
    def plain(self) -> bool:
        """True for the body of the paper: two equal edges, no damping and no
        restraints.
        """
        return not (self.sides or self.one_sided or self.damping or self.restraints)

    @classmethod
    def from_row(cls, row: Mapping[str, Any]) -> RockingParameters:
        """Return the parameters that `row()` wrote.

        Parameters
        ----------
        row
            a dictionary, as `rocking params --json` prints it

        Returns
        -------
        RockingParameters
            without the mechanism of an arch, which a row does not hold

        Raises
        ------
        KeyError, TypeError, ValueError
            if the dictionary is not valid
        """
        sides = tuple(
            Side(side["side"], arm=side.get("arm"), **fields_in(side))
            for side in row.get("sides", ())
        )
        kind = row["structure_kind"]
        more = {
            key: row[key]
            for key in ("one_sided", "damping", "friction", "arm")
            if key in row
        }
        if isinstance(friction := row.get("friction"), Mapping):
            more["friction"] = friction["static"]
            more["kinetic_friction"] = friction["kinetic"]
        more |= {"eta_source": row["eta_source"], "gravity": row["gravity"]}
        modes = row.get("building", ())
        more["building"] = tuple(FloorMode(*mode.values()) for mode in modes)
        if "ties" in row or "tendon" in row:
            more["restraints"] = Restraints.from_row(row)
        details = {key: row[key] for key in (*VARIED, "restrained") if key in row}
        more["labels"] = row.get("labels", {})
        return cls(
            name=row["name"],
            structure=kind,
            **fields_in(row),
            sides=sides,
            details=details,
            **more,
        )

    @property
    def linear_uplift(self) -> float:
        """alpha/a_scale, the ground acceleration over g at which the linear oscillator
        lifts [-]; the body itself lifts at lambda.
        """
        return self.alpha / self.a_scale

    def lifting_at_lambda(self) -> RockingParameters:
        """Return the body with a_scale = alpha/lambda (Eq. 3.9) on every edge: its
        linear oscillator lifts at lambda, as the body does. A structure whose a_scale
        is not 1 is returned unchanged.
        """
        if self.a_scale != 1.0:
            return self
        sides = tuple(
            replace(side, a_scale=side.alpha / side.uplift) for side in self.sides
        )
        return replace(self, a_scale=self.alpha / self.uplift, sides=sides)

    def with_restitution(self, eta: float) -> RockingParameters:
        """Return the same body with another restitution on every edge.

        Parameters
        ----------
        eta
            coefficient of restitution [-] (Eq. 2.6)

        Returns
        -------
        RockingParameters
            with eta_source "given"

        Raises
        ------
        StructureError
            if eta is out of range
        """
        return replace(
            self,
            eta=eta,
            eta_source="given",
            sides=tuple(replace(side, eta=eta) for side in self.sides),
        )

    @property
    def dimensionless(self) -> bool:
        """True for the oscillator of a dimensionless spectrum, which has no units."""
        return self.structure == DIMENSIONLESS

    def _shown(self) -> dict[str, Any]:
        return self.row()

    def row(self) -> dict[str, Any]:
        """Return the parameters as `rocking params --json` prints them: a document of
        kind `parameters`.
        """
        kind = {
            "name": self.name,
            "kind": "parameters",
            "structure_kind": self.structure,
        }
        more = {
            key: getattr(self, key)
            for key in ("one_sided", "damping", "friction", "arm")
            if getattr(self, key)
        }
        if self.kinetic_friction is not None:
            both = {"static": self.friction, "kinetic": self.kinetic_friction}
            more["friction"] = both
        if self.building:
            more["building"] = [row_of_mode(mode) for mode in self.building]
        sides = {"sides": [side.row() for side in self.sides]} if self.sides else {}
        more |= self.restraints.row() if self.restraints else {}
        more |= {"labels": dict(self.labels)} if self.labels else {}
        return {
            **kind,
            **numbers_of(self),
            "eta_source": self.eta_source,
            "gravity": self.gravity,
            **sides,
            **more,
            **self.details,
        }

    def alpha_on(self, side: Any) -> Any:
        """Return the critical angle on each side.

        Parameters
        ----------
        side
            +1 for the right edge (theta > 0), -1 for the left, of any shape

        Returns
        -------
        float or array
            alpha [rad], in the shape of `side`
        """
        if not self.sides:
            return self.alpha + 0.0 * side
        left, right = self.sides
        return left.alpha + (right.alpha - left.alpha) * (side > 0.0)

    def dimensionless_amplitude(self, a_g: Any) -> Any:
        """Return A = a_scale a_g / (alpha g).

        Parameters
        ----------
        a_g
            amplitude of the ground acceleration [m/s2], of any shape

        Returns
        -------
        float or array
            A [-]
        """
        return self.a_scale * a_g / (self.alpha * self.gravity)

    def ground_acceleration(self, amplitude: Any) -> Any:
        """Return a_g = A alpha g / a_scale.

        Parameters
        ----------
        amplitude
            A [-], of any shape

        Returns
        -------
        float or array
            amplitude of the ground acceleration [m/s2]
        """
        return amplitude * (self.alpha * self.gravity) / self.a_scale


def weaker_side(sides: Sequence[Side]) -> Side:
    """Return the side with the smaller lambda; the left side if both are equal."""
    return min(sides, key=lambda side: side.uplift)


def dimensionless_oscillator(*, eta: float) -> RockingParameters:
    """Return the oscillator of a dimensionless spectrum.

    Its p, alpha, lambda, a_scale and gravity are 1, so a_g = A and omega_g = Omega. One
    spectrum of it serves every structure of the same restitution (section 4 of the
    paper).

    Parameters
    ----------
    eta
        coefficient of restitution [-], from 0 to 1 (Eq. 2.6)

    Returns
    -------
    RockingParameters

    Raises
    ------
    StructureError
        if eta is not in [0, 1]

    Examples
    --------
    >>> oscillator = dimensionless_oscillator(eta=0.9)
    >>> oscillator.p, oscillator.alpha, oscillator.eta
    (1.0, 1.0, 0.9)
    """
    return RockingParameters(
        name=f"eta={eta:g}",
        structure=DIMENSIONLESS,
        p=1.0,
        alpha=1.0,
        eta=eta,
        uplift=1.0,
        a_scale=1.0,
        eta_source="given",
        gravity=1.0,
    )
