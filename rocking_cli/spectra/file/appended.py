"""The records of a partial file: its layout, and behind it the chunks that are done, each with a checksum."""

from __future__ import annotations

import hashlib
import json
import os
import struct
import zlib
from typing import Any, BinaryIO

from .digest import read

SIGNATURE = b"\x89HDF\r\n\x1a\n"
NOTE = -1  # index of a record that says something of the whole, as JSON
_RECORD = struct.Struct("<4sqQI")  # magic, index of the chunk, bytes of the content, CRC-32 of all else
_MAGIC = b"rock"


class Appended:
    """The layout and the records of a partial file.

    image: the bytes of an HDF5 file without chunks; notes: what was said of the whole; places: of each chunk (offset, bytes); end: where
    the last whole record ends. Raises ValueError where it is no partial file, or its layout is damaged.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file, size = file, os.fstat(file.fileno()).st_size
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
            if index == NOTE:
                self.notes |= json.loads(self.content(NOTE, (self.end, _RECORD.size + length)))
            else:
                self.places[index] = self.end, _RECORD.size + length
            self.end += _RECORD.size + length
        if "layout" not in self.notes:
            raise ValueError("it has neither a digest nor the records of a partial file")
        if self.notes["layout"] != layout_digest(self.image):
            raise ValueError("its layout is damaged")

    def content(self, index: int, place: tuple[int, int] | None = None) -> bytes:
        """What the record of a chunk holds. Raises ValueError where it is damaged, KeyError where there is none."""
        raw = read(self._file, *(place or self.places[index]))
        if len(raw) < _RECORD.size or raw[: _RECORD.size] != head_of(index, raw[_RECORD.size :]):
            raise ValueError("its checksum does not fit")
        return raw[_RECORD.size :]


def head_of(index: int, content: bytes) -> bytes:
    """The head of a record: magic, index, length, and the checksum of these and the content."""
    return _RECORD.pack(_MAGIC, index, len(content), zlib.crc32(content, zlib.crc32(struct.pack("<qQ", index, len(content)))))


def layout_digest(image: bytes) -> str:
    """The digest of a layout, 64 hexadecimal digits."""
    return hashlib.blake2b(image, digest_size=32).hexdigest()
