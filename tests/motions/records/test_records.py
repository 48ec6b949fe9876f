"""What all formats share: told apart by content, packed files, sets, components, and
what is no record.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import struct
import tarfile
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.packages import installed
from support.record_layouts import at2, of_a_station, wave
from support.refusals import refuses

from rocking_cli.errors import ArgumentError, DocumentError, RockingError, UsageError
from rocking_cli.motions import records
from rocking_cli.motions.reading import record_files
from rocking_cli.motions.records import Record, read_record, read_records
from rocking_cli.motions.records.record import (
    chosen,
    is_horizontal,
    is_vertical,
    vertical_of,
)

AT2 = at2(wave(500, 0.2))


def test_a_packed_file_is_read_and_told_by_its_own_bytes(tmp_path):
    path = tmp_path / "r.V2.gz"  # the content decides, not the name
    path.write_bytes(gzip.compress(AT2.encode()))
    found = read_record(path)
    assert (found.format, found.name, found.sha256) == (
        "PEER AT2",
        "r",
        hashlib.sha256(path.read_bytes()).hexdigest(),
    )


def test_a_set_is_files_a_directory_or_a_list(tmp_path):
    for name in ("b.AT2", "a.AT2", ".hidden"):
        (tmp_path / name).write_text(AT2)
    (tmp_path / "lists").mkdir()
    a, b, listing = (str(tmp_path / x) for x in ("a.AT2", "b.AT2", "lists/set.txt"))
    with pytest.raises(UsageError, match="a directory without files"):
        list(record_files([str(tmp_path / "lists")]))
    (tmp_path / "lists" / "set.txt").write_text("# a set\n../b.AT2\n\n../a.AT2\n")
    assert list(record_files([a, str(tmp_path)])) == [
        (a, True, None),
        (a, False, None),
        (b, False, None),
    ]
    assert [read_record(x).name for x, *_ in record_files([listing])] == ["b", "a"]


def archive(text):
    """A tar of one file, whose few nulls do not make it binary."""
    made, info = io.BytesIO(), tarfile.TarInfo("a.AT2")
    info.size = len(text)
    with tarfile.open(fileobj=made, mode="w") as tar:
        tar.addfile(info, io.BytesIO(text.encode()))
    return made.getvalue()


SAC = struct.pack("<110f", *[-12345.0] * 110)[:304] + struct.pack("<i", 6) + b"\0" * 400
REFUSED = [
    (b"", "empty"),
    (b"\n \n", "empty"),
    (SAC, "SAC, which holds counts"),
    (SAC[:304] + struct.pack(">i", 6) + b"\0" * 400, "SAC, which holds counts"),
    (b"000001D ABC  00HHZXX" + b"\0" * 100, "miniSEED, which holds counts"),
    (b"MS\x03" + b"\0" * 100, "miniSEED, which holds counts"),
    (b"abc\0def" * 50, "a binary file"),
    (gzip.compress(archive(AT2), mtime=0), "found a tar archive; expected a record"),
    (b"PK\x03\x04" + AT2.encode(), "found a zip archive; expected a record in text"),
    (
        gzip.compress(b"kind: block\n", mtime=0),
        "no record format (it begins with 'kind: block')",
    ),
    (b"kind: block\n", "no record format (it begins with 'kind: block')"),
    (gzip.compress(AT2.encode(), mtime=0)[:-20], "a damaged gzip file"),
    (gzip.compress(b"", mtime=0), "empty"),
]
test_what_is_no_record = refuses(
    read_records, DocumentError, REFUSED, file="a", literal=True
)


def test_a_file_too_large_is_refused_before_it_is_read(tmp_path, monkeypatch):
    path = tmp_path / "large.AT2"
    with open(path, "wb") as file:
        file.truncate(300_000_000)
    tracemalloc.start()
    with pytest.raises(DocumentError, match="larger than 256 MiB"):
        read_records(path)
    assert tracemalloc.get_traced_memory()[1] < 1_000_000
    tracemalloc.stop()
    (tmp_path / "packed.gz").write_bytes(gzip.compress(b"0 0\n" * 1000))
    monkeypatch.setattr(records, "LARGEST", 3999)
    with pytest.raises(DocumentError, match="when unpacked"):
        read_records(tmp_path / "packed.gz")


SPOILT = st.sampled_from(
    [
        b"",
        b" ",
        b"-",
        b".",
        b"9",
        b"x",
        b"\n",
        b"*",
        b"\0",
        b"\xff",
        b"E",
        b"nan",
        b"1e400",
        b"\r",
    ]
)


@pytest.mark.slow
@given(at=st.integers(0, len(AT2)), length=st.integers(0, 200), put=SPOILT)
@settings(max_examples=100, deadline=None)
def test_a_spoilt_file_is_a_record_or_one_sentence(at, length, put):
    raw = AT2.encode()
    refused, found = "", None
    try:
        found = records.records_of("a", raw[:at] + put + raw[at + length :])
    except RockingError as error:
        refused = str(error)
    assert found is None or 2 <= found[0].npts <= 5000
    assert not refused or (refused.startswith("a:") and "\n" not in refused)


OURS = """
import numpy as np

