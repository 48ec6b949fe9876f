"""Reads and scales the motions and records of files; the content of a file shows which
of the two it holds.
"""

import io
import math
import os
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any, BinaryIO, TypeVar, Unpack, cast

from ..documents.files import STDIN, read_bytes
from ..documents.parsing import parse_documents
from ..documents.quantities import quantity_at
from ..documents.texts import text_of
from ..errors import (
    DocumentError,
    NoAcceleration,
    NoComponent,
    UsageError,
    did_you_mean,
)
from ..plugins import installed
from .biaxial import Upwards
from .intensity_measures import GROUP, MEASURES, measure_named
from .motion import Motion
from .motion_document import motion_of
from .recording import Recording, with_distinct_labels
from .records import (
    Given,
    Record,
    Stated,
    is_record,
    pick,
    records_of,
    unknown,
    unpacked,
)
from .records.encodings import as_utf_8
from .records.record import (
    HORIZONTAL,
    chosen,
    is_horizontal,
    is_vertical,
    names_of,
    record_motion,
    vertical_of,
)
from .records.text import HEAD

Taken = TypeVar("Taken")

LONG = 5_000_000  # a record with so many samples gets a remark on memory
_BYTES = 200  # memory for each sample
_KEYS = ("component", "unit", "column", "dt", "skip")
_BESIDE = re.compile(rf",\s*({'|'.join(_KEYS)})=([^,=]*)\Z")
_OTHER = re.compile(r"([^,]*),\s*(\w+)=[^,]*")  # an unknown key


class MotionChoices(Stated, total=False):
    """Choices for the motion of a file, the keywords of `read_motion` and
    `load_records`.

    All but `scale` and `tell` apply to records only.

    Attributes
    ----------
    component: by name or number from 1
    unit: of plain numbers, such as "cm/s2"
    dt: time step of plain numbers [s]
    column: of plain numbers, from 1; "all" where each line goes on from the last,
        "pairs" where it holds several times, each with its value
    skip: number of lines above that are not read; "4:60": 4 above and 60 below
    as_it_stands: True takes numbers that are unlike a ground motion, as of one sign
    scale: factor, which may be negative [-]
    scale_to: instead of `scale`, such as "PGA=0.35g"
    vertical: factor of the vertical component of the file, which is added [-]
    tell: called with each remark

    Examples
    --------
    >>> halved = MotionChoices(scale=0.5)
    >>> round(read_motion("configs/motions/synthetic.at2", **halved).acceleration, 4)
    1.962
    """

    component: str | None  # by name or number from 1
    scale: float | None  # factor, which may be negative [-]
    scale_to: str | None  # instead of `scale`, such as `PGA=0.35g`
    # factor of the vertical component of the file, which is added [-]
    vertical: float | None
    tell: Callable[[str], None] | None  # called with each remark


def read_motion(path: str | Path, **given: Unpack[MotionChoices]) -> Motion:
    """Return the motion of a motion document or of a record.

    Parameters
    ----------
    path
        the file, "-" for standard input
    given
        component, unit, dt [s], column, skip, as_it_stands, scale [-], scale_to,
        vertical [-] and tell, as `MotionChoices` describes them

    Returns
    -------
    Motion
        of a record in its own time, omega_g = 1 rad/s

    Raises
    ------
    UsageError
        if the file cannot be read or a choice does not apply
    DocumentError
        for faults of the file, with line and column
    MotionError
        for a scale of zero, or a record that is zero throughout

    Examples
    --------
    >>> read_motion("configs/motions/two_pulses.yaml").name
    'Two pulses'
    >>> motion = read_motion("configs/motions/synthetic.at2", scale_to="PGA=0.35g")
    >>> round(motion.acceleration, 6)  # the peak in m/s2
    3.4335
    """
    found = read_one(path, given)
    return found if isinstance(found, Motion) else found.motion


