"""The lines above the numbers of a plain file: headings of columns, and other lines."""

import csv
import re
from collections.abc import Iterator
from typing import NamedTuple

from .directions import is_direction
from .headings import (
    ACCELERATION,
    FREQUENCY,
    PERIOD,
    TIME,
    UNKNOWN,
    HeadingCell,
    cell_of,
    cells_in,
    units_row,
)
from .printed_numbers import finite_number
from .rows import NumberRows, is_row
from .text import RecordText
from .units import dimension_of

# the sign of a comment; `#` alone in a cell is a heading, the number of a row
_COMMENT = re.compile(r"^\s*(?:[#%!*>]|//)+\s*(?![\s,;])")
# a line such as `Column 2: Acceleration (g)` or `y-axis: a [g]`
_COLUMN = re.compile(
    r"(?:(?:col|column|spalte|columna|colonna|colonne|sutun|field)\.?\s*#?\s*(\d)"
    r"|([xy])(?:[\s-]?axis|\s?label)?(?=\s*[:=]|\s?label|[\s-]?axis|\s))"
    r"(?:\s*[:=)-]\s*|\s+)([^\d\s:=].*)",
    re.IGNORECASE,
)
_LIST_OF_COLUMNS = re.compile(
    r"^(?:columns?|format|fields|headings?)\s*:\s*", re.IGNORECASE
)
# a number with its unit, such as `filter 0.1-25 Hz`
_VALUE = re.compile(r"\d\s*(?:k?hz|m?s|secs?|seconds?)\b", re.IGNORECASE)
_LONGEST_HEADINGS = 10_000  # characters of a line of headings
_APART = re.compile(r"[\s,;]+")  # what stands between headings
_IN_BRACKETS = re.compile(r"[\[(][^\])]*[\])]")
AMBIGUOUS = ("u", "v", "V", "U", "x")  # alone beside times: a direction or a quantity


class Title(NamedTuple):
    """A line above the numbers."""

    text: str  # the line as the file has it
    line: int  # number of the line in the file


def titles_of(text: RecordText) -> Iterator[Title]:
    """Read up to the first of two rows of numbers, and yield the lines above."""
    while True:
        at, line = text.at, text.line
        found = text.any_line()
        if found is None:
            raise text.fault("no numbers")
        if not found.strip():
            continue
        if is_row(found):
            rest = text.decoded(text.raw[text.at : text.at + 20_000]).lstrip()
            if not rest or is_row(rest.split("\n", 1)[0]):
                text.at, text.line = at, line
                return
        long = len(found) > _LONGEST_HEADINGS
        for words in (found,) if long else _APART.split(found):
            text.require_short(words, line)
        yield Title(found, line)


def unmarked(line: str) -> str:
    return _COMMENT.sub("", line).strip()


def cells_above(titles: list[Title]) -> int | None:
    """How many headings the last line above the numbers seems to hold."""
    if not titles:
        return None
    last = unmarked(titles[-1].text)
    return 2 if "," in last else 1


def _split(line: str, columns: int, separator: str) -> list[str] | None:
    """The cells of a line in one of the ways that give as many as there are columns."""
    for mark in dict.fromkeys((separator, ",", ";", "\t")):
        if mark in line and mark != " ":
            quoted = next(csv.reader([line], delimiter=mark, skipinitialspace=True), [])
            while quoted and not quoted[-1].strip() and len(quoted) > columns:
                quoted.pop()
            if len(quoted) == columns:
                return [x.strip() for x in quoted]
    wide = re.split(r"\s{2,}|\t", line)
    if len(wide) == columns:
        return wide
    parts = [] if any(mark in line for mark in ",;\t") else cells_in(line)
    return parts if len(parts) == columns else None


def headings(
    text: RecordText, titles: list[Title], rows: NumberRows
) -> tuple[list[HeadingCell] | None, list[Title]]:
    """(what the columns are called, None where nothing says so; the other lines)."""
    columns = rows.columns
    if columns == 1 or not titles:
        for title in titles[-1:]:
            _require_one(text, title, rows)
        return None, titles
    described, titles = _described(titles, columns)
    named: list[list[str]] = [described] if described else []
    others: list[Title] = []
    for title in titles:
        words = _LIST_OF_COLUMNS.sub("", unmarked(title.text))
        cells = _split(words, columns, rows.separator)
        direct = title == titles[-1] and not _COMMENT.match(title.text)
        separated = any(mark in title.text for mark in ",;\t")
        if cells is not None and _are_headings(cells, direct, separated):
            units = units_row(cells)
            named.append(cells if units is None else [f"[{x}]" for x in units])
        else:
            others.append(title)
    if not named:
        for title in titles[-1:]:
            _require_as_many(text, title, rows)
        return None, others
    together = [" ".join(words) for words in zip(*named, strict=True)]
    return [cell_of(words, first=not i) for i, words in enumerate(together)], others


