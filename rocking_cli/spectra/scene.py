"""What a sweep computes, and how it is cut into units of work. A unit is one chunk of the file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .grid import Grid

_SEED = 20120924


@dataclass(frozen=True, eq=False)
class Scene:
    """What a sweep computes: structures, grid, motion.

    Structures of equal restitution share one dimensionless spectrum, which is computed once (section 3.3 of the paper).
    Raises UsageError when a structure has no units but the grid does, or the scene holds no structure.
    """

    structures: tuple[RockingParameters, ...]
    grid: Grid
    motion: Motion

    def __post_init__(self) -> None:
        if not self.structures:
            raise UsageError("no structure: give a structure document, or a restitution for a dimensionless grid")
        for s in self.structures:
            if s.structure == "dimensionless" and not self.grid.dimensionless:
                raise UsageError("a restitution alone has no units: give a structure document, or axes A and Omega")

    @property
    def cells(self) -> int:
        """Cells of the result."""
        return len(self.structures) * self.grid.shape[0] * self.grid.shape[1]

    def sharing(self) -> list[tuple[int, ...]]:
        """Structures, by index, that share one computation."""
        if not self.grid.dimensionless:
            return [(i,) for i in range(len(self.structures))]
        groups: dict[float, list[int]] = {}
        for i, s in enumerate(self.structures):
            groups.setdefault(s.eta, []).append(i)
        return [tuple(g) for g in groups.values()]


@dataclass(frozen=True)
class Unit:
    """One unit of work: the structures it serves and its block of the grid."""

    structures: tuple[int, ...]
    row: int
    column: int


def chunk_shape(shape: tuple[int, int], cells: int) -> tuple[int, int]:
    """(rows, columns) of a unit of work of about `cells` cells: whole rows where they fit. Raises UsageError if cells < 1."""
    if cells < 1:
        raise UsageError(f"a unit of work has at least one cell, found {cells}")
    columns = min(shape[1], cells)
    return min(shape[0], max(1, cells // columns)), columns


def cut_into_units(scene: Scene, chunk: tuple[int, int]) -> Iterator[Unit]:
    rows, columns = scene.grid.shape
    for group in scene.sharing():
        for row in range(0, rows, chunk[0]):
            for column in range(0, columns, chunk[1]):
                yield Unit(group, row, column)


def sampled_cells(scene: Scene, check: int) -> np.ndarray:
    """(structure, row, column) of the cells to check: drawn without regard to units, among the cells that uplift."""
    if check < 1:
        return np.zeros((0, 3), dtype=np.int64)
    random = np.random.default_rng(_SEED)
    rows, columns = scene.grid.shape
    found: list[tuple[int, int, int]] = []
    owners = [group[0] for group in scene.sharing()]
    for _ in range(20 * check):
        i, r, c = owners[int(random.integers(len(owners)))], int(random.integers(rows)), int(random.integers(columns))
        amplitude = scene.grid.scaled(scene.structures[i])[0][c]
        if amplitude * scene.motion.peak > 1.0 and (i, r, c) not in found:
            found.append((i, r, c))
        if len(found) == check:
            break
    return np.array(found, dtype=np.int64).reshape(-1, 3)
