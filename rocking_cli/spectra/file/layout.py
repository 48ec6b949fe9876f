"""The layout of a spectra file: its datasets, built in memory so that no incomplete
layout is ever on a disk, and its chunks.
"""

import io
import json
import math
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import h5py
import numpy as np

from ... import __version__
from ...documents.files import whole_text
from ..dimensions import VARIABLES, Frame, Values, Variable
from ..error_bound import Conditions

GZIP_LEVEL = 1  # on these data level 4 takes three times as long and saves 2 %

Packed = Mapping[str, bytes]
"""A chunk: the stored, compressed bytes of each variable, in the order of VARIABLES,
and its CONDITIONS.
"""

BOOKKEEPING = "bookkeeping"  # group of CHUNK_TABLES, the variables of each chunk
CONDITIONS = "chunk_conditions"  # counts of the conditions of each chunk, packed

_FLAGS = {"flag_values": np.array([0, 1], dtype="u1"), "flag_meanings": "open done"}
CHUNK_TABLES = {
    "chunk": Variable(
        np.dtype("<i4"),
        {
            "units": "1",
            "long_name": "unit of work, row-major over the chunks of the data",
        },
    ),
    "chunk_done": Variable(
        np.dtype("u1"),
        {"units": "1", "long_name": "whether this chunk's data are written", **_FLAGS},
    ),
    "chunk_checksum": Variable(
        np.dtype("<u4"),
        {"units": "1", "long_name": "CRC-32 of this chunk's stored bytes"},
    ),
}


