"""`rocking envelope`: overturning intervals by frequency, traced or in closed form."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import click

from . import ground, options
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..envelopes.limit import Limit
    from ..motions import Motion
    from ..motions.grid import Axis
    from ..motions.recording import Recording
    from ..spectra.record_envelope import Tracing
    from ..structures import RockingParameters

    Searches = list[tuple[RockingParameters, list[dict[str, Any]]]]  # a structure, and what `structure_intervals` takes for each equation


@click.command(epilog="Example: rocking envelope --eta 0.9 --grid Omega=2:6:5")
@options.files
@click.option("--grid", "axes", metavar="AXIS", help="omega_g=START:STOP:N[:log] (or f_g, T_g), or Omega=…; of records T=… with --alpha.")
@options.eta
@options.alpha
@ground.motions
@ground.vertical
@options.methods
@options.linear_uplift
@options.a_max
@click.option(
    "--sign", type=click.Choice(["worse", "+", "-", "both"]), default="worse", show_default=True,
    help="Of the ground acceleration, where a body's sides differ: + or - alone, what overturns under either, or both apart.",
)  # fmt: skip
@click.option("--lowest", "--first", "first", is_flag=True, help="Of each frequency (or record) the lowest overturning amplitude alone.")
@click.option("--median", is_flag=True, help="Of records, the overturning spectrum: first overturnings, median, 16 and 84 % over them.")
@click.option("--closed-form", is_flag=True, help="The closed-form curves of a sine, half-sine or rectangular pulse instead.")
@options.workers
@options.output_form
@options.quiet
@click.pass_context
def envelope(
    context: click.Context,
    files: tuple[str, ...],
    axes: str | None,
    etas: tuple[float | None, ...],
    alphas: str | None,
    motion: Motion | None,
    recordings: tuple[Recording, ...],
    models: tuple[str, ...],
    tolerance: float,
    linear_uplift: str,
    a_max: Limit,
    sign: str,
    first: bool,
    median: bool,
    closed_form: bool,
    workers: int | None,
    form: str | None,
    quiet: bool,
) -> None:
    """Trace every interval of amplitude that overturns, for each frequency.

    A_to is empty where the interval goes on beyond --a-max; a frequency that never overturns has mode none and neither end. No
    interval wider than 1e-3 in A is missed; narrower ones, overturning or safe, can be: at low Omega just above uplift, and after
    many impacts (several cycles) anywhere. Under motions that push more than twice the scan is ten times as fine around every
    change, which finds most of those wider than 1e-4 and is no proof. For structures with units omega_g [rad/s], a_from and a_to
    [m/s2] are printed as well.

    Records have no frequency: what is sought is their scale, for each structure, or with --alpha and --grid T=… for blocks of
    these critical angles and sizes T = 2 pi/p in s. A row states A, the peak a [m/s2] and the scale of the record as it is given. The
    scan's amplitudes are 0.5 % apart, and nothing is claimed of narrower intervals.

    --model both traces the intervals of both equations, a row each with its model, and says over how much of the amplitudes that
    overturn a structure the linear one says that it stands.
    """
    from ..dynamics.method import governing_method, model_in_words
    from ..envelopes.intervals import CURVE_COLUMNS, check_curves, frequency_axis, structure_curves
    from ..spectra.record_envelope import Tracing
    from ..spectra.record_scene import scene_of_words

    workers = options.at_most_the_cpus(workers, quiet)
    if motion is None:
        if closed_form:
            raise click.UsageError("--closed-form does not go with records")
        if median and sign == "both":
            raise click.UsageError("--median does not go with --sign both")
        if len(models) > 1:
            raise click.UsageError("--model both goes with a pulse; of records the nonlinear equation decides")
        structures = options.lifting(options.structures_of(files, etas) if files else [], linear_uplift, models)
        scene = scene_of_words(
            structures, recordings, axes=axes, alphas=alphas, etas=etas,
            model=models[0], tolerance=tolerance,
        )  # fmt: skip
        told = [model_in_words(scene.method, *structures, model=models[0])]
        _of_records(context, Tracing(scene, a_max, first or median), told, sign, workers, median, form, quiet)
        return
    if alphas is not None or median:
        raise click.UsageError(f"{'--median' if median else '--alpha'} goes with records: give --motion")
    axis = frequency_axis(axes)
    structures = options.lifting(options.structures_of(files, etas), linear_uplift, models)
    if closed_form:
        for structure in structures:  # all of them, before the first row is printed
            check_curves(structure, motion, axis)
        options.emit((row for structure in structures for row in structure_curves(structure, motion, axis)), form, CURVE_COLUMNS)
        return
    dimensionless = axis.name == "Omega"
    methods = [governing_method(*structures, model=model, tolerance=tolerance, dimensionless=dimensionless) for model in models]
    searches = [
        (structure, [{"method": method, "a_max": a_max.of(structure), "sign": sign} for method in methods]) for structure in structures
    ]
    told = [
        model_in_words(method, *structures, model=model, dimensionless=dimensionless) for method, model in zip(methods, models, strict=True)
    ]
    _of_pulse(context, searches, told, motion, axis, first, workers, form, quiet)


def _of_pulse(
    context: click.Context,
    searches: Searches,
    told: list[str],
    motion: Motion,
    axis: Axis,
    lowest: bool,
    workers: int | None,
    form: str | None,
    quiet: bool,
) -> None:
    """Print the intervals of each structure, by one equation or both."""
    from ..envelopes.intervals import INTERVAL_COLUMNS, NARROWEST, NONE, check_intervals, misjudged, structure_intervals

    for structure, ways in searches:  # all of them, before the first row is printed
        for way in ways:
            check_intervals(structure, motion, axis, **way)
    both = any(len(ways) > 1 for _, ways in searches)
    failed = 0
    silent = told

    def records() -> Iterator[dict[str, Any]]:
        nonlocal failed
        for structure, ways in searches:
            compared = []
            for way in ways:
                found, none, model, most = [], set(), way["method"].model, way["a_max"]
                line = ProgressLine(structure.name, quiet, "frequencies")
                for record in structure_intervals(structure, motion, axis, **way, lowest=lowest, workers=workers, progress=line):
                    failed += record["mode"] == "failed"
                    found.append(record)
                    if record["mode"] == NONE:
                        none.add(record["Omega"])
                    yield {**record, "model": model} if both else record
                if none:
                    by = f", {model}" if both else ""
                    silent.append(
                        f"{structure.name}{by}: no overturning up to A = {most:g} at {len(none)} of {axis.values.size} frequencies"
                    )
                compared.append(found)
            if both and not lowest:
                silent.append(f"{structure.name}: {misjudged(*compared, a_max=most)}")

    options.emit(records(), form, columns=(*INTERVAL_COLUMNS, *(["model"] if both else [])))
    for line in silent:
        options.note(line, quiet)
    options.note(f"nothing is claimed of intervals narrower than {NARROWEST:g} in A, safe or overturning", quiet)
    if failed:
        options.note(f"{failed} intervals could not be decided (mode failed)", quiet)
        context.exit(4)


def _of_records(
    context: click.Context, tracing: Tracing, told: list[str], sign: str, workers: int | None, median: bool, form: str | None, quiet: bool
) -> None:
    """Print the overturning scales of records, or their quantiles."""
    from ..envelopes.capacity import RATIO
    from ..envelopes.intervals import NONE
    from ..spectra.overturning_spectrum import overturning_spectrum
    from ..spectra.record_envelope import check_tracing, tracing_records

    check_tracing(tracing)
    modes: Counter[str] = Counter()

    def records() -> Iterator[dict[str, Any]]:
        progress = ProgressLine("envelope", quiet, "searches")
        for record in tracing_records(tracing, sign=sign, workers=workers, progress=progress):
            modes[record["mode"]] += 1
            yield record

    places = ("record", "alpha", "T") if tracing.scene.over_angles else ("record", "structure")
    if median:
        options.emit(overturning_spectrum(tracing.scene, records()), form)
    else:
        options.emit(records(), form, columns=(*places, "A_from", *([] if tracing.first else ["A_to"]), "mode"))
    for line in told:
        options.note(line, quiet)
    if modes[NONE]:
        options.note(f"no overturning up to {tracing.most} in {modes[NONE]} searches", quiet)
    options.note(f"nothing is claimed of intervals narrower than {100.0 * RATIO:g} % of the amplitude, safe or overturning", quiet)
    if modes["failed"]:
        options.note(f"{modes['failed']} intervals could not be decided (mode failed)", quiet)
        context.exit(4)
