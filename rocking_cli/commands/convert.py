"""`rocking convert`: the cells of a spectra file as rows."""

from __future__ import annotations

import click

from . import options
from .parameter_types import InputPath


@click.command(epilog="Example: rocking convert slice.h5 --csv | head")
@click.argument("file", type=InputPath())
@options.output_form
def convert(file: str, form: str | None) -> None:
    """Stream the computed cells of a spectra file, one a row (CSV unless --json)."""
    from ..spectra.file.reader import SpectraFile

    with SpectraFile(file) as spectrum:
        if not spectrum.done.any():
            options.note(f"{file}: none of its cells is computed yet", quiet=False)
        options.emit(
            spectrum.cells(),
            form or "csv",
            (*spectrum.frame.dimensions, "outcome", "theta_ratio"),
        )
