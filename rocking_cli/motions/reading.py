"""The motion of a file, scaled. The content of the file shows if it is a motion document or a record."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..documents.document import documents_of
from ..documents.files import read_bytes
from ..documents.quantities import parse_quantity
from ..errors import DocumentError, UsageError
from .biaxial import with_vertical
from .intensity import intensity
from .motion import Motion
from .motion_document import build_motion
from .polyline import record_motion
from .records import Record, pick, records_of
from .records.components import vertical_of

LONG, _BYTES = 5_000_000, 200  # a record with so many samples gets a remark on memory; bytes for each sample
MEASURES = {"PGA": "acceleration", "PGV": "velocity", "PGD": "length", "Arias": "velocity", "CAV": "velocity"}  # dimensions by name


def read_motion(
    path: str | Path,
    *,
    component: str | None = None,
    unit: str | None = None,
    dt: float | None = None,
    scale: float | None = None,
    scale_to: str | None = None,
    vertical: float | None = None,
    tell: Callable[[str], None] | None = None,
) -> Motion:
    """The motion of a motion document or a record, times `scale`, which may be negative; path `-` is standard input.

    For a record only: component of a file with several; unit and dt [s] of a file of plain numbers; scale_to, instead of `scale`: a
    text such as `PGA=0.35g`; vertical: factor of the vertical component of the same file, which is added; tell: called with each
    remark about the record. Raises UsageError if the file cannot be read or an option does not apply, and DocumentError.

    >>> read_motion('configs/motions/two_pulses.yaml').name
    'Two pulses'
    >>> motion = read_motion('configs/motions/synthetic.at2', scale_to='PGA=0.35g')
    >>> round(motion.acceleration, 6)  # the peak in m/s2
    3.4335
    """
    source, raw = read_bytes(path)
    records = records_of(source, raw, unit=unit, dt=dt)
    if records is not None:
        record = pick(records, component)
        if tell is not None:
            for remark in remarks_on(record):
                tell(f"{source}: {remark}")
        motion = record_motion(record, factor_of(record, scale, scale_to))
        return motion if vertical is None else with_vertical(motion, record_motion(vertical_of(records)), vertical)
    of_records = {"component": component, "unit": unit, "dt": dt, "scale_to": scale_to, "vertical": vertical}
    return motion_of(source, raw, scale=scale, **of_records)


def motion_of(source: str, raw: bytes, *, scale: float | None = None, **of_records: Any) -> Motion:
    """The motion of the bytes of a document, times `scale`. Raises DocumentError, and UsageError if an option of records is given."""
    documents = documents_of(source, raw)
    if len(documents) > 1:
        raise DocumentError(f"{documents[1].place}: a second document; a motion file holds one")
    motion = build_motion(documents[0])
    for name, given in of_records.items():
        if given is not None:
            raise UsageError(f"{source}: found a motion document; `{name}` applies to a record only")
    return motion if scale is None else motion.scaled(scale)


def remarks_on(record: Record) -> tuple[str, ...]:
    """The remarks on a record, one sentence each; for a long record also the memory that a response needs."""
    if record.npts < LONG:
        return record.remarks
    memory = f"{record.npts:,} samples; a response to them takes about {_BYTES * record.npts / 1e9:.2g} GB of memory"
    return (*record.remarks, memory)


def factor_of(record: Record, scale: float | None, scale_to: str | None) -> float:
    """The factor from `--scale` or `--scale-to`; both may be given only if the scale is -1. Raises UsageError."""
    if scale_to is None:
        return 1.0 if scale is None else scale
    if scale not in (None, -1.0):
        raise UsageError("found both `scale` and `scale_to`; expected one of them, or both with a scale of -1, which reverses a record")
    return factor_to(record, scale_to) * (scale or 1.0)


def factor_to(record: Record, text: str) -> float:
    """The factor that scales a record to an intensity measure, such as PGA=0.35g. Raises UsageError."""
    name, equals, value = (x.strip() for x in text.partition("="))
    measure = next((m for m in MEASURES if m.casefold() == name.casefold()), None)
    if measure is None or not equals:
        raise UsageError(f"`scale_to`: found {text!r}; expected MEASURE=VALUE, such as PGA=0.35g, with one of {', '.join(MEASURES)}")
    try:
        wanted = parse_quantity(value, MEASURES[measure])
    except ValueError as error:
        raise UsageError(f"`scale_to` {measure}: found {value!r}; expected {error}") from None
    own = float(getattr(intensity(record), measure.casefold()))
    if not own > 0.0:
        raise UsageError(f"`scale_to`: the record has a {measure} of {own:g}; expected a non-zero {measure}")
    if not wanted > 0.0:
        raise UsageError(f"`scale_to`: found {text!r}; expected a positive intensity; a scale of -1 reverses a record")
    ratio = wanted / own
    return math.sqrt(ratio) if measure == "Arias" else ratio
