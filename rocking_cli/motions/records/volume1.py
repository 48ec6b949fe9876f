"""Volume 1, uncorrected accelerograms of CSMIP, RENADIC and BHRC: a channel is 13 lines
of text, 14 of numbers, and its samples. Below the text G/10 a line holds five pairs of
time and acceleration, or ten accelerations in files that begin with `* VOL1DS`; else
the samples announce themselves, as in `13200 Accelerogram points at 200 pts/sec in
units of g. Format: (8f9.6)`.
"""

import re

import numpy as np

from .record import Series
from .text import FORTRAN, Layout, RecordText, begins, fortran_layout, stated
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
_BODY = re.compile(
    r"^\s*(\d+)\s*accelerogram points at\s*([.\d]+)\s*pts/sec\s*in units"
    rf" of\s*([a-z0-9/^]+).*?{FORTRAN}",
    re.IGNORECASE,
)
_BODY_OF_1990 = re.compile(
    r"^\s*(\d+)\s*points of accel\w* data equally spaced at\s*([.\d]+)\s*sec"
    r".*?units?:?\s*([a-z0-9/^]+)",
    re.IGNORECASE,
)
# lines, and that of the numbers, from 0, which begins with the sampling rate in BHRC's
_TEXT, _NUMBERS, _RATE = (13, 14, 8)
_IN_A_LINE = 8  # values of the 1990s on a line, in columns as wide as they need
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
            dt, unit, samples = _announced(text, count)
        elif first[1]:
            dt = text.step_of_rate(numbers[_RATE][: _ALONE.width])
            samples = text.numbers(count, _ALONE) / 10.0
        else:
            line, pairs = text.line, text.numbers(2 * count, _PAIRS).reshape(count, 2)
            dt = even_step(pairs[:, 0], text, line, _PAIRS.columns // 2)
            samples = pairs[:, 1] / 10.0
        text.require_end(count)
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


def _announced(text: RecordText, count: int) -> tuple[float, str, np.ndarray]:
    """(step [s], unit, samples) of the numbers that a line announces, in its present
    form or in that of the 1990s.
    """
    line = text.next_line() or ""
    of_1990 = _BODY_OF_1990.search(line)
    body = of_1990 or _BODY.search(line)
    if body is None:
        example = (
            "13200 Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)"
        )
        raise text.fault(f"found {line.strip()!r}; expected a line like {example}")
    text.count(body[1], same=count)
    unit = text.unit(body[3])
    if of_1990 is None:
        return text.step_of_rate(body[2]), unit, text.numbers(count, Layout.of(body))
    first = text.raw[text.at : text.at + 200].split(b"\n", 1)[0].rstrip()
    layout = fortran_layout(line) or Layout(_IN_A_LINE, len(first) // _IN_A_LINE)
    return text.step(body[2]), unit, text.numbers(count, layout)
