"""Sweeps: structures over a grid, cut into units of work, spread over processes, streamed to a file or into memory.

A unit is one chunk of the file. Its cells are computed by the same code in the same order wherever it runs, and units
are collected in their own order, so neither the number of workers nor the size of a unit changes a bit of the result.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..dynamics.engine import Response, Work, linear_response
from ..dynamics.outcome import Outcome
from ..dynamics.reference import reference_cell
from ..errors import Interrupted, OutputError, UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .grid import Grid

CHUNK_CELLS = 131072
SMALL_SWEEP = 100_000  # cells below which starting processes takes longer than they save
CHECKED_CELLS = 16
_SEED = 20120924

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Scene:
    """What a sweep computes: structures, grid, motion.

    Structures of equal restitution share one dimensionless spectrum, which is computed once (section 3.3 of the paper).
    Raises UsageError when a structure has no units but the grid does, or the scene holds no structure.
    """

    structures: tuple[RockingParameters, ...]
    grid: Grid
    motion: Motion

    def __post_init__(self) -> None:
        if not self.structures:
            raise UsageError("no structure: give a structure document, or a restitution for a dimensionless grid")
        for s in self.structures:
            if s.structure == "dimensionless" and not self.grid.dimensionless:
                raise UsageError("a restitution alone has no units: give a structure document, or axes A and Omega")

    @property
    def cells(self) -> int:
        """Cells of the result."""
        return len(self.structures) * self.grid.shape[0] * self.grid.shape[1]

    def sharing(self) -> list[tuple[int, ...]]:
        """Structures, by index, that share one computation."""
        if not self.grid.dimensionless:
            return [(i,) for i in range(len(self.structures))]
        groups: dict[float, list[int]] = {}
        for i, s in enumerate(self.structures):
            groups.setdefault(s.eta, []).append(i)
        return [tuple(g) for g in groups.values()]


@dataclass(frozen=True)
class Unit:
    """One unit of work: the structures it serves and its block of the grid."""

    structures: tuple[int, ...]
    row: int
    column: int


@dataclass(frozen=True)
class Summary:
    """What a sweep took and left out.

    run_time [s]; estimated_error: largest difference of theta/alpha from the reference on the checked cells; misjudged:
    checked cells whose outcome differs; shared_cells: cells taken from another structure of equal restitution.
    """

    structures: int
    cells: int
    run_time: float
    workers: int
    outcomes: dict[str, int]
    work: Work
    shared_cells: int
    checked_cells: int
    estimated_error: float
    misjudged: int

    @property
    def time_per_cell(self) -> float:
        """Run time over all cells [s]."""
        return self.run_time / self.cells

    @property
    def failed(self) -> int:
        """Cells that could not be decided."""
        return self.outcomes[Outcome.FAILED.flag]

    def record(self) -> dict[str, Any]:
        """As one flat record for JSON and for the file's attributes."""
        work = asdict(self.work)
        work.pop("cells")
        return {
            "structures": self.structures,
            "cells": self.cells,
            "run_time": self.run_time,
            "time_per_cell": self.time_per_cell,
            "workers": self.workers,
            "estimated_error": self.estimated_error,
            "checked_cells": self.checked_cells,
            "misjudged_cells": self.misjudged,
            **{f"cells_{k}": v for k, v in self.outcomes.items()},
            "shared_cells": self.shared_cells,
            **work,
        }


@dataclass(frozen=True, eq=False)
class Spectrum:
    """A spectrum in memory: theta_ratio, outcome and impacts have dimensions (structure, frequency, amplitude)."""

    scene: Scene
    theta_ratio: np.ndarray
    outcome: np.ndarray
    impacts: np.ndarray
    summary: Summary


def spectrum(
    structures: Sequence[RockingParameters], grid: Grid, motion: Motion, *, workers: int | None = None, check: int = CHECKED_CELLS
) -> Spectrum:
    """The rocking spectrum of structures over a grid, in memory.

    workers: processes, None for all cores; check: cells computed again by the reference. Raises UsageError.
    """
    scene = Scene(tuple(structures), grid, motion)
    shape = (len(scene.structures), *grid.shape)
    theta, outcome, impacts = np.full(shape, np.nan), np.zeros(shape, dtype=np.uint8), np.zeros(shape, dtype=np.int32)
    chunk = chunk_shape(grid.shape, CHUNK_CELLS)

    def keep(unit: Unit, response: Response) -> None:
        rows, columns = response.outcome.shape
        for i in unit.structures:
            block = (i, slice(unit.row, unit.row + rows), slice(unit.column, unit.column + columns))
            theta[block], outcome[block], impacts[block] = response.theta_ratio, response.outcome, response.impacts

    summary = _sweep(scene, chunk, workers, check, None, None, keep)
    return Spectrum(scene, theta, outcome, impacts, summary)


