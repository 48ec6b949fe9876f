"""PEER AT2: lines of text, one of which is `NPTS=  n, DT=  x SEC` (older files:
`n  x  NPTS, DT`), then n values. A line above it states the quantity and the unit, g
where it names only an acceleration.
"""

import re
from itertools import takewhile

import numpy as np

from .claims import Claims
from .directions import is_up, is_up_alone
from .printed_numbers import finite_number
from .record import Series
from .text import Layout, RecordText, begins
from .times import even_step

NAME = "PEER AT2"
_NUMBER = r"([-+.\dEeDd]+)"
_COUNT = re.compile(
    rf"NPTS\s*=\s*{_NUMBER}\s*,?\s*DT\s*=\s*{_NUMBER}\s*([a-z]*)", re.IGNORECASE
)
_OLDER = re.compile(
    rf"^\s*{_NUMBER}\s*,?\s+{_NUMBER}\s*,?\s*NPTS\s*,?\s*DT\b()", re.IGNORECASE
)
_SAID, _TRAILER = re.compile(r"\S.*"), re.compile(r"\W*(?:END|EOF)\b", re.IGNORECASE)
_BRACKETS = re.compile(r"\([^)]*\)")
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
    claims = Claims(text.no_acceleration)
    for i, (words, number) in enumerate(above):
        claims.take(words, number, strict=i == len(above) - 1)
    before, behind = found.string[: found.start()], found.string[found.end() :]
    claims.take(before, text.line - 1)
    if re.match(r"\W*\d", behind):  # DT= 1/100
        raise text.fault(f"found {behind.strip()!r} after the time step {found[2]!r}")
    claims.take(behind, text.line - 1)
    count = text.count(found[1])
    dt = text.step(found[2]) * text.seconds(found[3])
    unit = claims.unit or ("g" if claims.acceleration else text.given.unit)
    if unit is None:
        last = above[-1][0].strip() if above else found.string.strip()
        said = (
            f"found {last!r}; expected a line such as ACCELERATION IN UNITS OF G, or"
            " `unit`"
        )
        raise text.fault(said, above[-1][1] if above else None)
    samples, remark = _samples(text, count, dt)
    trailer = None if remark else text.find(_SAID)
    if trailer is not None and not _TRAILER.match(trailer[0]):
        said = f"found {trailer[0].strip()[:60]!r} after the {count} values declared"
        raise text.fault(f"{said}; expected nothing, or a line that says end")
    return [Series(_upwards(claims, above), dt, samples, unit, remark=remark)]


def _samples(text: RecordText, count: int, dt: float) -> tuple[np.ndarray, str]:
    """(the samples, a remark if more follow); of lines of time and value the values."""
    at, line = text.at, text.line
    first = text.raw[at : at + 1000].lstrip().split(b"\n", 1)[0].split()
    width = max(1, len(first))
    timed = width > 1 and _first_numbers_rise(text, width)
    doubled = len(text.raw[at:].split(None, 2 * count + 1)) >= 2 * count
    if width == 2 and (timed or doubled):
        values = text.rows(count, 2)
        step = even_step(values[:, 0], text, line)
        if abs(step - dt) > 1e-3 * dt:
            raise text.fault(
                f"times every {step:g} s, where the header states {dt:g} s", line
            )
        return values[:, 1].copy(), text.surplus(count)
    samples = text.numbers(count, Layout(width))
    remark = text.surplus(count)
    more = len(text.raw[text.at :].split(None, count + 1)) if remark else 0
    if remark and more >= count:
        raise text.fault(f"found more than twice the {count} values declared")
    if remark and timed:
        raise text.fault(
            "the first numbers of the lines rise, as times do; expected values alone,"
            " or a time and a value on each line",
            line,
        )
    return samples, remark


def _first_numbers_rise(text: RecordText, width: int) -> bool:
    """True if the first numbers of lines of `width` numbers never fall and mostly rise,
    as times do and accelerations do not.
    """
    words = text.raw[text.at :].split(None, _MANY * width)[: _MANY * width : width]
    numbers = takewhile(lambda x: x is not None, map(finite_number, words))
    steps = np.diff(np.array(list(numbers), dtype=float))
    rising = steps.size > 1 and 2 * int(np.count_nonzero(steps)) > steps.size
    return rising and bool((steps >= 0.0).all())


def _upwards(claims: Claims, above: list[tuple[str, int]]) -> str | None:
    """The component if it is vertical: at the end of a line of words between commas."""
    for words, _ in above:
        last = (
            _BRACKETS.sub(" ", words.rpartition(",")[2]).strip() if "," in words else ""
        )
        if is_up_alone(last):
            return last
    up = claims.component
    return up if up is not None and is_up(up) else None
