"""Units of work, computed here, in other processes or on a cluster, and collected in
their own order.

The cells of a unit are computed by the same code in the same order everywhere, so the
result does not depend on the number of workers or the size of a unit, to the last bit.
"""

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import Any, NamedTuple

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
from ...structures.friction import friction_that_slides
from ...structures.parameters import RockingParameters
from ..scene import CellPlace, Scene, SceneCells, Unit
from ..verification import Answer, reference

TOGETHER = 1 << 19  # cells that a worker computes in one batch

Item = list[Unit] | CellPlace
"""A batch of units, or a cell for the reference."""

CellValues = dict[str, np.ndarray]
"""The variables of cells by name."""


class Report(NamedTuple):
    """The result of a unit. The work of units that ran together is counted with the
    first of them.
    """

    work: Work  # counters over all places
    outcomes: np.ndarray  # number of cells of each outcome, over all places
    differences: np.ndarray  # number of cells of each `Difference`, over all places
    data: tuple[Any, ...]  # its data at each place, converted
    seen: tuple[Answer, ...]  # what was found at its wanted cells


@dataclass(frozen=True)
class Job:
    """The data that a worker needs; a process of this machine receives it once, not
    with each unit. Called with a batch of units it returns their reports, called with
    the place of a cell the answer of the reference.
    """

    scene: Scene  # the whole sweep
    # turns a block into the data of a report; None: the block itself
    convert: Callable[[CellValues], Any] | None = None
    quantities: tuple[str, ...] = ()  # names of the requested variables of `QUANTITIES`

    @cached_property
    def runs(self) -> dict[Any, RockingParameters]:
        """A structure for each run of the engine that the scene needs."""
        scene = self.scene
        return {scene.system_of(s).march_key(scene.mixed): s for s in scene.structures}

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

    def only(self, units: Sequence[Unit]) -> "Job":
        """Return the job with only the data that these units need."""
        return replace(self, scene=self.scene.only(units))

    def batches(self, units: Sequence[Unit], at_once: int) -> list[list[Unit]]:
        """Return the units in batches, so many of which are computed at a time; a batch
        of one system fills the pool of the engine.
        """
        size = max(1, -(-len(units) // at_once))
        if len(self.runs) > 1 or (self.scene.of_records and not self.shares_records):
            size = 1
        elif units:
            size = min(size, max(1, TOGETHER // math.prod(units[0].shape)))
        return [list(units[i : i + size]) for i in range(0, len(units), size)]

    @property
    def shares_records(self) -> bool:
        """True if cells under several records may share a run."""
        return self.scene.of_records and self.quantities == ("velocity_ratio",)

    def __call__(self, item: Item) -> list[Report] | Answer:
        # Cells of one system under one motion, or under records that chain, share a
        # run of the march.
        if not isinstance(item, list):
            return reference(self.scene, item)
        parts = [list(self.scene.cells_of(unit)) for unit in item]
        runs: dict[tuple[int | None, Hashable], list[SceneCells]] = {}
        for cells in chain.from_iterable(parts):
            if friction_that_slides(cells.structure) is None:
                system = self.scene.system_of(cells.structure)
                chained = self.shares_records and can_share_records(
                    system, cells.motion
                )
                motion = None if chained else id(cells.motion)
                key = motion, system.march_key(self.scene.mixed)
                runs.setdefault(key, []).append(cells)
        work, found = Work(), dict[int, CellValues]()
        for (motion, _), run in runs.items():
            blocks, own = self._computed(run, chained=motion is None)
            found |= zip(map(id, run), blocks, strict=True)
            work += own
        reports = []
        for unit, some in zip(item, parts, strict=True):
            at_places = (
                [self._of(s, cells, found.get(id(cells))) for s in cells.sharers]
                for cells in some
            )
            places = list(map(_joined, zip(*at_places, strict=True)))
            reports.append(self._report(unit, places, work))
            work = Work()  # the first unit reports that of all
        return reports

    def _computed(
        self, run: Sequence[SceneCells], chained: bool
    ) -> tuple[list[CellValues], Work]:
        """Return (the variables of all cells of a run, the work); chained: True if they
        may be under several records.
        """
        shaking = (
            np.concatenate([cells.amplitude for cells in run]),
            np.concatenate([cells.omega for cells in run]),
        )
        system, motion = self._system(run, self.scene.system_of), run[0].motion
        rate = None
        if chained:
            got, rate = _under_records(run, system, *shaking)
        elif "velocity_ratio" in self.quantities:
            got, rate = response_with_speed(system, motion, *shaking)
        elif self.one_by_one:
            alone = self.scene.method.system_of
            parts = [
                response(alone(s), motion, a, w, how="floats") for s, _, a, w, _ in run
            ]
            got = Response.joined(parts)
        else:
            got = response(system, motion, *shaking)
        whole: CellValues = got._asdict()
        del whole["work"]
        if rate is not None:
            whole["velocity_ratio"] = rate * _of_each_cell(
                run, lambda x: x.structure.alpha
            )
        if "linear" in self.quantities:
            linear = response(self._system(run, LINEAR.system_of), motion, *shaking)
            whole["theta_ratio_linear"] = linear.theta_ratio
            whole["outcome_linear"] = linear.outcome
            whole["difference"] = difference(got.outcome, linear.outcome)
        if "slide" in self.quantities:  # a body that rocks does not slide
            whole["slide_max"] = np.full(got.outcome.size, np.nan)
        return _split(whole, run), got.work

    @staticmethod
    def _system(
        run: Sequence[SceneCells], system_of: Callable[[RockingParameters], System]
    ) -> System:
        """Return the system of all cells of a run."""
        return System.of_each_cell(
            [system_of(cells.structure) for cells in run],
            [cells.omega.size for cells in run],
        )

    def _of(
        self, structure: RockingParameters, cells: SceneCells, block: CellValues | None
    ) -> CellValues:
        """Return the block of one structure among those that share the rotations of a
        block, with the lost contact of this structure; block: None if it slides.
        """
        if block is None:
            from .sliding_cells import sliding_block

            return sliding_block(structure, cells, self.quantities)
        if not self.scene.method.exact:  # the run has tested contact
            return block
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
        at = [
            (row - unit.row) * unit.shape[1] + column - unit.column
            for _, row, column in unit.wanted
        ]
        seen = zip(
            *(
                places[0][name][at].tolist()
                for name in ("outcome", "theta_ratio", "condition")
            ),
            strict=True,
        )
        outcomes = [np.bincount(x["outcome"], minlength=len(Outcome)) for x in places]
        differs = places[0].get("difference", np.zeros(0, np.uint8))
        return Report(
            work,
            np.sum(outcomes, axis=0),
            len(places) * np.bincount(differs, minlength=len(Difference)),
            tuple(data[id(x)] for x in places),
            tuple(Answer(Outcome(code), *numbers) for code, *numbers in seen),
        )


def _under_records(
    run: Sequence[SceneCells], system: System, amplitude: np.ndarray, omega: np.ndarray
) -> tuple[Response, np.ndarray]:
    """Return `response_under_records` of the cells of one system under several
    records.
    """
    motions = {id(cells.motion): cells.motion for cells in run}
    numbers = {key: i for i, key in enumerate(motions)}
    which = _of_each_cell(run, lambda cells: numbers[id(cells.motion)])
    return response_under_records(
        system, list(motions.values()), which, amplitude, omega
    )


def _of_each_cell(
    run: Sequence[SceneCells], get: Callable[[SceneCells], Any]
) -> np.ndarray:
    """Return a number for each cell of a run, the same for those of one structure."""
    return np.repeat(list(map(get, run)), [cells.omega.size for cells in run])


def _split(whole: CellValues, run: Sequence[SceneCells]) -> list[CellValues]:
    """Return the variables of each part of a run, from those of all its cells."""
    ends = np.cumsum([cells.omega.size for cells in run])
    parts = zip(*(np.split(x, ends[:-1]) for x in whole.values()), strict=True)
    return [dict(zip(whole, some, strict=True)) for some in parts]


def _joined(blocks: Sequence[CellValues]) -> CellValues:
    """Join the cells of several blocks; a single block is returned itself, since
    several places often share it.
    """
    if len(blocks) == 1:
        return blocks[0]
    return {name: np.concatenate([x[name] for x in blocks]) for name in blocks[0]}
