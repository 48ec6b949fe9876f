"""Chunks, the units of work in a file: packed bytes, checksum, and place in the grid."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

GZIP_LEVEL = 1  # on these data level 4 takes three times as long and saves 2 %

Packed = Mapping[str, bytes]
"""A chunk: the stored bytes of each variable, in the order of VARIABLES."""


@dataclass(frozen=True)
class ChunkGrid:
    """An array of some shape, cut into chunks, which are counted row-major; those at its edge are filled up."""

    shape: tuple[int, ...]
    chunk: tuple[int, ...]

    @property
    def counts(self) -> tuple[int, ...]:
        """Chunks along each dimension."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk, strict=True))

    @property
    def size(self) -> int:
        """Chunks in all."""
        return math.prod(self.counts)

    def offset(self, index: int) -> tuple[int, ...]:
        """The first cell of a chunk."""
        return tuple(int(i) * c for i, c in zip(np.unravel_index(index, self.counts), self.chunk, strict=True))

    def index(self, cell: Sequence[int]) -> int:
        """The chunk that holds a cell."""
        return int(np.ravel_multi_index([i // c for i, c in zip(cell, self.chunk, strict=True)], self.counts))

    def extent(self, index: int) -> tuple[slice, ...]:
        """The cells of a chunk, without the filling at the edge."""
        return tuple(slice(o, min(o + c, n)) for o, c, n in zip(self.offset(index), self.chunk, self.shape, strict=True))

    def within(self, cells: Sequence[slice]) -> Iterator[int]:
        """The chunks that hold any of these cells (slices with start and stop)."""
        spans = [range(s.start // c, -(-s.stop // c) if s.stop > s.start else 0) for s, c in zip(cells, self.chunk, strict=True)]
        return (int(np.ravel_multi_index(place, self.counts)) for place in product(*spans))


def pack(block: np.ndarray, shape: tuple[int, ...] | None = None) -> bytes:
    """A block as HDF5's shuffle and gzip filters store it, filled up with zeros to the shape of a chunk. Workers call this."""
    if shape not in (None, block.shape):
        block = np.pad(block, [(0, n - m) for m, n in zip(block.shape, shape or (), strict=True)])
    planes = np.ascontiguousarray(block).view(np.uint8).reshape(-1, block.dtype.itemsize).T
    return zlib.compress(planes.tobytes(), GZIP_LEVEL)


def unpack(raw: bytes, dtype: np.dtype, shape: tuple[int, ...]) -> np.ndarray:
    """The inverse of `pack`. Raises ValueError when the bytes are not such a chunk; never unpacks more than one."""
    expected = dtype.itemsize * math.prod(shape)
    try:
        data = np.frombuffer(zlib.decompressobj().decompress(raw, expected + 1), dtype=np.uint8)
    except zlib.error as error:
        raise ValueError(str(error)) from None
    if data.size != expected:
        raise ValueError(f"{data.size if data.size < expected else 'more'} bytes, expected {expected}")
    return np.ascontiguousarray(data.reshape(dtype.itemsize, -1).T).view(dtype).reshape(shape)


def checksum(packed: Packed) -> int:
    """CRC-32 over the packed variables of a chunk."""
    return zlib.crc32(b"".join(packed.values()))


def joined(packed: Packed) -> bytes:
    """The packed variables of a chunk as the record of a partial file: their lengths, and their bytes."""
    return struct.pack(f"<{len(packed)}Q", *map(len, packed.values())) + b"".join(packed.values())


def split(content: bytes, names: Sequence[str]) -> dict[str, bytes]:
    """The inverse of `joined`. Raises ValueError."""
    begin, packed = 8 * len(names), {}
    if len(content) < begin:
        raise ValueError("its record is too short")
    for name, length in zip(names, struct.unpack(f"<{len(names)}Q", content[:begin]), strict=True):
        packed[name] = content[begin : begin + length]
        begin += length
    return packed
