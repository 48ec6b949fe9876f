"""Plain text: columns of numbers below lines that say what they are.

One column of accelerations, two of times and accelerations, or several, of which a
heading names the quantities and directions. What the headings do not say, the user
states (unit, step, column), and what they say, the user may not contradict.
"""

import re
from pathlib import Path

import numpy as np

from ...arrays import Array
from ...errors import DocumentError, UsageError
from .claims import Claims, agree
from .first_numbers import without_first_numbers
from .headings import ACCELERATION, BARE, FREQUENCY, PERIOD, TIME, UNKNOWN, HeadingCell
from .record import EVERY, Series
from .rows import NumberRows, is_row, rows_of
from .text import RecordText
from .times import even_step, is_even
from .titles import (
    AMBIGUOUS,
    cells_above,
    headings,
    require_no_row,
    titles_of,
    unmarked,
)
from .units import ACCELERATIONS, WRITTEN_UNITS

NAME = "text"
_MOST_TITLE_LINES = 120
# what files of other quantities hold, by the last part of their names
_OTHER_FILES = {
    **dict.fromkeys(("vel", "velo", "veloc", "velocity", "vt2"), "velocities"),
    **dict.fromkeys(
        ("dis", "disp", "displ", "dsp", "displacement", "dt2"), "displacements"
    ),
    **dict.fromkeys(
        ("sa", "psa", "rsp", "rs", "spc", "spectrum", "spectra"), "a spectrum"
    ),
    **dict.fromkeys(("fft", "fas", "fourier"), "a Fourier spectrum"),
}
_FEWEST = 10  # numbers in one column, without a word, of a motion
_FEW = 4  # lines that may rise evenly by chance
_MANY = 5  # so many columns are no components: a short last line shows values in a row


def recognise(head: str) -> bool:
    """True if rows of numbers begin after at most 120 lines of other text."""
    lines = [line for line in head.split("\n", _MOST_TITLE_LINES + 3) if line.strip()]
    above = lines[: _MOST_TITLE_LINES + 1]
    # the last line has itself below
    below = [*lines[1:], lines[-1] if lines else ""][: len(above)]
    return any(is_row(x) and is_row(y) for x, y in zip(above, below, strict=True))


def read(text: RecordText) -> list[Series]:
    """Return the components of the file. Raises DocumentError and UsageError."""
    titles = list(titles_of(text))
    rows = rows_of(text, cells_above(titles))
    claims = Claims(text.fault)
    above = [x for x in titles if is_row(unmarked(x.text))]  # marked as comments
    titles = [x for x in titles if x not in above]
    cells, others = headings(text, titles, rows)
    for title in others:
        require_no_row(text, title, rows.columns)
        text.require_short(title.text, title.line)
        claims.take(
            title.text, title.line, strict=title == titles[-1] and rows.columns == 1
        )
    rows, remark = without_first_numbers(text, claims, rows, above)
    if rows.values.size == 0:
        raise text.fault("no numbers")
    table = _NumberTable(text, claims, rows, cells)
    found = table.wrapped() if table.is_wrapped else table.columns()
    table.require_count(found[0].samples.size)
    return [
        x._replace(remark="; ".join(filter(None, (x.remark, remark)))) for x in found
    ]


def agreeing(said: str, given: str | None) -> bool:
    """True unless the user states a unit of another size."""
    return given is None or ACCELERATIONS[given] == ACCELERATIONS[said]


