"""Spectra on disk: HDF5 with named dimensions, coordinates and units, that netCDF readers open as it is.

A sweep writes to `OUT.h5.part`: a chunk's data and checksum, flush, its done flag, flush; the file takes its final name when
complete, so that nothing half-written ever stands under it, and a sweep that was stopped goes on from there. One writer.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

import h5py
import numpy as np

from ..errors import FAULTS, OutputError, UsageError
from .chunks import ChunkGrid, checksum, stored_chunk, stored_outcomes
from .contents import Contents, chunk_places, contents_of, reason
from .frame import Frame
from .layout import image
from .machine import machine, machines_of, together, unlike
from .part import Part
from .raw_file import RawFile
from .seal import seal
from .trial import trial

SLACK = 1 << 16  # bytes beside its chunks that HDF5 may take for one write, at most: nodes of its index, blocks of headers
WHOLE = "1/1"


def difference(one: Any, other: Any, place: str = "") -> tuple[str, Any, Any] | None:
    """Where two scenes first differ, and what each has there. A list that begins with a name differs by that name."""
    if one == other:
        return None
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        key = next(k for k in [*one, *other] if k not in one or k not in other or one[k] != other[k])
        place = f"{place}.{key}" if place else key
        return difference(one[key], other[key], place) if key in one and key in other else (place, one.get(key), other.get(key))
    if isinstance(one, list) and isinstance(other, list) and any(isinstance(x, list | Mapping) for x in [*one, *other]):
        if len(one) != len(other):
            return f"number of {place}", len(one), len(other)
        i = next(i for i, (a, b) in enumerate(zip(one, other, strict=True)) if a != b)
        return difference(one[i], other[i], place if isinstance(one[i], str) else f"{place}[{i}]")
    return place, one, other


def brief(value: Any) -> str:
    """A value of a scene in at most 60 characters."""
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."


class SpectraWriter:
    """The one writer of a spectra file; a context manager that closes it whatever happens.

    names: of the variables; shard: "i/n", the part of the chunks that is written, or None where any may be missing; strict: refuse
    a part that was begun on a machine which computes otherwise; machines: those whose chunks are written, this one unless given.
    Raises UsageError for an output that is refused, OutputError when the file is in use or cannot be written.
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
        self.path, self.names, self.whole = path, list(names), shard == WHOLE
        self.cut = ChunkGrid(frame.shape, (1, *chunk))
        self.chunks = self.cut.size
        self.written = self.resumed = 0
        self.kept = False
        self.outcomes: dict[int, np.ndarray] = {}  # of the chunks that were there before
        self.done = np.zeros(self.chunks, dtype=bool)
        self.machines = together([machines or [machine()]])
        settled = {**attributes, "computed_on": json.dumps(self.machines), **({} if shard is None else {"shard": shard})}
        fresh = image(frame, chunk, names, scene, settled)
        self._part = Part(path, fresh, overwrite=overwrite, resume=resume)
        self.part = self._part.part
        try:
            if self._part.resumes:
                self._resume(scene, shard, strict)
            else:
                self.raw = RawFile(self._part.descriptor)
                self.file = h5py.File(self.raw, "r+")
        except BaseException as error:
            self._part.discard()
            self._part.close()
            if isinstance(error, OSError):
                raise OutputError(f"{self.part}: cannot be written: {_reason(error)}") from None
            raise

    @property
    def elsewhere(self) -> str:
        """How the machines differ on which this file was computed; empty where they compute alike."""
        return unlike(self.machines)

    def _resume(self, scene: Mapping[str, Any], shard: str | None, strict: bool) -> None:
        """Go on with a part: the same scene, and every chunk that is marked done whole."""
        try:
            trial(self.part)
            self.raw = RawFile(self._part.descriptor)
            self.file = h5py.File(self.raw, "r+")
            contents = contents_of(self.file, self.raw.end)
        except (*FAULTS, UsageError) as error:
            raise OutputError(
                f"{self.part}: is not a sweep that can go on ({reason(error)}); it is kept, `overwrite` begins anew"
            ) from None
        try:
            self._demand_same(contents, scene, shard, strict)
            sums = contents.sums
            for index in np.flatnonzero(contents.done):
                with suppress(*FAULTS):  # a damaged chunk is computed again
                    packed = stored_chunk(self.file, self.names, self.cut.offset(int(index)), int(sums[index]))
                    self.outcomes[int(index)] = stored_outcomes(packed, self.cut, int(index))
                    self.done[index] = True
            self.raw.reserve(SLACK + len(json.dumps(self.machines)))
            self.file["chunk_done"][...] = self.done.astype("u1")
            self.file.attrs["computed_on"] = json.dumps(self.machines)
            self.file.flush()
        except BaseException:
            self._abandon()
            raise
        self.resumed = int(self.done.sum())

    def _demand_same(self, contents: Contents, scene: Mapping[str, Any], shard: str | None, strict: bool) -> None:
        """Refuse a part of another scene, shard or, if strict, machine. Raises UsageError."""
        found = difference(contents.scene, dict(scene))
        if found is not None:
            place, there, here = found
            raise UsageError(
                f"{self.part}: is of another scene: its {place} is {brief(there)}, this one's {brief(here)}; `overwrite` begins anew"
            )
        before = contents.attributes.get("shard")
        if before != shard:
            raise UsageError(f"{self.part}: is of shard {before}, this call computes {shard}; give another output")
        machines = together([machines_of(contents.attributes.get("computed_on")), self.machines])
        if strict and unlike(machines):
            raise UsageError(f"{self.part}: was begun on a machine that computes otherwise ({unlike(machines)}); it is kept")
        self.machines = machines

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
        """Write the packed chunk whose first cell is (place, row, column), and mark it done."""
        index = self.cut.index(offset)
        try:
            self.raw.reserve(SLACK + sum(len(packed[name]) for name in self.names))
            for name in self.names:
                self.file[name].id.write_direct_chunk(offset, packed[name], 0)
            self.file["chunk_checksum"][index] = checksum(packed, self.names)
            self.file.flush()
            self.file["chunk_done"][index] = 1
            self.file.flush()
        except (OSError, RuntimeError) as error:
            self._abandon()
            kept = "; what was done is kept there for `resume`" if self.written or self.resumed else ""
            raise OutputError(f"{self.part}: cannot be written: {_reason(error)}{kept}") from None
        self.done[index] = True
        self.written += 1

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Add the closing attributes, verify the file, seal it, make it durable and give it its final name."""
        self.kept = True
        if self.whole and not self.done.all():
            raise OutputError(f"{self.part}: {int((~self.done).sum())} of {self.done.size} chunks are missing; it is kept for `resume`")
        try:
            self.raw.reserve(SLACK + len(json.dumps(self.machines)))
            for key, value in {**attributes, "computed_on": json.dumps(self.machines)}.items():
                self.file.attrs[key] = value
            self.file.close()
            self.raw.trim()
            self._seal()
        except (OSError, RuntimeError) as error:
            self._abandon()
            raise OutputError(f"{self.path}: cannot be written: {_reason(error)}; the result is kept as {self.part}") from None
        self._part.publish()

    def _seal(self) -> None:
        """Read the finished file as a reader would, and set the seal behind it. Raises OutputError, OSError."""
        raw = RawFile(self._part.descriptor)
        size = raw.end
        try:
            with h5py.File(raw, "r") as file:
                contents = contents_of(file, size)
                end = seal(raw.descriptor, chunk_places(file, contents, size))
            if not np.array_equal(contents.done, self.done):
                raise ValueError("chunks that were written are missing")
        except (ValueError, LookupError, TypeError, UsageError) as error:
            raise OutputError(f"{self.part}: is not what was written ({reason(error)}); it is kept as it is") from None
        raw.reserve(len(end))
        raw.seek(size)
        raw.write(end)

    def discard(self) -> None:
        """Remove the part, if this process made it."""
        self._abandon()
        self._part.discard()

    def _abandon(self) -> None:
        """Close the file as it is on the disk; HDF5 would go on trying to write what it has in memory."""
        self.raw.abandoned = True
        with suppress(OSError, RuntimeError):
            self.file.close()
            self.raw.trim()

    def __enter__(self) -> SpectraWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        try:
            if self.file.id.valid:
                self.file.close()
                self.raw.trim()
        except (OSError, RuntimeError):  # on a full disk; the error that is on its way says so
            self._abandon()
            if error is None:
                raise
        finally:
            if error is not None and not (self.written or self.resumed or self.kept):
                self._part.discard()  # there is nothing in it to keep
            self._part.close()


def _reason(error: Exception) -> str:
    """The system's own words, where the error has them."""
    return str(getattr(error, "strerror", None) or error)
