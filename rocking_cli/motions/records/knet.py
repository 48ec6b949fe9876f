"""K-NET and KiK-net (NIED): 17 header lines, then counts; the header's scale makes them gal.

The counts lie about an offset of the recorder, so their mean is taken off: the header's Max. Acc. is the peak after that.
"""

from __future__ import annotations

import re

import numpy as np

from .numbers import Layout
from .record import Series
from .text import RecordText

NAME = "K-NET"
_HEADER = 17  # lines
_SCALE = re.compile(r"([\d.]+)\s*\(gal\)\s*/\s*([\d.]+)", re.IGNORECASE)


def recognise(head: str) -> bool:
    """True if the file begins with Origin Time and states a sampling frequency."""
    return head.lstrip().lower().startswith("origin time") and "Sampling Freq" in head


def read(text: RecordText) -> list[Series]:
    """The one component of the file. Raises DocumentError."""
    keys: dict[str, tuple[str, int]] = {}
    for i, line in enumerate(text.lines(_HEADER), 1):
        keys[line[:18].strip().lower()] = line[18:].strip(), i

    def value(key: str) -> tuple[str, int]:
        found = next((v for k, v in keys.items() if k.startswith(key.lower())), ("", _HEADER))
        if not found[0]:
            raise text.fault(f"{key}: no value" + (", and counts without a scale have no unit" if key == "Scale Factor" else ""), found[1])
        return found

    stated, line_number = value("Scale Factor")
    scale = _SCALE.search(stated)
    if scale is None or not float(scale[2]) > 0.0:
        raise text.fault(f"Scale Factor: found {stated!r}; expected a value like 7845(gal)/8223790", line_number)
    frequency, line_number = value("Sampling Freq")
    rate = text.rate(re.sub(r"\s*hz\s*$", "", frequency, flags=re.IGNORECASE), line_number)
    stated, line_number = value("Duration Time")
    duration = text.number(stated, line_number)
    count = text.count(f"{duration * rate:.10g}", line_number)
    peak = keys.get("max. acc. (gal)", ("", 0))[0]
    component = value("Dir.")[0]
    counts = text.numbers(count, Layout(8))
    offset = float(np.mean(counts))
    samples = (counts - offset) * (float(scale[1]) / float(scale[2]))
    return [Series(component, 1.0 / rate, samples, "gal", peak if re.fullmatch(r"[\d.]+", peak) else None, text.surplus(count))]
