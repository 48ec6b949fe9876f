"""The layout of a spectra file: which datasets it has, built in memory, so that no half of one ever stands on a disk.

A new variable is one entry of a table below.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from typing import Any

import h5py
import numpy as np

from ... import __version__
from ..dimensions import About, Frame, Values
from ..variables import VARIABLES
from .chunks import GZIP_LEVEL, ChunkGrid

CHUNK_TABLES: dict[str, tuple[np.dtype, dict[str, Any]]] = {
    "chunk": (np.dtype("<i4"), {"units": "1", "long_name": "unit of work, row-major over the chunks of the data"}),
    "chunk_done": (
        np.dtype("u1"),
        {"units": "1", "long_name": "whether this chunk's data are written",
         "flag_values": np.array([0, 1], dtype="u1"), "flag_meanings": "open done"},
    ),
    "chunk_checksum": (np.dtype("<u4"), {"units": "1", "long_name": "CRC-32 of this chunk's stored bytes"}),
}  # fmt: skip
"""The variables of each chunk in the group of bookkeeping: type and attributes."""

BOOKKEEPING = "bookkeeping"


def image(frame: Frame, chunk: tuple[int, ...], names: Sequence[str], scene: Mapping[str, Any], attributes: Mapping[str, Any]) -> bytes:
    """The bytes of a spectra file that has no chunk yet; names: of its variables, attributes: of its root."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", track_order=True) as file:
        root = {"Conventions": "CF-1.11", "title": "Rocking spectra", "source": f"rocking {__version__}", "scene": json.dumps(scene)}
        for key, value in {**root, **attributes}.items():
            file.attrs[key] = _encodable(value)
        datasets = {name: _list(file, name, values, frame.about(name)) for name, values in frame.dimensions.items()}
        for name in frame.dimensions:
            datasets[name].make_scale(name)
        for name, (dimension, values) in frame.beside.items():
            datasets[name] = _list(file, name, values, frame.about(name), datasets[dimension])
        cut = ChunkGrid(frame.shape, (1, *chunk))
        labels = {"coordinates": " ".join(frame.labels)} if frame.labels else {}
        for name in names:
            kind = VARIABLES[name]
            datasets[name] = file.create_dataset(
                name, cut.shape, kind.dtype, chunks=cut.chunk, shuffle=kind.dtype.itemsize > 1,
                compression="gzip", compression_opts=GZIP_LEVEL, fillvalue=kind.fill,
            )  # fmt: skip
            _describe(datasets[name], {**kind.attributes, **labels}, *(datasets[dimension] for dimension in frame.dimensions))
        tables = file.create_group(BOOKKEEPING, track_order=True)
        for name, (dtype, about) in CHUNK_TABLES.items():
            tables[name] = np.arange(cut.size, dtype=dtype) if name == "chunk" else np.zeros(cut.size, dtype=dtype)
            if name == "chunk":
                tables[name].make_scale(name)
            _describe(tables[name], about, *([] if name == "chunk" else [tables["chunk"]]))
    return buffer.getvalue()


def _list(file: h5py.File, name: str, values: Values, about: About, *scales: h5py.Dataset) -> h5py.Dataset:
    """A new list of values along one dimension, with what it says of itself."""
    data = file.create_dataset(name, data=values, dtype=about.dtype or h5py.string_dtype())
    _describe(data, {"units": about.units, "long_name": about.long_name}, *scales)
    return data


def _describe(data: h5py.Dataset, about: Mapping[str, Any], *scales: h5py.Dataset) -> None:
    stated = data.attrs
    for key, value in about.items():
        stated[key] = np.array([value], dtype=data.dtype) if key == "_FillValue" else value
    for i, scale in enumerate(scales):
        data.dims[i].attach_scale(scale)


def _encodable(value: Any) -> Any:
    """Text that came from a command line may hold bytes that are no UTF-8, which HDF5 does not store."""
    return value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value
