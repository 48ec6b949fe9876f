"""An open file: as HDF5 takes it, and locked.

HDF5 opens files by name, locks them in its own way, and meets a full disk in the middle of its bookkeeping; here a file is one
descriptor, its lock is the system's (flock, so that it ends with the process however that ends), and space is taken beforehand.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..errors import OutputError
from .seal import read

SIGNATURE = b"\x89HDF\r\n\x1a\n"
PATIENCE = 0.3  # s: somebody who only looks whether a part is in use holds it for an instant
_BUSY = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)
_NO_RESERVING = (errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL, errno.ENOTSUP)


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
