"""`rocking fragility`: the probability that a structure passes a limit state, given the
intensity of a set of motions.
"""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import UsageError
from . import equations, ground, options
from .command import (
    command,
    flag,
    given,
    group,
    option,
    partly,
    refuse,
    refuse_together,
)
from .parameter_types import InputPath, Registered, quantity
from .printing import emit, form, note, printed, units_of, units_shown
from .progress import ProgressLine

if TYPE_CHECKING:
    import numpy as np

    from ..fragility.measures import Measure
    from ..fragility.study import Fit, Study


_WITH_COUNTS = (
    "counts",
    "im",
    "limits",
    "curve",
    "samples",
    "seed",
    "workers",
    "hazard",
    "site",
    "standing",
    "export",
    "output",
    "overwrite",
)
_WHICH_RATE = (
    "annual rate of overturning: report that of the row exact, which assumes no"
    " lognormal curve and counts the intensities at which a body stands again; the"
    " fitted rows serve the other limit states"
)


@dataclass(frozen=True)
class Fits:
    """The options of `rocking fragility`."""

    pulses: str | None = option(
        "--pulses",
        "Site pulses instead of records: CSV of a_g, f_g, weight.",
        type=InputPath(),
    )
    im: str = option(
        "--im",
        "Intensity measure of the curves.",
        default="PGA",
        type=Registered("fragility.measures.MEASURES"),
    )
    levels: str | None = option(
        "--levels",
        "Levels: START:STOP:N[:log] or a list, with units: 0.1g:1g:10.",
        metavar="LEVELS",
    )
    limits: str = option(
        "--limit",
        "Limit states: |theta|/alpha beyond these.",
        default="0.1,0.5,1,overturning",
    )
    methods: str = option(
        "--method", "One or more of stripes, first and cloud.", default="stripes"
    )
    exact: bool = flag(
        "--exact",
        "Trace every interval that overturns, for exact shares of overturning motions"
        " at every intensity.",
    )
    efficiency: bool = flag(
        "--efficiency",
        "Print the dispersion for every measure instead; with --exact, from the traced"
        " first overturnings.",
    )
    cells: bool = flag(
        "--cells",
        "Print every motion at every level over PGA and PGV/PGA instead, for rocking"
        " plot.",
    )
    curve: bool = flag(
        "--curve",
        "Print points of the curves with their bands instead, for rocking plot.",
    )
    counts: str | None = option(
        "--counts",
        "Fit given counts: CSV of im, n, z; im may state its unit, as PGA [g].",
        type=InputPath(),
    )
    hazard: str | None = option(
        "--hazard",
        "Annual rates with this hazard curve: CSV of OpenQuake, or two columns.",
        type=InputPath(),
    )
    site: str | None = option(
        "--site",
        "The site of the hazard curve, if the file has several.",
        metavar="LON,LAT",
    )
    standing: float | None = option(
        "--standing",
        "Time the body has stood, such as 10000yr, to test the hazard curve.",
        type=quantity("number of years"),
        metavar="TIME",
    )
    export: str | None = option(
        "--export",
        "Write -o for this program: NRML (.xml), or CSV and JSON (.csv).",
        type=click.Choice(["openquake", "pelicun"]),
    )
    samples: int = option(
        "--bootstrap",
        "Samples for the bands; 0: no bands.",
        type=click.IntRange(0, 100_000),
        default=1000,
    )
    seed: int = option(
        "--seed", "Seed of the bootstrap.", type=click.IntRange(0), default=0
    )
    output: Path | None = options.output(
        "The HDF5 file of all cells (records), or that of --export."
    )


