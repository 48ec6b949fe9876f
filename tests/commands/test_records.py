"""`rocking records` at the shell."""

from __future__ import annotations

import gzip
import json

import numpy as np
import pytest
from support.documents import csv_rows
from support.record_layouts import of_a_station, rows, wave

COLUMNS = ["name", "format", "component", "npts", "dt", "duration", "pga", "pga_time", "pgv", "pgd", "arias", "cav", "d5_75", "d5_95"]
COLUMNS += ["header_pga"]
AT2 = "Title\nEvent\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 500, DT= .01 SEC\n" + rows(wave(500, 0.2), 5, "{:15.7E}")
VOLUME_1 = "Uncorrected Accelerogram Data\n" + 10 * "\n" + "No. of Points = 3  Record Length = .015 sec\n\n" + 14 * "    1\n"
VOLUME_1 += "3 Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)\n  .100000 -.200000  .100000\n"


def test_a_row_a_component_in_si_units(rocking, tmp_path):
    (tmp_path / "a.AT2.gz").write_bytes(gzip.compress(AT2.encode()))
    done = rocking("records", "a.AT2.gz", "configs/motions/synthetic.at2", "--json")
    first, second = (json.loads(x) for x in done.stdout.splitlines())
    assert list(first)[: len(COLUMNS)] == COLUMNS
    assert (first["name"], first["format"], first["component"], first["npts"], first["header_pga"]) == ("a", "PEER AT2", None, 500, None)
    assert first["pga"] == pytest.approx(0.2 * 9.81, rel=1e-6, abs=0)
    assert (first["dt"], first["duration"]) == (0.01, pytest.approx(4.99))
    assert (second["name"], second["npts"]) == ("synthetic", 1600)
    (row,) = csv_rows(rocking("records", "a.AT2.gz", "--csv").stdout)
    assert float(row["pga"]) == first["pga"]
    assert "pga [m/s2]" in rocking("records", "a.AT2.gz").stdout


def test_standard_input_and_plain_columns(rocking):
    done = rocking("records", "-", "--unit", "g", "--dt", "10 ms", "--json", stdin="0\n0.1\n-0.2\n0\n")
    (row,) = (json.loads(x) for x in done.stdout.splitlines())
    assert (row["npts"], row["dt"], row["pga_time"], row["unit"]) == (4, 0.01, 0.02, "g")
    assert row["pga"] == pytest.approx(1.962, rel=1e-14, abs=0)


def test_a_directory_leaves_out_what_is_no_record(rocking, tmp_path):
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "b.AT2").write_text(AT2)
    (tmp_path / "set" / "LICENSE").write_text("free to use\n")
    done = rocking("records", "set", "--json")
    assert [json.loads(x)["name"] for x in done.stdout.splitlines()] == ["b"]
    assert done.stderr.strip() == "set/LICENSE: left out, no record format"
    (tmp_path / "set" / "b.VT2").write_text(AT2.replace("ACCELERATION", "VELOCITY"))  # a download of PEER has all three
    done = rocking("records", "set", "--json")
    assert [json.loads(x)["name"] for x in done.stdout.splitlines()] == ["b"]
    assert "set/b.VT2:3: found 'VELOCITY" in done.stderr
    assert "; left out" in done.stderr
    (tmp_path / "set" / "a.mseed").write_bytes(b"MS\x03" + b"\0" * 100)
    assert "set/a.mseed: miniSEED, which holds counts" in rocking("records", "set").stderr
    assert rocking("records", "set/b.VT2").returncode == 3
    (tmp_path / "set" / "c.V1").write_text(2 * VOLUME_1)
    assert (
        "set/c.V1: an uncorrected accelerogram, which is taken where the file itself is named; left out" in rocking("records", "set").stderr
    )
    assert rocking("records", "set/c.V1").stderr.strip() == "set/c.V1: an uncorrected accelerogram"  # once for its two channels
    assert rocking("records", "set", "--json", "-q").stderr == ""


def test_a_peak_that_the_header_contradicts_is_one_line_with_both_numbers(rocking, tmp_path):
    keys = [
        "EVENT_NAME:",
        "NDATA: 3",
        "SAMPLING_INTERVAL_S: 0.01",
        "UNITS: cm/s^2",
        "STREAM: HNN",
        "PGA_CM/S^2: -50.5",
        "DATA_TYPE: ACCELERATION",
    ]
    (tmp_path / "a.asc").write_text("\n".join(keys) + "\n0\n-70.25\n0\n")
    done = rocking("records", "a.asc", "--json")
    row = json.loads(done.stdout)
    assert done.returncode == 0
    assert (row["component"], row["header_pga"], row["pga"]) == ("HNN", 0.505, 0.7025)
    assert row["header_difference"] == pytest.approx(70.25 / 50.5 - 1.0)
    odd = "a.asc: the header states a peak of component HNN of 50.5 cm/s2, the samples have 70.25 cm/s2"
    assert done.stderr.strip() == odd
    assert rocking("response", "configs/block.yaml", "--motion", "a.asc", "--json").stderr.splitlines()[0] == odd


