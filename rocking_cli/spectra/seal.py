"""The seal of a finished spectra file: a digest of all its bytes but the chunks, checked before HDF5 is let near the file.

HDF5 takes its own bookkeeping on trust: one flipped bit there can make it return other numbers, loop for ever or crash. The seal
stands behind the end that HDF5 knows, as a line of JSON and a line that tells its length. The chunks have checksums of their own.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Sequence

_LAST = re.compile(rb"\nrocking seal 1 (\d{10})\n")
_LAST_LENGTH = 27


def seal(descriptor: int, places: Sequence[tuple[int, int]]) -> bytes:
    """The seal of an open file, whose chunks lie at these places (offset, length). Raises ValueError if they overlap."""
    size, end, metadata = os.fstat(descriptor).st_size, 0, []
    for begin, length in sorted(places):
        if begin < end:
            raise ValueError(f"two chunks lie at byte {begin}")
        if begin > end:
            metadata.append([end, begin - end])
        end = begin + length
    if end < size:
        metadata.append([end, size - end])
    line = json.dumps({"size": size, "metadata": metadata, "digest": _digest(descriptor, size, metadata)}).encode()
    return b"\n" + line + b"\nrocking seal 1 %010d\n" % len(line)


def sealed(descriptor: int) -> bool:
    """Whether an open file ends with a seal. Raises ValueError when it does, and the file is not what was sealed."""
    size = os.fstat(descriptor).st_size
    last = _LAST.fullmatch(read(descriptor, max(0, size - _LAST_LENGTH), _LAST_LENGTH))
    if last is None:
        return False
    begins = size - _LAST_LENGTH - int(last[1])
    if begins < 1:
        return False
    try:
        stated = json.loads(read(descriptor, begins, int(last[1])))
        body, metadata, digest = stated["size"], [(int(o), int(n)) for o, n in stated["metadata"]], stated["digest"]
    except (ValueError, LookupError, TypeError, RecursionError):
        raise ValueError("its seal is damaged") from None
    if body != begins - 1 or read(descriptor, body, 1) != b"\n" or any(o < 0 or n < 0 or o + n > body for o, n in metadata):
        raise ValueError("its seal is damaged")
    if digest != _digest(descriptor, body, metadata):
        raise ValueError("it is not what was sealed when it was finished")
    return True


def read(descriptor: int, offset: int, length: int) -> bytes:
    """These bytes of an open file, fewer where it ends before."""
    pieces = []
    while length > 0 and (piece := os.pread(descriptor, min(length, 1 << 24), offset)):
        pieces.append(piece)
        offset, length = offset + len(piece), length - len(piece)
    return b"".join(pieces)


def _digest(descriptor: int, size: int, metadata: Sequence[Sequence[int]]) -> str:
    digest = hashlib.blake2b(json.dumps([size, [list(place) for place in metadata]]).encode(), digest_size=32)
    for offset, length in metadata:
        for first in range(offset, offset + length, 1 << 24):
            digest.update(read(descriptor, first, min(1 << 24, offset + length - first)))
    return f"blake2b:{digest.hexdigest()}"
