"""Spectra files read back: what is in them, whether it is whole, and their cells."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

import h5py
import numpy as np

from ..dynamics.outcome import Outcome
from ..errors import OutputError, UsageError
from ..motions import Harmonic, Motion, Piece
from ..structures.parameters import RockingParameters
from .grid import Axis, Grid
from .store import stored_chunk

_FAULTS = (OSError, KeyError, ValueError, RuntimeError, TypeError, AttributeError, IndexError, UnicodeDecodeError, UsageError)


class SpectraFile:
    """A spectra file, open for reading; a context manager.

    grid; structures: parameters as stored; names: of the variables; attributes: of the root. Raises UsageError when the file
    cannot be opened and OutputError when it is not a whole spectra file.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise UsageError(f"{path}: cannot be read: no such file")
        try:
            self.file = h5py.File(self.path, "r")
        except OSError as error:
            what = "is not an HDF5 file, or is damaged" if "signature" in str(error) else f"is damaged or truncated ({error})"
            raise OutputError(f"{path}: {what}") from None
        try:
            self._read()
        except _FAULTS as error:
            self.file.close()
            raise OutputError(f"{path}: is not a spectra file of this program, or is damaged ({error})") from None

    def _read(self) -> None:
        f = self.file
        self.attributes = {key: _plain(value) for key, value in f.attrs.items()}
        self.scene: dict[str, Any] = json.loads(f.attrs["scene"])
        dimensionless = "Omega" in f
        frequency, amplitude = ("Omega", "A") if dimensionless else ("omega_g", "a_g")
        self.grid = Grid(Axis(amplitude, f[amplitude][...]), Axis(frequency, f[frequency][...]))
        names = [x.decode() for x in f["structure"][...]]
        kinds = [s["structure"] for s in self.scene["structures"]]
        columns = [f[key][...] for key in ("p", "alpha", "eta", "lambda", "a_scale", "gravity")]
        self.structures = [
            RockingParameters(name, kind, float(p), float(alpha), float(eta), float(uplift), float(scale), "stored", float(gravity))
            for name, kind, p, alpha, eta, uplift, scale, gravity in zip(names, kinds, *columns, strict=True)
        ]
        self.names = [name for name in ("theta_ratio", "outcome", "impacts") if name in f]
        self.done = f["chunk_done"][...] == 1
        self.sums = f["chunk_checksum"][...]
        self.chunk = f["outcome"].chunks
        shape = (len(names), *self.grid.shape)
        if any(f[name].shape != shape or f[name].chunks != self.chunk for name in self.names) or len(self.names) < 2:
            raise ValueError("its variables do not fit its axes")
        self.counts = [-(-n // c) for n, c in zip(shape, self.chunk, strict=True)]
        if self.done.size != int(np.prod(self.counts)) or self.sums.size != self.done.size:
            raise ValueError("its chunks are not counted right")

    @property
    def complete(self) -> bool:
        """Whether every chunk is there and the sweep came to its end."""
        return bool(self.done.all()) and self.path.suffix != ".part"

    def motion(self) -> Motion:
        """The ground motion of the spectrum. Raises OutputError."""
        try:
            name, pieces = self.scene["motion"]
            return Motion(name, tuple(Piece(**{**p, "harmonics": tuple(Harmonic(**h) for h in p["harmonics"])}) for p in pieces))
        except _FAULTS as error:
            raise OutputError(f"{self.path}: its motion cannot be read: {error}") from None

    def damaged_chunks(self) -> list[int]:
        """Indices of the chunks that are marked done and are not what was written."""
        return [int(i) for i in np.flatnonzero(self.done) if not self.intact(int(i))]

    def offset(self, index: int) -> tuple[int, int, int]:
        """(structure, row, column) of a chunk's first cell."""
        structure, row, column = (int(i) * int(c) for i, c in zip(np.unravel_index(index, self.counts), self.chunk, strict=True))
        return structure, row, column

    def packed(self, index: int) -> dict[str, bytes]:
        """The stored bytes of a chunk, checked. Raises OutputError."""
        try:
            return stored_chunk(self.file, self.names, self.offset(index), self.chunk[1:], int(self.sums[index]))
        except _FAULTS as error:
            raise OutputError(f"{self.path}: chunk {index} is damaged: {error}") from None

    def intact(self, index: int) -> bool:
        """Whether a chunk is what was written."""
        try:
            self.packed(index)
        except OutputError:
            return False
        return True

    def block(self, structure: int, rows: slice, columns: slice = slice(None)) -> dict[str, np.ndarray]:
        """The variables of a part of the grid, (frequencies, amplitudes). Raises OutputError."""
        try:
            return {name: self.file[name][structure, rows, columns] for name in self.names}
        except _FAULTS as error:
            raise OutputError(f"{self.path}: is damaged: {error}; rocking info --verify tells where") from None

    def index(self, name: str | None) -> int:
        """The structure of that name, the only one where no name is given. Raises UsageError."""
        names = [s.name for s in self.structures]
        if name is None and len(names) == 1:
            return 0
        if name not in names:
            found = f"no structure {name!r}" if name is not None else f"{len(names)} structures"
            raise UsageError(f"{self.path}: {found}; accepted are {', '.join(names)}")
        return names.index(name)

    def cells(self) -> Iterator[dict[str, Any]]:
        """Every computed cell as a record, with units where the axes have them."""
        frequency, amplitude = self.grid.frequency, self.grid.amplitude
        for i, s in enumerate(self.structures):
            step = max(1, 100_000 // amplitude.values.size)
            for first in range(0, frequency.values.size, step):
                block = self.block(i, slice(first, first + step))
                for r, row in enumerate(block["outcome"]):
                    for c in np.flatnonzero(row != Outcome.NOT_COMPUTED):
                        theta = float(block["theta_ratio"][r, c])
                        record = {
                            "structure": s.name,
                            frequency.name: float(frequency.values[first + r]),
                            amplitude.name: float(amplitude.values[c]),
                            "outcome": Outcome(int(row[c])).flag,
                            "theta_ratio": theta if np.isfinite(theta) else None,
                        }
                        if "impacts" in block:
                            record["impacts"] = int(block["impacts"][r, c])
                        yield record

    def __enter__(self) -> SpectraFile:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.file.close()


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value.tolist() if isinstance(value, np.ndarray) else value
