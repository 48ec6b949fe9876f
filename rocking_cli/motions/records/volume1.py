"""Volume 1, uncorrected accelerograms of CSMIP, RENADIC and BHRC: a channel is 13 lines of text, 14 of numbers, and its samples.

Where the text says G/10, a line holds five pairs of time and acceleration (F7.3), or ten accelerations (E13.6) in files that begin with
`* VOL1DS`; else the samples announce themselves, as in `13200 Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)`.
"""

from __future__ import annotations

import re

import numpy as np

from .numbers import Layout, fortran_layout
from .plain import even_step
from .record import Series
from .text import RecordText

NAME = "Volume 1"
_FIRST = re.compile(r"^\s*(?:UNCORRECTED ACCELEROGRAM\b|(\* VOL1DS\b))", re.IGNORECASE)
_POINTS = re.compile(r"NO\. OF POINTS\s*=\s*(\d+)\s+(?:RECORD LENGTH|DURATION)\s*=\s*([.\d]+)", re.IGNORECASE)
_CHANNEL = re.compile(r"^\s*(?:CHAN(?:NEL)?\s*\d*\s*:|COMP\b)\s*(\S.*?)\s*(?:\(|\s{2}|$)", re.IGNORECASE | re.MULTILINE)
_PEAK = re.compile(r"\bMAX\s*=\s*([-+]?\d*\.\d+)\s*G\b", re.IGNORECASE)
_TENTHS = re.compile(r"\bUNITS\b.*\bSEC\w* AND G/10\b", re.IGNORECASE)
_BODY = re.compile(r"^\s*(\d+)\s*accelerogram points at\s*([.\d]+)\s*pts/sec\s*in units of\s*([a-z0-9/^]+)", re.IGNORECASE)
_TEXT, _NUMBERS, _RATE = 13, 14, 8  # lines, and that of the numbers, from 0, which begins with the sampling rate in BHRC's
_PAIRS, _ALONE = Layout(10, 7), Layout(10, 13)


def recognise(head: str) -> bool:
    """True if the first line is that of a volume 1. Test for GNS Science and COSMOS first: their files begin in the same way."""
    return bool(_FIRST.match(head.lstrip().split("\n", 1)[0]))


def read(text: RecordText) -> list[Series]:
    """The acceleration of every channel. Raises DocumentError."""
    found: list[Series] = []
    while (first := text.find(_FIRST)) is not None:
        said = "\n".join(text.lines(_TEXT - 1))
        numbers = text.lines(_NUMBERS)
        points, channel, peak = _POINTS.search(said), _CHANNEL.search(said), _PEAK.search(said)
        if points is None:
            raise text.fault("no line `No. of Points = n  Record Length = x sec` above the samples")
        count, unit = text.count(points[1]), "g"
        if _TENTHS.search(said):
            if first[1]:
                dt = 1.0 / text.rate(numbers[_RATE][: _ALONE.width])
                samples = text.numbers(count, _ALONE) / 10.0
            else:
                line = text.line
                pairs = text.numbers(2 * count, _PAIRS).reshape(count, 2)
                dt, samples = even_step(pairs[:, 0], text, line, _PAIRS.columns // 2), pairs[:, 1] / 10.0
        else:
            dt, unit, samples = _announced(text, count)
        text.demand_end(count)
        text.agree(count, dt, points[2])
        stated = peak[1] if peak is not None and unit == "g" else None
        found.append(Series(channel[1] if channel else None, dt, samples, unit, stated))
    return found


def _announced(text: RecordText, count: int) -> tuple[float, str, np.ndarray]:
    """dt [s], the unit and the samples where a line says what follows. Raises DocumentError."""
    line = text.next_line() or ""
    body, layout = _BODY.match(line), fortran_layout(line)
    if body is None or layout is None:
        raise text.fault(
            f"found {line.strip()!r}; expected a line like 13200 Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)"
        )
    unit = text.unit(body[3])
    if text.count(body[1]) != count:
        raise text.fault(f"{body[1]} points, where the channel's header states {count}")
    return 1.0 / text.rate(body[2]), unit, text.numbers(count, layout)
