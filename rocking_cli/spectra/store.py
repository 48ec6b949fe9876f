"""Spectra on disk: HDF5 with named dimensions, coordinates and units, that netCDF readers open as it is.

A sweep writes to `OUT.h5.part`: a chunk's data, flush, its done flag, flush; the file takes its final name when complete,
so that nothing half-written ever stands under it. One writer.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import h5py
import numpy as np

from .. import __version__
from ..dynamics.outcome import Outcome
from ..errors import OutputError, UsageError
from ..structures.parameters import RockingParameters
from .grid import LONG_NAMES, UNITS, Grid

GZIP_LEVEL = 1  # on these data level 4 takes three times as long and saves 2 %

PARAMETERS: dict[str, tuple[str, str, Callable[[RockingParameters], float]]] = {
    "p": ("rad s-1", "frequency parameter", lambda s: s.p),
    "alpha": ("rad", "critical angle", lambda s: s.alpha),
    "eta": ("1", "coefficient of restitution", lambda s: s.eta),
    "lambda": ("1", "static uplift acceleration over gravity", lambda s: s.uplift),
    "a_scale": ("1", "scale of the ground acceleration", lambda s: s.a_scale),
    "gravity": ("m s-2", "acceleration of gravity", lambda s: s.gravity),
}

VARIABLES: dict[str, tuple[np.dtype, dict[str, Any]]] = {
    "theta_ratio": (
        np.dtype("<f8"),
        {"units": "1", "long_name": "largest rotation over critical angle", "_FillValue": np.nan,
         "comment": "max over time of abs(theta)/alpha; NaN where overturned or not computed"},
    ),
    "outcome": (
        np.dtype("u1"),
        {"units": "1", "long_name": "outcome", "flag_values": np.array([o.value for o in Outcome], dtype="u1"),
         "flag_meanings": " ".join(o.flag for o in Outcome)},
    ),
    "impacts": (np.dtype("<i4"), {"units": "1", "long_name": "impacts during shaking"}),
}  # fmt: skip


def pack(block: np.ndarray) -> bytes:
    """A chunk as HDF5's shuffle and gzip filters would store it; a worker does this so that the writer only writes."""
    if block.dtype.itemsize > 1:
        block = block.reshape(-1).view(np.uint8).reshape(-1, block.dtype.itemsize).T
    return zlib.compress(np.ascontiguousarray(block).tobytes(), GZIP_LEVEL)


