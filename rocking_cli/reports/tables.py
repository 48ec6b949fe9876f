"""Rows on standard output, as an aligned table, JSON Lines or CSV. A row is a mapping of column names to values."""

import csv
import io
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import zip_longest
from textwrap import wrap
from typing import Any
from unicodedata import normalize

from ..errors import UsageError, did_you_mean
from .units import Units

Row = Mapping[str, Any]

WIDTH = 100  # of a table, if no terminal says otherwise
_FORMULA = ("=", "+", "-", "@")  # a spreadsheet reads a text that begins so as a formula, after blanks and in full width too


class Above(float):
    """A number that the true one exceeds, in a table `> 13`, rounded down."""

    def shown(self, digits: int) -> str:
        """Return the text with so many significant digits."""
        unit = 10.0 ** (math.floor(math.log10(self)) - digits + 1)
        return f"> {math.floor(self / unit * (1.0 + 1e-12)) * unit:.{digits}g}"


def json_line(row: Row, encoding: str = "utf-8") -> str:
    """Return a row as a JSON object on one line; NaN and infinity become null. All non-ASCII characters are escaped if one of them is not
    printable or not in the encoding."""
    line = json.dumps(_plain(row), ensure_ascii=False, allow_nan=False)
    fits = line.encode(encoding, "ignore").decode(encoding, "ignore") == line
    return line if fits and line.isprintable() else json.dumps(_plain(row), allow_nan=False)


def csv_lines(rows: Iterable[Row], columns: Sequence[str] = ()) -> Iterator[str]:
    """Yield CSV lines: a header, that of `columns` if there is no row, and the rows. A text that a spreadsheet reads as a formula gets a
    leading apostrophe."""
    header: list[str] | None = None
    for row in rows:
        if header is None:
            header = list(row)
            yield _csv_row(header)
        yield _csv_row([_csv_cell(row.get(c)) for c in header])
    if header is None and columns:
        yield _csv_row(list(columns))


def table_lines(rows: Iterable[Row], digits: int = 4, width: int = WIDTH, chosen: Sequence[str] = ()) -> Iterator[str]:
    """Yield the lines of an aligned table, none longer than `width`; numbers have `digits` significant digits.

    chosen: names of columns without units; if empty, all columns that have values. A table of up to three rows has a line for each
    quantity. Columns beyond the width stand in further tables, each with the first column. Raises UsageError for an unknown column.
    """
    body = list(rows)
    known = {key.partition(" [")[0]: key for row in body for key in row if key != "kind"}
    if unknown := [name for name in chosen if body and name not in known]:
        raise UsageError(f"`columns`: found {unknown[0]!r}{did_you_mean(unknown[0], known)}; expected names among {', '.join(known)}")
    keys = [known[name] for name in chosen if body] or [k for k in known.values() if any(row.get(k) not in (None, "", []) for row in body)]
    cells = [[key, *(_text(row.get(key), digits) for row in body)] for key in keys]
    if len(body) <= 3:
        yield from _upright(cells, width)
        return
    numeric = [all(isinstance(row.get(key), int | float | None) for row in body) for key in keys]
    widths = [min(max(map(len, cells[0])), width // 2)]
    widths += [min(max(map(len, column)), width - widths[0] - 2) for column in cells[1:]]
    begin = 1
    while begin <= len(keys) - (len(keys) > 1):
        end, used = begin + 1, sum(widths[:1] + widths[begin : begin + 1]) + 2
        while end < len(keys) and used + 2 + widths[end] <= width:
            used += 2 + widths[end]
            end += 1
        if begin > 1:
            yield ""
        shown = (0, *range(begin, min(end, len(keys))))
        for line in zip(*(cells[i] for i in shown), strict=True):
            cut = [cell if len(cell) <= widths[i] else f"{cell[: widths[i] - 3]}..." for i, cell in zip(shown, line, strict=True)]
            yield "  ".join(f"{cell:{'>' if numeric[i] else '<'}{widths[i]}}" for i, cell in zip(shown, cut, strict=True)).rstrip()
        begin = end


def _upright(cells: Sequence[Sequence[str]], width: int) -> Iterator[str]:
    """Yield a line for each quantity, its heading and values; a value that is too long continues on the next line."""
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    most = (width - widths[0]) // max(len(widths) - 1, 1) - 2 if sum(widths) + 2 * len(widths) - 2 > width else width
    widths[1:] = [min(w, most) for w in widths[1:]]
    for heading, *values in cells:
        parts = zip_longest([heading], *(wrap(value, w) for value, w in zip(values, widths[1:], strict=True)), fillvalue="")
        for line in parts:
            yield "  ".join(x.ljust(w) for x, w in zip(line, widths, strict=True)).rstrip()


def flat(row: Row) -> dict[str, Any]:
    """Return the row with a column for each item of its lists and mappings, such as hinges_1_angle or sides_2_p."""
    out: dict[str, Any] = {}
    for key, value in row.items():
        items = value.items() if isinstance(value, Mapping) else enumerate(value, 1) if isinstance(value, list | tuple) else None
        out |= {key: value} if items is None else flat({f"{key}_{name}": item for name, item in items})
    return out


def lines(
    rows: Iterable[Row], form: str, columns: Sequence[str] = (), *, encoding: str = "utf-8", units: Units | None = None, **table: Any
) -> Iterator[str]:
    """Yield the rows as lines of `json`, `csv` (columns: its header without rows) or `table` (with arguments of `table_lines`), the last
    two in these units, None for SI."""
    if form == "json":
        return (json_line(r, encoding) for r in rows)
    units = units or Units()
    if form == "csv":
        return csv_lines(units.shown(map(flat, rows)), [headed for headed, _ in map(units.heading, columns)])
    return table_lines(units.shown(rows), **table)


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
    if isinstance(value, Above):
        return value.shown(digits)
    if isinstance(value, float):
        return f"{value:.{digits}g}"
    if isinstance(value, Mapping):
        return " ".join(_text(v, digits) for v in value.values())
    if isinstance(value, list | tuple):
        return ", ".join(_text(v, digits) for v in value)
    return str(value)
