"""Plain text: columns of numbers under at most one heading line.

One column of accelerations, two of times and accelerations, or several. A heading says
the quantity, unit and direction of its column. What it does not say the user states
(`unit`, `dt`, `column`); the user counts the lines above it (`skip`), which nobody
reads.
"""

import csv
import re
from pathlib import PurePath

import numpy as np

from ...arrays import Array
from ...errors import DocumentError, UsageError
from .directions import UNKNOWN as NO_DIRECTION
from .directions import direction_of
from .headings import ACCELERATION, INDEX, NO_UNIT, TIME, UNKNOWN, Heading, headings_of
from .record import EVERY, PAIRS, Series
from .rows import NumberRows, counts_up, is_row, rows_of, unlike_samples
from .text import RecordText
from .times import even_step, is_even
from .units import WRITTEN_UNITS

NAME = "text"
_MOST_TITLE_LINES = 120
# the sign of a comment; `#` alone in a cell is a heading, the number of a row
_COMMENT = re.compile(r"^\s*(?:[#%!*>]|//)+\s*(?![\s,;])")
_CELL = re.compile(r"[^\s\[({<]+(?:\s*[\[({<][^\])}>]{0,200}[\])}>])?")
_DATE = re.compile(r"\s*\"?\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::[\d.]*)?Z?")
# what files of other quantities hold, by the last part of their names
_OTHER_FILES = {
    **dict.fromkeys(("vel", "velocity", "vt2"), "velocities"),
    **dict.fromkeys(("dis", "disp", "displacement", "dt2"), "displacements"),
    **dict.fromkeys(("sa", "psa", "rsp", "spectrum", "fft", "fas"), "a spectrum"),
}
_USUAL = (TIME, INDEX, ACCELERATION)
_LONGEST_HEADINGS = 10_000  # characters of a line of headings
_FEW = 4  # lines that may rise evenly by chance
_FEWEST = 10  # numbers in one column, without a word, of a motion


def recognise(head: str) -> bool:
    """True if rows of numbers, or of a date and a number, begin after at most 120 lines
    of other text.
    """
    lines = [line for line in head.split("\n", _MOST_TITLE_LINES + 3) if line.strip()]
    rows = [is_row(x) or _date(x) is not None for x in lines]
    # the last line has itself below
    below = [*rows[1:], rows[-1]] if rows else []
    both = list(zip(rows, below, strict=True))[: _MOST_TITLE_LINES + 1]
    return any(row and next_row for row, next_row in both)


def read(text: RecordText) -> list[Series]:
    """Return the components of the file. Raises DocumentError and UsageError."""
    above = _lines_above(text)
    last, number = above[-1] if above else ("", 0)
    heading = _COMMENT.sub("", last).strip()
    rows = rows_of(text, heading)
    every = text.given.column == EVERY
    if text.given.column == PAIRS:
        rows = rows.in_pairs(text)
    cells = _cells(heading, rows.separator, 1 if every else rows.columns)
    if len(above) > 1:
        usual = cells is not None and all(x.role in _USUAL for x in cells)
        raise text.fault(
            f"found {_short(above[0][0])} and more lines above the numbers; expected"
            " one heading line at most:"
            f" `skip` {above[-2][1] if usual else number} passes over lines above",
            above[0][1],
        )
    if heading and cells is None:
        raise text.fault(
            f"found {_short(heading)} above {rows.columns} columns; expected a heading"
            f" for each, or `skip` {number}, which passes over it",
            number,
        )
    table = _Table(text, rows, cells, number)
    return table.wrapped() if every else table.columns()


def _date(line: str) -> str | None:
    """The date before the numbers of a row, None for another line."""
    found = _DATE.match(line)
    dated = found is not None and is_row(f"0{line[found.end() :]}")
    return found[0].strip() if found is not None and dated else None


def _short(words: str) -> str:
    return repr(words.strip() if len(words) < 63 else words.strip()[:60] + "...")


def _lines_above(text: RecordText) -> list[tuple[str, int]]:
    """Read up to the first of two rows of numbers; return the lines above, which are
    not blank, with their numbers.
    """
    above: list[tuple[str, int]] = []
    while (line := text.any_line()) is not None:
        number = text.line - 1
        if (date := _date(line)) is not None:
            raise text.fault(f"found {date!r}; expected a time in s", number)
        if is_row(line):
            rest = text.decoded(text.raw[text.at : text.at + 20_000]).lstrip()
            if not rest or is_row(rest.split("\n", 1)[0]):
                text.at, text.line = text.begin, number
                return above
        if line.strip():
            if len(line) > _LONGEST_HEADINGS:
                text.require_short(line, number)
            above.append((line, number))
    raise text.fault("no numbers")


def _cells(heading: str, separator: str, columns: int) -> list[Heading] | None:
    """What a line says of so many columns; None if it has another number of cells."""
    if not heading:
        return None
    words = [heading] if columns == 1 else _parted(heading, separator, columns)
    return headings_of(words) if words else None


