"""Rows on standard output, as an aligned table, JSON Lines or CSV. A row is a mapping
of column names to values.
"""

import csv
import json
import math
import re
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import islice, zip_longest
from textwrap import wrap
from types import SimpleNamespace
from typing import Any, NamedTuple
from unicodedata import normalize

from ..digits import digits_apart, rounded_down
from ..errors import UsageError, did_you_mean
from .units import Units

Row = Mapping[str, Any]

WIDTH = 80  # columns of a table, if no terminal says otherwise
MANY = 1000  # rows up to which a table is laid out as a whole
_GAP = "  "  # between two columns
_LEAST = 4  # characters of a column that gives way to others
_NUMBER = re.compile(r"(?:[<>] ?)?[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")
# most values of a row; to find that one is no Mapping takes ten times as long
_SCALARS = (float, str, int, type(None))
# a spreadsheet reads a text that begins so as a formula, after blanks and in full width
# too
_FORMULA = ("=", "+", "-", "@")


RATIOS = (
    "capacity_demand",
    "code_linear_ratio",
    "code_slv_ratio",
    "code_slc_ratio",
    "theta_04_ratio",
)
"""The columns of which 1 is the limit: a table shows on which side of it they lie."""


_LATEX = {
    **{mark: f"\\{mark}" for mark in "&%$#_{}"},
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "\\": r"\textbackslash{}",
    "<": "$<$",
    ">": "$>$",
}


class Above(float):
    """A number that the true one exceeds, in a table `> 13`, rounded down."""

    def shown(self, digits: int) -> str:
        """Return the text with so many significant digits."""
        return f"> {rounded_down(self, digits):.{digits}g}"


def json_line(row: Row, encoding: str = "utf-8") -> str:
    """Return a row as a JSON object on one line; NaN and infinity become null. All
    non-ASCII characters are escaped if one of them is not printable or not in the
    encoding.
    """
    line = json.dumps(_plain(row), ensure_ascii=False, allow_nan=False)
    fits = line.encode(encoding, "ignore").decode(encoding, "ignore") == line
    return (
        line
        if fits and line.isprintable()
        else json.dumps(_plain(row), allow_nan=False)
    )


def csv_lines(
    rows: Iterable[Row], columns: Sequence[str] = (), semicolons: bool = False
) -> Iterator[str]:
    """Yield CSV lines: a header, that of `columns` if there is no row, and the rows. A
    heading or a text that a spreadsheet reads as a formula gets a leading apostrophe.
    semicolons: between the cells, with decimal commas, as spreadsheets read them where
    numbers have these.
    """
    header: list[str] | None = None
    for row in rows:
        if header is None:
            header = list(row)
            yield _csv_row(header, semicolons)
        yield _csv_row([row.get(c) for c in header], semicolons)
    if header is None and columns:
        yield _csv_row(columns, semicolons)


class _Column(NamedTuple):
    """A column of a printed table."""

    heading: str
    cells: list[str]  # the value of each row as a text
    numeric: bool  # True if every value is a number; numbers are aligned on the right

    @property
    def width(self) -> int:
        """The number of characters of the longest cell."""
        return max(map(len, self.cells), default=0)


def table_lines(
    rows: Iterable[Row],
    digits: int = 4,
    width: int = WIDTH,
    chosen: Sequence[str] = (),
    above: Sequence[str] = (),
    spare: Sequence[str] = (),
) -> Iterator[str]:
    """Yield the lines of an aligned table.

    digits: significant digits of numbers; chosen: names of columns without units, if
    empty all columns that have values; above: columns that stand once, above the table,
    if they are the same in all rows; spare: columns of which only as many stand as fit.
    To fit into `width` headings are broken, then texts go on below, then each quantity
    has a line with its values in a few rows; the lines of many rows may be longer. A
    table of more than MANY rows is written as they come, with every column. Raises
    UsageError for an unknown column.
    """
    rows = iter(rows)
    body = list(islice(rows, MANY + 1))
    if len(body) > MANY:
        yield from _long(body, rows, digits, chosen)
        return
    table = _columns_of(body, digits, chosen)
    if not table:
        return
    same, table = _same(table, above)
    if same:
        yield from wrap("; ".join(same), max(width, _LEAST), break_on_hyphens=False)
        yield ""
    spared = [c for c in table if _name(c.heading) in spare]
    while _arranged(table, width, whole=True) is None and spared:
        dropped = spared.pop()
        table = [column for column in table if column is not dropped]
    arranged = _arranged(table, width)
    upright = None if arranged else _upright(table, width)
    if upright is not None:
        yield from upright
        return
    arranged = arranged or _arranged(table, sys.maxsize)
    assert arranged is not None
    yield from _level(table, arranged)


