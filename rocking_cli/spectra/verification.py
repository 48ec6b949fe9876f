"""Checks of a sweep: some cells computed again by the reference, and a comparison of
the two equations.

Cells are drawn by chance, each with the next cell of the grid. Of the cells to check
a quarter are those whose rotation differs most from that of the next cell. Half have
another outcome than the next cell: a bound or a proof (Lemmas 6 to 8) ends nearly every
cell, and there it decided by the least margin. The others lift off. They depend on the
scene and its shard alone, not on workers or units.
"""

import math
import random
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, islice
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.method import Method
from ..dynamics.outcome import Difference, Outcome, difference, falls
from ..dynamics.response import cheaper, response
from ..structures.friction import friction_that_slides
from .error_bound import tolerance_of
from .scene import CellPlace, PulseScene, Scene, Unit

_SEED = 2
_REFERENCE = 1e-12  # of theta/alpha: what the reference itself may be off
_LEAST = 256  # draws at the least
_MOST = 100_000  # draws at the most, where few units of a sweep are left
# draws for each cell that is wanted: of many scenes half the cells lift, and of one in
# twenty the next cell has another outcome
_DRAWS = 32
# numbers of cells of a sweep below which two or four are checked, for the time that
# they take
_SMALL, _MIDDLE = (1_000, 5_000)
_CELLS = 64  # number of cells that are compared with the nonlinear equation
_DRAWN = 1024  # draws, among which cells next to a boundary are looked for
_STRUCTURES = 4  # each structure costs a few further rounds


