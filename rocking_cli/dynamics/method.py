"""Chooses equation, contact and reference solver for a structure; a new equation is one
entry of EQUATIONS, imported where it is used.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..errors import ArgumentError, StructureError, UsageError, did_you_mean
from ..structures.parameters import RockingParameters
from .body import Body
from .contacts.contact import (
    Contact,
    OneSided,
    Symmetric,
    Unequal,
    reciprocal_ratios,
)
from .equations.equation import Equation
from .equations.taylor import order_for
from .system import System

if TYPE_CHECKING:
    from ..motions.motion import Motion
    from ..structures.mechanics.linkage import Linkage
    from .outcome import Outcome
    from .references.general_solver import Problem

TOLERANCE = 1e-9
CHECKED_BY = "an independent solver"  # the slower one of `reference_of`
Reference = Callable[["Motion", float, float], tuple["Outcome", float]]


class EquationKind(NamedTuple):
    """An equation of motion in the registry."""

    model: str  # the word of `--model` and of files
    # returns True for a structure for which the equation holds
    serves: Callable[[RockingParameters], bool]
    # returns the equation of a structure at a tolerance, raises ArgumentError
    build: Callable[[RockingParameters, float], Equation]
    rates: str  # name of its form in `references.problems`
    exact: bool = False  # True if its tolerance is 1e-12, near rounding, always


def _linear(structure: RockingParameters, tolerance: float) -> Equation:
    from .equations.linear import LinearEquation

    return LinearEquation(structure.damping)


def _rigid_body(structure: RockingParameters, tolerance: float) -> Equation:
    from .equations.rigid_body import RigidBodyEquation

    alphas: Any = tuple(edge.alpha for edge in structure.edges)
    return RigidBodyEquation(
        alphas if structure.sides else structure.alpha, tolerance, structure.damping
    )


def _mechanism(structure: RockingParameters, tolerance: float) -> Equation:
    from .equations.mechanism import MechanismEquation
    from .equations.two_mechanisms import TwoMechanisms

    found = [
        MechanismEquation(one, tolerance, structure.damping)
        for one in _mechanisms(structure)
    ]
    return TwoMechanisms(found) if structure.sides else found[0]


def _mechanisms(structure: RockingParameters) -> list["Linkage"]:
    """The mechanisms of a structure, of the right side first."""
    return [edge.mechanism for edge in structure.edges if edge.mechanism is not None]


EQUATIONS = (
    EquationKind(  # Eqs. 2.4 and 3.6
        "linear", lambda s: True, _linear, "linear_rates", exact=True
    ),
    EquationKind(  # a mechanism of several pieces, Eq. 3.4
        "nonlinear",
        lambda s: s.mechanism is not None,
        _mechanism,
        "mechanism_rates",
    ),
    EquationKind(  # a rigid body, Eq. 2.3
        "nonlinear",
        lambda s: s.a_scale == 1.0 and not s.dimensionless,
        _rigid_body,
        "rigid_body_rates",
    ),
)
MODELS = tuple(dict.fromkeys(kind.model for kind in EQUATIONS))


@dataclass(frozen=True)
class Method:
    """The equation of motion and the tolerance of a computation.

    "linear" is Eqs. 2.4 and 3.6, always to 1e-12 of theta/alpha; "nonlinear" is Eq. 2.3
    of a rigid body or Eq. 3.4 of a mechanism. Functions that take a method choose one
    themselves if it is None. `system_of` makes the `System` for `response` and
    `history`; `serves` tells whether the model has an equation for a structure. Raises
    UsageError for an unknown model or a tolerance out of range.

    Attributes
    ----------
    model: "linear" or "nonlinear"
    tolerance: of theta/alpha [-], from 1e-13 to 1e-2; "linear" ignores it

    Examples
    --------
    >>> (column,) = load_structures("configs/block.yaml")
    >>> system = Method("nonlinear", tolerance=1e-10).system_of(column)
    >>> found = response(system, sine(), 1.5, 6.0)
    >>> f"{float(found.theta_ratio):.6f}"
    '0.156450'
    >>> Method().exact, Method("nonlinear").serves(dimensionless_oscillator(eta=0.9))
    (True, False)
    """

    model: str = MODELS[0]  # one of `MODELS`
    tolerance: float = TOLERANCE  # of theta/alpha [-]; "linear" ignores it

    @classmethod
    def of(cls, given: "Method | str") -> "Method":
        """Return a method, or that of a model with the usual tolerance.

        Parameters
        ----------
        given
            a method, "linear" or "nonlinear"

        Returns
        -------
        Method
        """
        return given if isinstance(given, Method) else cls(given)

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise UsageError(
                f"unknown model {self.model!r}; expected"
                f" {', '.join(MODELS)}{did_you_mean(self.model, MODELS)}"
            )
        try:
            order_for(self.tolerance)
        except ArgumentError as error:
            raise UsageError(str(error)) from None

    @property
    def exact(self) -> bool:
        """True if the model ignores the tolerance: its series hold to 1e-12."""
        return all(kind.exact for kind in EQUATIONS if kind.model == self.model)

    @property
    def stated_tolerance(self) -> float | None:
        """The tolerance, None if the model ignores it."""
        return None if self.exact else self.tolerance

    def kind_of(self, structure: RockingParameters) -> EquationKind:
        """Return the equation of this model for a structure.

        Parameters
        ----------
        structure
            the structure

        Returns
        -------
        EquationKind

        Raises
        ------
        UsageError
            if the model has none for this structure
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
        """True if the model has an equation for a structure.

        Parameters
        ----------
        structure
            the structure

        Returns
        -------
        bool
        """
        return any(
            kind.model == self.model and kind.serves(structure) for kind in EQUATIONS
        )

    def system_of(self, structure: RockingParameters) -> System:
        """Return the system of a structure: its equation of motion on its contact.

        Parameters
        ----------
        structure
            the structure

        Returns
        -------
        System

        Raises
        ------
        UsageError
            if the model does not hold for the structure
        """
        if structure.building:
            raise UsageError(
                f"{structure.name} stands in a building, the motion of whose floor is"
                " not known here; expected a document without the key building, or"
                " check, response, solve, compare or report"
            )
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
        except (ArgumentError, StructureError) as error:
            raise UsageError(f"{structure.name}: {error}") from None

    def body_of(self, structure: RockingParameters) -> Body | None:
        """Return what gives the forces of a structure on the ground.

        Parameters
        ----------
        structure
            the structure

        Returns
        -------
        Body or None
            None if the mass centre of the structure is not known
        """
        edges = structure.edges
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

    def reference_of(self, structure: RockingParameters) -> Reference:
        """Return a slower solver of a structure, which shares no code with the march.

        Parameters
        ----------
        structure
            the structure

        Returns
        -------
        function
            of (motion, A, Omega), which returns (outcome, theta_ratio)

        Raises
        ------
        UsageError
            if the model does not hold for the structure
        """
        from .references.general_solver import solve_cell

        return partial(solve_cell, problem=self.problem_of(structure))

    def problem_of(self, structure: RockingParameters) -> "Problem":
        """Return the problem of a structure for the reference solver.

        Parameters
        ----------
        structure
            the structure

        Returns
        -------
        Problem

        Raises
        ------
        UsageError
            if the model does not hold for the structure
        """
        from .references import problems

        return problems.problem_of(
            structure, getattr(problems, self.kind_of(structure).rates)
        )


