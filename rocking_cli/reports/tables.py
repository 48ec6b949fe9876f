"""Records on standard output: a table for people, JSON Lines or CSV for programs."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from .units import Units

Record = Mapping[str, Any]

_FORMULA = ("=", "+", "-", "@")  # a spreadsheet computes a text that begins with one of them


def json_line(record: Record, encoding: str = "utf-8") -> str:
    """One JSON object on one line; NaN and infinities become null, which is what JSON knows.

    All in ASCII where it holds characters that no screen shows (JSON escapes only some of them) or that the encoding lacks.
    """
    line = json.dumps(_plain(record), ensure_ascii=False, allow_nan=False)
    try:
        line.encode(encoding)
    except UnicodeEncodeError:
        shows = False
    else:
        shows = line.isprintable()
    return line if shows else json.dumps(_plain(record), allow_nan=False)


def csv_lines(records: Iterable[Record], columns: Sequence[str] = ()) -> Iterator[str]:
    """A header and one row a record, columns in order of the first record (or given).

    A text that a spreadsheet would take for a formula begins with an apostrophe instead.
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
    """An aligned table; numbers to `digits` significant digits, to the right."""
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
    """The record with a column for each item of its lists and mappings: hinges_1_angle, sides_2_p."""
    out: dict[str, Any] = {}
    for key, value in record.items():
        items = value.items() if isinstance(value, Mapping) else enumerate(value, 1) if isinstance(value, list | tuple) else None
        out |= {key: value} if items is None else flat({f"{key}_{name}": item for name, item in items})
    return out


def lines(
    records: Iterable[Record], form: str, columns: Sequence[str] = (), *, encoding: str = "utf-8", units: Units | None = None
) -> Iterator[str]:
    """Records in the form `json`, `csv` or `table`; columns: the header of a CSV without records; encoding: of the output; units: of
    a table and of CSV (None: SI), where headings tell them."""
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
    if isinstance(value, str) and value.startswith(_FORMULA):
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
