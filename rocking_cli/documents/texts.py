"""Bytes of a file to its text; a file that holds no text is refused by what it is, and
never quoted.
"""

import re

from ..errors import DocumentError
from .composition import Place, place_in

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
    (b"CDF", "a netCDF file", "export it as CSV"),
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


def text_of(source: str, raw: bytes) -> str:
    """Return the text of a file's bytes: UTF-8, UTF-16 or UTF-32 with a byte order
    mark, or else cp1252 as Windows programs write it. Raises DocumentError for bytes
    that are no text.
    """
    if found := packed(raw):
        raise DocumentError(
            f"{Place(source, 1, 1)}: found {found[0]}; expected a text: {found[1]}"
        )
    mark, encoding = next(
        (pair for pair in _MARKS if raw.startswith(pair[0])), (b"", "utf-8")
    )
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


def packed(raw: bytes) -> tuple[str, str] | None:
    """Return (what a file is, what to do with it) for a format that holds no text, None
    for any other bytes.
    """
    if raw.startswith(b"PK\x03\x04"):
        return next((name, advice) for inside, name, advice in _PACKED if inside in raw)
    return next(
        ((name, advice) for start, name, advice in _FORMATS if raw.startswith(start)),
        None,
    )


def refuse_binary(source: str, text: str) -> None:
    """Raise DocumentError for a text with control characters, which only binary data
    holds.
    """
    if found := _BINARY.search(text):
        place = place_in(text, found.start(), source)
        raise DocumentError(
            f"{place}: found binary data (the control character U+{ord(found[0]):04X});"
            " expected a text"
        )
