"""Sweeps that are stopped go on, shards come together, and spectra files are read back or refused in one sentence."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rocking_cli import OutputError, UsageError, dimensionless_oscillator, parse_grid, sine, write_spectrum
from rocking_cli.spectra.reader import SpectraFile

GRID = ("--grid", "A=0.5:12:200,Omega=0.5:12:200", "--eta", "0.9", "--eta", "0.7", "--chunk", "5000", "-q")


def same(one, other):
    with h5py.File(one) as a, h5py.File(other) as b:
        counts = [k for k in b.attrs if k.startswith("cells")]
        assert np.array_equal(a["theta_ratio"][...], b["theta_ratio"][...], equal_nan=True)
        assert np.array_equal(a["outcome"][...], b["outcome"][...])
        assert [a.attrs[k] for k in counts] == [b.attrs[k] for k in counts]
        assert a["chunk_done"][...].all()


def kill_loop(folder, kills, seed, values):
    """SIGKILL a resumed sweep at random moments; every part opens, every finished file equals the uninterrupted one."""
    moment, finished, opened = random.Random(seed), 0, 0
    call = [sys.executable, "-m", "rocking_cli", "spectrum", "--eta", "0.9", "--eta", "0.7", "-q", "--chunk", "10000"]
    call += ["--grid", f"A=0.5:12:{values},Omega=0.5:12:{values}"]
    began = time.perf_counter()
    subprocess.run([*call, "-o", "whole.h5"], cwd=folder, check=True)
    usual = time.perf_counter() - began
    done = 0
    while done < kills or not finished:
        process = subprocess.Popen([*call, "-o", "cut.h5", "--resume"], cwd=folder, stderr=subprocess.PIPE, start_new_session=True)
        if done < kills:
            time.sleep(moment.uniform(0.15, 0.9) * usual)
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
        said = process.communicate()[1]
        done += 1
        assert process.returncode in (0, -signal.SIGKILL), said
        if (folder / "cut.h5").exists():
            same(folder / "cut.h5", folder / "whole.h5")
            (folder / "cut.h5").unlink()
            finished += 1
        elif (folder / "cut.h5.part").exists():
            with h5py.File(folder / "cut.h5.part") as part:
                assert part["chunk_done"].shape == part["chunk"].shape
            opened += 1
    return finished, opened


def test_killed_sweeps_go_on_to_the_same_file(tmp_path):
    finished, opened = kill_loop(tmp_path, 6, 1, 500)
    assert finished
    assert opened


@pytest.mark.soak
def test_fifty_kills(tmp_path):
    finished, opened = kill_loop(tmp_path, 50, 2, 1200)
    assert finished
    assert opened > 10


@pytest.mark.parametrize("chunk", [2, 5, 8])
def test_resume_reads_on_beyond_the_end_that_a_killed_writer_stated(rocking, tmp_path, chunk):
    """HDF5 flushes the index of a chunk before the superblock: a kill in between leaves addresses beyond the stated end."""
    assert rocking("spectrum", *GRID, "-o", "whole.h5").returncode == 0
    part = tmp_path / "cut.h5.part"
    with h5py.File(tmp_path / "whole.h5") as file:
        begins = file["theta_ratio"].id.get_chunk_info(chunk).byte_offset
        last = file["chunk_done"].id.get_offset()
    data = bytearray((tmp_path / "whole.h5").read_bytes())
    assert data[8] == 0
    data[40:48] = begins.to_bytes(8, "little")
    data[last + chunk] = 0
    part.write_bytes(data)
    done = rocking("spectrum", *GRID, "-o", "cut.h5", "--resume")
    assert done.returncode == 0, done.stderr
    same(tmp_path / "cut.h5", tmp_path / "whole.h5")


def test_resume_takes_only_its_own_scene(rocking, refused, tmp_path):
    assert rocking("spectrum", *GRID, "-o", "a.h5").returncode == 0
    (tmp_path / "a.h5").rename(tmp_path / "b.h5.part")
    other = ["--grid", "A=0.5:12:200,Omega=0.5:12:201", *GRID[2:]]
    assert "its axis Omega is" in refused(2, "spectrum", *other, "-o", "b.h5", "--resume")
    assert "its motion is" in refused(2, "spectrum", *GRID, "--pulse", "cosine", "-o", "b.h5", "--resume")
    assert "its structures is" in refused(2, "spectrum", *GRID[:2], "--eta", "0.8", *GRID[6:], "-o", "b.h5", "--resume")
    assert "--resume goes on" in refused(2, "spectrum", *GRID, "-o", "b.h5")
    assert "does not go with" in refused(2, "spectrum", *GRID, "-o", "b.h5", "--resume", "--overwrite")
    assert rocking("spectrum", *GRID, "-o", "b.h5", "--resume").returncode == 0
    assert "is complete" in refused(2, "spectrum", *GRID, "-o", "b.h5", "--resume")


def test_resume_computes_damaged_chunks_again(rocking, tmp_path):
    assert rocking("spectrum", *GRID, "-o", "whole.h5").returncode == 0
    part = tmp_path / "cut.h5.part"
    part.write_bytes((tmp_path / "whole.h5").read_bytes())
    with h5py.File(part, "r+") as file:
        offset, size = file["theta_ratio"].id.get_chunk_info(3).byte_offset, file["theta_ratio"].id.get_chunk_info(3).size
        file["chunk_done"][7] = 0
    with open(part, "r+b") as raw:
        raw.seek(offset + size // 2)
        raw.write(b"\x00" * 8)
    info = rocking("info", "cut.h5.part", "--verify")
    assert info.returncode == 1
    assert "chunk 3 is damaged" in info.stderr
    assert rocking("spectrum", *GRID, "-o", "cut.h5", "--resume").returncode == 0
    same(tmp_path / "cut.h5", tmp_path / "whole.h5")


def test_a_worker_that_dies_loses_nothing_that_was_done(rocking, tmp_path):
    call = [
        sys.executable,
        "-m",
        "rocking_cli",
        "spectrum",
        "--eta",
        "0.9",
        "--grid",
        "A=0.5:12:2500,Omega=0.5:12:2500",
        "--chunk",
        "20000",
    ]
    process = subprocess.Popen([*call, "-o", "s.h5", "--workers", "2"], cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    part = tmp_path / "s.h5.part"
    while not (part.exists() and part.stat().st_size > 300_000):
        time.sleep(0.01)
    children = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True, check=True).stdout.split()
    os.kill(int(children[0]), signal.SIGKILL)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "a worker process died" in said
    assert "Traceback" not in said
    assert rocking("info", "s.h5.part", "--verify").returncode == 0


def test_a_full_disk_keeps_what_was_done(rocking, tmp_path):
    assert rocking("spectrum", *GRID, "-o", "whole.h5").returncode == 0
    call = f"ulimit -f 150; exec {sys.executable} -m rocking_cli spectrum {' '.join(GRID)} -o cut.h5"
    done = subprocess.run(["bash", "-c", call], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert "cut.h5.part: cannot be written: File too large; what was done is kept there for --resume" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert rocking("spectrum", *GRID, "-o", "cut.h5", "--resume").returncode == 0
    same(tmp_path / "cut.h5", tmp_path / "whole.h5")


def test_a_folder_that_vanishes_is_a_sentence(tmp_path):
    folder = tmp_path / "gone"
    folder.mkdir()
    call = [sys.executable, "-m", "rocking_cli", "spectrum", "--eta", "0.9", "--grid", "A=0.5:12:1500,Omega=0.5:12:1500", "-q"]
    process = subprocess.Popen([*call, "-o", str(folder / "s.h5")], stderr=subprocess.PIPE, text=True)
    while not (folder / "s.h5.part").exists():
        time.sleep(0.005)
    shutil.rmtree(folder)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "cannot be written" in said
    assert "Traceback" not in said


def test_shards_come_together(rocking, tmp_path):
    assert rocking("spectrum", *GRID, "-o", "whole.h5").returncode == 0
    for i in (1, 2, 3):
        assert rocking("spectrum", *GRID, "--shard", f"{i}/3", "-o", f"{i}.h5").returncode == 0
    assert rocking("merge", "1.h5", "3.h5", "-o", "some.h5").returncode == 4
    assert rocking("merge", "1.h5", "2.h5", "3.h5", "-o", "all.h5").returncode == 0
    same(tmp_path / "all.h5", tmp_path / "whole.h5")


def test_shards_of_another_scene_are_refused(rocking, refused):
    assert rocking("spectrum", *GRID, "--shard", "1/2", "-o", "1.h5").returncode == 0
    assert rocking("spectrum", *GRID, "--shard", "2/2", "--pulse", "cosine", "-o", "2.h5").returncode == 0
    assert "its motion differs" in refused(2, "merge", "1.h5", "2.h5", "-o", "all.h5")
    assert "accepted is I/N" in refused(2, "spectrum", *GRID, "--shard", "3/2", "-o", "3.h5")


def test_info_and_convert(rocking):
    rocking("spectrum", *GRID, "-o", "s.h5")
    (record,) = [json.loads(x) for x in rocking("info", "s.h5", "--verify", "--json").stdout.splitlines()]
    assert record["complete"] == "yes"
    assert record["damaged_chunks"] == 0
    lines = rocking("convert", "s.h5").stdout.splitlines()
    assert lines[0] == "structure,Omega,A,outcome,theta_ratio"
    assert len(lines) == 1 + 2 * 200 * 200
    first = json.loads(rocking("convert", "s.h5", "--json").stdout.splitlines()[39_999])
    assert first == {
        "structure": "eta=0.9",
        "Omega": 12.0,
        "A": 12.0,
        "outcome": "rocked",
        "theta_ratio": pytest.approx(first["theta_ratio"]),
    }


@pytest.fixture(scope="module")
def spectrum_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("spectra") / "s.h5"
    write_spectrum([dimensionless_oscillator(0.9)], parse_grid("A=0.5:8:400,Omega=1:8:400"), sine(), path, workers=1, chunk_cells=20_000)
    return path


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damaged_bytes_are_a_sentence_or_found_by_verify(spectrum_file, tmp_path, data):
    raw = bytearray(spectrum_file.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        raw = raw[: data.draw(st.integers(0, len(raw)))]
    damaged = tmp_path / "d.h5"
    damaged.write_bytes(raw)
    with suppress(OutputError, UsageError), SpectraFile(damaged) as file, SpectraFile(spectrum_file) as whole:
        if not file.damaged_chunks() and file.complete and file.scene == whole.scene:
            ours, theirs = file.block(0, slice(None)), whole.block(0, slice(None))
            assert np.array_equal(ours["outcome"], theirs["outcome"])
            assert np.array_equal(ours["theta_ratio"], theirs["theta_ratio"], equal_nan=True)


@pytest.mark.parametrize("content", [b"", b"not HDF5 at all", b"\x89HDF\r\n\x1a\n" + b"\x00" * 100])
def test_foreign_files_get_a_sentence(refused, tmp_path, content):
    (tmp_path / "x.h5").write_bytes(content)
    assert "x.h5: is" in refused(1, "info", "x.h5")
    with h5py.File(tmp_path / "y.h5", "w") as file:
        file["x"] = 1
    assert "is not a spectra file" in refused(1, "info", "y.h5")
    assert "no such file" in refused(2, "convert", "nowhere.h5")


STRUCTURE = """
{kind: block, name: One, width: 0.5, height: 2, restitution: 0.9}
---
{kind: spire, name: Two, base_radius: 1.5, height: 12, restitution: 0.9}
"""


def test_prediction_is_the_computed_response_within_its_stated_error(rocking, spectrum_file, tmp_path):
    (tmp_path / "two.yaml").write_text(STRUCTURE)
    for shaking in (("--A", "1.7", "--Omega", "3.3"), ("--a-g", "0.55g", "--f-g", "1.5"), ("--A", "7.5", "--Omega", "2")):
        call = ("predict", str(spectrum_file), "two.yaml", *shaking, "--json")
        read, exact = ([json.loads(x) for x in rocking(*call, *how).stdout.splitlines()] for how in ((), ("--exact",)))
        for a, b in zip(read, exact, strict=True):
            assert a["outcome"] == b["outcome"]
            assert a["margin"] == pytest.approx(b["margin"], abs=0.03)
            if a["theta_ratio"] is not None:
                assert abs(a["theta_ratio"] - b["theta_ratio"]) <= a["interpolation_error"] + 1e-12
                assert a["theta_max"] == pytest.approx(a["theta_ratio"] * (0.24497866 if a["structure"] == "One" else 0.358771), rel=1e-5)


def test_prediction_near_a_boundary_is_undecided_and_outside_refused(rocking, refused, spectrum_file, tmp_path):
    (tmp_path / "two.yaml").write_text(STRUCTURE)
    near = rocking("predict", str(spectrum_file), "two.yaml", "--A", "3.0186", "--Omega", "5", "--json")
    assert json.loads(near.stdout.splitlines()[0])["outcome"] == "undecided"
    assert "--exact decides" in near.stderr
    assert "is outside the spectrum" in refused(2, "predict", str(spectrum_file), "two.yaml", "--A", "9", "--Omega", "5")
    other = ("predict", str(spectrum_file), "configs/spire.yaml", "--A", "2", "--Omega", "5")
    assert "the spectrum holds 0.9" in refused(2, *other)


def test_prediction_is_never_a_guess(rocking, tmp_path):
    """Tongues of three-cycle overturning narrower than the grid's cells; and below uplift nothing moves."""
    rocking("spectrum", "--eta", "0.9", "--grid", "A=0.5:6:400,Omega=0.2:10:100", "--cycles", "3", "-o", "s3.h5", "-q")
    (tmp_path / "x.yaml").write_text("{kind: parameters, p: 2, alpha: 0.2, eta: 0.9, lambda: 0.2, a_scale: 1}")
    for cell, outcome in ((("1.8385398861885287", "3.2245844713068648"), "undecided"), (("0.99", "5"), "no_uplift")):
        done = rocking("predict", "s3.h5", "x.yaml", "--A", cell[0], "--Omega", cell[1], "--json")
        assert json.loads(done.stdout)["outcome"] == outcome
    call = ("predict", "s3.h5", "x.yaml", "--A", "1.0618680975437393", "--Omega", "3.266321116592374", "--json")
    record = json.loads(rocking(*call).stdout)
    assert record["outcome"] == "undecided" or abs(record["theta_ratio"] - 0.606) <= record["interpolation_error"] + 1e-3