def read_one(path: str | Path, given: MotionChoices) -> Motion | Recording:
    """Return the motion of a motion document, or the record of a file. Raises as
    `read_motion`.
    """
    file, given = beside(str(path), given)
    source, raw = read_bytes(file)
    records = records_of(source, raw, Given.of(given))
    if records is None:
        return _of_document(source, raw, given)
    (recording,) = _recordings(records, [pick(records, given.get("component"))], given)
    return _scaled(recording, given)


def read_motions(
    paths: Sequence[str],
    *,
    unread: Callable[[str], None] | None = None,
    **given: Unpack[MotionChoices],
) -> Motion | tuple[Recording, ...]:
    """Return the motion of a single document, or the records of a set (see
    `record_files`). unread: called with each file of a directory that cannot be read
    (None: an error). component may also be `horizontal`, `all`, or None for each
    horizontal one of each file. Raises as `read_motion`, and UsageError without a
    record.
    """
    # components of a file have the same remarks
    given["tell"] = tell = cache(given.get("tell") or (lambda text: None))
    found: list[Recording] = []
    try:
        for path in paths:
            file, own = beside(path, given)
            take = partial(_taken, given=own)
            records = read_set([file], take, Given.of(own), tell, unread)
            found += [_scaled(r, own) for r in records]
    except NoRecord as error:
        if len(paths) > 1 or error.source not in (file, STDIN):
            raise DocumentError(f"{error}; a set holds records only") from None
        return _of_document(error.source, error.raw, own)
    if not found:
        raise UsageError(f"{', '.join(paths)}: no record among the files")
    return with_distinct_labels(found)


def _taken(records: list[Record], given: MotionChoices) -> list[Recording]:
    """The recordings of the components that are wanted; of those without a known
    direction it is told that they are left out.
    """
    component, tell = given.get("component"), given.get("tell")
    found = chosen(records, component)
    unknown = [x for x in records if not (is_horizontal(x) or is_vertical(x))]
    if component in (None, HORIZONTAL) and unknown and tell is not None:
        tell(
            f"{records[0].source}: {names_of(unknown)}: no direction is known, which"
            f" of {names_of(records)} is vertical; left out, `component` takes it"
        )
    return _recordings(records, found, given)


def beside(path: str, given: MotionChoices | None = None) -> tuple[str, MotionChoices]:
    """Return (the path of a file, the choices for it), from a text such as
    `FILE,unit=g,column=2,dt=0.01,skip=5,component=NS`, which goes before `given`.
    Raises UsageError.
    """
    own: dict[str, Any] = {}
    while not os.path.exists(path) and (stated := _BESIDE.search(path)) is not None:
        path, own[stated[1]] = path[: stated.start()], stated[2].strip()
    other = None if os.path.exists(path) else _OTHER.fullmatch(path)
    if other is not None and os.path.exists(other[1]):
        raise UsageError(
            f"{other[1]}: found {other[2]}= beside the file"
            f"{did_you_mean(other[2], _KEYS)}; expected {', '.join(_KEYS)}"
        )
    if "dt" in own:
        own["dt"] = quantity_at("`dt`", own["dt"], "time")
    return path, cast("MotionChoices", {**(given or {}), **own})


def load_records(
    paths: str | Path | Sequence[str | Path],
    *,
    unread: Callable[[str], None] | None = None,
    **given: Unpack[MotionChoices],
) -> tuple[Recording, ...]:
    """Return the records of a folder, of files, or of lists of files.

    Parameters
    ----------
    paths
        a path, or several: record files, folders, or text files that list records
    unread
        called with a sentence on each file of a folder that cannot be read; None: such
        a file is an error
    given
        component, unit, dt [s], column, skip, as_it_stands, scale [-], scale_to,
        vertical [-] and tell, as `MotionChoices` describes them; component may also be
        "horizontal", "all", or None for each horizontal one of each file

    Returns
    -------
    tuple of Recording
        with distinct labels

    Raises
    ------
    UsageError
        if a file cannot be read, a choice does not apply, there is no record, or for a
        motion document
    DocumentError
        for faults of a file, with line and column

    Examples
    --------
    >>> (record,) = load_records("configs/motions/synthetic.at2", scale=0.5)
    >>> record.label, round(record.acceleration, 3)
    ('synthetic', 1.962)
    """
    found = read_motions(
        [str(x) for x in ([paths] if isinstance(paths, str | Path) else paths)],
        unread=unread,
        **given,
    )
    if isinstance(found, Motion):
        raise UsageError(
            f"{found.name}: a motion document; expected records (read_motion takes"
            " both)"
        )
    return found


