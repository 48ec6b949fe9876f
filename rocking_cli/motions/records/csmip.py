"""CSMIP and CESMD volume 2: corrected accelerograms in fixed columns, several channels
a file. Each is a header of text and numbers, then blocks that announce themselves, as
`2980 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.6)`. Numbers
touch.
"""

import re
from typing import NamedTuple

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
BLOCK = re.compile(
    r"^\s*(?P<count>\d+)\s*(?:points of )?(?P<of>acc|vel|dis)\w* (?:data|points)"
    r"(?:.*?\bat\s*(?P<step>[-+.\d]+)\s*(?P<rate>pts/)?sec)?(?P<behind>.*)",
    re.IGNORECASE,
)
_PGA = re.compile(r"Peak\s+acc\w*\s*=\s*([-+.\dEe]+)\s*([a-z/0-9^]+)", re.IGNORECASE)
_POINTS = re.compile(r"^\s*(\d+)\s+points of instrument", re.IGNORECASE)
_LENGTH = re.compile(r"Record length\s*=\s*([.\d]+)\s*sec", re.IGNORECASE)
_UNIT = re.compile(
    r"(?:\bin\b|units?:?)\s*(?:units of\s*)?([a-z]+(?:/[a-z0-9/^]+)?)", re.IGNORECASE
)
_IN_A_LINE = 8  # values, without a Fortran format in the line above
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
        said = BLOCK.match(line)
        if said is None:
            above.append(line)
            continue
        block = announced(text, said)
        if block.quantity != "acc":
            others = block.quantity
            text.skip(block.npts, block.layout)
        else:
            latest = above[::-1]
            text.count(stated(_POINTS, latest) or str(block.npts), same=block.npts)
            dt = _precise(block.step, above)
            if length := stated(_LENGTH, latest):
                text.agree(block.npts, dt, length, slack=0.5 * float(length))
            unit = block.unit or "cm/s2"
            pga = (
                stated(_PGA, latest)
                if unit_of(stated(_PGA, latest, 2) or "") == unit
                else None
            )
            samples = text.numbers(block.npts, block.layout)
            found.append(Series(stated(_FIRST, latest), dt, samples, unit, pga))
            above = []
    if not found:
        only = f"no points of accel data, only of {others}"
        raise (
            text.no_acceleration(only)
            if others
            else text.fault("no line `n points of accel data`")
        )
    return found


class Announced(NamedTuple):
    """What a line states of the block of numbers below it."""

    npts: int  # number of values
    quantity: str  # acc, vel or dis
    step: float  # [s], 0 of another quantity than an acceleration
    unit: str  # of accelerations, "" if the line states none
    layout: Layout  # by default eight on a line, as wide as the first line has them


def announced(text: RecordText, said: re.Match[str]) -> Announced:
    """Return what a line, a match of BLOCK, states of the block below it. Raises
    DocumentError.
    """
    count, quantity, step, unit = text.count(said["count"]), said["of"].lower(), 0.0, ""
    if quantity == "acc":
        step_of = text.step_of_rate if said["rate"] else text.step
        step = step_of(said["step"] or "")
        if word := stated(_UNIT, [said["behind"]]):
            unit = text.unit(word)
    first = text.raw[text.at : text.at + 200].split(b"\n", 1)[0].rstrip()
    width = max(1, len(first) // max(1, min(_IN_A_LINE, count)))
    layout = fortran_layout(said.string) or Layout(_IN_A_LINE, width)
    return Announced(count, quantity, step, unit, layout)


def _precise(dt: float, above: list[str]) -> float:
    """The step of the real header if it agrees with that of the text and has more
    digits, such as 1/128 s.
    """
    try:
        precise = float(above[-_ROW][_COLUMNS])
    except (IndexError, ValueError):
        return dt
    return precise if precise > 0.0 and abs(precise - dt) < 6e-4 else dt
