"""Checksums of all bytes: the digest of a finished file, and the entries of a partial
file.

The digest follows the HDF5 data of a finished file, as a line of JSON and a line with
its length. It covers all bytes except the chunks, which have their own checksums. A
partial file is a layout followed by entries. Entries are only appended, so a damaged
byte spoils one entry at most.
"""

import hashlib
import json
import os
import re
import struct
import zlib
from collections.abc import Iterable, Sequence
from contextlib import suppress
from itertools import chain
from typing import Any, BinaryIO

_LAST, _LAST_LENGTH = re.compile(rb"\nrocking seal 1 (\d{10})\n"), 27
_BLOCK = 1 << 24  # bytes of a digest that are read at once

SIGNATURE = b"\x89HDF\r\n\x1a\n"
NOTE = -1  # index of an entry about the whole, as JSON
# one entry: magic, index of the chunk, bytes of the content, CRC-32 of the others
_ENTRY = struct.Struct("<4sqQI")
_MAGIC = b"rock"


def read(file: BinaryIO, offset: int, length: int) -> bytes:
    """Return `length` bytes of an open file from an offset; fewer at the end of the
    file.
    """
    file.seek(offset)
    return file.read(length)


def write(file: BinaryIO, offset: int, content: bytes) -> None:
    """Write all of the content; an unbuffered file may accept only some bytes at once.
    Raises OSError.
    """
    file.seek(offset)
    view = memoryview(content)
    while view:
        view = view[file.write(view) :]


def digest(pieces: Iterable[bytes]) -> str:
    """Return BLAKE2b of the joined pieces, 64 hexadecimal digits."""
    found = hashlib.blake2b(digest_size=32)
    for piece in pieces:
        found.update(piece)
    return found.hexdigest()


def _digest_of(file: BinaryIO, size: int, ranges: Sequence[tuple[int, int]]) -> str:
    """The digest of a file's size and of ranges (begin, length) of it [bytes]."""
    places = (
        (at, min(_BLOCK, begin + length - at))
        for begin, length in ranges
        for at in range(begin, begin + length, _BLOCK)
    )
    stated = json.dumps([size, ranges]).encode()
    parts = (read(file, *place) for place in places)
    return f"blake2b:{digest(chain([stated], parts))}"


def digest_line(file: BinaryIO, places: Sequence[tuple[int, int]]) -> bytes:
    """Return the last lines of a finished file, with its digest; places: (offset,
    length) of chunks. Raises ValueError if they overlap.
    """
    size, end, ranges = file.seek(0, os.SEEK_END), 0, []
    for begin, length in sorted([*places, (size, 0)]):
        if begin < end:
            raise ValueError(f"two chunks lie at byte {begin}")
        if begin > end:
            ranges.append((end, begin - end))
        end = begin + length
    line = json.dumps(
        {"size": size, "metadata": ranges, "digest": _digest_of(file, size, ranges)}
    ).encode()
    return b"\n" + line + b"\nrocking seal 1 %010d\n" % len(line)


def checked_digest(file: BinaryIO) -> str | None:
    """Return the digest at the end of a file, None without one. Raises ValueError if
    the file does not agree with it.
    """
    size = file.seek(0, os.SEEK_END)
    last = _LAST.fullmatch(read(file, max(0, size - _LAST_LENGTH), _LAST_LENGTH))
    begins = size - _LAST_LENGTH - int(last[1]) if last is not None else 0
    if begins < 1:
        return None
    try:
        stated = json.loads(read(file, begins, size - _LAST_LENGTH - begins))
        found = stated["digest"]
        now = _digest_of(file, stated["size"], stated["metadata"])
    except (ValueError, LookupError, TypeError, OSError):
        raise ValueError("its digest is damaged") from None
    if (
        found != now
        or stated["size"] != begins - 1
        or read(file, begins - 1, 1) != b"\n"
    ):
        raise ValueError("it does not fit its digest")
    return str(found)


class Log:
    """The layout and the entries of a partial file. Raises ValueError where it is no
    partial file, or its layout is damaged.
    """

    def __init__(self, file: BinaryIO) -> None:
        self.file = file
        size = file.seek(0, os.SEEK_END)
        head = read(file, 0, 48)
        # as HDF5 states it
        self.end = 0
        if head[:8] == SIGNATURE:
            self.end = int.from_bytes(head[40:48], "little")
        if not 48 <= self.end <= size:
            raise ValueError(
                "it is not finished, and is no partial file of this program"
            )
        self.image = read(file, 0, self.end)  # bytes of an HDF5 file without chunks
        self.notes: dict[str, Any] = {}  # statements about the whole
        # (offset, bytes) of the last entry of each index
        self.places: dict[int, tuple[int, int]] = {}
        # `end` moves on to the place where the last whole entry ends
        while self.end + _ENTRY.size <= size:
            magic, index, length, _ = _ENTRY.unpack(read(file, self.end, _ENTRY.size))
            if magic != _MAGIC or self.end + _ENTRY.size + length > size:
                break
            self.places[index] = self.end, _ENTRY.size + length
            if index == NOTE:
                self.notes |= json.loads(self.content(NOTE))
            self.end += _ENTRY.size + length
        if "layout" not in self.notes:
            raise ValueError(
                "it has neither a digest nor the entries of a partial file"
            )
        if self.notes["layout"] != digest([self.image]):
            raise ValueError("its layout is damaged")

    def content(self, index: int) -> bytes:
        """Return the content of an entry. Raises ValueError if it is damaged, KeyError
        if it does not exist.
        """
        raw = read(self.file, *self.places[index])
        if raw != entry_of(index, raw[_ENTRY.size :]):
            raise ValueError("its checksum does not fit")
        return raw[_ENTRY.size :]

    def append(self, index: int, content: bytes) -> None:
        """Append an entry. Raises OSError, after which the file is as it was before."""
        entry = entry_of(index, content)
        try:
            write(self.file, self.end, entry)
        except OSError:
            with suppress(OSError):
                self.file.truncate(self.end)
            raise
        self.places[index] = self.end, len(entry)
        self.end += len(entry)

    def note(self, **words: Any) -> None:
        """Append a statement about the whole. Raises OSError."""
        self.append(NOTE, json.dumps(words).encode())
        self.notes |= words


def entry_of(index: int, content: bytes) -> bytes:
    """Return the bytes of an entry: its head, then the content."""
    head = zlib.crc32(struct.pack("<qQ", index, len(content)))
    return _ENTRY.pack(_MAGIC, index, len(content), zlib.crc32(content, head)) + content


def reason(error: BaseException) -> str:
    """Return the message of an error in one line."""
    text = (
        str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)
    )
    return text if " " in text else f"it has no {text!r}"
