"""A sweep that is stopped goes on to the same file; its partial file belongs to one
process, and nothing of others is replaced.
"""

import errno
import fcntl
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
import xarray
from support.documents import SMALL_SCENE, built, same_file
from support.watched_processes import PATIENCE, PROGRAM, grows

from rocking_cli import (
    Interrupted,
    Outcome,
    OutputError,
    UsageError,
    cosine,
    dimensionless_oscillator,
    parse_grid,
    sine,
    write_spectrum,
)
from rocking_cli.reports.summary import summary_lines
from rocking_cli.spectra.file import writer as store
from rocking_cli.spectra.file.integrity import Log
from rocking_cli.spectra.file.layout import CONDITIONS, FileLayout, joined, pack, split
from rocking_cli.spectra.file.reader import SpectraFile
from rocking_cli.spectra.file.same_scene import first_difference
from rocking_cli.spectra.file.writer import SpectraWriter
from rocking_cli.spectra.scene import PulseScene
from rocking_cli.spectra.sweep_options import SweepOptions
from rocking_cli.spectra.work import machine

GRID = parse_grid("A=0.5:12:40,Omega=0.5:12:30")
ONE, SINE = [dimensionless_oscillator(eta=0.9)], sine()


def sweep(path, structures=ONE, motion=SINE, grid=GRID, **options):
    """Six chunks of 200 cells."""
    return write_spectrum(
        structures, motion, grid, path, workers=1, chunk_cells=200, **options
    )


def left_part(path, chunks=3, **options):
    """The partial file that a sweep leaves which is interrupted after some chunks."""

    def stop(done, total):
        if done == chunks:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        sweep(path, progress=stop, **options)
    return path.with_name(path.name + ".part")


