"""CWB, the Taiwanese network (now CWA): lines `#Key: value`, then columns of time [s] and three components in gal."""

from __future__ import annotations

import re

from .numbers import fortran_layout
from .plain import even_step
from .record import Series
from .text import RecordText

NAME = "CWB"
_KEY = re.compile(r"#([^:]+):\s*(.*)")
_COMPONENT, _PEAK = re.compile(r"([A-Z])\s*\([-+]\)"), re.compile(r"\d*\.\d+")


def recognise(head: str) -> bool:
    """True if the header lines state the rate, the unit and the order of the columns."""
    return head.lstrip().startswith("#") and all(key in head for key in ("#SampleRate(Hz):", "#AmplitudeUnit:", "#DataSequence:"))


def read(text: RecordText) -> list[Series]:
    """The three components. Raises DocumentError."""
    keys = text.keys(_KEY)
    word, line = text.value(keys, "AmplitudeUnit")
    unit = text.unit(word.split()[0], line, "AmplitudeUnit")
    names = _COMPONENT.findall(text.value(keys, "DataSequence")[0])
    stated, line = text.value(keys, "Data")
    layout = fortran_layout(f"({stated})")
    if not names or layout is None or layout.columns != 1 + len(names):
        raise text.fault(f"Data: found {stated!r} for a time and {', '.join(names)}; expected a value like 4F10.3", line)
    rate = text.rate(*text.value(keys, "SampleRate(Hz)"))
    length, line = text.value(keys, "RecordLength(sec)")
    count, first = text.count(f"{text.number(length, line) * rate:.10g}", line), text.line
    values = text.numbers(count * layout.columns, layout).reshape(count, layout.columns)
    text.agree(count, even_step(values[:, 0], text, first), length, line)
    remark, found = text.surplus(count), []
    for i, name in enumerate(names, 1):
        peak = max(_PEAK.findall(keys.get(f"AmplitudeMAX. {name}", ("", 0))[0]), key=float, default=None)
        found.append(Series(name, 1.0 / rate, values[:, i].copy(), unit, peak, remark))
    return found
