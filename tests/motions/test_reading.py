"""The motion of a file and of a set: documents and records told apart, scaled, turned
over, and what becomes of other files.
"""

from __future__ import annotations

import gzip
import io
import os
import re
import sys
import threading
from dataclasses import replace

import numpy as np
import pytest
from support.record_layouts import at2, of_a_station, wave

from rocking_cli import DocumentError, Motion, UsageError, intensity, pulse, read_record
from rocking_cli.motions.reading import (
    factor_to,
    holds_records,
    read_motion,
    read_motions,
)

ESM = "EVENT_NAME: \nSAMPLING_INTERVAL_S: 0.01\nNDATA: 3"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for i, name in enumerate(("b.AT2", "a.AT2")):
        (tmp_path / name).write_text(at2(wave(40, 0.2 + 0.1 * i), 0.02))
    (tmp_path / "c.txt.gz").write_bytes(
        gzip.compress(b"0 0\n0.1 1.0\n0.2 -2.0\n0.3 0\n")
    )
    (tmp_path / "block.yaml").write_text("kind: block\nwidth: 1\nheight: 3\n")
    (tmp_path / "pulse.yaml").write_text("points: [[0, 0], [1, 1], [2, 0]]\n")
    (tmp_path / "binary.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(500))
    (tmp_path / "list").write_text("# ours\na.AT2\n\nb.AT2\n")
    return tmp_path


def labels(found):
    return [r.label for r in found]


def test_another_column_and_other_skipped_lines_are_another_record(tmp_path):
    """What was computed of one is not taken for the other, when a run goes on."""
    path = tmp_path / "r.csv"
    path.write_text("".join(f"0.{n},{n % 3 - 1},{n % 4 - 1.5}\n" for n in range(10)))
    given = ({"column": "2"}, {"column": "3"}, {"column": "2", "skip": "2"})
    found = [read_motions([str(path)], unit="m/s2", **one)[0] for one in given]
    assert len({str(one.identity()) for one in found}) == 3


def test_files_a_list_and_standard_input_name_the_same_set(folder, monkeypatch):
    by_name = read_motions(["a.AT2", "b.AT2"])
    assert labels(by_name) == ["a", "b"]
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"a.AT2\nb.AT2\n")))
    for other in (read_motions(["list"]), read_motions(["-"])):
        assert [r.identity() for r in other] == [r.identity() for r in by_name]
    monkeypatch.setattr(
        sys, "stdin", io.TextIOWrapper(io.BytesIO((folder / "a.AT2").read_bytes()))
    )
    (only,) = read_motions(["-"])  # a record on standard input is a set of one
    assert (only.label, only.acceleration) == (
        "record",
        pytest.approx(0.3 * 9.81, rel=1e-6),
    )


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_a_list_as_windows_writes_it(folder, encoding):
    (folder / "list").write_bytes(
        "# für uns\r\na.AT2\r\n\r\nb.AT2 \r\n".encode(encoding)
    )
    assert labels(read_motions(["list"])) == ["a", "b"]


def test_a_list_names_the_file_that_is_missing_and_takes_paths_of_windows(folder):
    (folder / "list").write_text("moved.AT2\nb.AT2\n")
    with pytest.raises(UsageError, match=r"^moved\.AT2: "):
        read_motions(["list"])
    (folder / "set").mkdir()
    (folder / "a.AT2").rename(folder / "set" / "a.AT2")
    (folder / "list").write_text("set\\a.AT2\nb.AT2\n")
    assert labels(read_motions(["list"])) == ["a", "b"]


def test_a_packed_document_is_a_motion_and_no_fault_quotes_packed_bytes(folder):
    (folder / "pulse.yaml.gz").write_bytes(
        gzip.compress((folder / "pulse.yaml").read_bytes())
    )
    assert (
        read_motion("pulse.yaml.gz").acceleration
        == read_motion("pulse.yaml").acceleration
    )
    (folder / "x.gz").write_bytes(gzip.compress(b"kind: block\n"))
    for call in (read_motion, lambda path: read_motions([path, "a.AT2"])):
        with pytest.raises(DocumentError) as error:
            call("x.gz")
        assert str(error.value).isprintable()
        assert "\\x" not in str(error.value)


def test_no_two_records_have_one_name(folder):
    alike = read_motions(["a.AT2", "list"])
    assert labels(alike) == [r.motion.name for r in alike] == ["a (1)", "a (2)", "b"]
    (folder / "a (1).AT2").write_bytes((folder / "a.AT2").read_bytes())
    assert labels(read_motions(["a.AT2", "a (1).AT2", "a.AT2"])) == [
        "a (2)",
        "a (1)",
        "a (3)",
    ]


