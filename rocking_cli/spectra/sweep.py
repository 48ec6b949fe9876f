"""Sweeps: structures over a grid, streamed chunk by chunk into a file, or into memory."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..dynamics.method import CHECKED_BY, Method, governing_method
from ..dynamics.outcome import Difference, Outcome, Work
from ..errors import Interrupted, UsageError
from ..interruption import check as check_for_a_stop
from ..interruption import deferred
from ..motions import Motion
from ..motions.grid import Grid
from ..processes import refuse_endless
from ..structures.parameters import RockingParameters
from .results import Spectrum, Summary
from .scene import PulseScene, Scene, Unit, cut_into_units
from .sweep_options import SweepOptions
from .trust.validity import validity
from .trust.verification import Verification, default_check
from .variables import VARIABLES
from .work.jobs import Block, Job, local_crew, unit_reports

_MOST_UNITS = 1_000_000


def spectrum(
    structures: Sequence[RockingParameters], motion: Motion, grid: Grid, *, method: Method | None = None, **options: Any
) -> Spectrum:
    """The rocking spectrum of structures over a grid, in memory.

    method: the equation of motion, None for `governing_method`; options: workers, check and quantities of `SweepOptions`. Raises
    UsageError.

    >>> found = spectrum([dimensionless_oscillator(0.9)], sine(), parse_grid('A=1:8:50,Omega=1:8:40'), workers=1)
    >>> found.theta_ratio.shape, int(overturned(found.outcome).sum())
    ((1, 40, 50), 1163)
    """
    return spectrum_of(_pulse_scene(structures, motion, grid, method), SweepOptions(**options))


def _pulse_scene(structures: Sequence[RockingParameters], motion: Motion, grid: Grid, method: Method | None) -> PulseScene:
    return PulseScene(tuple(structures), grid, motion, method or governing_method(*structures, dimensionless=grid.dimensionless))


def spectrum_of(scene: Scene, options: SweepOptions | None = None) -> Spectrum:
    """The spectrum of a scene, in memory. Raises UsageError."""
    options = replace(options or SweepOptions(), impacts=True)
    arrays = {name: np.full(scene.shape, VARIABLES[name].fill, VARIABLES[name].dtype) for name in options.variables_of(scene)}

    def keep(unit: Unit, blocks: tuple[Block, ...]) -> None:
        rows, columns = blocks[0]["outcome"].shape
        for i, block in zip(unit.places, blocks, strict=True):
            for name, values in arrays.items():
                values[i, unit.row : unit.row + rows, unit.column : unit.column + columns] = block[name]

    summary = _Sweep(scene, options).run(keep)
    theta_ratio, outcome, impacts = (arrays.pop(name) for name in ("theta_ratio", "outcome", "impacts"))
    return Spectrum(scene, theta_ratio, outcome, impacts, summary, arrays)


def write_spectrum(
    structures: Sequence[RockingParameters],
    motion: Motion,
    grid: Grid,
    path: str | Path,
    *,
    method: Method | None = None,
    **options: Any,
) -> Summary:
    """Compute a spectrum of structures under a pulse and stream it into an HDF5 file.

    method: as in `spectrum`; options: those of `SweepOptions`: workers, scheduler, chunk_cells, check, quantities, impacts, overwrite,
    resume, strict, shard, documents, history, progress and tell. Raises what `write_scene` raises.

    >>> grid = parse_grid('A=1:8:50,Omega=1:8:40')
    >>> write_spectrum([dimensionless_oscillator(0.9)], sine(), grid, 'shared.h5', workers=1).cells
    2000
    """
    return write_scene(_pulse_scene(structures, motion, grid, method), path, SweepOptions(**options))


def write_scene(scene: Scene, path: str | Path, options: SweepOptions | None = None) -> Summary:
    """Compute a scene and stream it, chunk by chunk, into an HDF5 file (layout: `rocking help files`).

    Raises UsageError for a refused scene or output, OutputError when the file cannot be written or a worker process dies,
    Interrupted on Ctrl-C.
    """
    from .file.layout import Layout
    from .file.writer import SpectraWriter

    options = options or SweepOptions()
    sweep, names, (part, count) = _Sweep(scene, options), options.variables_of(scene), options.shard or (1, 1)
    attributes: dict[str, Any] = {
        "history": options.history,
        "documents": options.documents,
        "motion": scene.title,
        "model": scene.method.model,
    }
    if scene.method.stated_tolerance is not None:
        attributes["tolerance"] = scene.method.stated_tolerance
    attributes["shard"] = f"{part}/{count}"
    stored = {"impacts": options.impacts, "quantities": list(options.quantities_of(scene)), "chunk": list(sweep.chunk)}
    layout = Layout(scene.frame(), sweep.chunk, names, {**scene.identity(), **stored}, attributes)
    with SpectraWriter(Path(path), layout, overwrite=options.overwrite, resume=options.resume, strict=options.strict) as writer:
        mine = sweep.units[part - 1 :: count]
        found = [writer.found(unit.places, unit.row, unit.column) for unit in mine]
        sweep.todo = [unit for unit, counts in zip(mine, found, strict=True) if counts is None]
        sweep.before += sum(counts for counts in found if counts is not None)

        def keep(unit: Unit, data: tuple[dict[str, bytes], ...]) -> None:
            for i, own in zip(unit.places, data, strict=True):
                writer.write((i, unit.row, unit.column), own)

        try:
            summary = sweep.run(keep, _Packing(names, sweep.chunk))
        except KeyboardInterrupt:
            kept = int(writer.done.sum())
            if not kept:
                raise Interrupted("interrupted before the first chunk was done; nothing is kept") from None
            raise Interrupted(f"interrupted; {kept} of {writer.cut.size} chunks are kept in {writer.part}; `resume` goes on") from None
        summary = replace(summary, elsewhere=writer.elsewhere, validity=validity(scene) if options.sample_validity else None)
        writer.finish(summary.record())
    return summary


@dataclass(frozen=True)
class _Packing:
    """Function from a block to the bytes of its variables as the file stores them; worker processes call it."""

    names: tuple[str, ...]
    chunk: tuple[int, int]

    def __call__(self, block: Block) -> dict[str, bytes]:
        from .file.chunks import pack

        return {name: pack(block[name], self.chunk) for name in self.names}


class _Sweep:
    """The computation of a scene. todo: the units to compute; before: counts of outcomes in resumed units. Raises
    UsageError for a sweep that would take years, and for one of too many units of work."""

    def __init__(self, scene: Scene, options: SweepOptions) -> None:
        self.scene, self.options, self.chunk = scene, options, options.chunk(scene)
        self.before = np.zeros(len(Outcome), dtype=np.int64)
        rows, columns = (-(-n // size) for n, size in zip(scene.shape[1:], self.chunk, strict=True))
        count, cells = rows * columns * len(scene.sharing()), self.chunk[0] * self.chunk[1]
        if count > _MOST_UNITS:
            raise UsageError(f"found {count} units of work of {cells} cells; expected up to {_MOST_UNITS} larger ones")
        refuse_endless(count * cells, 1 if scene.of_records else scene.segments)
        self.units = self.todo = list(cut_into_units(scene, self.chunk))

    def run(self, keep: Callable[[Unit, Any], None], convert: Callable[[Block], Any] | None = None) -> Summary:
        """Compute the units, and hand the data of each, converted, to `keep` in order."""
        began, scene, options = time.perf_counter(), self.scene, self.options
        workers = max(1, min(options.processes(scene), len(self.todo)))
        check = default_check(scene) if options.check is None else options.check
        verification = Verification(scene, check, self.chunk, self.todo)
        quantities = options.quantities_of(scene)
        job = Job(scene, self.chunk, tuple(verification.sensitive), convert, quantities)
        if options.scheduler is None:
            crew = local_crew(job, workers)
        else:
            from .work.cluster import cluster

            crew = cluster(job, options.scheduler, options.tell)
        total, shared, differences = Work(), 0, np.zeros(len(Difference), dtype=np.int64)
        outcomes = self.before.copy()
        for done, (unit, report) in enumerate(unit_reports(job, self.todo, crew, verification), 1 + len(self.units) - len(self.todo)):
            with deferred():
                keep(unit, report.data)
            total += report.work
            outcomes += report.outcomes
            differences += report.differences
            shared += int(report.outcomes.sum()) // len(unit.places) * (len(unit.places) - 1)
            verification.seen |= report.seen
            if options.progress:
                options.progress(done, len(self.units))
        check_for_a_stop()
        outcomes[Outcome.NOT_COMPUTED] = scene.cells - outcomes.sum()  # those of other shards
        return Summary(
            structures=len(scene.structures),
            cells=scene.cells,
            run_time=time.perf_counter() - began,
            workers=workers,
            outcomes={o.flag: int(outcomes[o]) for o in Outcome},
            work=total,
            shared_cells=shared,
            checked_by=CHECKED_BY,
            model=scene.method.model,
            records=scene.shape[0] if scene.of_records else 0,
            weighed=scene.weighed,
            differences={d.flag: int(differences[d]) for d in Difference} if "linear" in quantities else {},
            resumed_cells=int(self.before.sum()),
            **verification.compared(),
        )