def holds_records(path: str) -> bool:
    """True if a path is a record (by its content), a directory or a list of files;
    False for standard input.
    """
    path, _ = beside(path)
    if path == "-" or not os.path.exists(path):
        return False
    return os.path.isdir(path) or (
        os.path.isfile(path)
        and (is_record(path) or next(record_files([path]))[0] != path)
    )


def _recordings(
    records: list[Record], taken: Sequence[Record], given: MotionChoices
) -> list[Recording]:
    """Recordings of the records `taken`, each with the vertical one among `records` of
    the file if its factor is given.
    """
    vertical = given.get("vertical")
    up = (
        None
        if vertical is None
        else Upwards(record_motion(vertical_of(records)), vertical)
    )
    return [Recording(record, upwards=up) for record in taken]


def _scaled(recording: Recording, given: MotionChoices) -> Recording:
    """The recording with its factor, after its remarks are told."""
    record = recording.record
    scale = given.get("scale")
    scale_to = given.get("scale_to")
    if tell := given.get("tell"):
        for remark in record.remarks:
            tell(f"{record.source}: {remark}")
        if record.npts >= LONG:
            gigabytes = _BYTES * record.npts / 1e9
            tell(
                f"{record.source}: {record.npts:,} samples; a response to them takes"
                f" about {gigabytes:.2g} GB of memory"
            )
    if scale_to is None:
        return recording if scale is None else replace(recording, factor=scale)
    if scale not in (None, -1.0):
        raise UsageError(
            "found both `scale` and `scale_to`; expected one of them, or both with a"
            " scale of -1, which reverses a record"
        )
    return replace(recording, factor=factor_to(record, scale_to) * (scale or 1.0))


def _of_document(source: str, raw: bytes, given: MotionChoices) -> Motion:
    """Return the motion of a motion document, scaled as the user asks. Raises
    DocumentError, and UsageError for choices that only a record has.
    """
    try:
        text = text_of(source, unpacked(source, raw))
        documents = parse_documents(text, source)
    except DocumentError as error:
        raise DocumentError(f"{error}, or a record of a known format") from None
    motion, scale = motion_of(documents), given.get("scale")
    for name in ("component", *Stated.__annotations__, "scale_to", "vertical"):
        if given.get(name) not in (None, False):
            raise UsageError(
                f"{source}: found a motion document; `{name}` applies to a record only"
            )
    return motion if scale is None else motion.scaled(scale)


def factor_to(record: Record, text: str) -> float:
    """Return the factor that scales a record to a measure, such as PGA=0.35g. Raises
    UsageError.
    """
    name, equals, value = (x.strip() for x in text.partition("="))
    measure = measure_named(name, "scale_to")
    if measure is None or measure.of_structure is not None or not equals:
        known = [word for word, one in MEASURES.items() if one.of_structure is None]
        words = ", ".join((*known, *installed(GROUP)))
        raise UsageError(
            f"`scale_to`: found {text!r}; expected MEASURE=VALUE, such as PGA=0.35g,"
            f" with one of {words}, SA(T) and AvgSA(T)"
        )
    wanted = quantity_at(f"`scale_to` {measure.name}", value, measure.dimension)
    own = measure.value_of_record(record)
    if not own > 0.0:
        raise UsageError(
            f"`scale_to`: the record has a {measure.name} of {own:g}; expected a"
            f" non-zero {measure.name}"
        )
    if not wanted > 0.0:
        raise UsageError(
            f"`scale_to`: found {text!r}; expected a positive intensity; a scale of -1"
            " reverses a record"
        )
    ratio = wanted / own
    return math.sqrt(ratio) if measure.power == 2.0 else ratio ** (1.0 / measure.power)


