"""Options that several commands share, each defined once, and the structures of a call."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .command import argument, option
from .parameter_types import InputPath, OutputPath, Parsed, Registered, Restitution, limit, model_names
from .printing import below, note

if TYPE_CHECKING:
    from ..dynamics.method import Method
    from ..motions.grid import Grid
    from ..motions.recording import Recording
    from ..structures import RockingParameters
    from .families import Family

FIGURES = (".png", ".svg", ".pdf")
_REMARKS = 3  # printed at most
_RULE = (
    "Equation of motion{both}. Default: nonlinear for a known geometry in units (a_g, f_g, a record), linear on dimensionless axes "
    "(A, Omega) and for stated parameters."
)


def _at_most_the_cpus(_: click.Context, __: click.Parameter, given: int | None) -> int | None:
    from ..processes import available_cpus

    cpus = available_cpus()
    if given is None or given <= cpus:
        return given
    note(f"--workers {given}: reduced to {cpus}, the number of available CPUs")
    return cpus


# Arguments and options that several commands share.
files = partial(argument, nargs=-1, type=InputPath(), metavar="[FILE]...")
output = partial(option, "-o", "--output", type=OutputPath())
overwrite = partial(option, "--overwrite", is_flag=True, help="Replace an output that exists.")
strict = partial(option, "--strict", is_flag=True, help="Refuse data of machines or libraries whose results may differ in the last digits.")
workers = partial(option, "--workers", type=click.IntRange(1), callback=_at_most_the_cpus, help="Processes to use (default: all cores).")
a_max = partial(
    option, "--a-max", type=Parsed("amplitude", limit), default="20", show_default=True, metavar="AMPLITUDE",
    help="Largest amplitude of the search: A, or with a unit a_g, such as 1g.",
)  # fmt: skip
vary = partial(
    option, "--vary", multiple=True, metavar="KEY=START:STOP:N",
    help="Vary this key: a family of structures; repeatable, all combinations.",
)  # fmt: skip
linear_uplift = partial(
    option, "--linear-uplift", type=click.Choice(["alpha", "lambda"]), default="alpha", show_default=True,
    help="Uplift of rigid bodies in the linear equation: alpha g (Eq. 2.4), or lambda g, the true one (a_scale = alpha/lambda, Eq. 3.9).",
)  # fmt: skip


@dataclass(frozen=True)
class Oscillators:
    """Dimensionless oscillators instead of structures."""

    etas: tuple[float | None, ...] = option(
        "--eta", multiple=True, type=Restitution(), metavar="ETA",
        help="A dimensionless oscillator of this restitution instead of FILE; repeatable. With --alpha: that of the blocks, or `block`.",
    )  # fmt: skip


@dataclass(frozen=True)
class Sizeless(Oscillators):
    """Dimensionless oscillators, or blocks of given angles under records, instead of structures."""

    alphas: str | None = option(
        "--alpha", metavar="ANGLES", help="Rigid blocks of these critical angles instead of FILE, such as 10,15,20deg (records)."
    )


@dataclass(frozen=True)
class Model:
    """The equation of motion of a run; `model` None: the governing equation."""

    model: str | None = option("--model", type=Registered(model_names), help=_RULE.format(both=""))
    tolerance: float = option("--tolerance", type=float, default=1e-9, show_default=True, help="Error of theta/alpha aimed at (nonlinear).")

    @property
    def models(self) -> tuple[str | None, ...]:
        """The equations that are asked for, (None,) for that of the rule."""
        return (self.model,)

    def methods(self, structures: Sequence[RockingParameters], dimensionless: bool = False) -> list[Method]:
        """The method of each requested equation. Raises UsageError."""
        from ..dynamics.method import governing_method

        return [governing_method(*structures, model=one, tolerance=self.tolerance, dimensionless=dimensionless) for one in self.models]

    def in_words(self, methods: Sequence[Method], structures: Sequence[RockingParameters], dimensionless: bool = False) -> list[str]:
        """The line that names each equation."""
        from ..dynamics.method import model_in_words

        pairs = zip(methods, self.models, strict=True)
        return [model_in_words(method, *structures, model=model, dimensionless=dimensionless) for method, model in pairs]


@dataclass(frozen=True)
class Models(Model):
    """The equation of motion of a run, or both."""

    model: str | None = option(
        "--model", type=Registered(lambda: (*model_names(), "both")), help=_RULE.format(both=", or both")
    )  # fmt: skip

    @property
    def models(self) -> tuple[str | None, ...]:
        """The equations that are asked for, (None,) for that of the rule."""
        from ..dynamics.method import MODELS

        return MODELS if self.model == "both" else (self.model,)


@dataclass(frozen=True)
class Equations(Models):
    """The equation of motion of a run, or both, and the uplift of the linear one."""

    linear_uplift: str = linear_uplift()

    @property
    def models(self) -> tuple[str | None, ...]:
        """The requested equations, (None,) for the governing one; --linear-uplift lambda requests the linear one."""
        return ("linear",) if self.model is None and self.linear_uplift == "lambda" else super().models

    def lifting(self, structures: list[RockingParameters]) -> list[RockingParameters]:
        """The structures with the requested uplift. Raises click.UsageError for another equation, or without structures."""
        if self.linear_uplift == "lambda" and not structures:
            raise click.UsageError("--linear-uplift lambda goes with structures: give FILE")
        if self.linear_uplift == "lambda" and self.models != ("linear",):
            raise click.UsageError("--linear-uplift lambda goes with --model linear; the nonlinear equation lifts at lambda anyway")
        return lifting(structures, self.linear_uplift)


def lifting(structures: list[RockingParameters], linear_uplift: str) -> list[RockingParameters]:
    """The structures with the uplift of --linear-uplift."""
    return [structure.lifting_at_lambda() for structure in structures] if linear_uplift == "lambda" else structures


def structures_of(files: tuple[str, ...], etas: tuple[float | None, ...] = ()) -> list[RockingParameters]:
    """The structures of the given documents and the dimensionless oscillators of the given restitutions."""
    return structures_and_texts(files, etas)[0]


def structures_and_texts(files: tuple[str, ...], etas: tuple[float | None, ...] = ()) -> tuple[list[RockingParameters], str]:
    """The structures, and the text of their documents."""
    from ..structures import build_structure, with_distinct_names
    from ..structures.parameters import dimensionless_oscillator

    documents = [] if etas and not files else documents_of(files)
    if None in etas:
        raise click.UsageError("--eta block goes with --alpha")
    structures = [build_structure(document) for document in documents]
    try:
        oscillators = [dimensionless_oscillator(eta) for eta in etas if eta is not None]
    except ValueError as error:
        raise click.UsageError(f"--eta: {error}") from None
    found = with_distinct_names([*structures, *oscillators])
    remark_on(found)
    return found, "\n---\n".join(d.text for d in documents)


def members_of(files: tuple[str, ...], vary: tuple[str, ...], etas: tuple[float | None, ...] = ()) -> Family:
    """The structures of `structures_of`, or the families of --vary with the columns of their varied values."""
    if not vary:
        return structures_of(files, etas), {}, 0
    from .families import families

    if etas:
        raise click.UsageError("--vary goes with FILE, not with --eta")
    return families(documents_of(files), vary)


def documents_of(files: tuple[str, ...], most: int | None = None, place: str = "") -> list[Any]:
    """The structure documents of the files, up to `most` in a `place`. Raises click.UsageError."""
    from ..structures import read_documents

    if not files:
        sizeless = any(parameter.name == "etas" for parameter in click.get_current_context().command.params)
        instead = ", or --eta with a dimensionless grid" if sizeless else ""
        raise click.UsageError(f"no structure: give FILE (- for standard input){instead}")
    found = [document for path in files for document in read_documents(path)]
    if most is not None and len(found) > most:
        raise click.UsageError(f"found {len(found)} structures; up to {most} fit {place}")
    return found


def remark_on(structures: Iterable[RockingParameters] = (), grid: Grid | None = None, spans: str = "") -> None:
    """Print up to three remarks on unusual structures, amplitudes and spans."""
    from ..reports.plausibility import bare_remarks, grid_remarks, span_remarks, structure_remarks

    remarks = [remark for one in structures for remark in structure_remarks(one)] + ([] if grid is None else list(grid_remarks(grid)))
    remarks += [*span_remarks(spans), *bare_remarks(spans)]
    for remark in remarks[:_REMARKS]:
        below(remark)
    if len(remarks) > _REMARKS:
        below(f"and {len(remarks) - _REMARKS} more such remarks")


def refuse_own_input(output: Path, recordings: Sequence[Recording] = ()) -> None:
    """Raise click.UsageError if the output is a document or a record of this call, which --overwrite would destroy."""
    context = click.get_current_context()
    sources = [recording.record.source for recording in recordings]
    for parameter in context.command.params:
        if isinstance(parameter.type, InputPath):
            given = context.params[parameter.name or ""] or ()
            sources += [given] if isinstance(given, str) else given
    for source in sources:
        if os.path.isfile(source) and output.is_file() and os.path.samefile(source, output):
            raise click.UsageError(f"{output} is an input of this call; give another output")
