"""Units of work, computed here, in other processes or on a cluster, and collected in their own order.

The cells of a unit are computed by the same code in the same order everywhere, so the result does not depend on the number of
workers or the size of a unit, to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import Any

import numpy as np

from ...dynamics.method import LINEAR
from ...dynamics.outcome import Difference, Outcome, Work, difference
from ...dynamics.response import Response, response, response_with_demands, response_with_speed, that_left_the_ground
from ...motions import Motion
from ...processes import Run, processes
from ...structures.parameters import RockingParameters
from ..scene import Band, Scene, Unit
from ..trust.condition import condition_of
from ..trust.verification import Answer, Place, Verification, reference

_LONG, _FEW = 200, 20  # single cells are faster above so many segments, up to so many cells of a structure
TOGETHER = 1 << 19  # cells of an exact equation that a worker computes in one batch

Item = list[Unit] | Place
"""A batch of units, or a cell for the reference."""


@dataclass(frozen=True)
class Report:
    """The result of a unit: its data at each place (converted), its counters over all places, and (outcome, theta/alpha) of its cells
    to check. The work of units that ran together is counted with the first of them."""

    data: tuple[Any, ...]
    work: Work
    outcomes: np.ndarray
    differences: np.ndarray
    seen: Mapping[Place, tuple[int, float]]


@dataclass(frozen=True)
class Block(Response):
    """The response of cells, and by name the variables of the requested quantities."""

    beside: Mapping[str, np.ndarray] = field(default_factory=dict)

    def variable(self, name: str) -> np.ndarray:
        """A variable of the file."""
        return self.beside[name] if name in self.beside else getattr(self, name)

    def without(self, gone: np.ndarray) -> Block:
        """The same block with these cells, by index, as lost contact."""
        outcome, floats = self.outcome.copy(), {"theta_ratio": self.theta_ratio.copy()}
        floats |= {name: self.beside[name].copy() for name in ("velocity_ratio", "condition") if name in self.beside}
        outcome.flat[gone] = Outcome.LOST_CONTACT
        for values in floats.values():
            values.flat[gone] = np.nan
        return replace(self, theta_ratio=floats.pop("theta_ratio"), outcome=outcome, beside={**self.beside, **floats})

    def cut(self, first: int, last: int, size: tuple[int, int], work: Work) -> Block:
        """The cells from the first to before the last, as (rows, columns)."""
        theta_ratio, outcome, impacts = (x[first:last].reshape(size) for x in (self.theta_ratio, self.outcome, self.impacts))
        return Block(theta_ratio, outcome, impacts, work, {name: x[first:last].reshape(size) for name, x in self.beside.items()})


@dataclass(frozen=True)
class Job:
    """The data that a worker needs; a process of this machine receives it once, not with each unit."""

    scene: Scene
    chunk: tuple[int, int]
    checked: tuple[Place, ...]
    convert: Callable[[Block], Any] | None = None
    quantities: tuple[str, ...] = ()

    @property
    def forces(self) -> bool:
        """True if ground forces are computed."""
        return "friction" in self.quantities or "fz_min" in self.quantities

    @property
    def one_by_one(self) -> bool:
        """True if each cell is marched alone, which is faster for few cells of each system under long records."""
        scene = self.scene
        _, rows, columns = scene.shape
        systems = {scene.runs_with(structure) for structure in scene.structures}
        few = scene.segments > _LONG and rows * columns <= _FEW * len(scene.structures)
        return few and not scene.method.exact and len(systems) == len(scene.structures)

    @property
    def together(self) -> int:
        """The number of units in one batch, which fills the engine's pool; they are one system."""
        if not (self.scene.method.exact and self.scene.one_system):
            return 1
        return max(1, TOGETHER // (self.chunk[0] * self.chunk[1]))

    def answer(self, item: Item) -> list[Report] | Answer:
        """The reports of some units, or the reference of a cell."""
        return self.run(item) if isinstance(item, list) else reference(self.scene, item)

    def run(self, units: Sequence[Unit]) -> list[Report]:
        """Compute some units. Bands of one system under one motion form one batch; with forces also of one body."""
        scene = self.scene
        _, rows, columns = scene.shape
        sizes = [(min(self.chunk[0], rows - unit.row), min(self.chunk[1], columns - unit.column)) for unit in units]
        bands = [(n, band) for n, unit in enumerate(units) for band in scene.bands(unit, sizes[n])]
        batches: dict[Any, list[int]] = {}
        for i, (_, band) in enumerate(bands):
            body = scene.method.body_of(band.structure) if self.forces else None
            batches.setdefault((id(band.motion), scene.runs_with(band.structure), body), []).append(i)
        found: dict[int, list[Block]] = {}
        for batch in batches.values():
            found |= zip(batch, self.blocks([bands[i][1] for i in batch], [sizes[bands[i][0]][1] for i in batch]), strict=True)
        return [self.report(unit, [found[i] for i, (m, _) in enumerate(bands) if m == n]) for n, unit in enumerate(units)]

    def blocks(self, bands: Sequence[Band], columns: Sequence[int]) -> Iterator[list[Block]]:
        """The blocks of bands in one run under one motion, for each of their sharers; all work is counted with the first. columns: of
        each band."""
        motion, sizes = bands[0].motion, [(band.rows, width) for band, width in zip(bands, columns, strict=True)]
        ends = np.cumsum([0, *(a * b for a, b in sizes)])
        cells = np.empty((3, int(ends[-1])))
        for band, size, first, last in zip(bands, sizes, ends[:-1], ends[1:], strict=True):
            here = cells[:, first:last].reshape(3, *size)
            here[0], here[1], here[2] = band.amplitude, band.omega, band.structure.eta
        whole = self.together_of([band.structure for band in bands], [a * b for a, b in sizes], motion, cells)
        work = whole.work
        for band, size, first, last in zip(bands, sizes, ends[:-1], ends[1:], strict=True):
            block = whole.cut(first, last, size, work)
            yield [self._standing(sharer, motion, cells[:, first:last], block) for sharer in band.sharers]
            work = Work()

    def together_of(self, structures: list[RockingParameters], counts: list[int], motion: Motion, cells: np.ndarray) -> Block:
        """The block of cells (A, Omega, eta) with the quantities; counts: cells of each structure."""
        method = self.scene.method
        system = method.system_of_cells(structures, counts)
        if method.exact and not self.forces:
            system = replace(system, body=None, own=())  # structures that share rotations have different bodies
        beside: dict[str, np.ndarray] = {}
        known: Response | None = None
        if "velocity_ratio" in self.quantities:
            known, rate = response_with_speed(system, motion, *cells)
            beside["velocity_ratio"] = rate * np.repeat([s.alpha for s in structures], counts)
        if self.forces:
            got, asked = response_with_demands(system, motion, *cells, found=known)
            beside |= asked
        elif known is None and self.one_by_one:
            from ...dynamics.single.response import response_alone

            got = response_alone(method.system_of(structures[0]), motion, *cells)
        else:
            got = known or response(system, motion, *cells)
        if "condition" in self.quantities:
            pairs = method.system_of_cells(structures * 2, counts * 2)  # for several sets of cells in turn
            if method.exact:
                pairs = replace(pairs, body=None, own=())
            amplitude, omega, eta = cells
            condition = condition_of(partial(response, pairs, motion), amplitude, omega, eta, method.stated_tolerance or 0.0)
            beside["condition"] = np.where(got.outcome == Outcome.LOST_CONTACT, np.nan, condition)
        if "linear" in self.quantities:
            linear = response(LINEAR.system_of_cells(structures, counts), motion, *cells)
            beside |= {"theta_ratio_linear": linear.theta_ratio, "outcome_linear": linear.outcome}
            beside["difference"] = difference(got.outcome, linear.outcome)
        return Block(got.theta_ratio, got.outcome, got.impacts, got.work, beside)

    def _standing(self, structure: RockingParameters, motion: Motion, cells: np.ndarray, block: Block) -> Block:
        """The block of one of the structures that share it, with its own lost contact if the linear equation lets it leave the ground."""
        if not self.scene.method.exact:
            return block
        doubtful, (amplitude, omega, eta) = block.outcome.ravel() == Outcome.ROCKED, cells
        system = self.scene.method.system_of(structure)
        gone = that_left_the_ground(system, motion, (amplitude, omega, eta), doubtful, block.theta_ratio.ravel())
        return block.without(gone) if gone.size else block

    def report(self, unit: Unit, blocks: Sequence[Sequence[Block]]) -> Report:
        """The report of a unit whose rows are these blocks, each for all places of the unit."""
        keys = [tuple(map(id, rows)) for rows in zip(*blocks, strict=True)]
        parts = {key: joined(rows) for key, rows in zip(keys, zip(*blocks, strict=True), strict=True)}  # several places often share one
        data = {key: self.convert(one) if self.convert else one for key, one in parts.items()}
        outcomes = sum(np.bincount(parts[key].outcome.ravel(), minlength=len(Outcome)) for key in keys)
        first = parts[keys[0]]
        differences = np.bincount(first.beside.get("difference", np.zeros(0, np.uint8)).ravel(), minlength=len(Difference))
        seen = self.seen(unit, first)
        return Report(tuple(data[key] for key in keys), first.work, np.asarray(outcomes), len(keys) * differences, seen)

    def seen(self, unit: Unit, response: Response) -> dict[Place, tuple[int, float]]:
        """Outcome and theta/alpha of the cells to check in this unit."""
        found = {}
        for i, row, column in self.checked:
            r, c = row - unit.row, column - unit.column
            if i == unit.places[0] and 0 <= r < self.chunk[0] and 0 <= c < self.chunk[1]:
                found[i, row, column] = int(response.outcome[r, c]), float(response.theta_ratio[r, c])
        return found


def joined(blocks: Sequence[Block]) -> Block:
    """One block with the rows of all blocks in order."""
    if len(blocks) == 1:
        return blocks[0]
    theta_ratio, outcome, impacts = (np.concatenate([getattr(b, name) for b in blocks]) for name in ("theta_ratio", "outcome", "impacts"))
    beside = {name: np.concatenate([b.beside[name] for b in blocks]) for name in blocks[0].beside}
    return Block(theta_ratio, outcome, impacts, sum((b.work for b in blocks), Work()), beside)


Crew = AbstractContextManager[tuple[Run, int]]
"""A context with (function from items to their answers in order, number of items computed at a time)."""


@contextmanager
def local_crew(job: Job, workers: int) -> Iterator[tuple[Run, int]]:
    """A crew of this process, or of `workers` others. Raises OutputError when one of them dies."""
    if workers == 1:
        yield partial(map, job.answer), 1
        return
    with processes(workers, job.answer, "fewer `workers` or a smaller `chunk_cells` need less") as run:
        yield run, workers


def unit_reports(job: Job, units: Sequence[Unit], crew: Crew, verification: Verification) -> Iterator[tuple[Unit, Report]]:
    """The reports of the units, in their order; after the last one the verification has its answers."""
    with crew as (run, at_once):
        size = max(1, min(job.together, -(-len(units) // at_once)))
        batches = [list(units[i : i + size]) for i in range(0, len(units), size)]
        results = run(chain(batches, verification.sensitive))
        for batch in batches:
            yield from zip(batch, next(results), strict=True)
        verification.answers |= zip(verification.sensitive, results, strict=True)
