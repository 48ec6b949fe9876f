"""`rocking spectrum`: structures over a grid of amplitude and frequency, to an HDF5
file.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from . import equations, ground, options
from .command import command, flag, group, option, partly, refuse
from .printing import detail, emit, is_quiet, note, quiet
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..motions.grid import Grid
    from ..spectra.scene import Scene
    from ..structures import RockingParameters


# cells of which a line tells the size before the first one, and those of one call
_MANY, _MOST = 1_000_000, 1_000_000_000
_BYTES = 9  # of a cell in the file, before it is compressed


@dataclass(frozen=True)
class SpectrumOptions:
    """The cells to compute, what the file stores of them, and how they are verified."""

    axes: str | None = option(
        "--grid",
        "a_g=START:STOP:N[:log],omega_g=… (or f_g, T_g), or A=…,Omega=…; see above.",
        metavar="AXES",
    )
    output: Path = options.output("The HDF5 file to write.", required=True)
    impacts: bool = flag(
        "--impacts",
        "Store impacts_at_least: the impacts until a proof ends the computation.",
    )
    quantity: str | None = option(
        "--quantity",
        "Also store: condition (error bound over tolerance), linear, velocity_ratio.",
        metavar="NAME,…",
    )
    no_validity: bool = flag(
        "--no-validity",
        "Do not compare cells of a linear sweep with the nonlinear equation.",
    )
    chunk_cells: int | None = option(
        "--chunk", "Cells in one unit of work.", type=click.IntRange(1), metavar="CELLS"
    )
    check: int | None = option(
        "--verify-cells",
        "Cells to verify by an independent solver; by default 1 to 64, by the size"
        " of the sweep.",
        type=click.IntRange(0, 10_000),
        metavar="N",
    )
    strict: bool = options.strict()
    json_: bool = flag(
        "--json", "The closing summary as a JSON record on standard output."
    )

    def quantities(self, model: equations.Equations) -> list[str]:
        """Return the names of the further quantities to store."""
        stated = self.quantity.split(",") if self.quantity is not None else []
        return [name.strip() for name in stated] + ["linear"] * (len(model.models) > 1)


@command(
    "rocking spectrum configs/block.yaml --grid a_g=0.1g:1g:50,f_g=0.5:5:40 -o"
    " block.h5",
    quiet,
)
def spectrum(
    files: tuple[str, ...] = options.files(),
    wanted: SpectrumOptions = group(SpectrumOptions),
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
    from ..reports.remarks import direction_in_words
    from ..reports.summary import summary_details, summary_lines
    from ..spectra.file.partial_file import check_output
    from ..spectra.sweep import write_scene
    from ..spectra.sweep_options import CHUNK_CELLS, SweepOptions

    files, shaken = motions.several(files, one_upwards=True)
    grid = _grid(wanted, shaken)
    check_output(wanted.output, sweep.overwrite, sweep.resume)
    options.refuse_own_input(wanted.output, shaken.recordings)
    # with --model both the file holds the nonlinear equation and what differs from it
    quantities = wanted.quantities(model)
    model = replace(model, model=model.models[-1])
    structures = (
        options.structures_of(files, sizeless.etas, each=True)
        if files or grid is not None
        else []
    )
    structures = model.lifting(structures)
    scene = _scene(structures, shaken, grid, wanted, sizeless, model)
    options.remark_on(grid=grid, spans=wanted.axes or "")
    _tell_size(scene, wanted.output, sweep)

    settings = SweepOptions(
        chunk_cells=wanted.chunk_cells or CHUNK_CELLS,
        check=wanted.check,
        impacts=wanted.impacts,
        quantities=quantities,
        strict=wanted.strict,
        history=f"{options.now()}: {options.command_line()}",
        sample_validity=not (wanted.no_validity or is_quiet()),
        progress=ProgressLine("spectrum", "chunks"),
        **sweep.writing(structures),
    )
    summary = write_scene(scene, wanted.output, settings)
    dimensionless = grid is not None and grid.dimensionless
    note(*direction_in_words(*structures), *summary_lines(summary, str(wanted.output)))
    detail(
        *model.in_words([scene.method], structures, dimensionless),
        *summary_details(summary),
    )
    if wanted.json_:
        # Where no cell was checked, no difference is known.
        known = {} if summary.checked_cells else {"largest_difference": None}
        row = {"output": str(wanted.output), **summary.row(), **known}
        emit([row], form="json")
    partly(summary.failed)


def _grid(wanted: SpectrumOptions, shaken: ground.Ground) -> Grid | None:
    """Return the grid of a pulse or motion document, None for records, whose axes have
    other names. Raises UsageError.
    """
    from ..motions.grid import parse_grid

    if shaken.motion is None:
        return None
    if wanted.axes is None:
        raise click.UsageError(
            "no --grid: give two axes, such as a_g=0.1g:1g:50,f_g=0.5:5:40, or records"
            " as --motion"
        )
    refuse("goes with records: give --motion", "alphas")
    return parse_grid(wanted.axes)


def _tell_size(scene: Scene, output: Path, sweep: options.Sweep) -> None:
    """Print how many cells a large grid has and how long its file is. Raises UsageError
    for more cells than one call computes.
    """
    cells = math.prod(scene.shape)
    if cells > _MOST and sweep.shard is None and sweep.scheduler is None:
        parts = math.ceil(cells / _MOST)
        raise click.UsageError(
            f"found {cells:,} cells; expected up to {_MOST:,} in one call: compute"
            f" parts of them by --shard 1/{parts}"
        )
    if cells >= _MANY:
        megabytes = cells * _BYTES / 1e6
        note(f"{cells:,} cells into {output}: up to {megabytes:,.0f} MB")


def _scene(
    structures: list[RockingParameters],
    shaken: ground.Ground,
    grid: Grid | None,
    wanted: SpectrumOptions,
    sizeless: equations.Sizeless,
    model: equations.Equations,
) -> Scene:
    """Return the cells of structures over a grid, or under records. Raises
    UsageError.
    """
    if grid is not None and shaken.motion is not None:
        from ..spectra.scene import PulseScene

        (method,) = model.methods(structures, grid.dimensionless)
        return PulseScene(tuple(structures), grid, shaken.motion, method)
    from ..spectra.record_scene import scene_of_words

    return scene_of_words(
        structures,
        shaken.recordings,
        axes=wanted.axes,
        alphas=sizeless.alphas,
        etas=sizeless.etas,
        model=model.model,
        tolerance=model.tolerance,
    )
