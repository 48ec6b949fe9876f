"""The writer of a spectra file: it appends chunks to the partial file, and at the end writes the HDF5 file from it."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, cast

import h5py
import numpy as np

from ...errors import OutputError, UsageError
from ...publishing import published
from ..work.machine import machine, together, unlike
from .chunks import Packed, checksum, joined, split
from .difference import difference, reason
from .digest import digest_line
from .layout import BOOKKEEPING, Layout
from .partial import Partial


class SpectraWriter:
    """The one writer of a spectra file; a context manager that closes the partial file whatever happens.

    strict: refuse a partial file that was begun on a machine that computes differently; machines: those whose chunks are written, this
    one unless given. done: the finished chunks; resumed: those of an earlier run, with their counts of outcomes. Raises UsageError for an
    output that is refused, OutputError when the file is in use or cannot be written.
    """

    def __init__(
        self,
        path: Path,
        layout: Layout,
        *,
        overwrite: bool = False,
        resume: bool = False,
        strict: bool = False,
        machines: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        self.names, self.cut, self.overwrite = layout.names, layout.cut, overwrite
        self.whole = layout.attributes.get("shard") == "1/1"
        self.written = self.resumed = 0
        self.kept = False
        self.outcomes: dict[int, np.ndarray] = {}
        self.done = np.zeros(self.cut.size, dtype=bool)
        self.machines = together([machines or [machine()]])
        self._partial = Partial(path, layout.image(), overwrite=overwrite, resume=resume)
        self.part = self._partial.path
        try:
            if self._partial.resumes:
                self._resume(layout, strict)
            self._partial.log.note(computed_on=self.machines)
        except BaseException as error:
            self._partial.discard()
            self._partial.file.close()
            if isinstance(error, OSError):
                raise OutputError(f"{self.part}: cannot be written: {error.strerror}") from None
            raise

    @property
    def elsewhere(self) -> str:
        """The differences of the machines on which this file was computed; empty where they compute alike."""
        return unlike(self.machines)

    def _resume(self, layout: Layout, strict: bool) -> None:
        """Continue a partial file of the same scene with its intact chunks. Raises UsageError, OutputError, OSError."""
        from .reader import SpectraFile

        with SpectraFile(self.part) as before:
            if (found := difference(before.scene, dict(layout.scene))) is not None:
                place, there, here = found
                raise UsageError(f"{self.part}: is of another scene: its {place} is {there}, this one's {here}; `overwrite` begins anew")
            shards = [attributes.get("shard") for attributes in (before.attributes, layout.attributes)]
            if shards[0] != shards[1]:
                raise UsageError(f"{self.part}: is of shard {shards[0]}, this call computes {shards[1]}; give another output")
            machines = together([before.machines, self.machines])
            if strict and unlike(machines):
                raise UsageError(f"{self.part}: was begun on a machine that computes differently ({unlike(machines)}); it is kept")
            self.machines = machines
            intact = [int(i) for i in np.flatnonzero(before.done) if before.intact(int(i))]  # a damaged chunk is computed again
            self.outcomes = {i: before.outcomes(i) for i in intact}
        self.done[intact] = True
        self._partial.file.truncate(self._partial.log.end)
        self.resumed = len(intact)

    def has(self, places: Sequence[int], row: int, column: int) -> bool:
        """True if all chunks with the first cell (row, column) at these places of the first dimension are finished; otherwise none of them
        counts as finished."""
        indices = [self.cut.index((i, row, column)) for i in places]
        if all(self.done[indices]):
            return True
        for index in indices:
            self.outcomes.pop(index, None)
        return False

    def write(self, offset: tuple[int, ...], packed: Packed) -> None:
        """Write the packed chunk whose first cell is (place, row, column). Raises OutputError."""
        index = self.cut.index(offset)
        try:
            self._partial.log.append(index, joined(packed))
        except OSError as error:
            kept = "; the finished chunks are kept there for `resume`" if self.written or self.resumed else ""
            raise OutputError(f"{self.part}: cannot be written: {error.strerror}{kept}") from None
        self.done[index] = True
        self.written += 1

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Write the finished file from the partial file with the closing attributes, and remove the partial file. Raises OutputError."""
        self.kept = True
        if self.whole and not self.done.all():
            raise OutputError(f"{self.part}: {int((~self.done).sum())} of {self.done.size} chunks are missing; it is kept for `resume`")
        output = self._partial.output
        unfinished = output.with_name(f"{output.name}.{self._partial.log.notes['token']}.part")  # the same in a resumed sweep
        try:
            with published(output, self.overwrite, unfinished) as file:
                self._copy_into(file, {**attributes, "computed_on": json.dumps(self.machines)})
        except OutputError as error:
            raise OutputError(f"{error}; the result is kept as {self.part}") from None
        self._partial.remove()

    def _copy_into(self, file: BinaryIO, attributes: Mapping[str, Any]) -> None:
        """Write the HDF5 file: the layout, the chunks that are done, and the digest behind it. Raises OutputError, OSError."""
        log, target, places = self._partial.log, _Target(file), list[tuple[int, int]]()
        file.write(log.image)
        try:
            with h5py.File(target, "r+") as h5:
                tables = h5[BOOKKEEPING]
                sums = tables["chunk_checksum"][...]
                for index in map(int, np.flatnonzero(self.done)):
                    packed = split(log.content(index), self.names)
                    for name in self.names:
                        h5[name].id.write_direct_chunk(self.cut.offset(index), packed[name], 0)
                    sums[index] = checksum(packed)
                    target.check()
                tables["chunk_done"][...], tables["chunk_checksum"][...] = self.done, sums
                for key, value in attributes.items():
                    h5.attrs[key] = value
            target.check()
            with h5py.File(target, "r") as h5:
                for name in self.names:
                    h5[name].id.chunk_iter(lambda info: places.append((info.byte_offset, info.size)))
            if len(places) != self.done.sum() * len(self.names):
                raise ValueError("chunks that were written are missing")
        except (ValueError, RuntimeError, LookupError) as error:
            target.check()
            raise OutputError(f"{self.part}: cannot be finished: {reason(error)}") from None
        line = digest_line(file, places)
        file.seek(0, os.SEEK_END)
        file.write(line)

    def discard(self) -> None:
        """Remove the partial file, if this process made it."""
        self._partial.discard()

    def __enter__(self) -> SpectraWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if error is not None and not (self.written or self.resumed or self.kept):
            self._partial.discard()  # there is nothing in it to keep
        self._partial.file.close()


class _Target:
    """An open file for HDF5. After a fault it ignores writes and reports success, so that HDF5 can close its file; see `check`."""

    def __init__(self, file: BinaryIO) -> None:
        self._file, self._fault = file, cast(OSError | None, None)

    def check(self) -> None:
        """Raise the OSError of the first fault, if any."""
        if self._fault is not None:
            raise self._fault

    def __getattr__(self, name: str) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            try:
                return getattr(self._file, name)(*arguments) if self._fault is None else 0
            except OSError as error:
                self._fault = error
                return 0

        return call
