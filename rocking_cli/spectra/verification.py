"""Checks of a sweep: some cells computed again by the reference, and a comparison of
the two equations.

Half of the cells are drawn at random, half are those of high sensitivity: of 128 drawn
cells the ones whose rotation differs most from that of the next cell of the grid. A
single cell is of the latter, since it tells a rotation too. They depend on the scene
and its shard alone, not on workers or units.
"""

import math
import random
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.method import Method
from ..dynamics.outcome import Difference, Outcome, difference, falls
from ..dynamics.response import response
from ..structures.friction import friction_that_slides
from ..structures.parameters import RockingParameters
from .error_bound import tolerance_of
from .scene import PulseScene, Scene, Unit

CellPlace = tuple[int, int, int]  # (structure, row, column) of a cell

_SEED = 20120924
_CANDIDATES = 128  # candidates for the most sensitive cells
_DRAWS = 20  # draws for each cell that is wanted: of many scenes half the cells lift
# numbers of cells of a sweep below which two or four are checked, for the time that
# they take
_SMALL, _MIDDLE = (1_000, 5_000)
_CELLS = 64  # number of cells that are compared with the nonlinear equation
_DRAWN = 512  # candidates for cells next to a boundary
_STRUCTURES = 4  # each structure costs a few further rounds
_SEED_OF_VALIDITY = 20120925


