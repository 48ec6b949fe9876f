"""`rocking fragility`: the probability that a structure passes a limit state, given the
intensity of a set of motions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import UsageError
from . import equations, ground, options
from .command import command, group, partly, refuse, refuse_together
from .draws import note_left_out, require_spreads
from .fragility_options import FragilityOptions
from .printing import detail, note, printed
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..fragility.exposure import MotionSet
    from ..fragility.fitted_curve import Fit
    from ..fragility.hazard import HazardCurve
    from ..fragility.measures import MotionMember
    from ..fragility.study import Study
    from ..motions.intensity_measures import Measure
    from ..spectra.sweep_options import SweepOptions
    from ..structures import RockingParameters

_WHICH_RATE = (
    "annual rate of overturning: report that of the row exact, which assumes no"
    " lognormal curve and counts the intensities at which a body stands again; the"
    " fitted rows serve the other limit states"
)


@dataclass(frozen=True)
class _Request:
    """What a call asks of structures under a set of motions."""

    structures: Sequence[RockingParameters]
    motions: MotionSet  # the motions, their measure, the levels and the equation
    states: list[float | None]  # limit states |theta|/alpha [-], None for overturning
    methods: list[str]  # of the fits
    hazard: HazardCurve | None  # the hazard curve of the site
    exact: bool  # trace every interval that overturns
    sweep: SweepOptions  # how the cells at the levels are computed


@command(
    "rocking fragility configs/block.yaml --pulses configs/motions/site_pulses.csv"
    " --levels 0.2g:0.7g:11",
    printed,
)
def fragility(
    files: tuple[str, ...] = options.files(),
    motions: ground.BothWays = group(ground.BothWays),
    wanted: FragilityOptions = group(FragilityOptions),
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
    from ..reports.remarks import direction_in_words
    from .fragility_rows import emit_cells, emit_efficiency

    files, shaken = motions.several(files)
    if wanted.counts is not None:
        from .fragility_counts import fit_the_counts

        fit_the_counts(wanted, sweep.overwrite)
        return
    request = _requested(files, motions, shaken, wanted, model, sweep)
    found = _studies(request, wanted)
    if not found:
        note(
            f"{wanted.output}: {sweep.shard} is written; join all shards by rocking"
            " merge, then repeat this with --resume, without --shard"
        )
        return

    again = _standing_again(found)
    if wanted.by is not None:
        from ..fragility.study import of_classes

        found, again = of_classes(found, wanted.by), []
    for study in found:
        if study.drawn is not None and not study.drawn.of_class:
            made = study.drawn.made
            left_out = int(made.size - made.sum())
            note_left_out(study.structure.name, left_out, made.size, study.drawn.fault)
    refused: list[str] = []
    remarks: list[str] = []
    if wanted.cells:
        emit_cells(found)
    elif wanted.efficiency:
        emit_efficiency(found, wanted)
    else:
        refused, remarks = _fit_and_print(found, request, wanted, sweep.overwrite)
    note(
        *refused,
        *remarks,
        *direction_in_words(*request.structures),
        *again,
    )
    detail(
        *model.in_words([request.motions.method], request.structures),
        f"{len(request.motions.members)} motions",
    )
    # of the default limit states some may have no fit
    stated = click.get_current_context().get_parameter_source("limits")
    partly(refused and stated is not click.core.ParameterSource.DEFAULT)


def _requested(
    files: tuple[str, ...],
    motions: ground.BothWays,
    shaken: ground.Ground,
    wanted: FragilityOptions,
    model: equations.Model,
    sweep: options.Sweep,
) -> _Request:
    """Read the structures, motions and options of a call. Raises UsageError for options
    that do not go together, and for an output that cannot be written.
    """
    from ..fragility.exposure import MotionSet
    from ..fragility.hazard_files import read_hazard
    from ..motions.intensity_measures import measure_of
    from ..spectra.sweep_options import SweepOptions

    structures = options.structures_of(files, each=True)
    require_spreads(wanted.draws, structures)
    if wanted.draws is not None:
        refuse("does not go with --draws", "exact", "cells", "efficiency")
        if wanted.figure is None:
            refuse("does not go with --draws", "output")
    if wanted.by is not None:
        refuse("does not go with --by", "exact", "cells", "efficiency", "draws")
        if wanted.methods_of_fits() != ["stripes"]:
            raise click.UsageError("--by goes with --method stripes")
    _refuse_contradictions(shaken, wanted)
    measure = measure_of(wanted.im)
    hazard = (
        None
        if wanted.hazard is None
        else read_hazard(wanted.hazard, measure.name, wanted.site)
    )
    levels = wanted.levels_of(measure)
    states = wanted.limit_states()
    wanted.check_standing(None in states)
    methods = wanted.methods_of_fits()
    members = _members(motions, shaken, wanted)
    (equation,) = model.methods(structures)
    if wanted.export is not None:
        _check_export(wanted, states, methods, measure, shaken, sweep)
    else:
        _check_output(wanted, shaken, sweep)
    settings = SweepOptions(history=options.command_line(), **sweep.writing(structures))
    exact = wanted.exact or (
        hazard is not None and None in states and wanted.by is None
    )
    motion_set = MotionSet(members, measure, levels, equation)
    return _Request(structures, motion_set, states, methods, hazard, exact, settings)


def _refuse_contradictions(shaken: ground.Ground, wanted: FragilityOptions) -> None:
    """Raise click.UsageError for options that need others or contradict each other."""
    if bool(shaken.recordings) == (wanted.pulses is not None):
        raise click.UsageError(
            "no set of motions: give either --motion with records, or --pulses with a"
            " table of pulses"
        )
    if wanted.pulses is not None:
        refuse("does not go with --pulses", *ground.OF_A_PULSE)
    refuse_together("efficiency", "cells", "curve")
    if wanted.hazard is None:
        refuse("goes with --hazard", "site", "standing")
    else:
        refuse("does not go with --hazard", "cells", "efficiency")


def _members(
    motions: ground.BothWays, shaken: ground.Ground, wanted: FragilityOptions
) -> tuple[MotionMember, ...]:
    """Return the motions of the set: pulses of a site, or records."""
    from ..fragility.measures import members_of, shaken_upwards, site_pulses

    if wanted.pulses is not None:
        members = site_pulses(wanted.pulses, motions.scale)
    else:
        members = members_of(shaken.recordings)
    if shaken.upwards is None:
        return members
    return shaken_upwards(members, shaken.upwards)


def _check_export(
    wanted: FragilityOptions,
    states: list[float | None],
    methods: list[str],
    measure: Measure,
    shaken: ground.Ground,
    sweep: options.Sweep,
) -> None:
    """Raise UsageError for an --export that cannot or must not be written."""
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
    check_export(wanted.output, str(wanted.export), measure, sweep.overwrite)
    options.refuse_own_input(wanted.output, shaken.recordings)


def _check_output(
    wanted: FragilityOptions, shaken: ground.Ground, sweep: options.Sweep
) -> None:
    """Raise UsageError for a file of cells that cannot or must not be written."""
    if wanted.output is None or wanted.figure is not None:
        refuse("goes with -o OUT.h5", "resume", "shard", "scheduler")
    if wanted.figure is not None:
        refuse(f"does not go with -o {wanted.figure.name}", "cells", "efficiency")
        options.check_target(wanted.figure, sweep.overwrite)
        return
    if wanted.output is None:
        return
    from ..spectra.file.partial_file import check_output

    if not (sweep.resume and wanted.output.is_file()):
        check_output(wanted.output, sweep.overwrite, sweep.resume)
        options.refuse_own_input(wanted.output, shaken.recordings)


def _studies(request: _Request, wanted: FragilityOptions) -> list[Study]:
    """Return each structure under the set of motions; none if a shard is written."""
    from ..fragility.bootstrap import Resampling
    from ..fragility.study import studies

    drawn = wanted.figure is not None
    path: Path | None = None if wanted.export or drawn else wanted.output
    found = studies(
        request.structures,
        request.motions,
        request.methods,
        Resampling(wanted.samples, wanted.seed),
        sweep=request.sweep,
        path=path,
        exact=request.exact,
        hazard=request.hazard,
        line=ProgressLine,
        draws=None if wanted.draws is None else (wanted.draws, wanted.seed),
    )
    return list(found)


def _fit_and_print(
    found: Sequence[Study], request: _Request, wanted: FragilityOptions, overwrite: bool
) -> tuple[list[str], list[str]]:
    """Fit the curves, write the file of --export and print the rows; return (a sentence
    on each limit state without a fit, remarks).
    """
    from ..fragility.study import fitted
    from ..reports.remarks import direction_in_words
    from .fragility_rows import curves_of, emit_fits

    fits, refused = fitted(found, request.states, request.methods)
    if not fits and not (request.exact and (wanted.curve or request.hazard)):
        note(*direction_in_words(*request.structures))
        raise UsageError(
            refused[0]
            if refused
            else (
                "no limit state for this method: first needs overturning, cloud"
                " needs rotations"
            )
        )
    remarks: list[str] = []
    if wanted.export is not None and wanted.output is not None:
        from ..fragility.exports import share_of, write

        exported = [share_of(study) for study in found] if wanted.exact else fits
        measure = request.motions.measure
        remarks += write(exported, wanted.output, wanted.export, measure, overwrite)

    traced = found if request.exact else []
    emit_fits(fits, traced, wanted)
    if wanted.figure is not None:
        options.FigureFile(wanted.figure, overwrite).draw(curves_of(fits, traced))
    if request.hazard is not None:
        remarks += _remarks_on_rates(fits, traced, request.hazard)
    return refused, remarks


def _remarks_on_rates(
    fits: Sequence[Fit], traced: Sequence[Study], hazard: HazardCurve
) -> list[str]:
    """Return which of two annual rates of overturning to report, and what each rate
    leaves out.
    """
    remarks: list[str] = []
    fitted = any(fit.limit == "overturning" for fit in fits)
    if fitted and any(study.rate_without_fit is not None for study in traced):
        remarks.append(_WHICH_RATE)
    rates = [(f"{fit.structure}, {fit.limit}, {fit.method}", fit.rate) for fit in fits]
    for study in traced:
        name = f"{study.structure.name}, overturning, exact"
        rates.append((name, study.rate_without_fit))
    for name, rate in rates:
        if rate is not None:
            remarks += [f"{name}: {line}" for line in rate.remarks(hazard)]
    return remarks


def _standing_again(found: Sequence[Study]) -> list[str]:
    """Return a line on each structure that stands again at a higher intensity."""
    lines = []
    for study in found:
        if count := study.standing_again:
            at = "one of these levels" if study.intervals is None else "one intensity"
            lines.append(
                f"{study.structure.name}: {count} of {len(study.motions.members)}"
                f" motions overturn it at {at} and not at a larger one"
            )
    return lines
