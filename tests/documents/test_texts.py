"""Bytes to text: the encodings of Windows, and files that hold no text, which are named
and never quoted.
"""

import io
import zipfile

import pytest

from rocking_cli import (
    DocumentError,
    parse_documents,
    read_documents,
    read_hazard,
    read_spectrum,
)
from rocking_cli.documents import texts
from rocking_cli.documents.parsing import documents_in
from rocking_cli.documents.texts import text_of
from rocking_cli.fragility.counts import read_counts
from rocking_cli.fragility.measures import site_pulses

TEXT = "kind;name;width [cm]\nblock;Säule ² µ;45\n"


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32", "cp1252"]
)
def test_a_text_is_read_in_the_encodings_of_windows(encoding):
    assert text_of("f.csv", TEXT.encode(encoding)) == TEXT


@pytest.fixture
def _no_text_is_held(monkeypatch):
    monkeypatch.setattr(texts, "HELD", 90)
    monkeypatch.setattr(texts, "read_bytes", None)  # would fail


LARGE = "# façade\n" + TEXT + "block;Säule;0,5\n" * 40


@pytest.mark.usefixtures("_no_text_is_held")
@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32", "cp1252"]
)
def test_a_large_table_is_read_as_a_short_one(encoding, tmp_path):
    path = tmp_path / "f.csv"
    path.write_bytes(LARGE.encode(encoding))
    held = parse_documents(LARGE, str(path))
    assert [d.values for d in read_documents(path)] == [d.values for d in held]


@pytest.mark.usefixtures("_no_text_is_held")
@pytest.mark.parametrize(
    ("tail", "words"),
    [
        (b"block;\xe9;1\n", r"f\.csv:44: not a UTF-8 text \(byte 739\)"),
        (b"block;a\x01;1\n", r"f\.csv:44:8: found binary data \(.* U\+0001\)"),
        (b"block;a;1.234\n", r"f\.csv:44:3: found 1.234 beside 0,5, so that"),
        (b'block;"a;1\n', r"f\.csv:44:1: not valid CSV"),
    ],
)
def test_a_fault_of_a_large_table_is_told_before_its_first_row(tail, words, tmp_path):
    path = tmp_path / "f.csv"
    path.write_bytes(LARGE.encode() + tail)
    with pytest.raises(DocumentError, match=words):
        next(documents_in(path))


def archive(*names: str) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as file:
        for name in names:
            file.writestr(name, b"\x01\x02" * 99)
    return out.getvalue()


NO_TEXTS = [
    (
        archive("[Content_Types].xml", "xl/workbook.xml"),
        r"found an Excel workbook \(.xlsx\); expected a text: save it as CSV UTF-8",
    ),
    (archive("word/document.xml"), r"a Word document \(.docx\)"),
    (archive("mimetype", "Index/Tables.iwa"), "a Numbers or Pages file"),
    (archive("a.csv"), "a zip archive; expected a text: unpack it"),
    (b"\x1f\x8b\x08\0abc", "a gzip archive"),
    (b"\xd0\xcf\x11\xe0\xa1\xb1", "an old Office program"),
    (b"%PDF-1.7\n%\xe2\xe3", "a PDF"),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file"),
    (bytes(range(256)), r"not a UTF-8 text \(byte 128\)"),
]
READERS = [read_documents, read_hazard, read_spectrum, read_counts, site_pulses]


@pytest.mark.parametrize(("raw", "words"), NO_TEXTS)
@pytest.mark.parametrize("read", READERS)
def test_a_file_that_holds_no_text_is_named_and_not_quoted(read, raw, words, tmp_path):
    path = tmp_path / "f.csv"
    path.write_bytes(raw)
    with pytest.raises(DocumentError, match=words) as raised:
        read(path)
    assert str(raised.value).replace(str(path), "").isprintable()
