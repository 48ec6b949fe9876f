"""`rocking check`: does each structure stand, and how much more would it take."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import ground, options
from .parameter_types import OutputPath
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..envelopes.limit import Limit
    from ..motions import Motion
    from ..motions.biaxial import Upwards
    from ..motions.grid import Grid
    from ..motions.recording import Recording
    from ..responses.check import Verdict


@click.command(epilog="Example: rocking check configs/block.yaml configs/arch.yaml --a-g 0.35g --f-g 1.5 --sort capacity")
@options.files
@ground.motions
@ground.vertical_of_each
@ground.shaking
@options.a_max
@click.option("--sort", type=click.Choice(["capacity"]), help="The weakest first, those that never overturn last.")
@click.option("--fail-on", type=click.Choice(["overturning"]), help="Exit code 5 where a structure falls or loses the ground.")
@click.option("-o", "--output", type=OutputPath(), help="A figure of the capacities: .png, .svg or .pdf.")
@options.overwrite
@options.workers
@options.output_form
@options.quiet
@click.pass_context
def check(
    context: click.Context,
    files: tuple[str, ...],
    motion: Motion | None,
    recordings: tuple[Recording, ...],
    shaking: Grid | None,
    upwards: Upwards | None,
    a_max: Limit,
    sort: str | None,
    fail_on: str | None,
    output: Path | None,
    overwrite: bool,
    workers: int | None,
    form: str | None,
    quiet: bool,
) -> None:
    """Check which structures stand under a motion, and how much more it would take to overturn them.

    A row a structure and motion: the outcome and theta_max/alpha by the equation that governs (nonlinear for a known geometry in units:
    a_g, f_g, a record; linear on dimensionless axes, A, Omega, and for stated parameters); demand_a, the amplitude asked for;
    uplift_a and first_overturning_a, the least amplitudes that lift and overturn it; capacity_demand, the latter over the demand,
    below 1 where the body falls or would for less, empty where nothing overturns up to --a-max and twice the demand; safe_to, where
    the stretch around the demand that stands ends; outcome_linear, the linear verdict; friction and fz_min, the coefficient
    that the ground must have and the least vertical force over the weight of a rigid body. Accelerations are in m/s2
    (JSON, CSV) or in the unit of the request (table), unless --units says otherwise.
    """
    from ..dynamics.outcome import Outcome
    from ..envelopes.capacity import narrowest
    from ..motions.grid import as_recorded
    from ..publishing import check_target
    from ..responses.check import CHECK_COLUMNS, check_all

    structures = options.structures_of(files)
    if shaking is None and not recordings:
        raise click.UsageError("no shaking: give --a-g and --omega-g (or --f-g, --T-g), or --motion FILE")
    if output is not None:
        check_target(output, overwrite, options.FIGURES)
    shakes: list[tuple[Motion, Grid]] = [(r.motion, shaking or as_recorded(r.acceleration)) for r in recordings]
    if motion is not None and shaking is not None:
        shakes.append((motion, shaking))
    if upwards is not None:
        shakes = [(upwards(shake), grid) for shake, grid in shakes]
    demands = [(structure, *shake) for shake in shakes for structure in structures]
    tell = partial(options.note, quiet=quiet)
    progress = ProgressLine("check", quiet, "stages")
    verdicts = check_all(demands, a_max=a_max, workers=options.at_most_the_cpus(workers, quiet), progress=progress)
    if sort:
        verdicts.sort(key=lambda v: float("inf") if v.capacity_demand is None else v.capacity_demand)
    in_g = _in_g(context.params)
    if output is not None:
        from ..reports.figures.capacities import draw_capacities

        draw_capacities(verdicts, output, in_g=in_g, overwrite=overwrite, tell=tell)
    options.emit([v.record() for v in verdicts], form, CHECK_COLUMNS, table_units="g" if in_g else None)
    options.note_demand(shakes, quiet)
    options.note_governing(structures, shakes[0][1].dimensionless, quiet)
    for line in _remarks(verdicts):
        options.note(line, quiet)
    width = " or ".join(dict.fromkeys(narrowest(shake) for shake, _ in shakes))
    options.note(f"nothing is claimed of intervals narrower than {width}, safe or overturning, away from the demand", quiet)
    if fail_on and any(v.falls for v in verdicts):
        context.exit(5)
    if any(v.outcome == Outcome.FAILED for v in verdicts):
        context.exit(4)


def _in_g(given: dict[str, Any]) -> bool:
    """Whether the request speaks of g; of a record it does unless it says otherwise."""
    units = options.units_of()
    if units is not None and "acceleration" in units.chosen:
        return units.of("acceleration")[0] == "g"
    text = given["a_g"] or given["scale_to"] or ("g" if given["motion_files"] else "")
    return bool(text.rstrip().endswith("g"))


def _remarks(verdicts: list[Verdict]) -> list[str]:
    """What the table's columns do not say aloud."""

    several = len({v.motion for v in verdicts}) > 1

    def named(found: Iterable[Verdict]) -> list[str]:
        return [f"{v.name} under {v.motion}" if several else v.name for v in found]

    falls = named(v for v in verdicts if v.outcome.overturned)
    window = named(v for v in verdicts if v.outcome.safe and v.capacity_demand is not None and v.capacity_demand < 1.0)
    unsafe = named(v for v in verdicts if v.falls and v.outcome_linear.safe)
    lines = [f"{len(falls)} of {len(verdicts)} overturn{': ' if falls else ''}{', '.join(falls)}"]
    if lost := named(v for v in verdicts if v.falls and not v.outcome.overturned):
        lines.append(f"lose contact with the ground, after which nothing is known of them: {', '.join(lost)}")
    if window:
        lines.append(f"stand in a safe window, and would fall for less: {', '.join(window)}")
    if unsettled := named(v for v in verdicts if v.unsettled):
        lines.append(f"hang on the last digits of the demand, so that another amplitude as good decides otherwise: {', '.join(unsettled)}")
    if slides := named(v for v in verdicts if v.slides):
        lines.append(f"would slide, their friction being less than what rocking asks for: {', '.join(slides)}")
    for v in verdicts:
        if v.dust:
            share = f"{100.0 * v.dust:.2g} % of the amplitudes within 5 % of it"
            lines.append(f"{named([v])[0]}: above first_overturning {share} overturn, and narrower intervals may begin below")
    if unsafe:
        lines.append(f"the linear equation says they stand, and is wrong: {', '.join(unsafe)}")
    return lines