@pytest.fixture
def output(tmp_path):
    return tmp_path / "s.h5"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The same sweep without a stop."""
    path = tmp_path_factory.mktemp("swept") / "whole.h5"
    sweep(path)
    return path


def flip(path, at):
    data = bytearray(path.read_bytes())
    data[at] ^= 8
    path.write_bytes(data)


def names(folder):
    return sorted(p.name for p in folder.iterdir())


def layout():
    return FileLayout(
        PulseScene(tuple(ONE), GRID, SINE).frame(),
        (5, 40),
        ("theta_ratio", "outcome"),
        {},
        {"shard": "1/1"},
    )


def test_a_killed_sweep_goes_on_to_the_same_file(rocking, tmp_path):
    call = [
        "spectrum",
        "--eta",
        "0.9",
        "-q",
        "--chunk",
        "5000",
        "--grid",
        "A=0.5:12:250,Omega=0.5:12:250",
    ]
    assert rocking(*call, "-o", "whole.h5").returncode == 0
    part = tmp_path / "cut.h5.part"
    process = subprocess.Popen([*PROGRAM, *call, "-o", "cut.h5"], cwd=tmp_path)
    assert grows(part, int(0.3 * (tmp_path / "whole.h5").stat().st_size), process)
    process.kill()
    process.wait()
    with SpectraFile(part) as file:
        assert file.damaged_chunks() == []
    assert rocking(*call, "-o", "cut.h5", "--resume").returncode == 0
    same_file(tmp_path / "cut.h5", tmp_path / "whole.h5")


OTHER_SCENES = [
    (
        {"grid": parse_grid("A=0.5:12:40,Omega=0.5:12:31")},
        "belongs to another scene: its axis Omega is",
    ),
    (
        {"motion": cosine()},
        'its motion is "sine 1 cycle", that of this run "cosine 1 cycle"',
    ),
    (
        {"structures": [*ONE, dimensionless_oscillator(eta=0.7)]},
        "its number of structures is 1, that of this run 2",
    ),
    ({"shard": (1, 2)}, r"s\.h5\.part: is of shard 1/1, this call computes 1/2"),
    ({"impacts": True}, "its impacts is false, that of this run true"),
    (
        {"resume": False},
        (
            "left by a sweep that did not finish; `resume` goes on with it,"
            " `overwrite` begins anew"
        ),
    ),
]


def test_resume_takes_only_its_own_scene(output, whole):
    part = left_part(output)
    before = part.read_bytes()
    for changed, words in OTHER_SCENES:
        with pytest.raises(UsageError, match=words):
            sweep(output, **{"resume": True, **changed})
        assert part.read_bytes() == before
    assert sweep(output, resume=True).resumed_cells == 600
    same_file(output, whole)
    with pytest.raises(UsageError, match="exists and is complete"):
        sweep(output, resume=True)


@pytest.mark.parametrize(
    ("one", "other", "found"),
    [
        ({"a": 1}, {"a": 1}, None),
        ({"a": 1}, {"a": 1, "b": 2}, ("b", "null", "2")),
        (
            {"s": [{"eta": 0.9}, {"eta": 0.8}]},
            {"s": [{"eta": 0.9}, {"eta": 0.7}]},
            ("s[1].eta", "0.8", "0.7"),
        ),
        ({"s": [{}]}, {"s": [{}, {}]}, ("number of s", "1", "2")),
        (
            {"axis A": [0.5, 12.0, 3]},
            {"axis A": [0.5, 12.0, 4]},
            ("axis A", "[0.5, 12.0, 3]", "[0.5, 12.0, 4]"),
        ),
        (
            {"motion": ["sine", [{"end": 1.0}]]},
            {"motion": ["cosine", [{"end": 1.0}]]},
            ("motion", '"sine"', '"cosine"'),
        ),
        (
            {"motion": ["sine", [{"end": 1.0}]]},
            {"motion": ["sine", [{"end": 2.0}]]},
            ("motion[1][0].end", "1.0", "2.0"),
        ),
    ],
)
def test_scenes_differ_by_a_field_with_both_its_values(one, other, found):
    assert first_difference(one, other) == found


def test_resume_calls_no_damaged_file_complete(output, whole):
    data = whole.read_bytes()
    with h5py.File(whole) as file:
        chunk = file["theta_ratio"].id.get_chunk_info(0)
    flipped = bytearray(data)
    flipped[chunk.byte_offset + chunk.size // 2] ^= 1
    for content, said in (
        (data[:-1000], r"or damaged \("),
        (b"", "is not an HDF5 file, or is damaged"),
        (flipped, "1 of its chunks"),
    ):
        output.write_bytes(content)
        with pytest.raises(
            OutputError, match=f"{said}.*; use `overwrite` to replace it$"
        ):
            sweep(output, resume=True)
        assert output.read_bytes() == content


BOUNDS = ("error_bound", "error_bound_median", "cells_above_ten_medians")


def test_the_error_bound_of_a_sweep_that_goes_on_is_that_of_all_cells(output, whole):
    """Two structures share each chunk; the most sensitive cells may lie in the chunks
    of the first run, of which the second run computes none.
    """
    both = [*ONE, replace(ONE[0], name="other")]
    once = sweep(output.with_name("once.h5"), both)
    for chunks in (1, 3, 5):
        output.unlink(missing_ok=True)
        left_part(output, chunks, structures=both)
        found = sweep(output, both, resume=True)
        assert found.resumed_cells == 400 * chunks
        with SpectraFile(output) as file:
            for name in BOUNDS:
                assert getattr(found, name) == getattr(once, name) > 0
                assert file.attributes[name] == getattr(once, name)


def test_a_chunk_without_conditions_is_computed_again(output, whole):
    part = left_part(output)
    with part.open("rb+") as file:
        log = Log(file)
        parts = split(log.content(1), ("theta_ratio", "outcome"))
        log.append(1, joined({k: parts[k] for k in ("theta_ratio", "outcome")}))
    assert sweep(output, resume=True).resumed_cells == 400
    same_file(output, whole)


def test_resume_computes_damaged_chunks_again(rocking, output, whole):
    part = left_part(output, 5)
    with open(part, "rb") as file:
        at, length = Log(file).places[3]
    flip(part, at + length // 2)
    info = rocking("info", "s.h5.part", "--verify")
    assert (info.returncode, "chunk 3 is damaged" in info.stderr) == (1, True)
    assert sweep(output, resume=True).resumed_cells == 800
    same_file(output, whole)


@pytest.mark.slow
def test_a_full_disk_keeps_what_was_done(rocking, tmp_path):
    assert rocking("spectrum", *SMALL_SCENE, "-o", "whole.h5").returncode == 0
    half = (tmp_path / "whole.h5").stat().st_size // 2048
    call = (
        f"ulimit -f {half}; PYTHONDONTWRITEBYTECODE=1 exec {sys.executable} -m"
        f" rocking_cli spectrum {' '.join(SMALL_SCENE)} -o cut.h5"
    )
    done = subprocess.run(
        ["bash", "-c", call],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert (done.returncode, done.stderr) == (
        1,
        "rocking: cut.h5.part: cannot be written: File too large; the finished chunks"
        " are kept there for --resume\n",
    )
    assert names(tmp_path) == ["configs", "cut.h5.part", "whole.h5"]
    assert rocking("spectrum", *SMALL_SCENE, "-o", "cut.h5", "--resume").returncode == 0
    same_file(tmp_path / "cut.h5", tmp_path / "whole.h5")


def test_a_folder_that_vanishes_is_a_sentence(tmp_path):
    folder = tmp_path / "gone"
    folder.mkdir()
    with pytest.raises(OutputError, match="cannot be written: No such file"):
        sweep(
            folder / "s.h5",
            progress=lambda done, total: done == 2 and shutil.rmtree(folder),
        )


def test_a_disk_that_is_full_at_the_end_keeps_the_part_whole(output, monkeypatch):
    copy = SpectraWriter._copy_into

    def full_at_the_end(writer, file, attributes):
        copy(writer, file, attributes)
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(SpectraWriter, "_copy_into", full_at_the_end)
        with pytest.raises(
            OutputError,
            match=(
                r"cannot be written: No space left on device; the result is kept as"
                r" .*s\.h5\.part"
            ),
        ):
            sweep(output)
    assert names(output.parent) == ["s.h5.part"]
    assert sweep(output, resume=True).resumed_cells == 1200


def test_xarray_sees_dimensions_coordinates_units_and_flags(output):
    text = "kind: block\nname: Säule\nwidth: 0.5\nheight: 2"
    write_spectrum(
        [built(text)],
        SINE,
        parse_grid("a_g=0.1g:1g:12,omega_g=1:20:9"),
        output,
        documents=text,
    )
    with xarray.open_dataset(output, engine="h5netcdf") as d:
        assert d.theta_ratio.dims == ("structure", "omega_g", "a_g")
        assert d.sizes["omega_g"] == 9
        assert (d.omega_g.units, d.a_g.units, d.theta_ratio.units) == (
            "rad s-1",
            "m s-2",
            "1",
        )
        assert d.structure.values.tolist() == ["Säule"]
        assert d.outcome.dtype == np.uint8
        assert d.outcome.flag_meanings.split()[d.outcome.values.max()] in {
            o.flag for o in Outcome
        }
        assert list(d.outcome.flag_values) == [o.value for o in Outcome]
        assert d.attrs["Conventions"] == "CF-1.11"
        assert "kind: block" in d.attrs["documents"]
        assert d.attrs["largest_difference"] < 1e-9
        for name in d.variables:
            assert "units" in d[name].attrs, name
            assert "long_name" in d[name].attrs, name
        assert float(d.p[0]) == pytest.approx(2.6716705, abs=1e-6)
        assert d["lambda"].dims == ("structure",)
        assert d.sel(structure="Säule").theta_ratio.shape == (9, 12)


def test_hdf5_file_is_chunked_compressed_and_marked_done(whole):
    with h5py.File(whole) as f:
        theta = f["theta_ratio"]
        assert (theta.chunks, theta.compression, theta.shuffle) == (
            (1, 5, 40),
            "gzip",
            True,
        )
        assert f["bookkeeping/chunk_done"][...].tolist() == [1] * 6
        assert [scale.name for scale in (d[0] for d in theta.dims)] == [
            "/structure",
            "/Omega",
            "/A",
        ]
        assert {"theta_ratio", "outcome", "bookkeeping"} <= set(f)


def test_an_incomplete_file_is_never_published(output):
    with SpectraWriter(output, layout()) as writer:
        writer.write(
            (0, 0, 0),
            {
                "theta_ratio": pack(np.zeros((5, 40))),
                "outcome": pack(np.ones((5, 40), "u1")),
                CONDITIONS: b"",
            },
        )
        with pytest.raises(
            OutputError, match="5 of 6 chunks are missing; it is kept for `resume`"
        ):
            writer.finish({})
    assert names(output.parent) == ["s.h5.part"]


def test_a_chunk_that_is_damaged_before_the_end_is_not_published(output):
    """A bit that flips in the partial file while the sweep goes on."""
    part = output.with_name("s.h5.part")
    with pytest.raises(
        OutputError,
        match=(
            r"cannot be finished: its checksum does not fit; the result is kept as"
            r" .*s\.h5\.part"
        ),
    ):
        sweep(output, progress=lambda done, total: done == 4 and flip(part, -9))
    assert names(output.parent) == ["s.h5.part"]
    assert sweep(output, resume=True).resumed_cells == 1000


def test_a_part_whose_layout_is_cut_or_ends_elsewhere_is_kept(output):
    """Bytes 40 to 47 of the superblock are the end of the layout."""
    part = left_part(output)
    data = part.read_bytes()
    ends = [
        data[:byte] + bytes([data[byte] ^ 16]) + data[byte + 1 :]
        for byte in range(40, 48)
    ]
    for damaged in (
        data[:9],
        data[:2500],
        data[:4000],
        *ends,
        layout().image(),
    ):  # the last one as an earlier version left it
        part.write_bytes(damaged)
        with pytest.raises(
            OutputError,
            match=(
                r"is not a sweep that can go on \(it.*\); it is kept, `overwrite`"
                r" begins anew"
            ),
        ):
            sweep(output, resume=True)
        assert part.read_bytes() == damaged
    sweep(output, overwrite=True)


def test_a_layout_that_was_never_whole_is_begun_anew(output):
    """Its signature is written last; a kill before leaves zeros."""
    for content in (b"", bytes(100), bytes(8) + layout().image()[8:]):
        output.with_name("s.h5.part").write_bytes(content)
        assert sweep(output, resume=True).resumed_cells == 0
        output.unlink()


def test_a_part_that_another_state_of_the_program_or_another_machine_began_is_told(
    output, monkeypatch
):
    monkeypatch.setattr(machine, "version", lambda: "0.1.0+1234")
    left_part(output).rename(output.with_name("t.h5.part"))
    monkeypatch.undo()
    with pytest.raises(
        UsageError, match=r'its version is "0\.1\.0\+1234", that of this run "'
    ):
        sweep(output.with_name("t.h5"), resume=True)
    monkeypatch.setattr(store, "machine", lambda: {"numpy": "1.0"})
    part = left_part(output)
    monkeypatch.undo()
    before = part.read_bytes()
    with pytest.raises(
        UsageError,
        match=(
            r"was begun on a machine that computes differently .*numpy 1\.0 and .*it is"
            r" kept"
        ),
    ):
        sweep(output, resume=True, strict=True)
    assert part.read_bytes() == before
    summary = sweep(output, resume=True)
    assert "numpy 1.0 and" in summary.machine_differences
    assert any(
        "machines that differ: " in line and "numpy 1.0 and" in line
        for line in summary_lines(summary, "s.h5")
    )
    with SpectraFile(output) as file:
        assert file.attributes["machine_differences"] == summary.machine_differences


def as_on_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lock files as Windows does, which has no fcntl and lets nobody else read the
    bytes that are locked.
    """
    flock = fcntl.flock

    def locking(descriptor: int, mode: int, count: int) -> None:
        assert (mode, count) == (2, 1)
        assert os.lseek(descriptor, 0, os.SEEK_CUR) > 1 << 40
        try:
            flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise PermissionError(errno.EACCES, "Permission denied") from None

    system = SimpleNamespace(LK_NBLCK=2, locking=locking)
    monkeypatch.setitem(sys.modules, "msvcrt", system)
    monkeypatch.setitem(sys.modules, "fcntl", None)


