"""The partial file of a sweep: its name, its lock, and the outputs that are refused.

A process locks its partial file; another process then finds it in use and changes
nothing. On a file system without locks, two sweeps of one output are only detected at
their end.
"""

import io
import os
import time
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

from ...errors import OutputError, UsageError
from ...publishing import check_target, followed, kind_of

# s: a process that only tests for use of a partial file locks it for an instant
_PATIENCE = 0.3
# far behind the end of a file: on Windows nobody else can read the byte that is locked
_LOCKED_BYTE = 1 << 43
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
    refuse_existing(output, partial if partial.exists() else None, overwrite, resume)
    return partial


def refuse_existing(
    path: Path, partial: Path | None, overwrite: bool, resume: bool
) -> None:
    """Raise UsageError for an output or a partial file that must not be replaced;
    partial: None if there is none.
    """
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
        with SpectraFile(path, any_kind=True) as file:
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
    it, True also on a file system without locks.
    """
    end = time.monotonic() + _PATIENCE
    while True:
        try:
            _lock(file)
            return True
        except (BlockingIOError, PermissionError):
            if time.monotonic() > end:
                return False
            time.sleep(0.02)
        except OSError:  # a file system without locks
            return True


def _lock(file: BinaryIO) -> None:
    """Lock an open file. Raises BlockingIOError or PermissionError if another process
    has locked it, OSError.
    """
    try:
        import fcntl
    except ImportError:
        msvcrt: Any = import_module("msvcrt")
        file.seek(_LOCKED_BYTE)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def open_locked(path: Path) -> tuple[BinaryIO, bool]:
    """Open and lock a partial file; return (the file, True if it is new). Raises
    OutputError if another process has locked it, OSError.
    """
    end = time.monotonic() + _PATIENCE
    while time.monotonic() <= end:
        try:
            file, new = io.FileIO(path, "x+"), True
        except FileExistsError:
            file, new = io.FileIO(path, "r+"), False
        if not _locked(file):
            file.close()
            break
        if is_there(file, path):
            return file, new
        file.close()
    raise OutputError(f"{path}: is in use by another process")


def is_there(file: BinaryIO, path: Path) -> bool:
    """True if this name still belongs to the open file, so that nobody has removed or
    replaced it.
    """
    with suppress(FileNotFoundError):
        return os.path.samestat(os.lstat(path), os.fstat(file.fileno()))
    return False
