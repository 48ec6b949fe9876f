"""Reads the bytes of a file that a user names; `-` is standard input."""

import io
import os
import re
import select
import stat
import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext, suppress
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, BinaryIO

from ..errors import DocumentError, UsageError, did_you_mean

LARGEST = 256 << 20  # bytes of a file
STDIN = "<stdin>"
_SIZES = re.compile(r"[0-9.]+ *x *[0-9.]+ *[a-z]*")  # 0.5x2
_PATIENCE = 2.0  # s that a pipe may be without a writer


def is_document_text(given: str) -> bool:
    """True for the text of a document itself, which no path looks like."""
    return "\n" in given or (
        given.lstrip().startswith("{") and not os.path.exists(given)
    )


def several(given: Any) -> Sequence[Any]:
    """Return what Python passes as a sequence: a sequence itself, other than a text, or
    the one thing.
    """
    one = isinstance(given, str) or not isinstance(given, Sequence)
    return [given] if one else given


def whole_text(text: str) -> str:
    """Return a text that UTF-8, HDF5 and a font can hold: a byte of a file name that is
    no UTF-8 stands as \\udce9.
    """
    return text.encode("utf-8", "backslashreplace").decode()


@lru_cache  # every row of a table asks for that of its file
def named_after(path: str | Path) -> str:
    """Return the name that a file gives to what it holds, by default."""
    return whole_text(Path(path).stem)


def read_bytes(path: str | Path) -> tuple[str, bytes]:
    """Return (source name, content) of a file. Raises UsageError (it cannot be read) or
    DocumentError (it is too large).
    """
    source, file = _opened(path)
    return source, _content(source, file)


def opener_of(path: str | Path) -> tuple[str, Callable[[], BinaryIO]]:
    """Return (source name, a function that opens the file at its beginning). What can
    be read only once, such as a pipe, is held in memory. Raises as `read_bytes` does.
    """
    source, file = _opened(path)
    if source == STDIN or not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        return source, partial(io.BytesIO, _content(source, file))
    file.close()
    return source, lambda: _opened(path)[1]


def _opened(path: str | Path) -> tuple[str, BinaryIO]:
    """Return (source name, open file). Raises UsageError."""
    if str(path) == "-":
        if sys.stdin is None:
            raise UsageError("standard input is closed")
        return STDIN, sys.stdin.buffer
    try:
        return str(path), open(path, "rb", opener=_with_a_writer)
    except OSError as error:
        raise _unreadable(str(path), error) from None


def _content(source: str, file: BinaryIO) -> bytes:
    """Return the content of an open file, and close it unless it is standard input.
    Raises UsageError, DocumentError.
    """
    try:
        with nullcontext() if source == STDIN else file:
            size = 0 if source == STDIN else os.fstat(file.fileno()).st_size
            raw = b"" if size > LARGEST else file.read(LARGEST + 1)
    except OSError as error:
        raise _unreadable(source, error) from None
    if max(size, len(raw)) > LARGEST:
        raise DocumentError(
            f"{source}: larger than {LARGEST >> 20} MiB, the limit of a file"
        )
    return raw


def _unreadable(source: str, error: OSError) -> UsageError:
    """Return the error for a file that cannot be read."""
    if isinstance(error, IsADirectoryError):
        return UsageError(
            f"{source}: found a folder; expected a file, or several: {source}/*"
        )
    near = _near(source) if isinstance(error, FileNotFoundError) else ""
    return UsageError(f"{source}: cannot be read: {error.strerror or error}{near}")


def _near(path: str) -> str:
    """Return a question on the file of the same folder that a name probably means, or
    on the structure that its sizes mean; else an empty text.
    """
    if _SIZES.fullmatch(path):
        return f" (did you mean 'block:{path}'?)"
    folder, name = os.path.split(path)
    with suppress(OSError):
        near = did_you_mean(name, os.listdir(folder or "."))
        return near.replace("mean '", f"mean '{folder}/") if folder else near
    return ""


def _with_a_writer(path: str, flags: int) -> int:
    """Open a file. Raises UsageError for a pipe without a writer, on which reading
    would not end.
    """
    if not stat.S_ISFIFO(os.stat(path).st_mode):
        return os.open(path, flags)
    descriptor = os.open(path, flags | os.O_NONBLOCK)
    ready = select.select([descriptor], [], [], _PATIENCE)[0]
    try:
        nobody = not ready and os.read(descriptor, 1) == b""
    except BlockingIOError:  # there is a writer, who has not begun
        nobody = False
    if nobody:
        os.close(descriptor)
        raise UsageError(f"{path}: a pipe that nobody writes to")
    os.set_blocking(descriptor, True)
    return descriptor
