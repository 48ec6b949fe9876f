"""AFAD, the Turkish national network (NSMN): lines `KEY : value`, then three columns in gal, N-S, E-W and U-D."""

from __future__ import annotations

import re

from .numbers import Layout
from .record import Series
from .text import Keys, RecordText

NAME = "AFAD"
_TITLE = "STRONG GROUND MOTION RECORDS OF T"
_COLUMNS = re.compile(r"^\s*N-?S\s+E-?W\s+(?:U-?D|Z|V)\s*$", re.IGNORECASE)


def recognise(head: str) -> bool:
    """True if the first line is the network's title."""
    return head.lstrip().upper().startswith(_TITLE)


def read(text: RecordText) -> list[Series]:
    """The three components. Raises DocumentError."""
    keys: Keys = {}
    names: list[str] = []
    while not names:
        line = text.next_line()
        if line is None:
            raise text.fault("no line N-S, E-W, U-D above the values")
        names = line.split() if _COLUMNS.match(line) else []
        key, colon, value = line.partition(":")
        if colon:
            keys[key.strip().upper()] = value.strip(), text.line - 1

    count = text.count(*text.value(keys, "NUMBER OF DATA"))
    dt = text.step(*text.value(keys, "SAMPLING INTERVAL (SEC)"))
    stated = next((v for k, (v, _) in keys.items() if "PGA VALUES" in k), "")
    peaks = dict(re.findall(r"\(([^)]+)\)\s*([-+.\dEe]+)", stated))
    unit = next((k for k in keys if "PGA VALUES" in k), "(GAL)")
    if "(GAL)" not in unit:
        raise text.fault(f"found {unit!r}; expected a record in gal", keys[unit][1])
    values = text.numbers(3 * count, Layout(3)).reshape(count, 3)
    surplus = text.surplus(count)
    return [Series(name, dt, values[:, i].copy(), "gal", peaks.get(name), "" if i else surplus) for i, name in enumerate(names)]
