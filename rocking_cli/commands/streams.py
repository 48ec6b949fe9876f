"""The standard streams of a call: failures of output, and escapes for control characters."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from textwrap import wrap
from typing import TextIO, cast

import click

from ..errors import OutputError


def printable(text: str) -> str:
    """Return the text with every control character and half character escaped."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


_unfinished = False  # the line that the terminal renews


def renew(line: str) -> None:
    """Write a line over the one that the terminal renews on standard error."""
    global _unfinished
    _unfinished = True
    sys.stderr.write(f"\r\x1b[K{printable(line)}")
    sys.stderr.flush()


def end_line() -> None:
    """End the line that the terminal renews, if there is one."""
    global _unfinished
    if _unfinished:
        _unfinished = False
        sys.stderr.write("\n")


def put(*lines: str) -> None:
    """Write lines on standard output, each at once."""
    for line in lines:
        if sys.stdout.isatty():
            end_line()
        sys.stdout.write(f"{printable(line)}\n")
        sys.stdout.flush()


def say(line: str) -> None:
    """Write a line on standard error at once; on a terminal it is broken between words."""
    end_line()
    text = printable(line)
    if sys.stderr.isatty():
        from shutil import get_terminal_size

        text = "\n".join(wrap(text, get_terminal_size((100, 0)).columns, break_long_words=False, break_on_hyphens=False))
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


@contextmanager
def guarded() -> Iterator[None]:
    """Context of a call: a closed pipe on standard output ends it without an error; any other failure of the output is reported once. A
    closed or full standard error has no effect."""
    descriptor = 0
    while descriptor <= 2:  # else the next opened file gets the number of a closed stream, and a C library would print into it
        descriptor = os.open(os.devnull, os.O_RDWR)
    os.close(descriptor)
    with redirect_stdout(cast(TextIO, _Output(sys.stdout))), redirect_stderr(cast(TextIO, _Stream(sys.stderr))):
        yield


class _Stream:
    """Standard error, or None if it is closed. Characters that its encoding lacks are escaped, and failures are ignored. It has no
    `buffer`, so all output goes through `write`."""

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.encoding = getattr(stream, "encoding", None) or "utf-8"
        self.errors = "backslashreplace"

    def write(self, text: str | bytes) -> int:
        if isinstance(text, bytes):
            if not text:
                raise TypeError("a stream of text")  # click tests a text stream in this way
            text = text.decode()  # click writes what completes a word as bytes
        try:
            if self._stream is None:
                raise OSError("it is closed")
            if text:  # an empty one fails on a full device, which click would take for an answer
                self._stream.write(text.encode(self.encoding, self.errors).decode(self.encoding))
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
        raise OutputError(f"standard output: cannot be written: {error.strerror or error}") from None