class NoRecord(DocumentError):
    """A file that is no record, with its content; quoted: the error quotes its
    beginning.
    """

    def __init__(self, source: str, raw: bytes, quoted: bool) -> None:
        super().__init__(
            unknown(source, raw) if quoted else f"{source}: no record format"
        )
        self.source, self.raw = source, raw


def read_set(
    paths: Sequence[str],
    take: Callable[[list[Record]], Sequence[Taken]],
    given: Given,
    tell: Callable[[str], None],
    unread: Callable[[str], None] | None = None,
) -> Iterator[Taken]:
    """Yield the results of the function `take` on the records of each file (see
    `record_files`); given: what the user states of each. tell: called for each file
    without results and, in a directory, without a record, acceleration or the
    component; unread: for each file of a directory that cannot be read or taken (None:
    an error). Raises UsageError, DocumentError and the errors of `take`.
    """
    for path, named, held in record_files(paths):
        try:
            source, raw = held or read_bytes(path)
            records = records_of(source, raw, given._replace(named=named))
            if records is None:
                # a list may name a file that its reader may not see
                raise NoRecord(source, raw, quoted=path in paths)
            taken = take(records)
            if not taken:
                tell(
                    f"{source}: holds {names_of(records)} and no horizontal component;"
                    " left out, `component` all takes it"
                )
        except (NoAcceleration, NoComponent, NoRecord) as error:
            if named:
                raise
            tell(
                f"{path}: left out, no record format"
                if isinstance(error, NoRecord)
                else f"{error}; left out"
            )
        except (DocumentError, UsageError) as error:
            if named or unread is None:
                raise
            unread(
                f"{'' if str(error).startswith(path) else f'{path}: '}{error}; left out"
            )
        else:
            yield from taken


def record_files(
    paths: Sequence[str],
) -> Iterator[tuple[str, bool, tuple[str, bytes] | None]]:
    """Yield (path, True if the user or a list names it, (source, content) of standard
    input, else None) of each file of a set. A directory gives its files by name; a list
    file has a path on each line, relative to its folder; any other path is the file
    itself. Raises UsageError.
    """
    for path in paths:
        if path != "-" and os.path.isdir(path):
            inside = sorted(
                os.path.join(path, name)
                for name in os.listdir(path)
                if not name.startswith(".")
            )
            # reading reports a link to nothing
            files = [x for x in inside if os.path.isfile(x) or not os.path.exists(x)]
            if not files:
                raise UsageError(f"{path}: a directory without files")
            yield from ((x, False, None) for x in files)
        else:
            held, names = read_bytes(path) if path == "-" else None, list[str]()
            if held is not None:
                names = _listed(io.BytesIO(held[1]), "")
            elif os.path.isfile(path):
                with open(path, "rb") as file:
                    names = _listed(file, os.path.dirname(path))
            yield from (
                ((x, True, None) for x in names) if names else [(path, True, held)]
            )


def _listed(file: BinaryIO, folder: str) -> list[str]:
    """The files that a list names, one on each line; none if the first two do not
    exist, so it is no list.
    """
    raw = file.read(HEAD)
    names = _names(as_utf_8(raw), folder)
    if b"\0" in as_utf_8(raw) or not any(map(os.path.isfile, names[:2])):
        return []
    return _names(as_utf_8(raw + file.read()), folder)


def _names(raw: bytes, folder: str) -> list[str]:
    """Return the paths that a list of files names, also with the separator of Windows;
    empty lines and comments do not count.
    """
    lines = (
        line.strip().strip('"').replace("\\", "/")
        for line in raw.decode("utf-8", "surrogateescape").splitlines()
    )
    return [
        os.path.join(folder, line)
        for line in lines
        if line and not line.startswith("#")
    ]
