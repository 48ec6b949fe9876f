"""Units of work, computed here, in other processes or on a cluster, and collected in
their own order.

The cells of a unit are computed by the same code in the same order everywhere, so the
result does not depend on the number of workers or the size of a unit, to the last bit.
"""

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import chain, repeat
from typing import Any

import numpy as np

from ...dynamics.method import LINEAR
from ...dynamics.outcome import Difference, Outcome, Work, difference
from ...dynamics.response import (
    Response,
    can_share_records,
    cells_that_lose_contact,
    few,
    response,
    response_under_records,
    response_with_speed,
)
from ...dynamics.system import System
from ...motions import Motion
from ...processes import Runner, processes
from ...structures.friction import friction_that_slides
from ...structures.parameters import RockingParameters
from ..error_bound import Conditions
from ..scene import CellBand, Scene, Unit
from ..verification import Answer, CellPlace, Verification, reference

TOGETHER = 1 << 19  # cells that a worker computes in one batch

Item = list[Unit] | CellPlace
"""A batch of units, or a cell for the reference."""


@dataclass(frozen=True)
class Report:
    """The result of a unit. The work of units that ran together is counted with the
    first of them.
    """

    data: tuple[Any, ...]  # its data at each place, converted
    work: Work  # counters over all places
    outcomes: np.ndarray  # number of cells of each outcome, over all places
    differences: np.ndarray  # number of cells of each `Difference`, over all places
    conditions: Conditions  # of the cells that stand, over all places
    # (outcome, theta/alpha, condition) of its cells that the verification needs
    seen: Mapping[CellPlace, tuple[int, float, float]]


CellValues = dict[str, np.ndarray]
"""The variables of cells by name."""