def test_of_a_directory_the_records_are_taken(folder):
    with pytest.raises(DocumentError, match="without a unit"):
        read_motions(["."])
    (folder / "c.txt.gz").unlink()
    said: list[str] = []
    assert labels(read_motions(["."], tell=said.append)) == ["a", "b"]
    assert sorted(line.partition(":")[0] for line in said) == [
        "./binary.h5",
        "./block.yaml",
        "./list",
        "./pulse.yaml",
    ]


def test_of_a_directory_uncorrected_accelerograms_are_left_out_and_said(folder):
    """The corrected ones may lie beside them, and would be counted twice; velocities
    are left out too.
    """
    (folder / "set").mkdir()
    text = (folder / "a.AT2").read_text()
    (folder / "set" / "a.AT2").write_text(text)
    (folder / "set" / "z.VT2").write_text(text.replace("ACCELERATION", "VELOCITY"))
    uncorrected = (
        ("b.V1", "Uncorrected Accelerogram Data"),
        ("c.V1A", "Uncorrected accelerogram 1 GNS Science"),
        ("d.V1", "* VOL1DS FILE"),
        ("e.V1c", "Uncorrected acceleration  (Format v01.20 with 13 text lines)"),
        ("f.V1c", "Raw acceleration          (Format v01.20 with 13 text lines)"),
        ("g.smc", "1 UNCORRECTED ACCELEROGRAM"),
        ("h.DAT", f"{ESM}\nDATA_TYPE: UNPROCESSED ACCELERATION"),
        ("i.ASC", f"{ESM}\nDATA_TYPE: ACCELERATION\nPROCESSING: none"),
    )
    for name, first in uncorrected:
        (folder / "set" / name).write_text(f"{first}\n1 2 3\n")
    said: list[str] = []
    assert labels(read_motions(["set"], tell=said.append)) == ["a"]
    assert [line.split(":")[0] for line in said] == [
        f"set/{name}" for name, _ in (*uncorrected, ("z.VT2", ""))
    ]
    assert all(
        line.endswith(
            "an uncorrected accelerogram, which is taken where the file itself is"
            " named; left out"
        )
        for line in said[:-1]
    )
    assert "VELOCITY" in said[-1]
    with pytest.raises(DocumentError, match="the file ends within its header"):
        read_motions(["set/b.V1"])


@pytest.fixture
def mixed(folder):
    """A station of three components, numbers without a unit, half a file, and text that
    is no record.
    """
    text = (folder / "a.AT2").read_text()
    files = {
        "a.AT2": text,
        "half.AT2": text[:-100],
        "up.AT2": text.replace("\n\n", "\nNowhere, 1/2/1900, Some Station, UP\n"),
    }
    files |= {
        "still.csv": "0 0\n0.1 0\n0.2 0\n",
        "plain.csv": "0 0\n0.1 1\n0.2 -1\n",
        "README": "free\n",
    }
    files["station.txt"] = of_a_station(
        wave(50, 200.0), wave(50, 150.0), wave(50, 90.0)
    )
    (folder / "set").mkdir()
    for name, content in files.items():
        (folder / "set" / name).write_text(content)
    (folder / "set" / "link").symlink_to("nowhere")
    return folder


def test_one_file_ends_no_set(mixed):
    said, unread = list[str](), list[str]()
    assert labels(read_motions(["set"], tell=said.append, unread=unread.append)) == [
        "a",
        "station N-S",
        "station E-W",
    ]
    assert said == [
        "set/README: left out, no record format",
        (
            "set/up.AT2: holds UP and no horizontal component; left out, `component`"
            " all takes it"
        ),
    ]
    assert [line.split(":")[0] for line in unread] == [
        "set/half.AT2",
        "set/link",
        "set/plain.csv",
        "set/still.csv",
    ]
    assert all(line.endswith("; left out") for line in unread)
    with pytest.raises(DocumentError, match=r"half\.AT2:\d+: the file ends after"):
        read_motions(["set/half.AT2"], unread=unread.append)


def test_what_a_list_names_is_not_quoted(folder):
    (folder / "secret").write_text("root:secret\n")
    (folder / "names").write_text("secret\n")
    with pytest.raises(DocumentError) as error:
        read_motions(["names"])
    assert str(error.value) == "secret: no record format; a set holds records only"
    with pytest.raises(DocumentError, match="it begins with 'root:secret'"):
        read_motions(["a.AT2", "secret"])


