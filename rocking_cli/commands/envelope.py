"""`rocking envelope`: overturning intervals by frequency, traced or in closed form."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import click

from ..errors import counted
from . import equations, ground, options
from .command import command, flag, group, option, partly, refuse
from .printing import detail, note, printed
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..dynamics.method import Method
    from ..envelopes.amplitudes import Limit
    from ..motions import Motion
    from ..motions.grid import Axis
    from ..structures import RockingParameters

SIGNS = ("worse", "+", "-", "both")


@dataclass(frozen=True)
class EnvelopeOptions:
    """The options of `rocking envelope`."""

    axes: str | None = option(
        "--grid",
        "omega_g=START:STOP:N[:log] (or f_g, T_g), or Omega=…; for records T=… with"
        " --alpha.",
        metavar="AXIS",
    )
    a_max: Limit = options.a_max()
    sign: str = option(
        "--sign",
        "Sign of the motion: +, -, worse (either overturns), both (rows for each).",
        type=click.Choice(SIGNS),
        default=SIGNS[0],
    )
    lowest: bool = flag(
        "--lowest --first",
        "Print only the lowest overturning amplitude of each frequency (or record).",
    )
    median: bool = flag(
        "--median",
        "Print the overturning spectrum of records: median, 16 and 84 % of the first"
        " overturnings.",
    )
    vary: tuple[str, ...] = options.vary()
    closed_form: bool = flag(
        "--closed-form",
        "Print the closed-form curves of a sine, half-sine or rectangular pulse"
        " instead.",
    )
    workers: int | None = options.workers()


@command("rocking envelope --eta 0.9 --grid Omega=2:6:5", printed)
def envelope(
    files: tuple[str, ...] = options.files(),
    wanted: EnvelopeOptions = group(EnvelopeOptions),
    sizeless: equations.Sizeless = group(equations.Sizeless),
    motions: ground.BothWays = group(ground.BothWays),
    model: equations.Equations = group(equations.Equations),
    figure: options.FigureFile = group(options.FigureFile),
) -> None:
    """Trace every interval of amplitude that overturns, for each frequency.

    A_to is empty if the interval continues beyond --a-max. A frequency without
    overturning has mode none and neither end. Every interval wider than 1e-3 in A is
    found, narrower ones may be missed. Rows in units have omega_g [rad/s], a_from, a_to
    [m/s2].

    Records have no frequency. The search varies their scale, for each structure, or
    with --alpha and --grid T=… for blocks of these critical angles and sizes T = 2 pi/p
    in s. A row states A, the peak a [m/s2] and the factor of the original record.

    --model both traces the intervals of both equations, a row each with its model.
    """
    from ..envelopes.intervals import (
        CURVE_COLUMNS,
        INTERVAL_COLUMNS,
        NAMED,
        NARROWEST,
        check_curves,
        frequency_axis,
        structure_curves,
    )

    figure.check()
    files, shaken = motions.several(files, one_upwards=True)
    if shaken.motion is None:
        _of_records(files, wanted, sizeless, shaken, model, figure)
        return
    refuse("goes with records: give --motion", "alphas", "median")
    motion, axis = shaken.motion, frequency_axis(wanted.axes)
    structures, varied = options.members_of(
        files, wanted.vary, sizeless.etas, each=True
    )
    structures = model.lifting(structures)
    if wanted.closed_form:
        for structure in structures:  # all of them, before the first row is printed
            check_curves(structure, motion, axis)
        rows = (
            row
            for structure in structures
            for row in structure_curves(structure, motion, axis)
        )
        figure.emit(rows, CURVE_COLUMNS, unseen=NAMED, varied=varied)
        return
    methods = model.methods(structures, axis.name == "Omega")
    tracings = _tracings(structures, motion, axis, methods, wanted)
    rows = (row for tracing in tracings for row in tracing.trace(wanted))
    unseen = NAMED[: 1 if len(methods) > 1 else 2]
    figure.emit(rows, INTERVAL_COLUMNS, unseen=unseen, varied=varied)
    from ..reports.remarks import stuck_in_words

    detail(*model.in_words(methods, structures, axis.name == "Omega"))
    lines = stuck_in_words(structures)
    lines += _remarks(tracings, len(methods), wanted)
    failed = sum(tracing.count("failed") for tracing in tracings)
    _closing(lines, f"{NARROWEST:g} in A", failed)


@dataclass
class _OfPulse:
    """The intervals of one structure by one equation under a pulse."""

    structure: RockingParameters
    motion: Motion
    axis: Axis  # frequencies
    method: Method  # the equation
    most: float  # the largest A of the search [-]
    rows: list[dict[str, Any]] = field(default_factory=list)  # those found

    def trace(self, wanted: EnvelopeOptions) -> Iterator[dict[str, Any]]:
        """Yield the rows as they are found."""
        from ..envelopes.intervals import structure_intervals

        for row in structure_intervals(
            self.structure,
            self.motion,
            self.axis,
            method=self.method,
            a_max=self.most,
            sign=wanted.sign,
            lowest=wanted.lowest,
            workers=wanted.workers,
            progress=ProgressLine(self.structure.name, "frequencies"),
        ):
            self.rows.append(row)
            yield row

    def count(self, mode: str) -> int:
        """Return the number of rows of a mode."""
        return sum(row["mode"] == mode for row in self.rows)


def _tracings(
    structures: Sequence[RockingParameters],
    motion: Motion,
    axis: Axis,
    methods: Sequence[Method],
    wanted: EnvelopeOptions,
) -> list[_OfPulse]:
    """Return the searches of a call, by structure and equation. Raises UsageError for
    one that cannot be done, before the first row is printed.
    """
    from ..envelopes.amplitudes import limit_of
    from ..envelopes.intervals import check_intervals

    found = []
    for structure in structures:
        most = limit_of(wanted.a_max, structure)
        for method in methods:
            check_intervals(
                structure, motion, axis, method=method, a_max=most, sign=wanted.sign
            )
            found.append(_OfPulse(structure, motion, axis, method, most))
    return found


def _remarks(
    tracings: Sequence[_OfPulse], equations: int, wanted: EnvelopeOptions
) -> Iterator[str]:
    """Yield lines on frequencies without overturning, and with both equations on what
    the linear one misjudges; equations: the number for each structure.
    """
    from ..envelopes.intervals import NONE, misjudged
    from ..reports.remarks import misjudged_in_words

    for first in range(0, len(tracings), equations):
        of_structure = tracings[first : first + equations]
        for tracing in of_structure:
            # with --sign both a frequency may have two such rows
            none = {row["Omega"] for row in tracing.rows if row["mode"] == NONE}
            by = f", {tracing.method.model}" if equations > 1 else ""
            if none:
                yield (
                    f"{tracing.structure.name}{by}: no overturning up to A ="
                    f" {tracing.most:g} at {len(none)} of {tracing.axis.values.size}"
                    " frequencies"
                )
        if equations > 1 and not wanted.lowest:
            rows = (tracing.rows for tracing in of_structure)
            most = of_structure[0].most
            said = misjudged_in_words(*misjudged(*rows, a_max=most), a_max=most)
            yield f"{of_structure[0].structure.name}: {said}"


def _closing(lines: list[str], narrowest: str, failed: int) -> None:
    """Print what the search may have missed and how many intervals failed."""
    note(*lines)
    detail(
        f"intervals narrower than {narrowest}, safe or overturning, may be missed",
    )
    if failed:
        note(f"{counted(failed, 'interval')} could not be decided (mode failed)")
        partly()


def _of_records(
    files: tuple[str, ...],
    wanted: EnvelopeOptions,
    sizeless: equations.Sizeless,
    shaken: ground.Ground,
    model: equations.Equations,
    figure: options.FigureFile,
) -> None:
    """Print the intervals of scale of each record that overturn a structure, or with
    --median their quantiles.
    """
    from ..envelopes.capacity import RATIO
    from ..envelopes.intervals import NAMED, NONE
    from ..reports.remarks import model_in_words, stuck_in_words
    from ..spectra.record_envelope import Tracing, overturning_spectrum, tracing_rows
    from ..spectra.record_scene import scene_of_words

    _refuse_of_records(wanted, model)
    structures, varied = (
        options.members_of(files, wanted.vary, sizeless.etas, each=True)
        if files
        else ([], {})
    )
    structures = model.lifting(structures)
    scene = scene_of_words(
        structures,
        shaken.recordings,
        axes=wanted.axes,
        alphas=sizeless.alphas,
        etas=sizeless.etas,
        model=model.models[0],
        tolerance=model.tolerance,
    )
    tracing = Tracing(scene, wanted.a_max, wanted.lowest or wanted.median)
    modes: Counter[str] = Counter()

    def rows() -> Iterator[dict[str, Any]]:
        for row in tracing_rows(
            tracing,
            sign=wanted.sign,
            workers=wanted.workers,
            progress=ProgressLine("envelope", "searches"),
        ):
            modes[row["mode"]] += 1
            yield row

    if wanted.median:
        figure.emit(overturning_spectrum(scene, rows()))
    else:
        angles = scene.over_angles
        places = ("record", "alpha", "T") if angles else ("record", "structure")
        ends = ("A_from",) if tracing.first else ("A_from", "A_to")
        columns = (*places, *ends, "mode", "model")
        figure.emit(rows(), columns, unseen=NAMED, varied=varied)
    detail(model_in_words(scene.method, *structures, model=model.models[0]))
    lines = stuck_in_words(structures)
    if modes[NONE]:
        lines.append(f"no overturning up to {tracing.most} in {modes[NONE]} searches")
    lines.append(
        "the lowest amplitude that overturns may lie far below the first one found:"
        " rocking check searches it in finer steps"
    )
    _closing(lines, f"{100.0 * RATIO:g} % of the amplitude", modes["failed"])


def _refuse_of_records(wanted: EnvelopeOptions, model: equations.Equations) -> None:
    """Raise click.UsageError for options that do not go with records."""
    refuse("does not go with records", "closed_form")
    if wanted.median and wanted.sign == "both":
        raise click.UsageError("--median does not go with --sign both")
    if len(model.models) > 1:
        raise click.UsageError(
            "--model both goes with a pulse; records use the nonlinear equation"
        )
