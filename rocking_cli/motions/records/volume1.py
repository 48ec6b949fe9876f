"""Volume 1, uncorrected accelerograms of CSMIP, RENADIC and BHRC: a channel is 13 lines
of text, 14 of numbers, and its samples. Below the text G/10 a line holds five pairs of
time and acceleration, or ten accelerations in files that begin with `* VOL1DS`; else
the samples announce themselves, as in `13200 Accelerogram points at 200 pts/sec in
units of g. Format: (8f9.6)`.
"""

import re

from .csmip import BLOCK, announced
from .record import Series
from .text import Layout, RecordText, begins, stated
from .times import even_step

NAME = "Volume 1"
_FIRST = re.compile(r"\s*(?:UNCORRECTED ACCELEROGRAM\b|(\* VOL1DS\b))", re.IGNORECASE)
_POINTS = re.compile(
    r"NO\. OF POINTS\s*=\s*(\d+)\s+(?:RECORD LENGTH|DURATION)\s*=\s*([.\d]+)",
    re.IGNORECASE,
)
_CHANNEL = re.compile(
    r"\s*(?:CHAN(?:NEL)?\s*\d*\s*:|COMP\b)\s*(\S.*?)\s*(?:\(|\s{2}|$)", re.IGNORECASE
)
_PGA = re.compile(r"\bMAX\s*=\s*([-+]?\d*\.\d+)\s*G\b", re.IGNORECASE)
_TENTHS = re.compile(r"\b(UNITS)\b.*\bSEC\w* AND G/10\b", re.IGNORECASE)
# lines, and that of the numbers, from 0, which begins with the sampling rate in BHRC's
_TEXT, _NUMBERS, _RATE = (13, 14, 8)
_PAIRS, _ALONE = Layout(10, 7), Layout(10, 13)

# Test for GNS Science and COSMOS first: their files begin in the same way.
recognise = begins(_FIRST.pattern)


def read(text: RecordText) -> list[Series]:
    """Return the acceleration of every channel. Raises DocumentError."""
    found: list[Series] = []
    while (first := text.find(_FIRST)) is not None:
        lines, numbers = text.lines(_TEXT - 1), text.lines(_NUMBERS)
        points, length = stated(_POINTS, lines), stated(_POINTS, lines, 2)
        if points is None or length is None:
            raise text.fault(
                "no line `No. of Points = n  Record Length = x sec` above the samples"
            )
        count, unit = text.count(points), "g"
        if not stated(_TENTHS, lines):
            example = "13200 Accelerogram points at 200 pts/sec in units of g."
            said = text.like(BLOCK, f"{example} Format: (8f9.6)")
            block = announced(text, said)
            text.count(said["count"], same=count)
            dt, unit = block.step, text.unit(block.unit)
            samples = text.numbers(count, block.layout)
        elif first[1]:
            dt = text.step_of_rate(numbers[_RATE][: _ALONE.width])
            samples = text.numbers(count, _ALONE) / 10.0
        else:
            line, pairs = text.line, text.numbers(2 * count, _PAIRS).reshape(count, 2)
            dt = even_step(pairs[:, 0], text, line, _PAIRS.columns // 2)
            samples = pairs[:, 1] / 10.0
        text.agree(count, dt, length)
        found.append(
            Series(
                stated(_CHANNEL, lines),
                dt,
                samples,
                unit,
                stated(_PGA, lines) if unit == "g" else None,
            )
        )
    return found
