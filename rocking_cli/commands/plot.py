"""`rocking plot`: figures of spectra files and of the CSV that the commands print."""

from pathlib import Path

import click

from . import options, streams, written
from .command import argument, command, group, option
from .parameter_types import InputPath, OutputPath
from .printing import note, quiet, units, units_of


@command("rocking spectrum --eta 0.9 --grid A=0.5:8:40,Omega=1:6:40 -o map.h5 && rocking plot map.h5 --text", quiet, units)
def plot(
    files: tuple[Path, ...] = argument(nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE..."),
    output: Path | None = options.output(help="The figure: .png, .svg or .pdf."),
    structure: str | None = option("--structure", metavar="NAME", help="Structure (or record) of the map (default: the first)."),
    every: bool = option("--all", is_flag=True, help="A panel for every structure (or record) of a spectra file."),
    cut: str | None = option(
        "--slice", metavar="AXIS=VALUE", help="Rocking spectra along the other axis instead, such as f_g=1.5 or a_g=0.3g."
    ),
    over: str | None = option("--over", metavar="KEY[/KEY]", help="The axis of a family (default: the first key varied)."),
    log: str | None = option("--log", type=click.Choice(["x", "y", "xy"]), help="Logarithmic axes."),
    phase: bool = option("--phase", is_flag=True, help="The phase portrait of a response, with the separatrix."),
    align: bool = option("--align", is_flag=True, help="Count the time of each response from its largest rotation."),
    animate: Path | None = option(
        "--animate", type=OutputPath(), metavar="OUT.gif", help="The body of a response in motion, in real time."
    ),
    body: str | None = option(
        "--body", type=InputPath(), metavar="FILE", help="The structure of --animate and --phase (default: the block of its p, alpha)."
    ),
    text: bool = option("--text", is_flag=True, help="A quick look in the terminal, without matplotlib."),
    looks: written.Looks = group(written.Looks),
    overwrite: bool = options.overwrite(),
) -> None:
    """Draw a spectra file (overturning map or slice), or the CSV of check, envelope, response, compare --curves, params --vary,
    fragility --curve or accuracy.

    For records over alpha and T the figure shows the median of theta_max/alpha with 16 to 84 %, or the map of the named record.

    FILE may be - for CSV on standard input; several responses go into one panel. Axes carry units: g and Hz unless --units says
    otherwise. Figures need the extra: pip install 'rocking[plot]'.
    """
    from ..publishing import check_target
    from ..reports.drawing_files import draw, is_spectra_file
    from ..spectra.file.reader import SpectraFile

    file, *others = files
    if others and text:
        raise click.UsageError(f"--text: found {len(files)} files; expected one")
    if text and output is not None:
        raise click.UsageError("--text does not go with -o")
    if text and not is_spectra_file(file):
        raise click.UsageError(f"{file}: --text draws spectra files (.h5), and -o FIGURE.png CSV as well")
    given = {"--structure": structure is not None, "--all": every, "--slice": cut is not None}
    for flag, there in given.items():
        if there and not is_spectra_file(file):
            raise click.UsageError(f"{flag} goes with a spectra file (.h5)")
    for flag, there in {"--over": over is not None, "--phase": phase, "--align": align, "--animate": animate is not None}.items():
        if there and is_spectra_file(file):
            raise click.UsageError(f"{flag} goes with CSV, of {'a family (--vary)' if flag == '--over' else 'a response'}")
    if body is not None and animate is None and not phase:
        raise click.UsageError("--body goes with --animate and --phase")
    if sum(given.values()) > 1:
        raise click.UsageError(f"{' and '.join(flag for flag, there in given.items() if there)} do not go together")
    if text:
        from ..reports.figures.characters import text_map

        with SpectraFile(file) as spectrum:
            for line in text_map(spectrum, structure, cut):
                streams.put(line)
        return
    look = looks.look()
    document = None if body is None else options.documents_of((body,), 1, "a response")[0]
    if animate is not None:
        from ..reports.figures.animation import animate as moving
        from ..reports.rows import rows_of

        check_target(animate, overwrite, (".gif",))
        moving(rows_of(str(file)), animate, document, look=look, overwrite=overwrite, tell=note)
        if output is None:
            return
    if output is None:
        raise click.UsageError("no output: give -o FIGURE.png (or .svg, .pdf), or --text")
    check_target(output, overwrite, options.FIGURES)
    told = draw(
        files,
        output,
        structure=structure,
        cut=cut,
        every=every,
        over=over,
        log=log or "",
        units=units_of(),
        look=look,
        portrait=phase,
        body=document,
        align=align,
        overwrite=overwrite,
        tell=note,
    )
    if isinstance(told, str):
        note(told)
