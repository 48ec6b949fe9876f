"""Merges the shards of a sweep into one file; it copies bytes and computes no cell."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...dynamics.equations.linear import SERIES
from ...dynamics.outcome import Outcome
from ...errors import OutputError, UsageError
from ..dimensions import VARIABLES
from ..work.machine import together, unlike
from .layout import FileLayout, Packed, unpack
from .reader import SpectraFile
from .same_scene import first_difference
from .writer import SpectraWriter


@dataclass(frozen=True)
class Merged:
    """What `merge` did.

    Attributes
    ----------
    chunks: number of merged chunks
    all_chunks: number of chunks of the sweep
    machine_differences: between the machines that computed them
    missing: shards ("2/8") that are missing or not complete

    Examples
    --------
    >>> Merged(chunks=4, all_chunks=4, machine_differences="").missing
    ()
    """

    chunks: int  # number of merged chunks
    all_chunks: int  # number of chunks of the sweep
    machine_differences: str  # between the machines that computed them
    missing: tuple[str, ...] = ()  # shards ("2/8") that are missing or not complete


def merge(
    paths: Sequence[str | Path],
    output: str | Path,
    *,
    overwrite: bool = False,
    strict: bool = False,
) -> Merged:
    """Write one spectra file from the shards of a sweep.

    Parameters
    ----------
    paths
        files of `write_spectrum(..., shard=(i, n))`, finished or partial
    output
        the file to write
    overwrite
        True: replace an existing output
    strict
        True: refuse shards of machines that compute differently in the last digits

    Returns
    -------
    Merged
        with the shards that are missing

    Raises
    ------
    UsageError
        when the shards are not of one scene, or the output exists
    OutputError
        when one is damaged, two hold different data for the same cells, or the output
        cannot be written

    Examples
    --------
    >>> grid = parse_grid("A=1:8:50,Omega=1:8:40")
    >>> for i in (1, 2):
    ...     _ = write_spectrum(
    ...         [dimensionless_oscillator(eta=0.9)], sine(), grid, f"{i}.h5",
    ...         workers=1, chunk_cells=500, shard=(i, 2),
    ...     )
    >>> merge(["1.h5", "2.h5"], "whole.h5").all_chunks
    4
    """
    with ExitStack() as stack:
        files = [
            stack.enter_context(SpectraFile(path, any_kind=True)) for path in paths
        ]
        _require_one_scene(files)
        machines = together([file.machines for file in files])
        if strict and unlike(machines):
            raise UsageError(
                f"{output}: its shards come from machines that compute differently"
                f" ({unlike(machines)})"
            )
        writer = stack.enter_context(
            SpectraWriter(
                Path(output), _layout(files[0]), overwrite=overwrite, machines=machines
            )
        )
        try:
            outcomes = _copied(files, writer)
        except BaseException:
            writer.discard()  # it can be written again from the shards
            raise
        bounds = {}
        if writer.conditions is not None:
            tolerance = files[0].attributes.get("tolerance", SERIES)
            bounds = writer.conditions.bounds(tolerance)
        writer.finish(_totals(files, outcomes) | bounds)
        return Merged(
            int(writer.done.sum()),
            writer.chunk_grid.size,
            writer.machine_differences,
            _missing_shards(files),
        )


def _require_one_scene(files: Sequence[SpectraFile]) -> None:
    """Raise UsageError if a file holds another scene than the first one."""
    first = files[0]
    for other in files[1:]:
        differs = first_difference(first.scene, other.scene)
        if differs is not None:
            place, here, there = differs
            raise UsageError(
                f"{other.path}: belongs to another scene than {first.path}: its"
                f" {place} differs: {there}, there {here}"
            )


def _layout(first: SpectraFile) -> FileLayout:
    """Return the layout of the whole file; it is of no shard."""
    kept = {
        key: first.attributes[key]
        for key in ("title", "history", "documents", "motion", "model", "tolerance")
        if key in first.attributes
    }
    chunk = first.chunk_grid.chunk[1:]
    return FileLayout(first.frame, chunk, first.names, first.scene, kept)


def _copied(files: Sequence[SpectraFile], writer: SpectraWriter) -> np.ndarray:
    """Copy each chunk that a shard holds; return the number of cells by outcome."""
    grid = files[0].chunk_grid
    outcomes = np.zeros(len(Outcome), dtype=np.int64)
    for index in range(writer.chunk_grid.size):
        holders = [file for file in files if file.done[index]]
        if holders:
            holder, packed = _agreed(holders, index)
            outcomes += holder.outcomes(index)
            writer.write(grid.offset(index), packed)
    outcomes[Outcome.NOT_COMPUTED] = np.prod(grid.shape) - outcomes.sum()
    return outcomes


def _totals(files: Sequence[SpectraFile], outcomes: np.ndarray) -> dict[str, Any]:
    """Return the closing attributes of the whole file from those of the shards."""
    run_time, check_time, checked, difference = (
        [file.attributes.get(key, 0) for file in files]
        for key in (
            "run_time",
            "check_time",
            "checked_cells",
            "largest_difference",
        )
    )
    checks = {
        "check_time": sum(check_time),
        "checked_cells": sum(checked),
        "largest_difference": max(difference),
    }
    return {
        "cells": int(outcomes.sum()),
        "run_time": sum(run_time),
        **({} if files[0].frame.of_verdicts else checks),
        **{f"cells_{o.flag}": int(outcomes[o]) for o in Outcome},
    }


def _missing_shards(files: Sequence[SpectraFile]) -> tuple[str, ...]:
    """Return the shards that lack some of their chunks, such as "2/8"; none if the
    files belong to different N.
    """
    shards = [
        str(file.attributes.get("shard", "")).partition("/")[::2] for file in files
    ]
    if len({of for _, of in shards}) != 1 or not all(
        part.isdecimal() and of.isdecimal() for part, of in shards
    ):
        return ()
    count, chunks = int(shards[0][1]), files[0].chunk_grid.size
    there = dict.fromkeys(range(1, min(count, chunks) + 1), 0)
    for file, (part, _) in zip(files, shards, strict=True):
        there[int(part)] = max(there.get(int(part), 0), int(file.done.sum()))
    return tuple(
        f"{i}/{count}"
        for i, done in there.items()
        if done < len(range(i - 1, chunks, count))
    )


def _agreed(holders: Sequence[SpectraFile], index: int) -> tuple[SpectraFile, Packed]:
    """Return (the first file in which a chunk is intact, its bytes). Raises OutputError
    if another file has different bytes.
    """
    intact = [f for f in holders if f.intact(index)]
    first = intact[0] if intact else holders[0]
    packed = first.packed(index)
    for other in intact[1:]:
        theirs = other.packed(index)
        for name in first.names:
            kind = (VARIABLES[name].dtype, first.chunk_grid.chunk)
            if (
                packed[name] != theirs[name]
                and unpack(packed[name], *kind).tobytes()
                != unpack(theirs[name], *kind).tobytes()
            ):
                raise OutputError(
                    f"{other.path} and {first.path} disagree: chunk {index} of {name}"
                    " differs; one of them is wrong"
                )
    return first, packed
