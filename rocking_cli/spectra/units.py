"""Units of work, computed here or in other processes, and collected in their own order.

A unit's cells are computed by the same code in the same order wherever it runs, so neither the number of workers nor the
size of a unit changes a bit of the result.
"""

from __future__ import annotations

import multiprocessing
import signal
import sys
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..dynamics.engine import Response, Work, response
from ..dynamics.outcome import Outcome
from ..errors import OutputError
from .scene import Scene, Unit


def _compute(scene: Scene, unit: Unit, chunk: tuple[int, int]) -> Response:
    structure = scene.structures[unit.structures[0]]
    amplitude, omega = scene.grid.scaled(structure)
    a = amplitude[unit.column : unit.column + chunk[1]]
    w = omega[unit.row : unit.row + chunk[0]]
    return response(scene.method.model_of(structure), scene.motion, a[None, :], w[:, None], structure.eta)


@dataclass(frozen=True)
class Report:
    """What comes back from a unit: its data (converted), its counters, and how its checked cells compare."""

    data: Any
    work: Work
    outcomes: np.ndarray
    worst: float
    misjudged: int
    checked: int


@dataclass(frozen=True)
class Job:
    """Everything a worker needs; sent once, not with each unit."""

    scene: Scene
    chunk: tuple[int, int]
    samples: np.ndarray
    convert: Callable[[Response], Any] | None

    def run(self, unit: Unit) -> Report:
        response = _compute(self.scene, unit, self.chunk)
        worst, misjudged, checked = self.compare(unit, response)
        data = self.convert(response) if self.convert else response
        outcomes = np.bincount(response.outcome.ravel(), minlength=len(Outcome))
        return Report(data, response.work, outcomes, worst, misjudged, checked)

    def compare(self, unit: Unit, response: Response) -> tuple[float, int, int]:
        """(largest difference, outcomes that differ, cells) of this unit's sampled cells against the reference."""
        structure = self.scene.structures[unit.structures[0]]
        amplitude, omega = self.scene.grid.scaled(structure)
        worst, misjudged, checked = 0.0, 0, 0
        for i, row, column in self.samples:
            r, c = row - unit.row, column - unit.column
            if i != unit.structures[0] or not (0 <= r < self.chunk[0] and 0 <= c < self.chunk[1]):
                continue
            cell = (self.scene.motion, float(amplitude[column]), float(omega[row]), structure.eta)
            outcome, theta = self.scene.method.reference_of(structure)(*cell)
            if outcome == Outcome.FAILED:
                continue
            checked += 1
            misjudged += int(outcome != response.outcome[r, c])
            if outcome == response.outcome[r, c] and np.isfinite(theta):
                worst = max(worst, abs(theta - float(response.theta_ratio[r, c])))
        return worst, misjudged, checked


_job: Job | None = None


def _set_job(job: Job) -> None:
    global _job
    _job = job
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent alone decides
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _run_unit(unit: Unit) -> Report:
    assert _job is not None
    return _job.run(unit)


def unit_reports(job: Job, units: Sequence[Unit], workers: int) -> Iterator[tuple[Unit, Report]]:
    if workers == 1:
        for unit in units:
            yield unit, job.run(unit)
        return
    # Forked workers have the scene and the imported packages from the start; only results travel.
    forks = sys.platform == "linux"
    context = multiprocessing.get_context("fork" if forks else "spawn")
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_set_job, initargs=(job,))
    try:
        waiting: deque[tuple[Unit, Future[Report]]] = deque()
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
