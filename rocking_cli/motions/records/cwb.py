"""CWB, the Taiwanese network (now CWA): lines `#Key: value`, then columns of time [s] and three components in gal."""

from __future__ import annotations

import re

from .plain import even_step
from .record import Series
from .text import RecordText, begins, fortran_layout

NAME = "CWB"
_KEY = re.compile(r"#([^:(]+)[^:]*:(.*)")
_COMPONENT, _PEAK = re.compile(r"([A-Z])\s*\([-+]\)"), re.compile(r"\d*\.\d+")

recognise = begins(r"#(?=[\s\S]*#SampleRate\(Hz\):)(?=[\s\S]*#AmplitudeUnit:)(?=[\s\S]*#DataSequence:)")


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
    dt = text.step_of_rate(*text.value(keys, "SampleRate"))
    length, line = text.value(keys, "RecordLength")
    count, first = text.count(f"{text.number(length, line) / dt:.10g}", line), text.line
    values = text.numbers(count * layout.columns, layout).reshape(count, layout.columns)
    text.agree(count, even_step(values[:, 0], text, first), length, line)
    remark, found = text.surplus(count), []
    for i, name in enumerate(names, 1):
        peak = max(_PEAK.findall(keys.get(f"AMPLITUDEMAX. {name}", ("", 0))[0]), key=float, default=None)
        found.append(Series(name, dt, values[:, i], unit, peak, remark))
    return found
