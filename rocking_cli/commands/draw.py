"""`rocking draw`: structures to scale."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from . import options
from .parameter_types import OutputPath

MOST = 12  # panels that a page shows


@click.command(epilog="Example: rocking draw configs/arch.yaml -o arch.svg")
@options.files
@click.option("-o", "--output", required=True, type=OutputPath(), help="The figure: .png, .svg or .pdf.")
@options.units
@options.overwrite
def draw(files: tuple[str, ...], output: Path, overwrite: bool) -> None:
    """Draw structures to scale, a panel each: outline, pivots, mass centre, R and alpha, and dashed the shape at alpha.

    An arch has its voussoirs, its hinges numbered from springing A, and the linkage displaced; a cracked spire its crack; a stack
    what stays below the interface it rocks on. Kind parameters has no geometry. Figures need the extra: pip install 'rocking[plot]'.
    """
    from ..publishing import check_target
    from ..reports.figures.drawing import draw_structures
    from ..structures import read_documents

    if not files:
        raise click.UsageError("no structure: give FILE, or - for standard input")
    check_target(output, overwrite, options.FIGURES)
    documents = [document for path in files for document in read_documents(path)]
    if len(documents) > MOST:
        raise click.UsageError(f"found {len(documents)} structures; accepted are up to {MOST} in a figure")
    draw_structures(documents, output, units=options.units_of(), overwrite=overwrite, tell=partial(options.note, quiet=False))
