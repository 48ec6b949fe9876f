"""The text of a record file: lines one after the other, and blocks of numbers read at the speed of NumPy.

Numbers in blocks are parted by blanks or, in files that Fortran wrote, stand in columns of a fixed width where neighbours may touch.
A block is parsed whole; only where that does not come out even is it gone through line by line, to name the place of the fault.
"""

from __future__ import annotations

import re
import warnings
from typing import NamedTuple

import numpy as np

from ...errors import DocumentError, NoAcceleration

Array = np.ndarray
Keys = dict[str, tuple[str, int]]

HEAD = 1 << 16  # bytes in which a format shows itself
_LINES_AT_ONCE = 1 << 16
_DOS_BLOCK = 128  # bytes
_NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_OF_NUMBERS = b" \t0123456789+-.eEdD*"
_FORTRAN = re.compile(r"\(\s*(?:\d+P\s*,?\s*)?(\d*)\s*[FEGDI]\s*(\d+)", re.IGNORECASE)


class Layout(NamedTuple):
    """How numbers stand in lines: how many on a full line, and their width in characters (None: parted by blanks)."""

    columns: int
    width: int | None = None


def fortran_layout(text: str) -> Layout | None:
    """The layout of the first Fortran format in a text, such as (8F10.5) or (1E15.6); None where there is none."""
    found = _FORTRAN.search(text)
    if found is None or not 0 < int(found[2]) <= 80:
        return None
    return Layout(max(1, int(found[1] or 1)), int(found[2]))


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
        """The error for a file that holds something else, in good order."""
        return NoAcceleration(str(self.fault(what, line)))

    def next_line(self) -> str | None:
        """The next line without its end, None after the last."""
        if self.at >= len(self.raw):
            return None
        end = self.raw.find(b"\n", self.at)
        end = len(self.raw) if end < 0 else end
        found = self.raw[self.at : end].decode("latin-1")
        self.at, self.line = end + 1, self.line + 1
        return found.rstrip()

    def lines(self, count: int) -> list[str]:
        """The next `count` lines. Raises DocumentError where the file ends before."""
        found: list[str] = []
        while len(found) < count:
            line = self.next_line()
            if line is None:
                raise self.fault("the file ends within its header")
            found.append(line)
        return found

    def find(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """The first match among the lines to come, and the place after its line; None (and the end of the file) without one."""
        while (line := self.next_line()) is not None:
            found = pattern.search(line)
            if found is not None:
                return found
        return None

    def keys(self, pattern: re.Pattern[str]) -> Keys:
        """Every key (the pattern's first group) with its value (the second) and its line, above the first line that begins with a number.
        Raises DocumentError where there is none."""
        found: Keys = {}
        while not self.more_numbers():
            line = self.next_line()
            if line is None:
                raise self.fault("the file ends within its header")
            stated = pattern.match(line)
            if stated is not None:
                found[stated[1]] = stated[2].strip(), self.line - 1
        return found

    def value(self, keys: Keys, key: str, wanted: str = "") -> tuple[str, int]:
        """The value of a key, and its line. Raises DocumentError where it has none; wanted: what it should be."""
        text, line = keys.get(key, ("", 1))
        if not text:
            raise self.fault(f"no value of {key}" + (f"; accepted is {wanted}" if wanted else ""), line)
        return text, line

    def number(self, text: str, line: int | None = None) -> float:
        """A number of the header. Raises DocumentError."""
        token = _exponent(text.strip().encode("latin-1", "replace"))
        value = float(token) if _NUMBER.fullmatch(token) else np.nan
        if not np.isfinite(value):
            raise self.fault(f"found {text.strip()!r} in the header; accepted is a number", line)
        return value

    def count(self, text: str, line: int | None = None) -> int:
        """A number of values, as the header states it. Raises DocumentError."""
        value = self.number(text, line)
        if value != int(value) or value < 0.0:
            raise self.fault(f"a number of values of {text.strip()}; accepted is a whole number", line)
        return int(value)

    def step(self, text: str, line: int | None = None) -> float:
        """A step of time, as the header states it. Raises DocumentError."""
        value = self.number(text, line)
        if not value > 0.0:
            raise self.fault(f"a time step of {text.strip()}; accepted is a positive one", line)
        return value

    def rate(self, text: str, line: int | None = None) -> float:
        """A sampling frequency [Hz], as the header states it. Raises DocumentError."""
        value = self.number(text, line)
        if not value > 0.0:
            raise self.fault(f"a sampling frequency of {text.strip()} Hz; accepted is a positive one", line)
        return value

    def agree(self, count: int, dt: float, duration: str, line: int | None = None, slack: float = 0.0) -> None:
        """Raise DocumentError where points and step contradict the declared duration [s], which may count the last step or not."""
        stated = self.number(duration, line)
        if abs(count * dt - stated) > max(1.6 * dt, 0.005 * stated, slack):
            raise self.fault(f"{count} values every {dt:g} s make {count * dt:g} s, where the header states {duration.strip()} s", line)

    def surplus(self, count: int) -> str:
        """A remark where more numbers follow than the header declares."""
        return f"more values than the {count} declared, which are left out" if self.more_numbers() else ""

    def more_numbers(self) -> bool:
        """True if the next line that is not blank begins with a number."""
        rest = self.raw[self.at : self.at + 4096].split(None, 1)
        return bool(rest) and _NUMBER.fullmatch(rest[0]) is not None

    def numbers(self, count: int, layout: Layout) -> Array:
        """The next `count` numbers, from as many lines as hold them. Raises DocumentError at the line that holds another thing, and in
        columns of a fixed width at a line that is not full."""
        if count > len(self.raw) - self.at + 1:
            raise self.fault(f"{count} values are declared, more than a file of {len(self.raw)} bytes holds")
        values, done = np.empty(count), 0
        while done < count:
            lines = min(-(-(count - done) // layout.columns), _LINES_AT_ONCE)
            end = self._after(lines)
            if end == self.at:
                raise self.fault(f"the file ends after {done} of {count} values")
            block, first = self.raw[self.at : end], self.line
            found = _parse(block, layout.width, min(count - done, lines * layout.columns))
            if found is None or found.size > count - done:
                found = self._one_by_one(block, count, done, layout.width)
            else:
                self.at, self.line = end, self.line + block.count(b"\n") + (not block.endswith(b"\n"))
            self._demand_full_lines(block, layout, count, count - done, first)
            values[done : done + found.size] = found
            done += found.size
        return values

    def skip(self, count: int, layout: Layout) -> None:
        """Pass over `count` numbers, of which stars may stand in place. Raises DocumentError at a line that holds another thing."""
        end, first = self._after(-(-count // layout.columns)), self.line
        block = self.raw[self.at : end]
        lines = block.splitlines()
        self.at, self.line = end, first + len(lines)
        if len(lines) * layout.columns < count:
            raise self.fault(f"the file ends after {len(lines)} lines of {count} values")
        for i, line in enumerate(lines, first):
            if line.translate(None, _OF_NUMBERS):
                raise self.fault(f"found {_short(line.strip())}; accepted are {count} numbers from line {first} on", i)
        self._demand_full_lines(block, layout, count, count, first)

    def demand_end(self, count: int) -> None:
        """Raise DocumentError where another line of numbers follows the `count` values that are declared."""
        line = self.raw[self.at : self.at + 4096].lstrip().split(b"\n", 1)[0]
        if line and not line.translate(None, _OF_NUMBERS):
            blank = self.raw[self.at : self.at + 4096].partition(line)[0].count(b"\n")
            raise self.fault(f"found a line of numbers after the {count} values declared", self.line + blank)

    def _demand_full_lines(self, block: bytes, layout: Layout, count: int, left: int, first: int) -> None:
        """Raise DocumentError at a line that does not hold as many numbers as the columns and the `left` of `count` values ask for;
        first: the number of the block's first line."""
        if layout.width is None:
            return
        for i, line in enumerate(block.splitlines()):
            wanted, line = min(layout.columns, left - i * layout.columns), line.rstrip()
            if wanted not in (-(-len(line) // layout.width), held := len(line.split())):
                raise self.fault(f"found {held} numbers on a line; accepted are {wanted} (the header announces {count} values)", first + i)

    def table(self, separators: bytes = b"") -> tuple[Array, int]:
        """All numbers of the lines to come, and how many stand on each. Raises DocumentError where the lines differ."""
        first, columns, done = self.line, 0, 0
        values = np.empty(0)
        while self.at < len(self.raw):
            end, line = self._after(_LINES_AT_ONCE), self.line
            block = self.raw[self.at : end]
            lines, block = block.count(b"\n") + (not block.endswith(b"\n")), block.rstrip()
            for separator in separators:
                block = block.replace(bytes([separator]), b" ")
            if not done:
                columns = len(block[: max(0, block.find(b"\n")) or None].split())
                values = np.empty(columns * (self.raw.count(b"\n", self.at) + 1))  # at the most: of what is not filled no page is taken
            found = self._rows(block, columns, line, first) if block else values[:0]
            values[done : done + found.size] = found
            self.at, self.line, done = end, line + lines, done + found.size
        values.resize(done, refcheck=False)
        return values, columns

    def _rows(self, block: bytes, columns: int, line: int, first: int) -> Array:
        """The numbers of a block that begins on a line, so many on each of its lines; first: the first line of all blocks."""
        values = _parse(block, None, 0)
        if values is None or values.size != columns * (block.count(b"\n") + 1):
            for i, row in enumerate(block.split(b"\n"), line):
                tokens = row.split()
                for token in tokens:
                    self._number(token, i, "")
                if tokens and len(tokens) != columns:
                    raise self.fault(f"found {len(tokens)} numbers, {columns} on the lines before", i)
        if values is None:
            raise self.fault("numbers that cannot be read", first)
        return values

    def _after(self, lines: int) -> int:
        """The place after so many lines."""
        end = self.at
        while lines and end < len(self.raw):
            piece = np.frombuffer(self.raw, dtype=np.uint8, count=min(1 << 22, len(self.raw) - end), offset=end)
            ends = np.flatnonzero(piece == 10)
            if ends.size >= lines:
                return end + int(ends[lines - 1]) + 1
            lines, end = lines - ends.size, end + piece.size
        return end

    def _one_by_one(self, block: bytes, count: int, done: int, width: int | None) -> Array:
        """The numbers of a block line by line, up to `count`; raises at the first thing that is none."""
        found: list[float] = []
        for raw in block.split(b"\n"):
            if self.at >= len(self.raw):
                break
            line = raw.rstrip()
            tokens = line.split()
            if width is not None and not all(_NUMBER.fullmatch(_exponent(t)) for t in tokens):
                tokens = [line[i : i + width].strip() for i in range(0, len(line), width)]
            for token in tokens:
                if done + len(found) < count:
                    found.append(self._number(token, self.line, f", after {done + len(found)} of {count} values"))
            self.at, self.line = self.at + len(raw) + 1, self.line + 1
            if done + len(found) == count:
                break
        return np.array(found)

    def _number(self, token: bytes, line: int, where: str) -> float:
        if _NUMBER.fullmatch(_exponent(token)):
            value = float(_exponent(token))
            if np.isfinite(value):
                return value
        shown = _short(token)
        if not token:
            shown = "blanks in place of a number"
        elif set(token) == {42}:
            shown += ", stars in place of a number"
        elif len(_NUMBER.findall(token)) > 1 and not _NUMBER.sub(b"", token).strip(b"."):
            shown += ", two numbers run together"
        else:
            shown += ", which is no finite number"
        raise self.fault(f"found {shown}{where}", line)


def _short(text: bytes) -> str:
    """The beginning of a text in quotes."""
    shown = text.decode("latin-1")
    return repr(shown if len(shown) <= 40 else shown[:37] + "...")


def _exponent(text: bytes) -> bytes:
    """Fortran's exponent letter D as E."""
    return text.replace(b"D", b"E").replace(b"d", b"e")


def _parse(block: bytes, width: int | None, expected: int) -> Array | None:
    """The numbers of a block; None where something in it is no number, numbers touch without a width, or one is not finite."""
    block = _exponent(block)
    values = _parted_by_blanks(block)
    if width is None or (values is not None and values.size == expected):
        return values
    fields = [line[i : i + width] for line in block.split(b"\n") for i in range(0, len(line.rstrip()), width)]
    values = _parted_by_blanks(b" ".join(fields))
    return values if values is not None and values.size == len(fields) else None


def _parted_by_blanks(text: bytes) -> Array | None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            values = np.fromstring(text, sep=" ")  # takes -1-2 for two numbers, hence the count of words below
        except (DeprecationWarning, ValueError):
            return None
    blank = np.frombuffer(text, dtype=np.uint8) <= 32
    words = int(np.count_nonzero(blank[:-1] & ~blank[1:])) + int(blank.size > 0 and not blank[0])
    return values if values.size == words and bool(np.all(np.isfinite(values))) else None
