"""`rocking spectrum`: structures over a grid of amplitude and frequency, to an HDF5
file.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from . import equations, ground, options
from .command import command, flag, group, option, partly, refuse
from .printing import emit, is_quiet, note, quiet
from .progress import ProgressLine


@command(
    "rocking spectrum configs/block.yaml --grid a_g=0.1g:1g:50,f_g=0.5:5:40 -o"
    " block.h5",
    quiet,
)
def spectrum(
    files: tuple[str, ...] = options.files(),
    axes: str | None = option(
        "--grid",
        "a_g=START:STOP:N[:log],omega_g=… (or f_g, T_g), or A=…,Omega=…; see above.",
        metavar="AXES",
    ),
    output: Path = options.output("The HDF5 file to write.", required=True),
    impacts: bool = flag(
        "--impacts",
        "Store the impacts during the shaking, without those of a last sequence of"
        " impacts below the peak.",
    ),
    quantity: str | None = option(
        "--quantity",
        "Also store: condition (sensitivity to the input), linear, velocity_ratio.",
        metavar="NAME,…",
    ),
    no_validity: bool = flag(
        "--no-validity",
        "Do not compare cells of a linear sweep with the nonlinear equation.",
    ),
    chunk_cells: int | None = option(
        "--chunk", "Cells in one unit of work.", type=click.IntRange(1), metavar="CELLS"
    ),
    check: int | None = option(
        "--verify-cells",
        "Cells to verify by an independent solver.",
        type=click.IntRange(0, 10_000),
        metavar="N",
    ),
    strict: bool = options.strict(),
    json_: bool = flag(
        "--json", "The closing summary as a JSON record on standard output."
    ),
    sizeless: equations.Sizeless = group(equations.Sizeless),
    motions: ground.BothWays = group(ground.BothWays),
    model: equations.Equations = group(equations.Equations),
    sweep: options.Sweep = group(options.Sweep),
) -> None:
    """Sweep every structure over a grid and write its rocking spectrum.

    Bounds of a_g are in m/s2, or with g; omega_g in rad/s, f_g in Hz, T_g in s. A =
    a_scale a_g/(alpha g) and Omega = omega_g/p are dimensionless. NAME=VALUE gives an
    axis of one value. The file is OUTPUT.part until complete.

    A record has its own time. Structures under records have an axis scale=START:STOP:N
    (factor of each record; 1 without --grid), A or a_g (the peak). Without structures
    --alpha gives the critical angles of blocks and the axis T=START:STOP:N their sizes
    as 2 pi/p in s. For a family of structures: rocking params FILE --vary
    KEY=START:STOP:N --json.
    """
    from ..dynamics.method import direction_in_words
    from ..motions.grid import parse_grid
    from ..reports.summary import summary_lines
    from ..spectra.file.writer import check_output
    from ..spectra.scene import PulseScene, Scene
    from ..spectra.sweep import CHUNK_CELLS, SweepOptions, write_scene

    files, shaken = motions.several(files, one_upwards=True)
    quantities = (
        [name.strip() for name in quantity.split(",")] if quantity is not None else []
    )
    if len(model.models) > 1:
        quantities.append("linear")
    if shaken.motion is not None and axes is None:
        raise click.UsageError(
            "no --grid: give two axes, such as a_g=0.1g:1g:50,f_g=0.5:5:40, or records"
            " as --motion"
        )
    if shaken.motion is not None:
        refuse("goes with records: give --motion", "alphas")
    grid = None if shaken.motion is None else parse_grid(axes or "")
    check_output(output, sweep.overwrite, sweep.resume)
    options.refuse_own_input(output, shaken.recordings)
    scene: Scene
    model = replace(model, model=model.models[-1])
    if grid is not None and shaken.motion is not None:
        structures, texts = options.structures_of(files, sizeless.etas, each=True)
        structures = model.lifting(structures)
        scene = PulseScene(
            tuple(structures),
            grid,
            shaken.motion,
            model.methods(structures, grid.dimensionless)[0],
        )
    else:
        from ..spectra.record_scene import scene_of_words

        structures, texts = (
            options.structures_of(files, sizeless.etas, each=True)
            if files
            else ([], "")
        )
        structures = model.lifting(structures)
        equation: dict[str, Any] = {"model": model.model, "tolerance": model.tolerance}
        scene = scene_of_words(
            structures,
            shaken.recordings,
            axes=axes,
            alphas=sizeless.alphas,
            etas=sizeless.etas,
            **equation,
        )
    options.remark_on(grid=grid, spans=axes or "")
    settings = SweepOptions(
        chunk_cells=chunk_cells or CHUNK_CELLS,
        check=check,
        impacts=impacts,
        quantities=quantities,
        strict=strict,
        history=f"{options.now()}: {options.command_line()}",
        sample_validity=not (no_validity or is_quiet()),
        progress=ProgressLine("spectrum", "chunks"),
        **sweep.writing(texts),
    )
    summary = write_scene(scene, output, settings)
    lines = model.in_words(
        [scene.method], structures, grid is not None and grid.dimensionless
    )
    note(*lines, *direction_in_words(*structures), *summary_lines(summary, str(output)))
    if json_:
        emit([{"output": str(output), **summary.row()}], form="json")
    partly(summary.failed)