def default_check(scene: Scene) -> int:
    """Return the default number of cells to compute again: 2 of a small sweep and up
    to 64 of a large one.
    """
    if scene.cells < _MIDDLE:
        return 2 if scene.cells < _SMALL else 4
    return 8 if not scene.method.exact else max(8, min(64, scene.cells // 250_000))


def drawn_cells(scene: Scene, count: int, seed: int = _SEED) -> list[CellPlace]:
    """Return the places of so many draws from all cells that are computed, each place
    once.
    """
    _, rows, columns = scene.shape
    owners = [group[0] for group in scene.sharing()]
    draw = random.Random(seed).random
    places = (
        (owners[int(draw() * len(owners))], int(draw() * rows), int(draw() * columns))
        for _ in range(count)
    )
    return list(dict.fromkeys(places))


class Answer(NamedTuple):
    """What a sweep, or the reference, found at a cell."""

    outcome: Outcome  # what became of the body
    theta_ratio: float  # largest |theta|/alpha [-]
    condition: float = math.nan  # of theta_ratio [-], by the sweep
    # outcome by the nonlinear equation, None if not compared
    judged: Outcome | None = None


def reference(scene: Scene, place: CellPlace) -> Answer:
    """Return the answer for a cell by the reference, which shares no code with the
    march; of a linear sweep of records also the outcome by the nonlinear equation.
    """
    cell = scene.cell(*place)
    numbers = cell.amplitude.item(), cell.omega.item()
    outcome, theta = scene.method.reference_of(cell.structure)(cell.motion, *numbers)
    nonlinear, judged = Method("nonlinear"), None
    linear = scene.of_records and scene.method.exact and outcome != Outcome.FAILED
    if linear and nonlinear.serves(cell.structure):
        system = nonlinear.system_of(cell.structure)
        how, at = cheaper(system, cell.motion, 1), (cell.amplitude, cell.omega)
        found = response(system, cell.motion, *at, peaks=False, how=how)
        judged = Outcome(int(found.outcome[0]))
    return Answer(outcome, theta, judged=judged)


class Verification:
    """The cells of some of `every` units of work that the reference computes again.
    chunk: (rows, columns) of a unit.
    """

    def __init__(
        self,
        scene: Scene,
        check: int,
        chunk: tuple[int, int],
        units: Sequence[Unit],
        every: int,
    ) -> None:
        self.scene, self.chunk = scene, chunk
        # what the sweep found at the wanted cells of the units
        self.seen: dict[CellPlace, Answer] = {}
        self.sensitive: list[CellPlace] = []  # checked for their sensitivity
        self.answers: dict[CellPlace, Answer] = {}  # those of the reference
        self.seconds = 0.0  # time that the checks took [s]
        self.check = math.ceil(check * len(units) / every)
        least = _DRAWS * self.check
        count = max(_LEAST, least) * every // max(1, len(units)) if check else 0
        mine = {unit.first for unit in units}
        # drawn cells of these units, each with the next cell
        self._beside = {
            place: beside if self._unit_of(beside) in mine else place
            for place in drawn_cells(scene, min(count, max(_MOST, least)))
            if self._unit_of(place) in mine
            for beside in [self._next_to(place)]
        }
        wanted: dict[CellPlace, list[CellPlace]] = {}
        for place in sorted({*self._beside, *self._beside.values()}):
            wanted.setdefault(self._unit_of(place), []).append(place)
        self.units = [
            replace(unit, wanted=tuple(wanted.get(unit.first, ()))) for unit in units
        ]

    def _unit_of(self, place: CellPlace) -> CellPlace:
        """Return the first cell of the unit that holds a place."""
        i, row, column = place
        return i, row - row % self.chunk[0], column - column % self.chunk[1]

    def _next_to(self, place: CellPlace) -> CellPlace:
        """Return the next cell along the last dimension, or along the second of a grid
        of one column.
        """
        i, row, column = place
        _, rows, columns = self.scene.shape
        if columns > 1:
            return i, row, column + 1 if column + 1 < columns else column - 1
        return i, row + 1 if row + 1 < rows else max(row - 1, 0), column

    def ask(self, run: Callable[[Iterable[CellPlace]], Iterator[Answer]]) -> None:
        """Choose the cells to check from what the sweep has found, and let `run` answer
        them by the reference.
        """
        began = time.perf_counter()
        self.sensitive = self._most_sensitive()
        decided = islice(self._decided(), self.check // 2)
        chosen = chain(self.sensitive, decided, filter(self._lifts, self._beside))
        places = list(islice(dict.fromkeys(chosen), self.check))
        self.answers = dict(zip(places, run(places), strict=True))
        self.seconds = time.perf_counter() - began

    def _most_sensitive(self) -> list[CellPlace]:
        """Return a quarter of the cells to check, at least one: those whose rotation
        differs most from that of the next cell.
        """
        changes = {}
        for place, beside in self._beside.items():
            one, other = self.seen[place], self.seen[beside]
            if one.outcome == other.outcome == Outcome.ROCKED and place != beside:
                changes[place] = abs(one.theta_ratio - other.theta_ratio)
        order = sorted(changes, key=lambda place: -changes[place])
        return order[: max(1, self.check // 4)]

    def _decided(self) -> Iterator[CellPlace]:
        """Yield one of each two cells whose outcomes differ, in turn the one that
        stands, if only one does, and the other one.
        """
        found = 0
        for pair in self._beside.items():
            one, other = (self.seen[place].outcome for place in pair)
            if one != other and all(map(self._lifts, pair)):
                yield pair[(found + one.falls) % 2]
                found += 1

    def _lifts(self, place: CellPlace) -> bool:
        """True for a cell whose body leaves the ground, and does not slide."""
        return (
            self.seen[place].outcome != Outcome.NO_UPLIFT
            and friction_that_slides(self.scene.cell(*place).structure) is None
        )

    def compared(self) -> Mapping[str, Any]:
        """Return the result of the comparison, by the fields of `Summary`."""
        known = {
            place: answer
            for place, answer in self.answers.items()
            if answer.outcome != Outcome.FAILED
        }
        pairs = [(answer, self.seen[place]) for place, answer in known.items()]
        same = [(one, seen) for one, seen in pairs if one.outcome == seen.outcome]
        # By how much theta/alpha differs, and what the sweep says that it may.
        tolerance = tolerance_of(self.scene.method)
        apart = [
            (far, max(_REFERENCE, tolerance * seen.condition))
            for one, seen in same
            if np.isfinite(far := abs(one.theta_ratio - seen.theta_ratio))
        ]
        judged = [(a.outcome, a.judged) for a in known.values() if a.judged is not None]
        return {
            "largest_difference": max((far for far, _ in apart), default=0.0),
            "misjudged": len(pairs) - len(same),
            "checked_cells": len(pairs),
            "sensitive_cells": sum(place in known for place in self.sensitive),
            "compared": len(judged),
            "differing": sum(
                one.overturned != other.overturned for one, other in judged
            ),
            # A condition of NaN bounds nothing.
            "beyond_tolerance": sum(not far <= bound for far, bound in apart),
            "check_time": self.seconds,
        }


@dataclass(frozen=True)
class Validity:
    """The linear equation against the nonlinear one, in numbers of cells."""

    sampled: int  # computed by both equations
    differ: int  # with different outcomes
    unsafe: int  # with a body that falls, but stands by the linear equation


def validity(scene: Scene, tolerance: float = 1e-6) -> Validity | None:
    """Compare some cells of a linear sweep under a pulse with the nonlinear equation;
    None if that equation holds for no structure, or if no cell uplifts. tolerance: that
    of the nonlinear equation.
    """
    nonlinear = Method("nonlinear", tolerance)
    if not (isinstance(scene, PulseScene) and scene.method.exact):
        return None
    known = [
        s
        for s in scene.structures
        if nonlinear.serves(s) and friction_that_slides(s) is None
    ]
    count = min(_STRUCTURES, len(known))
    some = [known[i] for i in np.linspace(0, len(known) - 1, count).astype(int)]
    codes = [
        code
        for one in some
        for code in _differences(
            replace(scene, structures=(one,)), nonlinear, _CELLS // count
        )
        if code != Difference.NOT_COMPUTED
    ]
    differ = sum(code != Difference.AGREES for code in codes)
    unsafe = codes.count(Difference.LINEAR_UNSAFE)
    return Validity(len(codes), differ, unsafe) if codes else None


def _differences(scene: PulseScene, nonlinear: Method, count: int) -> list[int]:
    """Return the `Difference` of up to `count` cells of one structure that lift: half
    drawn, half with another outcome at the next amplitude.
    """
    (structure,) = scene.structures
    drawn = np.array(drawn_cells(scene, _DRAWN))[:, 1:]
    amplitude, omega = scene.grid.scaled(structure)
    neighbours = np.stack(
        [drawn[:, 1], np.minimum(drawn[:, 1] + 1, amplitude.size - 1)]
    )
    respond = partial(response, motion=scene.motion, peaks=False)
    linear = respond(
        scene.method.system_of(structure),
        amplitude=amplitude[neighbours],
        omega=omega[drawn[:, 0]],
    ).outcome
    changes = falls(linear[0]) != falls(linear[1])
    lifts = linear[0] != Outcome.NO_UPLIFT
    near = np.flatnonzero(changes & lifts)[: count // 2]
    others = np.setdiff1d(np.flatnonzero(lifts), near)
    at = np.append(near, others[: count - near.size])
    decided = respond(
        nonlinear.system_of(structure),
        amplitude=amplitude[drawn[at, 1]],
        omega=omega[drawn[at, 0]],
    )
    codes: list[int] = difference(decided.outcome, linear[0][at]).tolist()
    return codes
