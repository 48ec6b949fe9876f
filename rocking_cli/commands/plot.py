"""`rocking plot`: figures of spectra files and of the CSV that the commands print."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import click

from . import options, streams
from .command import argument, command, flag, group, option, refuse, refuse_together
from .parameter_types import InputPath, NameInFile, OutputPath
from .printing import note, quiet, units, units_of


@dataclass(frozen=True)
class PlotOptions:
    """What to draw of the files, and where."""

    output: Path | None = options.output("The figure: .png, .svg or .pdf.")
    structure: str | None = option(
        "--structure",
        "Structure (or record) of the map (default: the first).",
        type=NameInFile(),
        metavar="NAME",
    )
    every: bool = flag(
        "--all", "Draw a panel for every structure (or record) of a spectra file."
    )
    cut: str | None = option(
        "--slice",
        "Draw a slice at this value, such as f_g=1.5, instead of a map.",
        metavar="AXIS=VALUE",
    )
    over: str | None = options.over()
    log: str | None = option(
        "--log", "Logarithmic axes.", type=click.Choice(["x", "y", "xy"])
    )
    xlim: str | None = option(
        "--xlim", "Ends of the abscissa, in its unit.", metavar="FROM:TO"
    )
    ylim: str | None = option(
        "--ylim", "Ends of the ordinate, in its unit.", metavar="FROM:TO"
    )
    phase: bool = flag(
        "--phase-portrait",
        "Draw the phase portrait of a response, with the separatrix.",
    )
    data: str | None = option(
        "--data",
        "A measured rotation over a response: CSV of t [s] and theta [deg].",
        type=InputPath(),
    )
    align: bool = flag(
        "--align", "Count the time of each response from its largest rotation."
    )
    animate: Path | None = option(
        "--animate",
        "Animate the body of a response in real time.",
        type=OutputPath(),
        metavar="OUT.gif",
    )
    body: str | None = option(
        "--body",
        "Structure of --animate and --phase-portrait (default: the block of its p,"
        " alpha).",
        type=InputPath(),
    )
    text: bool = flag(
        "--text", "Draw a spectra file as text in the terminal, without matplotlib."
    )


@command(
    "rocking spectrum --eta 0.9 --grid A=0.5:8:40,Omega=1:6:40 -o map.h5 && rocking"
    " plot map.h5 --text",
    quiet,
    units,
)
def plot(
    files: tuple[str, ...] = argument(
        nargs=-1, required=True, type=InputPath(), metavar="FILE..."
    ),
    wanted: PlotOptions = group(PlotOptions),
    looks: options.Looks = group(options.Looks),
    overwrite: bool = options.overwrite(),
) -> None:
    """Draw a spectra file (overturning map or slice), or the CSV of check, envelope,
    response, compare --curves, params --vary, fragility --curve, records
    --export-spectrum or accuracy; or a record over time.

    For records over alpha and T the figure shows the median of theta_max/alpha with 16
    to 84 %, or the map of the named record.

    FILE may be - for CSV on standard input; several responses go into one panel. Axes
    carry units: g and Hz unless --units says otherwise. Figures need matplotlib: pip
    install matplotlib.
    """
    paths = tuple(map(Path, files))
    _refuse_contradictions(paths, wanted)
    if wanted.text:
        _put_map(paths[0], wanted)
        return
    look = looks.look()
    document = (
        None
        if wanted.body is None
        else options.documents_of((wanted.body,), 1, "a response")[0]
    )
    _check_targets(paths[0], wanted, overwrite)
    if wanted.animate is not None:
        from ..reports.figures.animation import animate
        from ..reports.rows import rows_of

        rows = rows_of(str(paths[0]))
        animate(
            rows, wanted.animate, document, look=look, overwrite=overwrite, tell=note
        )
    if wanted.output is not None:
        from ..reports.drawing_files import draw

        remark = draw(
            paths,
            wanted.output,
            structure=wanted.structure,
            cut=wanted.cut,
            every=wanted.every,
            over=wanted.over,
            log=wanted.log or "",
            xlim=_ends("--xlim", wanted.xlim),
            ylim=_ends("--ylim", wanted.ylim),
            units=units_of(),
            look=look,
            portrait=wanted.phase,
            body=document,
            align=wanted.align,
            data=wanted.data,
            overwrite=overwrite,
            tell=note,
        )
        if isinstance(remark, str):
            note(remark)


def _ends(flag: str, text: str | None) -> tuple[float, float] | None:
    """Return the ends of an axis that an option states. Raises click.UsageError."""
    if text is None:
        return None
    try:
        low, high = map(float, text.split(":"))
        if -math.inf < low < high < math.inf:
            return low, high
    except ValueError:
        pass
    raise click.UsageError(
        f"{flag}: found {text!r}; expected two numbers FROM:TO in the unit of the axis,"
        " such as 0:2"
    )


def _refuse_contradictions(files: tuple[Path, ...], wanted: PlotOptions) -> None:
    """Raise click.UsageError for options that have no effect on these files."""
    from ..reports.drawing_files import is_spectra_file

    file, *others = files
    if wanted.text:
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
        refuse("goes with CSV, of a response", "phase", "align", "animate", "data")
        refuse_together("structure", "every", "cut")
    else:
        refuse("goes with a spectra file (.h5)", "structure", "every", "cut")
    if wanted.animate is None and not wanted.phase:
        refuse("goes with --animate and --phase-portrait", "body")


def _put_map(file: Path, wanted: PlotOptions) -> None:
    """Print the map or slice of a spectra file as text."""
    from ..reports.drawing_files import in_figure_units
    from ..reports.figures.characters import text_map
    from ..spectra.file.reader import SpectraFile

    units = in_figure_units(units_of())
    with SpectraFile(file) as spectrum:
        streams.put(*text_map(spectrum, wanted.structure, wanted.cut, units))


def _check_targets(file: Path, wanted: PlotOptions, overwrite: bool) -> None:
    """Raise UsageError for figures that cannot or must not be written."""
    if wanted.output is None and wanted.animate is None:
        raise click.UsageError(
            "no output: give -o FIGURE.png (or .svg, .pdf), or --text"
        )
    if wanted.output is not None:
        from ..reports.drawing_files import is_spectra_file

        instead = "; `text` needs nothing" if is_spectra_file(file) else ""
        options.check_target(wanted.output, overwrite, instead=instead)
    if wanted.animate is not None:
        from ..reports.figures.animation import FORMATS

        options.check_target(wanted.animate, overwrite, FORMATS)
