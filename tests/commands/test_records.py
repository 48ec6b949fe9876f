"""`rocking records` at the shell."""

import gzip
import re

import numpy as np
import pytest
from support.record_layouts import at2, of_a_station, wave

COLUMNS = [
    "name",
    "format",
    "component",
    "npts",
    "dt",
    "duration",
    "pga",
    "pga_time",
    "pgv",
    "pgd",
    "arias",
    "cav",
    "d5_75",
    "d5_95",
]
COLUMNS += ["header_pga"]
AT2 = at2(wave(500, 0.2))


def test_a_row_a_component_in_si_units(rocking, tmp_path):
    (tmp_path / "a.AT2.gz").write_bytes(gzip.compress(AT2.encode()))
    first, second = rocking(
        "records", "a.AT2.gz", "configs/motions/synthetic.at2", "--json"
    ).records
    assert list(first)[: len(COLUMNS)] == COLUMNS
    assert (
        first["name"],
        first["format"],
        first["component"],
        first["npts"],
        first["header_pga"],
    ) == ("a", "PEER AT2", None, 500, None)
    assert first["pga"] == pytest.approx(0.2 * 9.81, rel=1e-6, abs=0)
    assert (first["dt"], first["duration"]) == (0.01, pytest.approx(4.99))
    assert (second["name"], second["npts"]) == ("synthetic", 1600)
    (row,) = rocking("records", "a.AT2.gz", "--csv").rows
    assert float(row["pga"]) == first["pga"]
    assert "pga [m/s2]" in rocking("records", "a.AT2.gz").stdout


def test_standard_input_and_plain_columns(rocking):
    row = rocking(
        "records",
        "-",
        "--unit",
        "g",
        "--dt",
        "10 ms",
        "--json",
        stdin="0\n0.1\n-0.2\n0\n",
    ).record
    assert (row["npts"], row["dt"], row["pga_time"], row["unit"]) == (
        4,
        0.01,
        0.02,
        "g",
    )
    assert row["pga"] == pytest.approx(1.962, rel=1e-14, abs=0)


def test_a_peak_that_the_header_contradicts_is_one_line_with_both_numbers(
    rocking, tmp_path
):
    keys = (
        "EVENT_NAME:\nNDATA: 3\nSAMPLING_INTERVAL_S: 0.01\nUNITS: cm/s^2\nSTREAM:"
        " HNN\nPGA_CM/S^2: -50.5\nDATA_TYPE: ACCELERATION\n"
    )
    (tmp_path / "a.asc").write_text(f"{keys}0\n-70.25\n69\n")
    done = rocking("records", "a.asc", "--json")
    row = done.record
    assert (done.returncode, row["component"], row["header_pga"], row["pga"]) == (
        0,
        "HNN",
        0.505,
        0.7025,
    )
    assert row["header_difference"] == pytest.approx(70.25 / 50.5 - 1.0)
    odd = (
        "a.asc: component HNN: the header states a PGA of 50.5 cm/s2, the samples have"
        " 70.25 cm/s2"
    )
    assert done.stderr.strip() == odd
    assert (
        rocking(
            "response", "configs/block.yaml", "--motion", "a.asc", "--json"
        ).stderr.splitlines()[0]
        == odd
    )


def test_the_shipped_record_is_what_its_recipe_makes(rocking):
    """The second line of the file, evaluated."""
    t, k = 0.01 * np.arange(1600), np.arange(1, 61)[:, None]
    f, phi = (
        0.4 * 25.0 ** (k / 60),
        2.0 * np.pi * np.modf(k * (np.sqrt(5.0) - 1.0) / 2.0)[0],
    )
    w = np.sum(np.sin(2.0 * np.pi * f * t + phi) / (1.0 + f**2), axis=0)
    e = np.where(
        t < 3.0, (t / 3.0) ** 2, np.where(t < 7.0, 1.0, np.exp(-0.6 * (t - 7.0)))
    )
    made = 9.81 * 0.4 * e * w / np.abs(e * w).max()
    row = rocking("records", "configs/motions/synthetic.at2", "--json").record
    assert row["pga"] == pytest.approx(np.abs(made).max(), rel=1e-7, abs=0)
    assert row["pga_time"] == pytest.approx(
        t[np.argmax(np.abs(made))], rel=1e-12, abs=0
    )
    # straight lines from one to the other: a trapezium, or two triangles where they
    # cross zero
    x, y = (made[:-1], made[1:])
    each = np.where(
        x * y >= 0.0, np.abs(x + y), (x**2 + y**2) / (np.abs(x) + np.abs(y))
    )
    assert row["cav"] == pytest.approx(0.005 * np.sum(each), rel=1e-7, abs=0)


RECORD = ("--motion", "configs/motions/synthetic.at2")


def test_plain_columns_as_a_motion(rocking, tmp_path):
    (tmp_path / "a.txt").write_text("0\n4\n-4\n0\n")
    call = (
        "response",
        "configs/block.yaml",
        "--motion",
        "a.txt",
        "--unit",
        "m/s2",
        "--events",
        "--json",
    )
    assert rocking(*call, "--motion-dt", "0.2").records[0]["event"] == "uplift"
    assert "numbers without times; give their step as --" in rocking(*call).stderr