def test_a_unit_goes_to_the_plain_numbers_of_a_directory(mixed):
    unread: list[str] = []
    found = read_motions(["set"], unit="g", component="all", unread=unread.append)
    assert labels(found) == [
        "a",
        "plain",
        "station N-S",
        "station E-W",
        "station U-D",
        "up UP",
    ]
    assert (
        "set/still.csv: motion 'still': zero throughout; the motion must have a"
        " non-zero value; left out" in unread
    )
    with pytest.raises(UsageError, match="`unit`: found 'furlong'"):
        read_motions(["set"], unit="furlong", unread=unread.append)


def test_what_is_stated_beside_a_file_goes_before_the_rest(mixed):
    (mixed / "b,c.txt").write_text("Kobe\n0 0 0\n0.1 1 2\n0.2 -1 -2\n")
    (first, second) = read_motions(
        ["b,c.txt,unit=g,column=3,skip=1", "b,c.txt,unit=gal, column=2,skip=1"],
        unit="m/s2",
        column="1",
    )
    assert (first.acceleration, second.acceleration) == (2.0 * 9.81, 0.01)
    assert labels((first, second)) == ["b,c (1)", "b,c (2)"]
    assert read_motion("set/station.txt,component=E-W").acceleration == 1.5
    assert holds_records("a.AT2,dt=0.02")
    read_motions(["a.AT2,dt=20 ms,unit=g"])
    for stated, words in (
        ("a.AT2,dt=0.03", "`dt`: found 0.03 s; the file says otherwise"),
        ("a.AT2,unit=mile", "`unit`: found 'mile'"),
        ("a.AT2,dt=x", "`dt`: "),
        ("a.AT2,colour=red", "a.AT2: found colour= beside the file"),
    ):
        with pytest.raises((DocumentError, UsageError), match=words):
            read_motions([stated])


def test_the_vertical_component_of_the_same_file_shakes_with_each_horizontal_one(mixed):
    unread: list[str] = []
    found = read_motions(["set"], vertical=0.5, unread=unread.append)
    assert labels(found) == ["station N-S", "station E-W"]
    assert (
        "set/a.AT2: holds no vertical component, only one without a name" in unread[0]
    )
    for r, peak in zip(found, (200.0, 150.0), strict=True):
        assert r.motion.vertical.largest * r.acceleration == pytest.approx(
            0.5 * 0.9, rel=1e-12
        )
        assert r.acceleration == pytest.approx(0.01 * peak, rel=1e-12)
    one = read_motion("set/station.txt", component="E-W", vertical=0.5)
    assert one.vertical.value([0.3, 0.5]) == pytest.approx(
        found[1].motion.vertical.value([0.3, 0.5]), rel=1e-14
    )


def test_what_a_path_holds(folder):
    held = {
        name: holds_records(name)
        for name in (*sorted(os.listdir()), ".", "-", "nowhere")
    }
    assert {name for name, there in held.items() if there} == {
        "a.AT2",
        "b.AT2",
        "c.txt.gz",
        "list",
        ".",
    }


def test_one_document_is_a_motion_and_belongs_to_no_set(folder):
    found = read_motions(["pulse.yaml"], scale=2.0)
    assert (isinstance(found, Motion), found.largest) == (True, 2.0)
    with pytest.raises(
        DocumentError,
        match=r"pulse\.yaml: no record format .* a set holds records only",
    ):
        read_motions(["a.AT2", "pulse.yaml"])


def test_a_set_is_scaled_record_by_record(folder):
    assert [
        r.acceleration for r in read_motions(["list"], scale_to="PGA=0.5g")
    ] == pytest.approx([0.5 * 9.81] * 2, rel=1e-12)
    assert [r.factor for r in read_motions(["list"], scale=-1.5)] == [-1.5, -1.5]


def test_a_pipe_is_read_where_somebody_writes_to_it(folder, monkeypatch):
    monkeypatch.setattr("rocking_cli.documents.files._PATIENCE", 0.01)
    os.mkfifo("pipe")
    with pytest.raises(UsageError, match="pipe: a pipe that nobody writes to"):
        read_motion("pipe")
    ends = os.open("pipe", os.O_RDWR)  # a writer who has not begun
    begin = threading.Timer(
        0.1, lambda: (os.write(ends, (folder / "a.AT2").read_bytes()), os.close(ends))
    )
    begin.start()
    assert np.array_equal(
        read_motion("pipe").value([0.3]), read_motion("a.AT2").value([0.3])
    )
    begin.join()


