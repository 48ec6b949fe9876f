"""The cells that a sweep computes again by the slower path: some at random, some of high sensitivity.

They depend on the scene alone, not on the number of workers, the size of a unit or a resumed sweep.
"""

from __future__ import annotations

import numpy as np

from ...dynamics.outcome import Outcome
from ...dynamics.response import response
from ..scene import PulseScene, Scene
from .condition import STEP

Array = np.ndarray

_SEED = 20120924
_CANDIDATES = 128  # candidates for the most sensitive cells
_LONGEST, _LONGEST_RECORD = 1000, 10_000  # segments beyond which the search takes as long as a sweep, so that all cells are drawn


def default_check(scene: Scene) -> int:
    """The default number of cells to compute again: large sweeps spend under 3 % of their time on them."""
    return 4 if not scene.method.exact else max(4, min(64, scene.cells // 250_000))


def _too_long(scene: Scene) -> bool:
    return scene.segments > (_LONGEST_RECORD if scene.of_records else _LONGEST)


def checked_cells(scene: Scene, check: int) -> Array:
    """(structure, row, column, True if chosen as sensitive) of the cells to check: half of them drawn, half the most sensitive of 128."""
    if _too_long(scene):
        drawn = sampled_cells(scene, check)
        return np.column_stack([drawn, np.zeros(len(drawn), dtype=np.int64)])
    chosen = sensitive_cells(scene, check // 2)
    drawn = sampled_cells(scene, check)
    drawn = drawn[~(drawn[:, None] == chosen[None]).all(axis=2).any(axis=1)][: check - len(chosen)]
    flag = np.repeat([0, 1], [len(drawn), len(chosen)])
    return np.column_stack([np.concatenate([drawn, chosen]), flag])


def sampled_cells(scene: Scene, check: int, seed: int = _SEED) -> Array:
    """(structure, row, column) of cells drawn without regard to units, among those that uplift."""
    if check < 1:
        return np.zeros((0, 3), dtype=np.int64)
    _, rows, columns = scene.shape
    owners = [group[0] for group in scene.sharing()]
    drawn = _drawn(seed, 20 * check, (len(owners), rows, columns))
    found: list[tuple[int, int, int]] = []
    seen: set[tuple[int, int, int]] = set()  # a small grid is drawn several times
    lifts: dict[int, float] = {}
    for owner, r, c in drawn.tolist():
        at = owners[owner], r, c
        if at in seen:
            continue
        seen.add(at)
        cell = scene.cell(*at)
        kind = id(cell.structure)
        if kind not in lifts:
            lifts[kind] = float(np.min(scene.method.system_of(cell.structure).equation.uplift_amplitude))
        if cell.amplitude * cell.motion.peak > lifts[kind]:
            found.append(at)
        if len(found) == check:
            break
    return np.array(found, dtype=np.int64).reshape(-1, 3)


def _drawn(seed: int, count: int, below: tuple[int, ...]) -> Array:
    """`count` rows of random whole numbers from 0, each column below a limit of up to 2^32, by SplitMix64 (Steele, Lea and Flood 2014);
    the import of numpy.random takes longer than a small sweep."""
    with np.errstate(over="ignore"):
        z = np.uint64(seed) + np.arange(1, count * len(below) + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        upper = ((z ^ (z >> np.uint64(31))) >> np.uint64(32)).reshape(count, -1)  # its upper half, a fraction of 2^32
    return (upper * np.array(below, dtype=np.uint64) >> np.uint64(32)).astype(np.int64)


def sensitive_cells(scene: Scene, count: int) -> Array:
    """(structure, row, column) of the cells whose rotation changes most with A, among 128 candidates of the least damped structure."""
    drawn = _candidates(scene) if count else np.zeros((0, 3), dtype=np.int64)
    if not len(drawn):
        return drawn
    cells = [scene.cell(*at) for at in drawn.tolist()]
    structure, motion = cells[0].structure, cells[0].motion
    step = max(STEP, 100.0 * (scene.method.stated_tolerance or 0.0))
    beside = np.array([cell.amplitude for cell in cells]) * np.array([[1.0 - step], [1.0 + step]])
    found = response(scene.method.system_of(structure), motion, beside, np.array([cell.omega for cell in cells]), structure.eta)
    change = np.abs(found.theta_ratio[1] - found.theta_ratio[0])
    change[(found.outcome != Outcome.ROCKED).any(axis=0)] = -1.0
    order = np.argsort(-change, kind="stable")[:count]
    return drawn[order[change[order] >= 0.0]]


def _candidates(scene: Scene) -> Array:
    """At most 128 cells of the least damped structure under one motion: drawn, or one row of one record."""
    if isinstance(scene, PulseScene):
        liveliest = max((group[0] for group in scene.sharing()), key=lambda i: abs(scene.structures[i].eta))
        drawn = sampled_cells(PulseScene((scene.structures[liveliest],), scene.grid, scene.motion, scene.method), _CANDIDATES, _SEED + 1)
        drawn[:, 0] = liveliest
        return drawn
    one = sampled_cells(scene, 1, _SEED + 1)
    if not len(one):
        return one
    row = max(range(scene.shape[1]), key=lambda i: abs(scene.structures[i].eta))
    columns = np.linspace(0, scene.shape[2] - 1, min(_CANDIDATES, scene.shape[2])).round().astype(np.int64)
    return np.column_stack([np.full(columns.size, one[0, 0]), np.full(columns.size, row), columns])
