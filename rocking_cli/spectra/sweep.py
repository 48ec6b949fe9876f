"""Sweeps: structures over a grid, streamed chunk by chunk into a file, or into memory."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..dynamics.march.account import Work
from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import Difference, Outcome
from ..errors import Interrupted, UsageError
from ..interruption import check as check_for_a_stop
from ..interruption import deferred
from ..motions import Motion
from ..motions.grid import Grid
from ..processes import available_cpus
from ..structures.parameters import RockingParameters
from .cost import refuse_endless
from .results import Spectrum, Summary
from .scene import QUANTITIES, PulseScene, Scene, Unit, chunk_shape, cut_into_units, known_quantities
from .trust.sampling import default_check
from .trust.validity import validity
from .trust.verification import Verification
from .units import Block, Job, unit_reports

CHUNK_CELLS = 131072
_MOST_UNITS = 1_000_000
SMALL_SWEEP = 100_000  # cells below which starting processes takes longer than they save

Progress = Callable[[int, int], None]


def spectrum(
    structures: Sequence[RockingParameters],
    motion: Motion,
    grid: Grid,
    *,
    method: Method | None = None,
    workers: int | None = None,
    check: int | None = None,
    quantities: Sequence[str] = (),
) -> Spectrum:
    """The rocking spectrum of structures over a grid, in memory.

    method: the equation of motion, None for `governing_method`; workers: processes, None for all cores; check: cells computed again
    by the reference, None for a few; quantities: names of `QUANTITIES` to compute as well. Raises UsageError.

    >>> found = spectrum([dimensionless_oscillator(0.9)], sine(), parse_grid('A=1:8:50,Omega=1:8:40'), workers=1)
    >>> found.theta_ratio.shape, int(overturned(found.outcome).sum())
    ((1, 40, 50), 1163)
    """
    return spectrum_of(_pulse_scene(structures, motion, grid, method), workers=workers, check=check, quantities=quantities)


def _pulse_scene(structures: Sequence[RockingParameters], motion: Motion, grid: Grid, method: Method | None) -> PulseScene:
    return PulseScene(tuple(structures), grid, motion, method or governing_method(*structures, dimensionless=grid.dimensionless))


def spectrum_of(
    scene: Scene, *, workers: int | None = None, check: int | None = None, quantities: Sequence[str] = (), progress: Progress | None = None
) -> Spectrum:
    """The spectrum of a scene, in memory; options as for `spectrum`; progress is called with (units done, units).

    Raises UsageError.
    """
    quantities, shape = _checked(quantities, scene), scene.shape
    theta, outcome, impacts = np.full(shape, np.nan), np.zeros(shape, dtype=np.uint8), np.zeros(shape, dtype=np.int32)
    beside = {name: np.full(shape, *_blank(name)) for quantity in quantities for name in QUANTITIES[quantity]}
    chunk = chunk_shape(shape[1:], CHUNK_CELLS)
    _refuse_endless(scene, chunk)

    def keep(unit: Unit, responses: tuple[Block, ...]) -> None:
        rows, columns = responses[0].outcome.shape
        for i, response in zip(unit.places, responses, strict=True):
            block = (i, slice(unit.row, unit.row + rows), slice(unit.column, unit.column + columns))
            theta[block], outcome[block], impacts[block] = response.theta_ratio, response.outcome, response.impacts
            for name, values in beside.items():
                values[block] = response.beside[name]

    summary = _sweep(scene, chunk, workers, check, progress, None, keep, quantities=quantities)
    return Spectrum(scene, theta, outcome, impacts, summary, beside)


def write_spectrum(
    structures: Sequence[RockingParameters],
    motion: Motion,
    grid: Grid,
    path: str | Path,
    *,
    method: Method | None = None,
    workers: int | None = None,
    chunk_cells: int = CHUNK_CELLS,
    check: int | None = None,
    impacts: bool = False,
    quantities: Sequence[str] = (),
    overwrite: bool = False,
    resume: bool = False,
    strict: bool = False,
    shard: tuple[int, int] | None = None,
    scheduler: str | None = None,
    documents: str = "",
    history: str = "",
    progress: Progress | None = None,
    tell: Callable[[str], None] | None = None,
) -> Summary:
    """Compute a spectrum of structures under a pulse and stream it into an HDF5 file; the options are those of `write_scene`.

    >>> grid = parse_grid('A=1:8:50,Omega=1:8:40')
    >>> write_spectrum([dimensionless_oscillator(0.9)], sine(), grid, 'shared.h5', workers=1).cells
    2000
    """
    scene = _pulse_scene(structures, motion, grid, method)
    return write_scene(
        scene, path, workers=workers, chunk_cells=chunk_cells, check=check, impacts=impacts, quantities=quantities, overwrite=overwrite,
        resume=resume, strict=strict, shard=shard, scheduler=scheduler, documents=documents, history=history, progress=progress, tell=tell,
    )  # fmt: skip


def write_scene(
    scene: Scene,
    path: str | Path,
    *,
    workers: int | None = None,
    chunk_cells: int = CHUNK_CELLS,
    check: int | None = None,
    impacts: bool = False,
    quantities: Sequence[str] = (),
    overwrite: bool = False,
    resume: bool = False,
    strict: bool = False,
    shard: tuple[int, int] | None = None,
    scheduler: str | None = None,
    documents: str = "",
    history: str = "",
    sample_validity: bool = False,
    progress: Progress | None = None,
    tell: Callable[[str], None] | None = None,
) -> Summary:
    """Compute a scene and stream it, chunk by chunk, into an HDF5 file (layout: `rocking help files`).

    quantities: names of `QUANTITIES`, stored as well. scheduler: address of a dask.distributed cluster to compute on. shard: (i, n)
    computes the i-th of n parts, for `merge`. resume: go on with the partial file of an interrupted sweep of the same scene, PATH.part,
    strict: unless it was begun on a machine whose results may differ in the last digits. documents, history: texts kept in the
    file. sample_validity: compare some cells of a linear sweep with the nonlinear equation.
    progress: called with (units done, units). tell: called with a line where the sweep waits for its
    cluster. Raises UsageError for a scene or an output that is refused, OutputError when the file cannot be written or a worker
    process dies, Interrupted on Ctrl-C.
    """
    from .file.layout import VARIABLES
    from .file.writer import SpectraWriter

    method, chunk = scene.method, chunk_shape(scene.shape[1:], chunk_cells)
    _refuse_endless(scene, chunk)
    attributes: dict[str, Any] = {"history": history, "documents": documents, "motion": scene.title, "model": method.model}
    if method.stated_tolerance is not None:
        attributes["tolerance"] = method.stated_tolerance
    quantities = _checked(quantities, scene)
    wanted = {"theta_ratio", "outcome", *(["impacts"] if impacts else []), *(name for key in quantities for name in QUANTITIES[key])}
    names = tuple(name for name in VARIABLES if name in wanted)
    identity = {**scene.identity(), "impacts": impacts, "quantities": list(quantities), "chunk": list(chunk)}
    options: dict[str, Any] = {
        "names": names, "overwrite": overwrite, "resume": resume, "strict": strict, "scene": identity, "attributes": attributes,
        "shard": "{}/{}".format(*(shard or (1, 1))),
    }  # fmt: skip
    with SpectraWriter(Path(path), scene.frame(), chunk, **options) as writer:
        mine = {u for i, u in enumerate(cut_into_units(scene, chunk)) if shard is None or i % shard[1] == shard[0] - 1}

        def todo(unit: Unit) -> bool:
            return unit in mine and not writer.has(unit.places, unit.row, unit.column)

        def keep(unit: Unit, data: tuple[dict[str, bytes], ...]) -> None:
            for i, own in zip(unit.places, data, strict=True):
                writer.write((i, unit.row, unit.column), own)

        try:
            packing = _Packing(names, chunk)
            summary = _sweep(scene, chunk, workers, check, progress, packing, keep, todo, writer.outcomes, scheduler, quantities, tell)
        except KeyboardInterrupt:
            kept = writer.written + writer.resumed
            if not kept:
                raise Interrupted("interrupted before the first chunk was done; nothing is kept") from None
            raise Interrupted(f"interrupted; {kept} of {writer.chunks} chunks are kept in {writer.part}; `resume` goes on") from None
        summary = replace(summary, elsewhere=writer.elsewhere, validity=validity(scene) if sample_validity else None)
        writer.finish(summary.record())
    return summary


@dataclass(frozen=True)
class _Packing:
    """Function from a block to the bytes of its variables as the file stores them; worker processes call it."""

    names: tuple[str, ...]
    chunk: tuple[int, int]

    def __call__(self, response: Block) -> dict[str, bytes]:
        from .file.chunks import pack

        return {name: pack(_padded(response.variable(name), self.chunk)) for name in self.names}


def _padded(block: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """A block at the grid's edge, filled up to the full chunk that HDF5 stores."""
    if block.shape == shape:
        return block
    full = np.zeros(shape, dtype=block.dtype)
    full[: block.shape[0], : block.shape[1]] = block
    return full


