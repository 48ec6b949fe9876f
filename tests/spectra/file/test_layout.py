"""Chunks as the file stores them: what HDF5 itself makes of them, and where they lie."""

import io

import h5py
import numpy as np
import pytest

from rocking_cli.spectra.file.layout import GZIP_LEVEL, ChunkGrid, pack, unpack


@pytest.mark.parametrize("dtype", ["<f8", "<i4", "u1"])
def test_packed_chunks_are_what_hdf5_reads_and_writes(dtype):
    block = np.random.default_rng(1).integers(0, 200, (1, 7, 11)).astype(dtype)
    with h5py.File(io.BytesIO(), "w") as file:
        data = file.create_dataset(
            "x", (1, 7, 11), dtype, chunks=True, shuffle=block.itemsize > 1, compression="gzip", compression_opts=GZIP_LEVEL
        )
        data[...] = block
        file.flush()
        assert np.array_equal(unpack(data.id.read_direct_chunk((0, 0, 0))[1], block.dtype, block.shape), block)
        data.id.write_direct_chunk((0, 0, 0), pack(block + 1), 0)
        assert np.array_equal(data[...], block + 1)


def test_doubles_of_every_kind_survive_packing():
    random = np.random.default_rng(2)
    block = random.uniform(size=(40, 50))
    block[random.uniform(size=block.shape) < 0.4] = np.nan
    block[:5] = [0.0, -0.0, np.inf, 5e-324, 1.7976931348623157e308] * 10
    packed = pack(block)
    assert unpack(packed, block.dtype, block.shape).tobytes() == block.tobytes()
    assert np.array_equal(unpack(pack(block[:3, :4], (4, 9)), block.dtype, (4, 9))[:3, :4], block[:3, :4], equal_nan=True)
    for some in (block[:1, :1], block[:0]):
        assert unpack(pack(some), some.dtype, some.shape).tobytes() == some.tobytes()


def test_every_cell_lies_in_the_chunk_that_is_named():
    cut = ChunkGrid((2, 7, 5), (1, 3, 2))
    assert cut.counts == (2, 3, 3)
    assert cut.size == 18
    count = np.zeros(cut.shape, dtype=int)
    for index in range(cut.size):
        assert cut.index(cut.offset(index)) == index
        count[cut.extent(index)] += 1
        cells = np.argwhere(np.arange(70).reshape(cut.shape) >= 0)
        inside = [tuple(c) for c in cells if all(s.start <= i < s.stop for i, s in zip(c, cut.extent(index), strict=True))]
        assert {cut.index(c) for c in inside} == {index}
    assert np.all(count == 1)
    assert list(cut.within((slice(0, 1), slice(2, 4), slice(4, 5)))) == [2, 5]
    assert list(cut.within((slice(0, 1), slice(2, 2), slice(4, 5)))) == []
