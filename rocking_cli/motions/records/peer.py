"""PEER AT2: text lines, one of which is `NPTS=  n, DT=  x SEC` (older files: `n  x  NPTS, DT`), then n values in g."""

import re

from .record import Series
from .text import Layout, RecordText, begins

NAME = "PEER AT2"
_NUMBER = r"([-+.\dEeDd]+)"
_COUNT = re.compile(rf"NPTS\s*=\s*{_NUMBER}\s*,?\s*DT\s*=\s*{_NUMBER}", re.IGNORECASE)
_OLDER = re.compile(rf"^\s*{_NUMBER}\s*,?\s+{_NUMBER}\s*,?\s*NPTS\s*,?\s*DT\b", re.IGNORECASE)
_UNIT = re.compile(
    r"UNITS?\s*(?:(?:(?:OF|ARE|IN)\b|[:=])\s*)+\(?([A-Z][A-Z0-9/^*]*)"
    r"|\bACC.*(?:\bIN\s+|[(\[]\s*)(M?G|GALS?|(?:[CM]?M|IN|FT)/S[A-Z0-9/^*]*)(?![A-Z0-9/^*])",
    re.IGNORECASE,
)
_OTHER = re.compile(r"\b(?:VELOC|DISPL)[A-Z.]*(?:\b.*\b(?:UNITS?|IN)\b|\s+TIME[ -](?:HISTORY|SERIES))", re.IGNORECASE)
_UPWARDS = re.compile(r",\s*(UP|U-?D|DN|DWN|DOWN|VER|VERT[A-Z]*|V|Z)\s*(?:\(|$)", re.IGNORECASE)
_SAID, _TRAILER = re.compile(r"\S.*"), re.compile(r"\W*(?:END|EOF)\b", re.IGNORECASE)

recognise = begins(rf"(?:.*\n){{0,49}}?.*(?:{_COUNT.pattern}|{_OLDER.pattern})")


def read(text: RecordText) -> list[Series]:
    """Return the one component of the file, named only if it is vertical: PEER states the others in the file name. Raises DocumentError."""
    unit, component = "g", None
    while (line := text.next_line()) is not None:
        if (found := _COUNT.search(line) or _OLDER.search(line)) is not None:
            break
        if _OTHER.search(line):
            raise text.no_acceleration(f"found {line.strip()!r}; expected an acceleration (AT2)")
        if (upwards := _UPWARDS.search(line)) is not None:
            component = upwards[1]
        if (said := _UNIT.search(line)) is not None:
            unit = text.unit(said[1] or said[2])
    if line is None or found is None:
        raise text.fault("no line NPTS=, DT=")
    count, dt = text.count(found[1]), text.step(found[2])
    first = text.raw[text.at : text.at + 1000].lstrip().split(b"\n", 1)[0].split()
    samples = text.numbers(count, Layout(max(1, len(first))))
    remark = text.surplus(count)
    trailer = None if remark else text.find(_SAID)
    if trailer is not None and not _TRAILER.match(trailer[0]):
        raise text.fault(f"found {trailer[0].strip()[:60]!r} after the {count} values declared; expected nothing, or a line that says end")
    return [Series(component, dt, samples, unit, remark=remark)]
