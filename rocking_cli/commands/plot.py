"""`rocking plot`: figures of spectra files and of the CSV that the commands print."""

from pathlib import Path
from typing import Any

import click

from . import options, streams
from .command import argument, command, flag, group, option, refuse, refuse_together
from .parameter_types import InputPath, OutputPath
from .printing import note, quiet, units, units_of


@command(
    "rocking spectrum --eta 0.9 --grid A=0.5:8:40,Omega=1:6:40 -o map.h5 && rocking"
    " plot map.h5 --text",
    quiet,
    units,
)
def plot(
    files: tuple[Path, ...] = argument(
        nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE..."
    ),
    output: Path | None = options.output("The figure: .png, .svg or .pdf."),
    structure: str | None = option(
        "--structure",
        "Structure (or record) of the map (default: the first).",
        metavar="NAME",
    ),
    every: bool = flag(
        "--all", "Draw a panel for every structure (or record) of a spectra file."
    ),
    cut: str | None = option(
        "--slice",
        "Draw a slice at this value, such as f_g=1.5, instead of a map.",
        metavar="AXIS=VALUE",
    ),
    over: str | None = option(
        "--over",
        "The axis of a family (default: the first key varied).",
        metavar="KEY[/KEY]",
    ),
    log: str | None = option(
        "--log", "Logarithmic axes.", type=click.Choice(["x", "y", "xy"])
    ),
    phase: bool = flag(
        "--phase-portrait",
        "Draw the phase portrait of a response, with the separatrix.",
    ),
    align: bool = flag(
        "--align", "Count the time of each response from its largest rotation."
    ),
    animate: Path | None = option(
        "--animate",
        "Animate the body of a response in real time.",
        type=OutputPath(),
        metavar="OUT.gif",
    ),
    body: str | None = option(
        "--body",
        "Structure of --animate and --phase-portrait (default: the block of its p,"
        " alpha).",
        type=InputPath(),
    ),
    text: bool = flag(
        "--text", "Draw a spectra file as text in the terminal, without matplotlib."
    ),
    looks: options.Looks = group(options.Looks),
    overwrite: bool = options.overwrite(),
) -> None:
    """Draw a spectra file (overturning map or slice), or the CSV of check, envelope,
    response, compare --curves, params --vary, fragility --curve or accuracy.

    For records over alpha and T the figure shows the median of theta_max/alpha with 16
    to 84 %, or the map of the named record.

    FILE may be - for CSV on standard input; several responses go into one panel. Axes
    carry units: g and Hz unless --units says otherwise. Figures need matplotlib: pip
    install matplotlib.
    """
    from ..reports.drawing_files import draw, is_spectra_file
    from ..spectra.file.reader import SpectraFile

    file, *others = files
    if text:
        if others:
            raise click.UsageError(f"--text: found {len(files)} files; expected one")
        refuse("does not go with --text", "output")
        if not is_spectra_file(file):
            raise click.UsageError(
                f"{file}: --text draws spectra files (.h5), and -o FIGURE.png CSV as"
                " well"
            )
    if is_spectra_file(file):
        refuse("goes with CSV, of a family (--vary)", "over")
        refuse("goes with CSV, of a response", "phase", "align", "animate")
        refuse_together("structure", "every", "cut")
    else:
        refuse("goes with a spectra file (.h5)", "structure", "every", "cut")
    if animate is None and not phase:
        refuse("goes with --animate and --phase-portrait", "body")
    if text:
        from ..reports.figures.characters import text_map

        with SpectraFile(file) as spectrum:
            streams.put(*text_map(spectrum, structure, cut))
        return
    look = looks.look()
    document = (
        None if body is None else options.documents_of((body,), 1, "a response")[0]
    )
    if output is None and animate is None:
        raise click.UsageError(
            "no output: give -o FIGURE.png (or .svg, .pdf), or --text"
        )
    if output is not None:
        instead = "; `text` needs nothing" if is_spectra_file(file) else ""
        options.check_target(output, overwrite, instead=instead)
    if animate is not None:
        from ..reports.figures.animation import FORMATS
        from ..reports.figures.animation import animate as moving
        from ..reports.rows import rows_of

        options.check_target(animate, overwrite, FORMATS)
        moving(
            rows_of(str(file)),
            animate,
            document,
            look=look,
            overwrite=overwrite,
            tell=note,
        )
    if output is None:
        return
    drawn: dict[str, Any] = {
        "structure": structure,
        "cut": cut,
        "every": every,
    }  # of a spectra file
    drawn |= {
        "over": over,
        "portrait": phase,
        "body": document,
        "align": align,
    }  # of rows
    remark = draw(
        files,
        output,
        log=log or "",
        units=units_of(),
        look=look,
        overwrite=overwrite,
        tell=note,
        **drawn,
    )
    if isinstance(remark, str):
        note(remark)
