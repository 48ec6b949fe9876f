"""AFAD, the Turkish national network (NSMN): lines `KEY : value`, then three columns in gal, N-S, E-W and U-D."""

from __future__ import annotations

import re

from .record import Series
from .text import Layout, RecordText, begins

NAME = "AFAD"
_KEY = re.compile(r"(.+?)\s*(?:\(sec\)\s*)?:(.*)", re.IGNORECASE)
_COLUMNS = re.compile(r"\s*N-?S\s+E-?W\s+(?:U-?D|Z|V)\s*$", re.IGNORECASE)

recognise = begins("STRONG GROUND MOTION RECORDS OF T")


def read(text: RecordText) -> list[Series]:
    """The three components. Raises DocumentError."""
    keys = text.keys(_KEY, _COLUMNS)
    count = text.count(*text.value(keys, "NUMBER OF DATA"))
    dt = text.step(*text.value(keys, "SAMPLING INTERVAL"))
    unit = next((k for k in keys if "PGA VALUES" in k), "(GAL)")
    if "(GAL)" not in unit:
        raise text.fault(f"found {unit!r}; expected a record in gal", keys[unit][1])
    peaks = dict(re.findall(r"\(([^)]+)\)\s*([-+.\dEe]+)", keys.get(unit, ("", 0))[0]))
    names = keys[""][0].split()
    values = text.numbers(3 * count, Layout(3)).reshape(count, 3)
    remark = text.surplus(count)
    return [Series(name, dt, values[:, i], "gal", peaks.get(name), remark) for i, name in enumerate(names)]
