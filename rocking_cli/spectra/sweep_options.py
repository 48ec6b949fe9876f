"""The options of a sweep."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..errors import UsageError
from ..processes import available_cpus
from .dimensions import QUANTITIES, VARIABLES
from .scene import Scene

CHUNK_CELLS = 131072
_SMALL = 100_000  # cells below which starting processes takes longer than they save


@dataclass(frozen=True)
class SweepOptions:
    """Options of a sweep, checked at construction; those from `impacts` on are for the
    file of `write_spectrum`. Raises UsageError.
    """

    workers: int | None = None  # number of processes, None for all cores
    # address of a dask.distributed cluster that computes instead
    scheduler: str | None = None
    chunk_cells: int = CHUNK_CELLS  # number of cells in one unit of work
    # number of cells to compute again by the reference, None for a few
    check: int | None = None
    quantities: Sequence[str] = ()  # names of `QUANTITIES` to compute as well
    # compare some cells of a linear sweep with the nonlinear equation
    sample_validity: bool = False
    progress: Callable[[int, int], None] | None = (
        None  # called with (units done, all units)
    )
    # called with a line while the sweep waits for its cluster
    tell: Callable[[str], None] | None = None
    impacts: bool = False  # store impacts_at_least
    overwrite: bool = False  # replace an existing output
    # continue the partial file PATH.part of an interrupted sweep of the same scene
    resume: bool = False
    # refuse a partial file that another machine began whose results may differ in the
    # last digits
    strict: bool = False
    # (i, n): compute the i-th of n parts, for `merge`
    shard: tuple[int, int] | None = None
    documents: str = ""  # text to store in the file
    history: str = ""  # text to store in the file

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 1:
            raise UsageError(
                f"workers is {self.workers}; it must be a whole number from 1"
            )
        if self.chunk_cells < 1:
            raise UsageError(
                f"a unit of work: found {self.chunk_cells} cells; expected one or more"
            )
        for name in self.quantities:
            if name in ("friction", "fz_min"):
                raise UsageError(
                    f"quantity {name}: a sweep no longer stores it; check and response"
                    " give friction_needed and fz_min"
                )
            if name not in QUANTITIES:
                raise UsageError(
                    f"unknown quantity {name!r}; expected {', '.join(QUANTITIES)}"
                )
        if self.resume and self.overwrite:
            raise UsageError("`resume` does not go with `overwrite`")
        if self.scheduler is not None:
            from .work.cluster import check_scheduler

            check_scheduler(self.scheduler)

    def processes(self, scene: Scene) -> int:
        """Return the number of processes for a scene: `workers` if given, otherwise one
        for a small scene.
        """
        return self.workers or (1 if scene.cells < _SMALL else available_cpus())

    def chunk(self, scene: Scene) -> tuple[int, int]:
        """Return (rows, columns) of a unit of work: whole rows if they fit."""
        _, rows, columns = scene.shape
        width = min(columns, self.chunk_cells)
        return min(rows, max(1, self.chunk_cells // width)), width

    def quantities_of(self, scene: Scene) -> tuple[str, ...]:
        """Return the quantities to compute, in the order of `QUANTITIES`: the requested
        ones, and those that the scene always has. Raises UsageError if the scene does
        not define one of them.
        """
        found = tuple(
            name for name in QUANTITIES if name in (*self.quantities, *scene.quantities)
        )
        if "velocity_ratio" in found and not scene.of_records:
            raise UsageError(
                "quantity velocity_ratio: found the sweep of a pulse; expected a sweep"
                " of records"
            )
        if "linear" in found and scene.method.exact:
            raise UsageError(
                "quantity linear: compares with the nonlinear equation; `model` must be"
                " nonlinear"
            )
        return found

    def variables_of(self, scene: Scene) -> tuple[str, ...]:
        """Return the variables in the file of a scene, in the order of `VARIABLES`.
        Raises UsageError as `quantities_of`.
        """
        of_quantities = {
            name for key in self.quantities_of(scene) for name in QUANTITIES[key]
        }
        wanted = {"theta_ratio", "outcome", *of_quantities} | (
            {"impacts_at_least"} if self.impacts else set()
        )
        return tuple(name for name in VARIABLES if name in wanted)
