"""`rocking check`: the verdict and the capacity of each structure under a motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from . import demand, options
from .check_demands import LONG_TABLE
from .command import command, flag, group, option, partly, refuse
from .draws import DrawnRows, Draws, note_one_demand, require_spreads
from .parameter_types import NUMBER, InputPath
from .printing import (
    chosen_columns,
    detail,
    emit,
    is_quiet,
    note,
    printed,
    require_columns,
    units_of,
    wants_details,
)
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..dynamics.outcome import Outcome
    from ..envelopes.amplitudes import Limit
    from ..responses.check import Demand
    from ..responses.verdict import Verdict
    from .check_demands import Demands
    from .code_rows import CodeRows


@dataclass(frozen=True)
class CodeOptions:
    """The check by a code."""

    code: str | None = option(
        "--code",
        "Check by the Italian code as well: code_linear, code_slv, …",
        type=click.Choice(["ntc2018"], case_sensitive=False),
    )
    spectrum: str | None = option(
        "--spectrum",
        "Spectrum for --code: CSV of T and S_a at 5 %, of SLV or of each limit state"
        " (default: the motion's).",
        type=InputPath(),
        metavar="FILE|slv=FILE,slc=FILE",
    )
    floor: tuple[str, ...] = option(
        "--floor",
        "For --code: a mode of the building below the body; repeatable.",
        multiple=True,
        metavar="T=…,xi=…,gamma_psi=…",
    )
    fc: float | None = option(
        "--fc", "Confidence factor of --code (default 1).", type=NUMBER
    )

    def rows(
        self, stated: Demands, verdict_only: bool = False, sort: str | None = None
    ) -> CodeRows | None:
        """Return the checks by the code, None without --code. Raises UsageError."""
        unknown = "needs the capacities, which --verdict-only does not search"
        if verdict_only:
            refuse(unknown, "inset_effect")
        if self.code is not None:
            from .code_rows import CodeRows

            own = self.spectrum, self.floor, self.fc
            return CodeRows(*own, stated.asked.carrier, stated.structures)
        refuse("goes with --code", "spectrum", "floor", "fc")
        if verdict_only:
            refuse(unknown, "output", *["sort"] * (sort == "capacity"))
        return None


@dataclass(frozen=True)
class CheckOptions:
    """What to find of each structure, and what to print and draw."""

    a_max: Limit = options.a_max()
    sign: str = demand.sign()
    verdict_only: bool = flag(
        "--verdict-only", "Skip the search; first_overturning_a and safe_to stay empty."
    )
    inset_effect: bool = options.inset_effect()
    vary: tuple[str, ...] = options.vary()
    skip_faulty: bool = options.skip_faulty()
    sort: str | None = option(
        "--sort",
        "capacity: the least first, structures that never overturn last; or a column.",
        metavar="capacity|COLUMN",
    )
    fail_on: str | None = option(
        "--fail-on",
        "Exit code 5 if a structure, or one of its draws, falls or loses contact, in"
        " either direction; or slides further than a length, such as slide=50mm.",
        metavar="overturning|slide=LENGTH",
    )
    output: Path | None = options.output(
        "Draw the capacities, over a key with --vary: .png, .svg or .pdf; or write the"
        " verdicts into .h5."
    )

    @property
    def limit(self) -> Limit | None:
        """The largest amplitude of the search, None without a search."""
        return None if self.verdict_only else self.a_max


@command(
    "rocking check configs/block.yaml configs/arch.yaml --a-g 0.35g --f-g 1.5 --sort"
    " capacity",
    printed,
)
def check(
    files: tuple[str, ...] = options.files(),
    asked: demand.Directed = group(demand.Directed),
    of_code: CodeOptions = group(CodeOptions),
    wanted: CheckOptions = group(CheckOptions),
    drawn: Draws = group(Draws),
    sweep: options.Sweep = group(options.Sweep),
) -> int:
    """Check which structures stand under a motion, and find the lowest amplitude that
    overturns each.

    One row for each structure (a stack: for each interface) and motion: the outcome and
    theta_max/alpha by the governing equation (nonlinear for a known geometry in units:
    a_g, f_g, a record; linear on dimensionless axes, A, Omega, and for stated
    parameters); top_displacement from the position of rest; demand_a, the amplitude of
    the motion; uplift_a and first_overturning_a, the lowest amplitudes that lift and
    overturn the body; capacity_demand, first_overturning_a over demand_a, in a table as
    `> 13` if no amplitude up to 13 times the demand overturns; safe_to, the end of the
    safe interval around the demand; outcome_linear; friction_needed and fz_min of a
    rigid body; opens, if a further hinge of an arch opens. With --draws: share_falls,
    the share of the draws that falls, with its 95 % interval; quantiles of
    first_overturning_a; key_1, the key that explains most of it, and its index of first
    order. Accelerations are in m/s2
    (JSON, CSV) or in the unit of the request (table), unless --units says otherwise.
    """
    from ..dynamics.outcome import Outcome
    from ..reports.units import parse_units
    from .check_demands import at_worst, opposite_outcomes, stated_demands
    from .check_rows import known_columns
    from .check_table import is_table, write_table

    stated = stated_demands(files, asked, wanted.vary, wanted.sign)
    if is_table(wanted.output):
        stated.are_shaken()
        return write_table(stated, wanted, sweep)
    require_spreads(drawn.draws, stated.structures)
    most_slide = _slide_limit(wanted.fail_on, stated, drawn)
    by_code = of_code.rows(stated, wanted.verdict_only, wanted.sort)
    known = known_columns(stated, wanted, by_code is not None, drawn.draws is not None)
    require_columns(known, wanted.sort)
    figure = options.FigureFile(wanted.output, sweep.overwrite)
    if wanted.output is not None:
        figure.check()
    if not stated.are_shaken(by_code) and by_code:
        by_code.alone(stated.structures, stated.varied, figure)
        return 0

    demands = at_worst(stated, wanted.limit, sweep.workers)
    if by_code:
        demands.rows = by_code.dynamic(demands.rows)
    of_draws = DrawnRows(drawn, wanted.limit)
    if drawn.draws is not None and demands.ranged:
        note_one_demand(demands.ranged)
    rows: list[dict[str, Any]] = []
    judged = _judge_and_print(
        demands, wanted, sweep.workers, by_code, of_draws, rows, known
    )
    if by_code:
        figure.draw([one.check for one in by_code.checks.values()])
    elif wanted.vary:
        figure.draw(rows)
    elif wanted.output is not None:
        figure.draw(list(judged), units=parse_units("g" if _in_g(asked) else "m/s2"))

    opposite = opposite_outcomes(demands)
    demand.note_demand(demands.shakes)
    demand.note_governing(demands.structures, demands.shakes[0][1].dimensionless)
    note(*of_draws.said, *_lines(judged, demands, by_code, opposite, of_draws))
    _search_remarks(judged, demands, wanted)
    outcomes = [*(v.outcome for v in judged), *(outcome for _, outcome in opposite)]
    partly(Outcome.FAILED in outcomes)
    if wanted.fail_on and any(outcome.falls for outcome in outcomes):
        return 5
    if wanted.fail_on and _draw_falls(of_draws, demands):
        return 5
    return 5 if _slid_too_far(judged, most_slide) else 0


def _slide_limit(fail_on: str | None, stated: Demands, drawn: Draws) -> float | None:
    """Return the length of --fail-on slide=LENGTH [m], None without it. Raises
    UsageError, also for a structure whose sliding is not known, and for draws.
    """
    if fail_on is None or fail_on == "overturning":
        return None
    from ..responses.sliding import parse_slide
    from ..structures.friction import covers_sliding

    most = parse_slide("--fail-on", fail_on, "overturning or slide=LENGTH")
    if drawn.draws is not None:
        raise click.UsageError(
            f"--fail-on {fail_on}: draws have no displacement; expected a call without"
            " --draws"
        )
    for one in stated.structures:
        if one.friction is None or not covers_sliding(one):
            raise click.UsageError(
                f"--fail-on {fail_on}: the sliding of {one.name} is not known; expected"
                " rigid bodies on two edges, without ties, whose documents state"
                " friction"
            )
    return most


def _draw_falls(of_draws: DrawnRows, demands: Demands) -> bool:
    """Return True if a draw falls, in a direction of the rows or in the opposite one
    where the rows do not hold it.
    """
    both = demands.asked.azimuth is not None or demands.sign == "both"
    return of_draws.falls or (not both and of_draws.fall_opposite(demands.rows))


def _slid_too_far(judged: Sequence[Verdict], most: float | None) -> bool:
    """Return True if a body slides further than a length [m], or if its sliding is not
    followed.
    """
    if most is None:
        return False
    unknown = [v.structure for v in judged if v.slides]
    if unknown:
        note(f"--fail-on slide: how far they slide is not known: {', '.join(unknown)}")
    far = [v.slide is not None and v.slide.slide_max > most for v in judged]
    return bool(unknown) or any(far)


def _judge_and_print(
    demands: Demands,
    wanted: CheckOptions,
    workers: int | None,
    by_code: CodeRows | None,
    of_draws: DrawnRows,
    kept: list[dict[str, Any]],
    known: list[str],
) -> Sequence[Verdict]:
    """Print a row for each demand and return the verdicts: JSON, CSV and long tables as
    soon as each is known, a table when all are; kept: gets the rows of a figure; known:
    the columns that a call may have.
    """
    from ..packed import Packed
    from ..responses.check import verdicts
    from ..responses.verdict import CHECK_COLUMNS
    from .check_rows import ASKED, later_columns, row_of, unseen_columns

    found: Iterable[tuple[Verdict, Demand]] = zip(
        verdicts(
            demands.rows,
            ranges=demands.ranges,
            a_max=wanted.limit,
            workers=workers,
            progress=ProgressLine("check", "checks"),
            forces=_forces_wanted(len(demands.rows)),
        ),
        demands.rows,
        strict=True,
    )
    by_capacity = wanted.sort == "capacity"
    if by_capacity:
        from ..reports.wording import capacity_left

        found = sorted(found, key=lambda one: capacity_left(one[0]))
    judged: Packed[Verdict] = Packed()
    searched = wanted.limit is not None

    later = later_columns(demands, searched)

    def rows() -> Iterator[dict[str, Any]]:
        for verdict, demanded in found:
            judged.append(verdict)
            columns = by_code.columns(verdict, searched) if by_code else {}
            columns |= of_draws.columns(demanded)
            if wanted.vary and wanted.output is not None:
                varied = demands.varied.get(verdict.structure, {})
                kept.append(varied | verdict.row())
            yield row_of(verdict, columns, later)
        yield from by_code.others() if by_code else ()

    units = "g,mm,deg" if _in_g(demands.asked) else "mm,deg"
    emit(
        rows(),
        CHECK_COLUMNS,
        table_units=units,
        unseen=unseen_columns(known, chain.from_iterable(demands.varied.values())),
        above=("motion", "demand_a", *ASKED),
        varied=demands.varied,
        sort=None if by_capacity else wanted.sort,
    )
    return judged


def _forces_wanted(rows: int) -> bool:
    """True if friction_needed and fz_min are computed of every row: of fewer than
    `LONG_TABLE`, or if --columns names them.
    """
    asked = {"friction_needed", "fz_min"}.intersection(chosen_columns())
    if rows < LONG_TABLE or asked:
        return True
    detail(
        f"friction_needed and fz_min are not computed of {LONG_TABLE} rows or more;"
        " --columns friction_needed,fz_min asks for them"
    )
    return False


def _lines(
    judged: Sequence[Verdict],
    demands: Demands,
    by_code: CodeRows | None,
    opposite: list[tuple[str, Outcome]],
    of_draws: DrawnRows,
) -> Iterator[str]:
    """Yield the lines below the rows that change a decision, none with --quiet."""
    if is_quiet():
        return
    from .check_remarks import remarks, worst_at_an_end

    yield from remarks(judged, of_means=bool(of_draws.said))
    yield from worst_at_an_end(demands, judged)
    yield from by_code.said() if by_code else ()
    if opposite:
        from ..reports.wording import opposite_in_words

        yield opposite_in_words(opposite)


def _search_remarks(
    judged: Sequence[Verdict], demands: Demands, wanted: CheckOptions
) -> None:
    """Print what is to be said of the search, and what worn edges would take."""
    from ..reports.device_words import devices_in_words
    from ..responses.inset import may_be_worn
    from .check_remarks import (
        inset_effects,
        narrow_intervals,
        without_worst,
    )

    limit = wanted.limit
    if wanted.inset_effect and limit is not None and not is_quiet():
        note(*inset_effects(judged, demands, limit))
    if not wants_details():
        return
    if demands.ranged:
        from ..reports.wording import range_in_words

        detail(range_in_words(demands.ranged, limit is not None))
    detail(*without_worst(demands, judged))
    for v in judged:
        detail(*(f"{v.structure}: {line}" for line in devices_in_words(v) if v.devices))
    if limit is None:
        return
    if not wanted.inset_effect and may_be_worn(judged, demands.rows):
        detail(
            "worn or rounded edges lower the capacity: --inset-effect shows by how much"
        )
    detail(narrow_intervals(demands.shakes))


def _in_g(asked: demand.Directed) -> bool:
    """True if --units, or the text of the amplitude, states g."""
    units = units_of()
    if units is not None and "acceleration" in units.chosen:
        return units.of("acceleration")[0] == "g"
    stated = asked.a_g or asked.scale_to or ("g" if asked.motion else "")
    return stated.rstrip().endswith("g")
