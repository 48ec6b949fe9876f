"""PEER AT2: lines of text, one of which is `NPTS=  n, DT=  x SEC` (older files:
`n  x  NPTS, DT`), then n values. The line above it states the quantity and the unit, g
where it names only an acceleration; the lines above that are titles.
"""

import re
from itertools import takewhile

import numpy as np

from .directions import is_vertical_name
from .headings import ACCELERATION_NAMES, other_quantity
from .printed_numbers import finite_number
from .record import Series
from .text import Layout, RecordText, begins
from .times import even_step
from .units import is_foreign, plain, unit_of

NAME = "PEER AT2"
_NUMBER = r"([-+.\dEeDd]+)"
_COUNT = re.compile(
    rf"NPTS\s*=\s*{_NUMBER}\s*,?\s*DT\s*=\s*{_NUMBER}\s*([a-z]*)", re.IGNORECASE
)
_OLDER = re.compile(
    rf"^\s*{_NUMBER}\s*,?\s+{_NUMBER}\s*,?\s*NPTS\s*,?\s*DT\b()", re.IGNORECASE
)
# what stands beside the word acceleration, and behind its unit
_BESIDE = {
    *("time", "series", "history", "data", "values", "in", "en", "units", "unit", "of"),
    *("corrected", "uncorrected"),
}
_FILTER = re.compile(r"\.?\s*\bfilter\b.*", re.IGNORECASE)
_UP = re.compile(r"(?:(,|\bcomp\w*\.?)\s*|[-–:\s])([-+\w]+)(?: comp\w*)?\W*$", re.I)
_MANY = 1000  # lines that show whether their first numbers are times

_BEGIN = begins(rf"(?:.*\n){{0,49}}?.*(?:{_COUNT.pattern}|{_OLDER.pattern})")
_OTHER_TEXT = re.compile(r"[A-CF-Za-cf-z]{2,}|[,;]")


def recognise(head: str) -> bool:
    """True if numbers between blanks follow a line of NPTS and DT."""
    if not _BEGIN(head):
        return False
    lines = head.splitlines()
    at = next(
        (i for i, x in enumerate(lines) if _COUNT.search(x) or _OLDER.search(x)), None
    )
    if at is None:  # NPTS and DT stand on two lines
        return False
    below = next((x for x in lines[at + 1 :] if x.strip()), "")
    return _OTHER_TEXT.search(below) is None


def read(text: RecordText) -> list[Series]:
    """Return the one component of the file, named only if it is vertical.

    PEER states the others in the name of the file. Raises DocumentError.
    """
    above: list[tuple[str, int]] = []
    found = None
    while (line := text.next_line()) is not None:
        if (found := _COUNT.search(line) or _OLDER.search(line)) is not None:
            break
        if line.strip():
            above.append((line, text.line - 1))
    if line is None or found is None:
        raise text.fault("no line NPTS=, DT=")
    behind = found.string[found.end() :]
    if re.match(r"\W*\d", behind):  # DT= 1/100
        raise text.fault(f"found {behind.strip()!r} after the time step {found[2]!r}")
    count = text.count(found[1])
    dt = text.step(found[2]) * text.seconds(found[3])
    unit = _unit(text, *(above[-1] if above else ("", text.line - 1)))
    return [Series(_upwards(above[:-1]), dt, _samples(text, count, dt), unit)]


def _unit(text: RecordText, said: str, line: int) -> str:
    """The unit in the line that states the quantity, or that of the user. Raises
    DocumentError.
    """
    quantity = _FILTER.sub("", said)
    words = [x for x in re.split(r"[\s,;:()\[\]{}=]+", quantity) if x]
    words = [y for x in words for y in (x.split("-") if unit_of(x) is None else [x])]
    units = [unit for x in words if (unit := unit_of(x))]
    names = [plain(x).strip(".") for x in words if unit_of(x) is None]
    if other_quantity(quantity) or any(map(is_foreign, words)):
        raise text.no_acceleration(
            f"found {said.strip()!r}; expected an acceleration", line
        )
    left = [x for x in names if x not in ACCELERATION_NAMES and x not in _BESIDE]
    if len(left) < len(names) and not left and set(names) & ACCELERATION_NAMES:
        return units[0] if units else "g"
    if text.given.unit is None:
        raise text.fault(
            f"found {said.strip()!r} above the number of values; expected a line such"
            " as ACCELERATION IN UNITS OF G, or `unit`",
            line,
        )
    return text.given.unit


def _samples(text: RecordText, count: int, dt: float) -> np.ndarray:
    """The samples; of lines of time and value the values."""
    at, line = text.at, text.line
    first = text.raw[at : at + 1000].lstrip().split(b"\n", 1)[0].split()
    width = max(1, len(first))
    timed = width > 1 and _first_numbers_rise(text, width)
    doubled = len(text.raw[at:].split(None, 2 * count + 1)) >= 2 * count
    if width == 2 and (timed or doubled):
        values = text.rows(count, Layout(2))
        step = even_step(values[:, 0], text, line)
        if abs(step - dt) > 1e-3 * dt:
            raise text.fault(
                f"times every {step:g} s, where the header states {dt:g} s", line
            )
        return values[:, 1].copy()
    samples = text.block(count)
    beyond = text.numbers_beyond() is not None
    if beyond and len(text.raw[text.at :].split(None, count + 1)) >= count:
        raise text.fault(f"found more than twice the {count} values declared")
    if beyond and timed:
        raise text.fault(
            "the first numbers of the lines rise, as times do; expected values alone,"
            " or a time and a value on each line",
            line,
        )
    return samples


def _first_numbers_rise(text: RecordText, width: int) -> bool:
    """True if the first numbers of lines of `width` numbers never fall and mostly rise,
    as times do and accelerations do not.
    """
    words = text.raw[text.at :].split(None, _MANY * width)[: _MANY * width : width]
    numbers = takewhile(lambda x: x is not None, map(finite_number, words))
    steps = np.diff(np.array(list(numbers), dtype=float))
    rising = steps.size > 1 and 2 * int(np.count_nonzero(steps)) > steps.size
    return rising and bool((steps >= 0.0).all())


def _upwards(titles: list[tuple[str, int]]) -> str | None:
    """The component if a title ends with the vertical direction: a word such as UP or
    VERTICAL, or V or Z behind a comma.
    """
    for words, _ in titles:
        end = _UP.search(re.sub(r"\([^)]*\)", " ", words).rstrip())
        letter = end is not None and end[1] and end[2].strip("+-") in "VvZz"
        if end and (letter or len(end[2]) > 1) and is_vertical_name(end[2]):
            return end[2]
    return None
