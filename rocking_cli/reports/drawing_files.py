"""Figures of spectra files and of the CSV tables that the commands write.

A new figure is one file with a function of figure, rows and units, and one line in
TABLES.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..documents.document import Document
from ..documents.files import named_after
from ..errors import UsageError
from ..motions.records import Record
from ..spectra.file.reader import SpectraFile
from .figures import curves
from .figures.canvas import (
    FIGURE_UNITS,
    SOURCE,
    Axes,
    Figure,
    Look,
    canvas,
    fit_title,
    legend,
    panels,
    plain_ticks,
    require_axes,
)
from .figures.capacities import checked
from .figures.characters import place_of
from .figures.curves import accuracy, closed_forms, comparison, family
from .figures.envelopes import bands
from .figures.fragility_curves import (
    fragility_curves,
    overturning_spectra,
    two_measures,
)
from .figures.histories import measured, response, response_axes
from .figures.maps import outcome_map
from .figures.phase import phase
from .figures.records import elastic_spectra, traces
from .figures.slices import of_record, record_spectra, slice_of, spectrum_lines
from .figures.sliding import slide_history
from .rows import Rows, rows_of
from .units import Units

if TYPE_CHECKING:
    from .figures.memory import Plan

Kind = tuple[set[str], Callable[[Figure, Rows, Units], list[Axes]]]
_TABLES = (".csv", ".json", ".jsonl", "")  # of the rows that the commands print
DRAWN = (
    "check, envelope, response, compare (curves), params (a family), fragility (curves,"
    " cells) or accuracy"
)


class Opened(NamedTuple):
    """A file, or a result in memory, that a figure shows."""

    name: str  # of the file, for messages; empty for a result
    # opens a spectra file, or a spectrum in memory
    cells: Callable[[], AbstractContextManager[SpectraFile]] | None = None
    rows: Callable[[], Rows] = list  # reads the rows of a table
    plan: Plan | None = None  # draws what is no table and no spectrum


@dataclass(frozen=True)
class OfRows:
    """How a table is drawn; the fields are arguments of `draw`."""

    over: str | None = None
    portrait: bool = False
    body: Document | None = None
    align: bool = False
    data: str | Path | None = None

    def drawn(
        self, figure: Figure, name: str, rows: Rows, units: Units, alone: Axes | None
    ) -> list[Axes]:
        """Draw rows by their columns; name: that of their source; alone: the Axes of
        the caller, None in a figure. Raises UsageError.
        """
        axes = self._table(figure, name, rows, units, alone)
        if self.data is None:
            return axes
        timed = "t" in rows[0] and _is_response(rows[0])
        if self.portrait or self.align or not timed:
            raise UsageError("`data` goes with a response over its time")
        from ..responses.identification.trace import read_trace

        measured(axes[0], read_trace(self.data), units)
        return axes

    def _table(
        self, figure: Figure, name: str, rows: Rows, units: Units, alone: Axes | None
    ) -> list[Axes]:
        there = set(rows[0])
        if "event" in there:
            raise UsageError(
                f"{name}: found events; expected the time history, which rocking"
                " response prints without them"
            )
        least = {"first_overturning_a", "A_from"}
        varied = any(heading.startswith(curves.VARIED) for heading in there)
        try:
            if varied and there & least:
                return curves.least_amplitudes(figure, rows, units, self.over)
            if self.portrait:
                return phase(figure, rows, units, self.body)
            if self.align or _is_response(rows[0]):
                if alone is not None:
                    return [response_axes(alone, rows, units, self.align)]
                return response(figure, rows, units, self.align)
            for wanted, kind in TABLES:
                if wanted <= there:
                    return kind(figure, rows, units)
            if {"p", "alpha", "eta", "lambda"} <= there:
                return family(figure, rows, units, self.over)
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            raise UsageError(f"{name}: cannot be drawn: {error}") from None
        found = ", ".join(sorted(there))[:80]
        raise UsageError(
            f"{name}: found the columns {found}; expected the CSV table of one of these"
            f" commands: {DRAWN}"
        )


def draw(
    source: Any,
    target: str | Path | Axes,
    *,
    structure: str | None = None,
    cut: str | None = None,
    every: bool = False,
    over: str | None = None,
    log: str = "",
    xlim: tuple[float, float] | None = None,
    ylim: tuple[float, float] | None = None,
    units: Units | None = None,
    look: Look | None = None,
    portrait: bool = False,
    body: Document | None = None,
    align: bool = False,
    data: str | Path | None = None,
    overwrite: bool = True,
    tell: Callable[[str], None] | None = None,
) -> str | Axes | None:
    """Draw results, of a file or in memory, into a PNG, SVG or PDF file, or into Axes.

    Parameters
    ----------
    source
        a spectra file, a CSV file of a command ("-": standard input), or the CSV files
        of several responses; or a result in memory: of `time_history`, `spectrum`,
        `check`, `code_check`, `envelope`, `trace_envelope`, `closed_form_curves`,
        `fragility`, `slide_history` or `load_records`; or the path of a record
    target
        the file to write, or Axes of matplotlib, into which a response is drawn
        without its ground acceleration, and a record without velocity and displacement
    structure
        name of the structure or record of a map, None for the first
    cut
        a slice of a spectra file, such as "Omega=5" or "f_g=1.5"
    every
        True: a panel for each structure
    over
        the abscissa of a family, "KEY" or "KEY/KEY"
    log
        logarithmic axes: "x", "y" or "xy"
    xlim
        (from, to) of the abscissa in its unit, None for the figure's own
    ylim
        (from, to) of the ordinate of the first panel and of those like it
    units
        of the axes, None for g and Hz
    look
        size, title and style, None for the figure's own
    portrait
        True: the phase portrait of a response
    body
        the structure of its separatrix, None for the block with its p and alpha
    align
        True: the time of each response counts from its largest rotation
    data
        CSV of a measured rotation, as `rocking identify` reads it, over a response
    overwrite
        False: an existing file is an error
    tell
        called with the characters that the font lacks

    Returns
    -------
    str, Axes or None
        the Axes if the target is one; of a slice a sentence that states its value

    Raises
    ------
    UsageError
        for another file, nothing to draw, or Axes for several panels
    OutputError
        when a file is damaged or cannot be written, or matplotlib is not installed

    Examples
    --------
    >>> grid = parse_grid("A=1:8:50,Omega=4:5:2")
    >>> structures = [dimensionless_oscillator(eta=0.9)]
    >>> _ = write_spectrum(structures, sine(), grid, "d.h5", workers=1)
    >>> draw("d.h5", "slice.svg", cut="Omega=5")
    'slice at Omega = 5, the nearest of the file'
    """
    opened, units = opened_source(source, tell), in_figure_units(units)
    alone = None if isinstance(target, str | Path) else target
    remark = None
    name = opened.name or (type(source).__name__ if alone else str(target))
    place: AbstractContextManager[Any] = (
        canvas(target, overwrite, look=look, tell=tell)
        if isinstance(target, str | Path)
        else nullcontext(OneAxes(require_axes(target)))
    )
    with place as figure:
        if opened.plan is not None:
            axes = opened.plan(figure, units, alone)
        elif opened.cells is None:
            of_rows = OfRows(over, portrait, body, align, data)
            axes = of_rows.drawn(figure, name, opened.rows(), units, alone)
        else:
            with opened.cells() as file:
                if cut is not None:
                    axes, remark = _cut(figure, file, cut, units)
                else:
                    axes = _places(figure, file, structure, every, units)
        _require_marks(axes, name)
        _set_logarithmic(axes, log)
        _set_limits(axes, xlim, ylim)
        if alone is not None:
            fit_title(alone)
    return remark if alone is None else alone


def in_figure_units(units: Units | None) -> Units:
    """Return the units of a figure: g and Hz where nothing else is chosen."""
    return Units({**FIGURE_UNITS.chosen, **(units.chosen if units else {})})


def _set_limits(
    axes: Sequence[Axes],
    xlim: tuple[float, float] | None,
    ylim: tuple[float, float] | None,
) -> None:
    """Set the ends of the axes of the first panels: ylim of those that share the label
    of the first one.
    """
    for one in axes:
        if xlim is not None:
            one.set_xlim(*xlim)
        if ylim is not None and one.get_ylabel() == axes[0].get_ylabel():
            one.set_ylim(*ylim)


def _set_logarithmic(axes: Sequence[Axes], log: str) -> None:
    """Make these scales logarithmic; log: x, y or xy."""
    for one in axes:
        for axis in log:
            one.set(**{f"{axis}scale": "log"})
            plain_ticks(getattr(one, f"{axis}axis"))


def _cut(
    figure: Figure, file: SpectraFile, cut: str, units: Units
) -> tuple[list[Axes], str]:
    """Draw a slice of a spectra file; return its axes and a sentence that states its
    place.
    """
    found = slice_of(file, cut)
    axes = figure.add_subplot()
    spectrum_lines(axes, found, units)
    name, unit, factor = units.column(found.where)
    place = f"slice at {name} = {found.coordinate / factor:.6g} {unit}".rstrip()
    return [axes], f"{place}, the nearest of the file"


def _require_marks(axes: Sequence[Axes], source: str) -> None:
    """Raise UsageError if no axes hold a mark or a point of a line."""
    if any(one.collections or one.patches for one in axes):
        return
    for one in axes:
        for line in one.get_lines():
            if np.isfinite(np.asarray(line.get_xydata())).all(axis=1).any():
                return
    raise UsageError(f"{source}: holds nothing to draw")


class OneAxes:
    """Stands for a figure that has only the Axes of the caller."""

    def __init__(self, axes: Axes) -> None:
        self._axes = axes

    def __getattr__(self, name: str) -> Any:
        return getattr(self._axes.figure, name)

    def set_size_inches(self, *_: float) -> None:
        """Do nothing: the figure of the caller keeps its size."""

    def legend(self, handles: Sequence[Any], **_: Any) -> None:
        """Add a legend inside the Axes."""
        legend(self._axes, handles)

    def add_subplot(self, *_: Any, **__: Any) -> Axes:
        """Return the Axes."""
        return self._axes

    def subplots(self, down: int = 1, across: int = 1, **_: Any) -> np.ndarray:
        """Return the Axes in an array. Raises UsageError if the drawing needs several
        panels.
        """
        if down * across > 1:
            raise UsageError(
                f"found a drawing of {down * across} panels; expected one, or a file as"
                " target"
            )
        return np.array([[self._axes]])


def opened_source(source: Any, tell: Callable[[str], None] | None) -> Opened:
    """Return what a path, several paths or a result in memory hold; tell: called with
    what is left out of records. Raises UsageError for another thing.
    """
    several = source if type(source) in (list, tuple) else [source]
    if not several or not all(isinstance(one, str | Path) for one in several):
        return _in_memory(several[0] if len(several) == 1 else source, several)
    paths = [Path(one) for one in several]
    name = str(several[0])
    if all(map(holds_record, paths)):
        records = read_records(paths, tell)
        return Opened(
            name,
            plan=lambda figure, units, alone: traces(figure, records, units, alone),
        )
    if len(paths) == 1 and is_spectra_file(paths[0]):
        return Opened(name, partial(SpectraFile, paths[0]))
    return Opened(name, rows=partial(_rows, paths))


def _in_memory(source: Any, several: Sequence[Any]) -> Opened:
    """Return what a result holds, or several of one kind."""
    from .figures.memory import memory_file, memory_plan, memory_rows

    if (file := memory_file(source)) is not None:
        return Opened("", lambda: nullcontext(file))
    if several and (plan := memory_plan(several)):
        return Opened("", plan=plan)
    rows = memory_rows(several)
    return Opened("", rows=lambda: rows)


def _rows(sources: Sequence[Path]) -> Rows:
    """Return the rows of one CSV, or of several responses with the names of their
    files. Raises UsageError.
    """
    if len(sources) == 1:
        return rows_of(str(sources[0]))
    found = [
        {SOURCE: named_after(source), **row}
        for source in sources
        for row in rows_of(str(source))
    ]
    if len({tuple(row) for row in found}) > 1 or not _is_response(found[0]):
        raise UsageError(
            f"{', '.join(map(str, sources))}: expected one file, or several CSV of"
            " rocking response with the same columns"
        )
    return found


def holds_record(source: Path) -> bool:
    """True for a file of a record whose format states its units."""
    from ..motions.reading import holds_records

    return source.suffix.lower() not in _TABLES and holds_records(str(source))


def read_records(
    sources: Sequence[Path], tell: Callable[[str], None] | None
) -> list[Record]:
    """Return the records of files, all components; tell: called with what is left out.
    Raises DocumentError.
    """
    from ..motions.reading import read_set
    from ..motions.records import Given
    from ..motions.records.record import accepted

    files = [str(source) for source in sources]
    said = tell or (lambda line: None)
    return list(read_set(files, accepted, Given(), said, said))


def is_spectra_file(source: Path) -> bool:
    """True if the suffix is that of a spectra file; any other file is read as CSV."""
    return source.suffix.lower() in (".h5", ".hdf5", ".nc", ".part")


def _places(
    figure: Figure, file: SpectraFile, name: str | None, every: bool, units: Units
) -> list[Axes]:
    """Draw the map of one structure or record, or of all with `every`; records over
    structures as lines, over alpha and T as quantiles.
    """
    names, *both = file.frame.dimensions.values()
    if "alpha" in file.frame.dimensions and name is None and not every:
        return record_spectra(figure, file, units)
    chosen = list(range(len(names))) if every else [place_of(file, name)]
    axes = panels(figure, len(chosen))
    of_structures = any(isinstance(values, list) for values in both)
    entries: dict[str, Any] = {}
    for one, place in zip(axes, chosen, strict=True):
        if of_structures:
            spectrum_lines(one, of_record(file, place), units)
        else:
            entries |= {
                entry.get_label(): entry
                for entry in outcome_map(one, file, place, units)
            }
    if entries:
        figure.legend(
            handles=list(entries.values()),
            loc="outside lower center",
            ncols=min(3, len(entries)),
        )
    return axes


TABLES: tuple[Kind, ...] = (
    ({"damping", "T", "S_a", "S_d"}, elastic_spectra),
    ({"A_from", "mode"}, bands),
    ({"motion", "outcome_linear", "first_overturning_a", "demand_a"}, checked),
    ({"curve", "Omega", "A"}, closed_forms),
    ({"structure", "tau", "theta_ratio", "t", "theta"}, comparison),
    ({"method", "time_per_cell", "largest_difference"}, accuracy),
    ({"im", "limit_state", "probability", "fraction"}, fragility_curves),
    ({"pga", "pgv_pga", "outcome"}, two_measures),
    ({"t", "slide", "slide_velocity", "ground_acceleration"}, slide_history),
    ({"p", "pga_ratio_16", "pga_ratio_50", "pga_ratio_84"}, overturning_spectra),
)
"""Columns and figure of each table; the first entry whose columns are all there
applies.
"""


def _is_response(row: Mapping[str, Any]) -> bool:
    """True for a row of the CSV of response."""
    return any(key.startswith(("theta_dot", "theta_ratio_rate")) for key in row)
