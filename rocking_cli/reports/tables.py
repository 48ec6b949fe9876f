"""Rows on standard output, as an aligned table, JSON Lines or CSV. A row is a mapping
of column names to values.
"""

import csv
import json
import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import zip_longest
from textwrap import wrap
from types import SimpleNamespace
from typing import Any, NamedTuple
from unicodedata import normalize

from ..digits import digits_apart, rounded_down
from ..errors import UsageError, did_you_mean
from .units import Units

Row = Mapping[str, Any]

WIDTH = 100  # columns of a table, if no terminal says otherwise
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

    cells: list[str]  # the heading and the value of each row, as texts
    numeric: bool  # True if every value is a number; numbers are aligned on the right
    key: bool  # True if the column says which row it is

    @property
    def width(self) -> int:
        """The number of characters of the longest cell."""
        return max(map(len, self.cells))

    @property
    def heading_width(self) -> int:
        """The number of characters of the longest word of the heading."""
        return max(map(len, self.cells[0].split()), default=0)


def table_lines(
    rows: Iterable[Row],
    digits: int = 4,
    width: int = WIDTH,
    chosen: Sequence[str] = (),
    keys: Sequence[str] = (),
) -> Iterator[str]:
    """Yield the lines of an aligned table, none longer than `width`.

    digits: significant digits of numbers; chosen: names of columns without units, if
    empty all columns that have values; keys: names of the columns that say which row it
    is, the first column if there is none. A table that is too wide is cut into blocks;
    each block begins with the key columns. A table of up to three rows, or one without
    room for the headings of its keys, has a line for each quantity, and its blocks hold
    as many rows as fit. Raises UsageError for an unknown column.
    """
    table = _columns_of(list(rows), digits, chosen, keys)
    if not table:
        return
    upright = len(table[0].cells) <= 4 or _breaks_headings(table, width)
    yield from _upright(table, width) if upright else _level(table, width)


def _columns_of(
    body: Sequence[Row], digits: int, chosen: Sequence[str], keys: Sequence[str] = ()
) -> list[_Column]:
    """Return the columns of a table; arguments as of `table_lines`."""
    table = []
    for heading in _headings(body, chosen):
        values = [row.get(heading) for row in body]
        cells = [heading, *(_cell(heading, value, digits) for value in values)]
        key = heading.partition(" [")[0] in keys
        table.append(_Column(cells, all(map(_is_number, values)), key))
    return table


def markdown_lines(
    rows: Iterable[Row], digits: int = 4, chosen: Sequence[str] = ()
) -> Iterator[str]:
    """Yield the lines of a table in Markdown; arguments as of `table_lines`."""
    table = _columns_of(list(rows), digits, chosen)
    for i, row in enumerate(zip(*(column.cells for column in table), strict=True)):
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
    for i, row in enumerate(zip(*(column.cells for column in table), strict=True)):
        yield " & ".join(map(_in_latex, row)) + r" \\"
        if not i:
            yield r"\hline"
    yield r"\end{tabular}"


def _in_latex(text: str) -> str:
    """Return a text with the marks of LaTeX escaped."""
    return "".join(_LATEX.get(mark, mark) for mark in text)


def unknown_column(name: str, known: Collection[str]) -> UsageError:
    """Return the error for a name that is not among the columns."""
    meant = did_you_mean(name, known)
    expected = f"expected names among {', '.join(known)}"
    return UsageError(f"`columns`: found {name!r}{meant}; {expected}")


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


def _breaks_headings(table: Sequence[_Column], width: int) -> bool:
    """True if the headings of the keys have no room beside another column."""
    if _together([column.width for column in table]) <= width:
        return False
    keys = [column for column in table if column.key] or list(table[:1])
    others = [column for column in table if column not in keys]
    return any(
        found < column.heading_width
        for found, column in zip(_key_widths(keys, others, width), keys, strict=True)
    )


def _level(table: Sequence[_Column], width: int) -> Iterator[str]:
    """Yield a line for each row; columns beyond the width stand in further blocks.

    A key that has no room continues on the next line, so that two rows never look
    alike; any other text is cut.
    """
    for number, block in enumerate(_blocks(table, width)):
        if number:
            yield ""
        for cells in zip(*(column.cells for column, _ in block), strict=True):
            parts = []
            for cell, (column, room) in zip(cells, block, strict=True):
                parts.append(_wrapped(cell, room) if column.key else [_cut(cell, room)])
            for line in zip_longest(*parts, fillvalue=""):
                aligned = [
                    text.rjust(room) if column.numeric else text.ljust(room)
                    for text, (column, room) in zip(line, block, strict=True)
                ]
                yield _GAP.join(aligned).rstrip()


