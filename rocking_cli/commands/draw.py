"""`rocking draw`: structures to scale."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from . import options
from .groups import takes
from .printing import note, quiet, units, units_of

MOST = 12  # panels that a page shows


@dataclass(frozen=True)
class Drawing:
    """The figure that `rocking draw` writes."""

    output: Path = options.output(required=True, help="The figure: .png, .svg or .pdf.")
    overwrite: bool = options.overwrite()


@click.command(epilog="Example: rocking draw configs/arch.yaml -o arch.svg")
@options.files
@takes(wanted=Drawing)
@units
@quiet
def draw(files: tuple[str, ...], wanted: Drawing) -> None:
    """Draw structures to scale, a panel each: outline, pivots, mass centre, R and alpha; dashed: the shape at alpha.

    For an arch the figure also has the voussoirs, the hinges numbered from springing A, and the displaced linkage; for a cracked spire
    the crack; for a stack the pieces below the interface on which it rocks. Kind parameters has no geometry. Figures need the extra:
    pip install 'rocking[plot]'.
    """
    from ..publishing import check_target
    from ..reports.figures.drawing import draw_structures

    check_target(wanted.output, wanted.overwrite, options.FIGURES)
    documents = options.documents_of(files, MOST, "a figure")
    draw_structures(documents, wanted.output, units=units_of(), overwrite=wanted.overwrite, tell=note)
