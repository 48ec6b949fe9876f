"""`rocking fragility`: the probability that a structure passes a limit state, given the intensity of a set of motions."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import UsageError
from . import equations, ground, options
from .command import command, flag, group, option, partly, refuse, refuse_together
from .parameter_types import InputPath, Registered, quantity
from .printing import emit, form, note, printed, units_of
from .progress import ProgressLine

if TYPE_CHECKING:
    import numpy as np

    from ..fragility.measures import Measure
    from ..fragility.study import Fit, Study


_WITH_COUNTS = ("counts", "curve", "samples", "seed", "workers", "overwrite")
_WHICH_RATE = (
    "annual rate of overturning: report that of the row exact, which assumes no lognormal curve "
    "and counts the intensities at which a body stands again; the fitted rows serve the other limit states"
)
_IN_G = re.compile(r"g(?![a-z])", re.IGNORECASE)  # and not in gal


@dataclass(frozen=True)
class Fits:
    """The options of `rocking fragility`."""

    pulses: str | None = option("--pulses", "Site pulses instead of records: CSV of a_g, f_g, weight.", type=InputPath())
    im: str = option("--im", "Intensity measure of the curves.", default="PGA", type=Registered("fragility.measures.MEASURES"))
    levels: str | None = option("--levels", "Levels: START:STOP:N[:log] or a list, with units: 0.1g:1g:10.", metavar="LEVELS")
    limits: str = option("--limit", "Limit states: |theta|/alpha beyond these.", default="0.1,0.5,1,overturning")
    methods: str = option("--method", "One or more of stripes, first and cloud.", default="stripes")
    exact: bool = flag("--exact", "Trace every interval that overturns, for exact shares of overturning motions at every intensity.")
    efficiency: bool = flag(
        "--efficiency", "Print the dispersion for every measure instead; with --exact, from the traced first overturnings."
    )
    cells: bool = flag("--cells", "Print every motion at every level over PGA and PGV/PGA instead, for rocking plot.")
    curve: bool = flag("--curve", "Print points of the curves with their bands instead, for rocking plot.")
    counts: str | None = option("--counts", "Fit given counts: CSV of im, n, z.", type=InputPath())
    hazard: str | None = option("--hazard", "Annual rates with this hazard curve: CSV of OpenQuake, or two columns.", type=InputPath())
    site: str | None = option("--site", "The site of the hazard curve, if the file has several.", metavar="LON,LAT")
    standing: float | None = option(
        "--standing",
        "Time the body has stood, such as 10000yr, to test the hazard curve.",
        type=quantity("number of years"),
        metavar="TIME",
    )
    export: str | None = option(
        "--export", "Write -o for this program: NRML (.xml), or CSV and JSON (.csv).", type=click.Choice(["openquake", "pelicun"])
    )
    samples: int = option("--bootstrap", "Samples for the bands; 0: no bands.", type=click.IntRange(0, 100_000), default=1000)
    seed: int = option("--seed", "Seed of the bootstrap.", type=click.IntRange(0), default=0)
    output: Path | None = options.output("The HDF5 file of all cells (records), or that of --export.")


@command("rocking fragility configs/block.yaml --pulses configs/motions/site_pulses.csv --levels 0.2g:0.7g:11", printed)
def fragility(
    files: tuple[str, ...] = options.files(),
    motions: ground.BothWays = group(ground.BothWays),
    wanted: Fits = group(Fits),
    model: equations.Model = group(equations.Model),
    sweep: options.Sweep = group(options.Sweep),
) -> None:
    """Fit lognormal fragility curves of structures under a set of records or site pulses.

    One row for each structure, limit state and method: median theta of the intensity measure, dispersion beta, and the 95 % bands of
    both by bootstrap over the motions. Measures: PGA, PGV, PGD, Arias, CAV, SA(T) and AvgSA(T) of records, nPGA = PGA/(lambda g),
    nPGV = p PGV/(g tan alpha) and nPGD = p^2 PGD/(g tan alpha).
    """
    from ..dynamics.method import direction_in_words
    from ..fragility.exposure import MotionSet
    from ..fragility.fits import Resampling
    from ..fragility.hazard import read_hazard
    from ..fragility.measures import measure_of, members_of, shaken_upwards, site_pulses
    from ..fragility.study import EFFICIENCY_COLUMNS, METHODS, counted, fitted, studies

    files, shaken = motions.several(files)
    if wanted.counts is not None:
        refuse("does not go with --counts", *(click.get_current_context().params.keys() - set(_WITH_COUNTS)))
        _emit(counted(wanted.counts, Resampling(wanted.samples, wanted.seed)), [], wanted)
        return
    structures, texts = options.structures_of(files, each=True)
    if bool(shaken.recordings) == (wanted.pulses is not None):
        raise click.UsageError("no set of motions: give either --motion with records, or --pulses with a table of pulses")
    if wanted.pulses is not None:
        refuse("does not go with --pulses", "pulse", "cycles", "gamma", "phase")
    refuse_together("efficiency", "cells", "curve")
    measure = measure_of(wanted.im)
    if wanted.hazard is None:
        refuse("goes with --hazard", "site", "standing")
    else:
        refuse("does not go with --hazard", "cells", "efficiency")
    hazard = None if wanted.hazard is None else read_hazard(wanted.hazard, measure.name, wanted.site)
    levels = _levels(wanted.levels, measure)
    states = dict.fromkeys(_each("--limit", wanted.limits, _limit, "positive values of |theta|/alpha, or overturning"))
    if wanted.standing is not None and not (wanted.standing > 0.0 and None in states):
        raise click.UsageError("--standing goes with a positive time and the limit state overturning")
    methods = dict.fromkeys(_each("--method", wanted.methods, lambda name: METHODS[METHODS.index(name)], ", ".join(METHODS)))
    members = site_pulses(wanted.pulses, motions.scale) if wanted.pulses is not None else members_of(shaken.recordings)
    if shaken.upwards is not None:
        members = shaken_upwards(members, shaken.upwards)
    (equation,) = model.methods(structures)
    if wanted.export is not None:
        from ..fragility.exports import check_export

        refuse("does not go with --export", "resume", "shard", "scheduler", "cells", "efficiency")
        if wanted.output is None:
            raise click.UsageError("--export goes with -o FILE")
        if len(methods) > 1:
            raise click.UsageError("--export goes with one --method")
        if wanted.exact and None not in states:
            raise click.UsageError("--export of exact shares goes with the limit state overturning")
        check_export(wanted.output, wanted.export, measure, sweep.overwrite)
        options.refuse_own_input(wanted.output, shaken.recordings)
    elif wanted.output is not None:
        from ..spectra.file.writer import check_output

        if not (sweep.resume and wanted.output.is_file()):
            check_output(wanted.output, sweep.overwrite, sweep.resume)
            options.refuse_own_input(wanted.output, shaken.recordings)
    else:
        refuse("goes with -o OUT.h5", "resume", "shard", "scheduler")
    from ..spectra.sweep import SweepOptions

    how = Resampling(wanted.samples, wanted.seed)
    settings = SweepOptions(history=options.command_line(), **sweep.writing(texts))
    shaking, path = MotionSet(members, measure, levels, equation), None if wanted.export else wanted.output
    exact = wanted.exact or (hazard is not None and None in states)
    found = list(studies(structures, shaking, methods, how, sweep=settings, path=path, exact=exact, hazard=hazard, line=ProgressLine))
    if not found:
        note(
            f"{wanted.output}: {sweep.shard} is written; join all shards by rocking merge, then repeat this with --resume, without --shard"
        )
        return
    direction = direction_in_words(*structures)
    refused: list[str] = []
    remarks: list[str] = []
    if wanted.cells:
        from ..fragility.study import CELL_COLUMNS

        emit([row for study in found for row in study.cells()], CELL_COLUMNS)
    elif wanted.efficiency:
        _in_units([row for study in found for row in study.efficiency()], EFFICIENCY_COLUMNS, wanted)
    else:
        fits, refused = fitted(found, states, methods)
        if not fits and not (exact and (wanted.curve or hazard)):
            note(*direction)
            raise UsageError(refused[0] if refused else "no limit state for this method: first needs overturning, cloud needs rotations")
        if wanted.export is not None and wanted.output is not None:
            from ..fragility.exports import share_of, write

            exported = [share_of(study) for study in found] if wanted.exact else fits
            remarks += write(exported, wanted.output, wanted.export, measure, sweep.overwrite)
        _emit(fits, found if exact else [], wanted)
        if hazard is not None:
            rated = [(f"{fit.structure}, {fit.limit}, {fit.method}", fit.rate) for fit in fits]
            rated += [(f"{study.structure.name}, overturning, exact", study.rate_without_fit) for study in found if exact]
            two_rates = any(fit.limit == "overturning" for fit in fits)
            if two_rates and any(exact and study.rate_without_fit is not None for study in found):
                remarks.append(_WHICH_RATE)
            remarks += [f"{name}: {words}" for name, rate in rated if rate is not None for words in rate.remarks(hazard)]
    note(*refused, *remarks, *model.in_words([equation], structures), *direction, f"{len(members)} motions")
    for study in found:
        if count := study.resurrections:
            at = "one of these levels" if study.intervals is None else "one intensity"
            note(f"{study.structure.name}: {count} of {len(members)} motions overturn it at {at} and not at a larger one")
    stated = click.get_current_context().get_parameter_source("limits") is not click.core.ParameterSource.DEFAULT
    partly(refused and stated)  # of the default limit states some may have no fit


def _emit(fits: "Sequence[Fit]", exact: "Sequence[Study]", wanted: Fits) -> None:
    """Print the rows of fits, or with --curve those of curves. A table, and any output with --units, states the unit of the measure."""
    from ..fragility.hazard import RATE_COLUMNS
    from ..fragility.study import CURVE_COLUMNS, FRAGILITY_COLUMNS, HAZARD_COLUMNS

    if wanted.curve:
        rows = [row for fit in fits for row in fit.points_of_curve()] + [row for study in exact for row in study.exact_rows()]
        emit(rows, CURVE_COLUMNS + (HAZARD_COLUMNS if wanted.hazard is not None else ()), without=("x",))
        return
    rows = [fit.row() for fit in fits]
    if wanted.hazard is not None:
        rows += [study.exact_row() for study in exact]
    if wanted.standing is not None:
        for row in rows:
            falls = row["limit_state"] == "overturning"
            row |= {"rejected": -math.expm1(-row["annual_rate"] * wanted.standing) if falls else None}
    _in_units(rows, FRAGILITY_COLUMNS + (RATE_COLUMNS if wanted.hazard is not None else ()), wanted)


def _in_units(rows: list[dict[str, Any]], columns: tuple[str, ...], wanted: Fits) -> None:
    """Print rows of a median in the unit of their measure. Tables do not show theta, the median under its old name."""
    from ..documents.quantities import headed
    from ..reports.units import Units, dimension_of, parse_units

    asked, shown, shown_rows = units_of(), form(), []
    shown_units = asked or (parse_units("g") if shown is None and _IN_G.search(wanted.levels or "") else Units())
    for row in rows:
        if shown != "json":
            dimension = dimension_of(row["im"].lower())
            unit, factor = ("", 1.0) if dimension is None else shown_units.of(dimension)
            row |= {k: x / factor for k, x in row.items() if k.startswith(("median", "theta")) and x is not None}
            if shown is None or asked is not None:
                row["im"] = headed(row["im"], unit)
            if shown is None:
                row = {k: x for k, x in row.items() if not k.startswith("theta")}
            else:
                row = {headed(k, unit) if k.startswith("median") else k: x for k, x in row.items()}
        shown_rows.append(row)
    emit(
        shown_rows, () if shown_rows else columns, without=("theta",), unseen=("rate_without_fit",)
    )  # the rows have units in their headings


def _each(flag: str, text: str, read: Callable[[str], Any], expected: str = "") -> list[Any]:
    """Return read(word) for each word between commas. Raises UsageError, which names `expected`, if read raises ValueError."""
    found: list[Any] = []
    for part in map(str.strip, text.split(",")):
        try:
            found.append(read(part))
        except ValueError as error:
            raise click.UsageError(f"{flag}: found {part!r}; expected {expected or error}") from None
    return found


def _levels(text: str | None, measure: "Measure") -> "np.ndarray":
    """Return the levels that --levels states, in SI. Raises UsageError."""
    import numpy as np

    from ..documents.quantities import parse_quantity
    from ..fragility.fits import check_levels
    from ..motions.grid import parse_span

    if text is None:
        raise click.UsageError(f"no --levels; expected START:STOP:N[:log] of {measure.name}, or a list, such as 0.1g:1g:10")
    if ":" in text:
        options.remark_on(spans=f"{measure.name}={text}")
        return check_levels(parse_span("--levels", text, measure.dimension))
    return check_levels(np.array(_each("--levels", text, lambda part: parse_quantity(part, measure.dimension))))


def _limit(text: str) -> float | None:
    """Return the limit state that a text states: a value of |theta|/alpha, or None for overturning. Raises ValueError."""
    value = None if text == "overturning" else float(text)
    if value is not None and not 0.0 < value < 1e3:
        raise ValueError
    return value
