"""Bytes of a file to its text; a file that holds no text is refused by what it is, and
never quoted.
"""

import io
import re
from codecs import getincrementaldecoder
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import BinaryIO, NamedTuple, TextIO

from ..errors import DocumentError
from .composition import Place, place_in
from .files import opener_of, read_bytes

# The first bytes of a format, its name, and what to do with such a file.
_FORMATS = (
    (
        b"\xd0\xcf\x11\xe0",
        "a workbook or document of an old Office program (.xls, .doc)",
        "save it as CSV UTF-8",
    ),
    (b"\x1f\x8b", "a gzip archive", "unpack it"),
    (b"BZh", "a bzip2 archive", "unpack it"),
    (b"\xfd7zXZ", "an xz archive", "unpack it"),
    (b"7z\xbc\xaf", "a 7z archive", "unpack it"),
    (b"Rar!", "a RAR archive", "unpack it"),
    (b"%PDF", "a PDF", "copy its numbers into a text file"),
    (b"\x89HDF", "an HDF5 file", "export it as CSV"),
    (b"CDF\1", "a netCDF file", "export it as CSV"),
    (b"CDF\2", "a netCDF file", "export it as CSV"),
    (b"\x89PNG", "a picture", "write its numbers into a text file"),
    (b"\xff\xd8\xff", "a picture", "write its numbers into a text file"),
    (b"{\\rtf", "a document of a word processor (.rtf)", "save it as plain text"),
)
# A name inside a zip archive, the kind of file that holds it, and what to do with it.
_PACKED = (
    (b"xl/", "an Excel workbook (.xlsx)", "save it as CSV UTF-8"),
    (b"word/", "a Word document (.docx)", "save it as plain text, UTF-8"),
    (
        b"opendocument.spreadsheet",
        "a LibreOffice spreadsheet (.ods)",
        "save it as CSV, UTF-8",
    ),
    (b"opendocument", "a LibreOffice document", "save it as plain text, UTF-8"),
    (b".iwa", "a Numbers or Pages file of Apple", "export it as CSV, UTF-8"),
    (b"", "a zip archive", "unpack it"),
)
_MARKS = (
    (b"\xef\xbb\xbf", "utf-8"),
    (b"\xff\xfe\0\0", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
_UTF8 = re.compile(
    rb"[\xc2-\xdf][\x80-\xbf]|[\xe0-\xef][\x80-\xbf]{2}|[\xf0-\xf4][\x80-\xbf]{3}"
)
# control characters that no text holds; an escape has its own sentence
_BINARY = re.compile(r"[\0-\x08\x0e-\x1a\x1c-\x1f]")


HELD = 1 << 20  # bytes of a file up to which its text is held in memory

Opener = Callable[[], BinaryIO]  # opens a file at its beginning


class Text(NamedTuple):
    """A text that is read as often as it is needed. That of a large file is not held in
    memory.
    """

    source: str  # the file
    head: str  # its beginning; all of a short text
    opened: Callable[[], TextIO]  # opens it at its beginning
    whole: Callable[[], str]  # returns all of it

    @classmethod
    def of(cls, text: str, source: str) -> "Text":
        """Return a text that is in memory."""
        return cls(source, text, partial(io.StringIO, text, newline=""), lambda: text)

    def lines(self, start: int, first: int) -> Iterator[str]:
        """Yield the lines with their ends from a place on, whose line has the number
        `first`. Raises DocumentError for a text with control characters, which only
        binary data holds.
        """
        with self.opened() as file:
            file.read(start)
            for at, line in enumerate(file, first):
                if found := _BINARY.search(line):
                    place = Place(self.source, at, found.start() + 1)
                    raise DocumentError(
                        f"{place}: found binary data (the control character"
                        f" U+{ord(found[0]):04X}); expected a text"
                    )
                yield line


def text_at(path: str | Path) -> Text:
    """Return the text of a file; `-` is standard input. Raises UsageError for a file
    that cannot be read, and DocumentError for one that holds no text.
    """
    source, opened = opener_of(path)
    with opened() as file:
        head = file.read(HELD + 1)
    if len(head) <= HELD:
        return Text.of(text_of(source, head), source)
    encoding = _encoding_of(source, head, opened)
    return Text(
        source,
        head.decode(encoding, "ignore"),
        lambda: io.TextIOWrapper(opened(), encoding, newline=""),
        lambda: text_of(*read_bytes(path)),
    )


def _encoding_of(source: str, head: bytes, opened: Opener) -> str:
    """Return the encoding of the text of a large file, as `text_of` decides it; head:
    its first bytes. Raises DocumentError for bytes that are no text.
    """
    refuse_packed(source, head)
    mark, encoding = _mark_of(head)
    if mark and encoding == "utf-8":
        encoding = "utf-8-sig"
    fault = _undecodable(opened, encoding)
    if fault is None:
        return encoding
    of_windows = not mark and not any(map(_UTF8.search, _blocks(opened)))
    if of_windows and _undecodable(opened, "cp1252") is None:
        return "cp1252"
    line, at = fault
    raise DocumentError(f"{source}:{line}: not a UTF-8 text (byte {at})")


def _undecodable(opened: Opener, encoding: str) -> tuple[int, int] | None:
    """Return (line, byte) of the first fault of a text, None without one."""
    decoder, line, read = getincrementaldecoder(encoding)(), 1, 0
    for block in _blocks(opened):
        try:
            decoder.decode(block, final=not block)
        except UnicodeDecodeError as error:
            good = error.object[: error.start]
            begin = read + len(block) - len(error.object)
            return line + good.count(b"\n"), begin + len(good)
        line, read = line + block.count(b"\n"), read + len(block)
    return None


def _blocks(opened: Opener) -> Iterator[bytes]:
    """Yield the content of a file in blocks, behind them an empty one."""
    with opened() as file:
        while block := file.read(HELD):
            yield block
    yield b""


def text_of(source: str, raw: bytes) -> str:
    """Return the text of a file's bytes: UTF-8, UTF-16 or UTF-32 with a byte order
    mark, or else cp1252 as Windows programs write it. Raises DocumentError for bytes
    that are no text.
    """
    refuse_packed(source, raw)
    mark, encoding = _mark_of(raw)
    try:
        text = raw.decode(encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        text = "" if mark or _UTF8.search(raw) else raw.decode("cp1252", "replace")
        if not text or "\ufffd" in text or _BINARY.search(text):
            good = raw[: error.start].decode(encoding, "ignore").removeprefix("\ufeff")
            place = place_in(good, len(good), source)
            at = error.start - (len(mark) if encoding == "utf-8" else 0)
            raise DocumentError(f"{place}: not a UTF-8 text (byte {at})") from None
    return text


def _mark_of(raw: bytes) -> tuple[bytes, str]:
    """Return (byte order mark, encoding) of a text that begins so."""
    return next((pair for pair in _MARKS if raw.startswith(pair[0])), (b"", "utf-8"))


def refuse_packed(source: str, raw: bytes) -> None:
    """Raise DocumentError for the bytes of a format that holds no text."""
    if found := packed(raw):
        raise DocumentError(
            f"{Place(source, 1, 1)}: found {found[0]}; expected a text: {found[1]}"
        )


def packed(raw: bytes) -> tuple[str, str] | None:
    """Return (what a file is, what to do with it) for a format that holds no text, None
    for any other bytes.
    """
    if raw[257:262] == b"ustar":
        return "a tar archive", "unpack it"
    if raw.startswith(b"PK\x03\x04"):
        return next((name, advice) for inside, name, advice in _PACKED if inside in raw)
    return next(
        ((name, advice) for start, name, advice in _FORMATS if raw.startswith(start)),
        None,
    )