LINEAR = Method()


def methods_of(given: Method | str | Sequence[Method | str]) -> list[Method]:
    """Return the methods of one or several, each itself or its model. Raises
    UsageError for an unknown model.
    """
    if isinstance(given, Method | str):
        return [Method.of(given)]
    return [Method.of(one) for one in given]


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
        if model is not None
        or (not dimensionless and all(map(geometry_known, structures)))
        else LINEAR
    )


def geometry_known(structure: RockingParameters) -> bool:
    """True if the geometry of a structure is known and there is a nonlinear equation
    for it.
    """
    return structure.structure != "parameters" and Method(MODELS[-1]).serves(structure)


def joined(equations: Sequence[Equation]) -> Equation:
    """Return the equation of several edges, each as `Equation.edge` returns it: `on`
    takes their numbers as cells.
    """
    first, *others = equations
    if not first.composed:
        return first.joined(others)
    from .equations.two_mechanisms import TwoMechanisms

    return TwoMechanisms.of_cells(equations)


def has_direction(structure: RockingParameters) -> bool:
    """True if the reversed motion may have another result: the structure has one side,
    or two sides that differ, or ties that differ.
    """
    if structure.plain:
        return False
    body = replace(structure, building=())  # the floor moves all bodies alike
    return not governing_method(body).system_of(body).alike


def contact_of(structure: RockingParameters, equation: Equation) -> Contact:
    """The contact of a structure under an equation."""
    if structure.one_sided:
        return OneSided(structure.eta)
    if not structure.sides:
        return Symmetric(structure.eta)
    left, right = structure.sides
    both = equation.on(np.array([1.0, -1.0]))
    turns, lifts = (
        np.broadcast_to(x, 2).tolist()
        for x in (both.rotation_rate(np.zeros(2), np.ones(2)), both.uplift_amplitude)
    )
    # speed of rotation theta' of each side for y' = 1
    unit = [
        side.alpha * side.p * turn
        for side, turn in zip((right, left), turns, strict=True)
    ]
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
        # converts y between edges if |theta| is no constant times y
        equation=None if both.rotation_proportional else equation,
        pace=(
            right.alpha * right.p / (structure.alpha * structure.p),
            left.alpha * left.p / (structure.alpha * structure.p),
        ),
    )
