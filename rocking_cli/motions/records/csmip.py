"""CSMIP and CESMD volume 2: corrected accelerograms in fixed columns, several channels
a file. Each is a header of text and numbers, then blocks that announce themselves, as
`2980 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.6)`. Numbers
touch.
"""

import re

from .record import Series
from .text import Layout, RecordText, begins, fortran_layout, stated
from .units import unit_of

NAME = "CSMIP V2"
_FIRST = re.compile(
    r"(?<!UN)CORRECTED"
    r" ACCELEROGRAM(?:.*?\b(?:Chan(?:nel)?\s*\d*\s*:|COMP\b)\s*(.+?)\s*(?:from|\(|$))?",
    re.IGNORECASE,
)
# a file of volume 3, which has spectra and no motion
_SPECTRA = re.compile(r"\s*RESPONSE AND FOURIER AMPLITUDE SPECTRA", re.IGNORECASE)
_BLOCK = re.compile(
    r"^\s*(\d+)\s*points of (acc|vel|dis)\w* data(?:.*?\bat\s*([-+.\d]+)\s*sec)?",
    re.IGNORECASE,
)
_PGA = re.compile(r"Peak\s+acc\w*\s*=\s*([-+.\dEe]+)\s*([a-z/0-9^]+)", re.IGNORECASE)
_POINTS = re.compile(r"^\s*(\d+)\s+points of instrument", re.IGNORECASE)
_LENGTH = re.compile(r"Record length\s*=\s*([.\d]+)\s*sec", re.IGNORECASE)
_UNIT = re.compile(
    r"(?:\bin\b|units?:?)\s*(?:units of\s*)?([a-z]+(?:/[a-z0-9/^]+)?)", re.IGNORECASE
)
# Place of the step in the real header, which has it with more digits.
_ROW = 6  # lines above the block
_COLUMNS = slice(40, 50)

recognise = begins(
    rf"(?!.*(?:GNS Science|\(format v))(?:{_SPECTRA.pattern}|.*{_FIRST.pattern})"
)


def read(text: RecordText) -> list[Series]:
    """Return the acceleration of every channel of the file. Raises DocumentError."""
    if _SPECTRA.match(text.head):
        raise text.no_acceleration(
            "spectra (volume 3); expected an accelerogram (volume 1 or 2)", 1
        )
    found: list[Series] = []
    others = ""
    above: list[str] = []  # lines of the channel's header
    while (line := text.next_line()) is not None:
        block = _BLOCK.match(line)
        if block is None:
            above.append(line)
            continue
        layout = fortran_layout(line) or Layout(8, 10)
        count = text.count(block[1])
        kind = block[2].lower()
        if kind != "acc":
            others = block[2]
            text.skip(count, layout)
        else:
            latest = above[::-1]
            text.count(stated(_POINTS, latest) or block[1], same=count)
            dt = _precise(text.step(block[3] or ""), above)
            if length := stated(_LENGTH, latest):
                text.agree(count, dt, length, slack=0.5 * float(length))
            word = stated(_UNIT, [line[block.end() :]])
            unit = text.unit(word) if word else "cm/s2"
            pga = (
                stated(_PGA, latest)
                if unit_of(stated(_PGA, latest, 2) or "") == unit
                else None
            )
            found.append(
                Series(
                    stated(_FIRST, latest), dt, text.numbers(count, layout), unit, pga
                )
            )
            above = []
        text.require_end(count)
    if not found:
        only = f"no points of accel data, only of {others}"
        raise (
            text.no_acceleration(only)
            if others
            else text.fault("no line `n points of accel data`")
        )
    return found


def _precise(dt: float, above: list[str]) -> float:
    """The step of the real header if it agrees with that of the text and has more
    digits, such as 1/128 s.
    """
    try:
        precise = float(above[-_ROW][_COLUMNS])
    except (IndexError, ValueError):
        return dt
    return precise if precise > 0.0 and abs(precise - dt) < 6e-4 else dt
