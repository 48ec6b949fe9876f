"""A finished file is refused where any byte of it but the chunks' is another, before HDF5 reads it."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

from rocking_cli import RockingError
from rocking_cli.spectra.file.digest import checked_digest, digest_line
from rocking_cli.spectra.file.reader import SpectraFile


@pytest.fixture
def raw(tmp_path):
    path = tmp_path / "x"
    path.write_bytes(bytes(range(200)))
    with open(path, "r+b", buffering=0) as file:
        yield path, file


def test_every_bit_but_those_of_chunks_counts(raw):
    path, file = raw
    end = digest_line(file, [(50, 30), (20, 10), (80, 5)])
    whole = path.read_bytes() + end
    for at in range(len(whole)):
        data = bytearray(whole)
        data[at] ^= 1 << at % 8
        path.write_bytes(data)
        if 20 <= at < 30 or 50 <= at < 85:
            assert checked_digest(file)
        elif at < 200:
            with pytest.raises(ValueError, match="does not fit its digest"):
                checked_digest(file)
        else:
            with suppress(ValueError):
                assert not checked_digest(file)
    path.write_bytes(whole)
    assert checked_digest(file)
    assert whole[: -len(end)] == bytes(range(200))


def test_chunks_that_overlap_are_refused(raw):
    with pytest.raises(ValueError, match="two chunks lie at byte 25"):
        digest_line(raw[1], [(20, 10), (25, 10)])


def test_a_digest_that_is_not_one_is_a_sentence(raw):
    path, file = raw
    for line in (
        b"[]",
        b"{}",
        b"[" * 10_000,
        b'{"size": 199, "metadata": [[0, 999]], "digest": ""}',
        b'{"size": 1, "metadata": 3, "digest": 3}',
    ):
        path.write_bytes(bytes(200) + b"\n" + line + b"\nrocking seal 1 %010d\n" % len(line))
        with pytest.raises(ValueError, match="its digest is damaged"):
            checked_digest(file)
    path.write_bytes(b"\nrocking seal 1 9999999999\n")
    assert not checked_digest(file)


def test_a_chunk_is_checked_whenever_it_is_read(spectrum_file, tmp_path):
    with SpectraFile(spectrum_file) as file:
        at = file.file["theta_ratio"].id.get_chunk_info(3).byte_offset + 40
        rows = file.cut.chunk[1]
    data = bytearray(spectrum_file.read_bytes())
    data[at] ^= 4
    (tmp_path / "d.h5").write_bytes(data)
    with SpectraFile(tmp_path / "d.h5") as file:
        assert file.digest
        assert file.damaged_chunks() == [3]
        assert np.isfinite(file.block(0, slice(0, 3 * rows))["theta_ratio"]).any()
        with pytest.raises(RockingError, match="chunk 3 is damaged: its checksum does not fit"):
            file.block(0, slice(3 * rows, 3 * rows + 1), slice(5, 6))
        with pytest.raises(RockingError, match="chunk 3 is damaged"):
            list(file.cells())
