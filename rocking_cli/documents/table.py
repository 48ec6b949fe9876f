"""Tables in text files: columns separated by commas, semicolons, tabs or blanks below a
heading; and tables of structures.

Spreadsheets write a table in many ways. A first line `sep=;` names the separator. Lines
that begin with # may stand above the heading. Fields may be quoted, with blanks around
them. Where commas do not separate columns they are decimal: 0,45 is 0.45.

In a table of structures a row is a document, a column a key, and the heading may state
the unit; columns `pieces_1_width`, `pieces_2_width` form a list of mappings, a cell
that begins with a bracket is a YAML list, an empty cell means no key.
"""

import csv
import json
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from pathlib import Path
from typing import NamedTuple

from ..errors import DocumentError, did_you_mean
from .composition import Place
from .quantities import FACTORS, split_quantity
from .spreads import has_no_unit, in_unit, is_spread
from .texts import Text, text_at

KIND = "kind"  # only a table of structures has this column
LABELS = "labels"  # the key of texts that the computation does not use
BLANKS = (  # the separator of columns that have blanks between them, any number of them
    " "
)
_SEPARATORS = (";", "\t", ",", BLANKS)
# the first line of a table of Excel
_SEP = re.compile(r"\s*\"?sep=(.)\"?[;,\t]*[ ]*(?:\r\n|\r|\n)", re.IGNORECASE)
# a comment or a blank line
_COMMENT = re.compile(r"[ \t]*(?:\"?#[^\r\n]*)?(?:\r\n|\r|\n)")
_LINE = re.compile(r"[^\r\n]{0,10000}")
_TWO_LINES = re.compile(r"([^\r\n]*)(?:\r\n|\r|\n)?([^\r\n]*)")
_LINE_END = re.compile(r"\r\n|\r|\n")
_LONGEST_HEADING = 100_000  # characters
_LONGEST_TITLE = 10_000  # characters
_KEY = re.compile(r"[a-z_]+:")  # that of a YAML document
# what YAML begins with, and a row of numbers
_NO_HEADING = re.compile(r":(?:\s|$)|^\s*[-#\[{&%'|>]|^\s*-?[\d.]")
# no separator inside quotes or brackets separates columns
_ENCLOSED = re.compile(r'"[^"]*"|(?<!\s)\s*(?:\([^()]*\)|\[[^][]*\])')
# a heading or a cell between blanks
_IN_BLANKS = re.compile(r"\"[^\"]*\"|[^\s\[(]\S*(?:\s*[\[(][^\])]{0,200}[\])])?")
_BARE = ("", "-", "1")  # no unit
# a column for an item of a list, such as pieces_1_width
ITEM = re.compile(r"([a-z_]+)_(\d{1,4})_([a-z_]+)")

# a number with a decimal comma, and the unit or the spread behind it
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?(?:\s*[^\s\d,.].*)?")
_DECIMAL_POINT = re.compile(r"[+-]?\d*\.\d+(?:[eE][+-]?\d+)?\s*([^\s\d,.].*)?")
# 1.234 and 1,234 may also be a thousand and some
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}(?!\d).*")


_Number = tuple[int, int, str]  # line, column and text of a cell
# called with the fault of a row of a table of structures that is left out
Faulty = Callable[[DocumentError], None]


class Cell(NamedTuple):
    """A non-empty cell of a table of structures."""

    key: str  # that of its column
    text: str  # in YAML form, with the unit of the heading
    place: Place  # its column counts cells
    written: str = ""  # its text as it stands in the file
    unit: str = ""  # of the heading


class Row(NamedTuple):
    """A row that is not blank; it may lack cells, or have more than the heading."""

    line: int  # in the file
    cells: list[str]  # without blanks around them, numbers with decimal points
    written: list[str]  # before decimal commas became points


