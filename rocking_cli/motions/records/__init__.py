"""Recorded ground motions: a reader for each format, told apart by what a file holds and never by its name.

A new format is one module with NAME, recognise(head) and read(text), and one word in FORMATS. recognise returns True for the first
characters of a file of the format; read takes a `RecordText` and returns a list of `Series`. An installed package adds a format by an
entry point, a module or an object with the same three names:

    [project.entry-points."rocking.records"]
    ours = "my_package.ours"

Entry points are read only for a file that no format of FORMATS recognises, and before it is taken for plain columns of numbers.
"""

from __future__ import annotations

import gzip
import hashlib
import re
import sys
import zlib
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...documents.quantities import UNITS
from ...errors import DocumentError, NoAcceleration, UsageError
from ...plugins import blamed, installed
from .components import pick
from .opening import STDIN, read_bytes, refuse_binary, unpacked
from .record import Record, Series, record_of
from .text import HEAD, RecordText

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = [
    "FORMATS",
    "Record",
    "Series",
    "demand_unit",
    "is_record",
    "pick",
    "read_bytes",
    "read_record",
    "read_records",
    "records_of",
    "unknown",
]

GROUP = "rocking.records"
FORMATS = ("esm", "cosmos", "geonet", "smc", "csmip", "volume1", "cwb", "knet", "afad", "peer")
_DOCUMENT = re.compile(r"^[\s{\"']*kind[\"']?\s*:", re.MULTILINE)
_UNCORRECTED = re.compile(
    r"\A\s*(?:\d\s+)?(?:UNCORRECTED ACCELER(?:OGRAM|ATION)|RAW ACCELERATION(?! COUNTS)|\* VOL1DS)\b"
    r"|^(?:DATA_TYPE:\s*UNPROCESSED|PROCESSING:\s*NONE)\b",
    re.IGNORECASE | re.MULTILINE,
)  # the first words of a file, or among the keys of ESM and ITACA


@cache
def _formats() -> tuple[Any, ...]:
    """The modules of FORMATS, imported when the first file is read."""
    return tuple(import_module(f"{__name__}.{name}") for name in FORMATS)


def demand_unit(unit: str | None) -> None:
    """Raise UsageError unless the unit of plain numbers is one of acceleration, or None."""
    if unit is not None and unit not in UNITS["acceleration"]:
        raise UsageError(f"`unit`: found {unit!r}; expected {', '.join(UNITS['acceleration'])}")


def records_of(source: str, raw: bytes, *, unit: str | None = None, dt: float | None = None, named: bool = True) -> list[Record] | None:
    """Every component of a file, or None where it has no record format; for plain text its unit, and dt [s] of a single column.

    named: false for a file of a directory, where uncorrected accelerograms may lie beside the corrected ones, and records that state
    their unit beside plain numbers.
    Raises DocumentError where a file of a record format is not valid, or holds counts, NoAcceleration for an uncorrected one that is not
    named, and UsageError for an unknown unit.
    """
    demand_unit(unit)
    from . import plain

    sha256 = hashlib.sha256(raw).hexdigest()
    raw = unpacked(source, raw)
    refuse_binary(source, raw)
    text = RecordText(source, raw)
    found: Any = next((f for f in _formats() if f.recognise(text.head)), None)
    entry = None if found is not None else _added(source, text.head)
    name = "record" if source == STDIN else Path(Path(source).name.removesuffix(".gz")).stem
    with nullcontext() if entry is None else _blamed(source, entry):
        if entry is not None:
            found = entry.load()
        if found is not None:
            if named and (unit is not None or dt is not None):
                raise UsageError(f"{source}: states its own `unit` and `dt` ({found.NAME}); they are given with plain numbers only")
            uncorrected = _UNCORRECTED.search(text.head)
            if uncorrected and not named:
                raise NoAcceleration(f"{source}: an uncorrected accelerogram, which is taken where the file itself is named")
            read = found.read(text)
            if not (isinstance(read, list) and read and all(isinstance(s, Series) for s in read)):
                raise TypeError(f"read returns {type(read).__name__}; expected a list of Series, one or more")
            series = [s._replace(remark="an uncorrected accelerogram") if uncorrected else s for s in read]
        elif plain.recognise(text.head):
            found, series = plain, plain.read(text, unit, dt)
        else:
            return None
        return [record_of(s, name, found.NAME, source, sha256) for s in _distinct(series)]


@cache
def _entries(_: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    """The entry points of formats, read once for each search path of modules."""
    return tuple(installed(GROUP).values())


def _added(source: str, head: str) -> EntryPoint | None:
    """The entry point of the first package that recognises a file, None for a document. Raises DocumentError for a package that fails."""
    for entry in () if _DOCUMENT.search(head) else _entries(tuple(sys.path)):
        with _blamed(source, entry):
            found = entry.load()
            if not (isinstance(getattr(found, "NAME", None), str) and callable(getattr(found, "read", None))):
                raise TypeError(f"{entry.value} has no NAME, a text, or no read(text)")
            if found.recognise(head):
                return entry
    return None


def _blamed(source: str, entry: EntryPoint) -> AbstractContextManager[None]:
    return blamed(entry, lambda found: DocumentError(f"{source}: the record format {found}; expected a package that works"))


def read_records(path: str | Path, *, component: str | None = None, unit: str | None = None, dt: float | None = None) -> list[Record]:
    """The components of a record file, or the one that is asked for. Raises UsageError and DocumentError."""
    source, raw = read_bytes(path)
    records = records_of(source, raw, unit=unit, dt=dt)
    if records is None:
        raise DocumentError(unknown(source, raw))
    return records if component is None else [pick(records, component)]


def read_record(path: str | Path, *, component: str | None = None, unit: str | None = None, dt: float | None = None) -> Record:
    """The one record of a file. Raises UsageError where it holds several and no component is asked for, and DocumentError.

    >>> record = read_record('configs/motions/synthetic.at2')
    >>> record.npts, record.dt
    (1600, 0.01)
    """
    return pick(read_records(path, unit=unit, dt=dt), component)


def unknown(source: str, raw: bytes) -> str:
    """The message for a file whose format `records_of` does not recognise."""
    first = raw[:200].decode("latin-1").strip().split("\n", 1)[0].strip()[:60]
    formats = f"{', '.join(f.NAME for f in _formats())} and plain columns of numbers"
    return f"{source}: no record format (it begins with {first!r}); expected {formats}"


def is_record(path: str) -> bool:
    """True if a file begins as a record does; only its beginning is read. Structure and motion documents are not records."""
    with open(path, "rb") as file:
        head = file.read(2)
        file.seek(0)
        try:
            raw = gzip.GzipFile(fileobj=file).read(HEAD) if head == b"\x1f\x8b" else file.read(HEAD)
        except (OSError, EOFError, zlib.error):
            return False
    from . import plain

    text = RecordText(path, raw).head
    if any(f.recognise(text) for f in _formats()):
        return True
    return not _DOCUMENT.search(text) and (plain.recognise(text) or _added(path, text) is not None)


def _distinct(series: list[Series]) -> list[Series]:
    """Components of equal names, or of none among several, told apart by their number in the file."""
    names = [s.component for s in series]
    alone = [names.count(name) == 1 and (name is not None or len(names) == 1) for name in names]
    return [
        s if one else s._replace(component=f"{s.component or 'channel'} ({i})")
        for i, (s, one) in enumerate(zip(series, alone, strict=True), 1)
    ]