def test_a_directory_is_read_to_its_end(rocking, tmp_path):
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "a.txt").write_text(
        of_a_station(wave(50, 200.0), wave(50, 150.0), wave(50, 90.0))
    )
    (tmp_path / "set" / "b.csv").write_text("0 0\n0.1 1\n0.2 0\n")
    (tmp_path / "set" / "c.AT2").write_text(AT2)
    for asked, names in (
        ((), ["N-S", "E-W", "U-D", None]),
        (("--component", "horizontal"), ["N-S", "E-W", None]),
    ):
        done = rocking("records", "set", "--json", "-q", *asked)
        assert (done.returncode, [row["component"] for row in done.records]) == (
            4,
            names,
        )
        assert re.fullmatch(
            "set/b.csv: plain numbers without a unit; give it as --unit.*; left out\n",
            done.stderr,
        )
    (tmp_path / "set" / "b.csv").write_text("free to use\n")
    done = rocking("records", "set")
    assert (done.returncode, done.stderr) == (
        0,
        "set/b.csv: left out, no record format\n",
    )


def test_a_spectrum_in_a_directory_is_left_out_and_named(rocking, tmp_path):
    """Its periods rise evenly, as times do; velocities beside an acceleration are no
    fault.
    """
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "a.csv").write_text("t [s],acc [g]\n0,0\n0.1,0.3\n0.2,-0.1\n")
    (tmp_path / "set" / "a.vel").write_text("0 0\n0.1 0.3\n0.2 -0.1\n")
    done = rocking("records", "set", "--unit", "g", "--json")
    assert (done.returncode, [row["name"] for row in done.records]) == (0, ["a"])
    assert re.search(
        r"set/a.vel:1: a file that is named as velocities.*; left out", done.stderr
    )
    (tmp_path / "set" / "s.csv").write_text("T [s],S_a [g]\n0,0.3\n0.1,0.5\n0.2,0.5\n")
    done = rocking("records", "set", "--unit", "g", "--json", "-q")
    assert (done.returncode, [row["name"] for row in done.records]) == (4, ["a"])
    assert re.fullmatch(
        r"set/s.csv:1: found 'T \[s\]' \(period\); .*; left out\n", done.stderr
    )
    done = rocking("records", "set/s.csv", "--unit", "g")
    assert (done.returncode, done.stdout) == (3, "")


def test_a_column_of_a_table_as_a_motion(rocking, tmp_path):
    (tmp_path / "a.csv").write_text("0 0 0 0\n0.2 1 4 2\n0.4 -1 -4 -2\n0.6 0 0 0\n")
    (row,) = rocking(
        "records", "a.csv", "--unit", "m/s2", "--column", "3", "--json"
    ).records
    assert (row["component"], row["pga"], row["dt"]) == (None, 4.0, 0.2)
    call = (
        "response",
        "configs/block.yaml",
        "--motion",
        "a.csv",
        "--unit",
        "m/s2",
        "--events",
        "--json",
    )
    assert rocking(*call, "--column", "3").records[0]["event"] == "uplift"
    refused = rocking(*call)
    assert (
        refused.returncode,
        "the number of one as --column" in refused.stderr,
    ) == (3, True)


def test_rows_under_a_record_stand_at_its_samples(rocking):
    call = ("response", "configs/block.yaml", *RECORD, "--scale-to", "PGA=0.35g")
    found = rocking(*call, "--csv").rows
    times, peak = (
        [float(r["t"]) for r in found],
        max(abs(float(r["ground_acceleration"])) for r in found),
    )
    assert peak == pytest.approx(0.35 * 9.81, rel=1e-12)
    assert all(any(abs(t - x) < 1e-9 for t in times) for x in (0.01, 0.02, 15.99))
    events = rocking(*call, "--csv", "--events").rows
    turns = [float(e["t"]) for e in events if e["event"] in ("impact", "peak")]
    assert turns
    assert all(min(abs(t - x) for t in times) < 1e-12 * x for x in turns)
    assert [float(r["t"]) for r in rocking(*call, "--csv", "--row-step", "0.5").rows][
        :3
    ] == pytest.approx([0.0, 0.5, 1.0])


def test_response_spectra_of_records(rocking, refused):
    given = ("records", "configs/motions/synthetic.at2", "--export-spectrum")
    found = rocking(
        *given, "--periods", "0.5:2:4", "--damping", "0.1", "--json"
    ).records
    assert [(row["name"], row["T"], row["damping"]) for row in found] == [
        ("synthetic", t, 0.1) for t in (0.5, 1.0, 1.5, 2.0)
    ]
    assert all(
        row["S_a"] == pytest.approx((2 * np.pi / row["T"]) ** 2 * row["S_d"])
        for row in found
    )
    assert len(rocking(*given, "--csv").rows) == 100
    assert "--periods goes with --export-spectrum" in refused(
        2, *given[:2], "--periods", "1"
    )
    assert "positive times" in refused(2, *given, "--periods", "0:1:3")