class _NumberTable:
    """The numbers of a file with what its headings and its user say of them."""

    def __init__(
        self,
        text: RecordText,
        claims: Claims,
        rows: NumberRows,
        cells: list[HeadingCell] | None,
    ) -> None:
        self.text, self.claims, self.rows, self.cells = text, claims, rows, cells
        self.width = rows.columns

    @property
    def is_wrapped(self) -> bool:
        """True if each line goes on where the one before it ends."""
        counts, said = self.rows.counts, self.claims.count
        if self.text.given.column == EVERY:
            return True
        if (
            self.width == 1
            or self.cells is not None
            or self.text.given.column is not None
        ):
            return False
        full = bool((counts[:-1] == self.width).all()) and counts[-1] <= self.width
        total = said == int(counts.sum()) and said != counts.size
        times = self.rows.values[: int(counts[:-1].sum()) : self.width]
        rising = times.size > 2 and bool((np.diff(times) > 0.0).all())
        short = (
            counts.size > 1
            and counts[-1] < self.width
            and self.width >= _MANY
            and not rising
        )
        return full and (total or short)

    def wrapped(self) -> list[Series]:
        """The one record of lines of several values."""
        first = self.rows.values[:: self.width]
        if (
            self.rows.counts.size > _FEW
            and (self.rows.counts == self.width).all()
            and is_even(first)
        ):
            said = "the first numbers of the lines rise evenly, as times do"
            raise self.text.fault(
                f"{said}; `column` {EVERY} is for lines of values alone",
                int(self.rows.lines[0]),
            )
        unit, dt = self.unit(None), self.step()
        told = self.claims.count is None and self.text.given.column is None
        remark = f"{self.width} values a line, which are read one line after the other"
        name, values = self.claims.component, self.rows.values
        return [Series(name, dt, values, unit, remark=remark if told else "")]

    def columns(self) -> list[Series]:
        """The records of a table, or of a single column."""
        self.require_even_lines()
        values = self.rows.values.reshape(-1, self.width)
        if self.width == 1:
            if self.text.given.column not in (None, "1"):
                raise self.no_column("one column")
            self.require_motion(values)
            unit = self.unit(None)
            return [Series(self.claims.component, self.step(), values[:, 0], unit)]
        time = self.time_column(values)
        taken = self.taken(values, time)
        dt, remark = self.step_of_times(values, time), self.left_out()
        found = []
        for i in taken:
            cell = None if self.cells is None else self.cells[i]
            name = self.name_of(i, cell, len(taken))
            unit = self.unit(cell)
            found.append(Series(name, dt, values[:, i].copy(), unit, remark=remark))
        return found

    def require_motion(self, values: Array) -> None:
        """Raise NoAcceleration for a short list in a directory, as of factors or
        periods.
        """
        said = self.claims.unit is not None or self.claims.acceleration
        if not self.text.given.named and not said and len(values) < _FEWEST:
            words = f"{len(values)} numbers, too few for a motion"
            raise self.text.no_acceleration(
                f"{words}; they are taken where the file itself is named", 1
            )

    def require_even_lines(self) -> None:
        counts, lines = self.rows.counts, self.rows.lines
        if (counts != self.width).any():
            odd = int(np.argmax(counts != self.width))
            said = f"found {counts[odd]} numbers, {self.width} on the lines before"
            raise self.text.fault(said, int(lines[odd]))

    def require_count(self, found: int) -> None:
        said = self.claims.count
        if said is not None and said != found:
            quoted = self.claims.quoted["count"]
            raise self.text.fault(f"{found} values, where {quoted!r} states {said}")

    def time_column(self, values: Array) -> int | None:
        """The column of times, None without one."""
        first = self.cells[0] if self.cells is not None else None
        line = int(self.rows.lines[0])
        if first is not None and first.role in (PERIOD, FREQUENCY):
            what = f"found {first.text!r}, a {first.role}; expected a time"
            why = (
                "; a time is called t or time" if first.text.strip()[:1] == "T" else ""
            )
            raise self.text.fault(f"{what}: a spectrum is no record{why}", line - 1)
        if first is not None:
            return 0 if first.role == TIME else None
        time = values[:, 0]
        rising = bool((np.diff(time) > 0.0).all())
        steps = np.diff(time)
        even = (
            rising
            and steps.size > 0
            and float(steps.max()) <= 1.5 * float(np.median(steps))
        )
        if self.width == 2:
            return 0
        return 0 if even else None

    def taken(self, values: Array, time: int | None) -> list[int]:
        """The columns of accelerations that are wanted."""
        given = self.text.given.column
        if given is not None:
            self.require_one_time(values, time)
            return [self.asked(given, time)]
        if self.cells is None:
            if self.width == 2:
                return [1]
            first = "the first of times" if time == 0 else "none of times"
            raise self.text.fault(
                f"{self.width} columns without headings, {first}; give the one of the"
                f" accelerations as `column`, or `column` {EVERY} where each line goes"
                " on from the one before",
                int(self.rows.lines[0]),
            )
        return self.accelerations()

    def require_one_time(self, values: Array, time: int | None) -> None:
        """Raise DocumentError for lines of several pairs of time and value."""
        if (
            self.cells is not None
            or time is None
            or len(values) <= _FEW
            or not is_even(values[:, 0])
        ):
            return
        step = values[1, 0] - values[0, 0]
        for i in range(1, self.width):
            if is_even(values[:, i]) and agree(step, values[1, i] - values[0, i]):
                said = f"columns 1 and {i + 1} rise alike, as times do"
                raise self.text.fault(
                    f"{said}; expected one time a line", int(self.rows.lines[0])
                )

    def left_out(self) -> str:
        """A remark that names the columns of other quantities."""
        if self.cells is None or self.text.given.column is not None:
            return ""
        others = [cell.text for cell in self.cells if cell.is_other]
        return f"columns left out: {', '.join(others)}" if others else ""

    def accelerations(self) -> list[int]:
        """The columns whose headings name accelerations or directions."""
        assert self.cells is not None
        line = int(self.rows.lines[0])
        begin = 1 if self.cells[0].is_time_or_like else 0
        held = list(enumerate(self.cells))[begin:]
        for _, cell in held:
            if cell.role == UNKNOWN or cell.is_time_or_like:
                odd = cell.odd or cell.text
                raise self.text.fault(
                    f"found {odd!r} in the heading {cell.text!r}, which is not"
                    " understood; expected an acceleration, its unit and direction, or"
                    " `column`",
                    line - 1,
                )
        found = [i for i, cell in held if cell.role in (ACCELERATION, BARE)]
        said = [i for i in found if self.cells[i].role == ACCELERATION]
        spectra = [cell for _, cell in held if "spectrum" in cell.role]
        if not found or (spectra and not said):
            cell = spectra[0] if spectra else held[0][1]
            raise self.text.fault(
                f"found {cell.text!r} ({cell.role}); expected an acceleration", line - 1
            )
        alone = self.cells[found[0]]
        if len(found) == 1 and alone.role == BARE and alone.text.strip() in AMBIGUOUS:
            raise self.text.fault(
                f"found the heading {alone.text!r}, a direction or another quantity;"
                " expected an acceleration, such as a or acc",
                line - 1,
            )
        nameless = [
            self.cells[i].text for i in found if self.cells[i].component is None
        ]
        if len(found) > 1 and nameless:
            raise self.text.fault(
                f"the headings {', '.join(map(repr, nameless))} state no direction;"
                " expected names such as NS, EW, UD, or the number of one as `column`",
                line - 1,
            )
        return found

    def asked(self, given: str, time: int | None) -> int:
        """The column that the user names by its number."""
        number = int(given) if given.isdecimal() and len(given) < 6 else 0
        if not 1 <= number <= self.width:
            raise self.no_column(f"{self.width} columns")
        if number - 1 == time:
            raise UsageError(
                f"{self.text.source}: `column`: found {given}, which holds the times"
            )
        cell = None if self.cells is None else self.cells[number - 1]
        foreign = (
            cell is not None and cell.odd and cell.unit is None and "[" in cell.text
        )
        if cell is not None and (cell.is_other or cell.is_time_or_like or foreign):
            raise self.text.fault(
                f"found {cell.text!r} ({cell.role}) in column {number}; expected an"
                " acceleration",
                int(self.rows.lines[0]) - 1,
            )
        return number - 1

    def no_column(self, held: str) -> UsageError:
        given = self.text.given.column
        return UsageError(
            f"{self.text.source}: `column`: found {given}; the file holds {held}"
        )

    def name_of(self, column: int, cell: HeadingCell | None, taken: int) -> str | None:
        if cell is not None and cell.component is not None:
            return cell.component
        chosen = self.width > 2 and taken == 1 and self.text.given.column is not None
        if chosen and (cell is None or cell.role != ACCELERATION):
            return f"column {column + 1}" if cell is None else cell.text
        return self.claims.component

    # Steps and units

    def step(self) -> float:
        """The step [s] that a heading or the user states."""
        said, given = self.claims.step, self.text.given.dt
        columns = "one column of numbers" if self.width == 1 else "numbers"
        if said is None and given is None and self.claims.some_time is not None:
            words, line = self.claims.some_time
            raise self.text.fault(
                f"found {words!r}, which may be the step or a period; give the step as"
                " `dt`",
                line,
            )
        if said is None and given is None:
            raise DocumentError(
                f"{self.text.source}: {columns} without times; give their step as `dt`"
            )
        if said is not None and given is not None and not agree(said, given):
            raise self.otherwise("dt", f"{given:g} s", repr(self.claims.quoted["step"]))
        return given if given is not None else said or 0.0

    def step_of_times(self, values: Array, time: int | None) -> float:
        """The step [s] of a table."""
        if time is None:
            return self.step()
        cell = None if self.cells is None else self.cells[time]
        seconds = cell.seconds if cell is not None else None
        factor = seconds or self.claims.seconds or 1.0
        lines = self.rows.lines
        step = even_step(
            factor * values[:, time], self.text, int(lines[0]), lines=lines
        )
        given, said = self.text.given.dt, self.claims.step
        for stated, quoted in ((said, self.claims.quoted.get("step")), (given, None)):
            if stated is None or agree(step, stated):
                continue
            if quoted is None:
                raise self.otherwise("dt", f"{stated:g} s", f"times every {step:g} s")
            raise self.text.fault(
                f"times every {step:g} s, where {quoted!r} says otherwise"
            )
        return step

    def unit(self, cell: HeadingCell | None) -> str:
        """The unit that a heading or the user states."""
        said = cell.unit if cell is not None else None
        quoted = f"the heading {cell.text!r}" if cell is not None else ""
        above = self.claims.unit
        if said is not None and above is not None and not agreeing(said, above):
            words = self.claims.quoted["unit"]
            raise self.text.fault(f"found {quoted}, where {words!r} says otherwise")
        if said is None and self.claims.unit is not None:
            said, quoted = self.claims.unit, repr(self.claims.quoted["unit"])
        given = self.text.given.unit
        if said is None:
            self.require_name(cell)
        if said is not None and not agreeing(said, given):
            raise self.otherwise("unit", str(given), f"{said}, which {quoted} states")
        if said is None and given is None:
            raise DocumentError(
                f"{self.text.source}: plain numbers without a unit; give it as `unit`,"
                f" one of {', '.join(WRITTEN_UNITS)}"
            )
        return said or given or ""

    def otherwise(self, name: str, given: str, said: str) -> DocumentError:
        source = self.text.source
        return DocumentError(
            f"{source}: `{name}`: found {given}; the file says otherwise: {said}"
        )

    def require_name(self, cell: HeadingCell | None) -> None:
        """Refuse a file that is named as velocities and says nothing else itself."""
        if self.claims.acceleration or (cell is not None and cell.role == ACCELERATION):
            return
        name = Path(self.text.source).name.removesuffix(".gz").lower()
        stem, _, end = name.rpartition(".")
        words = re.split(r"[\s_.\-]+", stem)
        long = [x for x in words[:-1] if len(x) > 3]
        found = [_OTHER_FILES.get(x) for x in (end, words[-1], *long)]
        what = next(filter(None, found), None)
        if what is not None:
            raise self.text.no_acceleration(
                f"a file that is named as {what}, and states no acceleration; expected"
                " an acceleration (rename it if it holds one)",
                1,
            )
