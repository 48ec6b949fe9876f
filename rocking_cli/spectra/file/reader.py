"""Reading of spectra files: contents, checks, and cells."""

import io
import json
import os
import stat
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...documents.hdf5 import own_dataset
from ...dynamics.outcome import Outcome
from ...errors import OutputError, UsageError
from ...motions import Harmonic, Motion, Piece
from ...motions.grid import Axis, Grid
from ...structures.parameters import RockingParameters
from ..dimensions import LABEL, VARIABLES, VARIED, Frame, Values, varied_units
from .integrity import SIGNATURE, Log, checked_digest, read, reason
from .layout import (
    BOOKKEEPING,
    CHUNK_TABLES,
    CONDITIONS,
    ChunkGrid,
    Packed,
    checksum,
    split,
    unpack,
)

# of h5py and this module for a file that is not a whole spectra file
_FAULTS = (
    OSError,
    LookupError,
    ValueError,
    RuntimeError,
    TypeError,
    AttributeError,
    OverflowError,
    UsageError,
)

# beginnings of the names of attributes that are numbers
_NUMBERS = (
    "cells",
    "run_time",
    "check_time",
    "checked_cells",
    "error_bound",
    "largest_difference",
    "tolerance",
)


class SpectraFile(ExitStack[None]):
    """A spectra file, finished or partial, open for reading; a context manager.

    `array` returns a whole variable, `block` a part of it, `cells` rows; `grid` and
    `motion` are those of a spectrum of a pulse. Every byte is checked by the digest or
    a checksum. any_kind: True to open a table of verdicts too. Raises UsageError if the
    file cannot be opened or holds verdicts, and OutputError if it is no spectra file or
    has changed.

    Attributes
    ----------
    frame: places of its cells
    structures: parameters as stored
    names: of the variables
    chunk_grid: the grid of chunks
    done: True for each chunk that is there
    attributes: of the root
    machines: that computed the chunks
    digest: of a finished file, None for a partial file

    Examples
    --------
    >>> grid = parse_grid("A=1:3:3,Omega=2:4:2")
    >>> structures = [dimensionless_oscillator(eta=0.9)]
    >>> _ = write_spectrum(structures, sine(), grid, "s.h5", workers=1)
    >>> with SpectraFile("s.h5") as file:
    ...     print(file.complete, file.array("outcome").shape)
    True (1, 2, 3)
    """

    def __init__(self, path: str | Path, *, any_kind: bool = False) -> None:
        super().__init__()
        self.path = Path(path)
        try:
            if not stat.S_ISREG(os.stat(path).st_mode):
                raise UsageError(f"{path}: cannot be read: not a regular file")
            raw = self.enter_context(io.FileIO(path))
        except OSError as error:
            missing = isinstance(error, FileNotFoundError)
            what = "no such file" if missing else error.strerror
            raise UsageError(f"{path}: cannot be read: {what}") from None
        try:
            self._open(raw)
        except BaseException as error:
            self.close()
            if isinstance(error, _FAULTS):
                found = f"changed by another one, or damaged ({reason(error)})"
                raise OutputError(
                    f"{path}: is not a spectra file as this program wrote it: {found}"
                ) from None
            raise
        if self.frame.of_verdicts and not any_kind:
            self.close()
            raise UsageError(f"{path}: found a table of verdicts; expected spectra")
        self._arrays = lru_cache(8)(self._unpacked)  # chunks that are kept as arrays

    def _open(self, raw: io.FileIO) -> None:
        """Check the bytes, and read the lists and attributes. Raises OutputError, one
        of _FAULTS.
        """
        if read(raw, 0, len(SIGNATURE)) != SIGNATURE:
            raise OutputError(f"{self.path}: is not an HDF5 file, or is damaged")
        self.digest = checked_digest(raw)  # None for a partial file
        self._log = Log(raw) if self.digest is None else None
        image = raw if self._log is None else io.BytesIO(self._log.image)
        file = self.file = self.enter_context(h5py.File(image, "r"))
        if BOOKKEEPING not in file:
            raise OutputError(
                f"{self.path}: was not written by this version; compute it again"
            )
        tables = file[BOOKKEEPING]
        names = [name for name in file if name != BOOKKEEPING]
        for group, some in ((file, names), (tables, [*CHUNK_TABLES, CONDITIONS])):
            for name in some:
                own_dataset(group, name)

        self._read_scene(file, names)
        self.done = tables["chunk_done"][...] == 1
        self._sums = tables["chunk_checksum"][...]
        self._conditions = tables[CONDITIONS]
        if self._log is not None:
            self.machines = _machines(self._log.notes.get("computed_on", []))
            chunks = np.arange(self.chunk_grid.size)
            self.done = np.isin(chunks, list(self._log.places))

    def _read_scene(self, file: h5py.File, names: Sequence[str]) -> None:
        """Read the attributes, the structures, the places of the cells and the names of
        the variables. Raises ValueError where they do not fit each other.
        """
        # of the root
        self.attributes = {
            key: x.tolist() if isinstance(x, np.generic | np.ndarray) else x
            for key, x in file.attrs.items()
        }
        for key, value in self.attributes.items():
            if key.startswith(_NUMBERS) and not isinstance(value, int | float):
                raise ValueError(f"its {key} is {value!r}, no number")
        self.machines = _machines(json.loads(self.attributes.get("computed_on", "[]")))
        # identity of the scene
        self.scene: dict[str, Any] = json.loads(self.attributes["scene"])
        if not isinstance(self.scene["model"], str):
            raise ValueError("its scene has no model")
        # parameters as stored
        self.structures = tuple(
            RockingParameters.from_row(row) for row in self.scene.get("structures", ())
        )

        outcome = file["outcome"]
        dimensions = {axis[0].name[1:]: _values(axis[0]) for axis in outcome.dims}
        for name in names:
            if name not in VARIABLES and file[name].ndim == outcome.ndim:
                raise OutputError(
                    f"{self.path}: found the variable {name}, which this version does"
                    f" not know; expected {', '.join(VARIABLES)}: compute the spectra"
                    " again"
                )
        lists = {
            name: (file[name].dims[0][0].name[1:], _values(file[name]))
            for name in names
            if name not in VARIABLES and name not in dimensions
        }
        # places of the cells
        units = self.scene.get("varied_units") or varied_units(self.structures)
        self.frame = Frame(dimensions, lists, units)
        # of a spectrum of a pulse
        pulse = not (self.frame.of_records or self.frame.of_verdicts)
        self._motion = _motion(self.scene["motion"]) if pulse else None
        self.names = tuple(name for name in VARIABLES if name in names)
        self.chunk_grid = ChunkGrid(self.frame.shape, outcome.chunks)
        for name in self.names:
            found = file[name].dtype, file[name].shape, file[name].chunks
            grid = self.chunk_grid
            if found != (VARIABLES[name].dtype, grid.shape, grid.chunk):
                raise ValueError(f"its {name} does not fit its axes")

    @property
    def complete(self) -> bool:
        """True if every chunk is there and the sweep has finished."""
        return bool(self.done.all()) and self.digest is not None

    @property
    def grid(self) -> Grid:
        """The grid of a spectrum of a pulse. Raises UsageError for one of records."""
        (frequency, omega), (amplitude, a) = list(self.frame.dimensions.items())[1:]
        if self.frame.of_records:
            raise UsageError(
                f"{self.path}: found spectra of records over {frequency} and"
                f" {amplitude}; expected the spectrum of a pulse"
            )
        return Grid(Axis(amplitude, np.asarray(a)), Axis(frequency, np.asarray(omega)))

    def motion(self) -> Motion:
        """Return the ground motion of a spectrum of a pulse. Raises UsageError for one
        of records.
        """
        if self._motion is None or "vertical" in self.scene:
            found = (
                "spectra of records" if self.frame.of_records else "a vertical motion"
            )
            raise UsageError(
                f"{self.path}: found {found}; expected the spectrum of a pulse, which"
                " is horizontal alone"
            )
        return self._motion

    def damaged_chunks(self) -> list[int]:
        """Indices of the chunks that are marked done but damaged."""
        return [int(i) for i in np.flatnonzero(self.done) if not self.intact(int(i))]

    def intact(self, index: int) -> bool:
        """True if a chunk is undamaged.

        Parameters
        ----------
        index
            index of the chunk

        Returns
        -------
        bool
        """
        try:
            self.packed(index)
        except OutputError:
            return False
        return True

    def outcomes(self, index: int) -> np.ndarray:
        """Return the number of cells of a chunk for each outcome.

        Parameters
        ----------
        index
            index of the chunk

        Returns
        -------
        array
            counts, (outcomes,)

        Raises
        ------
        OutputError
            for a damaged chunk
        """
        return np.bincount(
            self._arrays(index)["outcome"].ravel(), minlength=len(Outcome)
        )

    def packed(self, index: int) -> Packed:
        """Return the bytes of a chunk as they are stored, compressed.

        Parameters
        ----------
        index
            index of the chunk

        Returns
        -------
        Packed
            bytes by variable, and the packed conditions of its cells

        Raises
        ------
        OutputError
            if they are damaged
        """
        try:
            if self._log is not None:
                return split(self._log.content(index), self.names)
            stored = {
                name: self.file[name].id.read_direct_chunk(
                    self.chunk_grid.offset(index)
                )
                for name in self.names
            }
            packed = {name: raw for name, (_, raw) in stored.items()}
            if any(mask for mask, _ in stored.values()) or checksum(packed) != int(
                self._sums[index]
            ):
                raise ValueError("its checksum does not fit")
            packed[CONDITIONS] = (
                b"" if self._conditions is None else self._conditions[index].tobytes()
            )
            return packed
        except _FAULTS as error:
            raise OutputError(
                f"{self.path}: chunk {index} is damaged: {reason(error)}"
            ) from None

    def _unpacked(self, index: int) -> dict[str, np.ndarray]:
        """Return the variables of a chunk, without the zeros beyond the grid's edge.
        Raises OutputError if the chunk is damaged.
        """
        cells = tuple(slice(0, s.stop - s.start) for s in self.chunk_grid.extent(index))
        packed = self.packed(index)
        return {
            name: unpack(packed[name], VARIABLES[name].dtype, self.chunk_grid.chunk)[
                cells
            ]
            for name in self.names
        }

    def block(
        self, place: int, rows: slice, columns: slice = slice(None)
    ) -> dict[str, np.ndarray]:
        """Return the variables over a part of the cells.

        Parameters
        ----------
        place
            index along the first dimension
        rows, columns
            slices of the second and third dimension

        Returns
        -------
        dict of arrays
            by variable, (rows, columns)

        Raises
        ------
        OutputError
            for a damaged chunk
        """
        wanted = [
            slice(*s.indices(n)[:2])
            for s, n in zip(
                (slice(place, place + 1), rows, columns), self.frame.shape, strict=True
            )
        ]
        shape = [max(0, s.stop - s.start) for s in wanted]
        found = {
            name: np.full(shape, VARIABLES[name].fill, VARIABLES[name].dtype)
            for name in self.names
        }
        for index in self.chunk_grid.within(wanted):
            if self.done[index]:
                chunk = self.chunk_grid.extent(index)
                common = [
                    slice(max(a.start, b.start), min(a.stop, b.stop))
                    for a, b in zip(wanted, chunk, strict=True)
                ]
                for name, array in self._arrays(index).items():
                    found[name][_within(wanted, common)] = array[_within(chunk, common)]
        return {name: values[0] for name, values in found.items()}

    def array(self, name: str) -> np.ndarray:
        """Return one variable over all cells.

        Parameters
        ----------
        name
            one of `names`, such as "theta_ratio"

        Returns
        -------
        array
            over all three dimensions; NaN or 0 in cells that are not computed

        Raises
        ------
        UsageError
            for a variable that the file does not hold
        OutputError
            for a damaged chunk
        """
        if name not in self.names:
            raise UsageError(
                f"{self.path}: has no variable {name!r}; expected one of"
                f" {', '.join(self.names)}"
            )
        return np.stack(
            [self.block(i, slice(None))[name] for i in range(self.frame.shape[0])]
        )

    def cells(
        self, progress: Callable[[int, int], None] | None = None
    ) -> Iterator[dict[str, Any]]:
        """Yield a row for every computed cell: its place on each dimension, in SI
        units, and its variables; of a verdict also labels and varied keys of the
        structure.

        Parameters
        ----------
        progress
            called with the number of blocks of cells that are read, and of all

        Returns
        -------
        iterator of dict

        Raises
        ------
        OutputError
            for a damaged chunk
        """
        places, frequencies, columns = (
            values if isinstance(values, list) else values.tolist()
            for values in self.frame.dimensions.values()
        )
        height = self.chunk_grid.chunk[1]
        begins = range(0, len(frequencies), height)
        names = sorted(self.names, key=lambda name: name != "outcome")
        _, second, _ = self.frame.dimensions
        beside = {
            name: values
            for name, (along, values) in self.frame.extra.items()
            if along == second and name.startswith((LABEL, VARIED))
        }
        blocks = product(enumerate(places), begins)
        for done, ((i, place), begin) in enumerate(blocks, 1):
            block = self.block(i, slice(begin, begin + height))
            computed = block["outcome"] != Outcome.NOT_COMPUTED
            for r, c in np.argwhere(computed).tolist():
                where = place, frequencies[begin + r], columns[c]
                found = {name: _value(name, block[name][r, c]) for name in names}
                own = {name: values[begin + r] for name, values in beside.items()}
                yield dict(zip(self.frame.dimensions, where, strict=True)) | found | own
            if progress:
                progress(done, len(places) * len(begins))


