"""The motion of a file: a motion document or a record, told apart by what it holds, and scaled."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from ..documents.document import documents_of
from ..documents.quantities import UNITS, parse_quantity
from ..errors import DocumentError, UsageError
from .intensity import intensity
from .motion import Motion
from .pieces import build_motion
from .polyline import record_motion
from .records import Record, pick, read_bytes, records_of

MEASURES = {"PGA": "acceleration", "PGV": "velocity", "PGD": "length", "Arias": "velocity", "CAV": "velocity"}  # and their dimensions


def read_motion(
    path: str | Path,
    *,
    component: str | None = None,
    unit: str | None = None,
    dt: float | None = None,
    scale: float | None = None,
    scale_to: str | None = None,
    tell: Callable[[str], None] | None = None,
) -> Motion:
    """The motion of a document or of a record, `-` for standard input, times `scale` (which may be negative).

    Of a record: the component, where the file holds several; unit and dt [s] of plain numbers; scale_to: `PGA=0.35g` and the like
    instead of `scale`. tell: called with what is odd about the record, in a sentence. Raises UsageError for a file that cannot be
    read or a choice that does not fit, and DocumentError.
    """
    source, raw = read_bytes(path)
    records = records_of(source, raw, unit=unit, dt=dt)
    if records is not None:
        record = pick(records, component)
        if tell is not None:
            for remark in record.remarks:
                tell(f"{source}: {remark}")
        if scale_to is not None:
            if scale is not None:
                raise UsageError("scale and scale-to do not go together: give one of them")
            scale = factor_to(record, scale_to)
        return record_motion(record, 1.0 if scale is None else scale)
    documents = documents_of(raw, source)
    if len(documents) > 1:
        raise DocumentError(f"{documents[1].place}: a second document; a motion file holds one")
    motion = build_motion(documents[0])
    for name, given in {"component": component, "unit": unit, "dt": dt, "scale-to": scale_to}.items():
        if given is not None:
            raise UsageError(f"{source}: a motion document, which has no amplitude and time of its own; {name} goes with a record")
    return motion if scale is None else motion.scaled(scale)


def factor_to(record: Record, text: str) -> float:
    """The factor by which a record is scaled to an intensity measure, such as PGA=0.35g; a negative value turns it over.

    Raises UsageError.
    """
    name, equals, value = (x.strip() for x in text.partition("="))
    measure = next((m for m in MEASURES if m.casefold() == name.casefold()), None)
    if measure is None or not equals:
        raise UsageError(f"scale-to: found {text!r}; accepted is such as PGA=0.35g, of {', '.join(MEASURES)}")
    try:
        wanted = parse_quantity(value, MEASURES[measure])
    except ValueError as error:
        raise UsageError(f"scale-to {measure}: found {value!r}; accepted is {error}") from None
    own = float(getattr(intensity(record), measure.casefold()))
    if not (wanted != 0.0 and own > 0.0):
        raise UsageError(
            f"scale-to: found {text!r} for a record of {own:g} {next(iter(UNITS[MEASURES[measure]]))}; accepted is one that is not zero"
        )
    ratio = abs(wanted) / own
    return math.copysign(math.sqrt(ratio) if measure == "Arias" else ratio, wanted)