@command(
    "rocking fragility configs/block.yaml --pulses configs/motions/site_pulses.csv"
    " --levels 0.2g:0.7g:11",
    printed,
)
def fragility(
    files: tuple[str, ...] = options.files(),
    motions: ground.BothWays = group(ground.BothWays),
    wanted: Fits = group(Fits),
    model: equations.Model = group(equations.Model),
    sweep: options.Sweep = group(options.Sweep),
) -> None:
    """Fit lognormal fragility curves of structures under a set of records or site
    pulses.

    One row for each structure, limit state and method: median of the intensity measure,
    dispersion beta, and the 95 % bands of both by bootstrap over the motions. Measures:
    PGA, PGV, PGD, Arias, CAV, SA(T) and AvgSA(T) of records, nPGA = PGA/(lambda g),
    nPGV = p PGV/(g tan alpha) and nPGD = p^2 PGD/(g tan alpha).
    """
    from ..dynamics.method import direction_in_words
    from ..fragility.exposure import MotionSet
    from ..fragility.fits import Resampling
    from ..fragility.hazard import read_hazard
    from ..fragility.measures import measure_of, members_of, shaken_upwards, site_pulses
    from ..fragility.study import METHODS, fitted, studies

    files, shaken = motions.several(files)
    if wanted.counts is not None:
        refuse(
            "does not go with --counts",
            *(click.get_current_context().params.keys() - set(_WITH_COUNTS)),
        )
        _of_counts(wanted, sweep.overwrite)
        return
    structures, texts = options.structures_of(files, each=True)
    if bool(shaken.recordings) == (wanted.pulses is not None):
        raise click.UsageError(
            "no set of motions: give either --motion with records, or --pulses with a"
            " table of pulses"
        )
    if wanted.pulses is not None:
        refuse("does not go with --pulses", "pulse", "cycles", "gamma", "phase")
    refuse_together("efficiency", "cells", "curve")
    measure = measure_of(wanted.im)
    if wanted.hazard is None:
        refuse("goes with --hazard", "site", "standing")
    else:
        refuse("does not go with --hazard", "cells", "efficiency")
    hazard = (
        None
        if wanted.hazard is None
        else read_hazard(wanted.hazard, measure.name, wanted.site)
    )
    levels = _levels(wanted.levels, measure)
    states = dict.fromkeys(
        _each(
            "--limit",
            wanted.limits,
            _limit,
            "positive values of |theta|/alpha, overturning, or slide=LENGTH",
        )
    )
    if wanted.standing is not None and not (wanted.standing > 0.0 and None in states):
        raise click.UsageError(
            "--standing goes with a positive time and the limit state overturning"
        )
    methods = dict.fromkeys(
        _each(
            "--method",
            wanted.methods,
            lambda name: METHODS[METHODS.index(name)],
            ", ".join(METHODS),
        )
    )
    members = (
        site_pulses(wanted.pulses, motions.scale)
        if wanted.pulses is not None
        else members_of(shaken.recordings)
    )
    if shaken.upwards is not None:
        members = shaken_upwards(members, shaken.upwards)
    (equation,) = model.methods(structures)
    if wanted.export is not None:
        from ..fragility.exports import check_export

        refuse(
            "does not go with --export",
            "resume",
            "shard",
            "scheduler",
            "cells",
            "efficiency",
        )
        if wanted.output is None:
            raise click.UsageError("--export goes with -o FILE")
        if len(methods) > 1:
            raise click.UsageError("--export goes with one --method")
        if wanted.exact and None not in states:
            raise click.UsageError(
                "--export of exact shares goes with the limit state overturning"
            )
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
    shaking, path = (
        MotionSet(members, measure, levels, equation),
        None if wanted.export else wanted.output,
    )
    exact = wanted.exact or (hazard is not None and None in states)
    found = list(
        studies(
            structures,
            shaking,
            methods,
            how,
            sweep=settings,
            path=path,
            exact=exact,
            hazard=hazard,
            line=ProgressLine,
        )
    )
    if not found:
        note(
            f"{wanted.output}: {sweep.shard} is written; join all shards by rocking"
            " merge, then repeat this with --resume, without --shard"
        )
        return
    direction = direction_in_words(*structures)
    refused: list[str] = []
    remarks: list[str] = []
    if wanted.cells:
        from ..fragility.study import CELL_COLUMNS, CELL_KEYS

        emit(
            [row for study in found for row in study.cells()],
            CELL_COLUMNS,
            keys=CELL_KEYS,
        )
    elif wanted.efficiency:
        _emit_efficiency([row for study in found for row in study.efficiency()], wanted)
    else:
        fits, refused = fitted(found, states, methods)
        if not fits and not (exact and (wanted.curve or hazard)):
            note(*direction)
            raise UsageError(
                refused[0]
                if refused
                else (
                    "no limit state for this method: first needs overturning, cloud"
                    " needs rotations"
                )
            )
        if wanted.export is not None and wanted.output is not None:
            from ..fragility.exports import share_of, write

            exported = [share_of(study) for study in found] if wanted.exact else fits
            remarks += write(
                exported, wanted.output, wanted.export, measure, sweep.overwrite
            )
        _emit(fits, found if exact else [], wanted)
        if hazard is not None:
            rated = [
                (f"{fit.structure}, {fit.limit}, {fit.method}", fit.rate)
                for fit in fits
            ]
            rated += [
                (f"{study.structure.name}, overturning, exact", study.rate_without_fit)
                for study in found
                if exact
            ]
            two_rates = any(fit.limit == "overturning" for fit in fits)
            if two_rates and any(
                exact and study.rate_without_fit is not None for study in found
            ):
                remarks.append(_WHICH_RATE)
            remarks += [
                f"{name}: {words}"
                for name, rate in rated
                if rate is not None
                for words in rate.remarks(hazard)
            ]
    note(
        *refused,
        *remarks,
        *model.in_words([equation], structures),
        *direction,
        f"{len(members)} motions",
    )
    for study in found:
        if count := study.resurrections:
            at = "one of these levels" if study.intervals is None else "one intensity"
            note(
                f"{study.structure.name}: {count} of {len(members)} motions overturn it"
                f" at {at} and not at a larger one"
            )
    stated = (
        click.get_current_context().get_parameter_source("limits")
        is not click.core.ParameterSource.DEFAULT
    )
    partly(refused and stated)  # of the default limit states some may have no fit


