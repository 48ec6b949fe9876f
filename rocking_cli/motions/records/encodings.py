"""The encodings of record files: UTF-8, UTF-16 with its mark, and older code pages."""

_UTF_16 = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}


def as_utf_8(raw: bytes) -> bytes:
    """Return a text without its byte order mark, in UTF-8 if it was UTF-16."""
    if (encoding := _UTF_16.get(raw[:2])) is not None:
        return raw[2:].decode(encoding, "replace").encode("utf-8", "replace")
    return raw.removeprefix(b"\xef\xbb\xbf")


def encoding_of(raw: bytes) -> str:
    """UTF-8 if the bytes are valid in it, else the code page of Windows or Latin-1."""
    for encoding in ("utf-8", "cp1252"):
        try:
            raw.decode(encoding)
        except UnicodeDecodeError:
            continue
        return encoding
    return "latin-1"
