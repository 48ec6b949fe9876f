"""Results in memory, in the forms that the figures take: rows of texts in SI units, or
a spectra file.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from ...envelopes.closed_form import CurvePoint
from ...envelopes.intervals import Interval
from ...errors import ArgumentError
from ...fragility.fitted_curve import Fit
from ...responses.time_history import TimeHistory
from ...responses.verdict import Verdict
from ...spectra.file.reader import SpectraFile
from ...spectra.results import Spectrum
from ..rows import Rows
from .spectrum_cells import cells_of

_EXPECTED = (
    "a path, several paths, or a result of time_history, spectrum, check, envelope,"
    " trace_envelope, closed_form_curves or fragility"
)


def memory_file(source: Any) -> SpectraFile | None:
    """Return a spectrum in memory as a file of it; None for another thing."""
    return cells_of(source) if isinstance(source, Spectrum) else None


def memory_rows(source: Any) -> Rows:
    """Return the rows of a result, or of several of one kind, as texts. Raises
    ArgumentError for another thing.
    """
    several = list(source) if isinstance(source, list | tuple) else [source]
    if isinstance(source, CurvePoint | Interval):
        several = [source]
    rows = [row for one in several for row in _rows(one)]
    if not rows or not all(rows):
        raise ArgumentError(
            f"draw: `source`: found an empty {type(source).__name__}; expected"
            f" {_EXPECTED}"
        )
    return [
        {key: "" if x is None else str(x) for key, x in row.items()} for row in rows
    ]


def _rows(one: Any) -> Iterator[Mapping[str, Any]]:
    """Yield the rows of one result."""
    if isinstance(one, Mapping):
        yield one
    elif isinstance(one, TimeHistory):
        yield from one.rows()
    elif isinstance(one, Verdict):
        yield one.row()
    elif isinstance(one, Fit):
        yield from one.points_of_curve()
    elif isinstance(one, Interval):
        yield {
            "Omega": one.omega,
            "A_from": one.a_from,
            "A_to": one.a_to,
            "mode": one.mode,
        }
    elif isinstance(one, CurvePoint):
        yield {"curve": one.curve, "Omega": one.omega, "A": one.amplitude}
    else:
        raise ArgumentError(
            f"draw: `source`: found a {type(one).__name__}; expected {_EXPECTED}"
        )
