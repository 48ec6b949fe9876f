"""GeoNet V2A and V1A (GNS Science): three components a file, each 16 lines of text, 10
of numbers, then acceleration, velocity and displacement in mm/s2, mm/s and mm, ten
values of eight characters a line; V1A is uncorrected and has acceleration alone.
"""

import re

from .record import Series
from .text import Layout, RecordText, begins, stated
from .units import unit_of

NAME = "GeoNet"
_FIRST = re.compile(r"\s*(?:un)?corrected accelerogram.*GNS Science", re.IGNORECASE)
_SAID = re.compile(r".*\S.*")
_POINTS = re.compile(
    r"Number of points\s+(\S+)\s+Duration\s+([\d.]+)\s*s", re.IGNORECASE
)
_COMPONENT = re.compile(r"\s*Component\s+(\S+)", re.IGNORECASE)
_SCALE = re.compile(r"readings in units of\s+([\d.]+)\s*(\S+)", re.IGNORECASE)
_PGA = re.compile(r"Acceleration:\s*peak\s*([-+.\dEe]+)\s*mm/s", re.IGNORECASE)
_LAYOUT = Layout(10, 8)
_TEXT, _NUMBERS = 16, 100
# Places among the numbers, from 0.
_COUNTS = (33, 34, 35)  # number of values of each block
_STEP = 65  # time step

recognise = begins(_FIRST.pattern)


def read(text: RecordText) -> list[Series]:
    """Return the acceleration of every component. Raises DocumentError."""
    found: list[Series] = []
    while (first := text.find(_SAID)) is not None:
        if not _FIRST.match(first[0]):
            raise text.fault(
                f"found {first[0].strip()[:60]!r}; expected the first line of a"
                " component, Corrected accelerogram …"
            )
        start, lines = text.line, text.lines(_TEXT - 1)
        numbers = text.numbers(_NUMBERS, _LAYOUT)
        counts = [text.count(f"{numbers[i]:.10g}") for i in _COUNTS]
        if not counts[0]:
            raise text.fault("no acceleration: its number of points is 0")
        dt = text.step(f"{numbers[_STEP]:.10g}")
        for i, line in enumerate(lines, start):
            if (points := _POINTS.search(line)) is not None:
                text.agree(text.count(points[1], i, same=counts[0]), dt, points[2], i)
            scale = _SCALE.search(line)
            if scale is not None and (
                text.number(scale[1], i) != 1.0 or unit_of(scale[2]) != "mm/s2"
            ):
                raise text.fault(
                    f"found raw readings in units of {scale[1]} {scale[2]}; expected"
                    " units of 1 mm/s/s, no others are read",
                    i,
                )
        found.append(
            Series(
                stated(_COMPONENT, lines),
                dt,
                text.numbers(counts[0], _LAYOUT),
                "mm/s2",
                stated(_PGA, lines),
            )
        )
        for count in counts[1:]:
            text.skip(count, _LAYOUT)
    return found
