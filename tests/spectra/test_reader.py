"""Spectra files are read back, or refused in one sentence."""

from __future__ import annotations

from contextlib import suppress

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rocking_cli import OutputError, UsageError
from rocking_cli.spectra.reader import SpectraFile


@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
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
