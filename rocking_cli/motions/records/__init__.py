"""Recorded ground motions: a reader for each format, told apart by what a file holds and never by its name.

A new format is one module with NAME, recognise(head) and read(text), and one word in FORMATS.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import os
import re
import select
import stat
import sys
import zlib
from collections.abc import Iterator, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

from ...documents.quantities import UNITS
from ...errors import DocumentError, NoAcceleration, UsageError
from .record import Record, Series, record_of
from .text import HEAD, RecordText

__all__ = [
    "FORMATS",
    "Record",
    "is_record",
    "listed_in",
    "pick",
    "read_bytes",
    "read_record",
    "read_records",
    "record_files",
    "records_of",
    "unknown",
]

FORMATS = ("esm", "cosmos", "geonet", "smc", "csmip", "volume1", "cwb", "knet", "afad", "peer")
LARGEST = 256 << 20  # bytes of a file, unpacked
_STDIN = "<stdin>"
_PATIENCE = 2.0  # s that a pipe may be without a writer
_DOCUMENT = re.compile(r"^[\s{\"']*kind[\"']?\s*:", re.MULTILINE)
_UNCORRECTED = re.compile(
    r"\A\s*(?:\d\s+)?(?:UNCORRECTED ACCELER(?:OGRAM|ATION)|RAW ACCELERATION(?! COUNTS)|\* VOL1DS)\b"
    r"|^(?:DATA_TYPE:\s*UNPROCESSED|PROCESSING:\s*NONE)\b",
    re.IGNORECASE | re.MULTILINE,
)  # the first words of a file, or among the keys of ESM and ITACA
_COUNTS = "counts of an instrument and no unit; convert it to an acceleration with the station's response first"


def read_bytes(path: str | Path) -> tuple[str, bytes]:
    """The source's name and what the file holds, `-` for standard input. Raises UsageError, and DocumentError for one too large."""
    source = str(path)
    try:
        if source == "-":
            if sys.stdin is None:
                raise UsageError("standard input is closed")
            source, raw = _STDIN, sys.stdin.buffer.read(LARGEST + 1)
        else:
            with open(path, "rb", opener=_with_a_writer) as file:
                size = os.fstat(file.fileno()).st_size
                raw = b"" if size > LARGEST else file.read(LARGEST + 1)
    except OSError as error:
        raise UsageError(f"{source}: cannot be read: {error.strerror or error}") from None
    if len(raw) > LARGEST or (source != _STDIN and size > LARGEST):
        raise DocumentError(f"{source}: larger than {LARGEST >> 20} MiB, which no record is")
    return source, raw


def _with_a_writer(path: str, flags: int) -> int:
    """Open a file; of a pipe only one that somebody writes to, since it would be waited for without end. Raises UsageError."""
    if not stat.S_ISFIFO(os.stat(path).st_mode):
        return os.open(path, flags)
    descriptor = os.open(path, flags | os.O_NONBLOCK)
    ready = select.select([descriptor], [], [], _PATIENCE)[0]
    try:
        nobody = not ready and os.read(descriptor, 1) == b""
    except BlockingIOError:  # there is a writer, who has not begun
        nobody = False
    if nobody:
        os.close(descriptor)
        raise UsageError(f"{path}: a pipe that nobody writes to")
    os.set_blocking(descriptor, True)
    return descriptor


@cache
def _formats() -> tuple[ModuleType, ...]:
    """The modules of FORMATS, imported when the first file is read."""
    return tuple(import_module(f"{__name__}.{name}") for name in FORMATS)


def records_of(source: str, raw: bytes, *, unit: str | None = None, dt: float | None = None, named: bool = True) -> list[Record] | None:
    """Every component of a file, or None where it has no record format; for plain text its unit, and dt [s] of a single column.

    named: false for a file of a directory, where uncorrected accelerograms may lie beside the corrected ones.
    Raises DocumentError where a file of a record format is not valid, or holds counts, NoAcceleration for an uncorrected one that is not
    named, and UsageError for an unknown unit.
    """
    if unit is not None and unit not in UNITS["acceleration"]:
        raise UsageError(f"`unit`: found {unit!r}; accepted are {', '.join(UNITS['acceleration'])}")
    from . import plain

    sha256 = hashlib.sha256(raw).hexdigest()
    raw = _unpacked(source, raw)
    _refuse_binary(source, raw)
    text = RecordText(source, raw)
    found = next((f for f in _formats() if f.recognise(text.head)), None)
    if found is not None:
        if unit is not None or dt is not None:
            raise UsageError(f"{source}: states its own `unit` and `dt` ({found.NAME}); they are given with plain numbers only")
        uncorrected = _UNCORRECTED.search(text.head)
        if uncorrected and not named:
            raise NoAcceleration(f"{source}: an uncorrected accelerogram, which is taken where the file itself is named")
        series = [s._replace(remark="an uncorrected accelerogram") if uncorrected else s for s in found.read(text)]
    elif plain.recognise(text.head):
        found, series = plain, plain.read(text, unit, dt)
    else:
        return None
    name = "record" if source == _STDIN else Path(Path(source).name.removesuffix(".gz")).stem
    return [record_of(s, name, found.NAME, source, sha256) for s in _distinct(series)]


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
    """What to say of a file that `records_of` knows no format for."""
    first = raw[:200].decode("latin-1").strip().split("\n", 1)[0].strip()[:60]
    formats = f"{', '.join(f.NAME for f in _formats())} and plain columns of numbers"
    return f"{source}: no record format (it begins with {first!r}); accepted are {formats}"


