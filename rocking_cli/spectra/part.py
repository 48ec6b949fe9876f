"""The file of a sweep on the disk: who may write it, what HDF5 sees of it, and how it takes its final name.

A part is locked by the process that writes it from the moment it is opened to the moment it is published; every other process finds
it in use and touches nothing. The lock is the system's (flock), so that it ends with the process however that ends.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import time
import weakref
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..errors import OutputError, UsageError
from .seal import read

SIGNATURE = b"\x89HDF\r\n\x1a\n"
PATIENCE = 0.3  # s: somebody who only looks whether a part is in use holds it for an instant
_BUSY = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)
_NO_LINKS = (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK, errno.ENOTSUP)
_NO_RESERVING = (errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL, errno.ENOTSUP)

_open_parts: weakref.WeakSet[Part] = weakref.WeakSet()


def part_of(path: Path) -> Path:
    """The name a spectra file has while it is being written."""
    return path.with_name(path.name + ".part")


def check_output(path: Path, overwrite: bool, resume: bool = False) -> None:
    """Refuse an output that cannot or must not be written, before any work is done. Raises UsageError, OutputError if in use."""
    if str(path) in ("-", ".", ""):
        raise UsageError(f"{str(path)!r} is not the name of a file; an HDF5 file cannot be written to standard output")
    if resume and overwrite:
        raise UsageError("--resume does not go with --overwrite")
    part = part_of(path)
    try:
        if not path.parent.is_dir():
            raise UsageError(f"{path}: the folder {path.parent} does not exist")
        if kind := _kind(path):
            raise UsageError(f"{path}: is {kind}, accepted is the name of a file")
        if kind := _kind(part, links=False):
            raise UsageError(f"{part}: is {kind}, where a sweep would keep what is done; give another output")
        if os.path.exists(part) and not (overwrite or resume) and _locked(part):
            raise OutputError(f"{part}: is in use by another process")
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}") from None
    _refuse_existing(path, overwrite, resume)


def _refuse_existing(path: Path, overwrite: bool, resume: bool, own_part: bool = False) -> None:
    if os.path.lexists(path) and not overwrite:
        raise UsageError(f"{path}: exists{' and is complete' if resume else ''}; --overwrite replaces it")
    part = part_of(path)
    if os.path.lexists(part) and not (overwrite or resume or own_part):
        raise UsageError(f"{part}: exists, left by a sweep that did not finish; --resume goes on with it, --overwrite begins anew")


_KINDS = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device", stat.S_IFLNK: "a link"}


def _kind(path: Path, links: bool = True) -> str:
    """What a path is that is neither free nor a regular file (with `links`, nor a link to one); empty otherwise. Raises OSError."""
    try:
        mode = os.lstat(path).st_mode
        if stat.S_ISLNK(mode) and links:
            mode = os.stat(path).st_mode if os.path.exists(path) else mode
    except FileNotFoundError:
        return ""
    if stat.S_ISLNK(mode) and links:
        return "a link that leads nowhere"
    return "" if stat.S_ISREG(mode) else _KINDS.get(stat.S_IFMT(mode), "not a regular file")


def _locked(part: Path) -> bool:
    descriptor = open_regular(part)
    try:
        return not lock(descriptor, shared=True)
    finally:
        os.close(descriptor)


def open_regular(path: Path, flags: int = os.O_RDONLY) -> int:
    """A descriptor of a regular file; a pipe is not waited for. Raises OSError."""
    descriptor = os.open(path, flags | os.O_NONBLOCK | os.O_CLOEXEC)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "not a regular file")
    return descriptor


def lock(descriptor: int, shared: bool = False) -> bool:
    """Lock an open file for this process; False when another one holds it. Raises OutputError where there are no locks.

    HDF5's own variable HDF5_USE_FILE_LOCKING=FALSE or BEST_EFFORT says that the user knows of none and takes care.
    """
    try:
        import fcntl
    except ImportError:
        reason = "this system has none"
    else:
        end = time.monotonic() + PATIENCE
        while True:
            try:
                fcntl.flock(descriptor, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
                return True
            except OSError as error:
                if error.errno not in _BUSY:
                    reason = os.strerror(error.errno or 0)
                    break
            if shared or time.monotonic() > end:
                return False
            time.sleep(0.02)
    if os.environ.get("HDF5_USE_FILE_LOCKING", "").upper() in ("FALSE", "0", "BEST_EFFORT"):
        return True
    raise OutputError(
        f"the file system offers no locks ({reason}), so that two sweeps of one output could not be kept apart; write to another one, "
        "or set HDF5_USE_FILE_LOCKING=FALSE if no other process uses this output"
    )


class RawFile(io.RawIOBase):
    """An open file as HDF5 takes it: by its descriptor, so that neither a name nor a lock comes in between.

    A killed writer may leave data beyond the end that the superblock states (version 0, bytes 40 to 47), and a cut file ends before;
    HDF5 refuses both. It is shown the larger of the two ends, with zeros where there is nothing; the checksums tell what that cost.
    """

    def __init__(self, descriptor: int) -> None:
        self.descriptor, self.at, self.abandoned = descriptor, 0, False
        head, self.end = read(descriptor, 0, 48), os.fstat(descriptor).st_size
        plain = head[:9] == SIGNATURE + b"\0" and len(head) == 48 and head[13:14] == b"\x08" and not any(head[24:32])
        self.patched = plain
        if plain:
            self.end = max(self.end, int.from_bytes(head[40:48], "little"))

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Set the place of the next read or write."""
        self.at = offset + (0, self.at, self.end)[whence]
        return self.at

    def tell(self) -> int:
        """The place of the next read or write."""
        return self.at

    def readinto(self, buffer: Any) -> int:
        """Fill a buffer, with zeros from the end of the file to the end that is stated."""
        view = memoryview(buffer).cast("B")
        count = max(0, min(len(view), self.end - self.at))
        data = bytearray(read(self.descriptor, self.at, count).ljust(count, b"\0"))
        if self.patched:
            for i, byte in enumerate(self.end.to_bytes(8, "little"), 40 - self.at):
                if 0 <= i < count:
                    data[i] = byte
        view[:count] = data
        self.at += count
        return count

    def write(self, data: Any) -> int:
        """Write all of it. Raises OSError."""
        view = memoryview(data).cast("B")
        done = len(view) if self.abandoned else 0
        while done < len(view):
            done += os.pwrite(self.descriptor, view[done:], self.at + done)
        self.patched = self.patched and not self.at < 48 <= self.at + len(view)
        self.at += len(view)
        self.end = max(self.end, self.at)
        return len(view)

    def truncate(self, size: int | None = None) -> int:
        """Set the end of the file; what is reserved behind it stays until it is trimmed."""
        self.end = self.at if size is None else size
        if not self.abandoned and self.end > os.fstat(self.descriptor).st_size:
            os.ftruncate(self.descriptor, self.end)
        return self.end

    def reserve(self, count: int) -> None:
        """Take this many bytes behind the end from the disk, so that HDF5 never meets a full one. Raises OSError."""
        reserving: Callable[[int, int, int], None] | None = getattr(os, "posix_fallocate", None)
        if reserving is not None:
            try:
                reserving(self.descriptor, self.end, count)
            except OSError as error:
                if error.errno not in _NO_RESERVING:
                    raise

    def trim(self) -> None:
        """Give back what was reserved and not written. Raises OSError."""
        if self.end < os.fstat(self.descriptor).st_size:
            os.ftruncate(self.descriptor, self.end)


