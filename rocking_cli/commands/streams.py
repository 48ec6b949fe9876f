"""The standard streams of a call: failures of output, and escapes for control
characters.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from io import TextIOWrapper
from textwrap import wrap
from threading import RLock
from typing import TextIO, cast

import click

from ..errors import OutputError

_WIDTH = 100  # characters of a terminal that does not state its width


def printable(text: str) -> str:
    """Return the text with every control character and half character escaped."""
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode() for c in text
    )


lock = RLock()  # of the writers: the program, and the thread that shows its progress
silent = False  # True in a call with --quiet: no progress
_standing = 0  # characters of the line on the terminal that `renew` will replace
# A worker process must not inherit a lock that the thread of the progress holds.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(
        before=lock.acquire, after_in_parent=lock.release, after_in_child=lock.release
    )


def renew(line: str) -> None:
    """Write a line over the one that the terminal renews on standard error."""
    global _standing
    with lock:
        room = columns_of(sys.stderr) - 1  # a second line would stay
        text = printable(line)[:room]
        # blanks clear the line: not every terminal knows a sequence that does
        sys.stderr.write(f"\r{text.ljust(_standing)[:room]}")
        sys.stderr.flush()
        _standing = len(text)


def erase() -> None:
    """Remove the line that the terminal renews, so that another one can stand there."""
    global _standing
    with lock:
        if _standing:
            renew("")
            sys.stderr.write("\r")
            sys.stderr.flush()


def put(*lines: str) -> None:
    """Write lines on standard output, each at once."""
    for line in lines:
        with lock:
            if _standing and sys.stdout.isatty():
                erase()
            sys.stdout.write(f"{printable(line)}\n")
            sys.stdout.flush()


def say(line: str) -> None:
    """Write a line on standard error at once; on a terminal it is
    broken between words.
    """
    text = printable(line)
    with lock:
        erase()
        if sys.stderr.isatty():
            columns = columns_of(sys.stderr)
            text = "\n".join(
                wrap(text, columns, break_long_words=False, break_on_hyphens=False)
            )
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()


def columns_of(terminal: TextIO) -> int:
    """Return the width of a terminal in characters."""
    if not (asked := os.environ.get("COLUMNS", "")).isdigit() or int(asked) < 2:
        with suppress(OSError, ValueError):
            if (columns := os.get_terminal_size(terminal.fileno()).columns) > 1:
                return columns
        return _WIDTH
    return int(asked)


@contextmanager
def guarded() -> Iterator[None]:
    """Context of a call: a closed pipe on standard output ends it without an error; any
    other failure of the output is reported once. A closed or full standard error has no
    effect. What no terminal shows is UTF-8, whatever the locale, unless the environment
    names another encoding.
    """
    descriptor = 0
    # else the next opened file gets the number of a closed stream, and a C library
    # would print into it
    while descriptor <= 2:
        descriptor = os.open(os.devnull, os.O_RDWR)
    os.close(descriptor)
    for stream in (sys.stdout, sys.stderr):
        if (
            isinstance(stream, TextIOWrapper)
            and not stream.isatty()
            and "PYTHONIOENCODING" not in os.environ
        ):
            stream.reconfigure(encoding="utf-8")
    with (
        redirect_stdout(cast(TextIO, _Output(sys.stdout))),
        redirect_stderr(cast(TextIO, _Stream(sys.stderr))),
    ):
        yield


class _Stream:
    """Standard error, or None if it is closed. Characters that its encoding lacks are
    escaped, and failures are ignored. It has no `buffer`, so all output goes through
    `write`.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.encoding = getattr(stream, "encoding", None) or "utf-8"
        self.errors = "backslashreplace"

    def write(self, text: str | bytes) -> int:
        if isinstance(text, bytes):
            if not text:
                # click tests in this way whether a stream takes text
                raise TypeError("a stream of text")
            text = text.decode()  # click writes what completes a word as bytes
        try:
            if self._stream is None:
                raise OSError("it is closed")
            # an empty one fails on a full device, which click would take for an answer
            if text:
                self._stream.write(
                    text.encode(self.encoding, self.errors).decode(self.encoding)
                )
        except OSError as error:
            self._failed(error)
        return len(text)

    def flush(self) -> None:
        try:
            if self._stream is not None:
                self._stream.flush()
        except OSError as error:
            self._failed(error)

    def isatty(self) -> bool:
        return self._stream is not None and self._stream.isatty()

    def fileno(self) -> int:
        if self._stream is None:
            raise OSError("it is closed")
        return self._stream.fileno()

    def _failed(self, error: OSError) -> None:
        """Prevent the interpreter from flushing the stream at exit."""
        with suppress(OSError, ValueError):
            void = os.open(os.devnull, os.O_WRONLY)
            os.dup2(void, self.fileno())
            os.close(void)


class _Output(_Stream):
    """Standard output: a closed pipe is no error, other failures are."""

    def _failed(self, error: OSError) -> None:
        super()._failed(error)
        if isinstance(error, BrokenPipeError):
            raise click.exceptions.Exit(0) from None
        raise OutputError(
            f"standard output: cannot be written: {error.strerror or error}"
        ) from None
