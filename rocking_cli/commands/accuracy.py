"""`rocking accuracy`: error against run time for a scene."""

from dataclasses import dataclass, replace

import click

from . import equations, ground, options
from .command import command, group, option
from .printing import detail, emit, note, printed


@dataclass(frozen=True)
class AccuracyOptions:
    """The cells to compare with the reference."""

    axes: str = option(
        "--grid",
        "The grid of the scene, as in rocking spectrum.",
        required=True,
        metavar="AXES",
    )
    sample: int = option(
        "--sample",
        "Cells compared with the reference.",
        type=click.IntRange(1, 10_000),
        default=40,
    )
    scipy: int = option(
        "--scipy",
        "Cells of the sample for each SciPy solver.",
        type=click.IntRange(0, 10_000),
        default=10,
    )
    seed: int = option(
        "--seed", "Seed of the sample.", type=click.IntRange(0), default=0
    )


@command(
    "rocking accuracy --eta 0.9 --grid A=1:10:200,Omega=1:10:200 --sample 20 --scipy 4",
    printed,
)
def accuracy(
    files: tuple[str, ...] = options.files(),
    wanted: AccuracyOptions = group(AccuracyOptions),
    sizeless: equations.Oscillators = group(equations.Oscillators),
    motions: ground.Motions = group(ground.Motions),
    model: equations.Model = group(equations.Model),
) -> None:
    """Work-precision table of one structure's scene.

    For the engine (the exact linear one, or the nonlinear one at tolerances from 1e-4
    to 1e-12) and for SciPy's RK45, LSODA and DOP853 with events: run time a cell,
    largest and 99th-percentile error of theta/alpha, and misjudged outcomes, against an
    independent reference (`rocking help accuracy`).
    """
    from ..motions.grid import parse_grid
    from ..reports.remarks import stuck_in_words
    from ..reports.work_precision import work_precision
    from ..spectra.scene import PulseScene

    motion = motions.one().motion
    assert motion is not None
    grid = parse_grid(wanted.axes, own_time=motion.acceleration is not None)
    structures = options.structures_of(files, sizeless.etas)
    if len(structures) > 1:
        raise click.UsageError(f"found {len(structures)} structures; expected one")
    note(*stuck_in_words(structures))
    structures = [replace(s, friction=None, kinetic_friction=None) for s in structures]
    methods = model.methods(structures, grid.dimensionless)
    detail(*model.in_words(methods, structures, grid.dimensionless))
    detail(
        f"{structures[0].name}, {motion.name}; {wanted.sample} cells, seed"
        f" {wanted.seed}; times in s a cell"
    )
    scene = PulseScene(tuple(structures), grid, motion, methods[0])
    rows = work_precision(
        scene, sample=wanted.sample, scipy=wanted.scipy, seed=wanted.seed
    )
    emit(rows)
