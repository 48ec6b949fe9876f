"""The components of a file: names, the vertical one, and the choice of a call."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ...documents.quantities import parse_whole
from ...errors import NoComponent, UsageError
from .record import Record

HORIZONTAL, ALL, STATION = "horizontal", "all", "station"
_VERTICAL = re.compile(r"\b(?:up|u-d|ud|dn|down|dwn|ver|vrt|vert\w*)\b|^(?:[uvz]|[a-z]{2}z)(?: \(\d+\))?$", re.IGNORECASE)
_OF_A_STATION = 2  # horizontal components; a file of a building or an array has more


def is_vertical(record: Record) -> bool:
    """True if the component is vertical by its name, such as Up, U-D, Vert, HNZ or, in KiK-net, 3 and 6."""
    name = record.component or ""
    return bool(_VERTICAL.search(name)) or (record.format == "K-NET" and name in ("3", "6"))


def pick(records: Sequence[Record], component: str | None) -> Record:
    """The one record of a component, by its name or its number from 1; None for the only one there is. Raises UsageError."""
    found = list(records) if component is None else chosen(records, component)
    if len(found) == 1:
        return found[0]
    raise UsageError(f"{records[0].source}: holds the components {names_of(found or records)}; give one as component")


def chosen(records: Sequence[Record], component: str | None) -> list[Record]:
    """The chosen records of a file: `horizontal` (which may be none), `all`, or one by its name or its number from 1; None: the
    horizontal ones of a station. Raises NoComponent for an unknown name, and UsageError for None if more than two are horizontal."""
    source, word = records[0].source, None if component is None else component.strip().casefold()
    if word == ALL:
        return list(records)
    if word in (None, HORIZONTAL):
        found = [r for r in records if not is_vertical(r)]
        if word is None and len(found) > _OF_A_STATION:
            raise UsageError(f"{source}: holds the components {names_of(records)}; give one as component, or {HORIZONTAL} for all of those")
        return found
    for record in records:
        if (record.component or "").casefold() == word != "":
            return [record]
    if (number := parse_whole(word or "")) and number <= len(records):
        return [records[number - 1]]
    known = names_of(records) if records[0].component is not None else "1, the only one, which has no name"
    raise NoComponent(f"{source}: component: found {component!r}; expected {known}, {HORIZONTAL} and {ALL}")


def vertical_of(records: Sequence[Record]) -> Record:
    """The one vertical component of a file. Raises UsageError if it has none or several."""
    found = [r for r in records if is_vertical(r)]
    if len(found) != 1:
        held = f"{len(found)} vertical components ({names_of(found)})" if found else f"no vertical component, only {names_of(records)}"
        raise UsageError(f"{records[0].source}: holds {held}; expected one where `vertical` is {STATION}")
    return found[0]


def names_of(records: Sequence[Record]) -> str:
    """The names of these components in their file."""
    return ", ".join(r.component or "one without a name" for r in records)
