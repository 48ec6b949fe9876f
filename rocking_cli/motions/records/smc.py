"""SMC (USGS): 11 lines of text, 48 integers and 50 reals in fixed columns, comments
behind bars, values in cm/s2 of ten characters (fourteen where the header states eight
digits).
"""

import re

from .record import Series
from .text import Layout, RecordText, begins, stated

NAME = "SMC"
_KINDS = (
    "UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE"
    " SPECTRA|FOURIER AMPLITUDE SPECTRA|UNKNOWN"
)
_FIRST = re.compile(rf"([0-9])\s+({_KINDS})", re.IGNORECASE)
_COMPONENT = re.compile(r"component\s*=\s*(\S.*?)\s*$", re.IGNORECASE)
_TEXT, _INTEGERS, _REALS = 11, 48, 50
_POINTS, _DIGITS = 16, 46  # places among the integers, from 0
_NONE, _RATE, _MAXIMUM, _MINIMUM = 0, 1, 29, 31  # places among the reals

recognise = begins(_FIRST.pattern)


def read(text: RecordText) -> list[Series]:
    """Return the one component of the file. Raises DocumentError."""
    lines = text.lines(_TEXT)
    if "ACCELEROGRAM" not in (stated(_FIRST, lines[:1], 2) or "").upper():
        raise text.no_acceleration(
            f"found {lines[0].strip()!r}; expected an accelerogram", 1
        )
    integers = text.numbers(_INTEGERS, Layout(8, 10))
    reals = text.numbers(_REALS, Layout(5, 15))
    while text.raw[text.at : text.at + 1] == b"|":
        text.next_line()
    count = text.count(f"{integers[_POINTS]:.0f}")
    if reals[_RATE] == reals[_NONE]:
        raise text.fault(
            "no sampling rate in the header, as of pairs of times and accelerations;"
            " expected accelerations at equal steps"
        )
    dt = text.step_of_rate(f"{reals[_RATE]:.10g}")
    pga = max(
        (abs(reals[i]) for i in (_MAXIMUM, _MINIMUM) if reals[i] != reals[_NONE]),
        default=0.0,
    )
    samples = text.numbers(
        count, Layout(5, 14) if integers[_DIGITS] == 8 else Layout(8, 10)
    )
    return [
        Series(
            stated(_COMPONENT, lines),
            dt,
            samples,
            "cm/s2",
            f"{pga:.6e}" if pga > 0.0 else None,
        )
    ]
