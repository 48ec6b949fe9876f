"""Plain text: one column of accelerations, or two of time and acceleration, below any lines that hold no numbers. The last of these with
brackets may state units, as `time [ms], acc [g]`; without them a time is in s, and the user states the unit of the acceleration."""

import re

import numpy as np

from ...documents.quantities import UNITS
from ...errors import DocumentError
from .record import Series, unit_of
from .text import RecordText

NAME = "text"
_SEPARATORS = b",;\t"
_ROW = re.compile(r"^\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?(?:[\s,;]|$)")
_WORD = re.compile(r"(?!(?:nan|inf)\b)[a-z]{2,}", re.IGNORECASE)
_MOST_TITLE_LINES = 40
_BRACKETED = re.compile(r"[\[(]([^\])]*)[\])]")
_TIMES = {"ms": 1e-3, "msec": 1e-3, "µs": 1e-6, "us": 1e-6, "min": 60.0, "minutes": 60.0}  # s; any other word leaves times in s


def recognise(head: str) -> bool:
    """True if lines begin with numbers, after at most 40 lines of other text."""
    lines = [line for line in head.split("\n", _MOST_TITLE_LINES + 3) if line.strip()]
    rows = [i for i, line in enumerate(lines[: _MOST_TITLE_LINES + 1]) if _is_row(line)]
    return bool(rows) and (len(lines) <= rows[0] + 1 or _is_row(lines[rows[0] + 1]))


def _is_row(line: str) -> bool:
    """True if a line begins with a number and has no word (`1940 El Centro` has words, as most table rows do)."""
    return bool(_ROW.match(line)) and not _WORD.search(line)


def read(text: RecordText) -> list[Series]:
    """Return the one component of the file. Raises DocumentError."""
    at, first, title = text.at, text.line, ""
    while (line := text.next_line()) is not None and not _is_row(line):
        if re.search(r"\b(?:vel(?:oc\w*)?|disp(?:l\w*)?)\b", line, re.IGNORECASE) and not re.search(r"\bacc", line, re.IGNORECASE):
            raise text.fault(f"found {line.strip()!r}; expected an acceleration")
        title = line if _BRACKETED.search(line) else title
        at, first = text.at, text.line
    if line is None:
        raise text.fault("no numbers")
    text.at, text.line = at, first
    if ";" in line and "," in line and "." not in line:  # decimal commas
        text.raw = text.raw[:at] + text.raw[at:].replace(b",", b".")
    values, columns = text.table(_SEPARATORS)
    if columns > 2:
        raise text.fault(f"{columns} columns; expected one (acceleration) or two (time in s, acceleration)", first)
    stated = [word.strip() for word in _BRACKETED.findall(title)]
    unit = next((found for word in reversed(stated) if (found := unit_of(word))), None)
    if unit is not None and text.unit_given is not None and UNITS["acceleration"][text.unit_given] != UNITS["acceleration"][unit]:
        raise DocumentError(f"{text.source}: `unit`: found {text.unit_given}; expected {unit}, which the heading {title.strip()!r} states")
    unit, dt = unit or text.unit_given, text.dt_given
    if unit is None:
        raise DocumentError(f"{text.source}: plain numbers without a unit; give it as `unit`, one of {', '.join(UNITS['acceleration'])}")
    if columns == 1:
        if dt is None:
            raise DocumentError(f"{text.source}: one column of numbers without times; give their step as `dt`")
        if values[0] > 10 and values[0] in (values.size - 1, values.size - 2):
            raise text.fault(f"found {values[0]:g}, the number of the values below it; expected accelerations alone", first)
        return [Series(None, dt, values, unit)]
    if dt is not None:
        raise DocumentError(f"{text.source}: two columns, of which the first is the time; `dt` goes with one column")
    factor = next((_TIMES[word] for word in stated if word in _TIMES), 1.0)
    step = even_step(factor * values[0::2], text, first)
    remark = f"a step of {step:g} s, where the first column is taken for times in s" if step >= 1.0 else ""
    return [Series(None, step, values[1::2], unit, remark=remark)]


def even_step(time: np.ndarray, text: RecordText, line: int, in_a_line: int = 1) -> float:
    """Return the step of times that rise evenly; line: the line of the first time. Raises DocumentError if the times do not."""
    if time.size < 2:
        raise text.fault(f"found {time.size} values; expected at least two", line)
    step = float(f"{(time[-1] - time[0]) / (time.size - 1):.10g}")
    off = np.abs(time - (time[0] + step * np.arange(time.size))) > 0.1 * abs(step)  # printed times
    if off.any() or not step > 0.0 or np.any(np.diff(time) <= 0.0):
        bad = int(np.argmax(off))
        raise text.fault(f"times that do not rise in even steps, such as {time[bad]:g} s", line + bad // in_a_line)
    return step
