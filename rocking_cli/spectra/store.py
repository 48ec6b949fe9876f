"""Spectra on disk: HDF5 with named dimensions, coordinates and units, that netCDF readers open as it is.

A sweep writes to `OUT.h5.part`: a chunk's data and checksum, flush, its done flag, flush; the file takes its final name when
complete, so that nothing half-written ever stands under it, and a sweep that was stopped goes on from there. One writer.
"""

from __future__ import annotations

import json
import os
import re
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
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


def unpack(raw: bytes, dtype: np.dtype, shape: tuple[int, ...]) -> np.ndarray:
    """The inverse of `pack`. Raises ValueError when the bytes are not such a chunk."""
    try:
        data = np.frombuffer(zlib.decompress(raw), dtype=np.uint8)
    except zlib.error as error:
        raise ValueError(str(error)) from None
    if data.size != dtype.itemsize * int(np.prod(shape)):
        raise ValueError(f"{data.size} bytes, expected {dtype.itemsize * int(np.prod(shape))}")
    if dtype.itemsize > 1:
        data = np.ascontiguousarray(data.reshape(dtype.itemsize, -1).T)
    return data.reshape(-1).view(dtype).reshape(shape)


def checksum(packed: Mapping[str, bytes], names: Sequence[str]) -> int:
    """CRC-32 over the packed variables of a chunk, in their order."""
    total = 0
    for name in names:
        total = zlib.crc32(packed[name], total)
    return total


def stored_chunk(
    file: h5py.File, names: Sequence[str], offset: tuple[int, int, int], chunk: tuple[int, int], sum_: int
) -> dict[str, bytes]:
    """The stored bytes of a chunk's variables. Raises ValueError, or what HDF5 raises, where they are not what was written."""
    packed = {name: file[name].id.read_direct_chunk(offset)[1] for name in names}
    if checksum(packed, names) != sum_:
        raise ValueError("its checksum does not fit")
    unpack(packed["outcome"], np.dtype("u1"), chunk)
    return packed


def stored_outcomes(
    packed: Mapping[str, bytes], offset: tuple[int, int, int], chunk: tuple[int, int], shape: tuple[int, int]
) -> np.ndarray:
    """How many of a chunk's cells came to each outcome; shape: of the whole grid, at whose edge a chunk is filled up."""
    block = unpack(packed["outcome"], np.dtype("u1"), chunk)[: shape[0] - offset[1], : shape[1] - offset[2]]
    return np.bincount(block.ravel(), minlength=len(Outcome))


def difference(one: Mapping[str, Any], other: Mapping[str, Any]) -> str | None:
    """The first key in which two scenes differ."""
    return next((key for key in dict.fromkeys([*one, *other]) if one.get(key) != other.get(key)), None)


