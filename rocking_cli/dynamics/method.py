"""Chooses equation, contact and reference solver for a structure; a new equation is one
entry of EQUATIONS, imported where it is used.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..errors import UsageError, did_you_mean
from ..structures.parameters import RockingParameters, Side
from .body import Body
from .contacts.contact import Contact, OneSided, Symmetric, Unequal, reciprocal_ratios
from .equations.equation import Equation
from .equations.taylor import order_for
from .system import System

if TYPE_CHECKING:
    from ..motions.motion import Motion
    from ..structures.mechanics.kinematics import Mechanism
    from .outcome import Outcome
    from .references.general_solver import Problem

TOLERANCE = 1e-9
CHECKED_BY = "a Runge-Kutta method"  # the slower solver of `reference_of`
Reference = Callable[["Motion", float, float, float], tuple["Outcome", float]]


class EquationKind(NamedTuple):
    """An equation of motion in the registry."""

    model: str  # the word of `--model` and of files
    # returns True for a structure for which the equation holds
    serves: Callable[[RockingParameters], bool]
    # returns the equation of a structure at a tolerance, raises ValueError
    build: Callable[[RockingParameters, float], Equation]
    # returns the numbers, besides restitution and damping, that structures must have in
    # common to share a dimensionless computation
    shares: Callable[[RockingParameters], Any]
    rates: str  # name of its form in `references.problems`
    exact: bool = False  # True if it has no tolerance
    # returns one equation for cells of plain bodies with these alphas at a tolerance,
    # None if there is none
    of_cells: Callable[[np.ndarray, float], Equation] | None = None


def _linear(structure: RockingParameters, tolerance: float) -> Equation:
    from .equations.linear import LinearEquation

    return LinearEquation(structure.damping)


def _rigid(alpha: Any, tolerance: float, damping: float = 0.0) -> Equation:
    from .equations.rigid_body import RigidBodyEquation

    return RigidBodyEquation(alpha, tolerance, damping)


def _rigid_body(structure: RockingParameters, tolerance: float) -> Equation:
    return _rigid(
        tuple(side.alpha for side in reversed(structure.sides)) or structure.alpha,
        tolerance,
        structure.damping,
    )


def _mechanism(structure: RockingParameters, tolerance: float) -> Equation:
    from .equations.mechanism import MechanismEquation
    from .equations.two_mechanisms import TwoMechanisms

    found = [
        MechanismEquation(one, tolerance, structure.damping)
        for one in _mechanisms(structure)
    ]
    return TwoMechanisms(found) if structure.sides else found[0]


def _mechanisms(structure: RockingParameters) -> list["Mechanism"]:
    """The mechanisms of a structure, of the right side first."""
    edges: list[Side | RockingParameters] = [*reversed(structure.sides)] or [structure]
    return [edge.mechanism for edge in edges if edge.mechanism is not None]


EQUATIONS = (
    EquationKind(
        "linear", lambda s: True, _linear, lambda s: None, "linear_rates", exact=True
    ),  # Eqs. 2.4 and 3.6
    EquationKind(
        "nonlinear",
        lambda s: s.mechanism is not None,
        _mechanism,
        lambda s: tuple(_mechanisms(s)),
        "mechanism_rates",
    ),  # Eq. 3.4
    EquationKind(  # a rigid body, Eq. 2.3
        "nonlinear",
        lambda s: s.a_scale == 1.0 and not s.dimensionless,
        _rigid_body,
        lambda s: s.alpha,
        "rigid_body_rates",
        of_cells=_rigid,
    ),
)
MODELS = tuple(dict.fromkeys(kind.model for kind in EQUATIONS))


@dataclass(frozen=True)
class Method:
    """The model and the tolerance of a computation. Raises UsageError for an unknown
    model or a tolerance out of range.
    """

    model: str = MODELS[0]  # one of `MODELS`
    tolerance: float = TOLERANCE  # of theta/alpha [-]; an exact model ignores it

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise UsageError(
                f"unknown model {self.model!r}; expected"
                f" {', '.join(MODELS)}{did_you_mean(self.model, MODELS)}"
            )
        try:
            order_for(self.tolerance)
        except ValueError as error:
            raise UsageError(str(error)) from None

    @property
    def exact(self) -> bool:
        """True if the model has no tolerance."""
        return all(kind.exact for kind in EQUATIONS if kind.model == self.model)

    @property
    def stated_tolerance(self) -> float | None:
        """The tolerance, None if the model is exact."""
        return None if self.exact else self.tolerance

    def kind_of(self, structure: RockingParameters) -> EquationKind:
        """The equation of this model for a structure. Raises UsageError if the model
        has none.
        """
        for kind in EQUATIONS:
            if kind.model == self.model and kind.serves(structure):
                return kind
        if structure.dimensionless:
            raise UsageError(
                f"the {self.model} model needs a critical angle: give a structure"
                " document"
            )
        raise UsageError(
            f"{structure.name}: the {self.model} model needs the structure itself (an"
            " arch) or a rigid body, whose a_scale is 1; found parameters with a_scale"
            f" {structure.a_scale:.6g}"
        )

    def serves(self, structure: RockingParameters) -> bool:
        """True if the model has an equation for a structure."""
        return any(
            kind.model == self.model and kind.serves(structure) for kind in EQUATIONS
        )

    def system_of(self, structure: RockingParameters) -> System:
        """Builds the system (equation and contact) of a structure for the march. Raises
        UsageError when the model does not hold for it.
        """
        build = self.kind_of(structure).build
        try:
            equation = build(structure, self.tolerance)
            scale = (
                None if structure.dimensionless else structure.alpha / structure.a_scale
            )
            system = System(
                equation,
                contact_of(structure, equation),
                scale,
                self.body_of(structure),
                springs=any(one.springs for one in _mechanisms(structure)),
            )
            if structure.restraints is None:
                return system
            from .tied.devices import Devices

            devices = Devices.of(
                structure, equation, linear=self.exact, body=system.body
            )
            return (
                system
                if devices is None
                else system._replace(devices=devices, body=None)
            )
        except ValueError as error:
            raise UsageError(f"{structure.name}: {error}") from None

    def system_of_cells(
        self, structures: Sequence[RockingParameters], counts: Sequence[int]
    ) -> System:
        """One system for `counts` cells of each structure, whose `shares` are equal or
        which all mix. Raises UsageError as `system_of`.
        """
        one, of_cells = (
            self.system_of(structures[0]),
            self.kind_of(structures[0]).of_cells,
        )
        if len({(*self.shares(s), self.body_of(s)) for s in structures}) == 1:
            return one
        own = tuple(
            (self.system_of(s), count)
            for s, count in zip(structures, counts, strict=True)
        )
        equation = (
            one.equation
            if of_cells is None
            else of_cells(
                np.repeat([s.alpha for s in structures], counts), self.tolerance
            )
        )
        return one._replace(equation=equation, body=None, own=own)

    def body_of(self, structure: RockingParameters) -> Body | None:
        """The `Body` that gives a structure's forces on the ground; None if its mass
        centre is not known.
        """
        edges: list[Side | RockingParameters] = [*reversed(structure.sides)] or [
            structure
        ]
        kappa = tuple(
            e.arm * e.p**2 / structure.gravity for e in edges if e.arm is not None
        )
        if len(kappa) < len(edges):
            return None
        a_scale = tuple(e.a_scale for e in edges)
        return Body(
            tuple(e.alpha for e in edges),
            kappa,
            self.exact,
            structure.damping,
            structure.one_sided,
            a_scale,
        )

    def shares(self, structure: RockingParameters) -> tuple[Any, ...]:
        """Structures with equal keys have one system; with equal restitutions too, one
        dimensionless computation (sections 3.3, 4).
        """
        return (
            structure.one_sided,
            structure.sides,
            structure.damping,
            structure.restraints,
            self.kind_of(structure).shares(structure),
        )

    def reference_of(self, structure: RockingParameters) -> Reference:
        """A function (motion, A, Omega, eta) that gives (outcome, theta_ratio) by a
        slower solver, which shares no code with the march.
        """
        from .references.general_solver import solve_cell

        return partial(solve_cell, problem=self.problem_of(structure))

    def problem_of(self, structure: RockingParameters) -> "Problem":
        """Builds the problem of a structure for the reference solver."""
        from .references import problems

        return problems.problem_of(
            structure, getattr(problems, self.kind_of(structure).rates)
        )


LINEAR = Method()


def governing_method(
    *structures: RockingParameters,
    model: str | None = None,
    tolerance: float = TOLERANCE,
    dimensionless: bool = False,
) -> Method:
    """The method of a run: the given model; else the nonlinear one if the geometry of
    all structures is known and the motion has units (a_g, f_g, a record); else the
    linear one, which is not safe: a body that Eq. 2.3 overturns may survive. Raises
    UsageError as `Method`.
    """
    nonlinear = Method(MODELS[-1] if model is None else model, tolerance)
    return (
        nonlinear
        if model is not None or (not dimensionless and all(map(_known, structures)))
        else LINEAR
    )


def _known(structure: RockingParameters) -> bool:
    """True if the geometry of a structure is known and there is a nonlinear equation
    for it.
    """
    return structure.structure != "parameters" and Method(MODELS[-1]).serves(structure)


def model_in_words(
    method: Method,
    *structures: RockingParameters,
    model: str | None = None,
    dimensionless: bool = False,
) -> str:
    """The line that names the model of a run; if the model is linear by default, it
    says why. Parameters as of `governing_method`.
    """
    line = f"model: {method.model}"
    if model is not None or method != LINEAR:
        return line
    if dimensionless:
        return f"{line}, on dimensionless axes (A, Omega)"
    stated = [s.name for s in structures if not _known(s)]
    return (
        f"{line}, since the geometry of"
        f" {', '.join(stated[:3])}{' and others' * (len(stated) > 3)} is not known"
    )


def has_direction(structure: RockingParameters) -> bool:
    """True if the reversed motion may have another result: the structure has one side,
    or two sides that differ, or ties that differ.
    """
    return not (
        structure.plain or governing_method(structure).system_of(structure).alike
    )


def direction_in_words(
    *structures: RockingParameters,
    opposite: str = "the other sign of `scale` (1 if not given)",
) -> list[str]:
    """Return the lines for a run that computes one direction of the motion only: one
    that names the structures for which the opposite direction may have another result,
    none without such a structure. opposite: the option that computes the other
    direction.
    """
    names = [s.name for s in structures if has_direction(s)]
    some = f"{', '.join(names[:3])}{' and others' * (len(names) > 3)}"
    return (
        [
            f"one direction of the motion only, though the sides differ: {some};"
            f" {opposite} gives the opposite one"
        ]
        if names
        else []
    )


def contact_of(structure: RockingParameters, equation: Equation) -> Contact:
    """The contact of a structure under an equation."""
    if structure.one_sided:
        return OneSided()
    if not structure.sides:
        return Symmetric()
    left, right = structure.sides
    there = equation.on(np.array([1.0, -1.0]))
    turns, lifts = (
        np.broadcast_to(x, 2).tolist()
        for x in (there.rotation_rate(np.zeros(2), np.ones(2)), there.uplift_amplitude)
    )
    unit = [
        side.alpha * side.p * turn
        for side, turn in zip((right, left), turns, strict=True)
    ]  # theta' of y' = 1
    onto_left, onto_right = reciprocal_ratios(*unit)
    drive = [
        (side.a_scale / side.alpha) / (structure.a_scale / structure.alpha) / x
        for side, x in zip((right, left), lifts, strict=True)
    ]
    return Unequal(
        drive=(drive[0], drive[1]),
        omega=(structure.p / right.p, structure.p / left.p),
        eta=(right.eta * onto_left, left.eta * onto_right),
        rotation=(turns[0], turns[1]),
        equation=None if there.proportional else equation,
        pace=(
            right.alpha * right.p / (structure.alpha * structure.p),
            left.alpha * left.p / (structure.alpha * structure.p),
        ),
    )
