"""Sets of records: files, directories and lists of files."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator, Sequence
from typing import BinaryIO, TypeVar

from ...documents.files import read_bytes
from ...errors import DocumentError, NoAcceleration, NoComponent, UsageError
from . import demand_unit, records_of, unknown
from .record import Record, names_of
from .text import HEAD

Taken = TypeVar("Taken")


class NoRecord(DocumentError):
    """A file that is no record, with its content; quoted: the error quotes its beginning."""

    def __init__(self, source: str, raw: bytes, quoted: bool) -> None:
        super().__init__(unknown(source, raw) if quoted else f"{source}: no record format")
        self.source, self.raw = source, raw


def read_set(
    paths: Sequence[str],
    take: Callable[[list[Record]], Sequence[Taken]],
    *,
    unit: str | None = None,
    dt: float | None = None,
    tell: Callable[[str], None],
    unread: Callable[[str], None] | None = None,
) -> Iterator[Taken]:
    """The results of `take` on the records of each file; for the paths see `record_files`. unit, dt [s]: of plain numbers.

    tell: called for each file of a directory that is no record or lacks an acceleration or the component, and for each file without
    results; unread: called for each file of a directory that cannot be read or taken, an error if None, as for a named file. Raises
    UsageError, DocumentError and the errors of `take`.
    """
    demand_unit(unit)
    for path, named, held in record_files(paths):
        try:
            source, raw = held or read_bytes(path)
            records = records_of(source, raw, unit=unit, dt=dt, named=named)
            if records is None:
                raise NoRecord(source, raw, quoted=path in paths)  # a list may name a file that its reader may not see
            taken = take(records)
            if not taken:
                tell(f"{source}: holds {names_of(records)} and no horizontal component; left out, `component` all takes it")
        except (NoAcceleration, NoComponent, NoRecord) as error:
            if named:
                raise
            tell(f"{path}: left out, no record format" if isinstance(error, NoRecord) else f"{error}; left out")
        except (DocumentError, UsageError) as error:
            if named or unread is None:
                raise
            unread(f"{'' if str(error).startswith(path) else f'{path}: '}{error}; left out")
        else:
            yield from taken


def record_files(paths: Sequence[str]) -> Iterator[tuple[str, bool, tuple[str, bytes] | None]]:
    """The files of a set, each with True if it was named, and with its content if it is read already (standard input).

    A directory gives its files in order of name, unnamed; a list file (a path on each line, from the folder of the list) the files
    that it names; any other path itself. Raises UsageError.
    """
    for path in paths:
        if path != "-" and os.path.isdir(path):
            inside = sorted(os.path.join(path, name) for name in os.listdir(path) if not name.startswith("."))
            files = [x for x in inside if os.path.isfile(x) or not os.path.exists(x)]  # reading reports a link to nothing
            if not files:
                raise UsageError(f"{path}: a directory without files")
            yield from ((x, False, None) for x in files)
        elif path == "-":
            held = read_bytes(path)
            names = _listed(io.BytesIO(held[1]), "")
            yield from ((x, True, None) for x in names) if names else [(path, True, held)]
        else:
            names = []
            if os.path.isfile(path):
                with open(path, "rb") as file:
                    names = _listed(file, os.path.dirname(path))
            yield from ((x, True, None) for x in names or [path])


def _listed(file: BinaryIO, folder: str) -> list[str]:
    """The files that a list names, one on each line, from a folder on; none if the first is not there, and so the file is not a list."""
    head = file.read(HEAD)
    names = _names(head, folder)
    return _names(head + file.read(), folder) if b"\0" not in head and names and os.path.isfile(names[0]) else []


def _names(raw: bytes, folder: str) -> list[str]:
    lines = (line.strip() for line in raw.decode("utf-8", "surrogateescape").splitlines())
    return [os.path.join(folder, line) for line in lines if line and not line.startswith("#")]