def _of_counts(wanted: Fits, overwrite: bool) -> None:
    """Fit the counts of --counts, with the annual rate of --hazard and the file of
    --export.
    """
    from ..fragility.counts import fit_counts, read_counts
    from ..fragility.exports import check_export, write
    from ..fragility.fits import Resampling
    from ..fragility.hazard import read_hazard
    from ..fragility.study import word_of

    limit = "counted"
    if given("limits"):
        states = _each(
            "--limit",
            wanted.limits,
            _limit,
            "a positive value of |theta|/alpha, or overturning",
        )
        if len(states) != 1:
            raise click.UsageError(
                f"--limit: found {wanted.limits!r}; expected the one limit state that"
                " --counts has counted"
            )
        limit = word_of(states[0])
    if wanted.hazard is None:
        refuse("goes with --hazard", "site", "standing")
    elif wanted.standing is not None and not (
        wanted.standing > 0.0 and limit == "overturning"
    ):
        raise click.UsageError(
            "--standing goes with a positive time and --limit overturning"
        )
    if (wanted.export is None) != (wanted.output is None):
        raise click.UsageError(
            "--export goes with -o FILE, and with --counts -o FILE goes with --export"
        )
    needed = wanted.hazard is not None or wanted.export is not None
    counts = read_counts(
        str(wanted.counts), wanted.im if given("im") else None, needs_measure=needed
    )
    hazard = None
    if counts.measure is not None:
        if wanted.export is not None and wanted.output is not None:
            check_export(wanted.output, wanted.export, counts.measure, overwrite)
            options.refuse_own_input(wanted.output)
        hazard = (
            None
            if wanted.hazard is None
            else read_hazard(wanted.hazard, counts.measure.name, wanted.site)
        )
    fits = [
        fit_counts(
            counts, Resampling(wanted.samples, wanted.seed), hazard=hazard, limit=limit
        )
    ]
    remarks = [f"{counts.source}: {counts.remark}"] if counts.remark else []
    if (
        counts.measure is not None
        and wanted.export is not None
        and wanted.output is not None
    ):
        remarks += write(fits, wanted.output, wanted.export, counts.measure, overwrite)
    _emit(fits, [], wanted, counts.unit)
    if hazard is not None:
        remarks += [
            f"{fit.structure}: {words}"
            for fit in fits
            if fit.rate is not None
            for words in fit.rate.remarks(hazard)
        ]
    note(*remarks)


def _emit(
    fits: "Sequence[Fit]", exact: "Sequence[Study]", wanted: Fits, unit: str = ""
) -> None:
    """Print the rows of fits, or with --curve those of curves; unit: of the levels, as
    they are stated.
    """
    from ..fragility.hazard import RATE_COLUMNS
    from ..fragility.study import (
        CURVE_COLUMNS,
        CURVE_KEYS,
        FRAGILITY_COLUMNS,
        FRAGILITY_KEYS,
        HAZARD_COLUMNS,
    )
    from ..reports.units import OF_THE_MEASURE, dimension_of_measure

    columns: tuple[str, ...]
    keys: tuple[str, ...]
    measure = fits[0].im if fits else exact[0].motions.measure.name
    if wanted.curve:
        rows = [row for fit in fits for row in fit.points_of_curve()]
        rows += [row for study in exact for row in study.exact_rows()]
        columns, keys = CURVE_COLUMNS, CURVE_KEYS
        of_hazard: tuple[str, ...] = HAZARD_COLUMNS
    else:
        rows = [fit.row() for fit in fits]
        if wanted.hazard is not None:
            rows += [study.exact_row() for study in exact]
        _add_rejected(rows, wanted.standing)
        _name_the_unit(rows)
        columns, keys, of_hazard = FRAGILITY_COLUMNS, FRAGILITY_KEYS, RATE_COLUMNS

    if wanted.hazard is not None:
        columns = (*columns, *of_hazard)
    emit(
        rows,
        columns,
        keys=keys,
        table_units=_table_units(unit or _unit_of_levels(wanted)),
        dimensions=dict.fromkeys(OF_THE_MEASURE, dimension_of_measure(measure)),
        unseen=("rate_without_fit",),
    )


