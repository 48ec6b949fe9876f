"""TIMESERIES, the text of ObsPy and of the web services of data centres: a line such as
`TIMESERIES XX_STA_00_HNZ_D, 60 samples, 100 sps, 2020-01-01T00:00:00.000000, SLIST,
FLOAT, M/S**2` above the samples (SLIST), or above lines of a date and a sample
(TSPAIR).
"""

import re
from datetime import datetime, timedelta

import numpy as np

from ...arrays import Array
from .record import Series
from .text import RecordText, begins
from .units import unit_of

NAME = "TIMESERIES"
_FIRST = re.compile(
    r"TIMESERIES\s+(\S+?)\s*,\s*(\d+)\s+samples?\s*,\s*(\S+)\s*sps\s*,\s*(\S+)\s*,"
    r"\s*(SLIST|TSPAIR)\s*,\s*(\w+)\s*(?:,\s*(\S.*?))?\s*$",
    re.IGNORECASE,
)
_EXAMPLE = (
    "TIMESERIES XX_STA_00_HNZ_D, 60 samples, 100 sps, 2020-01-01T00:00:00.000000,"
    " SLIST, FLOAT, M/S**2"
)

recognise = begins(r"TIMESERIES\s+\S+\s*,\s*\d+\s+samples")


def read(text: RecordText) -> list[Series]:
    """Return every channel. Raises DocumentError, and NoAcceleration for counts."""
    found: dict[str, Series] = {}
    while text.raw[text.at :].strip():
        line = text.next_line() or ""
        if not line.strip():
            continue
        said = _FIRST.match(line.strip())
        if said is None:
            raise text.fault(
                f"found {line.strip()[:60]!r}; expected a line like {_EXAMPLE}"
            )
        if said[1] in found:
            raise text.fault(
                f"found a second stretch of {said[1]}, after a gap; expected one of"
                " each channel"
            )
        found[said[1]] = _series(text, said)
    return list(found.values())


def _series(text: RecordText, said: re.Match[str]) -> Series:
    """Return the series of a heading. Raises NoAcceleration, DocumentError."""
    name, word = said[1], said[7] or ""
    unit = unit_of(word) if word else text.given.unit
    if unit is None and not word:
        raise text.fault(f"found no unit of {name}; give it as `unit`")
    if unit is None:
        raise text.no_acceleration(
            f"found the unit {word!r}; expected one of acceleration, such as M/S**2"
        )
    count, dt = text.count(said[2]), text.step_of_rate(said[3])
    if said[5].upper() == "TSPAIR":
        values = _pairs(text, count, dt)
    else:
        values = text.block(count)
    parts = name.split("_")
    return Series(parts[3] if len(parts) > 3 else name, dt, values, unit)


def _pairs(text: RecordText, count: int, dt: float) -> Array:
    """The samples of lines of a date and a sample, of which each date is checked."""
    values = np.empty(count)
    first = None
    for i in range(count):
        line = text.next_line()
        if line is None:
            raise text.fault(f"the file ends after {i} of {count} values")
        date, _, value = line.strip().partition(" ")
        values[i] = text.number(value)
        try:
            at = datetime.fromisoformat(date)
        except ValueError:
            raise text.fault(
                f"found {date!r}; expected a date such as 2020-01-01T00:00:00.010000"
            ) from None
        first = first or at
        if abs((at - first) / timedelta(seconds=1) - i * dt) > 0.1 * dt:
            raise text.fault(
                f"found {date!r}, {i} steps of {dt:g} s after {first.isoformat()}"
            )
    return values
