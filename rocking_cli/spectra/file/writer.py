"""The writer of a spectra file: it appends chunks to the partial file, and at the end
writes the HDF5 file from it.

The partial file is the layout of the file to come, and behind it an entry for each
chunk that is done. Entries are only appended and have checksums, so a kill loses at
most the last entry, and a flipped bit only its chunk. A process locks its partial file;
another process then finds it in use and changes nothing. On a system without locks, two
sweeps of one output are only detected at their end.
"""

import io
import json
import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, cast

import h5py
import numpy as np

from ...errors import OutputError, UsageError
from ...publishing import check_target, followed, kind_of, published
from ..scene import Unit
from ..work.machine import machine, together, unlike
from .integrity import (
    NOTE,
    SIGNATURE,
    Log,
    digest,
    digest_line,
    entry_of,
    read,
    reason,
    write,
)
from .layout import BOOKKEEPING, FileLayout, Packed, checksum, joined, split

# s: a process that only tests for use of a partial file locks it for an instant
PATIENCE = 0.3
_OF_OTHERS = {
    ".csv",
    ".json",
    ".jsonl",
    ".txt",
    ".tsv",
    ".xlsx",
    ".yaml",
    ".yml",
    ".png",
    ".svg",
    ".pdf",
    ".html",
}


def check_output(path: Path, overwrite: bool, resume: bool = False) -> Path:
    """Refuse an output that cannot or must not be written, before any work is done, and
    return the name of its partial file. Raises UsageError, and OutputError if another
    process writes the output or, with resume, if the file there is damaged.
    """
    if path.suffix.lower() in _OF_OTHERS:
        raise UsageError(
            f"{path}: the output is HDF5; found the ending {path.suffix}; give a name"
            f" such as {path.stem}.h5"
        )
    check_target(path, overwrite=True)
    output = followed(path)
    partial = output.with_name(output.name + ".part")
    if kind := kind_of(partial):
        raise UsageError(
            f"{partial}: is {kind}, but a partial file must have this name; give"
            " another output"
        )
    if partial.exists() and not (overwrite or resume):
        with open(partial, "rb") as file:
            if not _locked(file):
                raise OutputError(f"{partial}: is in use by another process")
    _refuse_existing(output, partial if partial.exists() else None, overwrite, resume)
    return partial


def _refuse_existing(
    path: Path, partial: Path | None, overwrite: bool, resume: bool
) -> None:
    if overwrite:
        return
    if os.path.lexists(path):
        if resume:
            _require_whole(path)
        raise UsageError(
            f"{path}: exists{' and is complete' if resume else ''}; use `overwrite` to"
            " replace it"
        )
    if partial is not None and not resume:
        raise UsageError(
            f"{partial}: exists, left by a sweep that did not finish; `resume` goes on"
            " with it, `overwrite` begins anew"
        )


def _require_whole(path: Path) -> None:
    """Raise OutputError unless a file is a finished spectra file without damage."""
    from .reader import SpectraFile

    try:
        with SpectraFile(path) as file:
            if file.digest is None:
                raise OutputError(f"{path}: is a partial file")
            if damaged := file.damaged_chunks():
                raise OutputError(
                    f"{path}: is damaged: {len(damaged)} of its chunks are not as they"
                    " were written"
                )
    except OutputError as error:
        raise OutputError(f"{error}; use `overwrite` to replace it") from None


def _locked(file: BinaryIO) -> bool:
    """Lock an open file for this process. Returns False if another process has locked
    it, True also on a system without locks.
    """
    try:
        import fcntl
    except ImportError:
        return True
    end = time.monotonic() + PATIENCE
    while True:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        except BlockingIOError:
            if time.monotonic() > end:
                return False
            time.sleep(0.02)
        except OSError:  # a file system without locks
            return True


def _opened(path: Path) -> tuple[BinaryIO, bool]:
    """Open and lock a partial file; return (the file, True if it is new). Raises
    OutputError if another process has locked it, OSError.
    """
    end = time.monotonic() + PATIENCE
    while time.monotonic() <= end:
        try:
            file, new = io.FileIO(path, "x+"), True
        except FileExistsError:
            file, new = io.FileIO(path, "r+"), False
        if not _locked(file):
            file.close()
            break
        if _stands(file, path):
            return file, new
        file.close()
    raise OutputError(f"{path}: is in use by another process")


def _stands(file: BinaryIO, path: Path) -> bool:
    """True if this name still belongs to the open file, so that nobody has removed or
    replaced it.
    """
    with suppress(FileNotFoundError):
        return os.path.samestat(os.lstat(path), os.fstat(file.fileno()))
    return False


