"""Chunks, the units of work as a file stores them: packed bytes, their checksum, and where each one lies in the grid."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import h5py
import numpy as np

from ...dynamics.outcome import Outcome

GZIP_LEVEL = 1  # on these data level 4 takes three times as long and saves 2 %


@dataclass(frozen=True)
class ChunkGrid:
    """How an array of some shape is cut into chunks, which are counted row-major; those at its edge are filled up."""

    shape: tuple[int, ...]
    chunk: tuple[int, ...]

    @property
    def counts(self) -> tuple[int, ...]:
        """Chunks along each dimension."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk, strict=True))

    @property
    def size(self) -> int:
        """Chunks in all."""
        return int(np.prod([int(n) for n in self.counts], dtype=object))

    def offset(self, index: int) -> tuple[int, ...]:
        """The first cell of a chunk."""
        return tuple(int(i) * c for i, c in zip(np.unravel_index(index, self.counts), self.chunk, strict=True))

    def index(self, cell: Sequence[int]) -> int:
        """The chunk that holds a cell."""
        return int(np.ravel_multi_index([i // c for i, c in zip(cell, self.chunk, strict=True)], self.counts))

    def extent(self, index: int) -> tuple[slice, ...]:
        """The cells of a chunk, without what fills it up."""
        return tuple(slice(o, min(o + c, n)) for o, c, n in zip(self.offset(index), self.chunk, self.shape, strict=True))

    def within(self, cells: Sequence[slice]) -> Iterator[int]:
        """The chunks that hold any of these cells (slices with start and stop)."""
        lows = [s.start // c for s, c in zip(cells, self.chunk, strict=True)]
        spans = [-(-s.stop // c) - low if s.stop > s.start else 0 for s, c, low in zip(cells, self.chunk, lows, strict=True)]
        for place in np.ndindex(*spans):
            yield int(np.ravel_multi_index([low + i for low, i in zip(lows, place, strict=True)], self.counts))


def pack(block: np.ndarray) -> bytes:
    """A chunk as HDF5's shuffle and gzip filters read it; a worker does this so that the writer only writes."""
    size = block.dtype.itemsize
    if size > 1:
        block = block.reshape(-1).view(np.uint8).reshape(-1, size).T
    return zlib.compress(np.ascontiguousarray(block).tobytes(), GZIP_LEVEL)


def unpack(raw: bytes, dtype: np.dtype, shape: tuple[int, ...]) -> np.ndarray:
    """The inverse of `pack`. Raises ValueError when the bytes are not such a chunk; never unpacks more than one."""
    expected = dtype.itemsize * int(np.prod(shape))
    try:
        data = np.frombuffer(zlib.decompressobj().decompress(raw, expected + 1), dtype=np.uint8)
    except zlib.error as error:
        raise ValueError(str(error)) from None
    if data.size != expected:
        raise ValueError(f"{data.size if data.size < expected else 'more'} bytes, expected {expected}")
    if dtype.itemsize > 1:
        data = np.ascontiguousarray(data.reshape(dtype.itemsize, -1).T)
    return data.reshape(-1).view(dtype).reshape(shape)


def checksum(packed: Mapping[str, bytes], names: Sequence[str]) -> int:
    """CRC-32 over the packed variables of a chunk, in their order."""
    total = 0
    for name in names:
        total = zlib.crc32(packed[name], total)
    return total


def joined(packed: Mapping[str, bytes], names: Sequence[str]) -> bytes:
    """The packed variables of a chunk as the record of a partial file: their lengths, and their bytes."""
    return struct.pack(f"<{len(names)}Q", *(len(packed[name]) for name in names)) + b"".join(packed[name] for name in names)


def split(record: bytes, names: Sequence[str]) -> dict[str, bytes]:
    """The inverse of `joined`. Raises ValueError."""
    begin = 8 * len(names)
    if len(record) < begin:
        raise ValueError("its record is too short")
    packed = {}
    for name, length in zip(names, struct.unpack(f"<{len(names)}Q", record[:begin]), strict=True):
        packed[name] = record[begin : begin + length]
        begin += length
    return packed


def stored_chunk(file: h5py.File, names: Sequence[str], offset: tuple[int, ...], sum_: int) -> dict[str, bytes]:
    """The stored bytes of a chunk's variables. Raises ValueError, or what HDF5 raises, where they are not what was written."""
    packed = {}
    for name in names:
        mask, packed[name] = file[name].id.read_direct_chunk(offset)
        if mask:
            raise ValueError(f"its {name} leaves out filters")
    if checksum(packed, names) != sum_:
        raise ValueError("its checksum does not fit")
    return packed


def stored_outcomes(packed: Mapping[str, bytes], grid: ChunkGrid, index: int) -> np.ndarray:
    """How many of a chunk's cells came to each outcome. Raises ValueError when the bytes are not such a chunk."""
    cells = tuple(slice(0, s.stop - s.start) for s in grid.extent(index))
    outcomes = unpack(packed["outcome"], np.dtype("u1"), grid.chunk)[cells]
    counts = np.bincount(outcomes.ravel(), minlength=len(Outcome))
    if counts.size > len(Outcome):
        raise ValueError(f"outcome {counts.size - 1} is none")
    return counts


def chunk_places(file: h5py.File, names: Sequence[str]) -> list[tuple[int, int]]:
    """(offset, length) in the file of every chunk of the variables."""
    places: list[tuple[int, int]] = []
    for name in names:
        file[name].id.chunk_iter(lambda info: places.append((info.byte_offset, info.size)))
    return places
