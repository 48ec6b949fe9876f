"""Sweeps: structures over a grid, streamed chunk by chunk into a file,
or into memory.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import check_choices
from ..dynamics.method import CHECKED_BY, Method, governing_method
from ..dynamics.outcome import Difference, Outcome, Work
from ..errors import Interrupted, UsageError
from ..interruption import check as check_for_a_stop
from ..interruption import deferred
from ..motions import Motion
from ..motions.given import AnyMotion, with_grid
from ..motions.grid import Grid
from ..processes import available_cpus, refuse_endless
from ..structures.given import Structure, structures_from
from ..structures.parameters import RockingParameters
from .dimensions import QUANTITIES, VARIABLES
from .error_bound import Conditions, tolerance_of
from .results import Spectrum, Summary
from .scene import PulseScene, Scene, Unit, cut_into_units
from .verification import Verification, default_check, validity
from .work.jobs import CellValues, Crew, Job, Report, local_crew, unit_reports

if TYPE_CHECKING:
    from .file.layout import FileLayout

_MOST_UNITS = 1_000_000
CHUNK_CELLS = 131072
_SMALL = 100_000  # cells below which starting processes takes longer than they save

CellProgress = Callable[[int, int], None]


@dataclass(frozen=True)
class SweepOptions:
    """Options of a sweep, checked at construction; those from `impacts` on are for the
    file of `write_spectrum`. Raises UsageError.

    Attributes
    ----------
    workers: number of processes, None for all cores
    scheduler: address of a dask.distributed cluster that computes instead
    chunk_cells: number of cells in one unit of work
    check: number of cells to compute again by the reference, None for a few
    quantities: names of `QUANTITIES` to compute as well
    sample_validity: compare some cells of a linear sweep with the nonlinear equation
    progress: called with (units done, all units)
    tell: called with a line while the sweep waits for its cluster
    impacts: store impacts_at_least, the number of impacts that were computed
    overwrite: replace an existing output
    resume: continue the partial file PATH.part of an interrupted sweep of the same
        scene
    strict: refuse a partial file that another machine began whose results may differ in
        the last digits
    shard: (i, n): compute the i-th of n parts, for `merge`
    documents: text to store in the file
    history: text to store in the file
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
    progress: CellProgress | None = None  # called with (units done, all units)
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


def spectrum(
    structures: Structure | Sequence[Structure],
    motion: AnyMotion,
    grid: Grid | str | None = None,
    *,
    method: Method | str | None = None,
    **options: Any,
) -> Spectrum:
    """Return the rocking spectrum of structures over a grid, in memory (section 2 of
    the paper).

    Parameters
    ----------
    structures
        one or more: parameters, documents, paths, or texts such as "block:0.5x2"; of
        those of equal restitution a linear spectrum over A and Omega is computed once
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    grid
        the cells, A and Omega, or a_g and a frequency, or a text that states them; a
        record needs none, and parse_grid(..., own_time=True) scales it
    method
        the equation of motion or its name, such as "linear"; None for the nonlinear one
        if all geometries are known and the axes have units, else the linear one
    options
        `workers`: number of processes, None for all cores; `check`: number of cells
        that the reference computes again; `quantities`: more variables, such as
        "condition"

    Returns
    -------
    Spectrum
        with arrays of the shape (structures, frequencies, amplitudes)

    Raises
    ------
    UsageError
        for an equation that does not hold for a structure, an option out of range, or a
        pulse without a grid
    OutputError
        when a worker process dies

    Examples
    --------
    >>> grid = parse_grid("A=1:8:50,Omega=1:8:40")
    >>> found = spectrum([dimensionless_oscillator(eta=0.9)], sine(), grid, workers=1)
    >>> found.theta_ratio.shape, int(overturned(found.outcome).sum())
    ((1, 40, 50), 1163)
    """
    check_choices("spectrum", SweepOptions, options)
    return spectrum_of(
        _pulse_scene(structures_from(structures), *with_grid(motion, grid), method),
        SweepOptions(**options),
    )


def _pulse_scene(
    structures: Sequence[RockingParameters],
    motion: Motion,
    grid: Grid,
    method: Method | str | None,
) -> PulseScene:
    """Return the scene of structures under a pulse, by the governing equation unless a
    method is given.
    """
    return PulseScene(
        tuple(structures),
        grid,
        motion,
        Method.of(
            method or governing_method(*structures, dimensionless=grid.dimensionless)
        ),
    )


