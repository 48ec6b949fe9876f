"""`rocking envelope`: overturning intervals by frequency, traced or in closed form."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from . import options

if TYPE_CHECKING:
    from ..motions import Motion


@click.command(epilog="Example: rocking envelope --eta 0.9 --grid Omega=2:6:5")
@options.files
@click.option("--grid", "axes", metavar="AXIS", help="omega_g=START:STOP:N[:log] (or f_g, T_g), or Omega=…; a record has none.")
@options.eta
@options.motion
@options.vertical
@options.method
@click.option("--a-max", type=float, default=20.0, show_default=True, help="Largest dimensionless amplitude A that is searched.")
@click.option(
    "--sign", type=click.Choice(["worse", "+", "-", "both"]), default="worse", show_default=True,
    help="Of the ground acceleration, where a body's sides differ: + or - alone, what overturns under either, or both apart.",
)  # fmt: skip
@click.option("--closed-form", is_flag=True, help="The closed-form curves of a sine, half-sine or rectangular pulse instead.")
@options.workers
@options.output_form
@options.quiet
@click.pass_context
def envelope(
    context: click.Context,
    files: tuple[str, ...],
    axes: str | None,
    etas: tuple[float, ...],
    motion: Motion,
    model: str,
    tolerance: float,
    a_max: float,
    sign: str,
    closed_form: bool,
    workers: int | None,
    form: str | None,
    quiet: bool,
) -> None:
    """Trace every interval of amplitude that overturns, for each frequency.

    A_to is empty where the interval goes on beyond --a-max. No interval wider than 1e-3 in A is missed; narrower ones,
    overturning or safe, can be: at low Omega just above uplift, and after many impacts (several cycles) anywhere. Under
    motions that push more than twice the scan is ten times as fine around every change, which finds most of those wider
    than 1e-4 and is no proof. For
    structures with units omega_g [rad/s], a_from and a_to [m/s2] are printed as well.
    """
    from ..dynamics.method import Method
    from ..spectra.envelope import (
        CURVE_COLUMNS,
        INTERVAL_COLUMNS,
        NARROWEST,
        check_curves,
        check_intervals,
        frequency_axis,
        structure_curves,
        structure_intervals,
    )

    method = Method(model, tolerance)
    workers = options.at_most_the_cpus(workers, quiet)
    axis = frequency_axis(axes, own_time=motion.acceleration is not None)
    structures = options.structures_of(files, etas)
    for structure in structures:  # all of them, before the first row is printed
        if closed_form:
            check_curves(structure, axis, motion)
        else:
            check_intervals(structure, axis, motion, method=method, a_max=a_max, sign=sign, tell=partial(options.note, quiet=quiet))
    failed = 0
    silent: list[str] = []

    def records() -> Iterator[dict[str, Any]]:
        nonlocal failed
        for structure in structures:
            if closed_form:
                yield from structure_curves(structure, axis, motion)
                continue
            progress = options.ProgressLine(structure.name, quiet)
            found = set()
            traced = structure_intervals(structure, axis, motion, method=method, a_max=a_max, sign=sign, workers=workers, progress=progress)
            for record in traced:
                failed += record["mode"] == "failed"
                found.add(record["Omega"])
                yield record
            none = axis.values.size - len(found)
            if none:
                silent.append(f"{structure.name}: no overturning up to A = {a_max:g} at {none} of {axis.values.size} frequencies")

    options.emit(records(), form, columns=CURVE_COLUMNS if closed_form else INTERVAL_COLUMNS)
    for line in silent:
        options.note(line, quiet)
    if not closed_form:
        options.note(f"nothing is claimed of intervals narrower than {NARROWEST:g} in A, safe or overturning", quiet)
    if failed:
        options.note(f"{failed} intervals could not be decided (mode failed)", quiet)
        context.exit(4)
