"""Checks of a sweep: some cells computed again by the reference, the condition of
cells, and a comparison of the two equations.

Half of the cells are drawn at random, half are those of high sensitivity. They depend
on the scene alone, not on workers or units.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.method import Method
from ..dynamics.outcome import Difference, Outcome, difference, falls, safe
from ..dynamics.response import Response, response
from ..structures.friction import friction_that_slides
from ..structures.parameters import RockingParameters
from .scene import PulseScene, Scene, Unit

Array = np.ndarray
Place = tuple[int, int, int]  # (structure, row, column) of a cell

_SEED = 20120924
_CANDIDATES = 128  # candidates for the most sensitive cells
# segments beyond which the search takes as long as a sweep, so that all cells are drawn
_LONGEST, _LONGEST_RECORD = (1000, 10_000)
_EXACT = 1e-10  # tolerance for an exact method, for the rounding of two solvers
# relative change of each input; the linear equation leaves the differences 8 digits
STEP = 1e-7
_ETA = 2
# of a method with a tolerance, the least change of input, so that its own error stays
# below the difference
_TOLERANCES = 100.0
_CELLS = 64  # number of cells that are compared with the nonlinear equation
_DRAWN = 512  # candidates for cells next to a boundary
_STRUCTURES = 4  # each structure costs a few further rounds
_SEED_OF_VALIDITY = 20120925


def condition_of(
    respond: Callable[[Array, Array, Array], Response],
    amplitude: Array,
    omega: Array,
    eta: Array,
    tolerance: float,
) -> Array:
    """Return the condition of cells (any shape, broadcast): the change of max
    |theta|/alpha over a small relative change of the input,

        kappa = |d theta/d ln A| + |d theta/d ln Omega| + |d theta/d ln eta|,
        theta = max |theta|/alpha        [-]

    by central differences over a relative 1e-7, or 100 times the tolerance of the
    method (0 of an exact one). respond: the response of arrays (A, Omega, eta). NaN if
    the cell or a cell of the differences overturned or failed; 0 below uplift. From
    about 1e5 on the difference is no derivative and no bound: a rotation that changes
    completely over 1e-7 may do so over 1e-12.
    """
    cells = np.broadcast_arrays(
        *(np.asarray(x, dtype=float) for x in (amplitude, omega, eta))
    )
    step = max(STEP, _TOLERANCES * tolerance)
    total = np.zeros(cells[0].shape)
    for i, values in enumerate(cells):
        ends = np.stack([values * (1.0 - step), values * (1.0 + step)])
        if i == _ETA:
            np.clip(ends, -1.0, 1.0, out=ends)
        shifted = [ends if j == i else np.stack([x, x]) for j, x in enumerate(cells)]
        found = respond(*shifted)
        still = safe(found.outcome).all(axis=0)
        width = np.abs(ends[1] - ends[0])
        rate = (
            np.abs(found.theta_ratio[1] - found.theta_ratio[0])
            * np.abs(values)
            / np.where(width == 0.0, np.inf, width)
        )
        total += np.where(still, rate, np.nan)
    return total


def default_check(scene: Scene) -> int:
    """Return the default number of cells to compute again: large sweeps spend under 3 %
    of their time on them.
    """
    return 4 if not scene.method.exact else max(4, min(64, scene.cells // 250_000))


def checked_cells(scene: Scene, check: int) -> Array:
    """Return (structure, row, column, True if chosen as sensitive) of the cells to
    check: half drawn, half the most sensitive of 128.
    """
    too_long = scene.segments > (_LONGEST_RECORD if scene.of_records else _LONGEST)
    chosen = sensitive_cells(scene, 0 if too_long else check // 2)
    drawn = sampled_cells(scene, check)
    twice = (drawn[:, None] == chosen[None]).all(axis=2).any(axis=1)
    drawn = drawn[~twice][: check - len(chosen)]
    flag = np.repeat([0, 1], [len(drawn), len(chosen)])
    return np.column_stack([np.concatenate([drawn, chosen]), flag])


def sampled_cells(scene: Scene, check: int, seed: int = _SEED) -> Array:
    """Return (structure, row, column) of `check` cells, drawn by chance from all cells
    that uplift.
    """
    _, rows, columns = scene.shape
    owners = [group[0] for group in scene.sharing()]
    uplift: dict[int, float] = {}  # amplitude of uplift of each structure

    def uplifts(at: Place) -> bool:
        cell = scene.cell(*at)
        if friction_that_slides(cell.structure) is not None:
            return False
        key = id(cell.structure)
        if key not in uplift:
            uplift[key] = _uplift_amplitude(scene, cell.structure)
        return cell.amplitude * cell.motion.largest > uplift[key]

    drawn = _drawn(seed, 20 * check, (len(owners), rows, columns)).tolist()
    # a small grid is drawn several times
    once = dict.fromkeys((owners[i], row, column) for i, row, column in drawn)
    found = list(islice(filter(uplifts, once), check))
    return np.array(found, dtype=np.int64).reshape(-1, 3)


def _uplift_amplitude(scene: Scene, structure: RockingParameters) -> float:
    """Return the least amplitude that lifts a structure, in the unit of the cells."""
    system = scene.method.system_of(structure)
    held = 1.0
    if system.devices is not None:
        held = float(np.min(system.devices.held_at_first()))
    return held * float(np.min(system.equation.uplift_amplitude))


def _drawn(seed: int, count: int, below: tuple[int, ...]) -> Array:
    """`count` rows of random whole numbers from 0, each column below a limit, by
    NumPy's generator whose stream never changes.
    """
    return (
        np.random.RandomState(seed).random_sample((count, len(below))) * below
    ).astype(np.int64)


def sensitive_cells(scene: Scene, count: int) -> Array:
    """Return (structure, row, column) of the `count` cells whose rotation changes most
    with A, among the 128 of `_candidates`.
    """
    drawn = _candidates(scene) if count else np.zeros((0, 3), dtype=np.int64)
    if not len(drawn):
        return drawn
    cells = [scene.cell(*at) for at in drawn.tolist()]
    structure, motion = cells[0].structure, cells[0].motion
    step = max(STEP, _TOLERANCES * (scene.method.stated_tolerance or 0.0))
    ends = np.array([[1.0 - step], [1.0 + step]])
    shifted = np.array([cell.amplitude for cell in cells]) * ends
    found = response(
        scene.method.system_of(structure),
        motion,
        shifted,
        np.array([cell.omega for cell in cells]),
        structure.eta,
    )
    change = np.abs(found.theta_ratio[1] - found.theta_ratio[0])
    change[(found.outcome != Outcome.ROCKED).any(axis=0)] = -1.0
    order = np.argsort(-change, kind="stable")[:count]
    return drawn[order[change[order] >= 0.0]]


def _candidates(scene: Scene) -> Array:
    """Return at most 128 cells of the least damped structure under one motion: drawn by
    chance, or one row of cells of one record.
    """
    if isinstance(scene, PulseScene):
        least_damped = max(
            (group[0] for group in scene.sharing()),
            key=lambda i: abs(scene.structures[i].eta),
        )
        drawn = sampled_cells(
            replace(scene, structures=(scene.structures[least_damped],)),
            _CANDIDATES,
            _SEED + 1,
        )
        drawn[:, 0] = least_damped
        return drawn
    one = sampled_cells(scene, 1, _SEED + 1)
    if not len(one):
        return one
    rocks = [
        i
        for i in range(scene.shape[1])
        if friction_that_slides(scene.structures[i]) is None
    ]
    row = max(rocks, key=lambda i: abs(scene.structures[i].eta))
    columns = (
        np.linspace(0, scene.shape[2] - 1, min(_CANDIDATES, scene.shape[2]))
        .round()
        .astype(np.int64)
    )
    return np.column_stack(
        [np.full(columns.size, one[0, 0]), np.full(columns.size, row), columns]
    )


class Answer(NamedTuple):
    """The reference answer for a cell."""

    outcome: Outcome  # by the reference
    theta_ratio: float  # by the reference [-]
    judged: Outcome | None  # outcome by the nonlinear equation, None if not compared


def reference(scene: Scene, place: Place) -> Answer:
    """Return the answer for a cell by the reference, which shares no code with the
    march.
    """
    cell = scene.cell(*place)
    outcome, theta = scene.method.reference_of(cell.structure)(
        *cell[1:], cell.structure.eta
    )
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
        rows, columns = chunk
        there = {(unit.places[0], unit.row, unit.column) for unit in units}
        found = checked_cells(scene, check).tolist() if units else []
        self.scene = scene
        # the places of these cells: True if one was chosen for its sensitivity, False
        # if it was drawn by chance
        self.sensitive = {
            (i, r, c): bool(flag)
            for i, r, c, flag in found
            if (i, r - r % rows, c - c % columns) in there
        }
        # (outcome, theta/alpha) that the sweep found at these places
        self.seen: dict[Place, tuple[int, float]] = {}
        self.answers: dict[Place, Answer] = {}  # those that the reference found

    def compared(self) -> Mapping[str, Any]:
        """Return the result of the comparison, by the fields of `Summary`."""
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
            "estimated_error": max(apart.values(), default=0.0),
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

    def _unexplained(self, place: Place, apart: float) -> bool:
        """True if a difference of theta/alpha exceeds the tolerance times max(1,
        condition of the cell); the condition is 1 if unknown.
        """
        method, cell = self.scene.method, self.scene.cell(*place)
        tolerance = method.stated_tolerance or _EXACT
        if not apart > tolerance:
            return False
        amplitude, omega, eta = (
            np.array([x]) for x in (cell.amplitude, cell.omega, cell.structure.eta)
        )
        respond = partial(response, method.system_of(cell.structure), cell.motion)
        (condition,) = condition_of(
            respond, amplitude, omega, eta, method.stated_tolerance or 0.0
        )
        return not apart <= tolerance * np.nanmax([1.0, condition])


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
    respond = partial(response, motion=scene.motion, eta=structure.eta, peaks=False)
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
