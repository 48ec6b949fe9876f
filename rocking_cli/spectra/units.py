"""Units of work, computed here or in other processes, and collected in their own order.

A unit's cells are computed by the same code in the same order wherever it runs, so neither the number of workers nor the
size of a unit changes a bit of the result.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import tee
from typing import Any

import numpy as np

from ..dynamics.march.engine import Work
from ..dynamics.outcome import Outcome
from ..dynamics.response import Response, response
from .condition import condition_of
from .processes import processes
from .scene import Scene, Unit


@dataclass(frozen=True)
class Report:
    """What comes back from a unit: its data (converted), its counters, and how its checked cells compare.

    Units that ran together have their work counted with the first of them.
    """

    data: Any
    work: Work
    cells: int
    outcomes: np.ndarray
    worst: float
    misjudged: int
    checked: int
    sensitive: int


@dataclass(frozen=True)
class Block(Response):
    """A unit's response, and what was asked for beside it (see `QUANTITIES`)."""

    condition: np.ndarray | None = None


@dataclass(frozen=True)
class Job:
    """Everything a worker needs; to processes of this machine it goes once, not with each unit."""

    scene: Scene
    chunk: tuple[int, int]
    samples: np.ndarray
    convert: Callable[[Block], Any] | None
    quantities: tuple[str, ...] = ()

    @property
    def together(self) -> int:
        """Units that are best run as one batch, so that the engine's pool is seldom half empty; they are one system."""
        if not (self.scene.method.exact and self.scene.one_system):
            return 1
        return max(1, TOGETHER // (self.chunk[0] * self.chunk[1]))

    def run(self, units: Sequence[Unit]) -> list[Report]:
        """Compute some units in one batch."""
        scene = self.scene
        rows, columns = scene.grid.shape
        sizes = [(min(self.chunk[0], rows - unit.row), min(self.chunk[1], columns - unit.column)) for unit in units]
        cells, first = np.empty((3, sum(a * b for a, b in sizes))), 0
        for unit, size in zip(units, sizes, strict=True):
            structure = scene.structures[unit.structures[0]]
            amplitude, omega = scene.grid.scaled(structure)
            block = cells[:, first : first + size[0] * size[1]].reshape(3, *size)
            block[0], block[1] = amplitude[unit.column : unit.column + size[1]], omega[unit.row : unit.row + size[0], None]
            block[2] = structure.eta
            first += size[0] * size[1]
        system = scene.method.system_of(scene.structures[units[0].structures[0]])
        found, condition = response(system, scene.motion, *cells), None
        if "condition" in self.quantities:
            respond, tolerance = partial(response, system, scene.motion), scene.method.stated_tolerance or 0.0
            condition = condition_of(respond, cells[0], cells[1], cells[2], tolerance)
        del cells
        reports: list[Report] = []
        first = 0
        for unit, size in zip(units, sizes, strict=True):
            mine = slice(first, first + size[0] * size[1])
            first = mine.stop
            work = found.work if not reports else Work()
            theta_ratio, outcome, impacts = (x[mine].reshape(size) for x in (found.theta_ratio, found.outcome, found.impacts))
            part = Block(theta_ratio, outcome, impacts, work, None if condition is None else condition[mine].reshape(size))
            compared = self.compare(unit, part)
            outcomes = np.bincount(part.outcome.ravel(), minlength=len(Outcome))
            data = self.convert(part) if self.convert else part
            reports.append(Report(data, work, part.outcome.size, outcomes, *compared))
        return reports

    def compare(self, unit: Unit, response: Response) -> tuple[float, int, int, int]:
        """(largest difference, outcomes that differ, cells, of them sensitive ones) of this unit's checked cells against the reference."""
        structure = self.scene.structures[unit.structures[0]]
        amplitude, omega = self.scene.grid.scaled(structure)
        worst, misjudged, checked, sensitive = 0.0, 0, 0, 0
        for i, row, column, chosen in self.samples:
            r, c = row - unit.row, column - unit.column
            if i != unit.structures[0] or not (0 <= r < self.chunk[0] and 0 <= c < self.chunk[1]):
                continue
            cell = (self.scene.motion, float(amplitude[column]), float(omega[row]), structure.eta)
            outcome, theta = self.scene.method.reference_of(structure)(*cell)
            if outcome == Outcome.FAILED:
                continue
            checked, sensitive = checked + 1, sensitive + int(chosen)
            misjudged += int(outcome != response.outcome[r, c])
            if outcome == response.outcome[r, c] and np.isfinite(theta):
                worst = max(worst, abs(theta - float(response.theta_ratio[r, c])))
        return worst, misjudged, checked, sensitive


TOGETHER = 1 << 19  # cells of an exact equation that a worker computes in one batch


def _batches(job: Job, units: Sequence[Unit], workers: int) -> Iterator[list[list[int]]]:
    """Indices of units in rounds, one batch a worker each.

    Neighbours go to different workers, since they cost alike, and in alternating order, since the cost falls along the grid.
    """
    size = max(1, min(job.together, -(-len(units) // workers)))
    for first in range(0, len(units), workers * size):
        batches: list[list[int]] = [[] for _ in range(workers)]
        for i in range(first, min(len(units), first + workers * size)):
            lap, place = divmod(i - first, workers)
            batches[place if lap % 2 == 0 else workers - 1 - place].append(i)
        yield [batch for batch in batches if batch]


def unit_reports(job: Job, units: Sequence[Unit], workers: int) -> Iterator[tuple[Unit, Report]]:
    """The reports of the units, in their order. Raises OutputError when a worker process dies."""
    if workers == 1:
        for (batch,) in _batches(job, units, 1):
            some = [units[i] for i in batch]
            yield from zip(some, job.run(some), strict=True)
        return
    with processes(workers, job.run, "fewer --workers or a smaller --chunk need less") as run:
        rounds, ahead = tee(_batches(job, units, workers))
        results = run([units[i] for i in batch] for batches in ahead for batch in batches)
        for batches in rounds:
            reports = {i: report for batch in batches for i, report in zip(batch, next(results), strict=True)}
            for i in sorted(reports):
                yield units[i], reports[i]
