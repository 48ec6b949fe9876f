"""Numbers as a record file prints them: single words and whole blocks."""

import re

import numpy as np

from ...arrays import Array

NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
# a last line such as *** End Data ***
TRAILER = re.compile(rb"\n[^\w\n]*(?:end|eof)\b[^\n]*\s*\Z", re.IGNORECASE)
OF_NUMBERS = b" \t\n0123456789+-.eEdD*"  # the characters of a block, with stars
_LONGEST = 400  # characters of a number
_D_AS_E = bytes.maketrans(b"Dd", b"Ee")  # the letter of an exponent in Fortran
# an exponent beyond 99 in Fortran, which has no letter
_NO_LETTER = re.compile(rb"([+-]?\d*\.\d+)([+-]\d{3})")


def finite_number(token: bytes) -> float | None:
    """Return the finite number that a token states, which may have the exponent letter
    D; None if it states none.
    """
    token = (
        _NO_LETTER.sub(rb"\1E\2", token.translate(_D_AS_E))
        if len(token) < 40
        else token
    )
    written = len(token) <= _LONGEST and NUMBER.fullmatch(token)
    value = float(token) if written else np.nan
    return value if np.isfinite(value) else None


def words_on_lines(block: bytes) -> Array:
    """How many words stand on each line of a block."""
    codes = np.frombuffer(block, dtype=np.uint8)
    blank = codes <= 32
    begins = ~blank & np.concatenate([[True], blank[:-1]])
    line = np.cumsum(codes == 10)
    return np.bincount(line[begins], minlength=int(line[-1]) + 1 if codes.size else 0)


def parsed(block: bytes) -> Array | None:
    """Return the numbers between the blanks of a block; None if one of its words is not
    a finite number.
    """
    try:
        values = np.array(list(map(float, block.translate(_D_AS_E).split())))
    except ValueError:
        return None
    # Python takes 1_000 for a number.
    return values if np.all(np.isfinite(values)) and b"_" not in block else None


def shown(token: bytes) -> str:
    """Return a token that is not a number, in quotes and with the reason."""
    if not token:
        return "blanks in place of a number"
    words = token.decode("utf-8", "replace")
    if set(token) == {42}:
        reason = "stars in place of a number"
    elif len(NUMBER.findall(token)) > 1 and not NUMBER.sub(b"", token).strip(b"."):
        reason = "two numbers run together"
    else:
        reason = "which is no finite number"
    return f"{(words if len(words) <= 40 else words[:37] + '...')!r}, {reason}"


def parted(block: bytes) -> bytes | None:
    """Return a block whose numbers touch with blanks between its fields; None for
    another block. The fields are as wide as the points of the first line are apart, and
    the points of all other lines stand below these.
    """
    lines = block.split(b"\n")
    first = next((x.rstrip() for x in lines if x.strip()), b"")
    points = [x.start() for x in re.finditer(rb"\.", first)]
    if len(points) < 2:
        return None
    width, behind = points[1] - points[0], len(first) - points[-1]
    if width < behind + 1 or any(np.diff(points) != width):
        return None
    found = []
    for line in lines:
        ends = [x.start() + behind for x in re.finditer(rb"\.", line)]
        whole = [x + behind for x in points[: len(ends)]]
        if ends != whole or len(line.rstrip()) != (ends or [0])[-1]:
            return None
        found.append(b" ".join(line[max(0, x - width) : x].strip() for x in ends))
    return b"\n".join(found)
