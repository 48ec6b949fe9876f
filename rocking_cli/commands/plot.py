"""`rocking plot`: figures of spectra files and of the CSV that the commands print."""

from __future__ import annotations

from pathlib import Path

import click

from . import options, streams


@click.command(epilog="Example: rocking plot slice.h5 --text")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=options.OutputPath(), help="The figure: .png, .svg or .pdf.")
@click.option("--structure", metavar="NAME", help="Which structure of a spectra file is mapped (default: the first).")
@click.option("--slice", "cut", metavar="AXIS=VALUE", help="Rocking spectra along the other axis instead of the map.")
@click.option("--log", type=click.Choice(["x", "y", "xy"]), help="Logarithmic axes.")
@click.option("--text", is_flag=True, help="A quick look in the terminal, without matplotlib.")
@options.overwrite
def plot(file: Path, output: Path | None, structure: str | None, cut: str | None, log: str | None, text: bool, overwrite: bool) -> None:
    """Draw a spectra file (overturning map or slice), or the CSV of envelope, response, compare --curves, params --vary or accuracy.

    Axes carry units. Figures need the extra: pip install 'rocking[plot]'.
    """
    from ..reports.plot import draw, is_spectra_file, text_map
    from ..spectra.reader import SpectraFile

    if text and output is not None:
        raise click.UsageError("--text does not go with -o")
    if text and not is_spectra_file(file):
        raise click.UsageError(f"{file}: --text draws spectra files (.h5), and -o FIGURE.png CSV as well")
    if text:
        with SpectraFile(file) as spectrum:
            for line in text_map(spectrum, structure, cut):
                streams.put(line)
        return
    if output is None:
        raise click.UsageError("no output: give -o FIGURE.png (or .svg, .pdf), or --text")
    options.refuse_figure(output, overwrite)
    draw(file, output, structure=structure, cut=cut, log=log or "")