def check_output(path: Path, overwrite: bool) -> None:
    """Refuse an output that exists, or whose folder does not, before any work is done. Raises UsageError."""
    if str(path) in ("-", ".", ""):
        raise UsageError(f"{str(path)!r} is not the name of a file; an HDF5 file cannot be written to standard output")
    if not path.parent.is_dir():
        raise UsageError(f"{path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise UsageError(f"{path}: is a folder, accepted is the name of a file")
    for there in (path, part_of(path)):
        if there.exists() and not overwrite:
            what = "exists" if there == path else "exists, left by a sweep that did not finish"
            raise UsageError(f"{there}: {what}; --overwrite replaces it")


def part_of(path: Path) -> Path:
    """The name a spectra file has while it is being written."""
    return path.with_name(path.name + ".part")


class SpectraWriter:
    """The one writer of a spectra file; a context manager that closes it whatever happens.

    Raises OutputError when the file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        structures: Sequence[RockingParameters],
        grid: Grid,
        chunk: tuple[int, int],
        *,
        impacts: bool,
        overwrite: bool,
        attributes: Mapping[str, Any],
    ) -> None:
        check_output(path, overwrite)
        self.path, self.part, self.overwrite, self.chunk = path, part_of(path), overwrite, chunk
        self.written = 0
        try:
            self.file = h5py.File(self.part, "w", track_order=True)
            self._layout(structures, grid, impacts, attributes)
        except OSError as error:
            raise OutputError(f"{self.part}: cannot be written: {error}") from None

    def _layout(self, structures: Sequence[RockingParameters], grid: Grid, impacts: bool, attributes: Mapping[str, Any]) -> None:
        f = self.file
        f.attrs["Conventions"] = "CF-1.11"
        f.attrs["title"] = "Rocking spectra"
        f.attrs["source"] = f"rocking {__version__}"
        for key, value in attributes.items():
            f.attrs[key] = value
        dimensions = ("structure", grid.frequency.name, grid.amplitude.name)
        f.create_dataset("structure", data=[s.name for s in structures], dtype=h5py.string_dtype())
        f["structure"].attrs["long_name"] = "name of the structure"
        f["structure"].attrs["units"] = "1"
        for axis in (grid.frequency, grid.amplitude):
            f.create_dataset(axis.name, data=axis.values)
            f[axis.name].attrs["units"] = UNITS[axis.name]
            f[axis.name].attrs["long_name"] = LONG_NAMES[axis.name]
        for name in dimensions:
            f[name].make_scale(name)
        for name, (units, long_name, get) in PARAMETERS.items():
            f.create_dataset(name, data=[get(s) for s in structures])
            f[name].attrs["units"], f[name].attrs["long_name"] = units, long_name
            f[name].dims[0].attach_scale(f["structure"])
        shape = (len(structures), *grid.shape)
        self.names = ["theta_ratio", "outcome", *(["impacts"] if impacts else [])]
        for name in self.names:
            dtype, attrs = VARIABLES[name]
            fill = attrs.get("_FillValue", 0)
            data = f.create_dataset(
                name, shape, dtype, chunks=(1, *self.chunk), shuffle=dtype.itemsize > 1,
                compression="gzip", compression_opts=GZIP_LEVEL, fillvalue=fill,
            )  # fmt: skip
            for key, value in attrs.items():
                data.attrs[key] = np.array([value], dtype=dtype) if key == "_FillValue" else value
            for i, dimension in enumerate(dimensions):
                data.dims[i].attach_scale(f[dimension])
        counts = [-(-n // c) for n, c in zip(shape, (1, *self.chunk), strict=True)]
        done = f.create_dataset("chunk_done", data=np.zeros(int(np.prod(counts)), dtype="u1"))
        f.create_dataset("chunk", data=np.arange(int(np.prod(counts)), dtype="<i4")).make_scale("chunk")
        f["chunk"].attrs["units"], f["chunk"].attrs["long_name"] = "1", "unit of work, row-major over the chunks of the data"
        done.attrs["units"], done.attrs["long_name"] = "1", "whether this chunk's data are written"
        done.attrs["flag_values"], done.attrs["flag_meanings"] = np.array([0, 1], dtype="u1"), "open done"
        done.dims[0].attach_scale(f["chunk"])
        self._counts = counts
        self.chunks = int(np.prod(counts))
        f.flush()

    def write(self, structure: int, row: int, column: int, packed: Mapping[str, bytes]) -> None:
        """Write the packed chunk of one structure whose first cell is (row, column), and mark it done."""
        try:
            for name in self.names:
                self.file[name].id.write_direct_chunk((structure, row, column), packed[name], 0)
            self.file.flush()
            index = np.ravel_multi_index((structure, row // self.chunk[0], column // self.chunk[1]), self._counts)
            self.file["chunk_done"][index] = 1
            self.file.flush()
            self.written += 1
        except OSError as error:
            raise OutputError(f"{self.part}: cannot be written: {error}; what was done is kept there") from None

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Add the closing attributes, make the file durable and give it its final name."""
        try:
            for key, value in attributes.items():
                self.file.attrs[key] = value
            self.file.close()
            with open(self.part, "rb") as handle:
                os.fsync(handle.fileno())
            if self.overwrite:
                os.replace(self.part, self.path)
            else:  # a link fails where a file of that name has appeared meanwhile; a rename would replace it
                os.link(self.part, self.path)
                os.unlink(self.part)
        except FileExistsError:
            raise OutputError(f"{self.path}: has appeared meanwhile; the result is kept as {self.part}") from None
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be written: {error}; the result is kept as {self.part}") from None

    def __enter__(self) -> SpectraWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.file.id.valid:
            self.file.close()
        if error is not None and not self.written:
            self.part.unlink(missing_ok=True)  # there is nothing in it to keep
