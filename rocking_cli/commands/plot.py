"""`rocking plot`: figures of spectra files and of the CSV that the commands print."""

from __future__ import annotations

from pathlib import Path

import click

from . import options, streams
from .command import argument, command, option
from .printing import note, quiet, units, units_of


@command("rocking plot slice.h5 --text", quiet, units)
def plot(
    file: Path = argument(type=click.Path(path_type=Path)),
    output: Path | None = options.output(help="The figure: .png, .svg or .pdf."),
    structure: str | None = option("--structure", metavar="NAME", help="Structure (or record) of the map (default: the first)."),
    every: bool = option("--all", is_flag=True, help="A panel for every structure (or record) of a spectra file."),
    cut: str | None = option(
        "--slice", metavar="AXIS=VALUE", help="Rocking spectra along the other axis instead, such as f_g=1.5 or a_g=0.3g."
    ),
    over: str | None = option("--over", metavar="KEY[/KEY]", help="The axis of a family (default: the first key varied)."),
    log: str | None = option("--log", type=click.Choice(["x", "y", "xy"]), help="Logarithmic axes."),
    text: bool = option("--text", is_flag=True, help="A quick look in the terminal, without matplotlib."),
    overwrite: bool = options.overwrite(),
) -> None:
    """Draw a spectra file (overturning map or slice), or the CSV of check, envelope, response, compare --curves, params --vary,
    fragility --curve or accuracy.

    For records over alpha and T the figure shows the median of theta_max/alpha with 16 to 84 %, or the map of the named record.

    FILE may be - for CSV on standard input. Axes carry units: g and Hz unless --units says otherwise. Figures need the extra:
    pip install 'rocking[plot]'.
    """
    from ..publishing import check_target
    from ..reports.drawing_files import draw, is_spectra_file
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
        units=units_of(),
        overwrite=overwrite,
        tell=note,
    )
    if told:
        note(told)
