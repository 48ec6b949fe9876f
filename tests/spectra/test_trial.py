"""A damaged file that HDF5 loops over, or crashes on, costs a process that nobody misses, and a sentence."""

from __future__ import annotations

import shutil
import signal

import h5py
import pytest

from rocking_cli import OutputError
from rocking_cli.spectra import trial as module
from rocking_cli.spectra.reader import SpectraFile
from rocking_cli.spectra.trial import trial


@pytest.fixture
def unsealed(spectrum_file, tmp_path):
    path = tmp_path / "s.h5"
    shutil.copy(spectrum_file, path)
    with h5py.File(path, "r+") as file:
        file.attrs["remark"] = "no seal any more"
    return path


def test_a_file_that_hdf5_comes_to_no_end_over(unsealed, monkeypatch):
    """The heap of texts has no checksum: where it is cut off, HDF5 goes through nothing for ever."""
    trial(unsealed)
    data = bytearray(unsealed.read_bytes())
    heap = data.find(b"GCOL")
    data[heap + 16 : heap + 4096] = bytes(4080)
    unsealed.write_bytes(data)
    monkeypatch.setattr(module, "SECONDS", 1)
    with pytest.raises(OutputError, match=r"s\.h5: is not a spectra file of this program, or is damaged \(HDF5 comes to no end over it\)"):
        SpectraFile(unsealed)


def test_a_crash_is_a_sentence(unsealed, monkeypatch):
    monkeypatch.setattr(module, "_CODE", f"import os; os.kill(os.getpid(), {signal.SIGSEGV.value})")
    with pytest.raises(ValueError, match="HDF5 crashes over it, SIGSEGV"):
        trial(unsealed)
