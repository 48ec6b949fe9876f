"""`rocking spectrum`: structures over a grid of amplitude and frequency, to an HDF5 file."""

from __future__ import annotations

import shlex
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from . import ground, options, streams
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.recording import Recording


@click.command(epilog="Example: rocking spectrum configs/block.yaml --grid a_g=0.1g:1g:50,f_g=0.5:5:40 -o block.h5")
@options.files
@click.option(
    "--grid", "axes", metavar="AXES", help="a_g=START:STOP:N[:log],omega_g=… (or f_g, T_g), or A=…,Omega=…; of records see below."
)
@options.output
@options.eta
@options.alpha
@ground.motions
@ground.vertical
@options.methods
@options.linear_uplift
@click.option(
    "--impacts", is_flag=True, help="Also store the number of impacts during the shaking, without those of a last bouncing below the peak."
)
@click.option(
    "--quantity",
    "quantities",
    metavar="NAME,…",
    help="Also store: condition (sensitivity to the input), friction, fz_min, linear, of records velocity_ratio.",
)
@click.option("--no-validity", is_flag=True, help="Do not compare cells of a linear sweep with the nonlinear equation.")
@options.workers
@click.option("--chunk", "chunk_cells", type=click.IntRange(1), metavar="CELLS", help="Cells in one unit of work.")
@click.option("--check", type=click.IntRange(0, 10_000), metavar="N", help="Cells computed again by the independent path.")
@options.overwrite
@click.option("--resume", is_flag=True, help="Go on with an interrupted sweep of the same scene (OUTPUT.part).")
@options.strict
@click.option("--shard", metavar="I/N", help="Compute the I-th of N parts only; rocking merge puts them together.")
@click.option("--scheduler", metavar="ADDRESS", help="Compute on a dask.distributed cluster, such as tcp://host:8786.")
@click.option("--json", "json_", is_flag=True, help="The closing summary as a JSON record on standard output.")
@options.quiet
@click.pass_context
def spectrum(
    context: click.Context,
    files: tuple[str, ...],
    axes: str | None,
    output: Path,
    etas: tuple[float | None, ...],
    alphas: str | None,
    motion: Motion | None,
    recordings: tuple[Recording, ...],
    models: tuple[str, ...],
    tolerance: float,
    linear_uplift: str,
    impacts: bool,
    quantities: str | None,
    no_validity: bool,
    workers: int | None,
    chunk_cells: int | None,
    check: int | None,
    overwrite: bool,
    resume: bool,
    strict: bool,
    shard: str | None,
    scheduler: str | None,
    json_: bool,
    quiet: bool,
) -> None:
    """Sweep every structure over a grid and write its rocking spectrum.

    Units: bounds of a_g in m/s2, or with g; omega_g in rad/s, f_g in Hz, T_g in s. A = a_scale a_g/(alpha g) and
    Omega = omega_g/p are dimensionless. NAME=VALUE gives an axis of one value. The file is OUTPUT.part until complete.

    Records shake in their own time. Structures under them have an axis scale=START:STOP:N (factor of each record; 1 if there is no
    --grid), A or a_g (its peak). Without structures --alpha gives the critical angles of blocks and the axis T=START:STOP:N their
    sizes as 2 pi/p in s (no period), or p in rad/s; alpha and tan_alpha may stand in --grid too. The file has the dimensions
    record, structure and scale (A, a_g), or record, alpha and T.
    """
    from ..dynamics.method import governing_method
    from ..motions.grid import parse_grid
    from ..reports.summary import summary_lines
    from ..spectra.file.partial import check_output
    from ..spectra.scene import PulseScene, Scene
    from ..spectra.sweep import write_scene
    from ..spectra.sweep_options import CHUNK_CELLS, SweepOptions

    wanted = [name.strip() for name in quantities.split(",")] if quantities is not None else []
    if motion is not None and axes is None:
        raise click.UsageError("no --grid; accepted are two axes, such as a_g=0.1g:1g:50,f_g=0.5:5:40, or records as --motion")
    if motion is not None and alphas is not None:
        raise click.UsageError("--alpha goes with records: give --motion")
    grid = None if motion is None else parse_grid(axes or "")
    check_output(output, overwrite, resume)
    options.refuse_own_input(output, recordings)
    scene: Scene
    texts = ""
    if grid is not None and motion is not None:
        structures, texts = options.structures_and_texts(files, etas)
        structures = options.lifting(structures, linear_uplift, models)
        method = governing_method(*structures, model=models[-1], tolerance=tolerance, dimensionless=grid.dimensionless)
        scene = PulseScene(tuple(structures), grid, motion, method)
    else:
        from ..spectra.record_scene import scene_of_words

        structures, texts = options.structures_and_texts(files, etas) if files else ([], "")
        structures = options.lifting(structures, linear_uplift, models)
        scene = scene_of_words(structures, recordings, axes=axes, alphas=alphas, etas=etas, model=models[-1], tolerance=tolerance)
    options.remark_on(grid=grid, spans=axes or "")
    settings = SweepOptions(
        workers=options.at_most_the_cpus(workers, quiet),
        chunk_cells=chunk_cells or CHUNK_CELLS,
        check=check,
        impacts=impacts,
        quantities=[*wanted, "linear"] if len(models) > 1 else wanted,
        overwrite=overwrite,
        resume=resume,
        strict=strict,
        scheduler=scheduler,
        shard=None if shard is None else options.part_of(shard),
        documents=texts,
        history=f"{options.now()}: {streams.printable(shlex.join(['rocking', *sys.argv[1:]]))}",
        sample_validity=not (no_validity or quiet),
        progress=ProgressLine("spectrum", quiet, "chunks"),
        tell=partial(options.note, quiet=quiet),
    )
    summary = write_scene(scene, output, settings)
    options.note_models([scene.method], structures, models[-1:], grid is not None and grid.dimensionless, quiet)
    for line in summary_lines(summary, str(output)):
        options.note(line, quiet)
    if json_:
        options.emit([{"output": str(output), **summary.record()}], "json")
    if summary.failed:
        context.exit(4)
