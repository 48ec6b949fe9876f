"""K-NET and KiK-net (NIED): header lines up to the memo, then counts; the header's scale makes them gal.

The counts lie about an offset of the recorder. The reader removes their mean: the header's Max. Acc. is the peak after that.
"""

from __future__ import annotations

import re

import numpy as np

from .record import Series
from .text import Layout, RecordText, begins

NAME = "K-NET"
_KEY = re.compile(r"(\w[\w. ]*?)\s*(?:\(\w+\)\s*|\s\s+|$)(.*)")
_MEMO = re.compile(r"Memo", re.IGNORECASE)
_SCALE = re.compile(r"([\d.]+)\s*\(gal\)\s*/\s*([\d.]+)", re.IGNORECASE)

recognise = begins(r"Origin Time[\s\S]*Sampling Freq")


def read(text: RecordText) -> list[Series]:
    """The one component of the file. Raises DocumentError."""
    keys = text.keys(_KEY, _MEMO)
    stated, line = text.value(keys, "Scale Factor", "a scale such as 7845(gal)/8223790, since counts have no unit")
    scale = _SCALE.search(stated)
    if scale is None or not float(scale[2]) > 0.0:
        raise text.fault(f"Scale Factor: found {stated!r}; expected a value like 7845(gal)/8223790", line)
    frequency, line = text.value(keys, "Sampling Freq")
    dt = text.step_of_rate(re.sub(r"\s*hz\s*$", "", frequency, flags=re.IGNORECASE), line)
    duration, line = text.value(keys, "Duration Time")
    count = text.count(f"{text.number(duration, line) / dt:.10g}", line)
    component, _ = text.value(keys, "Dir.")
    peak, _ = keys.get("MAX. ACC.", ("", 0))
    counts = text.numbers(count, Layout(8))
    samples = (counts - float(np.mean(counts))) * (float(scale[1]) / float(scale[2]))
    return [Series(component, dt, samples, "gal", peak if re.fullmatch(r"[\d.]+", peak) else None, text.surplus(count))]
