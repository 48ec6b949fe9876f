"""`rocking fragility`: the probability that a structure passes a limit state, given the intensity of a set of motions."""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import UsageError
from . import ground, options, streams
from .parameter_types import InputPath, OutputPath, Registered
from .progress import ProgressLine

if TYPE_CHECKING:
    import numpy as np

    from ..fragility.fits import Resampling
    from ..fragility.measures import Measure
    from ..fragility.study import Fit, Study
    from ..motions import Motion
    from ..motions.biaxial import Upwards
    from ..motions.recording import Recording


def _measures() -> list[str]:
    from ..fragility.measures import MEASURES

    return list(MEASURES)


_SHAPE = ("pulse", "cycles", "gamma", "phase", "scale")  # of a motion that the options describe
_WITH_COUNTS = ("counts", "curve", "samples", "seed", "form", "units", "quiet", "workers", "overwrite")
_IN_G = re.compile(r"g(?![a-z])", re.IGNORECASE)  # and not in gal


def _refuse(context: click.Context, why: str, stray: Callable[[str], bool]) -> None:
    """Raise UsageError for the first parameter given that is one of those, since it would change nothing."""
    for parameter in context.command.params:
        name = parameter.name or ""
        given = context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE
        if isinstance(parameter, click.Argument):
            given = bool(context.params[name])  # click 8.2 calls it given where there is none
        if given and stray(name):
            raise click.UsageError(f"{why} {parameter.opts[-1] if isinstance(parameter, click.Option) else 'structure'}")


