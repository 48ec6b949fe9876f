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

TIME = ("t", "time")
IMPACT = "impact"
_RATES = {f"{unit}/s": factor for unit, factor in UNITS["angle"].items()}
QUANTITIES = {
    "theta": UNITS["angle"],
    "theta_dot": _RATES,
    "displacement": UNITS["length"],
    "uplift": UNITS["length"],
    "acceleration": UNITS["acceleration"],
    IMPACT: UNITS["time"],
}
"""The units of each quantity, with their factors to SI."""
_KIND = re.compile(r"^[^#\n]*\bkind\"?\s*[:,;\t]", re.MULTILINE)  # of a document
_LARGEST = 0.5 * math.pi  # rad


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
        if self.quantity not in QUANTITIES:
            raise ArgumentError(
                f"{self.name}: found the quantity {self.quantity!r}; expected"
                f" {', '.join(QUANTITIES)}"
            )
        if y.shape != (t.shape if self.quantity != IMPACT else (0,)) or t.ndim != 1:
            raise ArgumentError(
                f"{self.name}: found {t.shape} times and {y.shape} readings; expected"
                " one reading for each time, and none for impacts"
            )
        if not (np.isfinite(t).all() and np.isfinite(y).all()):
            raise ArgumentError(f"{self.name}: found NaN or infinity; expected numbers")
        late = np.flatnonzero(np.diff(t) <= 0.0)
        if late.size:
            raise ArgumentError(
                f"{self.name}: the time does not grow at sample {late[0] + 2}:"
                f" {t[late[0]]:g} s is followed by {t[late[0] + 1]:g} s"
            )
        lines = self.lines if len(self.lines) else np.arange(1, t.size + 1)
        for name, value in (("t", t), ("y", y), ("lines", lines)):
            object.__setattr__(self, name, value)


def read_trace(path: str | Path, column: str | None = None) -> Trace:
    """Return the trace of a file: a table whose first column is the time `t [s]`, and a
    second one of QUANTITIES with its unit; or one column, `impact [s]`. column: name of
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
    names = [split_heading(heading) for heading in table.headings]
    at, quantity, factor = _measured(table, names, column)
    if quantity == IMPACT:
        columns = _numbers(table, [at])
        times, readings = factor * columns[:, 0], np.empty(0)
    else:
        clock = _factor(table, 0, names[0], UNITS["time"])
        columns = _numbers(table, [0, at])
        times, readings = clock * columns[:, 0], factor * columns[:, 1]
    lines = np.array([line for line, _ in table.rows])
    late = np.flatnonzero(np.diff(times) <= 0.0)
    if late.size:
        before, after = table.rows[late[0]][1][0], table.rows[late[0] + 1][1][0]
        raise DocumentError(
            f"{table.place(int(lines[late[0] + 1]))}: found the time {after} behind"
            f" {before}; expected times that grow"
        )
    if quantity == "theta" and np.max(np.abs(readings), initial=0.0) > _LARGEST:
        worst = int(np.argmax(np.abs(readings)))
        raise DocumentError(
            f"{table.place(int(lines[worst]), at)}: found a rotation of"
            f" {readings[worst]:.4g} rad; expected less than a right angle: state the"
            " unit in the heading, such as theta [deg]"
        )
    return Trace(Path(table.source).name, quantity, times, readings, lines)


def _measured(
    table: Table, names: list[tuple[str, str]], column: str | None
) -> tuple[int, str, float]:
    """Return (index, quantity, factor to SI) of the column that was measured."""
    known = ", ".join(
        f"{name} [{'|'.join(list(units)[:2])}]" for name, units in QUANTITIES.items()
    )
    found = [i for i, (name, _) in enumerate(names) if name in QUANTITIES]
    if column is not None:
        found = [
            i
            for i, (name, _) in enumerate(names)
            if column in (name, table.headings[i])
        ]
        if not found:
            words = [name for name, _ in names]
            raise UsageError(
                f"{table.source}: `column`: found {column!r}; the columns are"
                f" {', '.join(words)}{did_you_mean(column, words)}"
            )
    if len(found) > 1:
        raise UsageError(
            f"{table.source}: found {', '.join(table.headings[i] for i in found)};"
            " `column` chooses one"
        )
    name = names[found[0]][0] if found else ""
    timed = name == IMPACT or (names[:1] and names[0][0] in TIME)
    if name not in QUANTITIES or not timed or (name != IMPACT and not found[0]):
        raise DocumentError(
            f"{table.place(table.line)}: found the columns"
            f" {', '.join(table.headings) or 'none'}; expected t [s] first, then one of"
            f" {known}; or a structure document"
        )
    return found[0], name, _factor(table, found[0], names[found[0]], QUANTITIES[name])


def _factor(
    table: Table, at: int, heading: tuple[str, str], units: dict[str, float]
) -> float:
    """Return the factor to SI of a column; without a unit it is in SI."""
    name, unit = heading
    if unit and unit not in units:
        raise DocumentError(
            f"{table.place(table.line, at)}: found {name} in {unit!r}; expected"
            f" {', '.join(units)}"
        )
    return units[unit] if unit else 1.0


def _numbers(table: Table, columns: list[int]) -> Array:
    """Return the numbers of these columns, (rows, columns). Raises DocumentError."""
    found = np.empty((len(table.rows), len(columns)))
    for i, (line, cells) in enumerate(table.full_rows()):
        for j, at in enumerate(columns):
            try:
                found[i, j] = float(cells[at])
            except ValueError:
                found[i, j] = math.nan
            if not math.isfinite(found[i, j]):
                raise DocumentError(
                    f"{table.place(line, at)}: found {cells[at]!r}; expected a number"
                )
    return found
