"""Options that several commands share, each defined once so that it means the same everywhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import UsageError
from . import streams

if TYPE_CHECKING:
    from ..motions import Motion
    from ..structures import RockingParameters

F = Callable[..., Any]


class OutputPath(click.Path):
    """The name of a file to write."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "":
            self.fail("found an empty name, accepted is the name of a file to write", param, ctx)
        return super().convert(value, param, ctx)


files = click.argument("files", nargs=-1, metavar="[FILE]...")
json_output = click.option("--json", "form", flag_value="json", help="JSON Lines on standard output.")
csv_output = click.option("--csv", "form", flag_value="csv", help="CSV on standard output.")
quiet = click.option("-q", "--quiet", is_flag=True, help="No progress and no summary on standard error.")
output = click.option("-o", "--output", required=True, type=OutputPath(), help="The HDF5 file to write.")
overwrite = click.option("--overwrite", is_flag=True, help="Replace an output that exists.")
strict = click.option("--strict", is_flag=True, help="Refuse data of a machine or of libraries that may differ in the last digits.")
workers = click.option("--workers", type=click.IntRange(1), help="Processes to use (default: all cores).")
pulse = click.option("--pulse", metavar="NAME", help="Ground motion: sine (default), or one of the pulses listed in the README.")
cycles = click.option("--cycles", type=float, help="Cycles of a sine or cosine, in half cycles (default 1).")
gamma = click.option("--gamma", type=float, help="Duration over period of a mavroeidis-papageorgiou pulse (default 2).")
phase = click.option("--phase", metavar="ANGLE", help="Phase of a mavroeidis-papageorgiou pulse, in rad or with a unit (default 0).")
motion_file = click.option("--motion", "motion_file", metavar="FILE", help="A motion document of your own instead of a pulse.")
component = click.option("--component", metavar="NAME", help="The component of a record that holds several, by name or number.")
unit = click.option("--unit", metavar="UNIT", help="Unit of a record in plain columns of numbers, such as g or m/s2.")
dt = click.option("--dt", metavar="TIME", help="Time between the values of a record in a single column.")
eta = click.option(
    "--eta", "etas", multiple=True, type=click.FloatRange(0.0, 1.0), metavar="ETA",
    help="A dimensionless oscillator of this restitution instead of FILE; repeatable.",
)  # fmt: skip


def method(command: F) -> F:
    """--model and --tolerance."""
    model = click.option("--model", default="linear", show_default=True, help="Equation of motion: linear or nonlinear.")
    tolerance = click.option("--tolerance", type=float, default=1e-9, show_default=True, help="Error of theta/alpha aimed at (nonlinear).")
    return model(tolerance(command))


def methods(command: F) -> F:
    """--model, which may be both, and --tolerance; the command gets `models`."""

    @wraps(command)
    def with_models(*arguments: Any, model: str, **others: Any) -> Any:
        return command(*arguments, models=("linear", "nonlinear") if model == "both" else (model,), **others)

    model = click.option("--model", default="linear", show_default=True, help="Equation of motion: linear, nonlinear or both.")
    tolerance = click.option("--tolerance", type=float, default=1e-9, show_default=True, help="Error of theta/alpha aimed at (nonlinear).")
    return model(tolerance(with_models))