def _name(heading: str) -> str:
    """Return the name of a column without its unit."""
    return heading.partition(" [")[0]


def _columns_of(
    body: Sequence[Row], digits: int, chosen: Sequence[str]
) -> list[_Column]:
    """Return the columns of a table; arguments as of `table_lines`."""
    return [
        _column(heading, [row.get(heading) for row in body], digits)
        for heading in _headings(body, chosen)
    ]


def _column(heading: str, values: Sequence[Any], digits: int) -> _Column:
    cells = [_cell(heading, value, digits) for value in values]
    return _Column(heading, cells, all(map(_is_number, values)))


def _same(
    table: list[_Column], above: Sequence[str]
) -> tuple[list[str], list[_Column]]:
    """Return (texts of the columns that are the same in all rows, the others)."""
    same = [
        column
        for column in table
        if _name(column.heading) in above and len(set(column.cells)) == 1
    ]
    if len(same) == len(table):
        return [], table
    texts = []
    for column in same:
        name, _, unit = column.heading.partition(" [")
        texts.append(f"{name} {column.cells[0]} {unit.rstrip(']')}".rstrip())
    return texts, [column for column in table if column not in same]


def _long(
    body: Sequence[Row], rest: Iterator[Row], digits: int, chosen: Sequence[str]
) -> Iterator[str]:
    """Yield the lines of a table of many rows, with the widths of the first ones."""
    headings = list(dict.fromkeys(key for row in body for key in row))
    known = {_name(heading): heading for heading in headings}
    headings = [known[name] for name in chosen] or headings
    table = [
        _column(heading, [row.get(heading) for row in body], digits)
        for heading in headings
    ]
    widths = [max(column.width, len(column.heading)) for column in table]
    yield _line(headings, table, widths)
    for i in range(len(body)):
        yield _line([column.cells[i] for column in table], table, widths)
    for row in rest:
        cells = [_cell(heading, row.get(heading), digits) for heading in headings]
        yield _line(cells, table, widths)


def _line(
    cells: Iterable[str],
    table: Sequence[_Column],
    widths: Sequence[int],
    gap: str = _GAP,
) -> str:
    """Return cells side by side, numbers on the right of their columns."""
    aligned = [
        cell.rjust(width) if column.numeric else cell.ljust(width)
        for cell, column, width in zip(cells, table, widths, strict=True)
    ]
    return gap.join(aligned).rstrip()


def markdown_lines(
    rows: Iterable[Row], digits: int = 4, chosen: Sequence[str] = ()
) -> Iterator[str]:
    """Yield the lines of a table in Markdown; arguments as of `table_lines`."""
    table = _columns_of(list(rows), digits, chosen)
    for i, row in enumerate(_rows_of(table)):
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |"
        if not i:
            marks = ("---:" if column.numeric else "---" for column in table)
            yield f"| {' | '.join(marks)} |"


def latex_lines(
    rows: Iterable[Row], digits: int = 4, chosen: Sequence[str] = ()
) -> Iterator[str]:
    """Yield the lines of a `tabular` of LaTeX; arguments as of `table_lines`."""
    table = _columns_of(list(rows), digits, chosen)
    if not table:
        return
    places = "".join("r" if column.numeric else "l" for column in table)
    yield f"\\begin{{tabular}}{{{places}}}"
    for i, row in enumerate(_rows_of(table)):
        yield " & ".join(map(_in_latex, row)) + r" \\"
        if not i:
            yield r"\hline"
    yield r"\end{tabular}"


def _rows_of(table: Sequence[_Column]) -> Iterator[tuple[str, ...]]:
    """Yield the headings and the cells of each row."""
    return zip(*((column.heading, *column.cells) for column in table), strict=True)


def _in_latex(text: str) -> str:
    """Return a text with the marks of LaTeX escaped."""
    return "".join(_LATEX.get(mark, mark) for mark in text)


def unknown_column(
    name: str, known: Collection[str], option: str = "columns"
) -> UsageError:
    """Return the error for a name, stated by this option, that is no column."""
    meant = did_you_mean(name, known)
    expected = f"expected names among {', '.join(known)}"
    return UsageError(f"`{option}`: found {name!r}{meant}; {expected}")


