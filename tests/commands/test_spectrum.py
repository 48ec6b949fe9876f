"""`rocking spectrum` at the shell: what it writes, what it says, and the calls a user
gets wrong.
"""

import os
import re
import signal
import subprocess

import h5py
import numpy as np
import pytest
from support.watched_processes import PATIENCE, PROGRAM, grows

from rocking_cli import (
    LinearEquation,
    Outcome,
    SpectraFile,
    System,
    UsageError,
    history,
    sine,
)
from rocking_cli.dynamics import batch
from rocking_cli.interruption import STOPS

SMALL = "A=0.5:9:40,Omega=0.5:12:30"


def test_summary_and_file(rocking, tmp_path):
    done = rocking(
        "spectrum",
        "configs/block.yaml",
        "configs/spire.yaml",
        "--grid",
        SMALL,
        "-o",
        "s.h5",
        *("--json", "--notes"),
    )
    assert done.returncode == 0, done.stderr
    record = done.record
    assert record["cells"] == 2400
    assert record["largest_difference"] < 1e-12
    assert "us a cell" in done.stderr
    assert "skipped: " in done.stderr
    with h5py.File(tmp_path / "s.h5") as f:
        assert f["structure"].asstr()[...].tolist() == ["Column", "Spire"]
        assert re.match(
            r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ: rocking spectrum configs/block.yaml",
            f.attrs["history"],
        )
        assert f.attrs["cells"] == 2400
        assert "kind: spire" in f.attrs["documents"]


def test_quantities_on_request_are_variables_of_the_file(rocking, tmp_path):
    done = rocking(
        "spectrum",
        "--eta",
        "0.9",
        "--grid",
        "A=0.5:9:7,Omega=5",
        "--quantity",
        "condition",
        "--impacts",
        "-o",
        "s.h5",
    )
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "s.h5") as f:
        condition, theta = f["condition"][0, 0], f["theta_ratio"][0, 0]
        assert f["condition"].attrs["units"] == "1"
        assert "tolerance" in f["condition"].attrs["comment"]
        assert f["impacts_at_least"].shape == f["condition"].shape
    assert theta[0] == 0.0
    assert np.isnan(condition[~(theta > 0.0)]).all()
    rows = rocking("convert", "s.h5", "--json").records
    assert [row["condition"] for row in rows] == [
        None if np.isnan(x) else x for x in condition
    ]


@pytest.mark.soak
def test_arches_and_spires_sweep_like_any_other_structure(rocking, tmp_path):
    """A cell of the spectrum overturns just where it lies inside an interval of the
    envelope.
    """
    files, periods = (
        [f"configs/{name}.yaml" for name in ("arch", "spire_cracked", "prism")],
        "T_g=1.6",
    )
    assert (
        rocking(
            "spectrum", *files, "--grid", f"a_g=0.1g:2g:20,{periods}", "-o", "s.h5"
        ).returncode
        == 0
    )
    envelope = rocking(
        "envelope",
        *files,
        "--grid",
        periods,
        "--a-max",
        "2.1g",
        "--sign",
        "+",
        "--json",
    )
    rows = envelope.records
    with h5py.File(tmp_path / "s.h5") as f:
        outcome, a_g, omega_g = f["outcome"][...], f["a_g"][...], f["omega_g"][...]
        names = f["structure"].asstr()[...].tolist()
    inside = np.zeros(outcome.shape, dtype=bool)
    for row in rows:
        if row["a_from"] is not None:
            place = (
                names.index(row["structure"]),
                int(np.abs(omega_g - row["omega_g"]).argmin()),
            )
            inside[place] |= (a_g > row["a_from"]) & (a_g < (row["a_to"] or np.inf))
    assert {row["structure"] for row in rows} == set(names)
    np.testing.assert_array_equal(outcome >= 3, inside)
    assert 10 < inside.sum() < inside.size - 10


def test_an_input_is_never_the_output(refused, tmp_path):
    (tmp_path / "mine.doc").write_text("kind: block\nwidth: 1\nheight: 5")
    (tmp_path / "mine.dat").write_text("0\n1\n-1\n")
    (tmp_path / "link.h5").symlink_to("mine.dat")
    (tmp_path / "set.lst").write_text("mine.dat\n")
    assert "is an input of this call" in refused(
        2, "spectrum", "mine.doc", "--grid", SMALL, "-o", "mine.doc", "--overwrite"
    )
    shaken = (
        "spectrum",
        "mine.doc",
        "--unit",
        "g",
        "--dt",
        "0.1",
        "--overwrite",
        "--motion",
    )
    for motion, output in (
        ("mine.dat", "mine.dat"),
        ("mine.dat", "link.h5"),
        ("mine.dat,unit=g", "mine.dat"),
        ("set.lst", "mine.dat"),
        ("set.lst", "set.lst"),
    ):
        assert f"{output} is an input of this call" in refused(
            2, *shaken, motion, "-o", output
        )


