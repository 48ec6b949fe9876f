"""No byte of a file changes unseen: of a finished one by its digest, of a partial one
by the checksums of its records.
"""

import io
import json

import h5py
import numpy as np
import pytest

from rocking_cli import RockingError
from rocking_cli.spectra.file.integrity import NOTE, Log, digest, digest_line, entry_of
from rocking_cli.spectra.file.reader import SpectraFile


def test_a_chunk_is_checked_whenever_it_is_read(spectrum_file, tmp_path):
    with SpectraFile(spectrum_file) as file:
        at = file.file["theta_ratio"].id.get_chunk_info(3).byte_offset + 40
        rows = file.chunk_grid.chunk[1]
    data = bytearray(spectrum_file.read_bytes())
    data[at] ^= 4
    (tmp_path / "d.h5").write_bytes(data)
    with SpectraFile(tmp_path / "d.h5") as file:
        assert file.digest
        assert file.damaged_chunks() == [3]
        assert np.isfinite(file.block(0, slice(0, 3 * rows))["theta_ratio"]).any()
        with pytest.raises(
            RockingError, match="chunk 3 is damaged: its checksum does not fit"
        ):
            file.block(0, slice(3 * rows, 3 * rows + 1), slice(5, 6))
        with pytest.raises(RockingError, match="chunk 3 is damaged"):
            list(file.cells())


CONTENTS = [bytes([i]) * (50 + i) for i in range(5)]


@pytest.fixture
def left():
    """The layout of a file, and the same with five records behind it."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        file["x"] = range(100)
    image = buffer.getvalue()
    note = json.dumps({"layout": digest([image])}).encode()
    return image, image + entry_of(NOTE, note) + b"".join(
        entry_of(i, content) for i, content in enumerate(CONTENTS)
    )


def test_a_cut_file_holds_the_records_before_the_cut(left):
    _, data = left
    ends = [sum(Log(io.BytesIO(data)).places[i]) for i in range(5)]
    for length in range(ends[0], len(data), 7):
        assert sorted(Log(io.BytesIO(data[:length])).places.keys() - {NOTE}) == [
            i for i in range(5) if ends[i] <= length
        ]


def test_chunks_that_overlap_get_no_digest():
    with pytest.raises(ValueError, match="two chunks lie at byte 25"):
        digest_line(io.BytesIO(bytes(200)), [(20, 10), (25, 10)])
