"""The digest of a finished spectra file: over all its bytes but the chunks, checked before HDF5 reads the file.

It follows the end of the HDF5 data, as a line of JSON and a line with its length. Chunks have their own checksums.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterable, Sequence
from itertools import chain
from typing import BinaryIO

_LAST = re.compile(rb"\nrocking seal 1 (\d{10})\n")
_LAST_LENGTH = 27
_BLOCK = 1 << 24  # bytes that are read at once


def digest_line(file: BinaryIO, places: Sequence[tuple[int, int]]) -> bytes:
    """The last lines of a finished file, whose chunks lie at these places (offset, length). Raises ValueError if they overlap."""
    size, end, ranges = file.seek(0, os.SEEK_END), 0, []
    for begin, length in sorted([*places, (size, 0)]):
        if begin < end:
            raise ValueError(f"two chunks lie at byte {begin}")
        if begin > end:
            ranges.append((end, begin - end))
        end = begin + length
    line = json.dumps({"size": size, "metadata": ranges, "digest": _digest_of(file, size, ranges)}).encode()
    return b"\n" + line + b"\nrocking seal 1 %010d\n" % len(line)


def checked_digest(file: BinaryIO) -> str | None:
    """The digest at the end of a file, None if there is none. Raises ValueError if the file has changed."""
    size = file.seek(0, os.SEEK_END)
    last = _LAST.fullmatch(read(file, max(0, size - _LAST_LENGTH), _LAST_LENGTH))
    begins = size - _LAST_LENGTH - int(last[1]) if last is not None else 0
    if begins < 1:
        return None
    try:
        stated = json.loads(read(file, begins, size - _LAST_LENGTH - begins))
        body, ranges, found = stated["size"], [(int(o), int(n)) for o, n in stated["metadata"]], str(stated["digest"])
    except (ValueError, LookupError, TypeError, RecursionError):
        raise ValueError("its digest is damaged") from None
    if body != begins - 1 or read(file, body, 1) != b"\n" or any(o < 0 or n < 0 or o + n > body for o, n in ranges):
        raise ValueError("its digest is damaged")
    if found != _digest_of(file, body, ranges):
        raise ValueError("it does not fit its digest")
    return found


def read(file: BinaryIO, offset: int, length: int) -> bytes:
    """These bytes of an open file, fewer at its end."""
    file.seek(offset)
    pieces = []
    while length > 0 and (piece := file.read(min(length, _BLOCK))):
        pieces.append(piece)
        length -= len(piece)
    return b"".join(pieces)


def digest(pieces: Iterable[bytes]) -> str:
    """BLAKE2b of the pieces put together, 64 hexadecimal digits."""
    found = hashlib.blake2b(digest_size=32)
    for piece in pieces:
        found.update(piece)
    return found.hexdigest()


def _digest_of(file: BinaryIO, size: int, ranges: Sequence[tuple[int, int]]) -> str:
    places = ((at, min(_BLOCK, begin + length - at)) for begin, length in ranges for at in range(begin, begin + length, _BLOCK))
    return f"blake2b:{digest(chain([json.dumps([size, ranges]).encode()], (read(file, *place) for place in places)))}"