def spectrum_of(scene: Scene, options: SweepOptions | None = None) -> Spectrum:
    """Return the spectrum of a scene (structures, motion, grid, equation), in memory.
    Raises UsageError.
    """
    options = replace(options or SweepOptions(), impacts=True)
    arrays = {
        name: np.full(scene.shape, VARIABLES[name].fill, VARIABLES[name].dtype)
        for name in options.variables_of(scene)
    }

    def keep(unit: Unit, blocks: tuple[CellValues, ...]) -> None:
        for i, block in zip(unit.places, blocks, strict=True):
            for name, values in arrays.items():
                values[i, unit.rows, unit.columns] = block[name]

    summary = _run(scene, options, _units_of(scene, options), keep)
    theta_ratio, outcome, impacts = (
        arrays.pop(name) for name in ("theta_ratio", "outcome", "impacts_at_least")
    )
    return Spectrum(scene, theta_ratio, outcome, impacts, summary, arrays)


def write_spectrum(
    structures: Structure | Sequence[Structure],
    motion: AnyMotion,
    grid: Grid | str,
    path: str | Path,
    *,
    method: Method | str | None = None,
    **options: Any,
) -> Summary:
    """Compute a spectrum of structures under a pulse and stream it into an HDF5 file.

    The file opens in xarray and other netCDF readers; `SpectraFile` reads it, `draw`
    draws it. While it is computed it has the name PATH.part.

    Parameters
    ----------
    structures
        one or more as in `spectrum`, with distinct names
    motion
        the pulse: an object, its name, or the path of a motion document
    grid
        the cells, A and Omega, or a_g and a frequency, or a text that states them
    path
        the HDF5 file
    method
        the equation of motion, None as in `spectrum`
    options
        `workers`, `check` and `quantities` as in `spectrum`; `scheduler` (address of a
        dask cluster), `chunk_cells`, `impacts` (True stores `impacts_at_least`),
        `overwrite`, `resume`, `strict`, `shard` ((i, n): the i-th of n parts, for
        `merge`), `sample_validity`, `documents` and `history` (texts to store),
        `progress` and `tell` (functions)

    Returns
    -------
    Summary
        counts, times and checks of the sweep

    Raises
    ------
    UsageError
        for a refused scene, option or output; a file that exists is not replaced
        without `overwrite`
    OutputError
        when the file cannot be written or a worker process dies
    Interrupted
        on Ctrl-C; `resume` goes on with the finished chunks

    Examples
    --------
    >>> grid = parse_grid("A=1:8:50,Omega=1:8:40")
    >>> structures = [dimensionless_oscillator(eta=0.9)]
    >>> write_spectrum(structures, sine(), grid, "shared.h5", workers=1).cells
    2000
    """
    check_choices("write_spectrum", SweepOptions, options)
    return write_scene(
        _pulse_scene(structures_from(structures), *with_grid(motion, grid), method),
        path,
        SweepOptions(**options),
    )


def write_scene(
    scene: Scene, path: str | Path, options: SweepOptions | None = None
) -> Summary:
    """Compute a scene and stream it, chunk by chunk, into an HDF5 file (layout:
    `rocking help files`). Raises UsageError for a refused scene or output, OutputError
    when the file cannot be written or a worker process dies, Interrupted on Ctrl-C.
    """
    from .file.writer import SpectraWriter

    options = options or SweepOptions()
    units, chunk = _units_of(scene, options), options.chunk(scene)
    layout = _layout(scene, options)
    with SpectraWriter(
        Path(path),
        layout,
        overwrite=options.overwrite,
        resume=options.resume,
        strict=options.strict,
    ) as writer:

        def keep(unit: Unit, data: tuple[dict[str, bytes], ...]) -> None:
            for i, own in zip(unit.places, data, strict=True):
                writer.write((i, unit.row, unit.column), own)

        pack = partial(_packed, layout.names, chunk)
        try:
            summary = _run(scene, options, units, keep, pack, writer.found)
        except KeyboardInterrupt:
            kept = int(writer.done.sum())
            if not kept:
                raise Interrupted(
                    "interrupted before the first chunk was done; nothing is kept"
                ) from None
            raise Interrupted(
                f"interrupted; {kept} of {writer.chunk_grid.size} chunks are kept in"
                f" {writer.part}; `resume` goes on"
            ) from None
        judged = validity(scene) if options.sample_validity else None
        assert writer.conditions is not None
        summary = replace(
            summary,
            machine_differences=writer.machine_differences,
            validity=judged,
            **writer.conditions.bounds(tolerance_of(scene.method)),
        )
        writer.finish(summary.row())
    return summary


def _layout(scene: Scene, options: SweepOptions) -> "FileLayout":
    """Return the layout of the file of a scene. Raises UsageError."""
    from .file.layout import FileLayout

    chunk, method = options.chunk(scene), scene.method
    names = options.variables_of(scene)
    attributes: dict[str, Any] = {
        "history": options.history,
        "documents": options.documents,
        "motion": scene.title,
        "model": method.model,
    }
    if method.stated_tolerance is not None:
        attributes["tolerance"] = method.stated_tolerance
    attributes["shard"] = "{}/{}".format(*options.shard or (1, 1))
    identity = {
        **scene.identity(),
        "impacts": options.impacts,
        "quantities": list(options.quantities_of(scene)),
        "chunk": list(chunk),
    }
    return FileLayout(scene.frame(), chunk, names, identity, attributes)