def heed_signals():
    """Let a process heed signals that its parent ignores, as under nohup."""
    for stop in STOPS:
        signal.signal(stop, signal.SIG_DFL)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("workers", "stop"),
    [
        ("2", signal.SIGTERM),
        pytest.param("2", signal.SIGINT, marks=pytest.mark.soak),
        *(
            pytest.param("2", stop, marks=pytest.mark.soak)
            for stop in set(STOPS) - {signal.SIGTERM, signal.SIGINT}
        ),
        pytest.param("1", signal.SIGTERM, marks=pytest.mark.soak),
    ],
)
def test_every_signal_that_stops_keeps_what_was_done(tmp_path, workers, stop):
    call = [
        *PROGRAM,
        "spectrum",
        "--eta",
        "0.9",
        "--grid",
        "A=0.5:12:3000,Omega=0.5:12:3000",
        "--chunk",
        "30000",
        "-q",
        "-o",
        "s.h5",
    ]
    process = subprocess.Popen(
        [*call, "--workers", workers],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heed_signals,
    )
    part = tmp_path / "s.h5.part"
    assert grows(part, 200_000, process)
    if stop == signal.SIGTERM:
        process.send_signal(stop)
    else:
        os.killpg(process.pid, stop)  # a terminal tells the whole group
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130
    assert said.startswith("rocking: interrupted; ")
    assert len(said.strip().splitlines()) == 1
    with pytest.raises(ProcessLookupError):  # no worker is left behind
        os.killpg(process.pid, 0)
    assert not (tmp_path / "s.h5").exists()
    with SpectraFile(part) as f:
        assert 0 < f.done.sum() < f.done.size


def test_a_step_count_that_runs_away_is_a_failed_cell(rocking, monkeypatch, tmp_path):
    monkeypatch.setattr(batch, "MAX_STEPS", -29)
    assert (
        rocking(
            "spectrum",
            "--grid",
            "A=1.5:1.6:2,Omega=4",
            "--eta",
            "1",
            "-q",
            "--workers",
            "1",
            "-o",
            "s.h5",
        ).returncode
        == 4
    )
    assert (tmp_path / "s.h5").exists()
    monkeypatch.setattr(batch, "MAX_STEPS", -38)
    assert (
        history(System(LinearEquation()), sine(), 1.5, 4.0, 1.0, duration=30.0).outcome
        == Outcome.FAILED
    )


def test_two_paths_are_said_to_differ_beyond_the_tolerance_and_not_below_it(rocking):
    call = (
        "spectrum",
        "configs/block.yaml",
        "--grid",
        "a_g=0.5g:0.9g:5,f_g=1:2:3",
        "--cycles",
        "3",
        "--tolerance",
        "1e-3",
        "-o",
        "s.h5",
    )
    done = rocking(*call, "--json")
    assert 1e-9 < done.record["largest_difference"] < 1e-3
    assert "do not rely" not in done.stderr


def test_where_no_cell_was_checked_no_error_is_known(rocking, tmp_path):
    call = ("spectrum", "--eta", "0.9", "--grid", "A=2,Omega=3", "--json")
    row = rocking(*call, "--verify-cells", "0", "-o", str(tmp_path / "a.h5")).record
    assert (row["checked_cells"], row["largest_difference"]) == (0, None)


def test_a_large_grid_tells_its_size_first_and_a_larger_one_asks_for_shards(
    rocking, refused, monkeypatch
):
    call = ("spectrum", "--eta", "0.9", "-o", "s.h5", "--grid")
    said = refused(2, *call, "A=1:2:100000,Omega=1:2:100000")
    assert "found 10,000,000,000 cells; expected up to 1,000,000,000" in said
    assert "--shard 1/10" in said

    def stop(*_):
        raise UsageError("stopped here")

    monkeypatch.setattr("rocking_cli.spectra.sweep.write_scene", stop)
    told = rocking(*call, "A=1:2:2000,Omega=1:2:1000").stderr
    assert "2,000,000 cells into s.h5: up to 18 MB\n" in told
    assert "stopped here" in told
