"""Options that several commands share, each defined once so that it means the same everywhere."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import RockingError, UsageError
from . import streams
from .parameter_types import InputPath, LimitType, OutputPath, PulseOrPath, Registered, Restitution, model_names, pulse_names
from .terms import in_options

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.recording import Recording
    from ..reports.units import Units
    from ..spectra.grid import Grid
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
strict = click.option("--strict", is_flag=True, help="Refuse data of a machine or of libraries that may differ in the last digits.")
workers = click.option("--workers", type=click.IntRange(1), help="Processes to use (default: all cores).")
pulse = click.option("--pulse", type=Registered(pulse_names), help="Ground motion (default: sine); see `rocking help motions`.")
cycles = click.option("--cycles", type=float, help="Cycles of a sine or cosine, in half cycles (default 1).")
gamma = click.option("--gamma", type=float, help="Duration over period of a mavroeidis-papageorgiou pulse (default 2).")
phase = click.option("--phase", metavar="ANGLE", help="Phase of a mavroeidis-papageorgiou pulse, in rad or with a unit (default 0).")
motion_file = click.option(
    "--motion", "motion_file", type=InputPath(), metavar="FILE", help="A record, or a motion document, instead of a pulse."
)
motion_files = click.option(
    "--motion", "motion_files", multiple=True, type=InputPath(), metavar="FILE...",
    help="Records, a directory or a list of them, or one motion document, instead of a pulse; repeatable.",
)  # fmt: skip
scale = click.option("--scale", type=float, metavar="FACTOR", help="Factor of the motion; a negative one turns it over.")
scale_to = click.option("--scale-to", metavar="IM=VALUE", help="Scale a record to an intensity measure, such as PGA=0.35g.")
component = click.option("--component", metavar="NAME", help="The component of a record that holds several, by name or number.")
unit = click.option("--unit", metavar="UNIT", help="Unit of a record in plain columns of numbers, such as g or m/s2.")
dt = click.option("--dt", metavar="TIME", help="Time between the values of a record in a single column.")
eta = click.option(
    "--eta", "etas", multiple=True, type=Restitution(), metavar="ETA",
    help="A dimensionless oscillator of this restitution instead of FILE; repeatable. Over --alpha that of the blocks, or `block`.",
)  # fmt: skip
alpha = click.option(
    "--alpha", "alphas", metavar="ANGLES", help="Rigid blocks of these critical angles instead of FILE, such as 10,15,20deg (records)."
)


def method(command: F) -> F:
    """--model and --tolerance."""
    model = click.option("--model", type=Registered(model_names), default="linear", show_default=True, help="Equation of motion.")
    tolerance = click.option("--tolerance", type=float, default=1e-9, show_default=True, help="Error of theta/alpha aimed at (nonlinear).")
    return model(tolerance(command))


def methods(command: F) -> F:
    """--model, which may be both, and --tolerance; the command gets `models`."""

    @wraps(command)
    def with_models(*arguments: Any, model: str, **others: Any) -> Any:
        from ..dynamics.method import MODELS

        return command(*arguments, models=MODELS if model == "both" else (model,), **others)

    words = Registered(lambda: (*model_names(), "both"))
    model = click.option("--model", type=words, default="linear", show_default=True, help="Equation of motion, or both.")
    tolerance = click.option("--tolerance", type=float, default=1e-9, show_default=True, help="Error of theta/alpha aimed at (nonlinear).")
    return model(tolerance(with_models))


linear_uplift = click.option(
    "--linear-uplift", type=click.Choice(["alpha", "lambda"]), default="alpha", show_default=True,
    help="Of rigid bodies by the linear equation: at alpha (Eq. 2.4), or at lambda g as the body does (a_scale = alpha/lambda, Eq. 3.9).",
)  # fmt: skip


def lifting(structures: list[RockingParameters], linear_uplift: str, models: Sequence[str] = ("linear",)) -> list[RockingParameters]:
    """The structures as --linear-uplift has them. Raises click.UsageError where another equation than the linear one is wanted."""
    if linear_uplift != "lambda":
        return structures
    if tuple(models) != ("linear",):
        raise click.UsageError("--linear-uplift lambda goes with --model linear: the nonlinear equation lifts at lambda by itself")
    return [structure.lifting_at_lambda() for structure in structures]


def shaking(command: F) -> F:
    """One amplitude and one frequency, with units or dimensionless; the command gets a grid of one cell, None without any.

    A record has both; only its peak may be given anew. Of a set of records there is no grid unless it is.
    """

    @wraps(command)
    def with_shaking(*arguments: Any, **given: Any) -> Any:
        from ..spectra.grid import parse_grid

        own = given["motion"].acceleration if given.get("motion") is not None else None
        records = bool(given.get("recordings"))
        flags = {"a_g": "--a-g", "omega_g": "--omega-g", "f_g": "--f-g", "T_g": "--T-g", "A": "--A", "Omega": "--Omega"}
        axes = {key: given.pop(key.lower() if key in ("A", "Omega", "T_g") else key) for key in flags}
        there = {key: value for key, value in axes.items() if value is not None}
        if there.get("a_g", "").startswith("-") and given.get("motion") is not None:
            given["motion"], there["a_g"] = given["motion"].scaled(-1.0), there["a_g"][1:]  # the same motion turned over
        grid = None
        if own is not None and not there:
            there = {"a_g": f"{own!r} m/s2"}
        for key, value in there.items():
            if "," in value:
                raise click.UsageError(f"{flags[key]}: found {value!r}; accepted is one value")
        if there:
            try:
                grid = parse_grid(",".join(f"{key}={value}" for key, value in there.items()), own_time=own is not None or records)
            except UsageError as error:
                text = str(error).replace("`grid`: ", "")  # the axes are options of their own here
                raise UsageError(re.sub(r"`grid` (\w+):", r"`\1`:", text)) from None
            if grid.shape != (1, 1):
                raise UsageError(f"found {' '.join(f'{flags[k]} {v}' for k, v in there.items())}; accepted is one value of each")
        remark_on(grid=grid)
        return command(*arguments, shaking=grid, **given)

    for name, meaning in (
        ("--Omega", "Dimensionless frequency omega_g/p."),
        ("--A", "Dimensionless amplitude a_scale a_g/(alpha g)."),
        ("--T-g", "Its period in s, the duration t_p of a rectangular pulse."),
        ("--f-g", "Its frequency in Hz."),
        ("--omega-g", "Angular frequency of the motion, rad/s."),
        ("--a-g", "Amplitude of the ground acceleration, m/s2 or with g; a negative one turns the motion over."),
    ):
        with_shaking = click.option(name, metavar="VALUE", help=meaning)(with_shaking)
    return with_shaking


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


def motion(command: F | None = None, *, dt_flag: str = "--dt") -> F:
    """The options of the ground motion; the command gets the motion itself. dt_flag: where the command has a --dt of its own."""
    if command is None:
        return partial(motion, dt_flag=dt_flag)

    @wraps(command)
    def with_motion(*arguments: Any, **given: Any) -> Any:
        mine = {key: given.pop(key) for key in (*_PULSE, *_FILE)}
        there = {k: v for k, v in mine.items() if v is not None}
        if os.path.isdir(there.get("motion_file", "")):
            raise click.UsageError(f"--motion: {there['motion_file']} is a directory; accepted here is one motion")
        return command(*arguments, motion=_motion_of(there, dt_flag, given.get("quiet", False)), **given)

    record_dt = click.option(dt_flag, "motion_dt", metavar="TIME", help="Time between the values of a record in a single column.")
    for option in (scale_to, scale, record_dt, unit, component, motion_file, phase, gamma, cycles, pulse):
        with_motion = option(with_motion)
    return with_motion


def vertical(command: F) -> F:
    """--vertical and --vertical-scale, below the options of the motion, which then has a vertical part."""

    @wraps(command)
    def with_vertical(*arguments: Any, vertical: str | None, vertical_scale: float | None, **given: Any) -> Any:
        if vertical is None:
            if vertical_scale is not None:
                raise click.UsageError("--vertical-scale goes with --vertical")
            return command(*arguments, **given)
        if given["motion"] is None:
            raise click.UsageError("--vertical goes with one pulse or motion document here, not with a set of records")
        from ..motions import PULSES, pulse, read_motion
        from ..motions.biaxial import with_vertical as biaxial

        quiet = given.get("quiet", False)
        up = pulse(vertical) if vertical in PULSES else read_motion(vertical, tell=partial(note, quiet=quiet))
        given["motion"] = biaxial(given["motion"], up, 1.0 if vertical_scale is None else vertical_scale)
        return command(*arguments, **given)

    factor = click.option("--vertical-scale", type=float, metavar="FACTOR", help="Factor of the vertical motion (default 1).")
    told = "Vertical motion, upwards: a pulse by name, a motion document or a record."
    return click.option("--vertical", type=PulseOrPath(), metavar="MOTION", help=told)(factor(with_vertical))


def motions(command: F) -> F:
    """The options of the ground motion, which may be a set of records; the command gets `motion`, None where there are records, and
    `recordings`.

    Records among the command's `files` belong to the set, so that a shell's pattern after --motion does.
    """

    @wraps(command)
    def with_motions(*arguments: Any, **given: Any) -> Any:
        mine = {key: given.pop(key) for key in (*_PULSE, "motion_files", *_FILE[1:])}
        there = {k: v for k, v in mine.items() if v is not None and v != ()}
        if "motion_files" in there:
            from ..motions.recording import holds_records

            own = {path: holds_records(path) for path in given["files"]}
            there["motion_files"] += tuple(path for path in given["files"] if own[path])
            given["files"] = tuple(path for path in given["files"] if not own[path])
            if "-" in there["motion_files"] and "-" in given["files"]:
                raise click.UsageError("standard input is given as structure and as motion; accepted is one of them")
        found = _motion_of(there, "--dt", given.get("quiet", False))
        is_set = isinstance(found, tuple)
        return command(*arguments, motion=None if is_set else found, recordings=found if is_set else (), **given)

    record_dt = click.option("--dt", "motion_dt", metavar="TIME", help="Time between the values of a record in a single column.")
    for option in (scale_to, scale, record_dt, unit, component, motion_files, phase, gamma, cycles, pulse):
        with_motions = option(with_motions)
    return with_motions


_PULSE = ("pulse", "cycles", "gamma", "phase")
_FILE = ("motion_file", "component", "unit", "motion_dt", "scale", "scale_to")


def _motion_of(given: dict[str, Any], dt_flag: str, quiet: bool) -> Motion | tuple[Recording, ...]:
    """The motion that the options describe; the records of a set where they are `motion_files`."""
    from ..documents.quantities import parse_quantity
    from ..motions import pulse as named_pulse
    from ..motions import read_motion
    from ..motions.recording import read_motions

    if "phase" in given:
        try:
            given["phase"] = parse_quantity(given["phase"], "angle")
        except ValueError as error:
            raise click.UsageError(f"--phase: found {given['phase']!r}; accepted is {error}") from None
    if "motion_dt" in given:
        given["dt"] = time(dt_flag, given.pop("motion_dt"))
    if "motion_file" in given or "motion_files" in given:
        for key in _PULSE:
            if key in given:
                raise click.UsageError(f"--motion does not go with --{key}")
        tell = partial(note, quiet=quiet)
        try:
            if "motion_file" in given:
                return read_motion(given.pop("motion_file"), tell=tell, **given)
            return read_motions(given.pop("motion_files"), tell=tell, **given)
        except RockingError as error:
            error.args = (str(error).replace("`dt`", dt_flag),)
            raise
    for key, flag in (("component", "--component"), ("unit", "--unit"), ("dt", dt_flag), ("scale_to", "--scale-to")):
        if key in given:
            raise click.UsageError(f"{flag} goes with a record: give --motion")
    factor = given.pop("scale", None)
    found = named_pulse(given.pop("pulse", "sine"), **given)
    return found if factor is None else found.scaled(factor)


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
    from ..spectra.processes import available_cpus

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


def remark_on(structures: Iterable[RockingParameters] = (), grid: Grid | None = None) -> None:
    """Say on standard error what is odd about structures and amplitudes, up to three lines of it."""
    from ..reports.plausibility import grid_remarks, structure_remarks

    remarks = [remark for one in structures for remark in structure_remarks(one)] + ([] if grid is None else list(grid_remarks(grid)))
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


def refuse_figure(output: Path, overwrite: bool) -> None:
    """Refuse a figure that cannot or must not be written, before any work is done. Raises UsageError."""
    if output.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise click.UsageError(f"{output}: accepted is a name that ends in .png, .svg or .pdf")
    if not output.parent.is_dir():
        raise click.UsageError(f"{output}: the folder {output.parent} does not exist")
    if output.exists() and not overwrite:
        raise click.UsageError(f"{output}: exists; --overwrite replaces it")


def now() -> str:
    """The time in UTC as the history of a file states it."""
    from datetime import UTC, datetime

    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def note(text: str, quiet: bool) -> None:
    """A line on standard error, unless --quiet."""
    if not quiet:
        context = click.get_current_context(silent=True)
        streams.say(text if context is None else in_options(text, context.command))