SAMPLES = wave(400, -2.5)
SCALED = [
    ("PGA=0.35g", 0.35 * 9.81),
    ("pgv=12 cm/s", 0.12),
    ("PGD=30 mm", 0.03),
    ("Arias=0.4", 0.4),
    ("CAV=3 m/s", 3.0),
]


@pytest.fixture
def plain(tmp_path):
    path = tmp_path / "plain.txt"
    path.write_text("".join(f"{x!r}\n" for x in SAMPLES.tolist()))
    return path


@pytest.mark.parametrize(("text", "value"), SCALED)
def test_a_record_is_scaled_to_a_measure(plain, text, value):
    record = read_record(plain, unit="m/s2", dt=0.02)
    factor = factor_to(record, text)
    scaled = replace(record, acceleration=factor * record.acceleration)
    assert getattr(intensity(scaled), text.partition("=")[0].lower()) == pytest.approx(
        value, rel=1e-12
    )
    assert factor > 0.0
    peak = int(np.argmax(np.abs(SAMPLES)))
    for turned, more in ((1.0, {}), (-1.0, {"scale": -1.0})):
        motion = read_motion(
            plain, unit="m/s2", dt=0.02, component="1", scale_to=text, **more
        )
        assert motion.acceleration == pytest.approx(factor * 2.5, rel=1e-14)
        assert float(motion.value(0.02 * peak)) == pytest.approx(
            turned * np.sign(SAMPLES[peak]), rel=1e-12
        )


def test_documents_and_pulses_are_turned_over_and_what_goes_with_a_record_is_refused(
    tmp_path,
):
    path = tmp_path / "own.yaml"
    path.write_text("points: [[0, 0], [0.25, 1], [0.75, -1], [1, 0]]\n")
    for given in (
        {"component": "NS"},
        {"unit": "g"},
        {"dt": 0.1},
        {"scale_to": "PGA=1"},
        {"vertical": 1.0},
    ):
        with pytest.raises(
            UsageError, match=f"`{next(iter(given))}` applies to a record only"
        ):
            read_motion(path, **given)
    phase = np.linspace(0.0, 7.0, 50)
    own = read_motion(path)
    np.testing.assert_array_equal(
        read_motion(path, scale=-2.0).value(phase), -2.0 * own.value(phase)
    )
    for name in (
        "sine",
        "cosine",
        "rectangular-impulse",
        "ricker-symmetric",
        "mavroeidis-papageorgiou",
    ):
        turned = pulse(name).scaled(-1.0)
        np.testing.assert_allclose(
            turned.value(phase), -pulse(name).value(phase), rtol=1e-12, atol=1e-15
        )
        assert turned.largest == pytest.approx(pulse(name).largest, rel=1e-12)
        assert len(turned.segments) == len(pulse(name).segments)
    path.write_text("kind: block\n")
    with pytest.raises(DocumentError, match="found a structure, of kind block"):
        read_motion(path)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            {"scale_to": "PGA"},
            (
                "`scale_to`: found 'PGA'; expected MEASURE=VALUE, such as PGA=0.35g,"
                " with one of PGA, PGV, PGD, Arias, CAV"
            ),
        ),
        ({"scale_to": "SA=1g"}, "SA: found no period; expected a time"),
        (
            {"scale_to": "PGA=1 m"},
            "`scale_to` PGA: found '1 m'; expected an acceleration",
        ),
        ({"scale_to": "PGA=0"}, "expected a positive intensity"),
        ({"scale_to": "PGA=-0.1g"}, "expected a positive intensity"),
        ({"scale_to": "PGA=1", "scale": 2.0}, "found both"),
        ({"scale": 0.0}, "a scale of 0"),
        ({"scale": 1e308}, "expected a number that is not zero, up to 1e+100"),
        ({"component": "2"}, "expected 1, the only one"),
    ],
)
def test_choices_that_do_not_fit(plain, given, words):
    with pytest.raises(UsageError, match=re.escape(words)):
        read_motion(plain, unit="m/s2", dt=0.02, **given)


def test_the_memory_of_a_long_record_is_said_beforehand(plain, monkeypatch):
    monkeypatch.setattr("rocking_cli.motions.reading.LONG", 3)
    monkeypatch.setattr("rocking_cli.motions.reading._BYTES", 1e9)
    said = []
    read_motion(plain, unit="m/s2", dt=0.02, tell=said.append)
    assert said == [
        f"{plain}: 400 samples; a response to them takes about 4e+02 GB of memory"
    ]
