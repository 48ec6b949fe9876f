"""Recorded ground motions: a reader for each format. The content of a file shows its
format, never its name.

A new format is one module with NAME, recognise(head) and read(text), or several as a
tuple FORMATS, and one line in FORMATS here. recognise returns True for the first
characters of a file of the format; read takes a `RecordText` (text.py) and returns a
list of `Series` (record.py).

An installed package adds a format by an entry point, a module or an object with the
same three names:

    [project.entry-points."rocking.records"]
    ours = "my_package.ours"

ASDF is no text; its module is asked before the others. Units, directions and headings
of columns have one grammar for all formats: units.py, directions.py and headings.py;
guard.py looks at the numbers.

Entry points are read only for a file that no format of FORMATS recognises, and before
it is taken for plain columns of numbers.
"""

import gzip
import hashlib
import io
import re
import sys
import zlib
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

from ...documents.files import LARGEST, STDIN, named_after, read_bytes
from ...documents.texts import packed
from ...errors import DocumentError, NoAcceleration, UsageError
from ...plugins import blamed, installed
from . import asdf, plain
from .cut_files import cut_number
from .directions import up_in_name
from .encodings import as_utf_8
from .printed_numbers import finite_number
from .record import Given, Record, Series, pick, record_of, require_series
from .text import HEAD, RecordText, cut_lines
from .units import ACCELERATIONS

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = [
    "FORMATS",
    "Given",
    "Record",
    "Series",
    "Stated",
    "is_record",
    "pick",
    "read_record",
    "read_records",
    "records_of",
    "unknown",
    "unpacked",
]

GROUP = "rocking.records"
_PACKED = b"\x1f\x8b"  # gzip
# control characters, which a text does not contain
_CONTROL = bytes(x for x in range(32) if x not in b"\t\n\v\f\r\x1a")
_COUNTS = (
    "counts of an instrument and no unit; convert it to an acceleration with the"
    " station's response first"
)
FORMATS = (
    "keyed",
    "cosmos",
    "geonet",
    "smc",
    "csmip",
    "volume1",
    "peer",
    "csmnc",
    "asa",
    "timeseries",
)
NOTHING = Given()
_DOCUMENT = re.compile(r"^[ \t{\"']*kind[\"']?\s*:", re.MULTILINE)
# uncorrected data: first words of a file, or a key of ESM and ITACA
_UNCORRECTED = re.compile(
    r"\A\s*(?:\d\s+)?(?:UNCORRECTED ACCELER(?:OGRAM|ATION)|RAW ACCELERATION(?!"
    r" COUNTS)|\* VOL1DS)\b"
    r"|^ *UNCORRECTED ACC+ELERATION +UNIT"
    r" *:|^(?:DATA_TYPE:\s*UNPROCESSED|PROCESSING:\s*NONE)\b",
    re.IGNORECASE | re.MULTILINE,
)

_FACTOR = re.compile(
    r"\bscal(?:e|ing)[ _]factor[^\w\n]*?([-+]?[.\d]+(?:[ed][-+]?\d+)?)", re.IGNORECASE
)


def _factor(text: RecordText, form: str) -> str:
    """Return a remark on a factor other than 1 that a header states, of samples that
    the user takes as they stand; K-NET has its own line of counts. Raises
    DocumentError for other samples: no format says whether they have the factor.
    """
    found = None if form == "K-NET" else _FACTOR.search(text.head)
    if found is None or finite_number(found[1].encode()) == 1.0:
        return ""
    if not text.given.as_it_stands:
        raise text.fault(
            f"found {found[0]!r}, and no word on whether the samples have it; expected"
            " none, or `as_it_stands`, which takes them without a factor",
            text.head.count("\n", 0, found.start()) + 1 + text.given.skip,
        )
    return f"the header states {found[0]!r}; the samples do not get it"


@cache
def _formats() -> tuple[Any, ...]:
    modules = (import_module(f"{__name__}.{name}") for name in FORMATS)
    return tuple(
        found for module in modules for found in getattr(module, "FORMATS", (module,))
    )


@cache
def _entries(_: tuple[str, ...]) -> "tuple[EntryPoint, ...]":
    """The entry points of formats, read once for each search path of modules."""
    return tuple(installed(GROUP).values())


def _blamed(source: str, entry: "EntryPoint") -> AbstractContextManager[None]:
    return blamed(
        entry,
        lambda found: DocumentError(
            f"{source}: the record format {found}; expected a package that works"
        ),
    )


