"""The partial file of a sweep: the layout of the file to come, and behind it a record for each chunk that is done.

A record is only appended, and has a checksum, so that a kill costs the last one at most, and a flipped bit the chunk that it is in.
A process locks the partial file that it writes; another one finds it in use and touches nothing. Where the system has no locks, two
sweeps of one output are not kept apart before their end.
"""

from __future__ import annotations

import io
import json
import os
import secrets
import stat
import time
import weakref
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from ...errors import OutputError, UsageError
from ...publishing import check_target, followed, kind_of
from .appended import NOTE, SIGNATURE, Appended, head_of, layout_digest
from .digest import read

PATIENCE = 0.3  # s: a process that only looks whether a partial file is in use locks it for an instant
_OF_OTHERS = {".csv", ".json", ".jsonl", ".txt", ".tsv", ".xlsx", ".yaml", ".yml", ".png", ".svg", ".pdf", ".html"}

_open_partials: weakref.WeakSet[Partial] = weakref.WeakSet()


def partial_of(path: Path) -> Path:
    """The name of the partial file of an output."""
    return path.with_name(path.name + ".part")


def check_output(path: Path, overwrite: bool, resume: bool = False) -> None:
    """Refuse an output that cannot or must not be written, before any work is done. Raises UsageError, OutputError if it is in use or,
    with resume, if the file there is damaged."""
    if path.suffix.lower() in _OF_OTHERS:
        raise UsageError(f"{path}: what is written is HDF5, which {path.suffix} does not say; accepted is a name such as {path.stem}.h5")
    if resume and overwrite:
        raise UsageError("`resume` does not go with `overwrite`")
    check_target(path, overwrite=True)
    partial = partial_of(followed(path))
    if kind := kind_of(partial):
        raise UsageError(f"{partial}: is {kind}, where a sweep would keep its partial file; give another output")
    if partial.exists() and not (overwrite or resume):
        with open(partial, "rb") as file:
            if not locked(file):
                raise OutputError(f"{partial}: is in use by another process")
    _refuse_existing(followed(path), partial, overwrite, resume)


def _refuse_existing(path: Path, partial: Path | None, overwrite: bool, resume: bool) -> None:
    if os.path.lexists(path) and not overwrite:
        if resume:
            _demand_whole(path)
        raise UsageError(f"{path}: exists{' and is complete' if resume else ''}; `overwrite` replaces it")
    if partial is not None and partial.exists() and not (overwrite or resume):
        raise UsageError(f"{partial}: exists, left by a sweep that did not finish; `resume` goes on with it, `overwrite` begins anew")


def _demand_whole(path: Path) -> None:
    """Raise OutputError unless a file is a finished spectra file, every chunk of it as it was written."""
    from .reader import SpectraFile

    try:
        with SpectraFile(path) as file:
            damaged, finished = len(file.damaged_chunks()), file.digest is not None
    except OutputError as error:
        raise OutputError(f"{error}; `overwrite` replaces it") from None
    if damaged or not finished:
        fault = f"damaged: {damaged} of its chunks are not as they were written" if damaged else "a partial file"
        raise OutputError(f"{path}: is {fault}; `overwrite` replaces it")


def locked(file: BinaryIO) -> bool:
    """Lock an open file for this process, True also where there are no locks; False where another process has it."""
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


class Partial:
    """The partial file of an output, opened and locked for this process; `resumes`: it holds what a sweep left there, else the image.

    Raises OutputError when another process has it or it cannot be written, UsageError when it must not be begun anew.
    """

    def __init__(self, output: Path, image: bytes, *, overwrite: bool, resume: bool) -> None:
        check_output(output, overwrite, resume)
        self.output = followed(output)
        self.path, self.created = partial_of(self.output), False
        try:
            self.file = self._opened()
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be written: {error.strerror}") from None
        _open_partials.add(self)
        try:
            begun = self._begun()
            _refuse_existing(self.output, self.path if begun else None, overwrite, resume)  # what appeared before it was locked
            self.resumes = begun and resume
            if self.resumes:
                self.records = Appended(self.file)
            else:
                self._begin(image)
        except BaseException as error:
            self.discard()
            self.close()
            if isinstance(error, OSError):
                raise OutputError(f"{self.path}: cannot be written: {error.strerror}") from None
            if isinstance(error, ValueError):
                kept = "it is kept, `overwrite` begins anew"
                raise OutputError(f"{self.path}: is not a sweep that can go on ({error}); {kept}") from None
            raise

    def _opened(self) -> BinaryIO:
        """Open the partial file, a new one where there is none, and lock it, until it is the one that stands under its name."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() <= end:
            try:
                file: BinaryIO = io.FileIO(self.path, "x+")
                created = True
            except FileExistsError:
                if not stat.S_ISREG(os.lstat(self.path).st_mode):
                    break
                file, created = io.FileIO(self.path, "r+"), False
            if not locked(file):
                file.close()
                break
            if self._stands(file):
                self.created = created
                return file
            file.close()
        raise OutputError(f"{self.path}: is in use by another process")

    def _stands(self, file: BinaryIO) -> bool:
        """Whether an open file is the one that stands under the name of the partial file."""
        with suppress(FileNotFoundError):
            return os.path.samestat(os.lstat(self.path), os.fstat(file.fileno()))
        return False

    def _begun(self) -> bool:
        """Whether it holds what somebody left: its first bytes, which are written last. Raises UsageError for what no sweep left."""
        head = read(self.file, 0, len(SIGNATURE))
        if any(head) and head != SIGNATURE:
            raise UsageError(f"{self.path}: is no partial file of this program; move it away, or give another output")
        return any(head)

    def _begin(self, image: bytes) -> None:
        self.created = True
        self.file.truncate(0)
        self._write(0, bytes(len(SIGNATURE)) + image[len(SIGNATURE) :])
        self._write(0, image[: len(SIGNATURE)])
        note = json.dumps({"layout": layout_digest(image), "token": secrets.token_hex(8)}).encode()
        self._write(len(image), head_of(NOTE, note) + note)
        self.records = Appended(self.file)

    def note(self, **words: Any) -> None:
        """Say something of the whole, as JSON. Raises OSError."""
        self.append(NOTE, json.dumps(words).encode())
        self.records.notes |= words

    def append(self, index: int, content: bytes) -> None:
        """Append the record of a chunk. Raises OSError, after which the file is as it was before."""
        record, begin = head_of(index, content) + content, self.records.end
        try:
            self._write(begin, record)
        except OSError:
            with suppress(OSError):
                self.file.truncate(begin)
            raise
        self.records.end += len(record)
        if index != NOTE:
            self.records.places[index] = begin, len(record)

    def _write(self, offset: int, content: bytes) -> None:
        self.file.seek(offset)
        view = memoryview(content)
        while view:
            view = view[self.file.write(view) :]

    def discard(self) -> None:
        """Remove the partial file if this process made it, and it is still there."""
        if self.created:
            self.remove()

    def remove(self) -> None:
        """Remove the partial file if it is still there."""
        if not self.file.closed and self._stands(self.file):
            try:
                self.path.unlink()
            except PermissionError:  # a system that removes no open file
                self.file.close()
                self.path.unlink()

    def close(self) -> None:
        """Let go of the file, and with it of the lock."""
        self.file.close()


def _close_in_child() -> None:
    """A worker process must not hold the lock of a parent that has died."""
    for partial in _open_partials:
        partial.close()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_close_in_child)