def _headings(body: Sequence[Row], chosen: Sequence[str]) -> list[str]:
    """Return the headings of a table: the chosen ones, or those that have values."""
    known = {
        key.partition(" [")[0]: key for row in body for key in row if key != "kind"
    }
    if not body:
        return []
    for name in chosen:
        if name not in known:
            raise unknown_column(name, known)
    if chosen:
        return [known[name] for name in chosen]
    empty: tuple[Any, ...] = (None, "", [])
    return [k for k in known.values() if any(row.get(k) not in empty for row in body)]


class _Arranged(NamedTuple):
    """Columns side by side."""

    headings: list[list[str]]  # the lines of each heading
    widths: list[int]
    gap: str  # between two columns


def _arranged(
    table: Sequence[_Column], width: int, whole: bool = False
) -> _Arranged | None:
    """Return the first of these arrangements that fits: headings in one line, in more
    lines, a narrower gap, texts that go on below (not if `whole`); None if none does.
    """
    most = max(len(_parts(column.heading)) for column in table)
    for tall, gap in (*((n, _GAP) for n in range(1, most + 1)), (most, " ")):
        headings = [_broken(column.heading, tall) for column in table]
        widths = [
            max(column.width, *map(len, heading))
            for column, heading in zip(table, headings, strict=True)
        ]
        if _together(widths, gap) <= width:
            return _Arranged(headings, widths, gap)
    if whole:
        return None
    words = [
        w
        if column.numeric
        else max(len(x) for x in (*heading, *" ".join(column.cells).split()))
        for column, heading, w in zip(table, headings, widths, strict=True)
    ]
    widths = _narrowed(widths, width, words, " ")
    fits = _together(widths, " ") <= width
    return _Arranged(headings, widths, " ") if fits else None


def _parts(heading: str) -> list[str]:
    """Return the parts of a heading: it is broken behind `_` and before a unit."""
    return re.findall(r" ?\[.*| ?[^_ ]+_?", heading)


def _broken(heading: str, tall: int) -> list[str]:
    """Return a heading in so many lines at most, as narrow as they can be."""
    parts = _parts(heading)
    for width in range(max(map(len, parts), default=0), len(heading) + 1):
        lines = [""]
        for part in parts:
            if len((lines[-1] + part).strip()) > width:
                lines.append("")
            lines[-1] = (lines[-1] + part).lstrip()
        if len(lines) <= tall:
            return lines
    return [heading]


def _level(table: Sequence[_Column], arranged: _Arranged) -> Iterator[str]:
    """Yield the headings and a line for each row; a text that is longer than its column
    goes on in the next line.
    """
    headings, widths, gap = arranged
    tall = max(map(len, headings))
    for parts in zip(*([""] * (tall - len(h)) + h for h in headings), strict=True):
        yield _line(parts, table, widths, gap)
    for cells in zip(*(column.cells for column in table), strict=True):
        folded = [_wrapped(x, w) for x, w in zip(cells, widths, strict=True)]
        for parts in zip_longest(*folded, fillvalue=""):
            yield _line(parts, table, widths, gap)


def _upright(table: Sequence[_Column], width: int) -> list[str] | None:
    """Return a line for each quantity: its heading, and its value in each row; None if
    the rows do not fit side by side. A value that is still too long goes on in the next
    line.
    """
    first = max(len(column.heading) for column in table)
    room = max(width - first - len(_GAP), 1)
    rows = list(zip(*(column.cells for column in table), strict=True))
    natural = [max(map(len, cells)) for cells in rows]
    words = [
        max(len(w) for c in (" ", *cells) for w in (c.split() or [""]))
        for cells in rows
    ]
    least = words if len(rows) > 1 else [min(_LEAST, room)]
    widths = _narrowed(natural, room, least)
    if len(rows) > 1 and _together(widths) > room:
        return None
    lines = []
    for column in table:
        parts = [_wrapped(v, w) for v, w in zip(column.cells, widths, strict=True)]
        for line in zip_longest([column.heading], *parts, fillvalue=""):
            cells = zip(line, [first, *widths], strict=True)
            lines.append(_GAP.join(text.ljust(w) for text, w in cells).rstrip())
    return lines


def _together(widths: Sequence[int], gap: str = _GAP) -> int:
    """Return the width of columns of these widths side by side."""
    return sum(widths) + len(gap) * (len(widths) - 1)