def _within(cells: Sequence[slice], some: Sequence[slice]) -> tuple[slice, ...]:
    """Return the slices of `some` cells counted from the first of `cells`."""
    return tuple(
        slice(s.start - first.start, s.stop - first.start)
        for s, first in zip(some, cells, strict=True)
    )


def _value(name: str, value: np.generic) -> float | int | str | None:
    """Return the value of a cell for JSON: a number, None for NaN, or the word of a
    code.
    """
    if (codes := VARIABLES[name].codes) is not None:
        return codes(int(value.item())).flag
    number: float | int = value.item()
    return number if np.isfinite(number) else None


def _machines(stated: Any) -> list[dict[str, Any]]:
    """Return the machines that a file states. Raises TypeError, ValueError."""
    return [dict(machine) for machine in stated]


def _motion(stated: Any) -> Motion:
    """Return the motion that a scene states. Raises TypeError, ValueError, KeyError."""
    name, pieces = stated
    if not isinstance(name, str):
        raise ValueError("its motion has no name")
    return Motion(
        name,
        tuple(
            Piece(**{**p, "harmonics": tuple(Harmonic(**h) for h in p["harmonics"])})
            for p in pieces
        ),
    )


def _values(data: h5py.Dataset) -> Values:
    """Return the numbers or texts of a dataset."""
    values = data[...]
    return [text.decode() for text in values] if data.dtype.hasobject else values
