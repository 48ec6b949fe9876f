"""The layout of a spectra file: its datasets, built in memory so that no incomplete layout is ever on a disk."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np

from ... import __version__
from ..dimensions import Frame, Values
from ..variables import VARIABLES, Variable
from .chunks import GZIP_LEVEL, ChunkGrid

BOOKKEEPING = "bookkeeping"  # name of the group

_FLAGS = {"flag_values": np.array([0, 1], dtype="u1"), "flag_meanings": "open done"}
CHUNK_TABLES = {
    "chunk": Variable(np.dtype("<i4"), {"units": "1", "long_name": "unit of work, row-major over the chunks of the data"}),
    "chunk_done": Variable(np.dtype("u1"), {"units": "1", "long_name": "whether this chunk's data are written", **_FLAGS}),
    "chunk_checksum": Variable(np.dtype("<u4"), {"units": "1", "long_name": "CRC-32 of this chunk's stored bytes"}),
}
"""The variables of each chunk in the group of bookkeeping."""


@dataclass(frozen=True)
class Layout:
    """A spectra file without its cells.

    frame: the places of its cells; chunk: (rows, columns); names: of the variables; scene: the identity of the scene; attributes: others of
    the root, with shard "i/n" for the i-th of n parts, and without shard if any chunks may be missing.
    """

    frame: Frame
    chunk: tuple[int, ...]
    names: tuple[str, ...]
    scene: Mapping[str, Any]
    attributes: Mapping[str, Any]

    @property
    def cut(self) -> ChunkGrid:
        """The cells, cut into chunks."""
        return ChunkGrid(self.frame.shape, (1, *self.chunk))

    def image(self) -> bytes:
        """The bytes of the file without a chunk."""
        buffer, frame, cut = io.BytesIO(), self.frame, self.cut
        with h5py.File(buffer, "w", track_order=True) as file:
            root = {"Conventions": "CF-1.11", "title": "Rocking spectra", "source": f"rocking {__version__}"}
            for key, value in {**root, "scene": json.dumps(self.scene), **self.attributes}.items():
                file.attrs[key] = _encodable(value)
            for name, (dimension, values) in frame.lists.items():
                about = frame.about(name)
                _add_list(file, name, dimension, values, about.dtype, {"units": about.units, "long_name": about.long_name})
            labels = {"coordinates": " ".join(frame.labels)} if frame.labels else {}
            for name in self.names:
                kind = VARIABLES[name]
                data = file.create_dataset(
                    name, cut.shape, kind.dtype, chunks=cut.chunk, shuffle=kind.dtype.itemsize > 1,
                    compression="gzip", compression_opts=GZIP_LEVEL, fillvalue=kind.fill,
                )  # fmt: skip
                for key, value in {**kind.attributes, **labels}.items():
                    data.attrs[key] = np.array([value], dtype=data.dtype) if key == "_FillValue" else value
                for i, dimension in enumerate(frame.dimensions):
                    data.dims[i].attach_scale(file[dimension])
            tables = file.create_group(BOOKKEEPING, track_order=True)
            for name, kind in CHUNK_TABLES.items():
                values = np.arange(cut.size) if name == "chunk" else np.zeros(cut.size)
                _add_list(tables, name, "chunk", values, kind.dtype, kind.attributes)
        return buffer.getvalue()


def _add_list(group: h5py.Group, name: str, dimension: str, values: Values, dtype: np.dtype | None, attributes: Mapping[str, Any]) -> None:
    """Add numbers, or texts without a dtype, along a dimension; the list that has its name is the scale of the dimension."""
    data = group.create_dataset(name, data=values, dtype=dtype or h5py.string_dtype())
    for key, value in attributes.items():
        data.attrs[key] = value
    if name == dimension:
        data.make_scale(name)
    else:
        data.dims[0].attach_scale(group[dimension])


def _encodable(value: Any) -> Any:
    """The value with bytes that are not UTF-8 escaped, since HDF5 cannot store them."""
    return value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value
