"""The digest of a finished spectra file: over all its bytes but the chunks, checked before HDF5 reads the file.

It stands behind the end that HDF5 knows, as a line of JSON and a line with the length of that. Chunks have checksums of their own.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Sequence
from typing import BinaryIO

_LAST = re.compile(rb"\nrocking seal 1 (\d{10})\n")
_LAST_LENGTH = 27
_BLOCK = 1 << 24  # bytes that are read at once


def digest_line(file: BinaryIO, places: Sequence[tuple[int, int]]) -> bytes:
    """What stands behind a finished file, whose chunks lie at these places (offset, length). Raises ValueError if they overlap."""
    size, end, ranges = file.seek(0, os.SEEK_END), 0, []
    for begin, length in sorted([*places, (size, 0)]):
        if begin < end:
            raise ValueError(f"two chunks lie at byte {begin}")
        if begin > end:
            ranges.append([end, begin - end])
        end = begin + length
    line = json.dumps({"size": size, "metadata": ranges, "digest": _digest(file, size, ranges)}).encode()
    return b"\n" + line + b"\nrocking seal 1 %010d\n" % len(line)


def checked_digest(file: BinaryIO) -> str | None:
    """The digest that a file ends with, None where it has none. Raises ValueError where the file is not what it was."""
    size = file.seek(0, os.SEEK_END)
    last = _LAST.fullmatch(read(file, max(0, size - _LAST_LENGTH), _LAST_LENGTH))
    begins = size - _LAST_LENGTH - int(last[1]) if last is not None else 0
    if begins < 1:
        return None
    try:
        stated = json.loads(read(file, begins, size - _LAST_LENGTH - begins))
        body, ranges, digest = stated["size"], [(int(o), int(n)) for o, n in stated["metadata"]], str(stated["digest"])
    except (ValueError, LookupError, TypeError, RecursionError):
        raise ValueError("its digest is damaged") from None
    if body != begins - 1 or read(file, body, 1) != b"\n" or any(o < 0 or n < 0 or o + n > body for o, n in ranges):
        raise ValueError("its digest is damaged")
    if digest != _digest(file, body, ranges):
        raise ValueError("it does not fit its digest")
    return digest


def read(file: BinaryIO, offset: int, length: int) -> bytes:
    """These bytes of an open file, fewer where it ends before."""
    file.seek(offset)
    pieces = []
    while length > 0 and (piece := file.read(min(length, _BLOCK))):
        pieces.append(piece)
        length -= len(piece)
    return b"".join(pieces)


def _digest(file: BinaryIO, size: int, ranges: Sequence[Sequence[int]]) -> str:
    digest = hashlib.blake2b(json.dumps([size, [list(place) for place in ranges]]).encode(), digest_size=32)
    for offset, length in ranges:
        for first in range(offset, offset + length, _BLOCK):
            digest.update(read(file, first, min(_BLOCK, offset + length - first)))
    return f"blake2b:{digest.hexdigest()}"
