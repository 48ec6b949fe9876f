"""The file of a sweep on the disk: who may write it, what HDF5 sees of it, and how it takes its final name.

A part is locked by the process that writes it from the moment it is opened to the moment it is published; every other process finds
it in use and touches nothing.
"""

from __future__ import annotations

import errno
import os
import time
import weakref
from contextlib import suppress
from pathlib import Path

from ..errors import OutputError, UsageError
from ..publishing import check_target, followed, kind_of
from .raw_file import PATIENCE, SIGNATURE, RawFile, lock, open_regular
from .seal import read

_NO_LINKS = (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK, errno.ENOTSUP)

_OF_OTHERS = {".csv", ".json", ".jsonl", ".txt", ".tsv", ".xlsx", ".yaml", ".yml", ".png", ".svg", ".pdf", ".html"}

_open_parts: weakref.WeakSet[Part] = weakref.WeakSet()


def part_of(path: Path) -> Path:
    """The name a spectra file has while it is being written."""
    return path.with_name(path.name + ".part")


def check_output(path: Path, overwrite: bool, resume: bool = False) -> None:
    """Refuse an output that cannot or must not be written, before any work is done. Raises UsageError, OutputError if in use or, with
    resume, if what stands there is damaged."""
    if path.suffix.lower() in _OF_OTHERS:
        raise UsageError(f"{path}: what is written is HDF5, which {path.suffix} does not say; accepted is a name such as {path.stem}.h5")
    if resume and overwrite:
        raise UsageError("`resume` does not go with `overwrite`")
    check_target(path, overwrite=True)
    path = followed(path)
    part = part_of(path)
    try:
        if kind := kind_of(part):
            raise UsageError(f"{part}: is {kind}, where a sweep would keep what is done; give another output")
        if os.path.exists(part) and not (overwrite or resume) and _locked(part):
            raise OutputError(f"{part}: is in use by another process")
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}") from None
    _refuse_existing(path, overwrite, resume)


def _refuse_existing(path: Path, overwrite: bool, resume: bool, own_part: bool = False) -> None:
    if os.path.lexists(path) and not overwrite:
        if resume:
            _demand_whole(path)
        raise UsageError(f"{path}: exists{' and is complete' if resume else ''}; `overwrite` replaces it")
    part = part_of(path)
    if os.path.lexists(part) and not (overwrite or resume or own_part):
        raise UsageError(f"{part}: exists, left by a sweep that did not finish; `resume` goes on with it, `overwrite` begins anew")


def _demand_whole(path: Path) -> None:
    """Raise OutputError unless a file is a finished spectra file, every chunk of it as it was written."""
    from .reader import SpectraFile

    try:
        with SpectraFile(path) as file:
            damaged = len(file.damaged_chunks())
            fault = f"is damaged: {damaged} of its chunks are not what was written" if damaged else ""
            if not (fault or file.sealed or file.complete):
                fault = f"is not complete: {int((~file.done).sum())} of its {file.done.size} chunks are missing"
    except OutputError as error:
        raise OutputError(f"{error}; `overwrite` replaces it") from None
    if fault:
        raise OutputError(f"{path}: {fault}; `overwrite` replaces it")


def _locked(part: Path) -> bool:
    descriptor = open_regular(part)
    try:
        return not lock(descriptor, shared=True)
    finally:
        os.close(descriptor)


