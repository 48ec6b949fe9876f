"""Options that several commands share, each defined once so that it means the same everywhere."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import UsageError
from . import streams
from .parameter_types import InputPath, LimitType, OutputPath, Registered, Restitution, model_names
from .terms import in_options

if TYPE_CHECKING:
    from ..dynamics.method import Method
    from ..motions.grid import Grid
    from ..motions.motion import Motion
    from ..motions.recording import Recording
    from ..reports.units import Units
    from ..structures import RockingParameters

F = Callable[..., Any]


a_max = click.option(
    "--a-max", type=LimitType(), default="20", show_default=True, metavar="AMPLITUDE",
    help="Largest amplitude that is searched: A, or with a unit a_g, such as 1g.",
)  # fmt: skip


files = click.argument("files", nargs=-1, type=InputPath(), metavar="[FILE]...")
json_output = click.option("--json", "form", flag_value="json", help="JSON Lines on standard output.")
csv_output = click.option("--csv", "form", flag_value="csv", help="CSV on standard output.")
quiet = click.option("-q", "--quiet", is_flag=True, help="No progress and no summary on standard error.")
output = click.option("-o", "--output", required=True, type=OutputPath(), help="The HDF5 file to write.")
overwrite = click.option("--overwrite", is_flag=True, help="Replace an output that exists.")
FIGURES = (".png", ".svg", ".pdf")
strict = click.option("--strict", is_flag=True, help="Refuse data of a machine or of libraries that may differ in the last digits.")
workers = click.option("--workers", type=click.IntRange(1), help="Processes to use (default: all cores).")
eta = click.option(
    "--eta", "etas", multiple=True, type=Restitution(), metavar="ETA",
    help="A dimensionless oscillator of this restitution instead of FILE; repeatable. Over --alpha that of the blocks, or `block`.",
)  # fmt: skip
alpha = click.option(
    "--alpha", "alphas", metavar="ANGLES", help="Rigid blocks of these critical angles instead of FILE, such as 10,15,20deg (records)."
)


def given(context: click.Context, name: str) -> bool:
    """Whether the user gave this option."""
    return context.get_parameter_source(name) is not click.core.ParameterSource.DEFAULT


tolerance = click.option("--tolerance", type=float, default=1e-9, show_default=True, help="Error of theta/alpha aimed at (nonlinear).")


_RULE = (
    "Equation of motion{both}. Default: nonlinear for a known geometry in units (a_g, f_g, a record), linear on dimensionless axes "
    "(A, Omega) and for stated parameters."
)


def method(command: F) -> F:
    """--model and --tolerance; the command gets None for the equation of the rule."""
    model = click.option("--model", type=Registered(model_names), help=_RULE.format(both=""))
    return model(tolerance(command))


def methods(command: F) -> F:
    """--model, which may be both, and --tolerance; the command gets `models`, (None,) for the equation of the rule."""

    @wraps(command)
    def with_models(*arguments: Any, model: str | None, **others: Any) -> Any:
        from ..dynamics.method import MODELS

        if model is None and others.get("linear_uplift") == "lambda":
            model = "linear"
        return command(*arguments, models=MODELS if model == "both" else (model,), **others)

    words = Registered(lambda: (*model_names(), "both"))
    model = click.option("--model", type=words, help=_RULE.format(both=", or both"))
    return model(tolerance(with_models))


def note_demand(shakes: Sequence[tuple[Motion, Grid]], quiet: bool) -> None:
    """Say how strong the shaking is that is asked for, with the acceleration in m/s2 and g."""
    from ..motions.grid import demand_in_words
    from ..reports.plausibility import bare_remarks

    note(f"demand: {demand_in_words(shakes)}", quiet)
    asked = click.get_current_context().params
    for remark in bare_remarks(f"a_g={asked['a_g']}" if asked["a_g"] else asked.get("scale_to") or ""):
        note(remark, quiet)


def note_governing(structures: Iterable[RockingParameters], dimensionless: bool, quiet: bool) -> None:
    """Say which equation answers for each structure by itself."""
    from ..dynamics.method import governing_method, model_in_words

    for line in dict.fromkeys(
        model_in_words(governing_method(one, dimensionless=dimensionless), one, dimensionless=dimensionless) for one in structures
    ):
        note(line, quiet)


def note_models(
    methods: Iterable[Method], structures: Sequence[RockingParameters], models: Iterable[str | None], dimensionless: bool, quiet: bool
) -> None:
    """Say which equation a run takes."""
    from ..dynamics.method import model_in_words

    for method, model in zip(methods, models, strict=True):
        note(model_in_words(method, *structures, model=model, dimensionless=dimensionless), quiet)


linear_uplift = click.option(
    "--linear-uplift", type=click.Choice(["alpha", "lambda"]), default="alpha", show_default=True,
    help="Of rigid bodies by the linear equation: at alpha (Eq. 2.4), or at lambda g as the body does (a_scale = alpha/lambda, Eq. 3.9).",
)  # fmt: skip


def lifting(structures: list[RockingParameters], linear_uplift: str, models: Sequence[str | None]) -> list[RockingParameters]:
    """The structures as --linear-uplift has them. Raises click.UsageError where another equation than the linear one is wanted, or
    there is none."""
    if linear_uplift != "lambda":
        return structures
    if not structures:
        raise click.UsageError("--linear-uplift lambda goes with structures: give FILE")
    if tuple(models) != ("linear",):
        raise click.UsageError("--linear-uplift lambda goes with --model linear: the nonlinear equation lifts at lambda by itself")
    return [structure.lifting_at_lambda() for structure in structures]


def time(flag: str, text: str) -> float:
    """A time in s, bare or with a unit. Raises UsageError."""
    from ..documents.quantities import parse_quantity

    try:
        return parse_quantity(text, "time")
    except ValueError as error:
        raise UsageError(f"{flag}: found {text!r}; accepted is {error}") from None


def _keep_units(context: click.Context, _: click.Parameter, text: str | None) -> None:
    if text is not None:
        from ..reports.units import parse_units

        context.meta[_UNITS] = parse_units(text)


def units_of() -> Units | None:
    """What --units of this call says, None without it."""
    return click.get_current_context().meta.get(_UNITS)


_UNITS = f"{__name__}.units"
units = click.option(
    "--units", metavar="UNIT,…", expose_value=False, callback=_keep_units,
    help="Units of tables, CSV and figures, such as g,Hz,deg or cm (JSON and HDF5 are in SI).",
)  # fmt: skip


def output_form(command: F) -> F:
    """--json and --csv, without either a table for people; --units of the latter two."""
    return json_output(csv_output(units(command)))


def emit(
    records: Iterable[Mapping[str, Any]], form: str | None, columns: Sequence[str] = (), *, table_units: str | None = None,
    without: Sequence[str] = (),
) -> None:  # fmt: skip
    """Records on standard output, each as soon as it is there; columns: the CSV header where there is no record; table_units: of a table
    where --units does not say; without: columns that have no unit of their own here."""
    from ..reports.tables import lines
    from ..reports.units import Units, parse_units

    units = units_of()
    if units is None and form is None and table_units is not None:
        units = parse_units(table_units)
    if without:
        units = replace(units or Units(), without=frozenset(without))
    for line in lines(records, form or "table", columns, encoding=sys.stdout.encoding, units=units):
        streams.put(line)


def at_most_the_cpus(workers: int | None, quiet: bool) -> int | None:
    """The processes that --workers comes to: more than there are CPUs to use only get into each other's way, as a line says."""
    from ..processes import available_cpus

    cpus = available_cpus()
    if workers is None or workers <= cpus:
        return workers
    note(f"--workers {workers}: reduced to {cpus}, the CPUs that may be used here", quiet)
    return cpus


