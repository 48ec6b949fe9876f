"""`rocking plot`: figures of spectra files and of the CSV that the commands print."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from . import options, streams
from .parameter_types import OutputPath


@click.command(epilog="Example: rocking plot slice.h5 --text")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=OutputPath(), help="The figure: .png, .svg or .pdf.")
@click.option("--structure", metavar="NAME", help="Which structure (or record) of a spectra file is mapped (default: the first).")
@click.option("--all", "every", is_flag=True, help="A panel for every structure (or record) of a spectra file.")
@click.option("--slice", "cut", metavar="AXIS=VALUE", help="Rocking spectra along the other axis instead, such as f_g=1.5 or a_g=0.3g.")
@click.option("--over", metavar="KEY[/KEY]", help="The axis of a family, such as base_radius/height (default: the first key varied).")
@click.option("--log", type=click.Choice(["x", "y", "xy"]), help="Logarithmic axes.")
@click.option("--text", is_flag=True, help="A quick look in the terminal, without matplotlib.")
@options.units
@options.overwrite
@options.quiet
def plot(
    file: Path,
    output: Path | None,
    structure: str | None,
    every: bool,
    cut: str | None,
    over: str | None,
    log: str | None,
    text: bool,
    overwrite: bool,
    quiet: bool,
) -> None:
    """Draw a spectra file (overturning map or slice), or the CSV of check, envelope, response, compare --curves, params --vary,
    fragility --curve or accuracy.

    Of records over alpha and T it draws theta_max/alpha, median and 16 to 84 %, and the map of one of them where it is named.

    FILE may be - for CSV on standard input. Axes carry units: g and Hz unless --units says otherwise. Figures need the extra:
    pip install 'rocking[plot]'.
    """
    from ..publishing import check_target
    from ..reports.plot import draw, is_spectra_file
    from ..spectra.file.reader import SpectraFile

    if text and output is not None:
        raise click.UsageError("--text does not go with -o")
    if text and not is_spectra_file(file):
        raise click.UsageError(f"{file}: --text draws spectra files (.h5), and -o FIGURE.png CSV as well")
    given = {"--structure": structure is not None, "--all": every, "--slice": cut is not None}
    for flag, there in given.items():
        if there and not is_spectra_file(file):
            raise click.UsageError(f"{flag} goes with a spectra file (.h5)")
    if sum(given.values()) > 1:
        raise click.UsageError(f"{' and '.join(flag for flag, there in given.items() if there)} do not go together")
    if over is not None and is_spectra_file(file):
        raise click.UsageError("--over goes with the CSV of params --vary")
    if text:
        from ..reports.figures.characters import text_map

        with SpectraFile(file) as spectrum:
            for line in text_map(spectrum, structure, cut):
                streams.put(line)
        return
    if output is None:
        raise click.UsageError("no output: give -o FIGURE.png (or .svg, .pdf), or --text")
    check_target(output, overwrite, options.FIGURES)
    told = draw(
        file,
        output,
        structure=structure,
        cut=cut,
        every=every,
        over=over,
        log=log or "",
        units=options.units_of(),
        overwrite=overwrite,
        tell=partial(options.note, quiet=quiet),
    )
    if told:
        options.note(told, quiet)
