"""The text of a record file: its lines, the values of its header, and its blocks of numbers.

A block is parsed as a whole, at the speed of NumPy. If that fails, it is read line by line, to name the place of the fault.
"""

from __future__ import annotations

import re

import numpy as np

from ...errors import DocumentError, NoAcceleration
from .numbers import NUMBER, OF_NUMBERS, Array, Layout, parsed, quoted, shown, value_of
from .record import WRITTEN_UNITS, unit_of

Keys = dict[str, tuple[str, int]]

HEAD = 1 << 16  # bytes in which a format shows itself
_LINES_AT_ONCE = 1 << 16
_DOS_BLOCK = 128  # bytes


class RecordText:
    """The text of one file and the place up to which it has been read; `line` is the number of the next line, from 1."""

    def __init__(self, source: str, raw: bytes) -> None:
        if b"\r" in raw[:HEAD]:
            raw = raw.replace(b"\r\n", b"\n").replace(b"\r\n", b"\n").replace(b"\r", b"\n" if b"\n" not in raw[:HEAD] else b"")
        if b"\0" in raw:
            raw = raw.replace(b"\0", b" ")
        if b"\x1a" in raw[-_DOS_BLOCK:]:  # where a text of DOS ends, to the end of its block
            raw = raw.rstrip(b"\x1a\n ")
        self.source, self.raw = source, raw.removeprefix(b"\xef\xbb\xbf")
        self.head = self.raw[:HEAD].decode("latin-1")
        self.at, self.line = 0, 1

    def fault(self, what: str, line: int | None = None) -> DocumentError:
        """The error for a line (default: the last one read)."""
        return DocumentError(f"{self.source}:{max(1, self.line - 1) if line is None else line}: {what}")

    def no_acceleration(self, what: str, line: int | None = None) -> NoAcceleration:
        """The error for a valid file that holds something else."""
        return NoAcceleration(str(self.fault(what, line)))

    # Lines

    def next_line(self) -> str | None:
        """The next line without its end, None after the last."""
        if self.at >= len(self.raw):
            return None
        return self._take(1).decode("latin-1").rstrip()

    def lines(self, count: int) -> list[str]:
        """The next `count` lines. Raises DocumentError if the file ends before."""
        found: list[str] = []
        while len(found) < count:
            line = self.next_line()
            if line is None:
                raise self.fault("the file ends within its header")
            found.append(line)
        return found

    def find(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """The first match in the lines to come; reads up to the end of its line, or of the file if there is none (None)."""
        while (line := self.next_line()) is not None:
            found = pattern.search(line)
            if found is not None:
                return found
        return None

    def _take(self, lines: int) -> bytes:
        """The bytes of the next lines, as many as there are."""
        begin = end = self.at
        while lines and end < len(self.raw):
            end = self.raw.find(b"\n", end) + 1 or len(self.raw)
            lines, self.line = lines - 1, self.line + 1
        self.at = end
        return self.raw[begin:end]

    # Values of the header

    def keys(self, pattern: re.Pattern[str]) -> Keys:
        """Each key (first group of the pattern) with its value (second group) and its line, above the first line that begins with a
        number. Raises DocumentError if there is no such line."""
        found: Keys = {}
        while not self.more_numbers():
            stated = pattern.match(self.lines(1)[0])
            if stated is not None:
                found[stated[1]] = stated[2].strip(), self.line - 1
        return found

    def value(self, keys: Keys, key: str, wanted: str = "") -> tuple[str, int]:
        """The value of a key and its line; wanted: what the value should be. Raises DocumentError if it has none."""
        text, line = keys.get(key, ("", 1))
        if not text:
            raise self.fault(f"no value of {key}" + (f"; expected {wanted}" if wanted else ""), line)
        return text, line

    def number(self, text: str, line: int | None = None) -> float:
        """A number of the header. Raises DocumentError."""
        value = value_of(text.strip().encode("latin-1", "replace"))
        if value is None:
            raise self.fault(f"found {text.strip()!r} in the header; expected a number", line)
        return value

    def count(self, text: str, line: int | None = None) -> int:
        """A number of values, as the header states it. Raises DocumentError."""
        value = self.number(text, line)
        if value != int(value) or value < 0.0:
            raise self.fault(f"a number of values of {text.strip()}; expected a whole number", line)
        return int(value)

    def step(self, text: str, line: int | None = None) -> float:
        """A time step [s], as the header states it. Raises DocumentError."""
        return self._positive(text, line, f"a time step of {text.strip()}")

    def rate(self, text: str, line: int | None = None) -> float:
        """A sampling frequency [Hz], as the header states it. Raises DocumentError."""
        return self._positive(text, line, f"a sampling frequency of {text.strip()} Hz")

    def _positive(self, text: str, line: int | None, what: str) -> float:
        value = self.number(text, line)
        if not value > 0.0:
            raise self.fault(f"{what}; expected a positive one", line)
        return value

    def unit(self, word: str, line: int | None = None, key: str = "") -> str:
        """The unit of acceleration that a word of the header states, as `unit_of`. Raises DocumentError if it states another."""
        unit = unit_of(word)
        if unit is None:
            found = f"{key}: found" if key else "found the unit"
            raise self.fault(f"{found} {word!r}; expected {', '.join(WRITTEN_UNITS)}", line)
        return unit

    def agree(self, count: int, dt: float, duration: str, line: int | None = None, slack: float = 0.0) -> None:
        """Raise DocumentError if points and step contradict the declared duration [s], which may count the last step or not."""
        stated = self.number(duration, line)
        if abs(count * dt - stated) > max(1.6 * dt, 0.005 * stated, slack):
            raise self.fault(f"{count} values every {dt:g} s make {count * dt:g} s, where the header states {duration.strip()} s", line)

    # Blocks of numbers

    def surplus(self, count: int) -> str:
        """A remark if more numbers follow than the header declares."""
        return f"more values than the {count} declared, which are left out" if self.more_numbers() else ""

    def more_numbers(self) -> bool:
        """True if the next line that is not blank begins with a number."""
        rest = self.raw[self.at : self.at + 4096].split(None, 1)
        return bool(rest) and NUMBER.fullmatch(rest[0]) is not None

    def demand_end(self, count: int) -> None:
        """Raise DocumentError if another line of numbers follows the `count` values that are declared."""
        ahead = self.raw[self.at : self.at + 4096]
        line = ahead.lstrip().split(b"\n", 1)[0]
        if line and not line.translate(None, OF_NUMBERS):
            blank = ahead.partition(line)[0].count(b"\n")
            raise self.fault(f"found a line of numbers after the {count} values declared", self.line + blank)

    def numbers(self, count: int, layout: Layout) -> Array:
        """The next `count` numbers, from as many lines as hold them. Raises DocumentError at a line that holds something else, and in
        columns of a fixed width at a line that is not full."""
        if count > len(self.raw) - self.at + 1:
            raise self.fault(f"{count} values are declared, more than a file of {len(self.raw)} bytes holds")
        values, done = np.empty(count), 0
        while done < count:
            left, at, first = count - done, self.at, self.line
            block = self._take(min(-(-left // layout.columns), _LINES_AT_ONCE))
            if not block:
                raise self.fault(f"the file ends after {done} of {count} values")
            rows = [] if layout.width is None else self._fields(block, layout, left)
            found = parsed(block if layout.width is None else b" ".join(field for row in rows for field in row))
            if found is None or found.size > left or (rows and found.size != sum(map(len, rows))):
                found, lines = self._one_by_one(rows or [line.split() for line in block.split(b"\n")], first, done, count)
                self.at, self.line = at, first
                self._take(lines)
            self._demand_full(rows, layout, left, count, first)
            values[done : done + found.size] = found
            done += found.size
        return values

    def skip(self, count: int, layout: Layout) -> None:
        """Read past `count` numbers; stars may stand in their place. Raises DocumentError at a line that holds something else."""
        first = self.line
        block = self._take(-(-count // layout.columns))
        if self.line - first < -(-count // layout.columns):
            raise self.fault(f"the file ends after {self.line - first} lines of {count} values")
        for i, line in enumerate(block.split(b"\n"), first):
            if line.translate(None, OF_NUMBERS):
                raise self.fault(f"found {quoted(line.strip())}; expected {count} numbers from line {first} on", i)
        self._demand_full(self._fields(block, layout, count), layout, count, count, first)

    def table(self, separators: bytes = b"") -> tuple[Array, int]:
        """All numbers of the lines to come, and how many stand on each. Raises DocumentError if the lines differ."""
        columns, done = 0, 0
        values = np.empty(0)
        while self.at < len(self.raw):
            line = self.line
            block = self._take(_LINES_AT_ONCE).rstrip().translate(bytes.maketrans(separators, b" " * len(separators)))
            if not done:
                columns = len(block.split(b"\n", 1)[0].split())
                values = np.empty(columns * (2 + self.raw.count(b"\n", self.at) + self.line - line))  # untouched pages take no memory
            found = parsed(block)
            if found is None or found.size != columns * (block.count(b"\n") + 1):
                rows = [row.split() for row in block.split(b"\n")]
                found, _ = self._one_by_one(rows, line)
                for i, row in enumerate(rows, line):
                    if row and len(row) != columns:
                        raise self.fault(f"found {len(row)} numbers, {columns} on the lines before", i)
            values[done : done + found.size] = found
            done += found.size
        values.resize(done, refcheck=False)
        return values, columns

    @staticmethod
    def _fields(block: bytes, layout: Layout, left: int) -> list[list[bytes]]:
        """The fields of each line of a block, of which `left` numbers are wanted."""
        lines = block.removesuffix(b"\n").split(b"\n") if block else []
        return [layout.fields(line, min(layout.columns, left - i * layout.columns)) for i, line in enumerate(lines)]

    def _demand_full(self, rows: list[list[bytes]], layout: Layout, left: int, count: int, first: int) -> None:
        """Raise DocumentError at a line of a fixed-width block that does not hold as many of the `left` numbers as its columns."""
        for i, row in enumerate(rows):
            wanted = min(layout.columns, left - i * layout.columns)
            if len(row) != wanted:
                expected = f"expected {wanted} (the header announces {count} values)"
                raise self.fault(f"found {len(row)} numbers on a line; {expected}", first + i)

    def _one_by_one(self, rows: list[list[bytes]], first: int, done: int = 0, count: int | None = None) -> tuple[Array, int]:
        """(the numbers of lines up to `count` in all, how many lines hold them). Raises DocumentError at the first token that is none."""
        found: list[float] = []
        lines = 0
        for row in rows:
            for token in row if count is None else row[: max(0, count - done - len(found))]:
                value = value_of(token)
                if value is None:
                    where = "" if count is None else f", after {done + len(found)} of {count} values"
                    raise self.fault(f"found {shown(token)}{where}", first + lines)
                found.append(value)
            lines += 1
            if count is not None and done + len(found) == count:
                break
        return np.array(found), lines
