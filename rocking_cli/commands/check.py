"""`rocking check`: the verdict and the capacity of each structure under a motion."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import ground, options
from .command import command, flag, group, option, partly, refuse
from .parameter_types import NUMBER, InputPath
from .printing import emit, form, is_quiet, note, printed, units_of
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..envelopes.amplitudes import Limit
    from ..responses.check import Demand, Verdict

INSET = 0.05  # of the width, whose effect on the capacity is stated


@command("rocking check configs/block.yaml configs/arch.yaml --a-g 0.35g --f-g 1.5 --sort capacity", printed)
def check(
    files: tuple[str, ...] = options.files(),
    asked: ground.Directed = group(ground.Directed),
    code: str | None = option("--code", "Check by the Italian code as well: code_linear, code_slv, …", type=click.Choice(["ntc2018"])),
    spectrum: str | None = option("--spectrum", "Spectrum for --code: CSV of T and S_a at 5 % (default: the motion's).", type=InputPath()),
    floor: tuple[str, ...] = option(
        "--floor", "For --code: a mode of the building below the body; repeatable.", multiple=True, metavar="T=…,xi=…,gamma_psi=…"
    ),
    fc: float | None = option("--fc", "Confidence factor of --code (default 1).", type=NUMBER),
    a_max: Limit = options.a_max(),
    sign: str = ground.sign(),
    verdict_only: bool = flag("--verdict-only", "Skip the search; first_overturning_a and safe_to stay empty."),
    vary: tuple[str, ...] = options.vary(),
    sort: str | None = options.sort(),
    fail_on: str | None = option(
        "--fail-on", "Exit code 5 if a structure falls or loses contact, in either direction.", type=click.Choice(["overturning"])
    ),
    output: Path | None = options.output("Draw the capacities: .png, .svg or .pdf."),
    overwrite: bool = options.overwrite(),
    workers: int | None = options.workers(),
) -> int:
    """Check which structures stand under a motion, and find the lowest amplitude that overturns each.

    One row for each structure (a stack: for each interface) and motion: the outcome and theta_max/alpha by the governing equation
    (nonlinear for a known geometry in units: a_g, f_g, a record; linear on dimensionless axes, A, Omega, and for stated parameters);
    top_displacement from the position of rest; demand_a, the amplitude of the motion; uplift_a and first_overturning_a, the lowest
    amplitudes that lift and overturn the body; capacity_demand, first_overturning_a over demand_a, empty if no amplitude up to --a-max and
    twice the demand overturns; safe_to, the end of the safe interval around the demand; outcome_linear; friction_needed and fz_min of a
    rigid body; opens, if a further hinge of an arch opens. Accelerations are in m/s2 (JSON, CSV) or in the unit of the request (table),
    unless --units says otherwise.
    """
    from ..dynamics.method import has_direction
    from ..dynamics.outcome import Outcome
    from ..envelopes.capacity import narrowest
    from ..reports.wording import opposite_in_words
    from ..responses.check import CHECK_COLUMNS, OLD_COLUMNS, TIED_COLUMNS, outcome_alone, verdicts

    files, motions = asked.several(files)
    ends = [end.of(motions) for end in asked.ends()]
    shaken = ends[0] if ends else asked.of(motions)
    if sign != "+" and (ends or asked.azimuth):
        raise click.UsageError(f"--sign {sign} does not go with {'a range of frequencies' if ends else '--azimuth'}")
    shaken = shaken.reversed if sign == "-" else shaken
    structures, varied = options.members_of(files, vary, each=True)
    azimuths = asked.azimuths()
    by_code = None
    if code is None:
        refuse("goes with --code", "spectrum", "floor", "fc")
        if verdict_only:
            refuse("needs the capacities, which --verdict-only does not search", "sort", "output")
    else:
        from .code_rows import CodeRows

        by_code = CodeRows(spectrum, floor, fc)
    if output is not None:
        options.check_target(output, overwrite)
    if by_code and spectrum and not shaken.shakes:
        refuse("needs a motion: under --spectrum alone nothing is shaken", "fail_on", "sort")
        by_code.alone(structures, varied, output, overwrite)
        return 0
    shakes = shaken.needed(*(["--spectrum FILE"] if by_code else []))
    demands = [(structure, *shake) for shake in shakes for structure in structures]
    if sign == "both":
        demands += [(structure, *shake) for shake in shaken.reversed.shakes for structure in structures if has_direction(structure)]
    extra: dict[str, dict[str, float]] = {}  # a further column by structure
    if azimuths is not None:
        from ..responses.azimuth import worst_azimuths

        searched = ProgressLine("azimuths", "checks")
        directed = worst_azimuths(structures, shaken.recordings, azimuths, workers=workers, progress=searched)
        extra, demands = {demand[0].name: {"azimuth": angle} for angle, demand in directed}, [demand for _, demand in directed]
        shakes = [(motion, grid) for _, motion, grid in demands]
        note(f"azimuth: the worst of {azimuths.size} for the demand; at another azimuth the capacity may be less")
        if both := [s.name for s in structures if has_direction(s)]:
            note(f"both signs of each azimuth, because the sides differ: {', '.join(both)}")
    if ends:
        from ..envelopes.worst import at_worst_frequencies

        motion, low, high = *shakes[0], ends[1].shakes[0][1]
        searched = ProgressLine("frequencies", "structures")
        worst = at_worst_frequencies(structures, motion, low, high, a_max, workers=workers, progress=searched)
        demands = [(structure, motion, grid) for structure, (grid, _) in zip(structures, worst, strict=True)]
        shakes = [(motion, low), (motion, high)]
        extra = {one.name: {"worst_f_g": frequency} for one, (_, frequency) in zip(structures, worst, strict=True)}
    if by_code:
        demands = by_code.dynamic(demands)
    judged: list[Verdict] = []
    limit = None if verdict_only else a_max
    found: Iterable[Verdict] = verdicts(demands, a_max=limit, workers=workers, progress=ProgressLine("check", "checks"))
    if sort:
        found = sorted(found, key=lambda verdict: float("inf") if (c := verdict.capacity_demand) is None else c)

    further: tuple[str, ...] = ()  # columns that the first structure may not have
    if form() == "csv":
        further = TIED_COLUMNS * any(s.restraints for s in structures) + ("opens",) * any(s.structure == "arch" for s in structures)

    def rows() -> Iterator[dict[str, Any]]:
        for verdict in found:
            judged.append(verdict)
            head = {"structure": verdict.structure, "motion": verdict.motion, **extra.get(verdict.structure, {})}
            added = by_code.columns(verdict, not verdict_only) if by_code else {}
            row = {**head, **verdict.row(), **added}
            yield row | {key: row.get(key) for key in further}
        yield from by_code.others() if by_code else ()

    in_g = _in_g(asked.a_g or asked.scale_to or ("g" if asked.motion else ""))
    emit(rows(), CHECK_COLUMNS, table_units="g,mm,deg" if in_g else "mm,deg", unseen=OLD_COLUMNS, varied=varied)
    if output is not None and by_code:
        by_code.draw(output, overwrite)
    elif output is not None:
        from ..reports.figures.capacities import draw_capacities

        draw_capacities(judged, output, in_g=in_g, overwrite=overwrite, tell=note)
    ground.note_demand(shakes)
    ground.note_governing(structures, shakes[0][1].dimensionless)
    note(*_remarks(judged), *(by_code.said() if by_code else ()))
    sided = [(s, motion.scaled(-1.0), grid) for s, motion, grid in demands if azimuths is None and sign != "both" and has_direction(s)]
    if sided and ends:  # the worst frequency of the opposite direction is another one
        worst = at_worst_frequencies([s for s, _, _ in sided], sided[0][1], low, high, a_max, workers=workers, progress=searched)
        sided = [(s, motion, grid) for (s, motion, _), (grid, _) in zip(sided, worst, strict=True)]
    opposite = [(demand[0].name, outcome_alone(*demand)) for demand in sided]
    if opposite:
        note(opposite_in_words(opposite))
    if not (verdict_only or is_quiet()) and (remark := _of_an_inset(judged, demands, a_max)):
        note(remark)
    width = " or ".join(dict.fromkeys(narrowest(shake) for shake, _ in shakes))
    if not verdict_only:
        note(f"intervals narrower than {width} may be missed, also far below the capacity, but not around the demand")
    outcomes = [*(v.outcome for v in judged), *(outcome for _, outcome in opposite)]
    partly(Outcome.FAILED in outcomes)
    return 5 if fail_on and any(outcome.falls for outcome in outcomes) else 0


def _in_g(asked: str) -> bool:
    """True if --units, or the text of the amplitude, states g."""
    units = units_of()
    if units is not None and "acceleration" in units.chosen:
        return units.of("acceleration")[0] == "g"
    return asked.rstrip().endswith("g")


def _of_an_inset(judged: list[Verdict], demands: Sequence[Demand], a_max: Limit) -> str | None:
    """Return a line on the least capacity: how much of it is lost if the pivots lie inside the edges."""
    from ..envelopes.amplitudes import limit_of
    from ..responses.check import first_overturning
    from ..structures.mechanics.single_body import worn

    asked = {(structure.name, motion.name): (structure, motion, grid) for structure, motion, grid in demands}
    for verdict in sorted((v for v in judged if v.first_overturning_a), key=lambda v: v.capacity_demand or 0.0):
        structure, motion, grid = asked[verdict.structure, verdict.motion]
        if "inset" in structure.details or (found := worn(structure, INSET)) is None:
            continue
        known = verdict.first_overturning_a or 0.0
        other = first_overturning(found[1], motion, grid, limit_of(a_max, found[1]), known)
        if other is None:
            return None
        change = 100.0 * (other / known - 1.0)
        pivots = f"pivots {1000.0 * found[0]:.3g} mm inside the edges ({100.0 * INSET:g} % of the width: rounding, wear)"
        return f"{structure.name}: {pivots} {'take' if change <= 0.0 else 'add'} {abs(change):.2g} % of the capacity"
    return None


def _remarks(verdicts: list[Verdict]) -> list[str]:
    """Return the lines below the table: which structures fall, and what is to note on the others."""
    from ..dynamics.outcome import Outcome

    several = len({v.motion for v in verdicts}) > 1

    def named(found: Iterable[Verdict]) -> list[str]:
        return [f"{v.structure} under {v.motion}" if several else v.structure for v in found]

    falls = named(v for v in verdicts if v.outcome.overturned)
    lines = [f"{len(falls)} of {len(verdicts)} overturn{': ' if falls else ''}{', '.join(falls)}"] * bool(verdicts)
    conditions: list[tuple[str, Callable[[Verdict], Any]]] = [
        ("lose contact with the ground, and their later motion is not known", lambda v: v.outcome == Outcome.LOST_CONTACT),
        ("come to rest leaning, held by their ties, which counts as a fall", lambda v: v.outcome == Outcome.LEANING),
        (
            "stand in a safe window, and overturn at a lower amplitude",
            lambda v: v.outcome.safe and v.capacity_demand is not None and v.capacity_demand < 1.0,
        ),
        ("depend on the last digits of the demand, as the outcome changes within 1e-6 of it", lambda v: v.unsettled),
        (
            "lose contact with the ground (fz_min) during their fall, which is therefore not proved",
            lambda v: v.outcome.overturned and v.fz_min is not None and v.fz_min <= 0.0,
        ),
        ("open a further hinge (see response --forces), so that another mechanism follows", lambda v: v.opens),
        ("would slide, because their friction is below friction_needed", lambda v: v.slides),
        ("stand by the linear equation, which is wrong", lambda v: v.falls and v.outcome_linear.safe),
    ]
    for words, holds in conditions:
        if names := named(filter(holds, verdicts)):
            lines.append(f"{words}: {', '.join(names)}")
    for v in verdicts:
        if v.devices:
            from ..responses.tied_history import remarks

            lines += [f"{named([v])[0]}: {line}" for line in remarks(v.devices, v.first_overturning_a, v.first_overturning_a_free)]
        if v.share_of_falls:
            share = f"{100.0 * v.share_of_falls:.2g} % of the amplitudes within 5 % of it"
            lines.append(f"{named([v])[0]}: above first_overturning {share} overturn, and narrower intervals may begin below")
    return lines