class Part:
    """The part of an output, opened and locked for this process; `resumes`: it holds what a sweep left there, else the given image.

    Raises OutputError when another process has it or it cannot be written, UsageError when it must not be begun anew.
    """

    def __init__(self, output: Path, image: bytes, *, overwrite: bool, resume: bool) -> None:
        check_output(output, overwrite, resume)
        self.output = followed(output)
        self.part, self.overwrite, self.descriptor, self.created = part_of(self.output), overwrite, -1, False
        _open_parts.add(self)
        try:
            there = self._appear(image)
            self.created = there or self._open()
            _refuse_existing(self.output, overwrite, resume, self.created)  # what appeared before the lock was held
            self.resumes = not (overwrite or self.created) and self._begun(len(image))
            if not (there or self.resumes):
                self._begin(image)
        except BaseException as error:
            self.discard()
            self.close()
            if isinstance(error, OSError):
                raise OutputError(f"{self.part}: cannot be written: {error.strerror}") from None
            raise

    def _appear(self, image: bytes) -> bool:
        """Where the system can, write the image to a file without a name, of which a kill leaves nothing, and then name it."""
        if not hasattr(os, "O_TMPFILE") or os.path.lexists(self.part):
            return False
        try:
            self.descriptor = os.open(self.part.parent, os.O_RDWR | os.O_TMPFILE | os.O_CLOEXEC, 0o666)
        except OSError:
            return False
        self._lock()
        self._write(image)
        try:  # a folder's descriptor makes Python follow the link, which an absolute name then has no need of
            os.link(f"/proc/self/fd/{self.descriptor}", self.part, src_dir_fd=self.descriptor, follow_symlinks=True)
        except OSError:  # somebody else was faster, or there is no such name here
            self.close()
            return False
        return True

    def _lock(self) -> bool:
        try:
            return lock(self.descriptor)
        except OutputError as error:
            raise OutputError(f"{self.part}: {error}") from None

    def _open(self) -> bool:
        """Open and lock the part, until it is the one that stands under its name; whether it is new."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() <= end:
            created = True
            try:
                self.descriptor = os.open(self.part, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
            except FileExistsError:
                created = False
                with suppress(FileNotFoundError):
                    self.descriptor = open_regular(self.part, os.O_RDWR | os.O_NOFOLLOW)
            if self.descriptor < 0:
                continue
            self.created = created
            if not self._lock():
                break
            if self.in_place():
                if created or not self.overwrite or os.fstat(self.descriptor).st_nlink == 1:
                    return created
                os.unlink(self.part)  # a second name of a finished file, which a kill left; the file itself stays
            self.close()
        self.close()
        raise OutputError(f"{self.part}: is in use by another process")

    def in_place(self) -> bool:
        """Whether the open file is the one that stands under the part's name."""
        try:
            there = os.stat(self.part, follow_symlinks=False)
        except FileNotFoundError:
            return False
        return os.path.samestat(there, os.fstat(self.descriptor))

    def _begun(self, layout: int) -> bool:
        """Whether it holds what a sweep left: more than a layout of so many bytes that never came to its signature."""
        return any(read(self.descriptor, 0, len(SIGNATURE))) or os.fstat(self.descriptor).st_size > layout

    def _begin(self, image: bytes) -> None:
        self.created = True
        os.ftruncate(self.descriptor, 0)
        self._write(image)

    def _write(self, image: bytes) -> None:
        """Make the part these bytes, its signature last: a part without is not begun."""
        raw = RawFile(self.descriptor)
        raw.reserve(len(image))
        raw.seek(len(SIGNATURE))
        raw.write(image[len(SIGNATURE) :])
        raw.seek(0)
        raw.write(image[: len(SIGNATURE)])

    def publish(self) -> None:
        """Make the part durable and give it its final name. Raises OutputError; what cannot be published is kept."""
        kept = f"the result is kept as {self.part}"
        try:
            os.fsync(self.descriptor)
            if not self.in_place():
                kept = f"{self.part} has vanished meanwhile, or is another's"
                raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
            if self.overwrite and os.path.lexists(self.output):
                if kind := kind_of(self.output):
                    raise OutputError(f"{self.output}: is {kind}; {kept}")
                os.replace(self.part, self.output)
            else:
                self._rename()
            _make_durable(self.output.parent)
        except FileExistsError:
            raise OutputError(f"{self.output}: has appeared meanwhile; {kept}") from None
        except OSError as error:
            raise OutputError(f"{self.output}: cannot be written: {error.strerror}; {kept}") from None

    def _rename(self) -> None:
        """Rename, but never over a file that has appeared meanwhile: a link fails there, where a rename would replace it."""
        try:
            os.link(self.part, self.output)
        except OSError as error:
            if error.errno not in _NO_LINKS or os.path.lexists(self.output):
                raise
            os.rename(self.part, self.output)
        else:
            os.unlink(self.part)

    def discard(self) -> None:
        """Remove the part if this process made it, and it is still there."""
        if self.created and self.descriptor >= 0 and self.in_place():
            os.unlink(self.part)

    def close(self) -> None:
        """Let go of the file, and with it of the lock."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
            self.descriptor = -1


def _make_durable(folder: Path) -> None:
    with suppress(OSError):  # a file system that cannot does without
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _close_in_child() -> None:
    """A worker process must not hold the lock of a parent that has died."""
    for part in _open_parts:
        part.close()


os.register_at_fork(after_in_child=_close_in_child)
