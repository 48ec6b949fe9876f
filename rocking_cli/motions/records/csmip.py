"""CSMIP and CESMD volume 2: corrected accelerograms in fixed columns, several channels a file.

Each channel is a text header, numbers, and blocks of acceleration, velocity and displacement that announce themselves, as in
`2980 points of accel data equally spaced at  .020 sec, in cm/sec2. (8f10.6)`. Numbers touch, so the columns of the format part them.
"""

from __future__ import annotations

import re

from .numbers import Layout, fortran_layout
from .record import Series, unit_of
from .text import RecordText

NAME = "CSMIP V2"
_FIRST = re.compile(r"(?<!UN)CORRECTED ACCELEROGRAM", re.IGNORECASE)
_SPECTRA = re.compile(r"\s*RESPONSE AND FOURIER AMPLITUDE SPECTRA", re.IGNORECASE)  # volume 3
_CHANNEL = re.compile(r"\bChan(?:nel)?\s*\d*\s*:\s*(.+?)\s*(?:from|\(|$)", re.IGNORECASE)
_BLOCK = re.compile(r"^\s*(\d+)\s*points of (accel|veloc|displ)\w* data(?:.*?\bat\s*([-+.\d]+)\s*sec)?", re.IGNORECASE)
_PEAK = re.compile(r"Peak\s+accel\w*\s*=\s*([-+.\dEe]+)\s*([a-z/0-9^]+)", re.IGNORECASE)
_POINTS = re.compile(r"^\s*(\d+)\s+points of instrument", re.IGNORECASE)
_LENGTH = re.compile(r"Record length\s*=\s*([.\d]+)\s*sec", re.IGNORECASE)
_UNIT = re.compile(r"(?:\bin\b|units?:?)\s*(?:units of\s*)?([a-z]+(?:/[a-z0-9/^]+)?)", re.IGNORECASE)
_REAL_HEADER = 13  # lines of the numbers before a block; the 61st of them is the step with more digits than the text has


def recognise(head: str) -> bool:
    """True if the first line announces a corrected accelerogram that is not of GNS Science, or spectra."""
    first = head.lstrip().split("\n", 1)[0]
    return bool(_FIRST.search(first) or _SPECTRA.match(first)) and "GNS Science" not in first and "(format v" not in first.lower()


def read(text: RecordText) -> list[Series]:
    """The acceleration of every channel of the file. Raises DocumentError."""
    found: list[Series] = []
    others = ""
    channel: str | None = None
    peak: re.Match[str] | None = None
    points = length = None
    recent: list[str] = []
    if _SPECTRA.match(text.head):
        raise text.no_acceleration("spectra (volume 3); expected an accelerogram (volume 1 or 2)", 1)
    while (line := text.next_line()) is not None:
        recent = [*recent[-_REAL_HEADER:], line]
        if _FIRST.search(line):
            named = _CHANNEL.search(line)
            channel = named[1] if named else None
        peak = _PEAK.search(line) or peak
        points = _POINTS.search(line) or points
        length = _LENGTH.search(line) or length
        block = _BLOCK.match(line)
        if block is None:
            continue
        layout = fortran_layout(line) or Layout(8, 10)
        count = text.count(block[1])
        if block[2].lower() != "accel":
            others = block[2].lower()
            text.skip(count, layout)
            text.demand_end(count)
            continue
        if points is not None and int(points[1]) != count:
            raise text.fault(f"{count} points of acceleration, where the channel's header states {points[1]}")
        dt = _precise(text.step(block[3] or ""), recent)
        if length is not None and not 0.5 < count * dt / max(float(length[1]), 1e-9) < 2.0:
            raise text.fault(f"{count} points every {dt:g} s, where the channel's header states a length of {length[1]} s")
        stated = _UNIT.search(line[block.end() :])
        unit = text.unit(stated[1]) if stated else "cm/s2"
        said = peak[1] if peak is not None and unit_of(peak[2]) == unit else None
        found.append(Series(channel, dt, text.numbers(count, layout), unit, said))
        text.demand_end(count)
        channel = peak = points = length = None
    if not found and others:
        raise text.no_acceleration(f"no points of accel data, only of {others}")
    if not found:
        raise text.fault("no line `n points of accel data`")
    return found


def _precise(dt: float, recent: list[str]) -> float:
    """The step of the real header where it is the text's with more digits, as 1/128 s is."""
    if len(recent) > _REAL_HEADER:
        try:
            precise = float(recent[-1 - _REAL_HEADER + 7][40:50])
        except ValueError:
            return dt
        if abs(precise - dt) < 6e-4 and precise > 0.0:
            return precise
    return dt