@pytest.mark.parametrize("system", ["posix", "windows"])
def test_a_part_in_use_is_left_alone(output, whole, monkeypatch, system):
    """Two sweeps of one output at once: the second one, whatever it is told, touches
    nothing.
    """
    if system == "windows":
        as_on_windows(monkeypatch)

    def meanwhile(done, total):
        if done == 2:
            for options in ({}, {"overwrite": True}, {"resume": True}):
                with pytest.raises(OutputError, match=r"in use by another process$"):
                    sweep(output, **options)
            with SpectraFile(
                output.with_name("s.h5.part")
            ) as part:  # which may be read meanwhile
                assert int(part.done.sum()) == 2

    sweep(output, progress=meanwhile)
    same_file(output, whole)
    assert names(output.parent) == ["s.h5"]


def test_only_the_file_that_was_opened_is_removed(output):
    with SpectraWriter(output, layout()) as first:
        first.part.unlink()
        with SpectraWriter(output, layout()) as second:
            first.discard()
            assert names(output.parent) == ["s.h5.part"]
            second.discard()
            assert names(output.parent) == []


def test_without_locks_a_sweep_goes_on_all_the_same(output, monkeypatch):
    def no_locks(*_):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", no_locks)
    left_part(output)
    assert sweep(output, resume=True).resumed_cells == 600