def test_the_shipped_record_is_what_its_recipe_makes(rocking):
    """The second line of the file, evaluated."""
    t, k = 0.01 * np.arange(1600), np.arange(1, 61)[:, None]
    f, phi = 0.4 * 25.0 ** (k / 60), 2.0 * np.pi * np.modf(k * (np.sqrt(5.0) - 1.0) / 2.0)[0]
    w = np.sum(np.sin(2.0 * np.pi * f * t + phi) / (1.0 + f**2), axis=0)
    e = np.where(t < 3.0, (t / 3.0) ** 2, np.where(t < 7.0, 1.0, np.exp(-0.6 * (t - 7.0))))
    made = 9.81 * 0.4 * e * w / np.abs(e * w).max()
    row = json.loads(rocking("records", "configs/motions/synthetic.at2", "--json").stdout)
    assert row["pga"] == pytest.approx(np.abs(made).max(), rel=1e-7, abs=0)
    assert row["pga_time"] == pytest.approx(t[np.argmax(np.abs(made))], rel=1e-12, abs=0)
    x, y = made[:-1], made[1:]  # straight lines from one to the other: a trapezium, or two triangles where they cross zero
    each = np.where(x * y >= 0.0, np.abs(x + y), (x**2 + y**2) / (np.abs(x) + np.abs(y)))
    assert row["cav"] == pytest.approx(0.005 * np.sum(each), rel=1e-7, abs=0)


@pytest.mark.parametrize(
    ("files", "arguments", "code", "words"),
    [
        ({}, (), 2, "no record: give FILE"),
        ({}, ("nowhere.AT2",), 2, "nowhere.AT2: cannot be read"),
        ({"a": AT2[:-30]}, ("a",), 3, "a:104: the file ends after"),
        ({"a": AT2, "b": "kind: block\n"}, ("a", "b"), 3, "b: no record format"),
        ({"a": "0 1\n1 2\n"}, ("a",), 3, "a: plain numbers without a unit"),
        ({"a": "0 1\n1 2\n"}, ("a", "--unit", "cm/s"), 2, "unit: found 'cm/s'"),
        ({"a": "0\n1\n"}, ("a", "--unit", "g", "--dt", "0"), 3, "a: a time step of 0 s"),
        ({"a": "0\n1\n"}, ("a", "--unit", "g", "--dt", "1 m"), 2, "--motion-dt: found '1 m'"),
        ({"a": ""}, ("a",), 3, "a: empty"),
    ],
)
def test_bad_input_is_one_sentence(refused, tmp_path, files, arguments, code, words):
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    assert words in refused(code, "records", *arguments)


RECORD = ("--motion", "configs/motions/synthetic.at2")


def summary(done):
    assert done.returncode == 0, done.stderr
    return done.stderr.strip()


def test_a_response_runs_as_recorded_and_scaled(rocking):
    """The block under 0.4 g of the synthetic record: as it is; by factor and by measure it is the same motion."""
    call = ("response", "configs/block.yaml", *RECORD, "--model", "nonlinear", "--events", "--json")
    assert "largest theta 0.1844" in summary(rocking(*call))
    call = ("response", "configs/block.yaml", *RECORD, "--model", "linear", "--events", "--json")
    more = rocking(*call, "--scale", "1.25")
    assert "overturn" in summary(more)
    other = [json.loads(x) for x in rocking(*call, "--scale-to", "PGA=0.5g").stdout.splitlines()]
    for a, b in zip(other, (json.loads(x) for x in more.stdout.splitlines()), strict=True):
        assert a["event"] == b["event"]
        if a["event"] != "summary":
            assert a["t"] == pytest.approx(b["t"], rel=1e-9)


def test_the_nonlinear_equation_answers_for_a_record_where_the_geometry_is_known(rocking, tmp_path):
    (tmp_path / "stated.yaml").write_text("kind: parameters\np: 2\nalpha: 0.25\neta: 0.9\na_scale: 1\n")
    for file, more, model in (
        ("configs/block.yaml", (), "nonlinear"),
        ("configs/block.yaml", ("--model", "linear"), "linear"),
        ("stated.yaml", (), "linear"),
    ):
        assert f", {model}: " in rocking("response", file, *RECORD, "--scale", "0.5", "--csv", *more).stderr


def test_a_record_turned_over_turns_the_response_over(rocking):
    call = ("response", "configs/block.yaml", *RECORD, "--model", "linear", "--csv")
    rows_ = [csv_rows(rocking(*call, *scale).stdout) for scale in ((), ("--scale", "-1"))]
    for a, b in zip(*rows_, strict=True):
        assert float(a["theta"]) == -float(b["theta"])
        assert float(a["ground_acceleration"]) == -float(b["ground_acceleration"])


