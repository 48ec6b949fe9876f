"""Measured traces of free rocking: tables of a time and one measured quantity."""

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...arrays import Array
from ...documents.document import Document
from ...documents.files import is_document_text, read_bytes
from ...documents.parsing import parse_documents
from ...documents.quantities import UNITS
from ...documents.table import Table, read_table, split_heading, table_of
from ...documents.texts import text_of
from ...errors import ArgumentError, DocumentError, UsageError, did_you_mean
from ...structures import read_documents
from ...structures.inline import inline_document

IMPACT = "impact"
DIMENSIONS = {  # of each quantity
    "theta": "angle",
    "theta_dot": "angular velocity",
    "displacement": "length",
    "uplift": "length",
    "acceleration": "acceleration",
    IMPACT: "time",
}
_RATES = {f"{unit}/s": factor for unit, factor in UNITS["angle"].items()}
_KIND = re.compile(r"^[^#\n]*\bkind\"?\s*[:,;\t]", re.MULTILINE)  # of a document


@dataclass(frozen=True)
class Trace:
    """A measured trace of free rocking, one release or several.

    Attributes
    ----------
    name: of the trace, such as that of its file
    quantity: what was measured: theta (> 0 on the right edge), theta_dot, displacement
        of a point of the body over the middle of its base, uplift of the edge that
        rises, acceleration along the axis of the body, or impact (times alone)
    t: times [s], (n,); for `impact` the times of the impacts
    y: readings in SI, (n,); empty for `impact`
    lines: lines of a file, (n,); the index of the sample without one

    Raises
    ------
    ArgumentError
        for an unknown quantity, times that do not grow, or readings that are no finite
        numbers, or not one for each time

    Examples
    --------
    >>> trace = Trace("hammer", "impact", [1.0, 1.9, 2.6, 3.2, 3.7])
    >>> trace.t.tolist()
    [1.0, 1.9, 2.6, 3.2, 3.7]
    """

    name: str
    quantity: str
    t: Array  # [s], (n,)
    y: Array = field(default_factory=lambda: np.empty(0))  # [SI], (n,)
    lines: Array = field(default_factory=lambda: np.empty(0, int))  # (n,)

    def __post_init__(self) -> None:
        t, y = (np.asarray(x, float) for x in (self.t, self.y))
        if self.quantity not in DIMENSIONS:
            raise ArgumentError(
                f"{self.name}: found the quantity {self.quantity!r}; expected"
                f" {', '.join(DIMENSIONS)}"
            )
        if y.shape != (t.shape if self.quantity != IMPACT else (0,)) or t.ndim != 1:
            raise ArgumentError(
                f"{self.name}: found {t.shape} times and {y.shape} readings; expected"
                " one reading for each time, and none for impacts"
            )
        if not (np.isfinite(t).all() and np.isfinite(y).all()):
            raise ArgumentError(f"{self.name}: found NaN or infinity; expected numbers")
        fault = DocumentError if len(self.lines) else ArgumentError
        lines = self.lines if len(self.lines) else np.arange(1, t.size + 1)
        for at in np.flatnonzero(np.diff(t) <= 0.0)[:1]:
            raise fault(
                f"{self.name}:{lines[at + 1]}: found the time {t[at + 1]:g} s behind"
                f" {t[at]:g} s; expected times that grow"
            )
        large = np.abs(y) > 0.5 * math.pi if self.quantity == "theta" else ()
        for at in np.flatnonzero(large)[:1]:
            raise fault(
                f"{self.name}:{lines[at]}: found a rotation of {y[at]:.4g} rad;"
                " expected less than a right angle: state the unit in the heading,"
                " such as theta [deg]"
            )
        for name, value in (("t", t), ("y", y), ("lines", lines)):
            object.__setattr__(self, name, value)


def read_trace(path: str | Path, column: str | None = None) -> Trace:
    """Return the trace of a file: a table whose first column is the time `t [s]`, and a
    second one of DIMENSIONS with its unit; or one column, `impact [s]`. column: name of
    the column of several. Raises UsageError, DocumentError.
    """
    return _trace_of(read_table(path), column)


def trace_or_documents(given: str, column: str | None) -> Trace | list[Document]:
    """Return the trace of a file (- for standard input), or the documents of one, or of
    a text such as `block:0.5x2`. Raises UsageError, DocumentError.
    """
    if is_document_text(given) or (":" in given and inline_document(given)):
        return read_documents(given)
    source, raw = read_bytes(given)
    text = text_of(source, raw)
    if _KIND.search(text):
        return parse_documents(text, source)
    return _trace_of(table_of(text, source), column)


def _trace_of(table: Table, column: str | None) -> Trace:
    """Return the trace of a table. Raises UsageError, DocumentError."""
    names = [split_heading(heading)[0] for heading in table.headings]
    wanted = DIMENSIONS if column is None else (column,)
    found = [
        i
        for i, two in enumerate(zip(names, table.headings, strict=True))
        if not set(two).isdisjoint(wanted)
    ]
    if column is not None and not found:
        raise UsageError(
            f"{table.source}: `column`: found {column!r}; the columns are"
            f" {', '.join(names)}{did_you_mean(column, names)}"
        )
    if len(found) > 1:
        raise UsageError(
            f"{table.source}: found {', '.join(table.headings[i] for i in found)};"
            " `column` chooses one"
        )
    quantity = names[found[0]] if found else ""
    timed = names[:1] in (["t"], ["time"]) and found[:1] != [0]
    if quantity not in DIMENSIONS or not (timed or quantity == IMPACT):
        known = ", ".join(
            f"{name} [{'|'.join(list(_units(name))[:2])}]" for name in DIMENSIONS
        )
        raise DocumentError(
            f"{table.place(table.line)}: found the columns"
            f" {', '.join(table.headings) or 'none'}; expected t [s] first, then one of"
            f" {known}; or a structure document"
        )
    times = _column(table, found[0] if quantity == IMPACT else 0, IMPACT)
    y = np.empty(0) if quantity == IMPACT else _column(table, found[0], quantity)
    lines = np.array([row.line for row in table.read()])
    return Trace(Path(table.source).name, quantity, times, y, lines)


def _units(quantity: str) -> dict[str, float]:
    """Return the units of a quantity, with their factors to SI."""
    return UNITS.get(DIMENSIONS[quantity], _RATES)


def _column(table: Table, at: int, quantity: str) -> Array:
    """Return the numbers of a column [SI]; without a unit it is in SI. Raises
    DocumentError.
    """
    (name, unit), units = split_heading(table.headings[at]), _units(quantity)
    if unit and unit not in units:
        raise DocumentError(
            f"{table.place(table.line, at)}: found {name} in {unit!r}; expected"
            f" {', '.join(units)}"
        )
    found = []
    for line, cells in table.full_rows():
        try:
            found.append(float(cells[at]))
        except ValueError:
            found.append(math.nan)
        if not math.isfinite(found[-1]):
            raise DocumentError(
                f"{table.place(line, at)}: found {cells[at]!r}; expected a number"
            )
    return np.array(found) * units.get(unit, 1.0)