def _format_of(source: str, head: str) -> "tuple[Any, EntryPoint | None]":
    """(format, entry point of the package that adds it) of a file; (None, None) for a
    file without records.
    """
    short = cut_lines(head)
    for found in _formats():
        if found.recognise(short):
            return found, None
    if _DOCUMENT.search(short):
        return None, None
    for entry in _entries(tuple(sys.path)):
        with _blamed(source, entry):
            found = entry.load()
            if found.recognise(short):
                return found, entry
    return (plain if plain.recognise(head) else None), None


def _refuse_cut(source: str, content: bytes) -> None:
    """Refuse a file that ends inside a number. Raises DocumentError."""
    if (cut := cut_number(content)) is not None:
        raise DocumentError(
            f"{source}: found {cut!r} at the end of the file, which is not written as"
            " the numbers before it; the file may be cut (`as_it_stands` takes it)"
        )


def records_of(source: str, raw: bytes, given: Given = NOTHING) -> list[Record] | None:
    """Return every component of a file, or None if it has no record format.

    given: what the user states, which the file may not contradict; of a file of a
    directory (not `named`) uncorrected accelerograms are no fault, and what is stated
    belongs to plain numbers. Raises DocumentError for a file that is not valid, holds
    counts or says otherwise than the user, and NoAcceleration for an uncorrected one
    that is not named.
    """
    sha256 = hashlib.sha256(raw).hexdigest()
    name = "record" if source == STDIN else named_after(source.removesuffix(".gz"))
    content = unpacked(source, raw)

    def records(series: list[Series], form: str) -> list[Record]:
        _require_agreement(source, series, given, form)
        return [
            record_of(one, name, form, source, sha256, given.as_it_stands)
            for one in _distinct(series, source)
        ]

    if asdf.recognise(content):
        return records(asdf.read(source, content, given), asdf.NAME)
    _refuse_binary(source, as_utf_8(content))
    text = RecordText(source, content, given)
    found, entry = _format_of(source, text.head)
    if found is None:
        return None
    uncorrected = _UNCORRECTED.search(cut_lines(text.head))
    if uncorrected and not given.named and found is not plain:
        raise NoAcceleration(
            f"{source}: an uncorrected accelerogram, which is taken where the file"
            " itself is named"
        )
    with nullcontext() if entry is None else _blamed(source, entry):
        read = found.read(text)
        require_series(read)
        if not given.as_it_stands:
            _refuse_cut(source, content)
        also = "an uncorrected accelerogram" if uncorrected else ""
        about = (*text.skipped, also, _factor(text, found.NAME), text.surplus())
        series = [
            s._replace(remark="; ".join(filter(None, (*about, s.remark)))) for s in read
        ]
        return records(series, found.NAME)


def _require_agreement(
    source: str, read: list[Series], given: Given, form: str
) -> None:
    """Raise DocumentError if a file says otherwise than the user; what is stated of a
    directory belongs to the formats that may lack it.
    """
    if given.column is not None and given.named and form != plain.NAME:
        raise UsageError(
            f"{source}: `column` goes with plain columns of numbers, not with {form}"
        )
    for series in read if given.named or form in (plain.NAME, asdf.NAME) else ():
        unit = given.unit
        if unit is not None and ACCELERATIONS[unit] != ACCELERATIONS[series.unit]:
            said = f"found {unit}; the file says otherwise: {series.unit} ({form})"
            raise DocumentError(f"{source}: `unit`: {said}")
        if given.dt is not None and abs(given.dt - series.dt) > 1e-3 * series.dt:
            said = (
                f"found {given.dt:g} s; the file says otherwise: {series.dt:g} s"
                f" ({form})"
            )
            raise DocumentError(f"{source}: `dt`: {said}")


class Stated(TypedDict, total=False):
    """Keywords of what the user states of a file, the fields of `Given`."""

    unit: str | None  # unit of plain numbers
    dt: float | None  # time step of plain numbers [s]
    # column of plain numbers, from 1; `all` where each line goes on from the last;
    # `pairs` where a line holds several times, each with its value
    column: str | None
    skip: int | str  # lines above, or above and below as 4:60, which are not read
    as_it_stands: bool  # True takes numbers that are unlike a ground motion


def read_records(path: str | Path, **stated: Unpack[Stated]) -> list[Record]:
    """Return the components of a record file, also one whose `fault` says that it is
    no ground motion. Raises UsageError and DocumentError.
    """
    source, raw = read_bytes(path)
    records = records_of(source, raw, Given.of(stated))
    if records is None:
        raise DocumentError(unknown(source, raw))
    return records