from rocking_cli.motions.records import Series
from rocking_cli.motions.records.text import Layout

NAME = "ours"


def recognise(head):
    {recognise}


def read(text):
    text.next_line()
    count, line = text.count(text.lines(1)[0]), text.line
    {read}
"""
READS = (
    'return [Series("N", 0.01, text.numbers(3, Layout(1)), "gal"), Series("E", 0.01,'
    ' np.zeros(count), "gal")]'
)


@pytest.fixture
def install(tmp_path, monkeypatch):
    """A function that installs a package with a record format, and writes a
    file of it.
    """

    def install(
        recognise: str = "return head.startswith('OURS')", read: str = READS
    ) -> None:
        installed(
            monkeypatch,
            tmp_path,
            records.GROUP,
            "ours",
            OURS.format(recognise=recognise, read=read),
        )
        (tmp_path / "a.txt").write_text("OURS\n3\n0\n50\n-20\n")

    return install


def test_an_installed_package_adds_a_format_which_says_its_own_fault(
    install, tmp_path, rocking
):
    install()
    first, second = read_records(tmp_path / "a.txt")
    assert (
        first.format,
        first.component,
        second.component,
        first.dt,
        list(first.acceleration),
    ) == ("ours", "N", "E", 0.01, [0, 0.5, -0.2])
    assert records.is_record(str(tmp_path / "a.txt"))
    assert [row["format"] for row in rocking("records", "a.txt", "--json").records] == [
        "ours"
    ] * 2
    (tmp_path / "a.txt").write_text("OURS\nmany\n")
    with pytest.raises(
        DocumentError, match=r"a.txt:2: found 'many' in the header; expected a number"
    ):
        read_records(tmp_path / "a.txt")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"recognise": "return 1 / 0"}, "ZeroDivisionError: division by zero"),
        ({"read": "raise SystemExit(0)"}, "SystemExit: 0"),
        (
            {"read": "return [Series('N', 0.01, [0.0] * count, 'gal')]"},
            "AttributeError: 'list' object has no attribute 'dtype'",
        ),
        *(
            ({"read": f"return {read}"}, "TypeError: read returns ")
            for read in (
                "None",
                "[('N', 0.01, np.zeros(count), 'gal')]",
                "[Series('N', 0.01, np.zeros(count), 'furlong')]",
                "[Series('N', 0.01, 1j * np.zeros(count), 'gal')]",
            )
        ),
    ],
)
def test_a_package_that_fails_is_named(install, tmp_path, rocking, changed, words):
    install(**changed)
    done = rocking("records", "a.txt")
    message = (
        "the record format ours, which the package of-ours adds and which cannot be"
        " used: "
    )
    assert (done.returncode, done.stdout) == (3, "")
    assert f"a.txt: {message}{words}" in done.stderr
    assert done.stderr.endswith("; expected a package that works\n")


def test_own_formats_never_look_for_packages(tmp_path, monkeypatch):
    def looked(*_):
        raise AssertionError("installed packages were searched")

    monkeypatch.setattr(records, "_entries", looked)
    (tmp_path / "a").write_text(AT2)
    assert read_record(tmp_path / "a").npts == 500


def test_options_may_repeat_what_a_file_says_and_not_contradict_it(tmp_path):
    (tmp_path / "a").write_text(AT2)
    assert (
        read_record(tmp_path / "a", unit="g", dt=0.01).acceleration.max()
        == read_record(tmp_path / "a").acceleration.max()
    )
    for stated, words in (
        (
            {"unit": "m/s2"},
            "a: `unit`: found m/s2; the file says otherwise: g \\(PEER AT2\\)",
        ),
        ({"dt": 0.02}, "a: `dt`: found 0.02 s; the file says otherwise: 0.01 s"),
    ):
        with pytest.raises(DocumentError, match=words):
            read_record(tmp_path / "a", **stated)
    with pytest.raises(
        UsageError,
        match=r"`column` goes with plain columns of numbers, not with PEER AT2",
    ):
        read_record(tmp_path / "a", column="2")
    with pytest.raises(
        UsageError, match=r"`column`: found '0'; expected a number from 1, all or"
    ):
        read_record(tmp_path / "a", column="0")


def record(component, form="COSMOS"):
    return Record("a", form, component, 0.01, np.array([0.0, 1.0]), None, "g", "a", "0")


def test_components_of_two_instruments_of_kiknet():
    found = [name for name in "123456" if is_vertical(record(name, "K-NET"))]
    assert found == ["3", "6"]
    assert [x for x in "123456" if is_horizontal(record(x, "K-NET"))] == [*"1245"]


def test_what_is_taken_of_a_file(tmp_path):
    station = tmp_path / "a"
    station.write_text(of_a_station(wave(50, 200.0), wave(50, 150.0), wave(50, 90.0)))
    level, every = ["N-S", "E-W"], ["N-S", "E-W", "U-D"]
    for component, names in (
        (None, level),
        ("horizontal", level),
        ("ALL", every),
        ("u-d", ["U-D"]),
        ("2", ["E-W"]),
    ):
        assert [r.component for r in chosen(read_records(station), component)] == names
    with pytest.raises(
        UsageError,
        match=r"a: component: found 'NS'; expected N-S, E-W, U-D, horizontal and all",
    ):
        chosen(read_records(station), "NS")
    for several in (None, "horizontal", "all"):
        with pytest.raises(UsageError, match="holds the components N-S, E-W"):
            read_record(station, component=several)
    assert vertical_of(read_records(station)).component == "U-D"
    with pytest.raises(UsageError, match="holds no vertical component, only N-S, E-W"):
        vertical_of(read_records(station)[:2])


def test_of_an_array_nothing_is_taken_unless_it_is_asked_for():
    array = [record(f"{angle} Deg") for angle in (0, 90, 180, 270)]
    with pytest.raises(
        UsageError,
        match=(
            "a: holds the components 0 Deg, 90 Deg, 180 Deg, 270 Deg; give one as"
            " component, or horizontal"
        ),
    ):
        chosen(array, None)
    assert chosen(array, "horizontal") == array


def test_a_record_of_an_array_is_that_of_a_file_of_its_numbers(tmp_path):
    samples = 3.0 * np.sin(0.1 * np.arange(200))
    numbers = "\n".join(repr(float(x)) for x in samples)
    (tmp_path / "a.txt").write_text(numbers)
    wanted = read_record(tmp_path / "a.txt", unit="m/s2", dt=0.02)
    found = Record.of(samples, 0.02)
    np.testing.assert_array_equal(found.acceleration, wanted.acceleration)
    assert found.dt == wanted.dt
    samples[0] = 9.0  # of the caller
    assert found.acceleration[0] == 0.0
    for wrong, said in (("abc", "expected samples"), ([[1.0, 2.0]], r"shape \(1, 2\)")):
        with pytest.raises(ArgumentError, match=said):
            Record.of(wrong, 0.02)
