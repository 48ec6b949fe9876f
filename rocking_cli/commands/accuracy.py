"""`rocking accuracy`: error against run time for a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from . import ground, options

if TYPE_CHECKING:
    from ..motions import Motion


@click.command(epilog="Example: rocking accuracy --eta 0.9 --grid A=1:10:200,Omega=1:10:200 --sample 20 --scipy 4")
@options.files
@click.option("--grid", "axes", required=True, metavar="AXES", help="The grid of the scene, as in rocking spectrum.")
@options.eta
@ground.motion
@options.method
@click.option("--sample", type=click.IntRange(1, 10_000), default=40, show_default=True, help="Cells compared with the reference.")
@click.option("--scipy", type=click.IntRange(0, 10_000), default=10, show_default=True, help="Of these, cells for each SciPy solver.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the sample.")
@options.output_form
@options.quiet
def accuracy(
    files: tuple[str, ...],
    axes: str,
    etas: tuple[float, ...],
    motion: Motion,
    model: str | None,
    tolerance: float,
    sample: int,
    scipy: int,
    seed: int,
    form: str | None,
    quiet: bool,
) -> None:
    """Work-precision table of one structure's scene.

    For the engine (the exact linear one, or the nonlinear one at tolerances from 1e-4 to 1e-12) and for SciPy's RK45, LSODA
    and DOP853 with events: run time a cell, largest and 99th-percentile error of theta/alpha, and misjudged outcomes, against an
    independent reference (a Runge-Kutta method in small steps).
    """
    from ..dynamics.method import governing_method, model_in_words
    from ..motions.grid import parse_grid
    from ..reports.accuracy import work_precision
    from ..spectra.scene import PulseScene

    grid = parse_grid(axes, own_time=motion.acceleration is not None)
    structures = options.structures_of(files, etas)
    if len(structures) > 1:
        raise click.UsageError(f"found {len(structures)} structures, accepted is one")
    method = governing_method(*structures, model=model, tolerance=tolerance, dimensionless=grid.dimensionless)
    scene = PulseScene(tuple(structures), grid, motion, method)
    options.note(model_in_words(method, *structures, model=model, dimensionless=grid.dimensionless), quiet)
    options.note(f"{structures[0].name}, {motion.name}; {sample} cells, seed {seed}; times in s a cell", quiet)
    options.emit((line.record() for line in work_precision(scene, sample=sample, scipy=scipy, seed=seed)), form)