class Part:
    """The part of an output, opened and locked for this process.

    Raises OutputError when another process has it or it cannot be opened, UsageError when it must not be begun anew.
    """

    def __init__(self, output: Path, overwrite: bool, resume: bool) -> None:
        check_output(output, overwrite, resume)
        self.output = Path(os.path.realpath(output)) if output.is_symlink() else output
        self.part, self.overwrite, self.descriptor = part_of(self.output), overwrite, -1
        try:
            self.created = self._open()
        except OSError as error:
            raise OutputError(f"{self.part}: cannot be written: {error.strerror}") from None
        _open_parts.add(self)
        try:
            _refuse_existing(self.output, overwrite, resume, self.created)  # what appeared before the lock was held
        except UsageError:
            self.discard()
            self.close()
            raise

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
            try:
                if not lock(self.descriptor):
                    break
            except OutputError as error:
                if created:
                    self.part.unlink(missing_ok=True)
                self.close()
                raise OutputError(f"{self.part}: {error}") from None
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

    def begun(self, layout: int) -> bool:
        """Whether it holds what a sweep left: more than a layout of so many bytes that never came to its signature."""
        return any(read(self.descriptor, 0, len(SIGNATURE))) or os.fstat(self.descriptor).st_size > layout

    def begin(self, image: bytes) -> None:
        """Make the part these bytes, its signature last: a part without is not begun. Raises OSError, and leaves none behind."""
        self.created = True
        try:
            os.ftruncate(self.descriptor, 0)
            raw = RawFile(self.descriptor)
            raw.reserve(len(image))
            raw.seek(len(SIGNATURE))
            raw.write(image[len(SIGNATURE) :])
            raw.seek(0)
            raw.write(image[: len(SIGNATURE)])
        except BaseException:
            self.discard()
            raise

    def publish(self) -> None:
        """Make the part durable and give it its final name. Raises OutputError; what cannot be published is kept."""
        kept = f"the result is kept as {self.part}"
        try:
            os.fsync(self.descriptor)
            if not self.in_place():
                kept = f"{self.part} has vanished meanwhile, or is another's"
                raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
            if self.overwrite and os.path.lexists(self.output):
                if kind := _kind(self.output):
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
        if self.created and self.in_place():
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