def read_record(
    path: str | Path,
    *,
    component: str | None = None,
    unit: str | None = None,
    dt: float | None = None,
    column: str | None = None,
    skip: int | str = 0,
    as_it_stands: bool = False,
) -> Record:
    """Return one record of a file.

    The format is found from what the file holds; `rocking help records` lists them.

    Parameters
    ----------
    path
        the file
    component
        which of several, by name or number from 1
    unit
        of plain columns of numbers, such as "cm/s2"
    dt
        time step of plain columns of numbers [s]
    column
        of plain columns of numbers, from 1; "all" where each line goes on from the
        last, "pairs" where it holds several times, each with its value
    skip
        number of lines above that are not read; "4:60": 4 above and 60 below
    as_it_stands
        True takes numbers that are unlike a ground motion, as of one sign

    Returns
    -------
    Record

    Raises
    ------
    UsageError
        if the file cannot be read, or holds several records and `component` names none
    DocumentError
        for a file of no known format and for its faults

    Examples
    --------
    >>> record = read_record("configs/motions/synthetic.at2")
    >>> record.npts, record.dt
    (1600, 0.01)
    """
    found = read_records(
        path, unit=unit, dt=dt, column=column, skip=skip, as_it_stands=as_it_stands
    )
    return pick(found, component)


def record_from(given: Record | str | Path) -> Record:
    """Return the record itself, or that of a path, as `read_record` does."""
    return read_record(given) if isinstance(given, str | Path) else given


def unknown(source: str, raw: bytes) -> str:
    """Return the message for a file of no known format."""
    try:
        content = unpacked(source, raw)[: 1 << 12]
    except DocumentError:
        content = raw
    first = RecordText(source, content).head.strip().split("\n", 1)[0].strip()[:60]
    formats = f"{', '.join(f.NAME for f in _formats())} and plain columns of numbers"
    return f"{source}: no record format (it begins with {first!r}); expected {formats}"


def is_record(path: str) -> bool:
    """True if a file begins as a record does, and not as a structure or a motion
    document.
    """
    with open(path, "rb") as file:
        begin = file.read(8)
        file.seek(0)
        if asdf.recognise(begin):
            return asdf.recognise(file.read())
        gzipped = begin.startswith(_PACKED)
        try:
            raw = (gzip.GzipFile(fileobj=file) if gzipped else file).read(HEAD)
        except (OSError, EOFError, zlib.error):
            return False
    return _format_of(path, RecordText(path, raw).head)[0] is not None


def _distinct(series: list[Series], source: str) -> list[Series]:
    """The series with distinct components: an equal or absent name among several
    becomes its number in the file; that of one may be vertical by the name of the file.
    """
    names = [s.component for s in series]
    if names == [None]:
        return [series[0]._replace(component=up_in_name(source))]
    numbered = (
        s._replace(component=f"{s.component or 'channel'} ({i})")
        for i, s in enumerate(series, 1)
    )
    return [
        s if s.component is not None and names.count(s.component) == 1 else other
        for s, other in zip(series, numbered, strict=True)
    ]


def unpacked(source: str, raw: bytes) -> bytes:
    if not raw.startswith(_PACKED):
        return raw
    try:
        with gzip.open(io.BytesIO(raw)) as file:
            unpacked = file.read(LARGEST + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise DocumentError(f"{source}: a damaged gzip file ({error})") from None
    if len(unpacked) > LARGEST:
        raise DocumentError(
            f"{source}: larger than {LARGEST >> 20} MiB when unpacked, the limit of a"
            " file"
        )
    return unpacked


def _refuse_binary(source: str, raw: bytes) -> None:
    """Raise DocumentError for an empty file, NoAcceleration for archives, SAC, miniSEED
    and all else that is no text.
    """
    if not (raw[:HEAD].strip() or raw.strip()):
        raise DocumentError(f"{source}: empty; expected a record or a motion document")
    if found := packed(raw):
        raise NoAcceleration(
            f"{source}: found {found[0]}; expected a record in text: {found[1]}"
        )
    # the version of a SAC header (6 or 7), in either order of bytes
    sac = raw[304:308].strip(b"\0") in (b"\x06", b"\x07") and len(raw) >= 632
    # -12345 is the undefined value of a SAC header
    sac = sac or raw[:HEAD].count(b"-12345.00") > 20
    seed = raw[:6].strip(b" 0123456789") == b"" and raw[6:7] in b"DRQM"
    seed = seed and raw[7:8] in b" \0" and len(raw) >= 48
    if sac or seed or raw[:3] == b"MS\x03":
        form = "SAC" if sac else "miniSEED"
        raise NoAcceleration(f"{source}: {form}, which holds {_COUNTS}")
    control = len(raw[:HEAD]) - len(raw[:HEAD].translate(None, _CONTROL))
    # The headers of some real files have a few of these to fill up a name.
    if 100 * control > len(raw[:HEAD]):
        raise NoAcceleration(
            f"{source}: a binary file; expected a record or a motion document in text"
        )
