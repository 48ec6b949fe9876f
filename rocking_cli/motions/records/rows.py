"""The rows of numbers of a plain file: separators, decimal commas, quotes, and fields
that touch.
"""

import re
from typing import NamedTuple, Self

import numpy as np

from ...arrays import Array
from .printed_numbers import finite_number
from .text import RecordText

_ODD_COMMA = re.compile(rb",(?![0-9])|,[0-9]*,")
# separators beside each other, as far as they go; two equal ones have nothing between
_BESIDE = re.compile(rb"[,;][ \t]*+[,;][,; \t]*+")
_EMPTY = re.compile(rb"([,;])[ \t]*\1")
_MARK = re.compile(rb"[0-9]([.,])[0-9]")  # of the decimals
_SHOWN = 60  # numbers whose printed form is looked at
_MOST_FIRST = 2  # numbers above a column that may be no samples
_STAR = re.compile(r"\*+|nan|inf|[-+]inf", re.IGNORECASE)
_TOUCHING = re.compile(r"[-+.\d]+")
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

    def in_pairs(self, text: RecordText) -> Self:
        """Return the rows of two numbers of lines that hold several. Raises
        DocumentError at a line of an odd number.
        """
        if (odd := np.flatnonzero(self.counts % 2)).size:
            found = f"found {self.counts[odd[0]]} numbers; expected pairs of two"
            raise text.fault(found, int(self.lines[odd[0]]))
        pairs = self.counts // 2
        lines = np.repeat(self.lines, pairs)
        return self._replace(counts=np.full(lines.size, 2), lines=lines)


def is_row(line: str) -> bool:
    """True if a line holds numbers alone, of which the first is one."""
    words = [x for x in _BETWEEN.split(line.strip()) if x]
    numbers = [
        finite_number(x.encode("utf-8", "replace")) is not None
        or (x.count(".") > 1 and _TOUCHING.fullmatch(x) is not None)
        for x in words
    ]
    known = all(n or _STAR.fullmatch(x) for n, x in zip(numbers, words, strict=True))
    return bool(words) and known and numbers[0]


def counts_up(values: Array) -> bool:
    """True for whole numbers that rise by one, which count lines."""
    return values.size > 2 and bool(
        (np.diff(values) == 1.0).all() and values[0] == int(values[0])
    )


def rows_of(text: RecordText, heading: str) -> NumberRows:
    """Return the rows of numbers to come, below the line `heading`, "" without one.

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
    separator, decimal = _separator(block, heading)
    if decimal:
        _require_one_mark(text, block)
        block = block.replace(b",", b".")
    if separator != " ":
        block = block.replace(separator.encode(), b" ")
    values, counts, lines = text.numbers_of(block)
    text.at = len(text.raw)
    words = block.split(None, _SHOWN)[:_SHOWN]
    return NumberRows(values, counts, lines, words, separator)


def _separator(block: bytes, heading: str) -> tuple[str, bool]:
    """(what separates the numbers, True if a comma stands for the decimal point)."""
    comma, point = b"," in block, b"." in block
    if b";" in block:
        return ";", comma
    if not comma:
        return ("\t" if b"\t" in block else " "), False
    if point or _ODD_COMMA.search(block) is not None:
        return ",", False
    if b"\t" in block:
        return "\t", True
    first = block.split(b"\n", 1)[0]
    if len(first.split()) > 1 or ";" in heading:
        return " ", True
    if heading:
        return (",", False) if "," in heading else (" ", True)
    # lines of `12,5` without a heading: lines that are counted, or decimals
    lines = [x.split(b",", 1)[0].strip() for x in block.split(b"\n") if b"," in x]
    whole = all(x.lstrip(b"+-").isdigit() for x in lines)
    return (",", False) if whole and counts_up(np.array(lines, float)) else (" ", True)


def _require_one_mark(text: RecordText, block: bytes) -> None:
    """Raise DocumentError at the first number with both marks of decimals, or with
    another than the numbers before it.
    """
    if b"." not in block:
        return
    first = _MARK.search(block)
    for word in re.finditer(rb"[^\s;]+", block):
        marks = {x[1] for x in _MARK.finditer(word[0])}
        if marks and first is not None and marks != {first[1]}:
            line = text.line + block[: word.start()].count(b"\n")
            said = "comma" if first[1] == b"," else "point"
            raise text.fault(
                f"found {word[0].decode('utf-8', 'replace')!r}; expected a decimal"
                f" {said}, as of the numbers before it",
                line,
            )


def unlike_samples(rows: NumberRows, dt: float) -> int:
    """Return how many first numbers seem to be no samples of a file without a heading:
    a number of values, a time step [s], a rate.

    They are printed otherwise than the others, count them, are the step or the rate, or
    lie far beyond all others.
    """
    values, words = rows.values, rows.words
    largest = float(np.abs(values[_MOST_FIRST:]).max(initial=0.0))
    forms = {_decimals(x) for x in words[_MOST_FIRST:]}
    stated = (dt, round(1.0 / dt, 6)) if dt > 0.0 else ()
    found = 0
    while found < min(_MOST_FIRST, len(words) - 3):
        value, left = float(values[found]), values.size - found - 1
        known = value in (left, left - 1, *stated)
        printed = len(forms) == 1 and _decimals(words[found]) not in forms
        if not value > 0.0 or not (known or printed or value > 10.0 * largest):
            break
        found += 1
    return found


def _decimals(word: bytes) -> tuple[int, int]:
    """How many digits stand behind the point, and in the exponent."""
    mantissa, _, exponent = word.upper().partition(b"E")
    return len(mantissa.partition(b".")[2]), len(exponent.strip(b"+-"))
