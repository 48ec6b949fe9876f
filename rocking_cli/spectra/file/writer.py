"""The one writer of a spectra file: it appends chunks to the partial file, and writes the HDF5 file from it when all are there."""

from __future__ import annotations

import io
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
from ..dimensions import Frame
from ..work.machine import machine, together, unlike
from .chunks import ChunkGrid, checksum, chunk_places, joined, split, stored_outcomes
from .difference import brief, difference, reason
from .digest import digest_line
from .layout import BOOKKEEPING, image
from .partial import Partial

WHOLE = "1/1"


class SpectraWriter:
    """The one writer of a spectra file; a context manager that closes the partial file whatever happens.

    names: of the variables; shard: "i/n", the part of the chunks that is written, or None where any may be missing; strict: refuse
    a partial file that was begun on a machine which computes otherwise; machines: those whose chunks are written, this one unless
    given. Raises UsageError for an output that is refused, OutputError when the file is in use or cannot be written.
    """

    def __init__(
        self,
        path: Path,
        frame: Frame,
        chunk: tuple[int, ...],
        *,
        names: Sequence[str],
        overwrite: bool,
        resume: bool,
        scene: Mapping[str, Any],
        attributes: Mapping[str, Any],
        shard: str | None = WHOLE,
        strict: bool = False,
        machines: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        self.path, self.names, self.whole, self.overwrite = path, list(names), shard == WHOLE, overwrite
        self.cut = ChunkGrid(frame.shape, (1, *chunk))
        self.chunks = self.cut.size
        self.written = self.resumed = 0
        self.kept = False
        self.outcomes: dict[int, np.ndarray] = {}  # of the chunks that were there before
        self.done = np.zeros(self.chunks, dtype=bool)
        self.machines = together([machines or [machine()]])
        fresh = image(frame, chunk, names, scene, {**attributes, **({} if shard is None else {"shard": shard})})
        self._partial = Partial(path, fresh, overwrite=overwrite, resume=resume)
        self.part = self._partial.path
        try:
            if self._partial.resumes:
                self._resume(scene, shard, strict)
            self._partial.note(computed_on=self.machines)
        except BaseException as error:
            self._partial.discard()
            self._partial.close()
            if isinstance(error, OSError):
                raise OutputError(f"{self.part}: cannot be written: {error.strerror}") from None
            raise

    @property
    def elsewhere(self) -> str:
        """How the machines differ on which this file was computed; empty where they compute alike."""
        return unlike(self.machines)

    def _resume(self, scene: Mapping[str, Any], shard: str | None, strict: bool) -> None:
        """Go on with a partial file: the same scene, and every chunk whose record is whole. Raises UsageError, OutputError, OSError."""
        records = self._partial.records
        with h5py.File(io.BytesIO(records.image), "r") as file:
            begun, before = json.loads(file.attrs["scene"]), file.attrs.get("shard")
        if (found := difference(begun, dict(scene))) is not None:
            place, there, here = found
            raise UsageError(
                f"{self.part}: is of another scene: its {place} is {brief(there)}, this one's {brief(here)}; `overwrite` begins anew"
            )
        if before != shard:
            raise UsageError(f"{self.part}: is of shard {before}, this call computes {shard}; give another output")
        machines = together([records.notes.get("computed_on", []), self.machines])
        if strict and unlike(machines):
            raise UsageError(f"{self.part}: was begun on a machine that computes otherwise ({unlike(machines)}); it is kept")
        self.machines = machines
        for index in sorted(i for i in records.places if 0 <= i < self.chunks):
            try:
                self.outcomes[index] = stored_outcomes(split(records.content(index), self.names), self.cut, index)
                self.done[index] = True
            except ValueError:
                continue  # a damaged chunk is computed again
        self._partial.file.truncate(records.end)
        self.resumed = int(self.done.sum())

    def has(self, places: Sequence[int], row: int, column: int) -> bool:
        """Whether the chunks at these places of the first dimension whose first cell is (row, column) are all there; if not, none
        counts."""
        indices = [self.cut.index((i, row, column)) for i in places]
        if all(self.done[indices]):
            return True
        for index in indices:
            self.outcomes.pop(index, None)
        return False

    def write(self, offset: tuple[int, ...], packed: Mapping[str, bytes]) -> None:
        """Write the packed chunk whose first cell is (place, row, column). Raises OutputError."""
        index = self.cut.index(offset)
        try:
            self._partial.append(index, joined(packed, self.names))
        except OSError as error:
            kept = "; what was done is kept there for `resume`" if self.written or self.resumed else ""
            raise OutputError(f"{self.part}: cannot be written: {error.strerror}{kept}") from None
        self.done[index] = True
        self.written += 1

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Write the finished file from the partial file, with the closing attributes, and remove the latter. Raises OutputError."""
        self.kept = True
        if self.whole and not self.done.all():
            raise OutputError(f"{self.part}: {int((~self.done).sum())} of {self.done.size} chunks are missing; it is kept for `resume`")
        settled = {**attributes, "computed_on": json.dumps(self.machines)}
        name = (
            f"{self._partial.output.name}.{self._partial.records.notes['token']}.part"  # which nobody else has, and a resumed sweep again
        )
        try:
            with published(self._partial.output, self.overwrite, self._partial.output.with_name(name)) as file:
                self._copy_into(file, settled)
        except OutputError as error:
            raise OutputError(f"{error}; the result is kept as {self.part}") from None
        self._partial.remove()

    def _copy_into(self, file: BinaryIO, attributes: Mapping[str, Any]) -> None:
        """Write the HDF5 file: the layout, the chunks that are done, and the digest behind it. Raises OutputError, OSError."""
        records, target = self._partial.records, _Target(file)
        file.write(records.image)
        try:
            with h5py.File(target, "r+") as h5:
                sums = h5[BOOKKEEPING]["chunk_checksum"][...]
                for index in map(int, np.flatnonzero(self.done)):
                    packed = split(records.content(index), self.names)
                    for name in self.names:
                        h5[name].id.write_direct_chunk(self.cut.offset(index), packed[name], 0)
                    sums[index] = checksum(packed, self.names)
                    target.check()
                h5[BOOKKEEPING]["chunk_done"][...] = self.done
                h5[BOOKKEEPING]["chunk_checksum"][...] = sums
                for key, value in attributes.items():
                    h5.attrs[key] = value
            target.check()
            with h5py.File(target, "r") as h5:
                places = chunk_places(h5, self.names)
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
        self._partial.close()


class _Target:
    """An open file as HDF5 writes it. After a fault nothing more is done and HDF5 is told of none, so that it can close its file."""

    def __init__(self, file: BinaryIO) -> None:
        self._file, self._fault = file, cast(OSError | None, None)

    def check(self) -> None:
        """Raise the OSError that has come up."""
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