@dataclass(frozen=True)
class ChunkGrid:
    """An array cut into chunks, which are numbered row by row. Chunks that reach over
    the edge of the array are filled up with zeros.
    """

    shape: tuple[int, ...]  # of the array
    chunk: tuple[int, ...]  # cells of a chunk along each dimension

    @property
    def counts(self) -> tuple[int, ...]:
        """The number of chunks along each dimension."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk, strict=True))

    @property
    def size(self) -> int:
        """The number of all chunks."""
        return math.prod(self.counts)

    def offset(self, index: int) -> tuple[int, ...]:
        """Return the indices of the first cell of a chunk."""
        return tuple(
            int(i) * c
            for i, c in zip(
                np.unravel_index(index, self.counts), self.chunk, strict=True
            )
        )

    def index(self, cell: Sequence[int]) -> int:
        """Return the number of the chunk that holds a cell."""
        return int(
            np.ravel_multi_index(
                [i // c for i, c in zip(cell, self.chunk, strict=True)], self.counts
            )
        )

    def extent(self, index: int) -> tuple[slice, ...]:
        """Return the cells of a chunk as slices, without the zeros beyond the edge of
        the array.
        """
        return tuple(
            slice(o, min(o + c, n))
            for o, c, n in zip(self.offset(index), self.chunk, self.shape, strict=True)
        )

    def within(self, cells: Sequence[slice]) -> Iterator[int]:
        """Return the numbers of the chunks that hold any of these cells (slices with
        start and stop).
        """
        spans = [
            range(s.start // c, -(-s.stop // c) if s.stop > s.start else 0)
            for s, c in zip(cells, self.chunk, strict=True)
        ]
        return (
            int(np.ravel_multi_index(place, self.counts)) for place in product(*spans)
        )


@dataclass(frozen=True)
class FileLayout:
    """The whole of a spectra file except the results of its cells."""

    frame: Frame  # dimensions of the sweep: the places of its cells
    chunk: tuple[int, ...]  # cells of a chunk, (rows, columns)
    names: tuple[str, ...]  # names of the variables
    scene: Mapping[str, Any]  # what identifies the scene, as JSON
    # other attributes of the root: `shard` "i/n" for the i-th of n parts, without it if
    # any chunks may be missing
    attributes: Mapping[str, Any]

    @property
    def chunk_grid(self) -> ChunkGrid:
        """The grid of chunks into which the cells are cut."""
        return ChunkGrid(self.frame.shape, (1, *self.chunk))

    def image(self) -> bytes:
        """Return the bytes of the file without a chunk."""
        buffer = io.BytesIO()
        with h5py.File(buffer, "w", track_order=True) as file:
            self._add_attributes(file)
            for name, (dimension, values) in self.frame.lists.items():
                about = self.frame.about(name)
                words = {"units": about.units, "long_name": about.long_name}
                _add_list(file, name, dimension, values, about.dtype, words)
            for name in self.names:
                self._add_variable(file, name)
            self._add_tables(file)
        return buffer.getvalue()

    def _add_attributes(self, file: h5py.File) -> None:
        """Add the attributes of the root."""
        attributes = {
            "Conventions": "CF-1.11",
            "title": "Rocking spectra",
            "source": f"rocking {__version__}",
            "scene": json.dumps(self.scene),
            **self.attributes,
        }
        for key, value in attributes.items():
            file.attrs[key] = whole_text(value) if isinstance(value, str) else value

    def _add_variable(self, file: h5py.File, name: str) -> None:
        """Add a variable of the cells, without chunks."""
        kind, frame, grid = VARIABLES[name], self.frame, self.chunk_grid
        data = file.create_dataset(
            name,
            grid.shape,
            kind.dtype,
            chunks=grid.chunk,
            shuffle=kind.dtype.itemsize > 1,
            compression="gzip",
            compression_opts=GZIP_LEVEL,
            fillvalue=kind.fill,
        )
        labels = {"coordinates": " ".join(frame.labels)} if frame.labels else {}
        for key, value in {**kind.attributes, **labels}.items():
            data.attrs[key] = (
                np.array([value], dtype=data.dtype) if key == "_FillValue" else value
            )
        for i, dimension in enumerate(frame.dimensions):
            data.dims[i].attach_scale(file[dimension])

    def _add_tables(self, file: h5py.File) -> None:
        """Add the group of the variables of each chunk."""
        size = self.chunk_grid.size
        tables = file.create_group(BOOKKEEPING, track_order=True)
        for name, kind in CHUNK_TABLES.items():
            values = np.arange(size) if name == "chunk" else np.zeros(size)
            _add_list(tables, name, "chunk", values, kind.dtype, kind.attributes)
        conditions = tables.create_dataset(CONDITIONS, size, h5py.vlen_dtype("u1"))
        conditions.attrs["long_name"] = (
            "largest condition of this chunk's cells (f8), then the bins of the"
            " conditions (u2: 64 a decade from 1e-8 on) with their cell counts (u4)"
        )
        conditions.dims[0].attach_scale(tables["chunk"])


def _add_list(
    group: h5py.Group,
    name: str,
    dimension: str,
    values: Values,
    dtype: np.dtype | None,
    attributes: Mapping[str, Any],
) -> None:
    """Add numbers, or texts without a dtype, along a dimension; the list that has its
    name is the scale of the dimension.
    """
    data = group.create_dataset(name, data=values, dtype=dtype or h5py.string_dtype())
    for key, value in attributes.items():
        data.attrs[key] = value
    if name == dimension:
        data.make_scale(name)
    else:
        data.dims[0].attach_scale(group[dimension])


def pack(block: np.ndarray, shape: tuple[int, ...] | None = None) -> bytes:
    """Return the bytes of a block after HDF5's shuffle and gzip filters; zeros fill it
    up to the shape of a chunk.
    """
    if shape not in (None, block.shape):
        block = np.pad(
            block, [(0, n - m) for m, n in zip(block.shape, shape or (), strict=True)]
        )
    planes = (
        np.ascontiguousarray(block).view(np.uint8).reshape(-1, block.dtype.itemsize).T
    )
    return zlib.compress(planes.tobytes(), GZIP_LEVEL)


def packed_block(
    names: Sequence[str], chunk: tuple[int, ...], block: Mapping[str, np.ndarray]
) -> Packed:
    """Return the chunk that holds the variables of these names of a block, and its
    conditions, none of verdicts. Workers call this.
    """
    known = block.get("condition")
    conditions = b"" if known is None else Conditions.of(known).packed()
    return {name: pack(block[name], chunk) for name in names} | {CONDITIONS: conditions}


def unpack(raw: bytes, dtype: np.dtype, shape: tuple[int, ...]) -> np.ndarray:
    """Return the block that `pack` has packed; the caller has checked the checksum of
    the bytes.
    """
    planes = np.frombuffer(zlib.decompress(raw), dtype=np.uint8).reshape(
        dtype.itemsize, math.prod(shape)
    )
    return np.ascontiguousarray(planes.T).view(dtype).reshape(shape)


def checksum(packed: Packed) -> int:
    """Return the CRC-32 of the packed variables of a chunk."""
    variables = (raw for name, raw in packed.items() if name != CONDITIONS)
    return zlib.crc32(b"".join(variables))


def joined(packed: Packed) -> bytes:
    """Return the content of an entry of a partial file: the lengths of the packed parts
    of a chunk, then their bytes.
    """
    return struct.pack(f"<{len(packed)}Q", *map(len, packed.values())) + b"".join(
        packed.values()
    )


def split(content: bytes, names: Sequence[str]) -> dict[str, bytes]:
    """Return the packed variables of these names and the conditions from the content
    that `joined` has made. Raises ValueError where it has other parts.
    """
    parts = (*names, CONDITIONS)
    begin, packed = 8 * len(parts), {}
    if len(content) < begin:
        raise ValueError("it is too short")
    for name, length in zip(
        parts, struct.unpack(f"<{len(parts)}Q", content[:begin]), strict=True
    ):
        packed[name] = content[begin : begin + length]
        begin += length
    if begin != len(content):
        raise ValueError("it has other parts")
    return packed
