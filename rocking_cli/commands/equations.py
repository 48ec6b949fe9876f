"""The options of the equation of motion of a run, and of dimensionless oscillators in
place of structures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import click

from .command import option
from .parameter_types import NUMBER, Parsed, Registered, restitution

if TYPE_CHECKING:
    from ..dynamics.method import Method
    from ..structures import RockingParameters

_MODELS = "dynamics.method.MODELS"
_RULE = (
    "Equation of motion{both}. Default: nonlinear for a known geometry in units (a_g,"
    " f_g, a record), linear on dimensionless axes (A, Omega) and for stated"
    " parameters."
)

_UPLIFT = (
    "Uplift of rigid bodies in the linear equation: alpha g (Eq. 2.4), or the true"
    " lambda g (a_scale = alpha/lambda, Eq. 3.9)."
)
linear_uplift = partial(
    option,
    "--linear-uplift",
    _UPLIFT,
    type=click.Choice(["alpha", "lambda"]),
    default="alpha",
)

_ETA = (
    "A dimensionless oscillator of this restitution instead of FILE; repeatable. With"
    " --alpha: that of the blocks, or `block`."
)


@dataclass(frozen=True)
class Oscillators:
    """Dimensionless oscillators instead of structures."""

    etas: tuple[float | None, ...] = option(
        "--eta", _ETA, multiple=True, type=Parsed("restitution", restitution)
    )


@dataclass(frozen=True)
class Sizeless(Oscillators):
    """Dimensionless oscillators, or blocks of given angles under records, instead of
    structures.
    """

    alphas: str | None = option(
        "--alpha",
        "Blocks of these critical angles instead of FILE (records): 10,15,20deg.",
        metavar="ANGLES",
    )


@dataclass(frozen=True)
class Model:
    """The option --model of a command with one equation; `model` None: the governing
    equation.
    """

    model: str | None = option(
        "--model", _RULE.format(both=""), type=Registered(_MODELS)
    )
    tolerance: float = option(
        "--tolerance",
        "Error of theta/alpha that the nonlinear equation aims at.",
        type=NUMBER,
        default=1e-9,
    )

    @property
    def models(self) -> tuple[str | None, ...]:
        """The requested equations; (None,) lets `governing_method` choose one."""
        return (self.model,)

    def methods(
        self, structures: Sequence[RockingParameters], dimensionless: bool = False
    ) -> list[Method]:
        """Return the method of each requested equation. Raises UsageError."""
        from ..dynamics.method import governing_method

        return [
            governing_method(
                *structures,
                model=one,
                tolerance=self.tolerance,
                dimensionless=dimensionless,
            )
            for one in self.models
        ]

    def in_words(
        self,
        methods: Sequence[Method],
        structures: Sequence[RockingParameters],
        dimensionless: bool = False,
    ) -> list[str]:
        """Return the lines that name the equations."""
        from ..reports.remarks import model_in_words

        pairs = zip(methods, self.models, strict=True)
        return [
            model_in_words(
                method, *structures, model=model, dimensionless=dimensionless
            )
            for method, model in pairs
        ]


@dataclass(frozen=True)
class Models(Model):
    """The option --model of a command that can use both equations."""

    model: str | None = option(
        "--model", _RULE.format(both=", or both"), type=Registered(_MODELS, "both")
    )

    @property
    def models(self) -> tuple[str | None, ...]:
        from ..dynamics.method import MODELS

        return MODELS if self.model == "both" else (self.model,)


@dataclass(frozen=True)
class Equations(Models):
    """The options that choose the equation of motion (linear, nonlinear or both) and
    the uplift of the linear equation.
    """

    linear_uplift: str = linear_uplift()

    @property
    def models(self) -> tuple[str | None, ...]:
        return (
            ("linear",)
            if self.model is None and self.linear_uplift == "lambda"
            else super().models
        )

    def lifting(
        self, structures: Sequence[RockingParameters]
    ) -> list[RockingParameters]:
        """Return the structures with the requested uplift. Raises click.UsageError."""
        if self.linear_uplift == "lambda" and not structures:
            raise click.UsageError(
                "--linear-uplift lambda goes with structures: give FILE"
            )
        if self.linear_uplift == "lambda" and self.models != ("linear",):
            raise click.UsageError(
                "--linear-uplift lambda goes with --model linear; the nonlinear"
                " equation lifts at lambda anyway"
            )
        return [lifted(structure, self.linear_uplift) for structure in structures]


def lifted(structure: RockingParameters, linear_uplift: str) -> RockingParameters:
    """Return the structure, with a_scale = alpha/lambda if --linear-uplift is
    `lambda`.
    """
    return structure.lifting_at_lambda() if linear_uplift == "lambda" else structure