def _narrowed(
    widths: Sequence[int], room: int, least: Sequence[int], gap: str = _GAP
) -> list[int]:
    """Return widths of columns that together fit into `room`: the widest give way, none
    below `least`.
    """
    found = list(widths)
    while _together(found, gap) > room:
        able = [i for i, floor in enumerate(least) if found[i] > floor]
        if not able:
            break
        found[max(able, key=lambda i: found[i])] -= 1
    return found


def _wrapped(cell: str, width: int) -> list[str]:
    """Return the lines of a cell in this width."""
    return [cell] if len(cell) <= width else wrap(cell, width)


def _is_number(value: Any) -> bool:
    """True for a number, for none, and for a text such as `0.62` or `> 13`."""
    if isinstance(value, str):
        return _NUMBER.fullmatch(value) is not None
    return value is None or isinstance(value, int | float)


def flat(row: Row) -> dict[str, Any]:
    """Return the row with a column for each item of its lists and mappings, such as
    hinges_1_angle or sides_2_p.
    """
    out: dict[str, Any] = {}
    for key, value in row.items():
        if isinstance(value, _SCALARS):
            out[key] = value
        elif isinstance(value, Mapping):
            out |= flat({f"{key}_{name}": item for name, item in value.items()})
        elif isinstance(value, list | tuple):
            out |= flat({f"{key}_{i}": item for i, item in enumerate(value, 1)})
        else:
            out[key] = value
    return out


def lines(
    rows: Iterable[Row],
    form: str,
    columns: Sequence[str] = (),
    *,
    encoding: str = "utf-8",
    units: Units | None = None,
    **table: Any,
) -> Iterator[str]:
    """Yield the rows as lines of `json`, or in `units` as those of `csv`,
    `csv-semicolon`, `markdown`, `latex` or `table`.

    columns: the header of a CSV without rows; units: None for SI; table: further
    arguments of `table_lines`, whose columns have the names of `rows`.
    """
    if form == "json":
        return (json_line(r, encoding) for r in rows)
    units = units or Units()
    if form.startswith("csv"):
        headings = [heading for heading, _ in map(units.heading, columns)]
        return csv_lines(units.shown(map(flat, rows)), headings, form != "csv")
    if form in MARKED:
        return MARKED[form](units.shown(rows), table["digits"], table["chosen"])
    for names in ("above", "spare"):
        if names in table:
            table[names] = [units.column(name)[0] for name in table[names]]
    return table_lines(units.shown(rows), **table)


MARKED = {"markdown": markdown_lines, "latex": latex_lines}
"""The forms of a table for other programs."""


def shown_cells(row: Row) -> Iterator[tuple[str, str]]:
    """Yield (heading with unit, text) of the columns of a row of SI values that have a
    value.
    """
    (shown,) = Units().shown([row])
    for heading in _headings([shown], ()):
        yield heading, _cell(heading, shown[heading], 4)


def _plain(value: Any) -> Any:
    """Return a value as JSON has it, with None for a number that is not finite."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, _SCALARS):
        return value
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value


# `writerow` returns what `write` returns: the text itself
_WRITER, _SEMICOLONS = (
    csv.writer(SimpleNamespace(write=str), lineterminator="", delimiter=mark)
    for mark in ",;"
)


def _csv_row(values: Iterable[Any], semicolons: bool = False) -> str:
    """Return headings or values as a line of CSV without its end."""
    cells = map(csv_cell, values)
    if not semicolons:
        return str(_WRITER.writerow(cells))
    return str(
        _SEMICOLONS.writerow(
            str(x).replace(".", ",") if isinstance(x, float) else x for x in cells
        )
    )


def csv_cell(value: Any) -> Any:
    """Return a value as a cell; a text that a spreadsheet would take for a formula is
    quoted.
    """
    value = _plain(value)
    if isinstance(value, str) and normalize("NFKC", value).lstrip().startswith(
        _FORMULA
    ):
        return f"'{value}"
    return "" if value is None else value


def _cell(heading: str, value: Any, digits: int) -> str:
    """Return a value of a column as a text."""
    if heading in RATIOS and isinstance(value, float) and not isinstance(value, Above):
        digits = digits_apart(value, 1.0, digits)
    return _text(value, digits)


def _text(value: Any, digits: int) -> str:
    """Return a value as a text with so many significant digits."""
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
