"""The parts of a sweep that was computed in shards, put together: bytes are copied, nothing is computed."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...dynamics.outcome import Outcome
from ...errors import OutputError, UsageError
from ..variables import VARIABLES
from ..work.machine import machines_of, together, unlike
from .chunks import stored_outcomes, unpack
from .difference import brief, difference
from .reader import SpectraFile
from .writer import SpectraWriter

KEPT = ("history", "documents", "motion", "model", "tolerance")


@dataclass(frozen=True)
class Merged:
    """The result of a merge: chunks there, chunks of the whole, how the machines differ that computed them, and the shards ("2/8") that
    were not given or are not complete."""

    there: int
    whole: int
    elsewhere: str
    missing: tuple[str, ...] = ()


def merge(paths: Sequence[str | Path], output: str | Path, *, overwrite: bool = False, strict: bool = False) -> Merged:
    """Write the spectrum that these shards hold together; strict: refuse machines that compute otherwise.

    Raises UsageError when they are not of one scene, OutputError when one is damaged, two hold different data for the same
    cells, or the output cannot be written.

    >>> grid = parse_grid('A=1:8:50,Omega=1:8:40')
    >>> for i in (1, 2):
    ...     _ = write_spectrum([dimensionless_oscillator(0.9)], sine(), grid, f'{i}.h5', workers=1, chunk_cells=500, shard=(i, 2))
    >>> merge(['1.h5', '2.h5'], 'whole.h5').whole
    4
    """
    with ExitStack() as stack:
        files = [stack.enter_context(SpectraFile(path)) for path in paths]
        first = files[0]
        _demand_one_scene(files)
        machines = together([machines_of(f.attributes.get("computed_on")) for f in files])
        if strict and unlike(machines):
            raise UsageError(f"{output}: its shards come from machines that compute otherwise ({unlike(machines)})")
        kept = {key: value for key, value in first.attributes.items() if key in KEPT}
        options: dict[str, Any] = {"names": first.names, "scene": first.scene, "attributes": kept, "shard": None, "machines": machines}
        chunk, target = first.cut.chunk[1:], Path(output)
        writer = stack.enter_context(SpectraWriter(target, first.frame, chunk, overwrite=overwrite, resume=False, **options))
        try:
            outcomes = np.zeros(len(Outcome), dtype=np.int64)
            for index in range(writer.chunks):
                holders = [f for f in files if f.done[index]]
                if holders:
                    packed = _agreed(holders, index)
                    outcomes += stored_outcomes(packed, first.cut, index)
                    writer.write(first.cut.offset(index), packed)
        except BaseException:
            writer.discard()  # it can be made again from the shards
            raise
        counts = {f"cells_{o.flag}": int(outcomes[o]) for o in Outcome}
        cells = int(np.prod(first.cut.shape))
        counts["cells_not_computed"] = cells - int(outcomes.sum())
        run_time, checked, error = ([f.attributes.get(key, 0) for f in files] for key in ("run_time", "checked_cells", "estimated_error"))
        totals = {"run_time": sum(run_time), "checked_cells": sum(checked), "estimated_error": max(error)}
        writer.finish({"cells": cells, **totals, **counts})
        return Merged(writer.written, writer.chunks, writer.elsewhere, _missing_shards(files, writer.chunks))


def _missing_shards(files: Sequence[SpectraFile], chunks: int) -> tuple[str, ...]:
    """The shards that hold fewer of the chunks than their part; none if the files are parts of different numbers."""
    there: dict[int, int] = {}
    counts = set()
    for file in files:
        part, _, of = str(file.attributes.get("shard", "")).partition("/")
        if not (part.isdecimal() and of.isdecimal()):
            return ()
        counts.add(int(of))
        there[int(part)] = max(there.get(int(part), 0), int(np.count_nonzero(file.done)))
    if len(counts) != 1:
        return ()
    (count,) = counts
    return tuple(f"{i}/{count}" for i in range(1, min(count, chunks) + 1) if there.get(i, 0) < len(range(i - 1, chunks, count)))


def _demand_one_scene(files: Sequence[SpectraFile]) -> None:
    first = files[0]
    for other in files[1:]:
        found = difference(first.scene, other.scene)
        if found is not None:
            place, one, another = found
            raise UsageError(
                f"{other.path}: is of another scene than {first.path}: its {place} differs: {brief(another)}, there {brief(one)}"
            )


def _agreed(holders: Sequence[SpectraFile], index: int) -> dict[str, bytes]:
    """The bytes of a chunk from the first file where it is intact; those of the others must say the same. Raises OutputError."""
    intact = [f for f in holders if f.intact(index)]
    if not intact:
        return holders[0].packed(index)
    first = intact[0]
    packed = first.packed(index)
    for other in intact[1:]:
        theirs = other.packed(index)
        for name in first.names:
            kind = (VARIABLES[name].dtype, first.cut.chunk)
            if packed[name] != theirs[name] and unpack(packed[name], *kind).tobytes() != unpack(theirs[name], *kind).tobytes():
                raise OutputError(f"{other.path} and {first.path} disagree: chunk {index} of {name} differs; one of them is wrong")
    return packed
