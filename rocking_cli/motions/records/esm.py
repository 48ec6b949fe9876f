"""ESM and ITACA: lines `KEY: value` from EVENT_NAME on (64 in DYNA 1.2, 55 in 1.0, 43 in the first ITACA), then one value a line."""

from __future__ import annotations

import re

from .numbers import Layout
from .record import Series
from .text import RecordText

NAME = "ESM"
_KEY = re.compile(r"\s*([A-Z][A-Z0-9_/^.()-]*)\s*:\s*(.*)")
_KINDS = ("ACCELERATION", "PROCESSED ACCELERATION", "UNPROCESSED ACCELERATION")


def recognise(head: str) -> bool:
    """True if the first line is EVENT_NAME and the keys of the sampling are there."""
    return head.lstrip().startswith("EVENT_NAME:") and "SAMPLING_INTERVAL_S" in head and "NDATA" in head


def read(text: RecordText) -> list[Series]:
    """The one component of the file. Raises DocumentError."""
    keys = text.keys(_KEY)
    kind, line_number = text.value(keys, "DATA_TYPE", "ACCELERATION")
    if kind.upper() not in _KINDS:
        raise text.no_acceleration(f"DATA_TYPE: found {kind!r}; expected ACCELERATION", line_number)
    unit = text.unit(*text.value(keys, "UNITS", "a unit of acceleration"), "UNITS")
    count = text.count(*text.value(keys, "NDATA", "a number of values"))
    dt = text.step(*text.value(keys, "SAMPLING_INTERVAL_S", "a step in s"))
    if keys.get("DURATION_S", ("", 0))[0]:
        text.agree(count, dt, *keys["DURATION_S"])
    peak = next((v for k, (v, _) in keys.items() if k.startswith("PGA_") and re.fullmatch(r"[-+\d.eE]+", v)), None)
    component = next((v for k in ("STREAM", "COMPONENT") if (v := keys.get(k, ("", 0))[0])), None)
    samples = text.numbers(count, Layout(1))
    return [Series(component, dt, samples, unit, peak, text.surplus(count))]
