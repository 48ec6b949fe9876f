"""Numbers as a record file prints them, to double precision, and the fault of a word that is not a number."""

from __future__ import annotations

import re

import numpy as np

Array = np.ndarray

NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
OF_NUMBERS = b" \t\n0123456789+-.eEdD*"


def value_of(token: bytes) -> float | None:
    """The finite number that a token states, which may have the exponent letter D; None if it states none."""
    token = _with_e(token)
    value = float(token) if NUMBER.fullmatch(token) else np.nan
    return value if np.isfinite(value) else None


def _with_e(text: bytes) -> bytes:
    """Fortran's exponent letter D as E."""
    return text.replace(b"D", b"E").replace(b"d", b"e")


def parsed(block: bytes) -> Array | None:
    """The numbers between the blanks of a block; None if one of its words is not a finite number."""
    try:
        values = np.array(_with_e(block).split(), dtype=bytes).astype(float)
    except ValueError:
        return None
    return values if np.all(np.isfinite(values)) and b"_" not in block else None  # Python takes 1_000 for a number


def shown(token: bytes) -> str:
    """A token that is not a number, in quotes and with the reason."""
    if not token:
        return "blanks in place of a number"
    words = token.decode("latin-1")
    if set(token) == {42}:
        reason = "stars in place of a number"
    elif len(NUMBER.findall(token)) > 1 and not NUMBER.sub(b"", token).strip(b"."):
        reason = "two numbers run together"
    else:
        reason = "which is no finite number"
    return f"{(words if len(words) <= 40 else words[:37] + '...')!r}, {reason}"
