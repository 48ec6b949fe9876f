"""No byte of a file changes unseen: of a finished one by its digest, of a partial one by the checksums of its records."""

import io
import json
import random
from contextlib import suppress

import h5py
import numpy as np
import pytest

from rocking_cli import RockingError
from rocking_cli.spectra.file.integrity import NOTE, Log, checked_digest, digest, digest_line, entry_of
from rocking_cli.spectra.file.reader import SpectraFile


def test_every_bit_but_those_of_chunks_counts():
    file = io.BytesIO(bytes(range(200)))
    whole = file.getvalue() + digest_line(file, [(50, 30), (20, 10), (80, 5)])
    for at in range(len(whole)):
        data = bytearray(whole)
        data[at] ^= 1 << at % 8
        if 20 <= at < 30 or 50 <= at < 85:
            assert checked_digest(io.BytesIO(data))
        elif at < 200:
            with pytest.raises(ValueError, match="does not fit its digest"):
                checked_digest(io.BytesIO(data))
        else:
            with suppress(ValueError):
                assert not checked_digest(io.BytesIO(data))
    assert checked_digest(io.BytesIO(whole))
    with pytest.raises(ValueError, match="two chunks lie at byte 25"):
        digest_line(file, [(20, 10), (25, 10)])


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


CONTENTS = [bytes([i]) * (50 + i) for i in range(5)]


@pytest.fixture
def left():
    """The layout of a file, and the same with five records behind it."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        file["x"] = range(100)
    image = buffer.getvalue()
    note = json.dumps({"layout": digest([image])}).encode()
    return image, image + entry_of(NOTE, note) + b"".join(entry_of(i, content) for i, content in enumerate(CONTENTS))


def test_a_damaged_record_is_the_only_one_that_is_lost(left):
    """Every bit of the file, in turn: the layout is refused, a chunk says so, and what is read is what was written."""
    (image, data), chance, damaged = left, random.Random(2), 0
    for _ in range(400):
        at = chance.randrange(len(data))
        flipped = bytearray(data)
        flipped[at] ^= 1 << chance.randrange(8)
        try:
            records = Log(io.BytesIO(flipped))
        except ValueError:
            damaged += at < len(image)
            continue
        assert records.image == image
        for index in records.places.keys() - {NOTE}:
            try:
                assert records.content(index) == CONTENTS[index]
            except ValueError:
                damaged += 1
    assert damaged > 300


def test_a_cut_file_holds_the_records_before_the_cut(left):
    _, data = left
    ends = [sum(Log(io.BytesIO(data)).places[i]) for i in range(5)]
    for length in range(ends[0], len(data), 7):
        assert sorted(Log(io.BytesIO(data[:length])).places.keys() - {NOTE}) == [i for i in range(5) if ends[i] <= length]
