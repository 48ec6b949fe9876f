"""`rocking predict`: a structure's response, read from a dimensionless spectrum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from . import ground, options
from .parameter_types import InputPath

if TYPE_CHECKING:
    from ..motions.grid import Grid


@click.command(epilog="Example: rocking predict shared.h5 configs/block.yaml --a-g 0.35g --f-g 1.5")
@click.argument("spectrum", type=InputPath())
@options.files
@ground.shaking
@click.option("--exact", is_flag=True, help="For the spectrum's motion, also beyond its range or restitutions; nothing is interpolated.")
@options.output_form
@options.quiet
@click.pass_context
def predict(
    context: click.Context, spectrum: str, files: tuple[str, ...], shaking: Grid | None, exact: bool, form: str | None, quiet: bool
) -> None:
    """Predict theta_max, outcome and margin of structures under the motion of a spectrum of equal restitution.

    SPECTRUM holds a linear spectrum on axes A and Omega. theta_max [rad] and the outcome are computed. capacity_demand is the
    lowest overturning amplitude over the demand: below 1 a body that falls would fall for less. margin is the relative distance in
    A to the nearest amplitude at which falling begins or ends, traced as by rocking envelope, which can miss what is narrower than
    1e-3 in A; margin_side tells on which side of the demand. They are empty where nothing overturns up to A = 20 and twice the
    demand. theta_ratio_interpolated is what the spectrum itself says, empty next to cells that overturn; interpolation_error is its
    distance from the computed value.
    """
    from ..dynamics.outcome import Outcome
    from ..spectra.file.reader import SpectraFile
    from ..spectra.prediction import predict as beside_spectrum
    from ..spectra.prediction import predict_exactly

    structures = options.structures_of(files)
    if shaking is None:
        raise click.UsageError("no shaking: give --a-g and --omega-g (or --f-g, --T-g), or --A and --Omega")
    with SpectraFile(spectrum) as file:
        if exact:
            records = [predict_exactly(s, file.motion(), shaking) for s in structures]
        else:
            records = [beside_spectrum(s, file, shaking) for s in structures]
    options.emit(records, form)
    options.note("model: linear, as the spectrum's", quiet)
    failed = sum(r["outcome"] == Outcome.FAILED.flag for r in records)
    if failed:
        options.note(f"{failed} structures could not be decided (outcome failed)", quiet)
        context.exit(4)
