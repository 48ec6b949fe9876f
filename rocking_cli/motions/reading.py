"""Motions and records of files, scaled. The content of a file shows if it is a motion document or a record."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypedDict, Unpack

from ..documents.document import documents_of
from ..documents.files import STDIN, read_bytes
from ..documents.quantities import parse_quantity
from ..errors import DocumentError, UsageError
from .biaxial import Upwards
from .intensity import intensity
from .motion import Motion
from .motion_document import build_motion
from .polyline import record_motion
from .recording import Recording, with_distinct_labels
from .records import Record, is_record, pick, records_of
from .records.record import chosen, vertical_of
from .records.sets import NoRecord, read_set, record_files

LONG, _BYTES = 5_000_000, 200  # a record with so many samples gets a remark on memory; bytes for each sample
MEASURES = {"PGA": "acceleration", "PGV": "velocity", "PGD": "length", "Arias": "velocity", "CAV": "velocity"}  # dimensions by name


class Given(TypedDict, total=False):
    """Choices for the motion of a file: its factor `scale`, which may be negative, and `tell`, called with each remark.

    For records only: component by name or number; unit and dt [s] of plain numbers; scale_to, instead of `scale`: a text such as
    `PGA=0.35g`; vertical: factor of the vertical component of the same file, which is added.
    """

    component: str | None
    unit: str | None
    dt: float | None
    scale: float | None
    scale_to: str | None
    vertical: float | None
    tell: Callable[[str], None] | None


def read_motion(path: str | Path, **given: Unpack[Given]) -> Motion:
    """The motion of a motion document or a record; path `-` is standard input; given: see `Given`.

    Raises UsageError if the file cannot be read or an option does not apply, and DocumentError.

    >>> read_motion('configs/motions/two_pulses.yaml').name
    'Two pulses'
    >>> motion = read_motion('configs/motions/synthetic.at2', scale_to='PGA=0.35g')
    >>> round(motion.acceleration, 6)  # the peak in m/s2
    3.4335
    """
    source, raw = read_bytes(path)
    records = records_of(source, raw, unit=given.get("unit"), dt=given.get("dt"))
    if records is None:
        return _of_document(source, raw, given)
    (recording,) = _recordings(records, [pick(records, given.get("component"))], given)
    return _scaled(recording, given).motion


def read_motions(
    paths: Sequence[str], *, unread: Callable[[str], None] | None = None, **given: Unpack[Given]
) -> Motion | tuple[Recording, ...]:
    """The motion of a single motion document, or the records of files, directories and lists of files (see `record_files`).

    unread: called with each file of a directory that cannot be read, an error if None; given: see `Given`, but component may be
    `horizontal` or `all` too; None: each horizontal component of each file. Raises UsageError and DocumentError as `read_motion` does,
    and UsageError without a record.
    """

    def shaken(records: list[Record]) -> list[Recording]:
        return _recordings(records, chosen(records, given.get("component")), given)

    tell = given.get("tell") or (lambda text: None)
    try:
        taken = read_set(paths, shaken, unit=given.get("unit"), dt=given.get("dt"), tell=tell, unread=unread)
        found = [_scaled(recording, given) for recording in taken]
    except NoRecord as error:
        if len(paths) > 1 or error.source not in (paths[0], STDIN):
            raise DocumentError(f"{error}; a set holds records only") from None
        return _of_document(error.source, error.raw, given)
    if not found:
        raise UsageError(f"{', '.join(paths)}: no record among the files")
    return with_distinct_labels(found)


def holds_records(path: str) -> bool:
    """True if a path is a record, a directory or a list of files, by its content; false for standard input."""
    if path == "-" or not os.path.exists(path):
        return False
    return os.path.isdir(path) or (os.path.isfile(path) and (is_record(path) or next(record_files([path]))[0] != path))


def _recordings(records: list[Record], taken: Sequence[Record], given: Given) -> list[Recording]:
    """The recordings of some records of a file, with the vertical component of the file if it has a factor."""
    vertical = given.get("vertical")
    up = None if vertical is None else Upwards(record_motion(vertical_of(records)), vertical)
    return [Recording(record, upwards=up) for record in taken]


def _scaled(recording: Recording, given: Given) -> Recording:
    """The recording with its factor. Raises UsageError."""
    record, tell = recording.record, given.get("tell")
    if tell is not None:
        for remark in remarks_on(record):
            tell(f"{record.source}: {remark}")
    return replace(recording, factor=factor_of(record, given.get("scale"), given.get("scale_to")))


def _of_document(source: str, raw: bytes, given: Given) -> Motion:
    """The motion of the bytes of a document, times `scale`. Raises DocumentError, and UsageError if a choice for records is given."""
    documents = documents_of(source, raw)
    if len(documents) > 1:
        raise DocumentError(f"{documents[1].place}: a second document; a motion file holds one")
    motion, scale = build_motion(documents[0]), given.get("scale")
    for name in ("component", "unit", "dt", "scale_to", "vertical"):
        if given.get(name) is not None:
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