@dataclass(frozen=True)
class Table:
    """A table as it is written. Its rows are read anew each time, so that a table may
    be larger than the memory.
    """

    source: str  # the file
    line: int  # that of the heading
    headings: list[str]  # one for each column
    comments: str  # the lines above the heading
    read: Callable[[], Iterator[Row]]  # yields the rows

    def place(self, line: int, column: int = 0) -> Place:
        """Return the place of a cell; column: its number from 0."""
        return Place(self.source, line, column + 1)

    def full_rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield line and cells of each row. Raises DocumentError for a row of another
        number of cells than the heading.
        """
        for line, cells, _ in self.read():
            if len(cells) != len(self.headings):
                raise self.uneven(line, cells)
            yield line, cells

    def uneven(self, line: int, cells: Sequence[str]) -> DocumentError:
        """Return the error for a row of another number of cells than the heading."""
        found, wanted = len(cells), len(self.headings)
        decimal = found > wanted and any(
            one.isdigit() and other.isdigit() for one, other in pairwise(cells)
        )
        hint = (
            " (with commas in numbers, the columns need another separator: ; or a tab)"
            if decimal
            else ""
        )
        return DocumentError(
            f"{self.place(line, min(found, wanted))}: found {found} cells; expected"
            f" {wanted}{hint}"
        )


def read_table(path: str | Path) -> Table:
    """Return the table of a file; `-` is standard input. Raises UsageError for a file
    that cannot be read, and DocumentError.
    """
    return _table_of(text_at(path))


def table_of(text: str, source: str) -> Table:
    """Return the table of a text, without headings if it is empty. Raises DocumentError
    for one that is not valid CSV.
    """
    return _table_of(Text.of(text, source))


def _table_of(text: Text) -> Table:
    """Return the table of a text, of which every row has been read once: it is valid
    CSV and has one decimal mark. Raises DocumentError.
    """
    start, separator = _heading_of(text.head)
    comments = text.head[:start]
    first = 1 + len(_LINE_END.findall(comments))

    def lines() -> Iterator[tuple[int, list[str]]]:
        return _split(text.lines(start, first), separator, text.source, first)

    (line, headings), *_ = [*islice(lines(), 1), (first, list[str]())]
    used = {i for i, heading in enumerate(headings) if heading}
    marks = _DecimalMarks()
    for at, cells in islice(lines(), 1, None):
        # a spreadsheet writes columns that are empty, heading and all
        if len(used) < len(headings) or len(cells) > len(headings):
            used |= {i for i, cell in enumerate(cells) if cell}
        if separator != ",":
            marks.add(at, cells)
    width = 1 + max(used, default=-1)
    kept = None if len(used) == width else sorted(used)

    def read() -> Iterator[Row]:
        for at, cells in islice(lines(), 1, None):
            written = cells[:width]
            if kept is not None:
                written = [cells[i] for i in kept if i < len(cells)]
            pointed = written if separator == "," else [*map(_with_point, written)]
            yield Row(at, pointed, written)

    own = [headings[i] for i in sorted(used) if i < len(headings)]
    table = Table(text.source, line, own, comments, read)
    if doubt := marks.doubt():
        (at, column, cell), other = doubt
        raise DocumentError(
            f"{table.place(at, sorted(used).index(column))}: found {cell} beside"
            f" {other}, so that {cell} may be a thousand and some; expected one decimal"
            " mark in all rows"
        )
    return table


def _heading_of(text: str) -> tuple[int, str]:
    """Return the place in the text where the heading begins, and the separator of its
    columns.
    """
    start, separator = 0, ""
    if stated := _SEP.match(text):
        start, separator = stated.end(), stated[1]
    while (comment := _COMMENT.match(text, start)) and comment.end() > start:
        start = comment.end()
    line = _LINE.match(text, start)
    plain = _ENCLOSED.sub(
        lambda found: "x" if found[0][0] == '"' else "",
        line[0].strip(" ") if line else "",
    )
    return start, separator or next((one for one in _SEPARATORS if one in plain), ",")


def _split(
    lines: Iterable[str], separator: str, source: str, first: int
) -> Iterator[tuple[int, list[str]]]:
    """Yield the line and the cells of each row that is not blank; first: the line of
    the file with which the lines begin. Raises DocumentError.
    """
    if separator == BLANKS:
        for at, text in enumerate(lines, first):
            if text.strip():
                yield at, [cell.strip('"') for cell in _IN_BLANKS.findall(text)]
        return
    reader = csv.reader(
        lines, delimiter=separator, skipinitialspace=separator != "\t", strict=True
    )
    line = first
    try:
        for row in reader:
            at, line = line, first + reader.line_num
            cells = [cell.strip() for cell in row]
            if any(cells):
                yield at, cells
    except csv.Error as error:
        raise DocumentError(
            f"{Place(source, line, 1)}: not valid CSV: {error}"
        ) from None


class _DecimalMarks:
    """The decimal marks of a table whose commas separate no columns. A number may be a
    thousand and some: 1.234 beside decimal commas, or 1,234 beside points if every
    comma stands so.
    """

    def __init__(self) -> None:
        # (line, column, text) of the first number with a comma, with a point, and with
        # a point that may stand behind thousands
        self.comma: _Number | None = None
        self.point: _Number | None = None
        self.grouped: _Number | None = None
        self.only_grouped = True  # True while every comma may stand behind thousands

    def add(self, line: int, cells: Sequence[str]) -> None:
        """Look at the cells of a row."""
        for i, cell in enumerate(cells):
            if "," in cell and _DECIMAL_COMMA.fullmatch(cell):
                self.comma = self.comma or (line, i, cell)
                self.only_grouped &= bool(_GROUPED.fullmatch(cell))
            elif (
                "." in cell
                and (number := _DECIMAL_POINT.fullmatch(cell))
                # 2.1 may also begin a name
                and (number[1] is None or number[1] in FACTORS)
            ):
                self.point = self.point or (line, i, cell)
                if self.grouped is None and _GROUPED.fullmatch(cell):
                    self.grouped = line, i, cell

    def doubt(self) -> tuple[_Number, str] | None:
        """Return the number that may be a thousand and some, and the text of one with
        another mark; None without one.
        """
        if self.comma is None or self.point is None:
            return None
        if self.grouped is not None:
            return self.grouped, self.comma[2]
        return (self.comma, self.point[2]) if self.only_grouped else None


def _with_point(cell: str) -> str:
    """Return the text of a cell with a decimal point for a decimal comma."""
    decimal = "," in cell and _DECIMAL_COMMA.fullmatch(cell)
    return cell.replace(",", ".", 1) if decimal else cell


def split_heading(heading: str) -> tuple[str, str]:
    """Split the heading of a column into (name, unit)."""
    heading = heading.strip()
    if not heading.endswith((")", "]")):
        return heading, ""
    inner = heading[:-1]
    start = max(inner.rfind(")"), inner.rfind("]")) + 1  # behind the brackets before
    opened = [at for mark in "[(" if (at := inner.find(mark, start)) >= 0]
    if not opened:
        return heading, ""
    return inner[: min(opened)].strip(), inner[min(opened) + 1 :].strip()


def columns_of(table: Table) -> list[tuple[str, str]]:
    """Return (key, unit) of each column; a heading whose brackets hold no known unit is
    a key as a whole. Raises DocumentError.
    """
    found: list[tuple[str, str]] = []
    before: set[str] = set()
    for i, heading in enumerate(table.headings):
        key, unit = split_heading(heading)
        if not key:
            raise DocumentError(
                f"{table.place(table.line, i)}: a column without a name; expected a"
                " key, and a unit in brackets"
            )
        if unit not in _BARE and unit not in FACTORS:
            key, unit = heading, ""
        if key in before:
            raise DocumentError(
                f"{table.place(table.line, i)}: duplicate column {key!r}"
            )
        before.add(key)
        found.append((key, unit))
    return found


def with_unit(cell: str, unit: str) -> str:
    """Return the text of a cell with the unit of its heading, unless the cell states
    its own.
    """
    if unit in _BARE:
        return cell
    if is_spread(cell):
        return in_unit(cell, unit) if has_no_unit(cell) else cell
    parts = split_quantity(cell)
    return f"{cell} {unit}" if parts is not None and not parts[1] else cell


def named_rows(path: str | Path) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """Return (column names, rows) of the table of a file; a row is (line number, cells
    by column, with the unit of the heading). Raises UsageError, DocumentError.
    """
    table = read_table(path)
    columns = columns_of(table)
    rows = [
        (
            line,
            {
                key: with_unit(cell, unit)
                for cell, (key, unit) in zip(cells, columns, strict=True)
            },
        )
        for line, cells in table.full_rows()
    ]
    return [key for key, _ in columns], rows


def rows_of_structures(
    text: Text, faulty: Faulty | None = None
) -> Iterator[list[Cell]] | None:
    """Return the rows of a table of structures, None for a text that is no table;
    faulty: as of `rows_of`. Raises DocumentError without a column `kind`, or with
    lines above the heading.
    """
    head, source = text.head, text.source
    start, separator = _heading_of(head)
    lines = _TWO_LINES.match(head, start)
    first, second = lines.groups() if lines else ("", "")
    if len(first) > _LONGEST_HEADING and KIND not in first[:10_000]:
        return None
    names = _names(first, separator)
    if len(names) > 1 and KIND in names:
        cells = _fields(second, separator)
        if separator == BLANKS and len(cells) < 2:
            return None
        return rows_of(text, faulty)
    _require_the_heading_first(head, start, source)
    if (
        len(names) > 1
        and separator != BLANKS
        and all(names)
        and not _NO_HEADING.search(first)
        and len(_fields(second, separator)) == len(names)
    ):
        found = ", ".join(names)
        shown = found if len(found) <= 60 else found[:57] + "..."
        hints = (did_you_mean(name, [KIND]) for name in names)
        raise DocumentError(
            f"{Place(source, 1, 1)}: CSV without a column {KIND!r}; found"
            f" {shown}{next(filter(None, hints), '')}; expected a heading such as"
            " kind,name,width"
        )
    return None


def _require_the_heading_first(text: str, start: int, source: str) -> None:
    """Raise DocumentError if the heading of a table of structures stands below a title
    or another line. start: the place where the heading should begin.
    """
    if _KEY.match(text, start):
        return
    first = 1 + len(_LINE_END.findall(text, 0, start))
    lines = _LINE_END.split(text[start : start + _LONGEST_TITLE])
    for at, line in enumerate(lines[1:], first + 1):
        if KIND not in line.casefold() or _NO_HEADING.search(line):
            continue
        _, separator = _heading_of(line)
        names = [name.casefold() for name in _names(line, separator)]
        if separator != BLANKS and len(names) > 1 and KIND in names:
            raise DocumentError(
                f"{Place(source, first, 1)}: CSV: line {first} is no heading; line"
                f" {at} looks like one: delete the lines above it, or begin them with #"
            )


def text_of_row(cells: Iterable[Cell], labels: Collection[str]) -> str:
    """Return a row of a table of structures as the text of a document; labels: the
    columns of its labels.
    """
    lines = [
        f"{cell.key}: {json.dumps(cell.text) if cell.key == 'name' else cell.text}"
        for cell in cells
        if cell.key not in labels
    ]
    texts = {cell.key: cell.written for cell in cells if cell.key in labels}
    return "\n".join([*lines, *[f"{LABELS}: {json.dumps(texts)}"] * bool(texts)])


def _names(line: str, separator: str) -> list[str]:
    """Return the names of the columns of a heading."""
    fields = _fields(line, separator)
    return [split_heading(name.strip().strip('"'))[0] for name in fields]


def _fields(line: str, separator: str) -> list[str]:
    return line.split() if separator == BLANKS else line.split(separator)


def rows_of(text: Text, faulty: Faulty | None = None) -> Iterator[list[Cell]]:
    """Yield the non-empty cells of each row of a table of structures. A row with more
    cells than the heading is left out and told to `faulty`, without which it raises
    DocumentError. Raises DocumentError.
    """
    table = _table_of(text)
    columns = columns_of(table)
    for line, cells, written in table.read():
        if len(cells) > len(columns):
            fault = table.uneven(line, cells)
            if faulty is None:
                raise fault
            faulty(fault)
            continue
        yield [
            Cell(key, with_unit(cell, unit), table.place(line, i), as_written, unit)
            for i, (cell, as_written, (key, unit)) in enumerate(
                zip(cells, written, columns, strict=False)
            )
            if cell
        ]
