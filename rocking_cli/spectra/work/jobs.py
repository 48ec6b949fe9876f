"""Units of work, computed here, in other processes or on a cluster, and collected in
their own order.

The cells of a unit are computed by the same code in the same order everywhere, so the
result does not depend on the number of workers or the size of a unit, to the last bit.
"""

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import chain
from typing import Any

import numpy as np

from ...dynamics.method import LINEAR
from ...dynamics.outcome import Difference, Outcome, Work, difference
from ...dynamics.response import (
    Response,
    can_share_records,
    few,
    response,
    response_under_records,
    response_with_speed,
)
from ...dynamics.system import System
from ...processes import Runner, processes
from ...structures.friction import friction_that_slides
from ...structures.parameters import RockingParameters
from ..error_bound import Conditions
from ..scene import Scene, SceneCells, Unit
from ..verification import Answer, CellPlace, Seen, reference

TOGETHER = 1 << 19  # cells that a worker computes in one batch

Item = list[Unit] | CellPlace
"""A batch of units, or a cell for the reference."""


CellValues = dict[str, np.ndarray]
"""The variables of cells by name."""


@dataclass(frozen=True)
class Report:
    """The result of a unit, or of several added up. The work of units that ran together
    is counted with the first of them.
    """

    work: Work  # counters over all places
    outcomes: np.ndarray  # number of cells of each outcome, over all places
    differences: np.ndarray  # number of cells of each `Difference`, over all places
    conditions: Conditions  # of the cells that stand, over all places
    shared: int = 0  # cells that took the result of another structure
    data: tuple[Any, ...] = ()  # of one unit: its data at each place, converted
    # of one unit: what was found at its cells that the verification needs
    seen: Mapping[CellPlace, Seen] | None = None

    def __add__(self, other: "Report") -> "Report":
        return Report(
            self.work + other.work,
            self.outcomes + other.outcomes,
            self.differences + other.differences,
            self.conditions + other.conditions,
            self.shared + other.shared,
        )


