"""Sweeps: structures over a grid, streamed chunk by chunk into a file,
or into memory.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import chain
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
from ..processes import Runner, processes, refuse_endless
from ..structures.given import Structure, structures_from
from ..structures.parameters import RockingParameters
from .dimensions import VARIABLES
from .error_bound import Conditions, tolerance_of
from .results import Spectrum, Summary
from .scene import PulseScene, Scene, Unit, cut_into_units
from .sweep_options import SweepOptions
from .verification import Verification, default_check, validity
from .work.jobs import CellValues, Job, Report

if TYPE_CHECKING:
    from .file.layout import FileLayout
    from .file.writer import SpectraWriter
    from .verdicts import VerdictJob

_MOST_UNITS = 1_000_000


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
    arrays = _Arrays(scene, options.variables_of(scene))
    summary = _run(scene, options, _units_of(scene, options), arrays)
    own = arrays.variables
    theta_ratio, outcome, impacts = map(
        own.pop, ("theta_ratio", "outcome", "impacts_at_least")
    )
    return Spectrum(scene, theta_ratio, outcome, impacts, summary, own)


class _Arrays:
    """Variables of a scene in memory; what a sweep fills in place of a file."""

    convert = None  # blocks are kept as they are

    def __init__(self, scene: Scene, names: Sequence[str]) -> None:
        self.variables = {
            name: np.full(scene.shape, VARIABLES[name].fill, VARIABLES[name].dtype)
            for name in names
        }
        self.conditions = Conditions.of(np.zeros(0))

    def found(self, unit: Unit) -> None:
        """Nothing is resumed."""

    def keep(self, unit: Unit, blocks: Sequence[CellValues]) -> None:
        """Keep the blocks of a unit, one for each of its places."""
        for i, block in zip(unit.places, blocks, strict=True):
            self.conditions += Conditions.of(block["condition"])
            for name, values in self.variables.items():
                values[i, unit.rows, unit.columns] = block[name]


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
    options = options or SweepOptions()
    units, layout = _units_of(scene, options), _layout(scene, options)
    with kept(path, layout, options) as writer:
        summary = replace(
            _run(scene, options, units, writer),
            machine_differences=writer.machine_differences,
            validity=validity(scene) if options.sample_validity else None,
        )
        writer.finish(summary.row())
    return summary


@contextmanager
def kept(
    path: str | Path, layout: "FileLayout", options: SweepOptions
) -> Iterator["SpectraWriter"]:
    """Context of the writer of a file, which keeps the finished chunks whatever
    happens. Raises UsageError for a refused output, OutputError when the file cannot be
    written, Interrupted on Ctrl-C.
    """
    from .file.writer import SpectraWriter

    with SpectraWriter(
        Path(path),
        layout,
        overwrite=options.overwrite,
        resume=options.resume,
        strict=options.strict,
    ) as writer:
        try:
            yield writer
        except KeyboardInterrupt:
            count = int(writer.done.sum())
            if not count:
                raise Interrupted(
                    "interrupted before the first chunk was done; nothing is kept"
                ) from None
            raise Interrupted(
                f"interrupted; {count} of {writer.chunk_grid.size} chunks are kept in"
                f" {writer.part}; `resume` goes on"
            ) from None


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
    store: "_Arrays | SpectraWriter",
) -> Summary:
    """Compute the units of a shard that `store` has not yet, and let it keep them, in
    their order.
    """
    began = time.perf_counter()
    todo, resumed = units_to_do(units, options.shard, store.found)
    workers = max(1, min(options.processes(scene), len(todo)))
    check = default_check(scene) if options.check is None else options.check
    verification = Verification(scene, check, options.chunk(scene), todo, len(units))
    job = Job(scene, store.convert, options.quantities_of(scene))

    work, outcomes = Work(), resumed.copy()
    differences = np.zeros(len(Difference), dtype=np.int64)
    with crew(job, options, workers) as (run, at_once):
        batches = job.batches(verification.units, at_once)
        for unit, report in in_turn(
            run(batches), verification.units, store, options.progress, len(units)
        ):
            verification.seen |= zip(unit.wanted, report.seen, strict=True)
            work += report.work
            outcomes += report.outcomes
            differences += report.differences
        verification.ask(run)
    check_for_a_stop()
    # cells of other shards
    outcomes[Outcome.NOT_COMPUTED] = scene.cells - outcomes.sum()

    assert store.conditions is not None
    return Summary(
        structures=len(scene.structures),
        cells=scene.cells,
        run_time=time.perf_counter() - began,
        workers=workers,
        outcomes=_by_flag(outcomes, Outcome),
        work=work,
        shared_cells=sum(unit.shared for unit in todo),
        checked_by=CHECKED_BY,
        model=scene.method.model,
        records=scene.shape[0] if scene.of_records else 0,
        weighed=scene.weighed,
        differences=(
            _by_flag(differences, Difference) if "linear" in job.quantities else {}
        ),
        resumed_cells=int(resumed.sum()),
        **verification.compared(),
        **store.conditions.bounds(tolerance_of(scene.method)),
    )


def _by_flag(
    counts: np.ndarray, codes: type[Outcome] | type[Difference]
) -> dict[str, int]:
    """Return the counts of cells by the names of their codes."""
    return {code.flag: int(counts[code]) for code in codes}


def in_turn(
    batches: Iterable[list[Report]],
    units: Sequence[Unit],
    store: "_Arrays | SpectraWriter",
    progress: Callable[[int, int], None] | None,
    total: int,
) -> Iterator[tuple[Unit, Report]]:
    """Yield each unit with its report, whose data `store` has kept. batches: the
    reports of the units, in their order; total: number of units of the scene.
    """
    reports = chain.from_iterable(batches)
    for done, unit in enumerate(units, 1 + total - len(units)):
        report = next(reports)
        with deferred():
            store.keep(unit, report.data)
        yield unit, report
        if progress:
            progress(done, total)


def units_to_do(
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


@contextmanager
def crew(
    job: "Job | VerdictJob", options: SweepOptions, workers: int
) -> Iterator[tuple[Runner, int]]:
    """Context of (a function from items to job(item) of each, in their order; the
    number of items computed at a time): by this process alone, others of this machine,
    or a cluster. Raises OutputError when a worker dies.
    """
    if options.scheduler is not None:
        from .work.cluster import cluster

        with cluster(job, options.scheduler, options.tell) as crew:
            yield crew
    elif workers == 1:
        yield partial(map, job), 1
    else:
        advice = "fewer `workers` or a smaller `chunk_cells` need less"
        with processes(workers, job, advice) as run:
            yield run, workers
