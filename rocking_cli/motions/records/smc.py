"""SMC (USGS): 11 lines of text, 48 integers and 50 reals in fixed columns, comments behind bars, values in cm/s2 of ten characters
(fourteen where the header states eight digits)."""

from __future__ import annotations

import re

from .numbers import Layout
from .record import Series
from .text import RecordText

NAME = "SMC"
_KINDS = "UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE SPECTRA|FOURIER AMPLITUDE SPECTRA|UNKNOWN"
_FIRST = re.compile(rf"^\s*([0-9])\s+({_KINDS})", re.IGNORECASE)
_COMPONENT = re.compile(r"component\s*=\s*(\S.*?)\s*$", re.IGNORECASE)
_TEXT, _INTEGERS, _REALS = 11, 48, 50
_COMMENTS, _POINTS, _DIGITS = 15, 16, 46  # places among the integers, from 0
_LAYOUTS = {8: Layout(5, 14)}  # of values, by the digits that the header states
_NONE, _RATE, _MAXIMUM, _MINIMUM = 0, 1, 29, 31  # places among the reals


def recognise(head: str) -> bool:
    """True if the first line names one of the kinds of SMC files."""
    return bool(_FIRST.match(head.split("\n", 1)[0]))


def read(text: RecordText) -> list[Series]:
    """The one component of the file. Raises DocumentError."""
    first, *lines = text.lines(_TEXT)
    kind = _FIRST.match(first)
    if kind is None or "ACCELEROGRAM" not in kind[2].upper():
        raise text.no_acceleration(f"found {first.strip()!r}; expected an accelerogram", 1)
    integers = text.numbers(_INTEGERS, Layout(8, 10))
    reals = text.numbers(_REALS, Layout(5, 15))
    while text.raw[text.at : text.at + 1] == b"|":
        text.next_line()
    count = text.count(f"{integers[_POINTS]:.0f}")
    if reals[_RATE] == reals[_NONE]:
        raise text.fault("no sampling rate in the header, as of pairs of times and accelerations; expected accelerations at equal steps")
    rate = text.rate(f"{reals[_RATE]:.10g}")
    component = next((m[1] for line in lines if (m := _COMPONENT.search(line))), None)
    peaks = [abs(reals[i]) for i in (_MAXIMUM, _MINIMUM) if reals[i] != reals[_NONE]]
    samples = text.numbers(count, _LAYOUTS.get(int(integers[_DIGITS]), Layout(8, 10)))
    peak = f"{max(peaks):.6e}" if peaks and max(peaks) > 0.0 else None
    return [Series(component, 1.0 / rate, samples, "cm/s2", peak, text.surplus(count))]
