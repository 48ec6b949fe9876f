"""Sets of records: which files a call names, and what is taken of each."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from ...errors import DocumentError, NoAcceleration, NoComponent, UsageError
from . import demand_unit, records_of, unknown
from .components import names_of
from .opening import read_bytes
from .record import Record
from .text import HEAD

Taken = TypeVar("Taken")


class NoRecord(DocumentError):
    """A file that is no record, with what it holds; quoted: the error quotes its beginning."""

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
    """What `take` makes of the records of each file, of files, directories and lists of files, also of a list on standard input.

    unit, dt [s]: of plain numbers. `tell` says which files of a directory are no record or have no acceleration or component that is
    asked for, and of which files nothing is taken; `unread` says which of a directory cannot be read or taken. Without `unread` that
    is an error, as for a file that is named. Raises UsageError, DocumentError and what `take` raises.
    """
    demand_unit(unit)
    for path, named, held in _files(paths):
        try:
            source, raw = held or read_bytes(path)
            records = records_of(source, raw, unit=unit, dt=dt, named=named)
            if records is None:
                raise NoRecord(source, raw, quoted=path in paths)  # a list may name a file that is not its reader's to see
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


def _files(paths: Sequence[str]) -> Iterator[tuple[str, bool, tuple[str, bytes] | None]]:
    """Every file, whether it was named, and what it holds where that is read already."""
    for path, named in record_files(paths):
        held = read_bytes(path) if path == "-" else None
        names = listed_in(held[1]) if held else []
        yield from ((name, True, None) for name in names) if names else [(path, named, held)]


def record_files(paths: Sequence[str]) -> Iterator[tuple[str, bool]]:
    """The files of a set, and whether they were named: of a directory all that lie in it, in order of name, unnamed; of a list file
    (one path a line, from where the list lies) those it names; and every other path itself. Raises UsageError."""
    for path in paths:
        if path != "-" and os.path.isdir(path):
            inside = sorted(os.path.join(path, name) for name in os.listdir(path) if not name.startswith("."))
            files = [x for x in inside if os.path.isfile(x) or not os.path.exists(x)]  # a link to nothing is said to be one
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