def _packed(
    names: Sequence[str], chunk: tuple[int, int], block: CellValues
) -> dict[str, bytes]:
    """Return the bytes of the variables of a block as the file stores them, and its
    packed conditions; worker processes call this.
    """
    from .file.layout import CONDITIONS, pack

    conditions = Conditions.of(block["condition"]).packed()
    return {name: pack(block[name], chunk) for name in names} | {CONDITIONS: conditions}


def _units_of(scene: Scene, options: SweepOptions) -> list[Unit]:
    """Return the units of work of a whole scene. Raises UsageError for a sweep that
    would take years, and for one of too many units.
    """
    chunk = options.chunk(scene)
    rows, columns = (
        -(-n // size) for n, size in zip(scene.shape[1:], chunk, strict=True)
    )
    count = rows * columns * len(scene.sharing())
    cells = chunk[0] * chunk[1]
    if count > _MOST_UNITS:
        raise UsageError(
            f"found {count} units of work of {cells} cells; expected up to"
            f" {_MOST_UNITS} larger ones"
        )
    refuse_endless(count * cells, 1 if scene.of_records else scene.segments)
    return list(cut_into_units(scene, chunk))


def _run(
    scene: Scene,
    options: SweepOptions,
    units: Sequence[Unit],
    keep: Callable[[Unit, Any], None],
    convert: Callable[[CellValues], Any] | None = None,
    found: Callable[[Unit], np.ndarray | None] = lambda unit: None,
) -> Summary:
    """Compute the units of a shard, and call `keep` with each unit and its converted
    data, in order. found: returns the counts of outcomes of a unit that a resumed file
    already has, None for a unit to compute.
    """
    began = time.perf_counter()
    todo, resumed = _todo(units, options.shard, found)
    workers = max(1, min(options.processes(scene), len(todo)))
    chunk, quantities = options.chunk(scene), options.quantities_of(scene)
    check = default_check(scene) if options.check is None else options.check
    verification = Verification(scene, check, chunk, todo)
    job = Job(scene, verification.wanted, convert, quantities)

    total = Report(
        Work(),
        resumed.copy(),
        np.zeros(len(Difference), dtype=np.int64),
        Conditions.of(np.zeros(0)),
    )
    with _crew(job, options, workers) as (run, at_once):
        reports = unit_reports(job, todo, run, at_once)
        for done, (unit, report) in enumerate(reports, 1 + len(units) - len(todo)):
            with deferred():
                keep(unit, report.data)
            verification.seen |= report.seen or {}
            total += report
            if options.progress:
                options.progress(done, len(units))
        verification.ask(run)
    check_for_a_stop()
    # cells of other shards
    total.outcomes[Outcome.NOT_COMPUTED] = scene.cells - total.outcomes.sum()

    return Summary(
        structures=len(scene.structures),
        cells=scene.cells,
        run_time=time.perf_counter() - began,
        workers=workers,
        outcomes=_by_flag(total.outcomes, Outcome),
        work=total.work,
        shared_cells=total.shared,
        checked_by=CHECKED_BY,
        model=scene.method.model,
        records=scene.shape[0] if scene.of_records else 0,
        weighed=scene.weighed,
        differences=(
            _by_flag(total.differences, Difference) if "linear" in quantities else {}
        ),
        resumed_cells=int(resumed.sum()),
        **verification.compared(),
        **total.conditions.bounds(tolerance_of(scene.method)),
    )


def _by_flag(
    counts: np.ndarray, codes: type[Outcome] | type[Difference]
) -> dict[str, int]:
    """Return the counts of cells by the names of their codes."""
    return {code.flag: int(counts[code]) for code in codes}


def _todo(
    units: Sequence[Unit],
    shard: tuple[int, int] | None,
    found: Callable[[Unit], np.ndarray | None],
) -> tuple[list[Unit], np.ndarray]:
    """Return (the units of a shard to compute, the counts of outcomes of the others);
    found: as in `_run`.
    """
    part, parts = shard or (1, 1)
    known = [(unit, found(unit)) for unit in units[part - 1 :: parts]]
    resumed = np.zeros(len(Outcome), dtype=np.int64)
    resumed += sum(counts for _, counts in known if counts is not None)
    return [unit for unit, counts in known if counts is None], resumed


def _crew(job: Job, options: SweepOptions, workers: int) -> Crew:
    """Return the processes that compute a job: those of this machine, or a cluster."""
    if options.scheduler is None:
        return local_crew(job, workers)
    from .work.cluster import cluster

    return cluster(job, options.scheduler, options.tell)