@click.command(epilog="Example: rocking fragility configs/block.yaml --pulses configs/motions/site_pulses.csv --levels 0.2g:0.7g:11")
@options.files
@ground.motions
@ground.vertical_of_each
@click.option("--pulses", type=InputPath(), metavar="FILE", help="Site pulses instead of records: CSV of a_g, f_g, weight.")
@click.option("--im", default="PGA", show_default=True, type=Registered(_measures), help="Intensity measure of the curves.")
@click.option("--levels", metavar="LEVELS", help="START:STOP:N[:log] of it, or a list, with units: 0.1g:1g:10.")
@click.option("--limit", "limits", default="0.1,0.5,1,overturning", show_default=True, help="Limit states: |theta|/alpha beyond these.")
@click.option("--method", "fits", default="stripes", show_default=True, help="Of stripes, first and cloud, one or more.")
@click.option("--exact", is_flag=True, help="Trace every interval that overturns: exact shares between levels, and resurrections.")
@click.option("--efficiency", is_flag=True, help="Instead, the dispersion of the first overturning over every measure.")
@click.option("--curve", is_flag=True, help="Instead, points of the curves with their bands: what rocking plot draws.")
@click.option("--counts", type=InputPath(), metavar="FILE", help="Fit counts that exist already: CSV of im, n, z.")
@click.option("--bootstrap", "samples", type=click.IntRange(0, 100_000), default=1000, show_default=True, help="Draws for bands; 0: none.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed of these draws.")
@click.option("-o", "--output", type=OutputPath(), help="The HDF5 file of all cells to write (records).")
@options.method
@options.workers
@options.overwrite
@click.option("--resume", is_flag=True, help="Go on with an interrupted sweep of the same scene, or read a complete one.")
@click.option("--shard", metavar="I/N", help="Compute the I-th of N parts only; rocking merge puts them together.")
@click.option("--scheduler", metavar="ADDRESS", help="Compute on a dask.distributed cluster, such as tcp://host:8786.")
@options.output_form
@options.quiet
@click.pass_context
def fragility(
    context: click.Context,
    files: tuple[str, ...],
    motion: Motion | None,
    recordings: tuple[Recording, ...],
    upwards: Upwards | None,
    pulses: str | None,
    im: str,
    levels: str | None,
    limits: str,
    fits: str,
    exact: bool,
    efficiency: bool,
    curve: bool,
    counts: str | None,
    samples: int,
    seed: int,
    output: Path | None,
    model: str | None,
    tolerance: float,
    workers: int | None,
    overwrite: bool,
    resume: bool,
    shard: str | None,
    scheduler: str | None,
    form: str | None,
    quiet: bool,
) -> None:
    """Fit lognormal fragility curves of structures under a set of records or site pulses.

    A row a structure, limit state and method: median theta of the intensity measure, dispersion beta, the 95 % bands of both by
    bootstrap over the motions. stripes: most likely curve of the counts at the levels; first: of the intensities of first
    overturning, traced, the motions that never overturn as censored; cloud: regression on the rotations as recorded. Measures:
    PGA, PGV, PGD, Arias, CAV, and nPGA = PGA/(lambda g), nPGV = p PGV/(g tan alpha), nPGD = p^2 PGD/(g tan alpha).
    """
    from ..dynamics.method import governing_method
    from ..fragility.fits import Resampling
    from ..fragility.measures import measure_of, members_of, shaken_upwards, site_pulses
    from ..fragility.study import counted

    how = Resampling(samples, seed)
    if counts is not None:
        _refuse(context, "--counts stands alone: it takes no", lambda name: name not in _WITH_COUNTS)
        _emit(counted(counts, how), [], curve, form, "")
        return
    structures, texts = options.structures_and_texts(files)
    if bool(recordings) == (pulses is not None):
        raise click.UsageError("no set of motions: give --motion with records, or --pulses with a table of them, one of the two")
    if pulses is not None:
        _refuse(context, "--pulses states each pulse itself: it takes no", lambda name: name in _SHAPE)
    if curve and efficiency:
        raise click.UsageError("--efficiency does not go with --curve")
    measure = measure_of(im)
    at = _levels(levels, measure)
    states, methods = _limits(limits), _methods(fits)
    members = site_pulses(pulses) if pulses is not None else members_of(recordings)
    if upwards is not None:
        members = shaken_upwards(members, upwards)
    method = governing_method(*structures, model=model, tolerance=tolerance)
    settled = {
        "overwrite": overwrite, "resume": resume, "shard": None if shard is None else options.part_of(shard), "scheduler": scheduler,
        "documents": texts, "history": streams.printable(shlex.join(["rocking", *sys.argv[1:]])),
        "tell": partial(options.note, quiet=quiet),
    }  # fmt: skip
    if output is not None:
        from ..spectra.file.partial import check_output

        if not (resume and output.is_file()):
            check_output(output, overwrite, resume)
            options.refuse_own_input(output, recordings)
    elif shard is not None or scheduler is not None or resume:
        raise click.UsageError("--shard, --scheduler and --resume go with -o OUT.h5")
    wanted = {"exact": exact or efficiency or "first" in methods, "cloud": "cloud" in methods}
    workers = options.at_most_the_cpus(workers, quiet)
    studies = list(_studies(structures, members, measure, at, method, how, output, workers, settled, wanted, quiet))
    if not studies:
        options.note(f"{output}: {shard} is written; rocking merge puts the parts together, and --resume reads the whole", quiet)
        return
    refused = 0
    if efficiency:
        from ..fragility.study import EFFICIENCY_COLUMNS

        options.emit([row for study in studies for row in study.efficiency()], form, EFFICIENCY_COLUMNS, without=("theta",))
    else:
        refused = _rows(studies, states, methods, exact, curve, form, levels or "", quiet)
    options.note_models([method], structures, [model], False, quiet)
    options.note(f"{len(members)} motions", quiet)
    for study in studies:
        if study.resurrections:
            what = f"{study.resurrections} of {len(members)} motions overturn it at one intensity and spare it at a larger one"
            options.note(f"{study.structure.name}: {what}", quiet)
    if refused and options.given(context, "limits"):  # the default ones are those that there may be
        context.exit(4)


def _studies(
    structures: Any, members: Any, measure: Measure, at: np.ndarray, method: Any, how: Resampling, output: Path | None, workers: int | None,
    settled: dict[str, Any], wanted: dict[str, bool], quiet: bool,
) -> Iterator[Study]:  # fmt: skip
    """What each structure comes to under the set."""
    from ..fragility.exposure import as_recorded, exposures, traced
    from ..fragility.study import Study

    line = ProgressLine("fragility", quiet, "chunks")
    found = exposures(structures, members, measure, at, method, path=output, workers=workers, progress=line, **settled)
    for structure, exposure in zip(structures, found, strict=False):
        intervals = None
        if wanted["exact"]:
            line = ProgressLine(structure.name, quiet, "motions")
            intervals = traced(structure, members, measure, float(at[-1]), method, workers=workers, progress=line)
        recorded = as_recorded(structure, members, method) if wanted["cloud"] else None
        yield Study(structure, members, measure, how, exposure, intervals, recorded)