def check_output(path: Path, overwrite: bool, resume: bool = False) -> None:
    """Refuse an output that exists, or whose folder does not, before any work is done. Raises UsageError."""
    if str(path) in ("-", ".", ""):
        raise UsageError(f"{str(path)!r} is not the name of a file; an HDF5 file cannot be written to standard output")
    if not path.parent.is_dir():
        raise UsageError(f"{path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise UsageError(f"{path}: is a folder, accepted is the name of a file")
    if resume and overwrite:
        raise UsageError("--resume does not go with --overwrite")
    if path.exists() and not overwrite:
        raise UsageError(f"{path}: exists{' and is complete' if resume else ''}; --overwrite replaces it")
    if part_of(path).exists() and not (overwrite or resume):
        raise UsageError(f"{part_of(path)}: exists, left by a sweep that did not finish; --resume goes on with it, --overwrite begins anew")


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
        resume: bool,
        scene: Mapping[str, Any],
        attributes: Mapping[str, Any],
    ) -> None:
        check_output(path, overwrite, resume)
        self.path, self.part, self.overwrite, self.chunk = path, part_of(path), overwrite, chunk
        self.written = 0
        shape = (len(structures), *grid.shape)
        self.names = ["theta_ratio", "outcome", *(["impacts"] if impacts else [])]
        self._counts = [-(-n // c) for n, c in zip(shape, (1, *chunk), strict=True)]
        self.chunks = int(np.prod(self._counts))
        self.done = np.zeros(self.chunks, dtype=bool)
        self.outcomes: dict[int, np.ndarray] = {}  # of the chunks that were there before
        self.resumed = 0
        try:
            if resume and self.part.exists():
                self._reopen(scene)
                return
            fresh = self.part.with_name(self.part.name + ".new")  # so that a part is never without its layout
            self.file = h5py.File(fresh, "w", track_order=True)
            self.file.attrs["scene"] = json.dumps(scene)
            self._layout(structures, grid, impacts, attributes)
            self.file.close()
            os.replace(fresh, self.part)
            self.file = h5py.File(self.part, "r+")
        except OSError as error:
            raise OutputError(f"{self.part}: cannot be written: {_reason(error)}") from None

    def _reopen(self, scene: Mapping[str, Any]) -> None:
        """Go on with a part: the same scene, and every chunk that is marked done whole."""
        try:
            self.file = self._open_part()
            before = json.loads(self.file.attrs["scene"])
            key = difference(before, scene)
            if key is not None:
                self.file.close()
                raise UsageError(
                    f"{self.part}: is of another scene: its {key} is {_brief(before.get(key))}, this one's {_brief(scene.get(key))}; "
                    "--overwrite begins anew"
                )
            flags, sums = self.file["chunk_done"][...] == 1, self.file["chunk_checksum"][...]
            if any(self.file[name].chunks != (1, *self.chunk) for name in self.names) or flags.size != self.chunks:
                raise ValueError("its layout is damaged")
        except (OSError, KeyError, ValueError, RuntimeError) as error:
            raise OutputError(f"{self.part}: is not a sweep that can go on ({error}); --overwrite begins anew") from None
        grid = self.file["outcome"].shape[1:]
        for index in np.flatnonzero(flags):
            offset = self._offset(int(index))
            with suppress(OSError, ValueError, RuntimeError):  # a damaged chunk is computed again
                packed = stored_chunk(self.file, self.names, offset, self.chunk, int(sums[index]))
                self.outcomes[int(index)] = stored_outcomes(packed, offset, self.chunk, grid)
                self.done[index] = True
        self.file["chunk_done"][...] = self.done.astype("u1")
        self.file.flush()
        self.resumed = int(self.done.sum())

    def _open_part(self) -> h5py.File:
        """A part whose end a full disk cut off is given its length again; the checksums tell which chunks that cost."""
        _state_end(self.part)
        try:
            return h5py.File(self.part, "r+")
        except OSError as error:
            length = re.search(r"stored_eof = (\d+)", str(error))
            if length is None or int(length[1]) <= self.part.stat().st_size:
                raise
            os.truncate(self.part, int(length[1]))
            return h5py.File(self.part, "r+")

    def has(self, structures: Sequence[int], row: int, column: int) -> bool:
        """Whether the chunks of these structures whose first cell is (row, column) are all there; if not, none counts."""
        indices = [self._index(i, row, column) for i in structures]
        if all(self.done[indices]):
            return True
        for index in indices:
            self.outcomes.pop(index, None)
        return False

    def _offset(self, index: int) -> tuple[int, int, int]:
        structure, row, column = (int(i) for i in np.unravel_index(index, self._counts))
        return structure, row * self.chunk[0], column * self.chunk[1]

    def _index(self, structure: int, row: int, column: int) -> int:
        return int(np.ravel_multi_index((structure, row // self.chunk[0], column // self.chunk[1]), self._counts))

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
        done = f.create_dataset("chunk_done", data=np.zeros(self.chunks, dtype="u1"))
        sums = f.create_dataset("chunk_checksum", data=np.zeros(self.chunks, dtype="<u4"))
        f.create_dataset("chunk", data=np.arange(self.chunks, dtype="<i4")).make_scale("chunk")
        f["chunk"].attrs["units"], f["chunk"].attrs["long_name"] = "1", "unit of work, row-major over the chunks of the data"
        done.attrs["units"], done.attrs["long_name"] = "1", "whether this chunk's data are written"
        done.attrs["flag_values"], done.attrs["flag_meanings"] = np.array([0, 1], dtype="u1"), "open done"
        done.dims[0].attach_scale(f["chunk"])
        sums.attrs["units"], sums.attrs["long_name"] = "1", "CRC-32 of this chunk's stored bytes"
        sums.dims[0].attach_scale(f["chunk"])
        f.flush()

    def write(self, structure: int, row: int, column: int, packed: Mapping[str, bytes]) -> None:
        """Write the packed chunk of one structure whose first cell is (row, column), and mark it done."""
        try:
            for name in self.names:
                self.file[name].id.write_direct_chunk((structure, row, column), packed[name], 0)
            index = self._index(structure, row, column)
            self.file["chunk_checksum"][index] = checksum(packed, self.names)
            self.file.flush()
            self.file["chunk_done"][index] = 1
            self.file.flush()
            self.written += 1
        except (OSError, RuntimeError) as error:
            raise OutputError(f"{self.part}: cannot be written: {_reason(error)}; what was done is kept there for --resume") from None

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
        except (OSError, RuntimeError) as error:
            kept = f"the result is kept as {self.part}" if self.part.exists() else f"{self.part} has vanished meanwhile"
            raise OutputError(f"{self.path}: cannot be written: {_reason(error)}; {kept}") from None

    def __enter__(self) -> SpectraWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.file.id.valid:
            try:
                self.file.close()
            except (OSError, RuntimeError):  # on a full disk; the error that is on its way says so
                if error is None:
                    raise
        if error is not None and not self.written and not self.resumed:
            self.part.unlink(missing_ok=True)  # there is nothing in it to keep


def _state_end(part: Path) -> None:
    """Where a killed writer left data beyond the end that the superblock states (version 0, bytes 40 to 47), state the file's own.

    HDF5 refuses every address beyond the stated end, and so would never again write a chunk whose index came through alone.
    """
    with open(part, "r+b") as raw:
        head, size = raw.read(48), os.fstat(raw.fileno()).st_size
        plain = head[:9] == b"\x89HDF\r\n\x1a\n\0" and head[13:14] == b"\x08" and not any(head[24:32])
        if plain and int.from_bytes(head[40:48], "little") < size:
            raw.seek(40)
            raw.write(size.to_bytes(8, "little"))


def _reason(error: Exception) -> str:
    """The system's own words; HDF5 hides its error number in a longer text."""
    number = getattr(error, "errno", None) or next((int(n) for n in re.findall(r"errno = (\d+)", str(error))), 0)
    return os.strerror(number) if number else str(error)


def _brief(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."
