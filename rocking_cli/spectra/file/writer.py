"""The writer of a spectra file: it appends chunks to the partial file, and at the end
writes the HDF5 file from it.

The partial file is the layout of the file to come, and behind it an entry for each
chunk that is done. Entries are only appended and have checksums, so a kill loses at
most the last entry, and a flipped bit only its chunk.
"""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import h5py
import numpy as np

from ...errors import OutputError, UsageError
from ...publishing import followed, published
from ..error_bound import Conditions
from ..scene import Unit
from ..work.machine import machine, together, unlike
from .integrity import (
    NOTE,
    SIGNATURE,
    Log,
    digest,
    digest_line,
    entry_of,
    read,
    reason,
    write,
)
from .layout import (
    BOOKKEEPING,
    CONDITIONS,
    FileLayout,
    Packed,
    checksum,
    joined,
    packed_block,
    split,
)
from .partial_file import check_output, is_there, open_locked, refuse_existing
from .same_scene import first_difference

if TYPE_CHECKING:
    from .reader import SpectraFile


class SpectraWriter:
    """The one writer of a spectra file; a context manager that closes the partial file
    whatever happens. strict: refuse a partial file that was begun on a machine that
    computes differently; machines: the machines that computed the chunks, by default
    this one. Raises UsageError for an output that is refused, OutputError when the file
    is in use or cannot be written.
    """

    def __init__(
        self,
        path: Path,
        layout: FileLayout,
        *,
        overwrite: bool = False,
        resume: bool = False,
        strict: bool = False,
        machines: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        self.part = check_output(path, overwrite, resume)  # the partial file
        self.output = followed(path)  # the finished file
        self.overwrite = overwrite  # whether it may replace another one
        self.names = layout.names  # names of the variables
        # turns a block of cells into a packed chunk
        self.convert = partial(packed_block, layout.names, layout.chunk)
        self.chunk_grid = layout.chunk_grid  # the grid of the chunks
        self.whole = layout.attributes.get("shard") == "1/1"
        # counts of outcomes in each chunk of an earlier run
        self.resumed: dict[int, np.ndarray] = {}
        # of the cells in all chunks; None where a chunk states none
        self.conditions: Conditions | None = Conditions.of(np.zeros(0))
        # True for each finished chunk, (chunks,)
        self.done = np.zeros(self.chunk_grid.size, dtype=bool)
        self.machines = together([machines or [machine()]])
        try:
            self.file, self.created = open_locked(self.part)
            try:
                self._begin(layout, overwrite, resume, strict)
            except BaseException:
                self.discard()
                self.file.close()
                raise
        except OSError as error:
            raise OutputError(
                f"{self.part}: cannot be written: {error.strerror or error}"
            ) from None
        except ValueError as error:
            raise OutputError(
                f"{self.part}: is not a sweep that can go on ({error}); it is kept,"
                " `overwrite` begins anew"
            ) from None

    def _begin(
        self, layout: FileLayout, overwrite: bool, resume: bool, strict: bool
    ) -> None:
        """Begin the partial file, or continue it. Raises UsageError, OutputError,
        OSError, or ValueError where it cannot go on.
        """
        head = read(self.file, 0, len(SIGNATURE))
        if any(head) and head != SIGNATURE:
            raise UsageError(
                f"{self.part}: is no partial file of this program; move it away, or"
                " give another output"
            )
        begun = any(head)  # these bytes are written last
        # an output may have appeared before the partial file was locked
        partial = self.part if begun else None
        refuse_existing(self.output, partial, overwrite, resume)
        if not (begun and resume):
            self._write_layout(layout)
        self.log = Log(self.file)
        if begun and resume:
            self._resume(layout, strict)
        self.log.note(computed_on=self.machines)
        # those of the machines, empty if they compute alike
        self.machine_differences = unlike(self.machines)

    def _write_layout(self, layout: FileLayout) -> None:
        """Write the layout of the file to come, its first bytes last."""
        self.created = True
        image = layout.image()
        self.file.truncate(0)
        about = {"layout": digest([image]), "token": os.urandom(8).hex()}
        note = entry_of(NOTE, json.dumps(about).encode())
        write(self.file, len(SIGNATURE), image[len(SIGNATURE) :] + note)
        write(self.file, 0, SIGNATURE)

    def _resume(self, layout: FileLayout, strict: bool) -> None:
        """Continue a partial file of the same scene with its intact chunks. Raises
        UsageError, OutputError, OSError.
        """
        from .reader import SpectraFile

        with SpectraFile(self.part, any_kind=True) as before:
            self._require_same(before, layout)
            machines = together([before.machines, self.machines])
            if strict and unlike(machines):
                raise UsageError(
                    f"{self.part}: was begun on a machine that computes differently"
                    f" ({unlike(machines)}); it is kept"
                )
            self.machines = machines
            # a damaged chunk is computed again
            done = map(int, np.flatnonzero(before.done))
            intact = [i for i in done if before.intact(i)]
            self.resumed = {i: before.outcomes(i) for i in intact}
            for i in intact:
                self._count(before.packed(i))
        self.done[intact] = True
        self.file.truncate(self.log.end)

    def _require_same(self, before: "SpectraFile", layout: FileLayout) -> None:
        """Raise UsageError if the partial file holds another scene or shard."""
        differs = first_difference(before.scene, dict(layout.scene))
        if differs is not None:
            place, there, here = differs
            raise UsageError(
                f"{self.part}: belongs to another scene: its {place} is {there},"
                f" that of this run {here}; `overwrite` begins anew"
            )
        shard = before.attributes.get("shard")
        if shard != layout.attributes.get("shard"):
            raise UsageError(
                f"{self.part}: is of shard {shard}, this call computes"
                f" {layout.attributes.get('shard')}; give another output"
            )

    def found(self, unit: Unit) -> np.ndarray | None:
        """Return the counts of outcomes in the resumed chunks of a unit; None unless
        all chunks of the unit are there.
        """
        chunks = {
            self.chunk_grid.index((i, unit.row, unit.column)) for i in unit.places
        }
        if not chunks <= self.resumed.keys():
            return None
        return np.sum([self.resumed[i] for i in chunks], axis=0)

    def keep(self, unit: Unit, data: Sequence[Packed]) -> None:
        """Write the packed chunks of a unit, one for each of its places. Raises
        OutputError.
        """
        for i, packed in zip(unit.places, data, strict=True):
            self.write((i, unit.row, unit.column), packed)

    def write(self, offset: tuple[int, ...], packed: Packed) -> None:
        """Write the packed chunk whose first cell is (place, row, column). Raises
        OutputError.
        """
        index = self.chunk_grid.index(offset)
        try:
            self.log.append(index, joined(packed))
        except OSError as error:
            kept = (
                "; the finished chunks are kept there for `resume`"
                if self.done.any()
                else ""
            )
            raise OutputError(
                f"{self.part}: cannot be written: {error.strerror or error}{kept}"
            ) from None
        self.done[index] = True
        self._count(packed)

    def _count(self, packed: Packed) -> None:
        """Add the conditions of a chunk to those of all."""
        raw = packed[CONDITIONS]
        self.conditions = (
            self.conditions + Conditions.unpacked(raw)
            if raw and self.conditions is not None
            else None
        )

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Write the finished file from the partial file with the closing attributes,
        and remove the partial file. Raises OutputError.
        """
        if self.whole and not self.done.all():
            raise OutputError(
                f"{self.part}: {int((~self.done).sum())} of {self.done.size} chunks are"
                " missing; it is kept for `resume`"
            )
        # the same name in a resumed sweep
        token = self.log.notes["token"]
        unfinished = self.output.with_name(f"{self.output.name}.{token}.part")
        closing = {**attributes, "computed_on": json.dumps(self.machines)}
        try:
            with published(self.output, self.overwrite, unfinished) as file:
                self._copy_into(file, closing)
        except OutputError as error:
            kept = f"; the result is kept as {self.part}" if self.done.any() else ""
            raise OutputError(f"{error}{kept}") from None
        self._remove()

    def _copy_into(self, file: BinaryIO, attributes: Mapping[str, Any]) -> None:
        """Write the HDF5 file: the layout, the finished chunks, and the digest at its
        end. Raises OutputError, OSError.
        """
        target = _Target(file)
        file.write(self.log.image)
        try:
            with h5py.File(target, "r+") as h5:
                self._fill(h5, target)
                for key, value in attributes.items():
                    h5.attrs[key] = value
            target.check()
            with h5py.File(target, "r") as h5:
                places = self._places(h5)
        except (ValueError, RuntimeError, LookupError) as error:
            target.check()
            raise OutputError(
                f"{self.part}: cannot be finished: {reason(error)}"
            ) from None
        line = digest_line(file, places)
        file.seek(0, os.SEEK_END)
        file.write(line)

    def _fill(self, h5: h5py.File, target: "_Target") -> None:
        """Write the finished chunks and what is noted of each."""
        tables = h5[BOOKKEEPING]
        sums = tables["chunk_checksum"][...]
        for index in map(int, np.flatnonzero(self.done)):
            packed = split(self.log.content(index), self.names)
            offset = self.chunk_grid.offset(index)
            for name in self.names:
                h5[name].id.write_direct_chunk(offset, packed[name], 0)
            sums[index] = checksum(packed)
            tables[CONDITIONS][index] = np.frombuffer(packed[CONDITIONS], np.uint8)
            target.check()
        tables["chunk_done"][...] = self.done
        tables["chunk_checksum"][...] = sums

    def _places(self, h5: h5py.File) -> list[tuple[int, int]]:
        """Return (first byte, number of bytes) of every chunk. Raises ValueError if one
        is missing.
        """
        places: list[tuple[int, int]] = []
        for name in self.names:
            h5[name].id.chunk_iter(
                lambda info: places.append((info.byte_offset, info.size))
            )
        if len(places) != self.done.sum() * len(self.names):
            raise ValueError("chunks that were written are missing")
        return places

    def discard(self) -> None:
        """Remove the partial file if this process has begun it."""
        if self.created:
            self._remove()

    def _remove(self) -> None:
        """Remove the partial file if it is still there."""
        if not self.file.closed and is_there(self.file, self.part):
            try:
                self.part.unlink()
            except PermissionError:  # a system that removes no open file
                self.file.close()
                self.part.unlink()

    def __enter__(self) -> "SpectraWriter":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is not None and not self.done.any():
            self.discard()  # there is nothing in it to keep
        self.file.close()


class _Target:
    """An open file for HDF5. After a fault it ignores writes and reports success, so
    that HDF5 can close its file; see `check`.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file, self._fault = file, cast(OSError | None, None)

    def check(self) -> None:
        """Raise the OSError of the first fault, if any."""
        if self._fault is not None:
            raise self._fault

    def __getattr__(self, name: str) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            try:
                return (
                    getattr(self._file, name)(*arguments) if self._fault is None else 0
                )
            except OSError as error:
                self._fault = error
                return 0

        return call