def default_check(scene: Scene) -> int:
    """Return the default number of cells to compute again: 2 of a small sweep and up
    to 64 of a large one.
    """
    if scene.cells < _MIDDLE:
        return 2 if scene.cells < _SMALL else 4
    return 8 if not scene.method.exact else max(8, min(64, scene.cells // 250_000))


def sampled_cells(
    scene: Scene,
    check: int,
    seed: int = _SEED,
    share: float = 1.0,
    there: Callable[[CellPlace], bool] = lambda place: True,
) -> Array:
    """Return (structure, row, column) of `check` cells, drawn by chance from all cells
    that uplift. there: True for the cells to draw from, which are this share of all.
    """
    uplift: dict[int, float] = {}  # amplitude of uplift of each structure

    def uplifts(at: CellPlace) -> bool:
        cell = scene.cell(*at)
        if friction_that_slides(cell.structure) is not None:
            return False
        key = id(cell.structure)
        if key not in uplift:
            uplift[key] = _uplift_amplitude(scene, cell.structure)
        return cell.amplitude * cell.motion.largest > uplift[key]

    count = math.ceil(_DRAWS * check / share)
    drawn = filter(there, _drawn(scene, count, seed))
    found = list(islice(filter(uplifts, drawn), check))
    return np.array(found, dtype=np.int64).reshape(-1, 3)


def _drawn(scene: Scene, count: int, seed: int) -> Iterator[CellPlace]:
    """Yield the places of so many draws from all cells that are computed, each place
    once; a small grid is drawn several times.
    """
    _, rows, columns = scene.shape
    owners = [group[0] for group in scene.sharing()]
    draw = _stream(seed)
    places = (
        (
            owners[int(draw() * len(owners))],
            int(draw() * rows),
            int(draw() * columns),
        )
        for _ in range(count)
    )
    once: set[CellPlace] = set()
    for place in places:
        if place not in once:
            once.add(place)
            yield place


def _stream(seed: int) -> Callable[[], float]:
    """Return a function that draws numbers from 0 to 1: those of NumPy's `RandomState`,
    whose stream never changes, without the import of `numpy.random`, which takes as
    long as a sweep of a thousand cells.
    """
    state = [seed]  # of the Mersenne twister, by its first seeding
    for i in range(1, 624):
        state.append((1812433253 * (state[-1] ^ (state[-1] >> 30)) + i) % 2**32)
    generator = random.Random()
    generator.setstate((3, (*state, 624), None))
    return generator.random


def _uplift_amplitude(scene: Scene, structure: RockingParameters) -> float:
    """Return the least amplitude that lifts a structure, in the unit of the cells."""
    system = scene.method.system_of(structure)
    held = 1.0
    if system.devices is not None:
        held = float(np.min(system.devices.held_at_first()))
    return held * float(np.min(system.equation.uplift_amplitude))


class Answer(NamedTuple):
    """The reference answer for a cell."""

    outcome: Outcome  # by the reference
    theta_ratio: float  # by the reference [-]
    judged: Outcome | None  # outcome by the nonlinear equation, None if not compared


def reference(scene: Scene, place: CellPlace) -> Answer:
    """Return the answer for a cell by the reference, which shares no code with the
    march.
    """
    cell = scene.cell(*place)
    outcome, theta = scene.method.reference_of(cell.structure)(*cell[1:])
    return Answer(
        outcome, theta, None if outcome == Outcome.FAILED else scene.judge_of(cell)
    )


class Verification:
    """The cells of some units of work that the reference computes again. chunk: (rows,
    columns) of a unit.
    """

    def __init__(
        self, scene: Scene, check: int, chunk: tuple[int, int], units: Sequence[Unit]
    ) -> None:
        self.scene = scene
        self.chunk = chunk
        # (outcome, theta/alpha, condition) that the sweep found at `wanted`
        self.seen: dict[CellPlace, tuple[int, float, float]] = {}
        # the places that are checked: True if one was chosen for its sensitivity, False
        # if it was drawn by chance
        self.sensitive: dict[CellPlace, bool] = {}
        self.answers: dict[CellPlace, Answer] = {}  # those that the reference found
        self.seconds = 0.0  # time that the checks took [s]
        with self._timed():
            self._units = {(unit.places[0], unit.row, unit.column) for unit in units}
            rows, columns = (
                -(-n // c) for n, c in zip(scene.shape[1:], chunk, strict=True)
            )
            share = len(units) / (len(scene.sharing()) * rows * columns)
            self.check = math.ceil(check * share)
            self._drawn = self._cells_drawn(share) if self.check else []
            pairs = self._pairs() if self.check else []
            self._candidates = pairs  # cells, and the cells next to them
            places = {*self._drawn, *(place for pair in pairs for place in pair)}
            # the places of each unit whose results are needed, by its first cell
            self.wanted: dict[CellPlace, list[CellPlace]] = {}
            for place in sorted(places):
                self.wanted.setdefault(self._unit_of(place), []).append(place)

    def _cells_drawn(self, share: float) -> list[CellPlace]:
        """Return the cells that are drawn by chance, as many as are checked."""

        def there(place: CellPlace) -> bool:
            return self._unit_of(place) in self._units

        found = sampled_cells(self.scene, self.check, share=share, there=there)
        return [(i, row, column) for i, row, column in found.tolist()]

    def _unit_of(self, place: CellPlace) -> CellPlace:
        """Return the first cell of the unit that holds a place."""
        i, row, column = place
        return i, row - row % self.chunk[0], column - column % self.chunk[1]

    def _pairs(self) -> list[tuple[CellPlace, CellPlace]]:
        """Return candidates for the most sensitive cells, each with the next cell along
        the last dimension, or along the second of a grid of one column.
        """
        _, rows, columns = self.scene.shape
        pairs = []
        for place in _drawn(self.scene, max(_CANDIDATES, self.check), _SEED + 1):
            i, row, column = place
            if columns > 1:
                other = (i, row, column + 1 if column + 1 < columns else column - 1)
            elif rows > 1:
                other = (i, row + 1 if row + 1 < rows else row - 1, column)
            else:
                continue
            if {self._unit_of(place), self._unit_of(other)} <= self._units:
                pairs.append((place, other))
        return pairs

    @contextmanager
    def _timed(self) -> Iterator[None]:
        """Context whose time counts as that of the checks."""
        began = time.perf_counter()
        yield
        self.seconds += time.perf_counter() - began

    def ask(self, run: Callable[[Iterable[CellPlace]], Iterator[Answer]]) -> None:
        """Choose the cells to check from what the sweep has found, and let `run` answer
        them by the reference.
        """
        with self._timed():
            chosen = dict.fromkeys(self._most_sensitive(), True)
            drawn = [place for place in self._drawn if place not in chosen]
            drawn = drawn[: self.check - len(chosen)]
            self.sensitive = dict.fromkeys(drawn, False) | chosen
            self.answers = dict(zip(self.sensitive, run(self.sensitive), strict=True))

    def _most_sensitive(self) -> list[CellPlace]:
        """Return half as many candidates as are checked, at least one: those whose
        rotation differs most from that of the next cell.
        """
        changes: dict[CellPlace, float] = {}
        for place, other in self._candidates:
            (outcome, theta, _), (beside, next_theta, _) = (
                self.seen[place],
                self.seen[other],
            )
            if outcome == beside == Outcome.ROCKED:
                changes[place] = abs(theta - next_theta)
        order = sorted(changes, key=lambda place: -changes[place])
        return order[: max(1, self.check // 2)]

    def compared(self) -> Mapping[str, Any]:
        """Return the result of the comparison, by the fields of `Summary`."""
        with self._timed():
            found = self._compared()
        return {**found, "check_time": self.seconds}

    def _compared(self) -> dict[str, Any]:
        """Return the fields of the comparison without its time."""
        # Answers that the reference has, those with the outcome of the sweep, and by
        # how much theta/alpha of these differs.
        known = {
            place: answer
            for place, answer in self.answers.items()
            if answer.outcome != Outcome.FAILED
        }
        same = {
            place: answer
            for place, answer in known.items()
            if answer.outcome == self.seen[place][0]
        }
        apart = {
            place: abs(a.theta_ratio - self.seen[place][1])
            for place, a in same.items()
            if np.isfinite(a.theta_ratio)
        }
        judged = [(a.outcome, a.judged) for a in known.values() if a.judged is not None]
        return {
            "largest_difference": max(apart.values(), default=0.0),
            "misjudged": len(known) - len(same),
            "checked_cells": len(known),
            "sensitive_cells": sum(self.sensitive[place] for place in known),
            "compared": len(judged),
            "differing": sum(
                one.overturned != other.overturned for one, other in judged
            ),
            "beyond_tolerance": sum(
                self._unexplained(place, far) for place, far in apart.items()
            ),
        }

    def _unexplained(self, place: CellPlace, apart: float) -> bool:
        """True if a difference of theta/alpha exceeds the bound of the cell."""
        bound = tolerance_of(self.scene.method) * self.seen[place][2]
        return not apart <= bound


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
    judged = [
        _differences(replace(scene, structures=(one,)), nonlinear, _CELLS // count)
        for one in some
    ]
    codes = np.concatenate([np.zeros(0, np.uint8), *judged])
    codes = codes[codes != Difference.NOT_COMPUTED]
    if not codes.size:
        return None
    return Validity(
        codes.size,
        int(np.count_nonzero(codes != Difference.AGREES)),
        int(np.count_nonzero(codes == Difference.LINEAR_UNSAFE)),
    )


def _differences(scene: PulseScene, nonlinear: Method, count: int) -> Array:
    """Return the `Difference` of up to `count` cells of one structure: half drawn, half
    with another outcome at the next amplitude.
    """
    (structure,) = scene.structures
    drawn = sampled_cells(scene, _DRAWN, _SEED_OF_VALIDITY)[:, 1:]
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
    near = np.flatnonzero(changes)[: count // 2]
    at = np.append(near, np.setdiff1d(np.arange(len(drawn)), near)[: count - near.size])
    decided = respond(
        nonlinear.system_of(structure),
        amplitude=amplitude[drawn[at, 1]],
        omega=omega[drawn[at, 0]],
    )
    return difference(decided.outcome, linear[0][at])