def _described(
    titles: list[Title], columns: int
) -> tuple[list[str] | None, list[Title]]:
    """(what lines such as `Column 2: Acceleration (g)` call each column, the other
    lines).

    None where they do not describe every column.
    """
    found: dict[int, str] = {}
    others: list[Title] = []
    for title in titles:
        parts = re.split(r"[,;]", unmarked(title.text))
        held = [_COLUMN.fullmatch(x.strip()) for x in parts]
        if not all(held):
            others.append(title)
        for one in filter(None, held):
            place = int(one[1]) if one[1] else "xy".index(one[2].lower()) + 1
            found[place] = one[3].strip()
    if sorted(found) != list(range(1, columns + 1)):
        return None, titles
    return [found[i + 1] for i in range(columns)], others


def _are_headings(cells: list[str], direct: bool, separated: bool) -> bool:
    """True if cells are headings of columns.

    direct: they stand right above the numbers; separated: by a mark, not by blanks.
    """
    found = [cell_of(x) for x in cells]
    if units_row(cells) is not None:
        return True
    if re.match(r"[-+.\d]", cells[0]) and not is_direction(cells[0]):
        return False
    if _holds_value(cells[0]):
        return False
    key = re.match(r"([^:=]*)[:=]", cells[0])
    if found[0].is_time_or_like and (key is None or cell_of(key[1]).is_time_or_like):
        return True
    if key is not None:
        return False
    directed = [x for x in found if x.component is not None]
    named = [x for x in found if x.component is not None or x.role == ACCELERATION]
    if not separated:
        return len(directed) == len(cells) or (len(named) > 1 and len(cells) > 2)
    return direct or (len(named) > 1 and all(x.role != UNKNOWN for x in found))


def _holds_value(cell: str) -> bool:
    """True for words with a frequency or a time, as `filter 0.1-25 Hz`: no heading."""
    return _VALUE.search(_IN_BRACKETS.sub(" ", cell)) is not None


def _require_one(text: RecordText, title: Title, rows: NumberRows) -> None:
    """Raise DocumentError if the line above one column names several,
    or another one.
    """
    text.require_short(title.text, title.line)
    words = unmarked(title.text)
    for mark in (",", ";", "\t"):
        cells = [x for x in words.split(mark) if x.strip()]
        if len(cells) > 1 and cell_of(cells[0]).role == TIME:
            raise text.fault(f"found {words!r} above one column of numbers", title.line)
    cell = cell_of(words)
    if words in AMBIGUOUS:
        raise text.fault(
            f"found the heading {words!r}, a direction or another quantity; expected an"
            " acceleration, such as a or acc",
            title.line,
        )
    few = (
        not re.search(r"\d", words)
        and len(words.split()) <= 3
        and not re.search(r"[:=]\s*\S", words)
    )
    if few and (cell.is_other or cell.role in (PERIOD, FREQUENCY)):
        raise text.fault(
            f"found {words!r} ({cell.role}); expected an acceleration", title.line
        )
    foreign = cell.odd != "" and dimension_of(cell.odd) not in (
        None,
        "acceleration",
        "time",
    )
    if few and cell.role == UNKNOWN and ("[" in words or foreign):
        raise text.fault(
            f"found {cell.odd or words!r} in the heading {words!r}, which is not"
            " understood",
            title.line,
        )


def _require_as_many(text: RecordText, title: Title, rows: NumberRows) -> None:
    """Raise DocumentError if the line above the numbers names more or fewer columns."""
    words = unmarked(title.text)
    for mark in (",", ";", "\t"):
        cells = [x for x in words.split(mark) if x.strip()]
        if (
            len(cells) > 1
            and cell_of(cells[0]).is_time_or_like
            and not _holds_value(cells[0])
        ):
            said = (
                f"found {len(cells)} headings in {words!r} above {rows.columns} columns"
            )
            raise text.fault(said, title.line)


def require_no_row(text: RecordText, title: Title, columns: int) -> None:
    """Raise DocumentError for a line that may be a row of numbers with a fault."""
    words = unmarked(title.text).replace(",", " ").replace(";", " ").split()
    begins = re.match(r"[-+]?\.?\d", words[0]) if words else None
    if begins and len(words) == columns and columns > 1:
        numbers = [x for x in words if re.match(r"[-+]?\.?\d", x)]
        if len(numbers) * 2 >= len(words) and not re.search(
            r"[a-zA-Z]{2,}", " ".join(numbers)
        ):
            raise text.fault(
                f"found {title.text.strip()!r} above the numbers, which is not"
                " understood",
                title.line,
            )


def numbers_in(line: str) -> list[str]:
    """The numbers of a line that holds nothing else, as printed."""
    found = [x for x in re.split(r"[\s;]+", line) if x]
    whole = all(finite_number(x.replace(",", ".").encode()) is not None for x in found)
    return found if whole else [x for x in re.split(r"[\s,;]+", line) if x]
