"""`rocking identify`: inset or alpha, p and eta from measured free rocking."""

from __future__ import annotations

from dataclasses import dataclass

import click

from . import options
from .command import argument, command, flag, group, option
from .parameter_types import InputPath, Parsed, quantity
from .printing import emit, form, note, printed, units_of
from .streams import put


def _share(text: str) -> float:
    """Return a share: a number, or one in percent. Raises ArgumentError."""
    from ..documents.quantities import parse_quantity

    number, percent, _ = text.strip().partition("%")
    return parse_quantity(number, "number") * (0.01 if percent else 1.0)


@dataclass(frozen=True)
class IdentifyOptions:
    """How traces are read and fitted."""

    fit: str | None = option(
        "--fit",
        "Unknowns (default: the first that the structure allows).",
        type=click.Choice(["inset", "alpha", "alpha,p"]),
    )
    two_sides: bool = flag("--two-sides", "The two edges may differ.")
    column: str | None = option(
        "--column", "Name of the column, where a trace has several.", metavar="NAME"
    )
    height: float | None = option(
        "--height",
        "Height over the base of the point whose displacement was measured.",
        type=quantity("length"),
    )
    lowpass: float | None = option(
        "--lowpass",
        "Cut-off frequency of the filter of a gyroscope, such as 60Hz.",
        type=quantity("frequency"),
    )
    start: float | None = option(
        "--from", "Time from which a trace counts.", type=quantity("time")
    )
    stop: float | None = option(
        "--to", "Time up to which a trace counts.", type=quantity("time")
    )
    least: float = option(
        "--least",
        "Least peak over the first one of a half-cycle that is used.",
        type=Parsed("share", _share),
        default="6%",
    )
    gain_error: float = option(
        "--gain-error",
        "Standard deviation of the gain of the sensor, such as 1%.",
        type=Parsed("share", _share),
        default="0%",
    )
    level: float = option(
        "--level",
        "Level of the intervals.",
        type=Parsed("share", _share),
        default="95%",
    )


@command("rocking identify configs/free_rocking.csv block:0.5x2", printed)
def identify(
    files: tuple[str, ...] = argument(
        nargs=-1, type=InputPath(), metavar="TRACE... [STRUCTURE]"
    ),
    wanted: IdentifyOptions = group(IdentifyOptions),
    figure: options.FigureFile = group(options.FigureFile),
) -> None:
    """Fit the effective edges, p and eta of a rigid body to measured free rocking.

    TRACE is a table with a time and a rotation, angular speed, displacement, uplift or
    acceleration, or times of impacts; the units stand in its heading. STRUCTURE is a
    document or a text such as block:0.5x2: then the fit finds the inset, without one
    alpha and p. A row a release and, of several, their mean; with --csv a row an
    impact. Lines to paste into the document stand below. A trace that is no free
    rocking is refused (exit code 3).
    """
    from ..responses.identification.identified import COLUMNS, IMPACT_COLUMNS
    from ..responses.identification.identify import identify as fitted
    from ..responses.identification.trace import DIMENSIONS, Trace, trace_or_documents

    figure.check()
    given = [trace_or_documents(one, wanted.column) for one in files]
    traces = [one for one in given if isinstance(one, Trace)]
    documents = [one for two in given if not isinstance(two, Trace) for one in two]
    if not traces:
        raise click.UsageError("no trace: give TRACE (- for standard input)")
    if len(documents) > 1:
        raise click.UsageError(f"found {len(documents)} structures; expected one")
    found = fitted(
        traces,
        documents[0] if documents else None,
        **{key: x for key, x in vars(wanted).items() if key != "column"},
    )
    if form() == "csv":
        emit((row for one in found for row in one.impacts), IMPACT_COLUMNS)
    else:
        reading = DIMENSIONS[traces[0].quantity]
        alike = all(trace.quantity == traces[0].quantity for trace in traces)
        readings = dict.fromkeys(("noise", "rms", "offset"), reading) if alike else {}
        emit((one.row for one in found), COLUMNS, dimensions=readings)
    lines = found[-1].lines
    if form() is not None:
        note(*lines)
    elif lines:
        put("", *lines)
    if figure.output is not None:
        from ..errors import UsageError
        from ..reports.figures.free_rocking import fits
        from ..reports.units import Units

        drawn = [one for one in found if one.course is not None]
        if not drawn:
            raise UsageError(f"{figure.output}: times of impacts alone give no figure")
        with figure.canvas() as canvas:
            fits(canvas, drawn, units_of() or Units())
    note(*(line for one in found for line in one.remarks))
