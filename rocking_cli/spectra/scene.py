"""What a sweep computes, and how it is cut into units of work. A unit is one chunk of the file."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from .. import __version__
from ..dynamics.method import LINEAR, Method
from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .grid import Grid

QUANTITIES = ("condition",)  # what may be computed beside theta_ratio, outcome and impacts


@dataclass(frozen=True, eq=False)
class Scene:
    """What a sweep computes: structures, grid, motion, and the equation of motion.

    Structures of equal restitution share one dimensionless linear spectrum, which is computed once (section 3.3 of the paper).
    Raises UsageError when a structure has no units but the grid does, or the scene holds no structure.
    """

    structures: tuple[RockingParameters, ...]
    grid: Grid
    motion: Motion
    method: Method = LINEAR

    def __post_init__(self) -> None:
        if not self.structures:
            raise UsageError("no structure: give a structure document, or a restitution for a dimensionless grid")
        for s in self.structures:
            if s.dimensionless and not self.grid.dimensionless:
                raise UsageError("a restitution alone has no units: give a structure document, or axes A and Omega")
            self.method.system_of(s)
            with np.errstate(all="ignore"):
                amplitude, omega = self.grid.scaled(s)
            if not (np.all(np.isfinite(amplitude)) and np.all(np.isfinite(omega)) and np.all(omega > 0.0)):
                raise UsageError(f"{s.name}: the grid in units of this structure (A, Omega) leaves the range of double precision")

    @property
    def cells(self) -> int:
        """Cells of the result."""
        return len(self.structures) * self.grid.shape[0] * self.grid.shape[1]

    def identity(self) -> dict[str, Any]:
        """What the result depends on, by name, as JSON values; two scenes of equal identity have equal spectra."""
        return {
            "version": __version__,
            "structures": [json.loads(json.dumps(s.record())) for s in self.structures],
            **{f"axis {axis.name}": axis.stated() for axis in (self.grid.frequency, self.grid.amplitude)},
            "motion": [self.motion.name, [json.loads(json.dumps(asdict(piece))) for piece in self.motion.pieces]],
            "model": self.method.model,
            "tolerance": self.method.stated_tolerance,
        }

    @property
    def one_system(self) -> bool:
        """Whether all structures are one system, but for their restitution."""
        return len({self.method.shares(s) for s in self.structures}) == 1

    def sharing(self) -> list[tuple[int, ...]]:
        """Structures, by index, that share one computation."""
        if not self.grid.dimensionless:
            return [(i,) for i in range(len(self.structures))]
        groups: dict[tuple[Any, ...], list[int]] = {}
        for i, s in enumerate(self.structures):
            groups.setdefault((s.eta, *self.method.shares(s)), []).append(i)
        return [tuple(g) for g in groups.values()]


def known_quantities(names: Sequence[str]) -> tuple[str, ...]:
    """These names of QUANTITIES, each once, in their own order. Raises UsageError for another."""
    for name in names:
        if name not in QUANTITIES:
            raise UsageError(f"unknown quantity {name!r}, accepted {'is' if len(QUANTITIES) == 1 else 'are'} {', '.join(QUANTITIES)}")
    return tuple(name for name in QUANTITIES if name in names)


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