def structures_of(files: tuple[str, ...], etas: tuple[float | None, ...] = ()) -> list[RockingParameters]:
    """The structures of the given documents and the dimensionless oscillators of the given restitutions."""
    return structures_and_texts(files, etas)[0]


def structures_and_texts(files: tuple[str, ...], etas: tuple[float | None, ...] = ()) -> tuple[list[RockingParameters], str]:
    """The structures, and the text of their documents."""
    from ..structures import build_structure, read_documents, with_distinct_names
    from ..structures.parameters import dimensionless_oscillator

    if not files and not etas:
        sizeless = any(parameter.name == "etas" for parameter in click.get_current_context().command.params)
        instead = ", or --eta with a dimensionless grid" if sizeless else ""
        raise click.UsageError(f"no structure: give FILE (- for standard input){instead}")
    if None in etas:
        raise click.UsageError("--eta block goes with --alpha")
    documents = [document for path in files for document in read_documents(path)]
    structures = [build_structure(document) for document in documents]
    try:
        oscillators = [dimensionless_oscillator(eta) for eta in etas if eta is not None]
    except ValueError as error:
        raise click.UsageError(f"--eta: {error}") from None
    found = with_distinct_names([*structures, *oscillators])
    remark_on(found)
    return found, "\n---\n".join(d.text for d in documents)


def remark_on(structures: Iterable[RockingParameters] = (), grid: Grid | None = None, spans: str = "") -> None:
    """Say on standard error what is odd about structures, amplitudes and spans as they are written, up to three lines of it."""
    from ..reports.plausibility import bare_remarks, grid_remarks, span_remarks, structure_remarks

    remarks = [remark for one in structures for remark in structure_remarks(one)] + ([] if grid is None else list(grid_remarks(grid)))
    remarks += [*span_remarks(spans), *bare_remarks(spans)]
    quiet = click.get_current_context().params.get("quiet", False)
    for remark in remarks[:_REMARKS]:
        note(remark, quiet)
    if len(remarks) > _REMARKS:
        note(f"and {len(remarks) - _REMARKS} more such remarks", quiet)


_REMARKS = 3


def part_of(text: str) -> tuple[int, int]:
    """(I, N) of --shard. Raises UsageError."""
    from ..documents.quantities import parse_whole

    part, count = (parse_whole(x) for x in text.partition("/")[::2])
    if part is None or count is None or not 1 <= part <= count <= 1_000_000:
        raise click.UsageError(f"--shard: found {text!r}; accepted is I/N with I from 1 to N, such as 2/8")
    return part, count


def refuse_own_input(output: Path, recordings: Sequence[Recording] = ()) -> None:
    """Refuse an output that is a document or a record of this very call: --overwrite would destroy it. Raises UsageError."""
    context = click.get_current_context()
    sources = [recording.record.source for recording in recordings]
    for parameter in context.command.params:
        if isinstance(parameter.type, InputPath):
            given = context.params[parameter.name or ""] or ()
            sources += [given] if isinstance(given, str) else given
    for source in sources:
        if os.path.isfile(source) and output.is_file() and os.path.samefile(source, output):
            raise click.UsageError(f"{output} is an input of this very call; give another output")


def now() -> str:
    """The time in UTC as the history of a file states it."""
    from datetime import UTC, datetime

    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def note(text: str, quiet: bool) -> None:
    """A line on standard error, unless --quiet."""
    if not quiet:
        context = click.get_current_context(silent=True)
        streams.say(text if context is None else in_options(text, context.command))
