"""ESM and ITACA: lines `KEY: value` from EVENT_NAME on (64 in DYNA 1.2, 55 in 1.0, 43 in the first ITACA), then one value a line."""

from __future__ import annotations

import re

from .record import Series
from .text import Layout, RecordText, begins

NAME = "ESM"
_KEY = re.compile(r"\s*([A-Z][A-Z0-9_/^.()-]*)\s*:\s*(.*)")
_KINDS = ("ACCELERATION", "PROCESSED ACCELERATION", "UNPROCESSED ACCELERATION")

recognise = begins(r"EVENT_NAME:(?=[\s\S]*SAMPLING_INTERVAL_S)(?=[\s\S]*NDATA)")


def read(text: RecordText) -> list[Series]:
    """The one component of the file. Raises DocumentError."""
    keys = text.keys(_KEY)
    kind, line = text.value(keys, "DATA_TYPE", "ACCELERATION")
    if kind.upper() not in _KINDS:
        raise text.no_acceleration(f"DATA_TYPE: found {kind!r}; expected ACCELERATION", line)
    unit = text.unit(*text.value(keys, "UNITS", "a unit of acceleration"), "UNITS")
    count = text.count(*text.value(keys, "NDATA", "a number of values"))
    dt = text.step(*text.value(keys, "SAMPLING_INTERVAL_S", "a step in s"))
    duration, line = keys.get("DURATION_S", ("", 0))
    if duration:
        text.agree(count, dt, duration, line)
    peak = next((v for k, (v, _) in keys.items() if k.startswith("PGA_") and re.fullmatch(r"[-+\d.eE]+", v)), None)
    component = keys.get("STREAM", ("", 0))[0] or keys.get("COMPONENT", ("", 0))[0] or None
    return [Series(component, dt, text.numbers(count, Layout(1)), unit, peak, text.surplus(count))]
