"""CSV files: rows by column name, and tables of structures.

In a table of structures a row is a document, a column a key, and the heading may state the unit; columns `pieces_1_width`,
`pieces_2_width` form a list of mappings, a cell that begins with a bracket is a YAML list, an empty cell means no key.
"""

import csv
import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from ..errors import DocumentError
from .composition import LONGEST, Place, text_of
from .files import read_bytes
from .quantities import FACTORS, split_quantity

KIND = "kind"  # only a table of structures has this column
_DELIMITERS = (",", ";", "\t")
_HEADING = re.compile(r"\s*(?P<key>.*?)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?\s*", re.DOTALL)
_FIRST_LINE = re.compile(r"\s*([^\r\n]{1,10000})")
_LONGEST_HEADING = 100_000  # characters
_NO_HEADING = re.compile(r":(?:\s|$)|^\s*[-#\[{&%\"'|>]|^\s*-?[\d.]")  # what YAML begins with, and a row of numbers
_BARE = ("", "-", "1")  # no unit
_WORDS = {"True": "true", "TRUE": "true", "False": "false", "FALSE": "false"}  # as spreadsheets write them


class Cell(NamedTuple):
    """A non-empty cell: its key, its text in YAML form, and its place (the column counts cells)."""

    key: str
    text: str
    place: Place


def delimiter_of(text: str) -> str | None:
    """Return the delimiter of a text whose first line names a column `kind` and at least one more; None for other texts."""
    match = _FIRST_LINE.match(text)
    first = match[1] if match else ""
    for delimiter in _DELIMITERS if KIND in first else ():
        try:
            names = [split_heading(heading)[0] for heading in next(csv.reader([first], delimiter=delimiter), [])]
        except csv.Error:
            continue
        if len(names) > 1 and KIND in names:
            return delimiter
    return None


def rows_of_structures(text: str, source: str) -> Iterator[list[Cell]] | None:
    """Return the rows of a table of structures, None for a text that is no table. Raises DocumentError without a column `kind`."""
    if delimiter := delimiter_of(text):
        return rows_of(text, source, delimiter)
    first, _, rest = text.lstrip().partition("\n")
    for delimiter in _DELIMITERS if len(first) <= _LONGEST_HEADING and not _NO_HEADING.search(first) else ():
        names = first.split(delimiter)
        if len(names) > 1 and all(name.strip() for name in names) and rest.partition("\n")[0].count(delimiter) == len(names) - 1:
            found = ", ".join(split_heading(name)[0] for name in names)
            shown = found if len(found) <= 60 else found[:57] + "..."
            wanted = "expected a heading such as kind,name,width"
            raise DocumentError(f"{Place(source, 1, 1)}: CSV without a column {KIND!r}; found {shown}; {wanted}")
    return None


def rows_of(text: str, source: str, delimiter: str) -> Iterator[list[Cell]]:
    """Yield the non-empty cells of each row that is not blank. Raises DocumentError."""
    if len(text) > LONGEST:
        raise DocumentError(f"{source}: longer than {LONGEST >> 20} MiB, the limit of a table")
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    columns: list[tuple[str, str]] | None = None
    line = 1
    try:
        for row in reader:
            line, first = reader.line_num + 1, line
            if not any(cell.strip() for cell in row):
                continue
            if columns is None:
                columns = _columns(row, source, first)
                continue
            if len(row) > len(columns):
                raise DocumentError(f"{Place(source, first, len(columns) + 1)}: found {len(row)} cells; expected {len(columns)}")
            yield [
                Cell(key, _with_unit(cell.strip(), unit), Place(source, first, i))
                for i, (cell, (key, unit)) in enumerate(zip(row, columns, strict=False), 1)
                if cell.strip()
            ]
    except csv.Error as error:
        raise DocumentError(f"{Place(source, line, 1)}: not valid CSV: {error}") from None


def named_rows(path: str | Path) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """Return (column names, rows) of any CSV file; a row is (line number, cells by column). Raises UsageError, DocumentError."""
    source, raw = read_bytes(path)
    reader = csv.DictReader(io.StringIO(text_of(source, raw), newline=""), strict=True)
    try:
        return list(reader.fieldnames or ()), [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise DocumentError(f"{source}: is not CSV ({error})") from None


def split_heading(heading: str) -> tuple[str, str]:
    """Split the heading of a column into (name, unit)."""
    match = _HEADING.fullmatch(heading)
    return (match["key"], match["unit"] or "") if match else (heading, "")


def _columns(row: list[str], source: str, line: int) -> list[tuple[str, str]]:
    columns = [split_heading(heading) for heading in row]
    before: set[str] = set()
    for i, (key, unit) in enumerate(columns, 1):
        place = Place(source, line, i)
        if not key:
            raise DocumentError(f"{place}: a column without a name; expected a key, and a unit in brackets")
        if key in before:
            raise DocumentError(f"{place}: duplicate column {key!r}")
        before.add(key)
        if unit not in _BARE and unit not in FACTORS:
            raise DocumentError(f"{place}: {key}: found the unit {unit!r}; expected one of {', '.join(FACTORS)}")
    return columns


def _with_unit(cell: str, unit: str) -> str:
    parts = split_quantity(cell)
    bare = parts is not None and not parts[1]
    return f"{cell} {unit}" if bare and unit not in _BARE else _WORDS.get(cell, cell)