def test_figures_of_every_kind_are_drawn(rocking, refused, spectrum_file, tmp_path):
    calls = {
        "envelope.csv": ("envelope", "--eta", "0.9", "--grid", "Omega=2:6:9", "--csv"),
        "curves.csv": ("envelope", "--eta", "0.9", "--grid", "Omega=2:6:9", "--closed-form", "--csv"),
        "response.csv": ("response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--model", "both", "--csv"),
        "tau.csv": ("response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--dimensionless", "--csv"),
        "compare.csv": ("compare", "configs/block.yaml", "configs/spire.yaml", "--A", "2", "--Omega", "4", "--curves", "--csv"),
        "params.csv": ("params", "configs/spire.yaml", "--vary", "base_radius=1:2:4", "--vary", "height=8:16:3", "--csv"),
        "accuracy.csv": ("accuracy", "--eta", "0.9", "--grid", "A=1:9:9,Omega=1:9:9", "--sample", "3", "--scipy", "1", "--csv"),
    }
    for name, call in calls.items():
        (tmp_path / name).write_text(rocking(*call).stdout)
        done = rocking("plot", name, "-o", f"{name}.png")
        assert done.returncode == 0, done.stderr
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert rocking("plot", str(spectrum_file), "-o", "map.svg", "--log", "xy").returncode == 0
    assert rocking("plot", str(spectrum_file), "--slice", "Omega=5", "-o", "slice.pdf").returncode == 0
    assert "overturns" in rocking("plot", str(spectrum_file), "--text").stdout
    assert "Omega = 5" in rocking("plot", str(spectrum_file), "--text", "--slice", "Omega=5").stdout
    assert "exists" in refused(2, "plot", "params.csv", "-o", "params.csv.png")
    assert "are none that a command" in refused(2, "plot", str(_foreign(tmp_path)), "-o", "x.png")
    assert "ends in .png" in refused(2, "plot", "params.csv", "-o", "x.bmp")
    assert "--slice" in refused(2, "plot", str(spectrum_file), "--text", "--slice", "B=3")
    assert "Omega=1 to 8" in refused(2, "plot", str(spectrum_file), "--text", "--slice", "Omega=99")
    assert "spectra files" in refused(2, "plot", "params.csv", "--text")


def _foreign(folder):
    (folder / "foreign.csv").write_text("a,b\n1,2\n")
    return folder / "foreign.csv"


def test_shell_completion(tmp_path):
    program = [sys.executable, "-c", "from rocking_cli.commands import main; main()"]
    env = {**os.environ, "_ROCKING_COMPLETE": "bash_complete", "COMP_WORDS": "rocking sp", "COMP_CWORD": "1"}
    assert "plain,spectrum" in subprocess.run(program, env=env, capture_output=True, text=True, check=False).stdout
