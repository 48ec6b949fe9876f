"""The partial file of a sweep: the layout of the file to come, and behind it a record for each chunk that is done.

Records are only appended and have checksums, so a kill loses at most the last record, and a flipped bit only its chunk. A process
locks its partial file; another process then finds it in use and changes nothing. On a system without locks, two sweeps of one output
are only detected at their end.
"""

from __future__ import annotations

import io
import json
import os
import secrets
import stat
import time
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from ...errors import OutputError, UsageError
from ...publishing import check_target, followed, kind_of
from .digest import digest, read
from .log import NOTE, SIGNATURE, Log, head_of, write

PATIENCE = 0.3  # s: a process that only tests for use of a partial file locks it for an instant
_OF_OTHERS = {".csv", ".json", ".jsonl", ".txt", ".tsv", ".xlsx", ".yaml", ".yml", ".png", ".svg", ".pdf", ".html"}


def partial_of(path: Path) -> Path:
    """The name of the partial file of an output."""
    return path.with_name(path.name + ".part")


def check_output(path: Path, overwrite: bool, resume: bool = False) -> None:
    """Refuse an output that cannot or must not be written, before any work is done. Raises UsageError, OutputError if it is in use or,
    with resume, if the file there is damaged."""
    if path.suffix.lower() in _OF_OTHERS:
        raise UsageError(f"{path}: the output is HDF5; found the ending {path.suffix}; give a name such as {path.stem}.h5")
    check_target(path, overwrite=True)
    partial = partial_of(followed(path))
    if kind := kind_of(partial):
        raise UsageError(f"{partial}: is {kind}, but a partial file must have this name; give another output")
    if partial.exists() and not (overwrite or resume):
        with open(partial, "rb") as file:
            if not _locked(file):
                raise OutputError(f"{partial}: is in use by another process")
    _refuse_existing(followed(path), partial if partial.exists() else None, overwrite, resume)


def _refuse_existing(path: Path, partial: Path | None, overwrite: bool, resume: bool) -> None:
    if overwrite:
        return
    if os.path.lexists(path):
        if resume:
            _demand_whole(path)
        raise UsageError(f"{path}: exists{' and is complete' if resume else ''}; `overwrite` replaces it")
    if partial is not None and not resume:
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


def _locked(file: BinaryIO) -> bool:
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
    """The partial file of an output, opened and locked for this process; log: its layout and records; resumes: an earlier sweep left
    them, else they are of this image, without a chunk.

    Raises OutputError when another process has it or it cannot be written, UsageError when it must not be begun anew.
    """

    def __init__(self, output: Path, image: bytes, *, overwrite: bool, resume: bool) -> None:
        check_output(output, overwrite, resume)
        self.output = followed(output)
        self.path, self.created = partial_of(self.output), False
        try:
            self.file = self._opened()
            begun = self._begun()
            _refuse_existing(self.output, self.path if begun else None, overwrite, resume)  # they may have appeared before it was locked
            self.resumes = begun and resume
            if not self.resumes:
                self._begin(image)
            self.log = Log(self.file)
        except BaseException as error:
            if hasattr(self, "file"):
                self.discard()
                self.file.close()
            if isinstance(error, OSError):
                raise OutputError(f"{self.path}: cannot be written: {error.strerror}") from None
            if isinstance(error, ValueError):
                raise OutputError(f"{self.path}: is not a sweep that can go on ({error}); it is kept, `overwrite` begins anew") from None
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
            if not _locked(file):
                file.close()
                break
            if self._stands(file):
                self.created = created
                return file
            file.close()
        raise OutputError(f"{self.path}: is in use by another process")

    def _stands(self, file: BinaryIO) -> bool:
        """True if an open file is the one under the name of the partial file."""
        with suppress(FileNotFoundError):
            return os.path.samestat(os.lstat(self.path), os.fstat(file.fileno()))
        return False

    def _begun(self) -> bool:
        """True if a sweep has written its layout, whose first bytes come last. Raises UsageError for the file of another program."""
        head = read(self.file, 0, len(SIGNATURE))
        if any(head) and head != SIGNATURE:
            raise UsageError(f"{self.path}: is no partial file of this program; move it away, or give another output")
        return any(head)

    def _begin(self, image: bytes) -> None:
        self.created = True
        self.file.truncate(0)
        note = json.dumps({"layout": digest([image]), "token": secrets.token_hex(8)}).encode()
        write(self.file, len(SIGNATURE), image[len(SIGNATURE) :] + head_of(NOTE, note) + note)
        write(self.file, 0, SIGNATURE)

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