def shaking(command: F) -> F:
    """One amplitude and one frequency, with units or dimensionless; the command gets a grid of one cell, None without any."""

    @wraps(command)
    def with_shaking(*arguments: Any, **given: Any) -> Any:
        from ..spectra.grid import parse_grid

        flags = {"a_g": "--a-g", "omega_g": "--omega-g", "f_g": "--f-g", "T_g": "--T-g", "A": "--A", "Omega": "--Omega"}
        axes = {key: given.pop(key.lower() if key in ("A", "Omega", "T_g") else key) for key in flags}
        there = {key: value for key, value in axes.items() if value is not None}
        grid = None
        for key, value in there.items():
            if "," in value:
                raise click.UsageError(f"{flags[key]}: found {value!r}; accepted is one value")
        if there:
            try:
                grid = parse_grid(",".join(f"{key}={value}" for key, value in there.items()))
            except UsageError as error:
                text = str(error)
                for key, flag in flags.items():
                    text = text.replace(f"--grid {key}:", f"{flag}:")
                raise UsageError(text.replace("--grid: ", "")) from None
            if grid.shape != (1, 1):
                raise UsageError(f"found {' '.join(f'{flags[k]} {v}' for k, v in there.items())}; accepted is one value of each")
        return command(*arguments, shaking=grid, **given)

    for name, meaning in (
        ("--Omega", "Dimensionless frequency omega_g/p."),
        ("--A", "Dimensionless amplitude a_scale a_g/(alpha g)."),
        ("--T-g", "Its period in s, the duration t_p of a rectangular pulse."),
        ("--f-g", "Its frequency in Hz."),
        ("--omega-g", "Angular frequency of the motion, rad/s."),
        ("--a-g", "Amplitude of the ground acceleration, m/s2 or with g."),
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


def output_form(command: F) -> F:
    """--json and --csv; without either a table for people."""
    return json_output(csv_output(command))


def motion(command: F) -> F:
    """The options of the ground motion; the command gets the motion itself."""

    @wraps(command)
    def with_motion(
        *arguments: Any,
        pulse: str | None,
        cycles: float | None,
        gamma: float | None,
        phase: str | None,
        motion_file: str | None,
        **others: Any,
    ) -> Any:
        return command(*arguments, motion=_motion_of(pulse, cycles, gamma, phase, motion_file), **others)

    return pulse(cycles(gamma(phase(motion_file(with_motion)))))


def _motion_of(name: str | None, cycles: float | None, gamma: float | None, phase: str | None, path: str | None) -> Motion:
    from ..documents.quantities import parse_quantity
    from ..motions import pulse as named_pulse
    from ..motions import read_motion

    angle = None
    if phase is not None:
        try:
            angle = parse_quantity(phase, "angle")
        except ValueError as error:
            raise click.UsageError(f"--phase: found {phase!r}; accepted is {error}") from None
    given = {key: value for key, value in (("cycles", cycles), ("gamma", gamma), ("phase", angle)) if value is not None}
    if path is None:
        return named_pulse(name or "sine", **given)
    if name is not None or given:
        raise click.UsageError(f"--motion does not go with --{'pulse' if name is not None else next(iter(given))}")
    return read_motion(path)


def emit(records: Iterable[Mapping[str, Any]], form: str | None, columns: Sequence[str] = ()) -> None:
    """Records on standard output, each as soon as it is there; columns: the CSV header where there is no record."""
    from ..reports.tables import lines

    for line in lines(records, form or "table", columns, encoding=sys.stdout.encoding):
        streams.put(line)


def at_most_the_cpus(workers: int | None, quiet: bool) -> int | None:
    """The processes that --workers comes to: more than there are CPUs to use only get into each other's way, as a line says."""
    from ..spectra.processes import available_cpus

    cpus = available_cpus()
    if workers is None or workers <= cpus:
        return workers
    note(f"--workers {workers}: reduced to {cpus}, the CPUs that may be used here", quiet)
    return cpus


def structures_of(files: tuple[str, ...], etas: tuple[float, ...] = ()) -> list[RockingParameters]:
    """The structures of the given documents and the dimensionless oscillators of the given restitutions."""
    return structures_and_texts(files, etas)[0]


def structures_and_texts(files: tuple[str, ...], etas: tuple[float, ...] = ()) -> tuple[list[RockingParameters], str]:
    """The structures, and the text of their documents."""
    from ..structures import build_structure, read_documents, with_distinct_names
    from ..structures.parameters import dimensionless_oscillator

    if not files and not etas:
        raise click.UsageError("no structure: give FILE (- for standard input), or --eta with a dimensionless grid")
    documents = [document for path in files for document in read_documents(path)]
    structures = [build_structure(document) for document in documents]
    try:
        oscillators = [dimensionless_oscillator(eta) for eta in etas]
    except ValueError as error:
        raise click.UsageError(f"--eta: {error}") from None
    return with_distinct_names([*structures, *oscillators]), "\n---\n".join(d.text for d in documents)


class ProgressLine:
    """One line on standard error, rewritten; only on a terminal and not with --quiet."""

    def __init__(self, label: str, quiet: bool) -> None:
        self.label, self.shown = streams.printable(label), not quiet and sys.stderr.isatty()

    def __call__(self, done: int, total: int) -> None:
        if self.shown:
            end = "\n" if done == total else ""
            sys.stderr.write(f"\r{self.label}: {done}/{total} ({100 * done // max(1, total)} %)\x1b[K{end}")
            sys.stderr.flush()


def note(text: str, quiet: bool) -> None:
    """A line on standard error, unless --quiet."""
    if not quiet:
        streams.say(text)
