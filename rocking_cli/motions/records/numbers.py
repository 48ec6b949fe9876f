"""Numbers in the text of a record file: separated by blanks, or in columns of a fixed width (Fortran), where neighbours may touch."""

from __future__ import annotations

import re
import warnings
from typing import NamedTuple

import numpy as np

Array = np.ndarray

NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
OF_NUMBERS = b" \t0123456789+-.eEdD*"
_FORTRAN = re.compile(r"\(\s*(?:\d+P\s*,?\s*)?(\d*)\s*[FEGDI]\s*(\d+)", re.IGNORECASE)


class Layout(NamedTuple):
    """How many numbers stand on a full line, and their width in characters (None: separated by blanks)."""

    columns: int
    width: int | None = None

    def fields(self, line: bytes, wanted: int) -> list[bytes]:
        """The numbers of a line: those between blanks if they are as many as wanted, else those of the columns."""
        tokens, line = line.split(), line.rstrip()
        if len(tokens) == wanted or self.width is None:
            return tokens
        return [line[i : i + self.width].strip() for i in range(0, len(line), self.width)]


def fortran_layout(text: str) -> Layout | None:
    """The layout of the first Fortran format in a text, such as (8F10.5) or (1E15.6); None if there is none."""
    found = _FORTRAN.search(text)
    if found is None or not 0 < int(found[2]) <= 80:
        return None
    return Layout(max(1, int(found[1] or 1)), int(found[2]))


def value_of(token: bytes) -> float | None:
    """The finite number that a token states, which may have the exponent letter D; None if it states none."""
    token = _with_e(token)
    value = float(token) if NUMBER.fullmatch(token) else np.nan
    return value if np.isfinite(value) else None


def parsed(block: bytes) -> Array | None:
    """The numbers between the blanks of a block; None if one of its words is not a finite number."""
    block = _with_e(block)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            values = np.fromstring(block, sep=" ")  # takes -1-2 for two numbers, hence the count of words below
        except (DeprecationWarning, ValueError):
            return None
    blank = np.frombuffer(block, dtype=np.uint8) <= 32
    words = int(np.count_nonzero(blank[:-1] & ~blank[1:])) + int(blank.size > 0 and not blank[0])
    return values if values.size == words and bool(np.all(np.isfinite(values))) else None


def shown(token: bytes) -> str:
    """A token that is not a number, in quotes and with the reason."""
    if not token:
        return "blanks in place of a number"
    if set(token) == {42}:
        reason = "stars in place of a number"
    elif len(NUMBER.findall(token)) > 1 and not NUMBER.sub(b"", token).strip(b"."):
        reason = "two numbers run together"
    else:
        reason = "which is no finite number"
    return f"{quoted(token)}, {reason}"


def quoted(text: bytes) -> str:
    """The beginning of a text in quotes."""
    words = text.decode("latin-1")
    return repr(words if len(words) <= 40 else words[:37] + "...")


def _with_e(text: bytes) -> bytes:
    """Fortran's exponent letter D as E."""
    return text.replace(b"D", b"E").replace(b"d", b"e")
