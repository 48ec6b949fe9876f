"""Sweeps that are stopped go on to the same file."""

from __future__ import annotations

import errno
import os
import random
import shutil
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest
import xarray
from support.documents import SMALL_SCENE, same_file
from support.watched_processes import PATIENCE, PROGRAM, children, grows

from rocking_cli import (
    Outcome,
    OutputError,
    UsageError,
    build_structure,
    dimensionless_oscillator,
    parse_documents,
    parse_grid,
    sine,
    write_spectrum,
)
from rocking_cli.commands import main
from rocking_cli.errors import Interrupted
from rocking_cli.reports.summary import summary_lines
from rocking_cli.spectra.dimensions import pulse_frame
from rocking_cli.spectra.file import log
from rocking_cli.spectra.file import writer as store
from rocking_cli.spectra.file.chunks import pack
from rocking_cli.spectra.file.difference import difference
from rocking_cli.spectra.file.layout import Layout
from rocking_cli.spectra.file.log import Log
from rocking_cli.spectra.file.reader import SpectraFile
from rocking_cli.spectra.file.writer import SpectraWriter
from rocking_cli.spectra.work import machine


def kill_loop(folder, kills, seed, values):
    """SIGKILL a resumed sweep at random sizes of its part; every part opens, every finished file equals the uninterrupted one."""
    moment, finished, opened = random.Random(seed), 0, 0
    call = [*PROGRAM, "spectrum", "--eta", "0.9", "--eta", "0.7", "-q", "--chunk", "10000"]
    call += ["--grid", f"A=0.5:12:{values},Omega=0.5:12:{values}"]
    subprocess.run([*call, "-o", "whole.h5"], cwd=folder, check=True)
    whole, part = (folder / "whole.h5").stat().st_size, folder / "cut.h5.part"
    done = 0
    while done < kills or not finished:
        process = subprocess.Popen([*call, "-o", "cut.h5", "--resume"], cwd=folder, stderr=subprocess.PIPE, start_new_session=True)
        begun = part.stat().st_size if part.exists() else -1
        if done < kills and grows(part, begun + int(moment.uniform(0.0, 0.5) * whole), process):
            time.sleep(moment.uniform(0.0, 0.02))  # somewhere between two writes, or in one
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
        said = process.communicate()[1]
        done += 1
        assert process.returncode in (0, -signal.SIGKILL), said
        if (folder / "cut.h5").exists():
            same_file(folder / "cut.h5", folder / "whole.h5")
            (folder / "cut.h5").unlink()
            finished += 1
        elif part.exists():
            with SpectraFile(part) as file:
                assert file.damaged_chunks() == []
            opened += 1
    return finished, opened