def pick(records: Sequence[Record], component: str | None) -> Record:
    """The record of a component, by its name or its number from 1; None for the only one there is. Raises UsageError."""
    names = [str(r.component) for r in records]
    if component is None:
        if len(records) == 1:
            return records[0]
        raise UsageError(f"{records[0].source}: holds the components {', '.join(names)}; give one as component")
    for record in records:
        if record.component is not None and record.component.casefold() == component.strip().casefold():
            return record
    if component.strip().isdigit() and 1 <= int(component) <= len(records):
        return records[int(component) - 1]
    if len(records) == 1 and records[0].component is None:
        raise UsageError(f"{records[0].source}: component: found {component!r}; accepted is 1, the only one, which has no name")
    raise UsageError(f"{records[0].source}: component: found {component!r}; accepted are {', '.join(names)}")


def record_files(paths: Sequence[str]) -> Iterator[tuple[str, bool]]:
    """The files of a set, and whether they were named: of a directory all that lie in it, in order of name, unnamed; of a list file
    (one path a line, from where the list lies) those it names; and every other path itself. Raises UsageError."""
    for path in paths:
        if path != "-" and os.path.isdir(path):
            inside = sorted(os.path.join(path, name) for name in os.listdir(path) if not name.startswith("."))
            files = [x for x in inside if os.path.isfile(x)]
            if not files:
                raise UsageError(f"{path}: a directory without files")
            yield from ((x, False) for x in files)
        else:
            yield from ((x, True) for x in _listed(path) or [path])


def _listed(path: str) -> list[str]:
    """The files that a list names; none where the file is not a list."""
    if path == "-" or not os.path.isfile(path):
        return []
    with open(path, "rb") as file:
        head = file.read(HEAD)
        folder = os.path.dirname(path)
        return listed_in(head + file.read(), folder) if listed_in(head, folder) else []


def listed_in(raw: bytes, folder: str = "") -> list[str]:
    """The files that the text of a list names, one a line, from a folder on; none where it is not a list of files."""
    if b"\0" in raw[:HEAD]:
        return []
    begin = [line.strip() for line in raw[:HEAD].decode("utf-8", "surrogateescape").splitlines()]
    first = next((name for name in begin if name and not name.startswith("#")), "")
    if not first or not os.path.isfile(os.path.join(folder, first)):
        return []
    names = [line.strip() for line in raw.decode("utf-8", "surrogateescape").splitlines()]
    return [os.path.join(folder, name) for name in names if name and not name.startswith("#")]


def is_record(path: str) -> bool:
    """Whether the head of a file is that of a record, which is not read further; structure documents and motion documents are none."""
    with open(path, "rb") as file:
        head = file.read(2)
        file.seek(0)
        try:
            raw = gzip.GzipFile(fileobj=file).read(HEAD) if head == b"\x1f\x8b" else file.read(HEAD)
        except (OSError, EOFError, zlib.error):
            return False
    from . import plain

    text = RecordText(path, raw).head
    return any(f.recognise(text) for f in _formats()) or (plain.recognise(text) and not _DOCUMENT.search(text))


def _unpacked(source: str, raw: bytes) -> bytes:
    if not raw.startswith(b"\x1f\x8b"):
        return raw
    try:
        with gzip.open(io.BytesIO(raw)) as file:
            unpacked = file.read(LARGEST + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise DocumentError(f"{source}: a damaged gzip file ({error})") from None
    if len(unpacked) > LARGEST:
        raise DocumentError(f"{source}: larger than {LARGEST >> 20} MiB when unpacked, which no record is")
    return unpacked


def _refuse_binary(source: str, raw: bytes) -> None:
    """Raise DocumentError for an empty file, NoAcceleration for archives, SAC and miniSEED, and for all else that is no text."""
    if not (raw[:HEAD].strip() or raw.strip()):
        raise DocumentError(f"{source}: empty; accepted is a record or a motion document")
    if raw.startswith(b"PK\x03\x04") or raw[257:262] == b"ustar":
        raise NoAcceleration(f"{source}: an archive (zip or tar); unpack it and name the files in it")
    if raw[:3] == b"MS\x03" or (raw[:6].strip(b" 0123456789") == b"" and raw[6:7] in b"DRQM" and raw[7:8] in b" \0" and len(raw) >= 48):
        raise NoAcceleration(f"{source}: miniSEED, which holds {_COUNTS}")
    if len(raw) >= 632 and raw[304:308] in (b"\x06\0\0\0", b"\0\0\0\x06", b"\x07\0\0\0", b"\0\0\0\x07"):
        raise NoAcceleration(f"{source}: SAC, which holds {_COUNTS}")
    if raw[:HEAD].split(None, 6)[:5] == [b"-12345.00"] * 5 or raw[:HEAD].count(b"-12345.00") > 20:
        raise NoAcceleration(f"{source}: SAC (alphanumeric), which holds {_COUNTS}")
    if 100 * raw[:HEAD].count(0) > len(raw[:HEAD]):  # some headers of real files pad a name with a few
        raise NoAcceleration(f"{source}: a binary file; accepted is a record or a motion document in text")


def _distinct(series: list[Series]) -> list[Series]:
    """Components of equal names, or of none among several, told apart by their number in the file."""
    names = [s.component for s in series]
    alone = [names.count(name) == 1 and (name is not None or len(names) == 1) for name in names]
    return [
        s if one else s._replace(component=f"{s.component or 'channel'} ({i})")
        for i, (s, one) in enumerate(zip(series, alone, strict=True), 1)
    ]