@dataclass(frozen=True)
class Job:
    """The data that a worker needs; a process of this machine receives it once, not
    with each unit.
    """

    scene: Scene  # the whole sweep
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

    def together(self, unit: Unit) -> int:
        """Return the number of units such as this one in one batch, which fills the
        pool of the engine; all units of a batch have one system.
        """
        if len(self.runs) > 1 or (self.scene.of_records and not self.shares_records):
            return 1
        return max(1, TOGETHER // math.prod(unit.shape))

    @property
    def shares_records(self) -> bool:
        """True if cells under several records may share a run."""
        return self.scene.of_records and self.quantities == ("velocity_ratio",)

    def answer(self, item: Item) -> list[Report] | Answer:
        """Return the reports of some units, or the reference answer for a cell."""
        return self.run(item) if isinstance(item, list) else reference(self.scene, item)

    def run(self, units: Sequence[Unit]) -> list[Report]:
        """Compute some units. Cells of one system under one motion, or under records
        that chain, share a run of the march.
        """
        parts = [list(self.scene.cells_of(unit)) for unit in units]
        runs: dict[Hashable, list[SceneCells]] = {}
        for cells in chain.from_iterable(parts):
            runs.setdefault(self._run_of(cells), []).append(cells)
        work, found = Work(), dict[int, list[CellValues]]()
        for some in runs.values():
            values, own = self._computed(some)
            found |= dict(zip(map(id, some), values, strict=True))
            work += own
        reports = []
        for unit, some in zip(units, parts, strict=True):
            blocks = zip(*(found[id(cells)] for cells in some), strict=True)
            # The first unit reports the work of all.
            reports.append(self._report(unit, list(map(_joined, blocks)), work))
            work = Work()
        return reports

    def _run_of(self, cells: SceneCells) -> Hashable:
        """Return a key: cells of equal keys share a run."""
        if friction_that_slides(cells.structure) is not None:
            return id(cells)
        motion = None if self._chains(cells) else id(cells.motion)
        return motion, self._key(cells.structure)

    def _chains(self, cells: SceneCells) -> bool:
        """True if cells under other records share their run."""
        system = self.scene.system_of(cells.structure)
        return self.shares_records and can_share_records(system, cells.motion)

    def _computed(
        self, run: Sequence[SceneCells]
    ) -> tuple[list[list[CellValues]], Work]:
        """Return (for all cells of a run the variables of each structure that shares
        them; the work).
        """
        first = run[0]
        if friction_that_slides(first.structure) is not None:
            from .sliding_cells import sliding_block

            slides = [sliding_block(s, first, self.quantities) for s in first.sharers]
            return [slides], Work()
        chains = self._chains(first)
        amplitude = np.concatenate([cells.amplitude for cells in run])
        omega = np.concatenate([cells.omega for cells in run])
        compute = self._under_records if chains else self._under_one_motion
        whole, work = compute(run, amplitude, omega)
        if "slide" in self.quantities:  # a body that rocks does not slide
            whole["slide_max"] = np.full(omega.size, np.nan)
        ends = np.cumsum([x.omega.size for x in run])[:-1]
        blocks = zip(*(np.split(x, ends) for x in whole.values()), strict=True)
        values = [dict(zip(whole, block, strict=True)) for block in blocks]
        tested = not self.scene.method.exact  # for lost contact, by the run
        return [
            [x if tested else self._standing(s, cells, x) for s in cells.sharers]
            for x, cells in zip(values, run, strict=True)
        ], work

    def _under_records(
        self, run: Sequence[SceneCells], amplitude: np.ndarray, omega: np.ndarray
    ) -> tuple[CellValues, Work]:
        """Return (the variables of all cells, the work) of one system under several
        records.
        """
        system, alpha = self._system(run, self.scene.system_of)
        motions = {id(cells.motion): cells.motion for cells in run}
        numbers = {key: i for i, key in enumerate(motions)}
        which = np.repeat(
            [numbers[id(x.motion)] for x in run], [x.omega.size for x in run]
        )
        got, rate = response_under_records(
            system, list(motions.values()), which, amplitude, omega
        )
        return {**_variables(got), "velocity_ratio": rate * alpha}, got.work

    def _under_one_motion(
        self, run: Sequence[SceneCells], amplitude: np.ndarray, omega: np.ndarray
    ) -> tuple[CellValues, Work]:
        """Return (the variables of all cells, the work) of one system under one
        motion.
        """
        method, motion = self.scene.method, run[0].motion
        system, alpha = self._system(run, self.scene.system_of)
        extra: CellValues = {}
        if "velocity_ratio" in self.quantities:
            got, rate = response_with_speed(system, motion, amplitude, omega)
            extra["velocity_ratio"] = rate * alpha
        elif self.one_by_one:
            got = Response.joined(
                [
                    response(method.system_of(s), motion, a, w, how="floats")
                    for s, _, a, w, _ in run
                ]
            )
        else:
            got = response(system, motion, amplitude, omega)
        if "linear" in self.quantities:
            system, _ = self._system(run, LINEAR.system_of)
            linear = response(system, motion, amplitude, omega)
            extra |= {
                "theta_ratio_linear": linear.theta_ratio,
                "outcome_linear": linear.outcome,
                "difference": difference(got.outcome, linear.outcome),
            }
        return {**_variables(got), **extra}, got.work

    @staticmethod
    def _system(
        run: Sequence[SceneCells], system_of: Callable[[RockingParameters], System]
    ) -> tuple[System, np.ndarray]:
        """Return (the system of all cells of a run, alpha of each [rad])."""
        counts = [cells.omega.size for cells in run]
        systems = [system_of(cells.structure) for cells in run]
        alpha = np.repeat([cells.structure.alpha for cells in run], counts)
        return System.of_each_cell(systems, counts), alpha

    def _standing(
        self, structure: RockingParameters, cells: SceneCells, block: CellValues
    ) -> CellValues:
        """Return the block of one structure among those that share rotations, with the
        lost contact of this structure.
        """
        system, motion = self.scene.method.system_of(structure), cells.motion
        # Its own body is watched where Lemma 13 leaves open whether it keeps contact.
        doubtful = cells.amplitude > system.safe_amplitude(motion)
        at = np.flatnonzero((block["outcome"] == Outcome.ROCKED) & doubtful)
        shaking = cells.amplitude[at], cells.omega[at]
        own = response(system, motion, *shaking, peaks=False)
        lost = at[own.outcome != Outcome.ROCKED]
        if lost.size:
            block = {name: x.copy() for name, x in block.items()}
            block["outcome"][lost] = Outcome.LOST_CONTACT
            for name in {"theta_ratio", "velocity_ratio", "condition"} & block.keys():
                block[name][lost] = np.nan
        return block

    def _report(self, unit: Unit, places: Sequence[CellValues], work: Work) -> Report:
        """Return the report of a unit, from its cells at all its places."""
        data = {}
        for cells in {id(x): x for x in places}.values():
            block = {name: x.reshape(unit.shape) for name, x in cells.items()}
            data[id(cells)] = self.convert(block) if self.convert else block
        seen = {}
        for place in self.wanted.get(unit.first, ()):
            at = (place[1] - unit.row) * unit.shape[1] + place[2] - unit.column
            names = "outcome", "theta_ratio", "condition"
            seen[place] = Seen(*(places[0][name][at].item() for name in names))
        differs = places[0].get("difference", np.zeros(0, np.uint8))
        return Report(
            work,
            np.sum(
                [np.bincount(x["outcome"], minlength=len(Outcome)) for x in places],
                axis=0,
            ),
            len(places) * np.bincount(differs, minlength=len(Difference)),
            sum(
                (Conditions.of(x["condition"]) for x in places[1:]),
                Conditions.of(places[0]["condition"]),
            ),
            math.prod(unit.shape) * (len(places) - 1),
            tuple(data[id(x)] for x in places),
            seen,
        )


def _variables(of: Response) -> CellValues:
    """Return the variables that every cell has."""
    return {name: x for name, x in of._asdict().items() if name != "work"}


def _joined(blocks: Sequence[CellValues]) -> CellValues:
    """Join the cells of several blocks; a single block is returned itself, since
    several places often share it.
    """
    if len(blocks) == 1:
        return blocks[0]
    return {name: np.concatenate([x[name] for x in blocks]) for name in blocks[0]}


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
    job: Job, units: Sequence[Unit], run: Runner, at_once: int
) -> Iterator[tuple[Unit, Report]]:
    """Yield the reports of the units, in their order, by a crew (see `Crew`)."""
    together = job.together(units[0]) if units else 1
    size = max(1, min(together, -(-len(units) // at_once)))
    batches = [list(units[i : i + size]) for i in range(0, len(units), size)]
    for batch, reports in zip(batches, run(batches), strict=True):
        yield from zip(batch, reports, strict=True)
