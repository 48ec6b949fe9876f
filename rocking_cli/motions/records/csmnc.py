"""CSMNC (China Strong Motion Network Centre): a header of lines such as `COMP. EW`,
`UNCORRECTED ACCELERATION  UNIT: CM/SEC/SEC` and `NO. OF POINTS: 12000  EQUALLY SPACED
INTERVALS OF: 0.005 SEC`, then several values a line."""

import re

from .record import Series
from .text import RecordText, begins, stated

NAME = "CSMNC"
_POINTS = re.compile(
    r"NO\. OF POINTS:\s*(\S+)\s+EQUALLY SPACED INTERVALS OF:\s*(\S+)\s*([A-Z]*)",
    re.IGNORECASE,
)
_QUANTITY = re.compile(r"^\s*(.*?\S)\s+UNIT\s*:\s*(\S.*?)\s*$", re.IGNORECASE)
_COMPONENT = re.compile(r"^\s*COMP\.?\s*:?\s*(\S+)", re.IGNORECASE)
_PEAK = re.compile(r"PEAK VALUE:\s*([-+.\dE]+)", re.IGNORECASE)
_DURATION = re.compile(r"DURATION:\s*([.\d]+)", re.IGNORECASE)

recognise = begins(rf"(?:.*\n){{0,40}}?.*{_POINTS.pattern}")


def read(text: RecordText) -> list[Series]:
    """Return the one component of the file. Raises DocumentError."""
    lines: list[str] = []
    while not text.more_numbers() or not any(map(_POINTS.search, lines)):
        lines += text.lines(1)
    quantity = stated(_QUANTITY, lines)
    if quantity is None:
        raise text.fault("no line such as CORRECTED ACCELERATION  UNIT: CM/SEC/SEC")
    at = next(i for i, line in enumerate(lines, 1) if _QUANTITY.search(line))
    if (
        not re.search(r"\bAC+EL", quantity, re.IGNORECASE)
        or "SPECTR" in quantity.upper()
    ):
        raise text.no_acceleration(
            f"found {lines[at - 1].strip()!r}; expected an acceleration", at
        )
    unit = text.unit(stated(_QUANTITY, lines, 2) or "", at)
    count = text.count(stated(_POINTS, lines) or "")
    dt = text.step(stated(_POINTS, lines, 2) or "")
    dt *= text.seconds(stated(_POINTS, lines, 3) or "")
    if duration := stated(_DURATION, lines):
        text.agree(count, dt, duration, slack=1.0)
    samples = text.block(count)
    component, peak = stated(_COMPONENT, lines), stated(_PEAK, lines)
    return [Series(component, dt, samples, unit, peak)]
