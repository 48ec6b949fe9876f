"""`rocking envelope`: overturning intervals by frequency, traced or in closed form."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from ..errors import counted
from . import equations, ground, options
from .command import command, flag, group, option, partly, refuse
from .printing import emit, note, printed
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..dynamics.method import Method
    from ..envelopes.amplitudes import Limit
    from ..motions import Motion
    from ..motions.grid import Axis
    from ..structures import RockingParameters

SIGNS = ("worse", "+", "-", "both")


@dataclass(frozen=True)
class Envelope:
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
    wanted: Envelope = group(Envelope),
    sizeless: equations.Sizeless = group(equations.Sizeless),
    motions: ground.BothWays = group(ground.BothWays),
    model: equations.Equations = group(equations.Equations),
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
        CURVE_KEYS,
        NAMED,
        check_curves,
        frequency_axis,
        structure_curves,
    )

    files, shaken = motions.several(files, one_upwards=True)
    if shaken.motion is None:
        _of_records(files, wanted, sizeless, shaken, model)
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
        emit(rows, CURVE_COLUMNS, keys=CURVE_KEYS, unseen=NAMED, varied=varied)
        return
    methods = model.methods(structures, axis.name == "Omega")
    from ..responses.sliding import stuck_in_words

    lines = model.in_words(methods, structures, axis.name == "Omega")
    lines += stuck_in_words(structures)
    _of_pulse(structures, motion, axis, methods, wanted, lines, varied)


def _of_pulse(
    structures: Sequence[RockingParameters],
    motion: Motion,
    axis: Axis,
    methods: Sequence[Method],
    wanted: Envelope,
    lines: list[str],
    varied: dict[str, dict[str, float]],
) -> None:
    """Print the intervals of each structure by each equation under a pulse; lines: the
    lines to print after them.
    """
    from ..envelopes.amplitudes import limit_of
    from ..envelopes.intervals import (
        INTERVAL_COLUMNS,
        INTERVAL_KEYS,
        NAMED,
        NARROWEST,
        NONE,
        check_intervals,
        misjudged,
        structure_intervals,
    )

    for structure in structures:  # all of them, before the first row is printed
        for method in methods:
            check_intervals(
                structure,
                motion,
                axis,
                method=method,
                a_max=limit_of(wanted.a_max, structure),
                sign=wanted.sign,
            )
    both = len(methods) > 1
    failed = 0

    def rows() -> Iterator[dict[str, Any]]:
        nonlocal failed
        for structure in structures:
            compared, most = [], limit_of(wanted.a_max, structure)
            for method in methods:
                found, none = [], set()
                for row in structure_intervals(
                    structure,
                    motion,
                    axis,
                    method=method,
                    a_max=most,
                    sign=wanted.sign,
                    lowest=wanted.lowest,
                    workers=wanted.workers,
                    progress=ProgressLine(structure.name, "frequencies"),
                ):
                    failed += row["mode"] == "failed"
                    found.append(row)
                    if row["mode"] == NONE:
                        none.add(row["Omega"])
                    yield row
                if none:
                    by = f", {method.model}" if both else ""
                    lines.append(
                        f"{structure.name}{by}: no overturning up to A = {most:g} at"
                        f" {len(none)} of {axis.values.size} frequencies"
                    )
                compared.append(found)
            if both and not wanted.lowest:
                lines.append(f"{structure.name}: {misjudged(*compared, a_max=most)}")

    emit(
        rows(),
        INTERVAL_COLUMNS,
        keys=INTERVAL_KEYS,
        unseen=NAMED[: 1 if both else 2],
        varied=varied,
    )
    _closing(lines, f"{NARROWEST:g} in A", failed)


def _closing(lines: list[str], narrowest: str, failed: int) -> None:
    """Print what the search may have missed and how many intervals failed."""
    note(
        *lines,
        f"intervals narrower than {narrowest}, safe or overturning, may be missed",
    )
    if failed:
        note(f"{counted(failed, 'interval')} could not be decided (mode failed)")
        partly()


def _of_records(
    files: tuple[str, ...],
    wanted: Envelope,
    sizeless: equations.Sizeless,
    shaken: ground.Ground,
    model: equations.Equations,
) -> None:
    """Print the intervals of scale of each record that overturn a structure, or with
    --median their quantiles.
    """
    from ..dynamics.method import model_in_words
    from ..envelopes.capacity import RATIO
    from ..envelopes.intervals import INTERVAL_KEYS, NAMED, NONE
    from ..responses.sliding import stuck_in_words
    from ..spectra.record_envelope import Tracing, overturning_spectrum, tracing_rows
    from ..spectra.record_scene import scene_of_words

    refuse("does not go with records", "closed_form")
    if wanted.median and wanted.sign == "both":
        raise click.UsageError("--median does not go with --sign both")
    if len(model.models) > 1:
        raise click.UsageError(
            "--model both goes with a pulse; records use the nonlinear equation"
        )
    structures, varied = (
        options.members_of(files, wanted.vary, sizeless.etas, each=True)
        if files
        else ([], {})
    )
    structures = model.lifting(structures)
    equation: dict[str, Any] = {"model": model.models[0], "tolerance": model.tolerance}
    scene = scene_of_words(
        structures,
        shaken.recordings,
        axes=wanted.axes,
        alphas=sizeless.alphas,
        etas=sizeless.etas,
        **equation,
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
        emit(overturning_spectrum(scene, rows()), keys=INTERVAL_KEYS)
    else:
        places = (
            ("record", "alpha", "T") if scene.over_angles else ("record", "structure")
        )
        emit(
            rows(),
            (*places, "A_from", *([] if tracing.first else ["A_to"]), "mode", "model"),
            keys=INTERVAL_KEYS,
            unseen=NAMED,
            varied=varied,
        )
    lines = [model_in_words(scene.method, *structures, model=model.models[0])]
    lines += stuck_in_words(structures)
    if modes[NONE]:
        lines.append(f"no overturning up to {tracing.most} in {modes[NONE]} searches")
    lines.append(
        "the lowest amplitude that overturns may lie far below the first one found:"
        " rocking check searches it in finer steps"
    )
    _closing(lines, f"{100.0 * RATIO:g} % of the amplitude", modes["failed"])
