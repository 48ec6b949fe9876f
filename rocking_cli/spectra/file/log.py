"""The records of a partial file, which are only appended: each has a checksum, so that damage is found and costs one record."""

from __future__ import annotations

import json
import os
import struct
import zlib
from contextlib import suppress
from typing import Any, BinaryIO

from .digest import digest, read

SIGNATURE = b"\x89HDF\r\n\x1a\n"
NOTE = -1  # index of a record about the whole, as JSON
_RECORD = struct.Struct("<4sqQI")  # magic, index of the chunk, bytes of the content, CRC-32 of all else
_MAGIC = b"rock"


class Log:
    """The layout and the records of a partial file.

    image: the bytes of an HDF5 file without chunks; notes: statements about the whole; places: (offset, bytes) of the last record of each
    index; end: where the last whole record ends. Raises ValueError where it is no partial file, or its layout is damaged.
    """

    def __init__(self, file: BinaryIO) -> None:
        self.file, size = file, os.fstat(file.fileno()).st_size
        head = read(file, 0, 48)
        self.end = int.from_bytes(head[40:48], "little") if head[:8] == SIGNATURE else 0  # as HDF5 states it
        if not 48 <= self.end <= size:
            raise ValueError("it is not finished, and is no partial file of this program")
        self.image = read(file, 0, self.end)
        self.notes: dict[str, Any] = {}
        self.places: dict[int, tuple[int, int]] = {}
        while self.end + _RECORD.size <= size:
            magic, index, length, _ = _RECORD.unpack(read(file, self.end, _RECORD.size))
            if magic != _MAGIC or self.end + _RECORD.size + length > size:
                break
            self.places[index] = self.end, _RECORD.size + length
            if index == NOTE:
                self.notes |= json.loads(self.content(NOTE))
            self.end += _RECORD.size + length
        if "layout" not in self.notes:
            raise ValueError("it has neither a digest nor the records of a partial file")
        if self.notes["layout"] != digest([self.image]):
            raise ValueError("its layout is damaged")

    def content(self, index: int) -> bytes:
        """The content of a record. Raises ValueError where it is damaged, KeyError where there is none."""
        raw = read(self.file, *self.places[index])
        if len(raw) < _RECORD.size or raw[: _RECORD.size] != head_of(index, raw[_RECORD.size :]):
            raise ValueError("its checksum does not fit")
        return raw[_RECORD.size :]

    def append(self, index: int, content: bytes) -> None:
        """Append a record. Raises OSError, after which the file is as it was before."""
        record = head_of(index, content) + content
        try:
            write(self.file, self.end, record)
        except OSError:
            with suppress(OSError):
                self.file.truncate(self.end)
            raise
        self.places[index] = self.end, len(record)
        self.end += len(record)

    def note(self, **words: Any) -> None:
        """Append a statement about the whole. Raises OSError."""
        self.append(NOTE, json.dumps(words).encode())
        self.notes |= words


def head_of(index: int, content: bytes) -> bytes:
    """What stands before the content of a record."""
    return _RECORD.pack(_MAGIC, index, len(content), zlib.crc32(content, zlib.crc32(struct.pack("<qQ", index, len(content)))))


def write(file: BinaryIO, offset: int, content: bytes) -> None:
    """Write all of the content, in several calls, since an unbuffered file may accept only some bytes. Raises OSError."""
    file.seek(offset)
    view = memoryview(content)
    while view:
        view = view[file.write(view) :]
