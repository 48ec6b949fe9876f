"""`rocking predict`: a structure's response, read from a dimensionless spectrum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from . import options

if TYPE_CHECKING:
    from ..spectra.grid import Grid


@click.command(epilog="Example: rocking predict shared.h5 configs/block.yaml --a-g 0.35g --f-g 1.5")
@click.argument("spectrum")
@options.files
@options.shaking
@click.option("--exact", is_flag=True, help="Compute it for the spectrum's motion, also beyond its range or restitutions.")
@options.output_form
@options.quiet
def predict(spectrum: str, files: tuple[str, ...], shaking: Grid | None, exact: bool, form: str | None, quiet: bool) -> None:
    """Predict theta_max, outcome and margin of structures from the spectrum of any structure of equal restitution.

    SPECTRUM holds a linear spectrum on axes A and Omega. theta_max in rad; margin is the relative distance in A to the nearest
    overturning boundary, read off the grid a lower bound. interpolation_error is the distance from the computed value; the
    outcome is `undecided` where a boundary runs through the grid's cell.
    """
    from ..spectra.prediction import predict as read_off
    from ..spectra.prediction import predict_exactly
    from ..spectra.reader import SpectraFile

    structures = options.structures_of(files)
    if shaking is None:
        raise click.UsageError("no shaking: give --a-g and --omega-g (or --f-g, --T-g), or --A and --Omega")
    with SpectraFile(spectrum) as file:
        reach = float(file.grid.amplitude.values[-1]) if file.grid.dimensionless else 0.0
        if exact:
            records = [predict_exactly(s, file.motion(), shaking, reach) for s in structures]
        else:
            records = [read_off(file, s, shaking) for s in structures]
    options.emit(records, form)
    if not exact and any(r["outcome"] == "undecided" for r in records):
        options.note("undecided: a boundary runs through the spectrum's cell; --exact decides", quiet)