def _blocks(
    table: Sequence[_Column], width: int
) -> Iterator[list[tuple[_Column, int]]]:
    """Yield the columns of each block, the key columns first, with their widths."""
    if _together([column.width for column in table]) <= width:
        yield [(column, column.width) for column in table]
        return

    if not any(column.key for column in table):
        table = [table[0]._replace(key=True), *table[1:]]
    keys = [column for column in table if column.key]
    others = [column for column in table if not column.key]
    narrowed = _key_widths(keys, others, width)
    begin = list(zip(keys, narrowed, strict=True))
    left = max(width - sum(narrowed) - len(_GAP) * len(keys), _LEAST)

    block, used = list(begin), 0
    for column in others:
        needed = min(column.width, left)
        if used and used + len(_GAP) + needed > left:
            yield block
            block, used = list(begin), 0
        used += needed + (len(_GAP) if used else 0)
        block.append((column, needed))
    yield block


def _key_widths(
    keys: Sequence[_Column], others: Sequence[_Column], width: int
) -> list[int]:
    """Return the widths of the key columns at the begin of each block.

    The widest of the other columns takes up to half of the width, the keys the rest.
    """
    widest = max((column.width for column in others), default=-len(_GAP))
    room = width - min(widest, width // 2) - len(_GAP)
    natural = [column.width for column in keys]
    return _narrowed(natural, room, [column.heading_width for column in keys])


def _upright(table: Sequence[_Column], width: int) -> Iterator[str]:
    """Yield a line for each quantity: its heading, and its value in each row.

    Rows that have no room beside the others stand in further blocks. A value that is
    still too long continues on the next line.
    """
    headings = [column.cells[0] for column in table]
    first = max(map(len, headings))
    room = max(width - first - len(_GAP), 1)
    rest = [
        list(row) for row in zip(*(column.cells[1:] for column in table), strict=True)
    ]
    begun = False
    while rest:
        count, widths = _abreast(rest, room)
        block, rest = rest[:count], rest[count:]
        if begun:
            yield ""
        begun = True
        for heading, *values in zip(headings, *block, strict=True):
            parts = [_wrapped(v, w) for v, w in zip(values, widths, strict=True)]
            for line in zip_longest([heading], *parts, fillvalue=""):
                cells = zip(line, [first, *widths], strict=True)
                yield _GAP.join(text.ljust(w) for text, w in cells).rstrip()


def _abreast(rows: Sequence[Sequence[str]], room: int) -> tuple[int, list[int]]:
    """Return (number, widths) of the first rows that stand side by side: as many as fit
    without a broken word, or one."""
    natural = [max(map(len, cells)) for cells in rows]
    for count in range(len(rows), 1, -1):
        widths = _narrowed(natural[:count], room)
        words = [
            max((len(w) for c in cells for w in c.split()), default=0) for cells in rows
        ]
        whole = all(w >= word for w, word in zip(widths, words[:count], strict=True))
        if whole and _together(widths) <= room:
            return count, widths
    return 1, [min(natural[0], room)]


def _together(widths: Sequence[int]) -> int:
    """Return the width of columns of these widths side by side."""
    return sum(widths) + len(_GAP) * (len(widths) - 1)


def _narrowed(widths: Sequence[int], room: int, kept: Sequence[int] = ()) -> list[int]:
    """Return widths of columns that together fit into `room`: the widest give way.

    kept: width of each column that gives way after all that lies above these widths.
    """
    found = list(widths)
    for least in (kept, []):
        floors = [max(one, _LEAST) for one in least] or [_LEAST] * len(found)
        while _together(found) > room:
            able = [
                i
                for i, (w, floor) in enumerate(zip(found, floors, strict=True))
                if w > floor
            ]
            if not able:
                break
            found[max(able, key=lambda i: found[i])] -= 1
    return found


def _wrapped(cell: str, width: int) -> list[str]:
    """Return the lines of a cell in this width."""
    return [cell] if len(cell) <= width else wrap(cell, width)


def _cut(cell: str, width: int) -> str:
    """Return a cell, shortened to the width."""
    return cell if len(cell) <= width else f"{cell[: width - 3]}..."


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
    keys: Sequence[str] = (),
    **table: Any,
) -> Iterator[str]:
    """Yield the rows as lines of `json`, or in `units` as those of `csv`,
    `csv-semicolon`, `markdown`, `latex` or `table`.

    columns: the header of a CSV without rows; units: None for SI; keys: the columns
    that say which row it is, repeated in every block of a table; table: further
    arguments of `table_lines`.
    """
    if form == "json":
        return (json_line(r, encoding) for r in rows)
    units = units or Units()
    if form.startswith("csv"):
        headings = [heading for heading, _ in map(units.heading, columns)]
        return csv_lines(units.shown(map(flat, rows)), headings, form != "csv")
    if form in MARKED:
        return MARKED[form](units.shown(rows), table["digits"], table["chosen"])
    named = [units.column(key)[0] for key in keys]
    return table_lines(units.shown(rows), keys=named, **table)


MARKED = {"markdown": markdown_lines, "latex": latex_lines}
"""The forms of a table for other programs."""


def shown_cells(row: Row, digits: int = 4) -> Iterator[tuple[str, str]]:
    """Yield (heading with unit, text) of the columns of a row of SI values that have a
    value.
    """
    (shown,) = Units().shown([row])
    for heading in _headings([shown], ()):
        yield heading, _cell(heading, shown[heading], digits)


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