def _rows(studies: list[Study], states: Any, methods: Any, exact: bool, curve: bool, form: str | None, levels: str, quiet: bool) -> int:
    """Print the fits, and say which the data do not bear; how many. Raises UsageError where there is none."""
    fits, faults = [], []
    for study in studies:
        for method in methods:
            for state in states:
                if (method == "first") != (state is None) and method != "stripes":
                    continue  # first is of overturning, cloud of rotations
                try:
                    fits.append(study.fit(method, state))
                except UsageError as error:
                    from ..fragility.study import word_of

                    faults.append(f"{study.structure.name}, {word_of(state)}, {method}: {error}")
    if not fits and not (exact and curve):
        raise UsageError(faults[0] if faults else "no limit state that this method fits: first is of overturning, cloud of rotations")
    _emit(fits, studies if exact else [], curve, form, levels)
    for fault in faults:
        options.note(fault, quiet)
    return len(faults)


def _emit(fits: list[Fit], exact: list[Study], curve: bool, form: str | None, levels: str) -> None:
    """The rows of fits or of their curves; a table for people, or one in units asked for, names the measure's unit."""
    from ..documents.quantities import headed
    from ..fragility.study import CURVE_COLUMNS, FRAGILITY_COLUMNS
    from ..reports.units import Units, dimension_of, parse_units

    if curve:
        rows = [row for fit in fits for row in fit.points_of_curve()] + [row for study in exact for row in study.exact_rows()]
        options.emit(rows, form, CURVE_COLUMNS, without=("x",))
        return
    asked = options.units_of()
    told = asked or (parse_units("g") if form is None and _IN_G.search(levels) else Units())
    records = []
    for record in (fit.record() for fit in fits):
        if form != "json":
            dimension = dimension_of(record["im"].lower())
            unit, factor = ("", 1.0) if dimension is None else told.of(dimension)
            record |= {k: x / factor for k, x in record.items() if k.startswith(("median", "theta")) and x is not None}
            if form is None or asked is not None:
                record["im"] = headed(record["im"], unit)
            if form is None:  # theta is the median under its old name, for programs
                record = {k: x for k, x in record.items() if not k.startswith("theta")}
            else:
                record = {headed(k, unit) if k.startswith("median") else k: x for k, x in record.items()}
        records.append(record)
    options.emit(records, form, FRAGILITY_COLUMNS, without=("theta",))


def _levels(text: str | None, measure: Measure) -> np.ndarray:
    """The levels of --levels, in SI. Raises UsageError."""
    import numpy as np

    from ..documents.quantities import parse_quantity
    from ..fragility.fits import check_levels
    from ..motions.grid import parse_span

    if text is None:
        raise click.UsageError(f"no --levels; accepted is START:STOP:N[:log] of {measure.name}, or a list, such as 0.1g:1g:10")
    if ":" in text:
        options.remark_on(spans=f"{measure.name}={text}")
        return check_levels(parse_span("--levels", text, measure.dimension))
    found = []
    for part in text.split(","):
        try:
            found.append(parse_quantity(part.strip(), measure.dimension))
        except ValueError as error:
            raise click.UsageError(f"--levels: found {part.strip()!r}; accepted is {error}") from None
    return check_levels(np.array(found))


def _limits(text: str) -> list[float | None]:
    found: list[float | None] = []
    for part in (x.strip() for x in text.split(",")):
        try:
            value = None if part == "overturning" else float(part)
        except ValueError:
            value = -1.0
        if value is not None and not 0.0 < value < 1e3:
            raise click.UsageError(f"--limit: found {part!r}; accepted are positive values of |theta|/alpha, and overturning")
        if value not in found:
            found.append(value)
    return found


def _methods(text: str) -> list[str]:
    from ..fragility.study import METHODS

    found = [x.strip() for x in text.split(",")]
    for name in found:
        if name not in METHODS:
            raise click.UsageError(f"--method: found {name!r}; accepted are {', '.join(METHODS)}")
    return list(dict.fromkeys(found))