def test_a_spectrum_and_an_envelope_need_no_frequency(rocking):
    done = rocking(
        "spectrum", "configs/block.yaml", *RECORD, "--grid", "a_g=0.3g:0.5g:3", "--model", "linear", "--check", "0", "-o", "r.h5", "--json"
    )
    assert summary(done)
    done = rocking("convert", "r.h5", "--csv")
    ratios = [row["theta_ratio"] for row in csv_rows(done.stdout)]
    assert float(ratios[0]) > 0.0
    assert ratios[1] == "", "at 0.4 g the linear equation overturns"
    done = rocking(
        "spectrum", "configs/block.yaml", "configs/spire.yaml", *RECORD, "--grid", "A=1.1:1.5:2", "--check", "0", "-o", "A.h5", "-q"
    )
    assert summary(done) == ""
    done = rocking("envelope", "configs/block.yaml", *RECORD, "--a-max", "1.6", "--model", "linear", "--first", "--json")
    first = json.loads(done.stdout.splitlines()[0])
    assert 0.3 * 9.81 < first["a_from"] < 0.4 * 9.81


def test_plain_columns_as_a_motion(rocking, tmp_path):
    (tmp_path / "a.txt").write_text("0\n4\n-4\n0\n")
    call = ("response", "configs/block.yaml", "--motion", "a.txt", "--unit", "m/s2", "--events", "--json")
    assert json.loads(rocking(*call, "--motion-dt", "0.2").stdout.splitlines()[0])["event"] == "uplift"
    assert "one column of numbers" in rocking(*call).stderr


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("response", "configs/block.yaml", *RECORD, "--a-g", "1", "--T-g", "1"), 2, "a record runs in its own time"),
        (("response", "configs/block.yaml", *RECORD, "--T-g", "1"), 2, "a record runs in its own time"),
        (("response", "configs/block.yaml", "--scale-to", "PGA=1g", "--a-g", "1", "--T-g", "1"), 2, "--scale-to goes with a record"),
        (("response", "configs/block.yaml", *RECORD, "--pulse", "sine"), 2, "--motion does not go with --pulse"),
        (("response", "configs/block.yaml", *RECORD, "--scale", "0"), 2, "a scale of 0"),
        (("response", "configs/block.yaml", *RECORD, "--scale", "2", "--scale-to", "PGA=1"), 2, "found both"),
        (("spectrum", "configs/block.yaml", *RECORD, "--grid", "a_g=1:2:3,T_g=1", "-o", "x.h5"), 2, "a record runs in its own time"),
        (("envelope", "configs/block.yaml", *RECORD, "--grid", "T_g=1"), 2, "a record runs in its own time"),
        (("envelope", "configs/block.yaml"), 2, "no --grid"),
        (("spectrum", "--eta", "0.9", *RECORD, "--grid", "A=1:2:3", "-o", "x.h5"), 2, "no units"),
    ],
)
def test_what_does_not_go_with_a_record(refused, arguments, code, words):
    assert words in refused(code, *arguments)


def test_a_directory_is_read_to_its_end(rocking, tmp_path):
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "a.txt").write_text(of_a_station(wave(50, 200.0), wave(50, 150.0), wave(50, 90.0)))
    (tmp_path / "set" / "b.csv").write_text("0 0\n0.1 1\n0.2 0\n")
    (tmp_path / "set" / "c.AT2").write_text(AT2)
    for asked, names in ((), ["N-S", "E-W", "U-D", None]), (("--component", "horizontal"), ["N-S", "E-W", None]):
        done = rocking("records", "set", "--json", "-q", *asked)
        assert [json.loads(x)["component"] for x in done.stdout.splitlines()] == names
        assert done.returncode == 4
        assert done.stderr.startswith("set/b.csv: plain numbers without a unit; give it as --unit")
        assert done.stderr.endswith("; left out\n")
    (tmp_path / "set" / "b.csv").unlink()
    assert rocking("records", "set").returncode == 0


def test_rows_under_a_record_stand_at_its_samples(rocking):
    call = ("response", "configs/block.yaml", *RECORD, "--scale-to", "PGA=0.35g")
    found = csv_rows(rocking(*call, "--csv").stdout)
    times, peak = [float(r["t"]) for r in found], max(abs(float(r["ground_acceleration"])) for r in found)
    assert peak == pytest.approx(0.35 * 9.81, rel=1e-12)
    assert all(any(abs(t - x) < 1e-9 for t in times) for x in (0.01, 0.02, 15.99))
    events = csv_rows(rocking(*call, "--csv", "--events").stdout)
    turns = [float(e["t"]) for e in events if e["event"] in ("impact", "peak")]
    assert turns
    assert all(min(abs(t - x) for t in times) < 1e-12 * x for x in turns)
    assert [float(r["t"]) for r in csv_rows(rocking(*call, "--csv", "--dt", "0.5").stdout)][:3] == pytest.approx([0.0, 0.5, 1.0])
