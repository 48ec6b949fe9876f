"""Sweeps: the same bits however they are cut and spread, the file's layout, and what a reader sees."""

from __future__ import annotations

import subprocess
import sys

import h5py
import numpy as np
import pytest
import xarray

from rocking_cli import (
    Outcome,
    UsageError,
    build_structure,
    cosine,
    dimensionless_oscillator,
    linear_response,
    parse_documents,
    parse_grid,
    sine,
    spectrum,
    write_spectrum,
)
from rocking_cli.errors import OutputError

GRID = parse_grid("A=0.5:9:53,Omega=0.5:12:37")
TWO = [dimensionless_oscillator(0.9), dimensionless_oscillator(0.6)]


def read(path):
    with h5py.File(path) as f:
        return {name: f[name][...] for name in ("theta_ratio", "outcome", "impacts")}


@pytest.mark.parametrize(("workers", "chunk"), [(1, 1), (1, 100), (2, 100), (2, 1000), (2, 10**6)])
def test_workers_and_chunks_change_no_bit(tmp_path, workers, chunk):
    grid = GRID if chunk > 1 else parse_grid("A=0.5:9:9,Omega=0.5:12:7")
    write_spectrum(TWO, grid, sine(1.5), tmp_path / "s.h5", workers=workers, chunk_cells=chunk, impacts=True)
    data = read(tmp_path / "s.h5")
    a, omega = grid.amplitude.values, grid.frequency.values
    for i, structure in enumerate(TWO):
        direct = linear_response(sine(1.5), a[None, :], omega[:, None], structure.eta)
        assert data["theta_ratio"][i].tobytes() == direct.theta_ratio.tobytes()
        assert data["outcome"][i].tobytes() == direct.outcome.tobytes()
        assert data["impacts"][i].tobytes() == direct.impacts.tobytes()
    assert not (tmp_path / "s.h5.part").exists()


def test_in_memory_equals_the_file(tmp_path):
    write_spectrum(TWO, GRID, cosine(1), tmp_path / "s.h5", impacts=True)
    memory = spectrum(TWO, GRID, cosine(1))
    data = read(tmp_path / "s.h5")
    assert data["theta_ratio"].tobytes() == memory.theta_ratio.tobytes()
    assert data["outcome"].tobytes() == memory.outcome.tobytes()


def test_structures_of_equal_restitution_are_computed_once():
    texts = "kind: block\nwidth: 1\nheight: 5\nrestitution: 0.9\n---\nkind: spire\nbase_radius: 1\nheight: 9\nrestitution: 0.9"
    structures = [build_structure(d) for d in parse_documents(texts)]
    shared = spectrum(structures, GRID, sine())
    assert shared.summary.shared_cells == 53 * 37
    assert shared.theta_ratio[0].tobytes() == shared.theta_ratio[1].tobytes()
    dimensional = spectrum(structures, parse_grid("a_g=0.1g:2g:20,f_g=0.5:5:10"), sine())
    assert dimensional.summary.shared_cells == 0
    a, omega = structures[1].dimensionless_amplitude(np.linspace(0.981, 19.62, 20)), 2 * np.pi * np.linspace(0.5, 5, 10) / structures[1].p
    direct = linear_response(sine(), a[None, :], omega[:, None], 0.9)
    assert np.array_equal(dimensional.outcome[1], direct.outcome)


def test_summary_adds_up_and_the_check_agrees():
    s = spectrum(TWO, GRID, sine(), check=40).summary
    assert s.cells == 2 * 53 * 37 == sum(s.outcomes.values())
    assert s.outcomes["no_uplift"] == s.work.no_uplift
    assert s.checked_cells == 40
    assert s.misjudged == 0
    assert s.estimated_error < 1e-12
    assert s.record()["time_per_cell"] * s.cells == pytest.approx(s.run_time)


