"""Rows on standard output, as an aligned table, JSON Lines or CSV. A row is a mapping of column names to values."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any
from unicodedata import normalize

from .units import Units

Record = Mapping[str, Any]

_FORMULA = ("=", "+", "-", "@")  # a spreadsheet reads a text that begins so as a formula, after blanks and in full width too


def json_line(record: Record, encoding: str = "utf-8") -> str:
    """One JSON object on one line; NaN and infinity become null.

    All non-ASCII characters are escaped if one of them is not printable or not in the encoding.
    """
    line = json.dumps(_plain(record), ensure_ascii=False, allow_nan=False)
    fits = line.encode(encoding, "ignore").decode(encoding, "ignore") == line
    return line if fits and line.isprintable() else json.dumps(_plain(record), allow_nan=False)


def csv_lines(records: Iterable[Record], columns: Sequence[str] = ()) -> Iterator[str]:
    """CSV lines: a header with the columns of the first row (or `columns` if there is no row), then the rows.

    A text that a spreadsheet reads as a formula gets a leading apostrophe.
    """
    header: list[str] | None = None
    for record in records:
        if header is None:
            header = list(record)
            yield _csv_row(header)
        yield _csv_row([_csv_cell(record.get(c)) for c in header])
    if header is None and columns:
        yield _csv_row(list(columns))


def table_lines(records: Iterable[Record], digits: int = 6) -> Iterator[str]:
    """The lines of an aligned table; numbers have `digits` significant digits and stand at the right."""
    rows = list(records)
    if not rows:
        return
    columns = [key for key in dict.fromkeys(key for row in rows for key in row) if key != "kind"]
    cells = [[_text(row.get(c), digits) for c in columns] for row in rows]
    numeric = [all(isinstance(row.get(c), int | float | None) for row in rows) for c in columns]
    widths = [max(len(c), *(len(row[i]) for row in cells)) for i, c in enumerate(columns)]
    for line in [columns, *cells]:
        parts = [x.rjust(w) if right else x.ljust(w) for x, w, right in zip(line, widths, numeric, strict=True)]
        yield "  ".join(parts).rstrip()


def flat(record: Record) -> dict[str, Any]:
    """The row with one column for each item of its lists and mappings, such as hinges_1_angle or sides_2_p."""
    out: dict[str, Any] = {}
    for key, value in record.items():
        items = value.items() if isinstance(value, Mapping) else enumerate(value, 1) if isinstance(value, list | tuple) else None
        out |= {key: value} if items is None else flat({f"{key}_{name}": item for name, item in items})
    return out


def lines(
    records: Iterable[Record], form: str, columns: Sequence[str] = (), *, encoding: str = "utf-8", units: Units | None = None
) -> Iterator[str]:
    """The rows as lines of `json`, `csv` or `table`.

    columns: the header of CSV without rows; encoding: of the output; units: for tables and CSV (None: SI), stated in the headings.
    """
    if form == "json":
        return (json_line(r, encoding) for r in records)
    units = units or Units()
    if form == "csv":
        return csv_lines(units.shown(map(flat, records)), [headed for headed, _ in map(units.heading, columns)])
    return table_lines(units.shown(records))


def _plain(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value


def _csv_row(cells: list[Any]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="").writerow(cells)
    return out.getvalue()


def _csv_cell(value: Any) -> Any:
    value = _plain(value)
    if isinstance(value, str) and normalize("NFKC", value).lstrip().startswith(_FORMULA):
        return f"'{value}"
    return "" if value is None else value


def _text(value: Any, digits: int) -> str:
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.{digits}g}"
    if isinstance(value, Mapping):
        return " ".join(_text(v, digits) for v in value.values())
    if isinstance(value, list | tuple):
        return ", ".join(_text(v, digits) for v in value)
    return str(value)
