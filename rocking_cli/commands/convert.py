"""`rocking convert`: the cells of a spectra file as rows."""

from __future__ import annotations

import click

from .parameter_types import InputPath
from .printing import emit, printed, warn


@click.command(epilog="Example: rocking convert slice.h5 --csv | head")
@click.argument("file", type=InputPath())
@printed
def convert(file: str) -> None:
    """Stream the computed cells of a spectra file, one row for each cell (CSV unless --json)."""
    from ..spectra.file.reader import SpectraFile

    with SpectraFile(file) as spectrum:
        if not spectrum.done.any():
            warn(f"{file}: none of its cells is computed yet")
        emit(spectrum.cells(), (*spectrum.frame.dimensions, "outcome", "theta_ratio"), form="csv")