def _check_bodies(scene: Scene) -> None:
    """Raise UsageError if friction or fz_min is not defined for a structure, or structures share rotations but not forces."""
    bodies = [scene.method.body_of(s) for s in scene.structures]
    for s, body in zip(scene.structures, bodies, strict=True):
        if body is None:
            raise UsageError(f"{s.name}: quantities friction and fz_min: accepted is a rigid body whose arm is known")
        if not body.moves_with_the_ground:
            raise UsageError(
                f"{s.name}: quantities friction and fz_min: found a_scale {s.a_scale:.6g}; accepted is 1, of an uplift at alpha"
            )
    for first, *others in () if scene.of_records else scene.sharing():
        for i in others:
            if bodies[i] != bodies[first]:
                name = scene.structures[i].name
                raise UsageError(f"{name}: shares its rotations with another structure, but not its forces; sweep them apart")


def _checked(names: Sequence[str], scene: Scene) -> tuple[str, ...]:
    """The quantities of a sweep, those asked for and those that belong to its scene. Raises UsageError."""
    quantities = known_quantities((*names, *scene.quantities))
    if "velocity_ratio" in quantities and not scene.of_records:
        raise UsageError("quantity velocity_ratio: found the sweep of a pulse; accepted is one of records")
    if "friction" in quantities or "fz_min" in quantities:
        _check_bodies(scene)
    if "linear" in quantities and scene.method.exact:
        raise UsageError("quantity linear: the linear equation beside the nonlinear one, which `model` is not; accepted is nonlinear")
    return quantities