def _add_rejected(rows: list[dict[str, Any]], standing: float | None) -> None:
    """Add the probability that a body would have fallen in the years that
    it has stood.
    """
    if standing is None:
        return
    for row in rows:
        falls = row["limit_state"] == "overturning"
        row["rejected"] = -math.expm1(-row["annual_rate"] * standing) if falls else None


def _name_the_unit(rows: list[dict[str, Any]]) -> None:
    """State the unit beside the measure too, in a CSV whose units are asked for."""
    from ..documents.quantities import headed
    from ..reports.units import dimension_of_measure

    units = units_of()
    if form() != "csv" or units is None:
        return
    for row in rows:
        dimension = dimension_of_measure(row["im"])
        if dimension is not None:
            row["im"] = headed(row["im"], units.of(dimension)[0])


def _emit_efficiency(rows: list[dict[str, Any]], wanted: Fits) -> None:
    """Print a row for each measure. In a table and in CSV, its unit stands beside its
    name, because the medians of one column have several.
    """
    from ..documents.quantities import headed
    from ..fragility.study import EFFICIENCY_COLUMNS, EFFICIENCY_KEYS
    from ..reports.units import OF_THE_MEASURE, dimension_of_measure

    units = units_shown(_table_units(_unit_of_levels(wanted)))
    for row in rows if form() != "json" else ():
        dimension = dimension_of_measure(row["im"])
        if dimension is not None:
            unit, factor = units.of(dimension)
            row |= {"im": headed(row["im"], unit), "median": row["median"] / factor}
    dimensions = dict.fromkeys(OF_THE_MEASURE)
    emit(rows, EFFICIENCY_COLUMNS, keys=EFFICIENCY_KEYS, dimensions=dimensions)


def _table_units(unit: str) -> str | None:
    """Return the unit of a table: that of the levels, if a table can have it."""
    from ..reports.units import is_choice

    return unit if is_choice(unit) else None


def _unit_of_levels(wanted: Fits) -> str:
    """Return the first unit that --levels states, an empty text without one."""
    from ..documents.quantities import unit_of

    return next(filter(None, map(unit_of, re.split("[:,]", wanted.levels or ""))), "")


def _each(
    flag: str, text: str, read: Callable[[str], Any], expected: str = ""
) -> list[Any]:
    """Return read(word) for each word between commas. Raises UsageError, which names
    `expected`, if read raises ValueError.
    """
    found: list[Any] = []
    for part in map(str.strip, text.split(",")):
        try:
            found.append(read(part))
        except ValueError as error:
            raise click.UsageError(
                f"{flag}: found {part!r}; expected {expected or error}"
            ) from None
    return found


def _levels(text: str | None, measure: "Measure") -> "np.ndarray":
    """Return the levels that --levels states, in SI. Raises UsageError."""
    import numpy as np

    from ..documents.quantities import parse_quantity, with_a_point
    from ..fragility.fits import check_levels
    from ..motions.grid import parse_span

    if text is None:
        raise click.UsageError(
            f"no --levels; expected START:STOP:N[:log] of {measure.name}, or a list,"
            " such as 0.1g:1g:10"
        )
    if ":" in text:
        options.remark_on(spans=f"{measure.name}={text}")
        return check_levels(parse_span("--levels", text, measure.dimension))
    if with_a_point(text) and "0" in text.split(","):
        raise click.UsageError(
            f"--levels: found {text!r}; expected positive levels, with commas between"
            f" them{with_a_point(text)}"
        )
    return check_levels(
        np.array(
            _each(
                "--levels", text, lambda part: parse_quantity(part, measure.dimension)
            )
        )
    )


def _limit(text: str) -> float | None:
    """Return the limit state that a text states: a value of |theta|/alpha, None for
    overturning, or a displacement such as slide=50mm. Raises ValueError.
    """
    if text.startswith("slide"):
        from ..fragility.exposure import SlideLimit
        from ..responses.sliding import parse_slide

        return SlideLimit(parse_slide("--limit", text, "slide=LENGTH"))
    value = None if text == "overturning" else float(text)
    if value is not None and not 0.0 < value < 1e3:
        raise ValueError
    return value