@dataclass(frozen=True)
class Job:
    """The data that a worker needs; a process of this machine receives it once, not
    with each unit.
    """

    scene: Scene  # the whole sweep
    chunk: tuple[int, int]  # (rows, columns) of a unit
    # places whose results the verification needs, by the first cell of their unit
    wanted: Mapping[CellPlace, Sequence[CellPlace]]
    # turns a block into the data of a report; None: the block itself
    convert: Callable[[CellValues], Any] | None = None
    quantities: tuple[str, ...] = ()  # names of the requested variables of `QUANTITIES`

    @cached_property
    def runs(self) -> dict[Any, RockingParameters]:
        """A structure for each run of the engine that the scene needs."""
        return {self._key(s): s for s in self.scene.structures}

    def _key(self, structure: RockingParameters) -> Hashable:
        """Return a key: one run computes structures of equal keys under a motion."""
        return self.scene.system_of(structure).march_key(self.scene.mixed)

    @cached_property
    def one_by_one(self) -> bool:
        """True if each cell is marched alone, on floats: under a long record this takes
        less time for all cells of a place than a run on arrays for each system.
        """
        scene = self.scene
        if scene.method.exact:
            return False
        _, rows, columns = scene.shape
        return rows * columns <= sum(
            few(scene.method.system_of(s), scene.segments) for s in self.runs.values()
        )

    @cached_property
    def together(self) -> int:
        """The number of units in one batch, which fills the pool of the engine; all
        units of a batch have one system.
        """
        if len(self.runs) > 1 or (self.scene.of_records and not self.shares_records):
            return 1
        return max(1, TOGETHER // (self.chunk[0] * self.chunk[1]))

    @property
    def shares_records(self) -> bool:
        """True if cells under several records may share a run."""
        return self.scene.of_records and self.quantities == ("velocity_ratio",)

    def answer(self, item: Item) -> list[Report] | Answer:
        """Return the reports of some units, or the reference answer for a cell."""
        return self.run(item) if isinstance(item, list) else reference(self.scene, item)

    def run(self, units: Sequence[Unit]) -> list[Report]:
        """Compute some units. Bands of one system under one motion, or under records
        that chain, form one batch.
        """
        bands = [self._bands(unit) for unit in units]
        # Bands that one run can compute together, by motion and system.
        batches: dict[Any, list[CellBand]] = {}
        found: dict[int, list[CellValues]] = {}
        for band in chain.from_iterable(bands):
            if friction_that_slides(band.structure) is not None:
                from .sliding_cells import sliding_block

                found[id(band)] = [
                    sliding_block(s, band, self.quantities) for s in band.sharers
                ]
                continue
            batches.setdefault(self._batch_of(band), []).append(band)
        work = Work()
        for (motion, _), batch in batches.items():
            blocks, own = self._batch_blocks(batch, shared=motion is None)
            found |= blocks
            work += own
        # The first unit reports the work of all.
        works = chain([work], repeat(Work()))
        return [
            self.report(unit, [found[id(band)] for band in own], w)
            for unit, own, w in zip(units, bands, works, strict=False)
        ]

    def _bands(self, unit: Unit) -> list[CellBand]:
        """Return the bands of a unit, in the order of their rows."""
        _, rows, columns = self.scene.shape
        size = (
            min(self.chunk[0], rows - unit.row),
            min(self.chunk[1], columns - unit.column),
        )
        return list(self.scene.bands(unit, size))

    def _batch_of(self, band: CellBand) -> tuple[int | None, Any]:
        """Return a key of the batch of a band: (its motion, None if cells under other
        records share the run; what its structure runs with).
        """
        shared = self.shares_records and can_share_records(
            self.scene.system_of(band.structure), band.motion
        )
        return None if shared else id(band.motion), self._key(band.structure)

    def _batch_blocks(
        self, batch: Sequence[CellBand], shared: bool
    ) -> tuple[dict[int, list[CellValues]], Work]:
        """Return (the blocks of the structures of each band, by the id of the band; the
        work) of a batch; shared: True if it is under several records.
        """
        cells = np.concatenate([band.cells() for band in batch], axis=1)
        compute = self.under_records if shared else self.together_of
        whole, work = compute(batch, cells)
        if "slide" in self.quantities:  # a body that rocks does not slide
            whole["slide_max"] = np.full(cells.shape[1], np.nan)
        found, last = {}, 0
        for band in batch:
            first, last = last, last + band.size
            block = {
                name: x[first:last].reshape(band.shape) for name, x in whole.items()
            }
            found[id(band)] = [block] * len(band.sharers)
            if shared or self.scene.method.exact:
                found[id(band)] = [
                    self._standing(s, band.motion, cells[:, first:last], block)
                    for s in band.sharers
                ]
        return found, work

    def under_records(
        self, batch: Sequence[CellBand], cells: np.ndarray
    ) -> tuple[CellValues, Work]:
        """Return (the variables of all cells (A, Omega), the work) for bands of
        one system under several records.
        """
        counts = [band.size for band in batch]
        structures = [band.structure for band in batch]
        systems = [self.scene.system_of(s) for s in structures]
        system = System.of_each_cell(systems, counts)._replace(body=None)
        numbers: dict[int, int] = {}
        which = np.repeat(
            [numbers.setdefault(id(band.motion), len(numbers)) for band in batch],
            counts,
        )
        records = list({id(band.motion): band.motion for band in batch}.values())
        got, rate = response_under_records(system, records, which, *cells)
        rate *= np.repeat([s.alpha for s in structures], counts)
        return {
            "theta_ratio": got.theta_ratio,
            "outcome": got.outcome,
            "impacts_at_least": got.impacts_at_least,
            "condition": got.condition,
            "velocity_ratio": rate,
        }, got.work

    def together_of(
        self, batch: Sequence[CellBand], cells: np.ndarray
    ) -> tuple[CellValues, Work]:
        """Return (the variables of all cells (A, Omega), the work) for bands under
        one motion.
        """
        method, motion = self.scene.method, batch[0].motion
        counts, structures = [b.size for b in batch], [b.structure for b in batch]
        systems = [self.scene.system_of(s) for s in structures]
        system = System.of_each_cell(systems, counts)
        extra: CellValues = {}
        if "velocity_ratio" in self.quantities:
            got, rate = response_with_speed(system, motion, *cells)
            extra["velocity_ratio"] = rate * np.repeat(
                [s.alpha for s in structures], counts
            )
        elif self.one_by_one:
            parts = np.split(cells, np.cumsum(counts)[:-1], axis=1)
            got = Response.joined(
                [
                    response(method.system_of(s), motion, *own, how="floats")
                    for s, own in zip(structures, parts, strict=True)
                ]
            )
        else:
            got = response(system, motion, *cells)
        if "linear" in self.quantities:
            systems = [LINEAR.system_of(s) for s in structures]
            linear = response(System.of_each_cell(systems, counts), motion, *cells)
            extra |= {
                "theta_ratio_linear": linear.theta_ratio,
                "outcome_linear": linear.outcome,
            }
            extra["difference"] = difference(got.outcome, linear.outcome)
        return {
            "theta_ratio": got.theta_ratio,
            "outcome": got.outcome,
            "impacts_at_least": got.impacts_at_least,
            "condition": got.condition,
            **extra,
        }, got.work

    def _standing(
        self,
        structure: RockingParameters,
        motion: Motion,
        cells: np.ndarray,
        block: CellValues,
    ) -> CellValues:
        """Return the block of one structure among those that share rotations, with the
        lost contact of this structure.
        """
        doubtful = block["outcome"].ravel() == Outcome.ROCKED
        system = self.scene.method.system_of(structure)
        theta_ratio, fastest = (
            block[name].ravel() if name in block else None
            for name in ("theta_ratio", "velocity_ratio")
        )
        lost = cells_that_lose_contact(
            system,
            motion,
            (cells[0], cells[1]),
            doubtful,
            theta_ratio,
            fastest,
        )
        if lost.size:
            block = {name: x.copy() for name, x in block.items()}
            block["outcome"].flat[lost] = Outcome.LOST_CONTACT
            for name in {"theta_ratio", "velocity_ratio", "condition"} & block.keys():
                block[name].flat[lost] = np.nan
        return block

    def report(
        self, unit: Unit, bands: Sequence[Sequence[CellValues]], work: Work
    ) -> Report:
        """Return the report of a unit, from the block of each of its bands at all
        places of the unit.
        """
        places = [_joined(blocks) for blocks in zip(*bands, strict=True)]
        data = {
            key: self.convert(block) if self.convert else block
            for key, block in {id(x): x for x in places}.items()
        }
        outcomes = np.sum(
            [
                np.bincount(block["outcome"].ravel(), minlength=len(Outcome))
                for block in places
            ],
            axis=0,
        )
        differences = np.bincount(
            places[0].get("difference", np.zeros(0, np.uint8)).ravel(),
            minlength=len(Difference),
        )
        return Report(
            tuple(data[id(x)] for x in places),
            work,
            outcomes,
            len(places) * differences,
            sum(
                (Conditions.of(block["condition"]) for block in places[1:]),
                Conditions.of(places[0]["condition"]),
            ),
            self.seen(unit, places[0]),
        )

    def seen(
        self, unit: Unit, block: CellValues
    ) -> dict[CellPlace, tuple[int, float, float]]:
        """Return outcome, theta/alpha and condition of the cells of this unit that the
        verification needs.
        """
        found = {}
        for place in self.wanted.get((unit.places[0], unit.row, unit.column), ()):
            at = place[1] - unit.row, place[2] - unit.column
            found[place] = (
                int(block["outcome"][at]),
                float(block["theta_ratio"][at]),
                float(block["condition"][at]),
            )
        return found


def _joined(blocks: Sequence[CellValues]) -> CellValues:
    """Join the rows of several blocks to one block; a single block is returned itself,
    since several places often share it.
    """
    return (
        blocks[0]
        if len(blocks) == 1
        else {
            name: np.concatenate([block[name] for block in blocks])
            for name in blocks[0]
        }
    )


Crew = AbstractContextManager[tuple[Runner, int]]
"""A context with (function from items to their answers in order, number of items
computed at a time).
"""


@contextmanager
def local_crew(job: Job, workers: int) -> Iterator[tuple[Runner, int]]:
    """Context of a crew: this process alone, or `workers` other processes. Raises
    OutputError when a worker dies.
    """
    if workers == 1:
        yield partial(map, job.answer), 1
        return
    with processes(
        workers, job.answer, "fewer `workers` or a smaller `chunk_cells` need less"
    ) as run:
        yield run, workers


def unit_reports(
    job: Job, units: Sequence[Unit], crew: Crew, verification: Verification
) -> Iterator[tuple[Unit, Report]]:
    """Yield the reports of the units, in their order; after the last one `verification`
    has all its answers.
    """
    with crew as (run, at_once):
        size = max(1, min(job.together, -(-len(units) // at_once)))
        batches = [list(units[i : i + size]) for i in range(0, len(units), size)]
        for batch, reports in zip(batches, run(batches), strict=True):
            for unit, report in zip(batch, reports, strict=True):
                verification.seen |= report.seen
                yield unit, report
        verification.ask(run)