def write_spectrum(
    structures: Sequence[RockingParameters],
    grid: Grid,
    motion: Motion,
    path: str | Path,
    *,
    workers: int | None = None,
    chunk_cells: int = CHUNK_CELLS,
    check: int = CHECKED_CELLS,
    impacts: bool = False,
    overwrite: bool = False,
    documents: str = "",
    history: str = "",
    progress: Progress | None = None,
) -> Summary:
    """Compute a spectrum and stream it, chunk by chunk, into an HDF5 file (layout: README).

    documents, history: texts kept in the file. progress: called with (units done, units). Raises UsageError for a scene or
    an output that is refused, OutputError when the file cannot be written or a worker process dies, Interrupted on Ctrl-C.
    """
    from .store import SpectraWriter, pack

    scene = Scene(tuple(structures), grid, motion)
    chunk = chunk_shape(grid.shape, chunk_cells)
    attributes = {"history": history, "documents": documents, "motion": motion.name, "model": "linear"}
    names = ("theta_ratio", "outcome", "impacts") if impacts else ("theta_ratio", "outcome")

    def packed(response: Response) -> dict[str, bytes]:
        return {name: pack(_padded(getattr(response, name), chunk)) for name in names}

    with SpectraWriter(Path(path), scene.structures, grid, chunk, impacts=impacts, overwrite=overwrite, attributes=attributes) as writer:

        def keep(unit: Unit, data: dict[str, bytes]) -> None:
            for i in unit.structures:
                writer.write(i, unit.row, unit.column, data)

        try:
            summary = _sweep(scene, chunk, workers, check, progress, packed, keep)
        except KeyboardInterrupt:
            raise Interrupted(f"interrupted; {writer.written} of {writer.chunks} chunks are kept in {writer.part}") from None
        writer.finish(summary.record())
    return summary