def _blank(name: str) -> tuple[Any, np.dtype]:
    """(fill value of cells that are not computed, type) of a variable."""
    from .file.layout import VARIABLES

    dtype, about = VARIABLES[name]
    return about.get("_FillValue", 0), dtype


def _refuse_endless(scene: Scene, chunk: tuple[int, int]) -> None:
    """Refuse a sweep that would take years, and one of too many units of work. Raises UsageError."""
    rows, columns = (-(-n // size) for n, size in zip(scene.shape[1:], chunk, strict=True))
    units = rows * columns * len(scene.sharing())
    if units > _MOST_UNITS:
        raise UsageError(f"{units} units of work of {chunk[0] * chunk[1]} cells, accepted are up to {_MOST_UNITS}; make them larger")
    refuse_endless(units * chunk[0] * chunk[1], 1 if scene.of_records else scene.segments)


def _processes(scene: Scene, workers: int | None) -> int:
    if workers is not None and workers < 1:
        raise UsageError(f"workers is {workers}, accepted is a whole number from 1")
    return workers or (1 if scene.cells < SMALL_SWEEP else available_cpus())


def _sweep(
    scene: Scene,
    chunk: tuple[int, int],
    workers: int | None,
    check: int | None,
    progress: Progress | None,
    convert: Callable[[Block], Any] | None,
    keep: Callable[[Unit, Any], None],
    todo: Callable[[Unit], bool] | None = None,
    before: Mapping[int, np.ndarray] | None = None,
    scheduler: str | None = None,
    quantities: tuple[str, ...] = (),
    tell: Callable[[str], None] | None = None,
) -> Summary:
    """Compute all units, or those `todo`, hand each result to `keep` in order, and sum up with the outcomes from before."""
    began = time.perf_counter()
    every = list(cut_into_units(scene, chunk))
    units = [unit for unit in every if todo is None or todo(unit)]
    wanted = max(1, min(_processes(scene, workers), len(units)))
    verification = Verification(scene, default_check(scene) if check is None else check, chunk, units)
    job = Job(scene, chunk, verification.candidates, convert, quantities)
    total, outcomes, shared = Work(), np.zeros(len(Outcome), dtype=np.int64), 0
    outcomes += sum((before or {}).values(), np.zeros_like(outcomes))
    differences = np.zeros(len(Difference), dtype=np.int64)
    if scheduler is None:
        reports = unit_reports(job, units, wanted, verification)
    else:
        from .cluster import cluster_reports

        reports = cluster_reports(job, units, scheduler, verification, tell)
    for done, (unit, report) in enumerate(reports, 1 + len(every) - len(units)):
        with deferred():
            keep(unit, report.data)
        times = len(unit.places)
        total += report.work
        outcomes += report.outcomes
        differences += report.differences
        shared += (times - 1) * report.cells
        verification.seen |= report.seen
        if progress:
            progress(done, len(every))
    check_for_a_stop()
    outcomes[Outcome.NOT_COMPUTED] = scene.cells - outcomes.sum()  # those of other shards
    return Summary(
        structures=len(scene.structures),
        cells=scene.cells,
        run_time=time.perf_counter() - began,
        workers=wanted,
        outcomes={o.flag: int(outcomes[o]) for o in Outcome},
        work=total,
        shared_cells=shared,
        checked_by=" and ".join(sorted({scene.method.checked_by(s, scene.weighed) for s in scene.structures})),
        model=scene.method.model,
        records=scene.shape[0] if scene.of_records else 0,
        weighed=scene.weighed,
        differences={d.flag: int(differences[d]) for d in Difference} if "linear" in quantities else {},
        resumed_cells=int(sum(int(counts.sum()) for counts in (before or {}).values())),
        **verification.compared(),
    )