def test_xarray_sees_dimensions_coordinates_units_and_flags(tmp_path):
    (document,) = parse_documents("kind: block\nname: Säule\nwidth: 0.5\nheight: 2")
    path = tmp_path / "s.h5"
    write_spectrum([build_structure(document)], parse_grid("a_g=0.1g:1g:12,omega_g=1:20:9"), sine(), path, documents=document.text)
    with xarray.open_dataset(path, engine="h5netcdf") as d:
        assert d.theta_ratio.dims == ("structure", "omega_g", "a_g")
        assert d.sizes["omega_g"] == 9
        assert (d.omega_g.units, d.a_g.units, d.theta_ratio.units) == ("rad s-1", "m s-2", "1")
        assert d.structure.values.tolist() == ["Säule"]
        assert d.outcome.dtype == np.uint8
        assert d.outcome.flag_meanings.split()[d.outcome.values.max()] in {o.flag for o in Outcome}
        assert list(d.outcome.flag_values) == list(range(6))
        assert d.attrs["Conventions"] == "CF-1.11"
        assert "kind: block" in d.attrs["documents"]
        assert d.attrs["estimated_error"] < 1e-12
        for name in d.variables:
            assert "units" in d[name].attrs, name
            assert "long_name" in d[name].attrs, name
        assert float(d.p[0]) == pytest.approx(2.6716705, abs=1e-6)
        assert d["lambda"].dims == ("structure",)
        assert d.sel(structure="Säule").theta_ratio.shape == (9, 12)


def test_hdf5_file_is_chunked_compressed_and_marked_done(tmp_path):
    write_spectrum(TWO, GRID, sine(), tmp_path / "s.h5", chunk_cells=500)
    with h5py.File(tmp_path / "s.h5") as f:
        theta = f["theta_ratio"]
        assert theta.chunks == (1, 9, 53)
        assert theta.compression == "gzip"
        assert theta.shuffle
        assert f["chunk_done"][...].all()
        assert f["chunk_done"].size == 2 * 5
        assert [scale.name for scale in (d[0] for d in theta.dims)] == ["/structure", "/Omega", "/A"]
        assert "theta_ratio" in list(f)[-5:]


def test_outputs_are_never_replaced_unasked(tmp_path):
    path = tmp_path / "s.h5"
    path.write_text("mine")
    with pytest.raises(UsageError, match="exists; --overwrite"):
        write_spectrum(TWO, GRID, sine(), path)
    assert path.read_text() == "mine"
    write_spectrum(TWO, GRID, sine(), path, overwrite=True)
    assert path.read_bytes()[:4] == b"\x89HDF"
    (tmp_path / "t.h5.part").write_text("half")
    with pytest.raises(UsageError, match="left by a sweep"):
        write_spectrum(TWO, GRID, sine(), tmp_path / "t.h5")
    with pytest.raises(UsageError, match="does not exist"):
        write_spectrum(TWO, GRID, sine(), tmp_path / "nowhere" / "t.h5")


def test_a_file_that_appears_meanwhile_is_kept(tmp_path):
    path = tmp_path / "s.h5"
    with pytest.raises(OutputError, match="has appeared meanwhile"):
        write_spectrum(TWO, GRID, sine(), path, workers=1, progress=lambda done, total: path.write_text("mine"))
    assert path.read_text() == "mine"
    assert h5py.is_hdf5(tmp_path / "s.h5.part")


def test_a_restitution_alone_needs_dimensionless_axes():
    with pytest.raises(UsageError, match="no units"):
        spectrum(TWO, parse_grid("a_g=1:2:3,omega_g=1:2:3"), sine())
    with pytest.raises(UsageError, match="no structure"):
        spectrum([], GRID, sine())


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_million_cells_stay_within_400_mb(tmp_path):
    code = (
        "import resource\n"
        "from rocking_cli import *\n"
        "grid = parse_grid('A=0.5:12:1000,Omega=0.5:12:1000')\n"
        f"write_spectrum([dimensionless_oscillator(0.9)], grid, sine(), {str(tmp_path / 's.h5')!r}, workers=2)\n"
        "print(next(line.split()[1] for line in open('/proc/self/status') if line.startswith('VmHWM')))\n"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    parent, largest_worker = (float(x) / 1024 for x in done.stdout.split())
    assert parent + 2 * largest_worker < 400