def _parted(line: str, separator: str, columns: int) -> list[str] | None:
    """The cells of a line in one of the ways that give as many as there are columns."""
    for mark in dict.fromkeys((separator, ",", ";", "\t")):
        if mark in line and mark != " ":
            cells = next(csv.reader([line], delimiter=mark, skipinitialspace=True), [])
            while cells and not cells[-1].strip() and len(cells) > columns:
                cells.pop()
            if len(cells) == columns:
                return cells
    for ways in (re.split(r"\s{2,}|\t", line), line.split(), _CELL.findall(line)):
        if len(ways) == columns:
            return [str(x) for x in ways]
    return None


class _Table:
    """The numbers of a file with what its heading and its user say of them."""

    def __init__(
        self,
        text: RecordText,
        rows: NumberRows,
        cells: list[Heading] | None,
        line: int,
    ) -> None:
        self.text, self.rows, self.cells, self.line = text, rows, cells, line
        self.width, self.given = rows.columns, text.given
        self.told: list[str] = []

    def wrapped(self) -> list[Series]:
        """The one record of lines of several values, without the numbers of the
        lines.
        """
        ends = np.cumsum(self.rows.counts)
        starts, values = ends - self.rows.counts, self.rows.values
        counted = [x for x in (starts, ends - 1) if counts_up(values[x])]
        if counted and self.width > 1:
            self.told.append("a number that counts the lines, left out")
            values = np.delete(values, counted[0])
        elif len(starts) > _FEW and self.width > 1 and is_even(values[starts]):
            raise self.fault(
                "the first numbers of the lines rise evenly, as times do; `column`"
                f" {EVERY} is for lines of values alone"
            )
        self.require_samples()
        if self.cells is not None:
            self.accelerations(self.cells, [0])
        return [self.series(values, self.cell(0))]

    def columns(self) -> list[Series]:
        """The records of a table, or of a single column."""
        odd = np.flatnonzero(self.rows.counts != self.width)
        if odd.size:
            found = self.rows.counts[odd[0]]
            raise self.text.fault(
                f"found {found} numbers, {self.width} on the lines before; expected as"
                f" many, or `column` {EVERY} where each line goes on from the last",
                int(self.rows.lines[odd[0]]),
            )
        values = self.rows.values.reshape(-1, self.width)
        if self.width == 1:
            self.require_samples()
        begin, time = self.leading(values)
        taken = self.taken(values, begin, time)
        times = None if time is None else (values[:, time], self.cell(time))
        return [self.series(values[:, i].copy(), self.cell(i), times) for i in taken]

    def series(
        self,
        values: Array,
        cell: Heading | None,
        times: tuple[Array, Heading | None] | None = None,
    ) -> Series:
        """The record of values under a heading, with the column of times."""
        unit, dt = self.unit(cell), self.step(times)
        name = None if cell is None else cell.component
        if cell is not None and cell.role == UNKNOWN:  # as `Vertical sensor 5`
            known = direction_of(cell.text) != NO_DIRECTION
            name = cell.text if known else None
        return Series(name, dt, values, unit, remark="; ".join(self.told))

    def cell(self, column: int) -> Heading | None:
        return None if self.cells is None else self.cells[column]

    def fault(self, what: str) -> DocumentError:
        """Return the error at the heading, or at the first numbers without one."""
        return self.text.fault(what, self.line or int(self.rows.lines[0]))

    def require_samples(self) -> None:
        """Refuse first numbers that seem to be no samples, and a short list in a
        directory, as of factors or periods.
        """
        if self.cells is None and not self.given.as_it_stands:
            first = unlike_samples(self.rows, self.given.dt or 0.0)
            if first:
                above = int(self.rows.lines[0]) + first - 1
                words = " and ".join(x.decode("ascii") for x in self.rows.words[:first])
                raise self.fault(
                    f"found {words} above other numbers, as of a number of values, a"
                    f" step or a rate; expected samples alone: `skip` {above} passes"
                    " over it, `as_it_stands` takes it"
                )
        if self.rows.values.size < _FEWEST and not self.given.named and not self.cells:
            raise self.text.no_acceleration(
                f"{self.rows.values.size} numbers, too few for a motion; they are taken"
                " where the file itself is named",
                1,
            )

    def leading(self, values: Array) -> tuple[int, int | None]:
        """(number of leading columns that are no values, that of the times)."""
        cell, begin = self.cell(0), 0
        counted = self.width > 1 and counts_up(values[:, 0])
        if counted and (cell is None or cell.role in (INDEX, UNKNOWN)):
            self.told.append("column 1 counts the lines, left out")
            cell, begin = self.cell(1), 1
        left = self.width - begin
        if cell is not None and cell.is_other and left > 1:
            raise self.fault(f"found {cell.text!r} ({cell.role}); expected a time")
        if left == 1 or (cell is not None and cell.role == ACCELERATION):
            return begin, None
        if cell is not None and cell.role == UNKNOWN and self.given.column is None:
            raise self.not_understood(cell)
        if cell is None or cell.role == UNKNOWN:
            if left > 2 and not is_even(values[:, begin]):
                return begin, None
        elif cell.role == INDEX:
            raise self.fault(f"found no name of column {begin + 1}; expected a time")
        return begin + 1, begin

    def taken(self, values: Array, begin: int, time: int | None) -> list[int]:
        """The columns of accelerations that are wanted."""
        again = [
            i for i in range(begin, self.width) if i != time and is_even(values[:, i])
        ]
        if time is not None and self.cells is None and again and len(values) > _FEW:
            raise self.fault(
                f"columns {time + 1} and {again[0] + 1} rise alike, as times do;"
                f" expected one time a line, or `column` {PAIRS}, which reads pairs of"
                " times and values"
            )
        if self.given.column not in (None, PAIRS):
            return [self.asked(self.given.column, values, time)]
        if self.cells is None and self.width > begin + 1:
            raise self.fault(
                f"{self.width} columns without headings; expected the number of one as"
                f" `column`, or `column` {EVERY} where each line goes on from the last"
            )
        held = range(begin, self.width)
        if self.cells is None:
            return list(held)
        return self.accelerations(self.cells, list(held))

    def accelerations(self, cells: list[Heading], held: list[int]) -> list[int]:
        """The columns whose headings name accelerations, others told."""
        for i in held:
            if cells[i].role in (UNKNOWN, INDEX, TIME):
                raise self.not_understood(cells[i])
        found = [i for i in held if cells[i].role == ACCELERATION]
        others = [cells[i] for i in held if cells[i].is_other]
        if not found:
            cell = others[0]
            beside = f", or `skip` {self.line}" * cell.role.startswith(NO_UNIT)
            raise self.fault(
                f"found {cell.text!r} ({cell.role}); expected an acceleration{beside}"
            )
        nameless = [cells[i].text for i in found if cells[i].component is None]
        if len(found) > 1 and nameless:
            raise self.fault(
                f"the headings {', '.join(map(repr, nameless))} state no direction;"
                " expected names such as NS, EW, UD, or the number of one as `column`"
            )
        if others:
            left_out = ", ".join(x.text for x in others)
            self.told.append(f"columns left out: {left_out}")
        return found

    def not_understood(self, cell: Heading) -> DocumentError:
        return self.fault(
            f"found the heading {cell.text!r}, which is not understood; expected a name"
            " and a unit, such as acc [m/s2], the number of a column of accelerations"
            f" as `column`, or `skip` {self.line}"
        )

    def asked(self, given: str, values: Array, time: int | None) -> int:
        """The column that the user names by its number."""
        number, source = int(given), self.text.source
        if number > self.width:
            held = "one column" if self.width == 1 else f"{self.width} columns"
            raise UsageError(f"{source}: `column`: found {given}; the file has {held}")
        if number - 1 == time:
            raise UsageError(f"{source}: `column`: found {given}, that of the times")
        cell = self.cell(number - 1)
        if cell is not None and cell.role not in (ACCELERATION, UNKNOWN):
            raise self.fault(
                f"found {cell.text!r} ({cell.role}) in column {number}; expected an"
                " acceleration"
            )
        return number - 1

    def step(self, timed: tuple[Array, Heading | None] | None) -> float:
        """The step [s] of the times, or that which the user states."""
        given, lines = self.given.dt, self.rows.lines
        if timed is None:
            if given is None:
                raise DocumentError(
                    f"{self.text.source}: {'; '.join((*self.told, 'numbers'))} without"
                    " times; give their step as `dt`"
                )
            return given
        times, cell = timed
        if self.cells is None and is_even(times[1:]) and not is_even(times):
            raise self.fault(
                f"found {times[0]:g} above times that rise evenly; expected rows alone:"
                f" `skip` {int(lines[0])} passes over it"
            )
        factor = 1.0 if cell is None else cell.seconds
        return even_step(factor * times, self.text, int(lines[0]), lines=lines)

    def unit(self, cell: Heading | None) -> str:
        """The unit that the heading or the user states."""
        said, given = None if cell is None else cell.unit, self.given.unit
        if cell is None or cell.role == UNKNOWN:
            self.require_name()
        if said is None and given is None:
            raise DocumentError(
                f"{self.text.source}: plain numbers without a unit; give it as `unit`,"
                f" one of {', '.join(WRITTEN_UNITS)}"
            )
        return said or given or ""

    def require_name(self) -> None:
        """Refuse a file that is named as velocities where no heading says otherwise."""
        path = PurePath(self.text.source.removesuffix(".gz").lower())
        last = re.split(r"[\s_.\-]+", path.stem)[-1]
        what = _OTHER_FILES.get(path.suffix[1:], _OTHER_FILES.get(last))
        if what is not None:
            raise self.text.no_acceleration(
                f"a file that is named as {what}, and states no acceleration; expected"
                " an acceleration (rename it if it holds one)",
                1,
            )