def test_outputs_are_never_replaced_unasked(output, tmp_path):
    output.write_text("mine")
    with pytest.raises(UsageError, match="exists; use `overwrite`"):
        sweep(output)
    assert output.read_text() == "mine"
    sweep(output, overwrite=True)
    assert output.read_bytes()[:4] == b"\x89HDF"
    with pytest.raises(UsageError, match="does not exist"):
        sweep(tmp_path / "nowhere" / "t.h5")
    with pytest.raises(UsageError, match=r"the output is HDF5; found the ending \.csv"):
        sweep(tmp_path / "s.csv")
    with pytest.raises(UsageError, match="`resume` does not go with `overwrite`"):
        SweepOptions(overwrite=True, resume=True)


def test_a_part_that_no_sweep_left_is_not_taken_over(output, tmp_path):
    """Neither a foreign file nor a link, whatever is asked for."""
    part = tmp_path / "s.h5.part"
    part.write_text("precious")
    for options in ({"resume": True}, {"overwrite": True}):
        with pytest.raises(
            UsageError, match="is no partial file of this program; move it away"
        ):
            sweep(output, **options)
    part.rename(tmp_path / "victim")
    part.symlink_to("victim")
    with pytest.raises(
        UsageError, match="is a link, but a partial file must have this name"
    ):
        sweep(output, overwrite=True)
    assert (tmp_path / "victim").read_text() == "precious"


def test_a_file_that_appears_meanwhile_is_kept(output):
    with pytest.raises(OutputError, match="has appeared meanwhile"):
        sweep(output, progress=lambda done, total: output.write_text("mine"))
    assert output.read_text() == "mine"
    assert h5py.is_hdf5(output.with_name("s.h5.part"))


def test_what_a_kill_leaves_of_the_finished_file_is_removed(output):
    """The finished file has a name that the partial file states until
    it is complete.
    """
    with open(left_part(output), "rb") as file:
        half = output.with_name(f"s.h5.{Log(file).notes['token']}.part")
    half.write_bytes(b"half")
    sweep(output, resume=True)
    assert names(output.parent) == ["s.h5"]