def test_killed_sweeps_go_on_to_the_same_file(tmp_path):
    finished, opened = kill_loop(tmp_path, 2, 1, 250)
    assert finished
    assert opened


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The small scene, swept without a stop."""
    path = tmp_path_factory.mktemp("swept") / "whole.h5"
    with pytest.raises(SystemExit):
        main(["spectrum", *SMALL_SCENE, "-o", str(path)])
    return path


@pytest.fixture
def left(tmp_path, rocking, monkeypatch):
    """The partial file of the small scene, with all its chunks, as a kill before the end leaves it."""

    def stop(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(SpectraWriter, "finish", stop)
        assert rocking("spectrum", *SMALL_SCENE, "-o", "cut.h5").returncode == 130
    return tmp_path / "cut.h5.part"


def test_resume_takes_only_its_own_scene(rocking, refused, left, tmp_path):
    left.rename(tmp_path / "b.h5.part")
    other = ["--grid", "A=0.5:12:120,Omega=0.5:12:121", *SMALL_SCENE[2:]]
    assert "its axis Omega is" in refused(2, "spectrum", *other, "-o", "b.h5", "--resume")
    said = refused(2, "spectrum", *SMALL_SCENE, "--pulse", "cosine", "-o", "b.h5", "--resume")
    assert 'its motion is "sine, 1 cycle", this one\'s "cosine, 1 cycle"' in said
    assert "its number of structures is 2, this one's 1" in refused(
        2, "spectrum", *SMALL_SCENE[:2], "--eta", "0.8", *SMALL_SCENE[6:], "-o", "b.h5", "--resume"
    )
    assert "--resume goes on" in refused(2, "spectrum", *SMALL_SCENE, "-o", "b.h5")
    assert "does not go with" in refused(2, "spectrum", *SMALL_SCENE, "-o", "b.h5", "--resume", "--overwrite")
    assert rocking("spectrum", *SMALL_SCENE, "-o", "b.h5", "--resume").returncode == 0
    assert "is complete" in refused(2, "spectrum", *SMALL_SCENE, "-o", "b.h5", "--resume")


def test_resume_calls_no_damaged_file_complete(refused, whole, tmp_path):
    data = whole.read_bytes()
    with h5py.File(whole) as file:
        chunk = file["theta_ratio"].id.get_chunk_info(0)
    flipped = bytearray(data)
    flipped[chunk.byte_offset + chunk.size // 2] ^= 1
    for bytes_, said in ((data[:-10000], "or damaged ("), (b"", "is not an HDF5 file, or is damaged"), (flipped, "1 of its chunks")):
        (tmp_path / "b.h5").write_bytes(bytes_)
        found = refused(1, "spectrum", *SMALL_SCENE, "-o", "b.h5", "--resume")
        assert said in found
        assert "--overwrite replaces it" in found
        assert "complete" not in found
        assert (tmp_path / "b.h5").read_bytes() == bytes_


def test_resume_computes_damaged_chunks_again(rocking, whole, left, tmp_path):
    with SpectraFile(left) as file:
        at, length = file._log.places[3]
    data = bytearray(left.read_bytes())
    data[at + length // 2] ^= 8
    left.write_bytes(data)
    info = rocking("info", "cut.h5.part", "--verify")
    assert info.returncode == 1
    assert "chunk 3 is damaged" in info.stderr
    assert rocking("spectrum", *SMALL_SCENE, "-o", "cut.h5", "--resume").returncode == 0
    same_file(tmp_path / "cut.h5", whole)


def test_a_worker_that_dies_loses_nothing_that_was_done(rocking, tmp_path):
    call = [*PROGRAM, "spectrum", "--eta", "0.9", "--grid", "A=0.5:12:2500,Omega=0.5:12:2500", "--chunk", "20000", "--workers", "2"]
    process = subprocess.Popen([*call, "-o", "s.h5"], cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    assert grows(tmp_path / "s.h5.part", 300_000, process)
    os.kill(children(process)[0], signal.SIGKILL)
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1
    assert "a worker process died" in said
    assert "Traceback" not in said
    assert rocking("info", "s.h5.part", "--verify").returncode == 0


def test_a_full_disk_keeps_what_was_done(rocking, whole, tmp_path):
    most = whole.stat().st_size // 2048  # kB, half
    call = f"ulimit -f {most}; exec {sys.executable} -m rocking_cli spectrum {' '.join(SMALL_SCENE)} -o cut.h5"
    done = subprocess.run(["bash", "-c", call], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 1
    assert "cut.h5.part: cannot be written: File too large; the finished chunks are kept there for --resume" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert rocking("spectrum", *SMALL_SCENE, "-o", "cut.h5", "--resume").returncode == 0
    same_file(tmp_path / "cut.h5", whole)


def test_a_disk_full_before_the_first_chunk_claims_to_keep_nothing(rocking, tmp_path):
    call = f"ulimit -f 13; exec {sys.executable} -m rocking_cli spectrum {' '.join(SMALL_SCENE)} -o cut.h5"
    done = subprocess.run(["bash", "-c", call], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 1
    assert done.stderr == "rocking: cut.h5.part: cannot be written: File too large\n"
    assert not list(tmp_path.glob("cut.h5*"))


def test_a_folder_that_vanishes_is_a_sentence(tmp_path):
    folder = tmp_path / "gone"
    folder.mkdir()
    call = [*PROGRAM, "spectrum", "--eta", "0.9", "--grid", "A=0.5:12:1000,Omega=0.5:12:1000", "-q"]
    process = subprocess.Popen([*call, "-o", str(folder / "s.h5")], stderr=subprocess.PIPE, text=True)
    assert grows(folder / "s.h5.part", 0, process)
    shutil.rmtree(folder)
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1
    assert "cannot be written" in said
    assert "Traceback" not in said


GRID = parse_grid("A=0.5:9:53,Omega=0.5:12:37")
TWO = [dimensionless_oscillator(0.9), dimensionless_oscillator(0.6)]


def test_xarray_sees_dimensions_coordinates_units_and_flags(tmp_path):
    (document,) = parse_documents("kind: block\nname: Säule\nwidth: 0.5\nheight: 2")
    path = tmp_path / "s.h5"
    write_spectrum([build_structure(document)], sine(), parse_grid("a_g=0.1g:1g:12,omega_g=1:20:9"), path, documents=document.text)
    with xarray.open_dataset(path, engine="h5netcdf") as d:
        assert d.theta_ratio.dims == ("structure", "omega_g", "a_g")
        assert d.sizes["omega_g"] == 9
        assert (d.omega_g.units, d.a_g.units, d.theta_ratio.units) == ("rad s-1", "m s-2", "1")
        assert d.structure.values.tolist() == ["Säule"]
        assert d.outcome.dtype == np.uint8
        assert d.outcome.flag_meanings.split()[d.outcome.values.max()] in {o.flag for o in Outcome}
        assert list(d.outcome.flag_values) == [o.value for o in Outcome]
        assert d.attrs["Conventions"] == "CF-1.11"
        assert "kind: block" in d.attrs["documents"]
        assert d.attrs["estimated_error"] < 1e-9
        for name in d.variables:
            assert "units" in d[name].attrs, name
            assert "long_name" in d[name].attrs, name
        assert float(d.p[0]) == pytest.approx(2.6716705, abs=1e-6)
        assert d["lambda"].dims == ("structure",)
        assert d.sel(structure="Säule").theta_ratio.shape == (9, 12)


def test_hdf5_file_is_chunked_compressed_and_marked_done(tmp_path):
    write_spectrum(TWO, sine(), GRID, tmp_path / "s.h5", chunk_cells=500)
    with h5py.File(tmp_path / "s.h5") as f:
        theta = f["theta_ratio"]
        assert theta.chunks == (1, 9, 53)
        assert theta.compression == "gzip"
        assert theta.shuffle
        assert f["bookkeeping/chunk_done"][...].all()
        assert f["bookkeeping/chunk_done"].size == 2 * 5
        assert [scale.name for scale in (d[0] for d in theta.dims)] == ["/structure", "/Omega", "/A"]
        assert {"theta_ratio", "outcome", "bookkeeping"} <= set(f)


def left_part(path, chunks, **options):
    """The part that a sweep of six chunks leaves which is interrupted after some."""

    def stop(done, total):
        if done == chunks:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        sweep(path, progress=stop, **options)
    return path.with_name(path.name + ".part")


def sweep(path, **options):
    grid = parse_grid("A=0.5:12:40,Omega=0.5:12:30")
    return write_spectrum([dimensionless_oscillator(0.9)], sine(), grid, path, workers=1, chunk_cells=200, **options)


def test_a_shard_does_not_go_on_with_the_part_of_another(tmp_path):
    part = left_part(tmp_path / "s.h5", 3)
    before = part.read_bytes()
    with pytest.raises(UsageError, match=r"s\.h5\.part: is of shard 1/1, this call computes 1/2"):
        sweep(tmp_path / "s.h5", resume=True, shard=(1, 2))
    assert part.read_bytes() == before
    sweep(tmp_path / "s.h5", resume=True)
    sweep(tmp_path / "whole.h5")
    same_file(tmp_path / "s.h5", tmp_path / "whole.h5")


def test_an_incomplete_file_is_never_published(tmp_path):
    with pytest.raises(OutputError, match="5 of 6 chunks are missing; it is kept for `resume`"):
        with_one_chunk(tmp_path / "s.h5")
    assert [p.name for p in tmp_path.iterdir()] == ["s.h5.part"]


def with_one_chunk(path):
    grid = parse_grid("A=0.5:12:40,Omega=0.5:12:30")
    frame = pulse_frame([dimensionless_oscillator(0.9)], grid)
    with SpectraWriter(path, Layout(frame, (5, 40), ("theta_ratio", "outcome"), {}, {"shard": "1/1"})) as writer:
        writer.write((0, 0, 0), {"theta_ratio": pack(np.zeros((5, 40))), "outcome": pack(np.ones((5, 40), "u1"))})
        writer.finish({})


def test_a_chunk_that_is_damaged_before_the_end_is_not_published(tmp_path):
    """A bit that flips in the partial file while the sweep goes on."""

    def flip(done, total):
        if done == 4:
            part = tmp_path / "s.h5.part"
            data = part.read_bytes()
            with open(part, "r+b") as raw:
                raw.seek(len(data) - 9)
                raw.write(bytes([data[-9] ^ 1]))

    with pytest.raises(OutputError, match=r"cannot be finished: its checksum does not fit; the result is kept as .*s\.h5\.part"):
        sweep(tmp_path / "s.h5", progress=flip)
    assert [p.name for p in tmp_path.iterdir()] == ["s.h5.part"]
    assert sweep(tmp_path / "s.h5", resume=True).resumed_cells == 1000


def test_a_part_whose_layout_is_cut_or_ends_elsewhere_is_kept(tmp_path):
    """Bytes 40 to 47 of the superblock are the end of the layout."""
    part = left_part(tmp_path / "s.h5", 3)
    whole = part.read_bytes()
    ends = [whole[:byte] + bytes([whole[byte] ^ 16]) + whole[byte + 1 :] for byte in range(40, 48)]
    for damaged in (whole[:9], whole[:2500], whole[:4000], *ends):
        part.write_bytes(damaged)
        with pytest.raises(OutputError, match=r"is not a sweep that can go on \(it.*\); it is kept, `overwrite` begins anew"):
            sweep(tmp_path / "s.h5", resume=True)
        assert part.read_bytes() == damaged


@pytest.mark.parametrize("at", ["chunk", "finish"])
def test_a_disk_that_fills_up_keeps_the_part_whole(tmp_path, monkeypatch, at):
    sweep(tmp_path / "whole.h5")
    write, copy, calls = log.write, SpectraWriter._copy_into, []

    def full(file, offset, content):
        calls.append(offset)
        if len(calls) == 4:  # a note, two chunks
            write(file, offset, content[: len(content) // 2])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(file, offset, content)

    def full_at_the_end(writer, file, attributes):
        copy(writer, file, attributes)
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        if at == "chunk":
            patch.setattr(log, "write", full)
        else:
            patch.setattr(SpectraWriter, "_copy_into", full_at_the_end)
        with pytest.raises(OutputError, match=r"cannot be written: No space left on device; .* (is|are) kept"):
            sweep(tmp_path / "s.h5")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["s.h5.part", "whole.h5"]
    done = 2 if at == "chunk" else 6
    with SpectraFile(tmp_path / "s.h5.part") as part:
        assert int(part.done.sum()) == done
        assert part.damaged_chunks() == []
    assert sweep(tmp_path / "s.h5", resume=True).resumed_cells == 200 * done
    same_file(tmp_path / "s.h5", tmp_path / "whole.h5")


def test_a_part_that_was_begun_elsewhere_is_told_and_refused_if_strict(tmp_path, monkeypatch):
    monkeypatch.setattr(store, "machine", lambda: {"numpy": "1.0"})
    part = left_part(tmp_path / "s.h5", 3)
    monkeypatch.undo()
    before = part.read_bytes()
    with pytest.raises(UsageError, match=r"was begun on a machine that computes differently .*numpy 1\.0 and .*it is kept"):
        sweep(tmp_path / "s.h5", resume=True, strict=True)
    assert part.read_bytes() == before
    summary = sweep(tmp_path / "s.h5", resume=True)
    assert "numpy 1.0 and" in summary.elsewhere
    assert any("machines that differ: " in line and "numpy 1.0 and" in line for line in summary_lines(summary, "s.h5"))
    with SpectraFile(tmp_path / "s.h5") as file:
        assert file.attributes["elsewhere"] == summary.elsewhere


def test_a_part_that_another_state_of_the_program_began_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(machine, "version", lambda: "0.1.0+1234")
    part = left_part(tmp_path / "s.h5", 3)
    monkeypatch.undo()
    before = part.read_bytes()
    with pytest.raises(UsageError, match=r'its version is "0\.1\.0\+1234", this one\'s "'):
        sweep(tmp_path / "s.h5", resume=True)
    assert part.read_bytes() == before


def test_a_part_in_use_is_left_alone(tmp_path):
    """Two sweeps of one output at once: the second one, whatever it is told, touches nothing."""
    path, refusals = tmp_path / "s.h5", []

    def meanwhile(done, total):
        if done == 2:
            for options in ({}, {"overwrite": True}, {"resume": True}):
                with pytest.raises(OutputError, match=r"in use by another process$") as refusal:
                    sweep(path, **options)
                refusals.append(str(refusal.value))
            with SpectraFile(tmp_path / "s.h5.part") as part:  # which may be read meanwhile
                assert int(part.done.sum()) == 2

    sweep(path, progress=meanwhile)
    sweep(tmp_path / "whole.h5")
    assert len(refusals) == 3
    same_file(path, tmp_path / "whole.h5")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["s.h5", "whole.h5"]


@pytest.mark.parametrize(
    ("one", "other", "found"),
    [
        ({"a": 1}, {"a": 1}, None),
        ({"a": 1}, {"a": 1, "b": 2}, ("b", "null", "2")),
        ({"a": 1, "b": None}, {"a": 1}, ("b", "null", "null")),
        ({"s": [{"eta": 0.9}, {"eta": 0.8}]}, {"s": [{"eta": 0.9}, {"eta": 0.7}]}, ("s[1].eta", "0.8", "0.7")),
        ({"s": [{}]}, {"s": [{}, {}]}, ("number of s", "1", "2")),
        ({"axis A": [0.5, 12.0, 3]}, {"axis A": [0.5, 12.0, 4]}, ("axis A", "[0.5, 12.0, 3]", "[0.5, 12.0, 4]")),
        ({"motion": ["sine", [{"end": 1.0}]]}, {"motion": ["cosine", [{"end": 1.0}]]}, ("motion", '"sine"', '"cosine"')),
        ({"motion": ["sine", [{"end": 1.0}]]}, {"motion": ["sine", [{"end": 2.0}]]}, ("motion[1][0].end", "1.0", "2.0")),
    ],
)
def test_scenes_differ_by_a_field_with_both_its_values(one, other, found):
    assert difference(one, other) == found


def test_outputs_are_never_replaced_unasked(tmp_path):
    path = tmp_path / "s.h5"
    path.write_text("mine")
    with pytest.raises(UsageError, match="exists; `overwrite`"):
        write_spectrum(TWO, sine(), GRID, path)
    assert path.read_text() == "mine"
    write_spectrum(TWO, sine(), GRID, path, overwrite=True)
    assert path.read_bytes()[:4] == b"\x89HDF"
    (tmp_path / "t.h5.part").write_text("half")
    with pytest.raises(UsageError, match="left by a sweep"):
        write_spectrum(TWO, sine(), GRID, tmp_path / "t.h5")
    with pytest.raises(UsageError, match="does not exist"):
        write_spectrum(TWO, sine(), GRID, tmp_path / "nowhere" / "t.h5")


def test_a_file_that_appears_meanwhile_is_kept(tmp_path):
    path = tmp_path / "s.h5"
    with pytest.raises(OutputError, match="has appeared meanwhile"):
        write_spectrum(TWO, sine(), GRID, path, workers=1, progress=lambda done, total: path.write_text("mine"))
    assert path.read_text() == "mine"
    assert h5py.is_hdf5(tmp_path / "s.h5.part")


def test_what_a_kill_leaves_of_the_finished_file_is_removed(tmp_path):
    """The finished file has a name that the partial file states until it is complete."""
    part = left_part(tmp_path / "s.h5", 3)
    with open(part, "rb") as file:
        half = tmp_path / f"s.h5.{Log(file).notes['token']}.part"
    half.write_bytes(b"half")
    sweep(tmp_path / "s.h5", resume=True)
    assert [p.name for p in tmp_path.iterdir()] == ["s.h5"]