class SpectraWriter:
    """The one writer of a spectra file; a context manager that closes the partial file
    whatever happens. strict: refuse a partial file that was begun on a machine that
    computes differently; machines: the machines that computed the chunks, by default
    this one. Raises UsageError for an output that is refused, OutputError when the file
    is in use or cannot be written.
    """

    def __init__(
        self,
        path: Path,
        layout: FileLayout,
        *,
        overwrite: bool = False,
        resume: bool = False,
        strict: bool = False,
        machines: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        # the partial file; the finished file; whether it may replace another one
        self.part, self.output, self.overwrite = (
            check_output(path, overwrite, resume),
            followed(path),
            overwrite,
        )
        # names of the variables; grid of the chunks
        self.names, self.cut = layout.names, layout.cut
        self.whole = layout.attributes.get("shard") == "1/1"
        # counts of outcomes in each chunk of an earlier run
        self.resumed: dict[int, np.ndarray] = {}
        # True for each finished chunk, (chunks,)
        self.done = np.zeros(self.cut.size, dtype=bool)
        self.machines = together([machines or [machine()]])
        try:
            self.file, self.created = _opened(self.part)
            try:
                self._begin(layout, overwrite, resume, strict)
            except BaseException:
                self.discard()
                self.file.close()
                raise
        except OSError as error:
            raise OutputError(
                f"{self.part}: cannot be written: {error.strerror}"
            ) from None
        except ValueError as error:
            raise OutputError(
                f"{self.part}: is not a sweep that can go on ({error}); it is kept,"
                " `overwrite` begins anew"
            ) from None

    def _begin(
        self, layout: FileLayout, overwrite: bool, resume: bool, strict: bool
    ) -> None:
        """Begin the partial file, or continue it. Raises UsageError, OutputError,
        OSError, or ValueError where it cannot go on.
        """
        head = read(self.file, 0, len(SIGNATURE))
        if any(head) and head != SIGNATURE:
            raise UsageError(
                f"{self.part}: is no partial file of this program; move it away, or"
                " give another output"
            )
        begun = any(head)  # these bytes are written last
        _refuse_existing(
            self.output, self.part if begun else None, overwrite, resume
        )  # they may have appeared before it was locked
        if not (begun and resume):
            self.created = True
            image = layout.image()
            self.file.truncate(0)
            note = json.dumps(
                {"layout": digest([image]), "token": os.urandom(8).hex()}
            ).encode()
            write(
                self.file,
                len(SIGNATURE),
                image[len(SIGNATURE) :] + entry_of(NOTE, note),
            )
            write(self.file, 0, SIGNATURE)
        self.log = Log(self.file)
        if begun and resume:
            self._resume(layout, strict)
        self.log.note(computed_on=self.machines)
        # those of the machines, empty if they compute alike
        self.machine_differences = unlike(self.machines)

    def _resume(self, layout: FileLayout, strict: bool) -> None:
        """Continue a partial file of the same scene with its intact chunks. Raises
        UsageError, OutputError, OSError.
        """
        from .reader import SpectraFile

        with SpectraFile(self.part) as before:
            if (found := difference(before.scene, dict(layout.scene))) is not None:
                place, there, here = found
                raise UsageError(
                    f"{self.part}: belongs to another scene: its {place} is {there},"
                    f" that of this run {here}; `overwrite` begins anew"
                )
            shards = [
                attributes.get("shard")
                for attributes in (before.attributes, layout.attributes)
            ]
            if shards[0] != shards[1]:
                raise UsageError(
                    f"{self.part}: is of shard {shards[0]}, this call computes"
                    f" {shards[1]}; give another output"
                )
            machines = together([before.machines, self.machines])
            if strict and unlike(machines):
                raise UsageError(
                    f"{self.part}: was begun on a machine that computes differently"
                    f" ({unlike(machines)}); it is kept"
                )
            self.machines = machines
            intact = [
                int(i) for i in np.flatnonzero(before.done) if before.intact(int(i))
            ]  # a damaged chunk is computed again
            self.resumed = {i: before.outcomes(i) for i in intact}
        self.done[intact] = True
        self.file.truncate(self.log.end)

    def found(self, unit: Unit) -> np.ndarray | None:
        """Return the counts of outcomes in the resumed chunks of a unit; None unless
        all chunks of the unit are there.
        """
        chunks = {self.cut.index((i, unit.row, unit.column)) for i in unit.places}
        return (
            np.sum([self.resumed[i] for i in chunks], axis=0)
            if chunks <= self.resumed.keys()
            else None
        )

    def write(self, offset: tuple[int, ...], packed: Packed) -> None:
        """Write the packed chunk whose first cell is (place, row, column). Raises
        OutputError.
        """
        index = self.cut.index(offset)
        try:
            self.log.append(index, joined(packed))
        except OSError as error:
            kept = (
                "; the finished chunks are kept there for `resume`"
                if self.done.any()
                else ""
            )
            raise OutputError(
                f"{self.part}: cannot be written: {error.strerror}{kept}"
            ) from None
        self.done[index] = True

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Write the finished file from the partial file with the closing attributes,
        and remove the partial file. Raises OutputError.
        """
        if self.whole and not self.done.all():
            raise OutputError(
                f"{self.part}: {int((~self.done).sum())} of {self.done.size} chunks are"
                " missing; it is kept for `resume`"
            )
        unfinished = self.output.with_name(
            f"{self.output.name}.{self.log.notes['token']}.part"
        )  # the same in a resumed sweep
        try:
            with published(self.output, self.overwrite, unfinished) as file:
                self._copy_into(
                    file, {**attributes, "computed_on": json.dumps(self.machines)}
                )
        except OutputError as error:
            raise OutputError(
                f"{error}"
                f"{f'; the result is kept as {self.part}' if self.done.any() else ''}"
            ) from None
        self._remove()

    def _copy_into(self, file: BinaryIO, attributes: Mapping[str, Any]) -> None:
        """Write the HDF5 file: the layout, the finished chunks, and the digest at its
        end. Raises OutputError, OSError.
        """
        target, places = _Target(file), list[tuple[int, int]]()
        file.write(self.log.image)
        try:
            with h5py.File(target, "r+") as h5:
                tables = h5[BOOKKEEPING]
                sums = tables["chunk_checksum"][...]
                for index in map(int, np.flatnonzero(self.done)):
                    packed = split(self.log.content(index), self.names)
                    for name in self.names:
                        h5[name].id.write_direct_chunk(
                            self.cut.offset(index), packed[name], 0
                        )
                    sums[index] = checksum(packed)
                    target.check()
                tables["chunk_done"][...], tables["chunk_checksum"][...] = (
                    self.done,
                    sums,
                )
                for key, value in attributes.items():
                    h5.attrs[key] = value
            target.check()
            with h5py.File(target, "r") as h5:
                for name in self.names:
                    h5[name].id.chunk_iter(
                        lambda info: places.append((info.byte_offset, info.size))
                    )
            if len(places) != self.done.sum() * len(self.names):
                raise ValueError("chunks that were written are missing")
        except (ValueError, RuntimeError, LookupError) as error:
            target.check()
            raise OutputError(
                f"{self.part}: cannot be finished: {reason(error)}"
            ) from None
        line = digest_line(file, places)
        file.seek(0, os.SEEK_END)
        file.write(line)

    def discard(self) -> None:
        """Remove the partial file if this process has begun it."""
        if self.created:
            self._remove()

    def _remove(self) -> None:
        """Remove the partial file if it is still there."""
        if not self.file.closed and _stands(self.file, self.part):
            try:
                self.part.unlink()
            except PermissionError:  # a system that removes no open file
                self.file.close()
                self.part.unlink()

    def __enter__(self) -> "SpectraWriter":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is not None and not self.done.any():
            self.discard()  # there is nothing in it to keep
        self.file.close()


def difference(one: Any, other: Any, place: str = "") -> tuple[str, str, str] | None:
    """Return (the first place where two scenes differ, the value of each there, as JSON
    of at most 60 characters), None if they are equal. A difference in the first text of
    a list counts as one of the list; a list without lists or mappings is one value.
    """
    if one == other:
        return None
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        inner = [
            (f"{place}.{key}" if place else key, one.get(key), other.get(key))
            for key in {**one, **other}
        ]
    elif (
        isinstance(one, list)
        and isinstance(other, list)
        and any(isinstance(x, list | Mapping) for x in (*one, *other))
    ):
        if len(one) != len(other):
            return f"number of {place}", str(len(one)), str(len(other))
        places = [
            f"{place}[{i}]" if i or not isinstance(a, str) else place
            for i, a in enumerate(one)
        ]
        inner = list(zip(places, one, other, strict=True))
    else:
        first, second = (
            text if len(text) <= 60 else f"{text[:57]}..."
            for text in (json.dumps(one), json.dumps(other))
        )
        return place, first, second
    return next(filter(None, (difference(a, b, at) for at, a, b in inner)), None)


class _Target:
    """An open file for HDF5. After a fault it ignores writes and reports success, so
    that HDF5 can close its file; see `check`.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file, self._fault = file, cast(OSError | None, None)

    def check(self) -> None:
        """Raise the OSError of the first fault, if any."""
        if self._fault is not None:
            raise self._fault

    def __getattr__(self, name: str) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            try:
                return (
                    getattr(self._file, name)(*arguments) if self._fault is None else 0
                )
            except OSError as error:
                self._fault = error
                return 0

        return call
