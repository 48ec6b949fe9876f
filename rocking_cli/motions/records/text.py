"""The text of a record file: lines, values of its header, and blocks of numbers, which
stand between blanks or in columns of a fixed width (Fortran), where neighbours may
touch. A block is parsed as a whole; if that fails, line by line, to name the place of
the fault.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple, Self

import numpy as np

from ...arrays import Array
from ...errors import DocumentError, NoAcceleration, UsageError
from .encodings import as_utf_8, encoding_of
from .printed_numbers import (
    NUMBER,
    OF_NUMBERS,
    TRAILER,
    finite_number,
    parsed,
    parted,
    shown,
    words_on_lines,
)
from .record import Given, Series
from .units import WRITTEN_UNITS, time_unit, unit_of

Keys = dict[str, tuple[str, int]]

HEAD = 1 << 16  # bytes in which a format shows itself
# characters of a line of words: patterns may take the square of them
LONGEST_LINE = 1000
_DOS_BLOCK = 128  # bytes
_LAST = 200  # bytes that may hold the last line
# the first word of a line of words, no number that is missing
_WORD = re.compile(rb"(?!(?:nan|inf)\b)[^\W\d_]", re.IGNORECASE)
# a format such as (8F10.5) or (1E15.6)
FORTRAN = r"\(\s*(?:\d+P\s*,?\s*)?(?P<columns>\d*)\s*[FEGDI]\s*(?P<width>[1-9]\d?)"


def begins(pattern: str) -> Callable[[str], bool]:
    """Return the function `recognise` of a format whose files begin with a pattern, in
    any case, after blank lines.
    """
    begin = re.compile(pattern, re.IGNORECASE | re.MULTILINE)
    return lambda head: begin.match(head.lstrip()) is not None


def cut_lines(head: str) -> str:
    """Return the lines of the beginning of a file that are not blank, cut to
    LONGEST_LINE characters.
    """
    lines = (line[:LONGEST_LINE] for line in head.split("\n"))
    return "\n".join(line for line in lines if line.strip())


def stated(
    pattern: re.Pattern[str], lines: Iterable[str], group: int = 1
) -> str | None:
    """Return a group of the first match of a pattern in the lines of a header; None if
    no line matches.
    """
    return next(
        (found[group] for line in lines if (found := pattern.search(line))), None
    )


class Format(NamedTuple):
    """A format of a module that holds several."""

    NAME: str  # as tables print it
    recognise: Callable[[str], bool]  # True for a text in this format
    read: "Callable[[RecordText], list[Series]]"  # returns the components of a text


class Layout(NamedTuple):
    """The layout of a full line of numbers."""

    columns: int  # number of values
    width: int | None = None  # characters of a value; None: separated by blanks

    @classmethod
    def of(cls, found: re.Match[str]) -> Self:
        """Return the layout of a match of FORTRAN."""
        return cls(max(1, int(found["columns"] or 1)), int(found["width"]))


def fortran_layout(text: str) -> Layout | None:
    """Return the layout of the first Fortran format in a text; None if
    there is none.
    """
    found = re.search(FORTRAN, text, re.IGNORECASE)
    return None if found is None else Layout.of(found)


class RecordText:
    """The text of one file and the place up to which it is read."""

    def __init__(self, source: str, raw: bytes, given: Given | None = None) -> None:
        # the file, for messages; what the user states
        self.source, self.given = source, given or Given()
        raw = as_utf_8(raw)
        if b"\r" in raw[:HEAD]:
            raw = raw.replace(b"\r\n", b"\n").replace(b"\r\n", b"\n")
            raw = raw.replace(b"\r", b"\n" if b"\n" not in raw[:HEAD] else b"")
        if b"\0" in raw:
            raw = raw.replace(b"\0", b" ")
        # where a text of DOS ends, to the end of its block
        if b"\x1a" in raw[-_DOS_BLOCK:]:
            raw = raw.rstrip(b"\x1a\n ")
        self.raw = raw  # the content, with line ends of Unix
        self.encoding = encoding_of(raw)  # its name
        if self.encoding == "utf-8" and not raw.isascii():
            self.raw = raw.replace("−".encode(), b"-").replace("\xa0".encode(), b" ")
        self.at, self.line = 0, 1  # place of the next byte; number of the next line
        self.begin = 0  # place of the last line
        self.skipped = self._skip()  # lines above, which are not read
        # the beginning as text
        self.head = self.decoded(self.raw[self.at : self.at + HEAD])
        # how many values the block that ends here has by its header, 0 behind a line
        self.declared = 0

    def _skip(self) -> list[str]:
        """Pass over the lines above and leave out those below that the user counts;
        return what is told of them.
        """
        skip, below = self.given.skip, self.given.below
        if not (skip or below):
            return []
        lines = self.raw.removesuffix(b"\n").split(b"\n")
        end = len(lines) - below
        if skip >= end:
            found = f"{skip}:{below}" if below else skip
            raise UsageError(
                f"{self.source}: `skip`: found {found}; the file has {len(lines)} lines"
            )
        self._take(skip)
        left_out = [(f"line {i}", x) for i, x in enumerate(lines[:skip], 1)]
        if below:
            self.raw = b"\n".join(lines[:end])
            left_out.append((f"line {end + 1} and below", lines[end]))
        told = [(place, self.decoded(x).rstrip()) for place, x in left_out]
        return [f"{place}, not read: {x!r}" for place, x in told if x]

    def decoded(self, raw: bytes) -> str:
        """Return bytes of the file as text."""
        return raw.decode(self.encoding, "replace")

    def fault(self, what: str, line: int | None = None) -> DocumentError:
        """Return the error for a line (default: the last one read)."""
        return DocumentError(
            f"{self.source}:{max(1, self.line - 1) if line is None else line}: {what}"
        )

    def no_acceleration(self, what: str, line: int | None = None) -> NoAcceleration:
        """Return the error for a valid file that holds something else."""
        return NoAcceleration(str(self.fault(what, line)))

    # Lines

    def any_line(self) -> str | None:
        """Return the next line, of any length, without its end; None after the last."""
        if self.at >= len(self.raw):
            return None
        return self.decoded(self._take(1)).rstrip()

    def next_line(self) -> str | None:
        """Return the next line of words without its end, None after the last. Raises
        DocumentError for one that is too long for words, and for more numbers than the
        block above it declares, on its last line or on the next.
        """
        if self.declared and (beyond := self.numbers_beyond()) is not None:
            found = f"found numbers after the {self.declared} values declared"
            raise self.fault(found, beyond)
        self.declared = 0
        line = self.any_line()
        self.require_short(line or "", self.line - 1)
        return line

    def require_short(self, words: str, line: int) -> None:
        """Raise DocumentError for words that are longer than those of a header."""
        if len(words) > LONGEST_LINE:
            raise self.fault(
                f"found {len(words)} characters, {words.strip()[:40]!r} and more, that"
                f" are not numbers alone; expected words of up to {LONGEST_LINE}"
                " characters",
                line,
            )

    def lines(self, count: int) -> list[str]:
        """Return the next `count` lines. Raises DocumentError if the
        file ends before.
        """
        found: list[str] = []
        for _ in range(count):
            if (line := self.next_line()) is None:
                raise self.fault("the file ends within its header")
            found.append(line)
        return found

    def find(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """Return the first match in the next lines and read to the end of its line;
        without one return None and read the whole file.
        """
        while (line := self.next_line()) is not None:
            if (found := pattern.search(line)) is not None:
                return found
        return None

    def like(self, pattern: re.Pattern[str], example: str) -> re.Match[str]:
        """Return the match of the next line. Raises DocumentError, with `example`, if
        the line does not match.
        """
        line = self.next_line() or ""
        if (found := pattern.search(line)) is None:
            raise self.fault(f"found {line.strip()!r}; expected a line like {example}")
        return found

    def _take(self, lines: int) -> bytes:
        begin = end = self.begin = self.at
        while lines and end < len(self.raw):
            end = self.raw.find(b"\n", end) + 1 or len(self.raw)
            lines, self.line = lines - 1, self.line + 1
        self.at = end
        return self.raw[begin:end]

    # Values of the header

    def keys(
        self, pattern: re.Pattern[str], end: re.Pattern[str] | None = None
    ) -> Keys:
        """Return each key (first group, in capitals) with its value (second group) and
        line, up to a line that matches `end`, whose key is "", or by default that
        begins with a number. Raises DocumentError without such a line.
        """
        found: Keys = {}
        while end is not None or not self.more_numbers():
            (line,) = self.lines(1)
            if (pair := pattern.match(line)) is not None:
                found[pair[1].strip().upper()] = pair[2].strip(), self.line - 1
            if end is not None and end.match(line):
                return {**found, "": (line, self.line - 1)}
        return found

    def value(self, keys: Keys, key: str, wanted: str = "") -> tuple[str, int]:
        """Return the value of a key and its line; wanted: the values allowed, in words.
        Raises DocumentError if it has none.
        """
        text, line = keys.get(key.upper(), ("", 1))
        if not text:
            raise self.fault(
                f"no value of {key}" + (f"; expected {wanted}" if wanted else ""), line
            )
        return text, line

    def number(self, text: str, line: int | None = None) -> float:
        """Return a number of the header. Raises DocumentError."""
        value = finite_number(text.strip().encode("utf-8", "replace"))
        if value is None:
            raise self.fault(
                f"found {text.strip()!r} in the header; expected a number", line
            )
        return value

    def count(self, text: str, line: int | None = None, same: int | None = None) -> int:
        """Return the number of values that a text of the header states; same: the
        number that another place of the header states. Raises DocumentError if the two
        differ.
        """
        value = self.number(text, line)
        if value != int(value) or value < 0.0:
            raise self.fault(
                f"a number of values of {text.strip()}; expected a whole number", line
            )
        if same is not None and value != same:
            raise self.fault(
                f"{text.strip()} points, where the header states {same}", line
            )
        return int(value)

    def step(
        self, text: str, line: int | None = None, name: str = "time step"
    ) -> float:
        """Return a time step [s] in the header. Raises DocumentError if it is not
        positive.
        """
        value = self.number(text, line)
        if not value > 0.0:
            raise self.fault(
                f"a {name} of {text.strip()}; expected a positive number", line
            )
        return value

    def step_of_rate(self, text: str, line: int | None = None) -> float:
        """Return the time step [s] of a sampling frequency [Hz] in the header. Raises
        DocumentError if it is not positive.
        """
        return 1.0 / self.step(text, line, "sampling frequency")

    def seconds(self, word: str) -> float:
        """Return the seconds of a unit of time in the header, 1 for an empty word.

        Raises DocumentError for a word that is no unit of time.
        """
        found = time_unit(word) if word.strip() else 1.0
        if found is None:
            raise self.fault(
                f"found {word.strip()!r} after a time step; expected s or ms"
            )
        return found

    def unit(self, word: str, line: int | None = None, key: str = "") -> str:
        """Return the unit of acceleration that a word of the header states, as
        `unit_of`. Raises DocumentError for any other word.
        """
        unit = unit_of(word)
        if unit is None:
            raise self.fault(
                f"{f'{key}: found' if key else 'found the unit'} {word!r}; expected"
                f" {', '.join(WRITTEN_UNITS)}",
                line,
            )
        return unit

    def agree(
        self,
        count: int,
        dt: float,
        duration: str,
        line: int | None = None,
        slack: float = 0.0,
    ) -> None:
        """Raise DocumentError if points and step contradict the declared duration [s],
        which may count the last step or not.
        """
        said = self.number(duration, line)
        if abs(count * dt - said) > max(1.6 * dt, 0.005 * said, slack):
            raise self.fault(
                f"{count} values every {dt:g} s make {count * dt:g} s, where the header"
                f" states {duration.strip()} s",
                line,
            )

    # Blocks of numbers

    def more_numbers(self) -> bool:
        """True if the next line that is not blank begins with a number."""
        rest = self.raw[self.at : self.at + 4096].split(None, 1)
        return bool(rest) and NUMBER.fullmatch(rest[0]) is not None

    def surplus(self) -> str:
        """Return a remark if numbers or words follow the last block, other than a line
        that says that the file ends.
        """
        if not self.declared:
            return ""
        if self.numbers_beyond() is not None:
            return f"more values than the {self.declared} declared, which are left out"
        left = TRAILER.sub(b"", b"\n" + self.raw[self.at :]).lstrip()
        if not left:
            return ""
        line = self.line + self.raw[self.at : self.raw.index(left, self.at)].count(
            b"\n"
        )
        words = self.decoded(left.split(b"\n", 1)[0]).strip()[:60]
        return f"{words!r} in line {line} and what follows, which are left out"

    def numbers_beyond(self) -> int | None:
        """The line of the next numbers, None if the file ends or other text follows,
        such as `2980 points of veloc data`.
        """
        ahead = self.raw[self.at : self.at + 4096]
        line = ahead.lstrip().split(b"\n", 1)[0]
        within = self.raw[self.at - 1 : self.at] != b"\n"  # on the line of the last
        first = line.split(None, 2)[: 1 if within else 2]
        numbers = all(finite_number(word) is not None for word in first)
        if not line or (line.translate(None, OF_NUMBERS) and not numbers):
            return None
        return self.line + ahead.partition(line)[0].count(b"\n")

    def rows(self, count: int, layout: Layout) -> Array:
        """Return the numbers of the next `count` full lines, (count, columns). Raises
        DocumentError at a line that holds something else.
        """
        at, first, columns = self.at, self.line, layout.columns
        values = self.numbers(count * columns, layout)
        self.declared = count
        if layout.width is not None:
            return values.reshape(count, columns)
        each = words_on_lines(self.raw[at : self.at])
        odd = np.flatnonzero((each != columns) & (each != 0))
        if odd.size:
            raise self.fault(
                f"found {each[odd[0]]} numbers on a line; expected {columns}",
                first + int(odd[0]),
            )
        return values.reshape(count, columns)

    def numbers(self, count: int, layout: Layout) -> Array:
        """Return the next `count` numbers; the next place is behind the last, also
        where more follow on its line. Raises DocumentError at a line that holds
        something else, or is not full in columns of a fixed width.
        """
        if count > len(self.raw) - self.at + 1:
            raise self.fault(
                f"{count} values are declared, more than a file of {len(self.raw)}"
                " bytes holds"
            )
        at, first, self.declared = self.at, self.line, count or self.declared
        if layout.width is None:
            taken = self._take(-(-count // layout.columns))
            for block in (taken, parted(taken)):
                found = None if block is None else parsed(block)
                if found is not None and found.size == count:
                    return found
            self.at, self.line = at, first
        values: list[float] = []
        for row in self._rows(count, layout):
            values += [
                self._finite(token, f", after {len(values) + i} of {count} values")
                for i, token in enumerate(row)
            ]
        return np.array(values)

    def block(self, count: int) -> Array:
        """Return the next `count` numbers, as many on each line as on the first, as
        `numbers`.
        """
        first = self.raw[self.at : self.at + 1000].lstrip().split(b"\n", 1)[0]
        columns = len((parted(first) or first).split())
        return self.numbers(count, Layout(max(1, columns)))

    def skip(self, count: int, layout: Layout) -> None:
        """Read past `count` numbers; stars may stand in their place. Raises
        DocumentError at a line that holds something else.
        """
        self.declared = count or self.declared
        for row in self._rows(count, layout):
            for token in row:
                if token.translate(None, OF_NUMBERS):
                    raise self.fault(f"found {shown(token)}; expected {count} numbers")

    def _rows(self, count: int, layout: Layout) -> Iterator[list[bytes]]:
        """The numbers of each line as printed, `count` in all."""
        done = 0
        while done < count:
            line = self._take(1)
            wanted = min(layout.columns, count - done)
            width = layout.width
            if not line:
                raise self.fault(f"the file ends after {done} of {count} values")
            row = line.split()
            if width is not None and len(row) != wanted:  # they touch, or are too few
                line = line.rstrip()
                row = [line[i : i + width].strip() for i in range(0, len(line), width)]
            left = count - done
            yield row[:left]
            if width is not None and len(row) != wanted:
                raise self.fault(
                    f"found {len(row)} numbers on a line; expected {wanted} (the header"
                    f" announces {count} values)"
                )
            if len(row) > left:  # back to the first number that is not declared
                self.at -= len(line.split(None, left)[left])
                self.line -= 1
            done += len(row)

    def numbers_of(self, block: bytes) -> tuple[Array, Array, Array]:
        """(numbers, how many stand on each line that is not blank, number of that
        line).

        block: the rest of the file from the next line on, with blanks between numbers
        or in fields of one width; a last line may say that it ends. Raises
        DocumentError at a word that is no number.
        """
        block = block[:-_LAST] + TRAILER.sub(b"", block[-_LAST:])
        each = words_on_lines(block)
        filled = np.flatnonzero(each)
        counts, lines = each[filled], self.line + filled
        values = parsed(block)
        fields = parted(block) if values is None else None
        if fields is not None and parsed(fields) is not None:
            return self.numbers_of(fields)
        if values is None:
            on = np.repeat(lines, counts)
            found = [finite_number(token) for token in block.split()]
            bad = next((i for i, value in enumerate(found) if value is None), None)
            if bad is not None:
                word, line = block.split()[bad], int(on[bad])
                words = on[bad] > on[bad - 1] and _WORD.match(word)
                raise self.fault(
                    f"found {shown(word)}; expected one block of numbers alone from"
                    f" line {self.line} on{self._apart(line) if words else ''}",
                    line,
                )
            values = np.array(found, dtype=float)
        return values, counts, lines

    def _apart(self, line: int) -> str:
        """Return the option that leaves out a line of words and those below."""
        above, below = self.line - 1, self.raw.rstrip().count(b"\n") + 2 - line
        above = above if above > self.given.skip + 1 else self.given.skip
        return f": `skip` {above}:{below} passes over lines above and below"

    def _finite(self, token: bytes, after: str = "") -> float:
        value = finite_number(token)
        if value is None:
            raise self.fault(f"found {shown(token)}{after}")
        return value
