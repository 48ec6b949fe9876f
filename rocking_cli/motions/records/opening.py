"""Files that hold a packed text, and files that are no text."""

from __future__ import annotations

import gzip
import io
import zlib

from ...documents.files import LARGEST
from ...errors import DocumentError, NoAcceleration
from .text import HEAD

PACKED = b"\x1f\x8b"  # gzip
_COUNTS = "counts of an instrument and no unit; convert it to an acceleration with the station's response first"


def unpack(source: str, raw: bytes) -> bytes:
    """The bytes of a file, unpacked if it is a gzip file. Raises DocumentError."""
    if not raw.startswith(PACKED):
        return raw
    try:
        with gzip.open(io.BytesIO(raw)) as file:
            unpacked = file.read(LARGEST + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise DocumentError(f"{source}: a damaged gzip file ({error})") from None
    if len(unpacked) > LARGEST:
        raise DocumentError(f"{source}: larger than {LARGEST >> 20} MiB when unpacked, the limit of a file")
    return unpacked


def refuse_binary(source: str, raw: bytes) -> None:
    """Raise DocumentError for an empty file, NoAcceleration for archives, SAC and miniSEED, and for all else that is no text."""
    if not (raw[:HEAD].strip() or raw.strip()):
        raise DocumentError(f"{source}: empty; expected a record or a motion document")
    if raw.startswith(b"PK\x03\x04") or raw[257:262] == b"ustar":
        raise NoAcceleration(f"{source}: an archive (zip or tar); unpack it and name the files in it")
    if raw[:3] == b"MS\x03" or (raw[:6].strip(b" 0123456789") == b"" and raw[6:7] in b"DRQM" and raw[7:8] in b" \0" and len(raw) >= 48):
        raise NoAcceleration(f"{source}: miniSEED, which holds {_COUNTS}")
    if len(raw) >= 632 and raw[304:308] in (b"\x06\0\0\0", b"\0\0\0\x06", b"\x07\0\0\0", b"\0\0\0\x07"):
        raise NoAcceleration(f"{source}: SAC, which holds {_COUNTS}")
    if raw[:HEAD].split(None, 6)[:5] == [b"-12345.00"] * 5 or raw[:HEAD].count(b"-12345.00") > 20:
        raise NoAcceleration(f"{source}: SAC (alphanumeric), which holds {_COUNTS}")
    if 100 * raw[:HEAD].count(0) > len(raw[:HEAD]):  # some headers of real files pad a name with a few
        raise NoAcceleration(f"{source}: a binary file; expected a record or a motion document in text")
