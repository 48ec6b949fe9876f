"""The options of a sweep: its computation and its file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..errors import UsageError
from ..processes import available_cpus
from .scene import Scene
from .variables import QUANTITIES, VARIABLES

CHUNK_CELLS = 131072
SMALL_SWEEP = 100_000  # cells below which starting processes takes longer than they save

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class SweepOptions:
    """Options of a sweep, checked at construction.

    workers: processes, None for all cores; scheduler: address of a dask.distributed cluster to compute on instead; chunk_cells: cells
    in one unit of work; check: cells computed again by the reference, None for a few; quantities: names of `QUANTITIES` to compute as
    well; sample_validity: compare some cells of a linear sweep with the nonlinear equation; progress: called with (units done, units);
    tell: called with a line while the sweep waits for its cluster.

    Of a file: impacts: store their number; overwrite: replace an output; resume: continue the partial file PATH.part of an
    interrupted sweep of the same scene; strict: refuse one of a machine whose results may differ in the last digits; shard: (i, n)
    computes the i-th of n parts, for `merge`; documents, history: texts to keep.

    Raises UsageError.
    """

    workers: int | None = None
    scheduler: str | None = None
    chunk_cells: int = CHUNK_CELLS
    check: int | None = None
    quantities: Sequence[str] = ()
    sample_validity: bool = False
    progress: Progress | None = None
    tell: Callable[[str], None] | None = None
    impacts: bool = False
    overwrite: bool = False
    resume: bool = False
    strict: bool = False
    shard: tuple[int, int] | None = None
    documents: str = ""
    history: str = ""

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 1:
            raise UsageError(f"workers is {self.workers}; it must be a whole number from 1")
        if self.chunk_cells < 1:
            raise UsageError(f"a unit of work: found {self.chunk_cells} cells; expected one or more")
        for name in self.quantities:
            if name not in QUANTITIES:
                raise UsageError(f"unknown quantity {name!r}; expected {', '.join(QUANTITIES)}")
        if self.resume and self.overwrite:
            raise UsageError("`resume` does not go with `overwrite`")

    def processes(self, scene: Scene) -> int:
        """The number of processes for a scene: `workers` if given, otherwise one for a small scene."""
        return self.workers or (1 if scene.cells < SMALL_SWEEP else available_cpus())

    def chunk(self, scene: Scene) -> tuple[int, int]:
        """(rows, columns) of a unit of work: whole rows if they fit."""
        _, rows, columns = scene.shape
        width = min(columns, self.chunk_cells)
        return min(rows, max(1, self.chunk_cells // width)), width

    def quantities_of(self, scene: Scene) -> tuple[str, ...]:
        """The quantities to compute, in the order of `QUANTITIES`: the requested ones, and those that the scene always has.

        Raises UsageError if one is not defined for the scene.
        """
        found = tuple(name for name in QUANTITIES if name in (*self.quantities, *scene.quantities))
        if "velocity_ratio" in found and not scene.of_records:
            raise UsageError("quantity velocity_ratio: found the sweep of a pulse; expected a sweep of records")
        if "friction" in found or "fz_min" in found:
            _demand_bodies(scene)
        if "linear" in found and scene.method.exact:
            raise UsageError("quantity linear: compares with the nonlinear equation; `model` must be nonlinear")
        return found

    def variables_of(self, scene: Scene) -> tuple[str, ...]:
        """The variables in the file of a scene, in the order of `VARIABLES`. Raises UsageError as `quantities_of`."""
        of_quantities = {name for key in self.quantities_of(scene) for name in QUANTITIES[key]}
        wanted = {"theta_ratio", "outcome", *of_quantities} | ({"impacts"} if self.impacts else set())
        return tuple(name for name in VARIABLES if name in wanted)


def _demand_bodies(scene: Scene) -> None:
    """Raise UsageError if friction or fz_min is not defined for a structure, or structures share rotations but not forces."""
    bodies = [scene.method.body_of(s) for s in scene.structures]
    for s, body in zip(scene.structures, bodies, strict=True):
        if body is None:
            raise UsageError(f"{s.name}: quantities friction and fz_min: the structure must be a rigid body whose arm is known")
        if not body.moves_with_the_ground:
            raise UsageError(
                f"{s.name}: quantities friction and fz_min: found a_scale {s.a_scale:.6g}; it must be 1, of an uplift at alpha"
            )
    for first, *others in () if scene.of_records else scene.sharing():
        for i in others:
            if bodies[i] != bodies[first]:
                name = scene.structures[i].name
                raise UsageError(f"{name}: shares its rotations with another structure, but not its forces; sweep them apart")
