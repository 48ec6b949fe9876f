"""The rows of numbers of a plain file: separators, decimal commas, quotes, first lines.

A number or two on the first lines may be no samples: their count, step or rate.
"""

import re
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from .claims import agree
from .printed_numbers import finite_number
from .text import RecordText

_ODD_COMMA = re.compile(rb",(?![0-9])|,[0-9]*,")
# separators beside each other, as far as they go; two equal ones have nothing between
_BESIDE = re.compile(rb"[,;][ \t]*+[,;][,; \t]*+")
_EMPTY = re.compile(rb"([,;])[ \t]*\1")
_MANY = 2000  # lines that show whether whole numbers before a comma are times
_SHOWN = 200  # numbers whose printed form is looked at
_MOST_FIRST = 3  # numbers above a column that may be no samples: count, step, rate
_USUAL_STEPS = (0.001, 0.002, 0.0025, 0.004, 0.005, 0.01, 0.02, 0.025, 0.04, 0.05, 0.1)
_STAR = re.compile(r"\*+|nan|inf|[-+]inf", re.IGNORECASE)
_BETWEEN = re.compile(r"[\s,;\"']+")


class NumberRows(NamedTuple):
    """The numbers of a file as they stand on its lines."""

    values: Array  # all numbers, in order
    counts: Array  # how many stand on each line that is not blank
    lines: Array  # the numbers of these lines in the file
    words: list[bytes]  # the first of these numbers as printed
    separator: str  # what stands between them: "," ";" tab or " "

    @property
    def columns(self) -> int:
        """How many numbers stand on most lines."""
        return int(np.bincount(self.counts).argmax())

    def below(self, rows: int) -> "NumberRows":
        """Return the rows below so many first ones."""
        numbers = int(self.counts[:rows].sum())
        return self._replace(
            values=self.values[numbers:],
            counts=self.counts[rows:],
            lines=self.lines[rows:],
            words=self.words[numbers:],
        )


def is_row(line: str) -> bool:
    """True if a line holds numbers alone, of which the first is one."""
    words = [x for x in _BETWEEN.split(line.strip()) if x]
    numbers = [finite_number(x.encode("utf-8", "replace")) is not None for x in words]
    known = all(n or _STAR.fullmatch(x) for n, x in zip(numbers, words, strict=True))
    return bool(words) and known and numbers[0]


def rows_of(text: RecordText, headings: int | None) -> NumberRows:
    """Return the rows of numbers to come; headings: how many cells the line above has.

    Raises DocumentError at a word that is no number, and at an empty cell.
    """
    block = text.raw[text.at :].rstrip()
    for quote in (b'"', b"'"):
        if quote in block:
            block = block.replace(quote + b"," + quote, b";")  # "0,01","0,02"
            block = block.replace(quote, b"")
    for beside in _BESIDE.finditer(block):
        ends = block[beside.end() : beside.end() + 1] in (b"", b"\n")  # its line
        if not ends and _EMPTY.search(beside[0]):
            line = text.line + block[: beside.start()].count(b"\n")
            raise text.fault("an empty cell between two numbers", line)
    separator, decimal = _separator(block, headings)
    if decimal:
        block = block.replace(b",", b".")
    if separator != " ":
        block = block.replace(separator.encode(), b" ")
    values, counts, lines = text.numbers_of(block)
    text.at = len(text.raw)
    return NumberRows(
        values, counts, lines, block.split(None, _SHOWN)[:_SHOWN], separator
    )


def _separator(block: bytes, headings: int | None) -> tuple[str, bool]:
    """(what separates the numbers, True if a comma stands for the decimal point)."""
    comma, point = b"," in block, b"." in block
    odd = comma and _ODD_COMMA.search(block) is not None
    if b";" in block:
        return ";", comma and not point
    if not comma:
        return ("\t" if b"\t" in block else " "), False
    if point or odd:
        return ",", False
    if b"\t" in block:
        return "\t", True
    if len(block.split(b"\n", 1)[0].split()) > 1:
        return " ", True
    if headings is not None and headings <= 2:
        return (",", False) if headings == 2 else (" ", True)
    before = [
        x.split(b",", 1)[0] for x in block.split(None, _MANY)[:_MANY] if b"," in x
    ]
    whole = np.array([int(x) if x.strip(b"+-").isdigit() else 0 for x in before])
    rising = np.diff(whole)
    times = whole.size > 1 and bool((rising > 0).all() and (rising == rising[0]).all())
    return (",", False) if times else (" ", True)


def rows_above_samples(rows: NumberRows) -> int:
    """Return how many first rows hold numbers that seem to be no samples.

    Of a single column these are numbers printed unlike the others, whole numbers far
    beyond the others, and usual time steps above values near zero; of several columns
    first rows of another length, or one that the first column does not go on from.
    """
    columns = rows.columns
    if columns > 1:
        short = int(np.argmax(rows.counts == columns))
        if short:
            return min(short, _MOST_FIRST)
        return _first_is_apart(rows)
    if rows.counts[0] > 1:
        above = int(np.argmax(rows.counts == columns))
        below = rows.counts.size > above + 1
        return above + rows_above_samples(rows.below(above)) if below else 0
    found = 0
    while (
        found < min(_MOST_FIRST, len(rows.words))
        and rows.values.size > found + 2
        and _is_no_sample(rows, found)
    ):
        found += 1
    return found


def _first_is_apart(rows: NumberRows) -> int:
    """1 if the times of several columns rise evenly from the second row on only."""
    if rows.counts.size < 4 or (rows.counts != rows.columns).any():
        return 0
    time = rows.values[:: rows.columns]
    steps = np.diff(time)
    usual = float(np.median(steps[1:]))
    even = usual > 0.0 and bool((np.abs(steps[1:] - usual) < 0.5 * usual).all())
    return int(even and abs(steps[0] - usual) > 0.5 * usual)


def _is_no_sample(rows: NumberRows, at: int) -> bool:
    """True if a number is probably not a sample: it is printed otherwise than the
    numbers after it, counts them, far exceeds them, or is a usual time step.
    """
    value, rest = float(rows.values[at]), rows.values[at + 1 :]
    if not value > 0.0:
        return False
    own = _digits(rows.words[at])
    others = {
        _digits(x)
        for x in rows.words[max(at + 1, _MOST_FIRST) : 60] or rows.words[at + 1 :]
    }
    if len(others) == 1 and own not in others:
        return True
    whole = value == int(value)
    if whole and own == 0 and 0 not in others:
        return True
    largest = float(np.abs(rest).max())
    if whole and value >= 10.0 and value > 10.0 * largest:
        return True
    if whole and value == rest.size:
        return True
    usual = any(agree(value, step) for step in _USUAL_STEPS)
    return usual and abs(float(rest[0])) < 0.2 * value


def _digits(word: bytes) -> int | str:
    """How many digits stand behind the point, with the width of an exponent."""
    mantissa, _, exponent = word.upper().partition(b"E")
    behind = len(mantissa.partition(b".")[2])
    return f"{behind}E{len(exponent.strip(b'+-'))}" if exponent else behind


def as_printed(word: bytes) -> str:
    """Return a number as the file prints it."""
    return word.decode("utf-8", "replace")