def chunk_shape(shape: tuple[int, int], cells: int) -> tuple[int, int]:
    """(rows, columns) of a unit of work of about `cells` cells: whole rows where they fit. Raises UsageError if cells < 1."""
    if cells < 1:
        raise UsageError(f"a unit of work has at least one cell, found {cells}")
    columns = min(shape[1], cells)
    return min(shape[0], max(1, cells // columns)), columns


def _padded(block: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """A block at the grid's edge, filled up to the full chunk that HDF5 stores."""
    if block.shape == shape:
        return block
    full = np.zeros(shape, dtype=block.dtype)
    full[: block.shape[0], : block.shape[1]] = block
    return full


def _units(scene: Scene, chunk: tuple[int, int]) -> Iterator[Unit]:
    rows, columns = scene.grid.shape
    for group in scene.sharing():
        for row in range(0, rows, chunk[0]):
            for column in range(0, columns, chunk[1]):
                yield Unit(group, row, column)


def _compute(scene: Scene, unit: Unit, chunk: tuple[int, int]) -> Response:
    structure = scene.structures[unit.structures[0]]
    amplitude, omega = scene.grid.scaled(structure)
    a = amplitude[unit.column : unit.column + chunk[1]]
    w = omega[unit.row : unit.row + chunk[0]]
    return linear_response(scene.motion, a[None, :], w[:, None], structure.eta)


def _sweep(
    scene: Scene,
    chunk: tuple[int, int],
    workers: int | None,
    check: int,
    progress: Progress | None,
    convert: Callable[[Response], Any] | None,
    keep: Callable[[Unit, Any], None],
) -> Summary:
    """Compute all units, hand each result to `keep` in order, and sum up."""
    began = time.perf_counter()
    if workers is not None and workers < 1:
        raise UsageError(f"workers is {workers}, accepted is a whole number from 1")
    units = list(_units(scene, chunk))
    wanted = min(workers or os.cpu_count() or 1, len(units))
    if workers is None and scene.cells < SMALL_SWEEP:
        wanted = 1
    job = _Job(scene, chunk, _sampled(scene, check), convert)
    total, outcomes, shared, worst, misjudged, checked = Work(), np.zeros(len(Outcome), dtype=np.int64), 0, 0.0, 0, 0
    for done, (unit, report) in enumerate(_results(job, units, wanted), 1):
        keep(unit, report.data)
        times = len(unit.structures)
        total += report.work
        outcomes += times * report.outcomes
        shared += (times - 1) * report.work.cells
        worst, misjudged, checked = max(worst, report.worst), misjudged + report.misjudged, checked + report.checked
        if progress:
            progress(done, len(units))
    return Summary(
        structures=len(scene.structures),
        cells=scene.cells,
        run_time=time.perf_counter() - began,
        workers=wanted,
        outcomes={o.flag: int(outcomes[o]) for o in Outcome},
        work=total,
        shared_cells=shared,
        checked_cells=checked,
        estimated_error=worst,
        misjudged=misjudged,
    )


def _sampled(scene: Scene, check: int) -> np.ndarray:
    """(structure, row, column) of the cells to check: drawn without regard to units, among the cells that uplift."""
    if check < 1:
        return np.zeros((0, 3), dtype=np.int64)
    random = np.random.default_rng(_SEED)
    rows, columns = scene.grid.shape
    found: list[tuple[int, int, int]] = []
    owners = [group[0] for group in scene.sharing()]
    for _ in range(20 * check):
        i, r, c = owners[int(random.integers(len(owners)))], int(random.integers(rows)), int(random.integers(columns))
        amplitude = scene.grid.scaled(scene.structures[i])[0][c]
        if amplitude * scene.motion.peak > 1.0 and (i, r, c) not in found:
            found.append((i, r, c))
        if len(found) == check:
            break
    return np.array(found, dtype=np.int64).reshape(-1, 3)


@dataclass(frozen=True)
class _Report:
    """What comes back from a unit: its data (converted), its counters, and how its checked cells compare."""

    data: Any
    work: Work
    outcomes: np.ndarray
    worst: float
    misjudged: int
    checked: int


@dataclass(frozen=True)
class _Job:
    """Everything a worker needs; sent once, not with each unit."""

    scene: Scene
    chunk: tuple[int, int]
    samples: np.ndarray
    convert: Callable[[Response], Any] | None

    def run(self, unit: Unit) -> _Report:
        response = _compute(self.scene, unit, self.chunk)
        worst, misjudged, checked = self.compare(unit, response)
        data = self.convert(response) if self.convert else response
        outcomes = np.bincount(response.outcome.ravel(), minlength=len(Outcome))
        return _Report(data, response.work, outcomes, worst, misjudged, checked)

    def compare(self, unit: Unit, response: Response) -> tuple[float, int, int]:
        """(largest difference, outcomes that differ, cells) of this unit's sampled cells against the reference."""
        structure = self.scene.structures[unit.structures[0]]
        amplitude, omega = self.scene.grid.scaled(structure)
        worst, misjudged, checked = 0.0, 0, 0
        for i, row, column in self.samples:
            r, c = row - unit.row, column - unit.column
            if i != unit.structures[0] or not (0 <= r < self.chunk[0] and 0 <= c < self.chunk[1]):
                continue
            outcome, theta = reference_cell(self.scene.motion, amplitude[column], omega[row], structure.eta)
            if outcome == Outcome.FAILED:
                continue
            checked += 1
            misjudged += int(outcome != response.outcome[r, c])
            if outcome == response.outcome[r, c] and np.isfinite(theta):
                worst = max(worst, abs(theta - float(response.theta_ratio[r, c])))
        return worst, misjudged, checked


_job: _Job | None = None


def _set_job(job: _Job) -> None:
    global _job
    _job = job
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent alone decides


def _run_unit(unit: Unit) -> _Report:
    assert _job is not None
    return _job.run(unit)


def _results(job: _Job, units: Sequence[Unit], workers: int) -> Iterator[tuple[Unit, _Report]]:
    if workers == 1:
        for unit in units:
            yield unit, job.run(unit)
        return
    # Forked workers have the scene and the imported packages from the start; only results travel.
    forks = sys.platform == "linux"
    context = multiprocessing.get_context("fork" if forks else "spawn")
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_set_job, initargs=(job,))
    try:
        waiting: deque[tuple[Unit, Future[_Report]]] = deque()
        with warnings.catch_warnings():  # numpy's idle arithmetic threads are no danger to a fork
            warnings.simplefilter("ignore", DeprecationWarning)
            for unit in units:
                waiting.append((unit, pool.submit(_run_unit, unit)))
                if len(waiting) > 2 * workers:
                    first, future = waiting.popleft()
                    yield first, future.result()
        while waiting:
            first, future = waiting.popleft()
            yield first, future.result()
    except BrokenProcessPool:
        raise OutputError("a worker process died (out of memory?); fewer --workers or a smaller --chunk need less") from None
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
