"""`rocking report`: structures under a motion, as one page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from . import demand, options
from .check import CodeOptions
from .check_demands import LONG_TABLE
from .command import command, flag, group, option, partly, refuse
from .draws import Draws, require_spreads
from .printing import note, quiet
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..envelopes.amplitudes import Limit
    from ..reports.page_parts import Asked
    from ..responses.verdict import Verdict
    from .check_demands import Demands, Members
    from .code_rows import CodeRows

PAGES = (".html", ".htm")
MOST = 12  # structures with a section of their own; of more the page is a summary


@dataclass(frozen=True)
class ReportOptions:
    """What the page holds."""

    output: Path = options.output("The page: .html.", required=True)
    title: str | None = option(
        "--title",
        "Title of the page (default: the names of the structures, of many the first"
        " four).",
        metavar="TEXT",
    )
    summary: bool = flag(
        "--summary",
        "Begin with a page in words: a sentence on each structure; the details follow.",
    )
    author: str | None = option(
        "--author", "Who made the page, below the title.", metavar="TEXT"
    )
    place: str | None = option(
        "--place", "Where the structures stand, below the title.", metavar="TEXT"
    )
    inset_effect: bool = options.inset_effect()
    sort: str | None = options.sort()
    by: str | None = option(
        "--by",
        f"Of more than {MOST} structures: also a table by this label.",
        metavar="COLUMN",
    )
    skip_faulty: bool = options.skip_faulty()


@command(
    "rocking report configs/block.yaml configs/arch.yaml --a-g 0.35g --f-g 1.5 -o"
    " report.html",
    quiet,
)
def report(
    files: tuple[str, ...] = options.files(),
    asked: demand.Directed = group(demand.Directed),
    sign: str = demand.sign(),
    of_code: CodeOptions = group(CodeOptions),
    wanted: ReportOptions = group(ReportOptions),
    drawn: Draws = group(Draws),
    workers: int | None = options.workers(),
    overwrite: bool = options.overwrite(),
) -> None:
    """Write a page about structures under a pulse or a set of records: verdicts,
    drawings, maps and fragility.

    The page is one HTML file. It holds the table of rocking check; for each structure
    its drawing, parameters and their relations, the map with the demand, the number of
    cells in which the linear equation is wrong, and fragility curves under records;
    with --code the verdicts of the code and the capacity curve; with --draws the share
    of the draws that falls, over the amplitude; then the documents, the command,
    versions and hashes. It prints on A4, two structures a page. Of more than 12
    structures it holds a histogram of the capacities and the 20 least ones; all rows
    stand in a CSV file beside it. The page needs jinja2 and matplotlib: pip install
    jinja2 matplotlib.
    """
    from ..dynamics.outcome import Outcome
    from ..reports.page_of_many import write_page_of_many
    from ..reports.page_parts import WRITTEN_WITH, labels_of
    from ..reports.wording import tally
    from ..responses.check import verdicts
    from ..structures.mechanics.capacity_curve import require_geometry
    from .check_demands import at_worst, demands_on
    from .check_remarks import worst_at_an_end

    options.check_target(wanted.output, overwrite, PAGES, packages=WRITTEN_WITH)
    files, motions = asked.several(files)

    def members() -> Members:
        return options.structures_of(files, each=True, with_documents=MOST), {}

    stated = demands_on(members, asked, motions, sign)
    many = len(stated.structures) > MOST
    _refuse_contradictions(stated, wanted, overwrite)
    labels = labels_of(stated.structures, wanted.by)
    require_spreads(drawn.draws, stated.structures)
    by_code = of_code.rows(stated)
    shaken = stated.are_shaken(by_code)
    if by_code is not None:
        require_geometry(stated.structures)
    demands = at_worst(stated, _limit(), workers)
    found = list(
        verdicts(
            demands.rows,
            ranges=demands.ranges,
            a_max=_limit(),
            workers=workers,
            progress=ProgressLine("report", "checks"),
            forces=not many or len(demands.rows) < LONG_TABLE,
        )
    )
    inputs = [*(files if many else ()), asked.vertical or ""]
    said = _asked(demands, wanted, by_code, drawn, found, inputs)
    if many:
        write_page_of_many(found, labels, wanted.output, said, wanted.by, overwrite)
    else:
        _write_sections(demands, found, said, wanted.output, workers, overwrite)
    if shaken:
        demand.note_demand(demands.shakes)
        demand.note_governing(demands.structures, demands.shakes[0][1].dimensionless)
        note(f"{wanted.output}: {tally(found)}", *filter(None, [said.opposite]))
        note(*worst_at_an_end(demands, found))
        partly(any(v.outcome == Outcome.FAILED for v in found))


def _refuse_contradictions(
    stated: Demands, wanted: ReportOptions, overwrite: bool
) -> None:
    """Raise UsageError for options of the other page, and for an output that cannot or
    must not be written.
    """
    from ..reports.page_of_many import beside_of
    from ..reports.page_parts import WRITTEN_WITH

    options.refuse_own_input(wanted.output, stated.shaken.recordings)
    if len(stated.structures) <= MOST:
        refuse(f"goes with more than {MOST} structures", "by")
        return
    refuse(
        f"goes with up to {MOST} structures: of more the page is a summary",
        *("draws", "code", "summary", "inset_effect"),
    )
    beside = beside_of(wanted.output)
    options.check_target(beside, overwrite, (beside.suffix,), packages=WRITTEN_WITH)


def _write_sections(
    demands: Demands,
    found: Sequence[Verdict],
    said: Asked,
    target: Path,
    workers: int | None,
    overwrite: bool,
) -> None:
    """Write the page with a section for each structure, and print the verdicts of the
    code.
    """
    from ..reports.page import page
    from ..reports.page_parts import write
    from ..reports.wording import NOT_KNOWN, verified_in_words
    from ..responses.code_verdict import code_verdicts

    structures, rows, code = demands.structures, demands.rows, said.code
    checks = [] if code is None else list(code_verdicts(structures, rows, code))
    lines = verified_in_words([one.check for one in checks])
    note(*lines)
    # a limit state without an answer is a part of the work without a result
    partly(any(NOT_KNOWN in line for line in lines))
    text = page(structures, found, said, checks=checks, demands=rows, workers=workers)
    write(target, text, overwrite)


def _limit() -> Limit:
    """Return the largest amplitude of the search."""
    from ..envelopes.amplitudes import Limit
    from ..envelopes.intervals import A_MAX

    return Limit(A_MAX)


def _asked(
    demands: Demands,
    wanted: ReportOptions,
    by_code: CodeRows | None,
    drawn: Draws,
    found: Sequence[Verdict],
    inputs: Sequence[str],
) -> Asked:
    """Return what the page says of its making, and what it holds besides the verdicts;
    inputs: files that were read.
    """
    from ..reports.page_parts import Asked
    from ..reports.wording import opposite_in_words
    from .check_demands import opposite_outcomes

    outcomes = opposite_outcomes(demands)
    spectra = () if by_code is None else by_code.files.values()
    return Asked(
        options.command_line(),
        options.now(),
        title=wanted.title,
        author=wanted.author,
        place=wanted.place,
        summary=wanted.summary,
        by_capacity=wanted.sort is not None,
        draws=None if drawn.draws is None else (drawn.draws, drawn.seed),
        fragility=demands.azimuths is None,
        ends=tuple(g for _, g in demands.shakes) if demands.up_to is not None else (),
        code=None if by_code is None else by_code.given,
        demand=_in_words(demands, wanted.summary) if demands.shakes else "",
        opposite=opposite_in_words(outcomes) if outcomes else "",
        remarks=list(_remarks(found, demands, wanted)),
        recordings=demands.shaken.recordings,
        inputs=[*inputs, *spectra],
    )


def _in_words(demands: Demands, summary: bool) -> str:
    """Return the demand in words."""
    from ..motions.grid import demand_in_words
    from ..reports.wording import demand_plainly

    if demands.azimuths is None:
        shakes = demands.shakes
        plainly = demand_plainly(shakes, demands.asked.vertical)
        return plainly if summary else demand_in_words(shakes)
    pair = " and ".join(r.record.label for r in demands.shaken.recordings)
    return (
        f"{pair} in the worst of {demands.azimuths.size} directions for each structure"
    )


def _remarks(
    verdicts: Sequence[Verdict],
    demands: Demands,
    wanted: ReportOptions,
) -> Iterator[str]:
    """Yield sentences for the page that `rocking check` prints below its rows."""
    from .check_remarks import inset_effects, worst_at_an_end

    if demands.ranged:
        tried = (
            "range of frequencies"
            if demands.azimuths is None
            else f"{demands.azimuths.size} directions"
        )
        yield (
            f"Of the {tried} the capacity is the least one and the rotation the largest"
            " one, each where the table says."
        )
    yield from worst_at_an_end(demands, verdicts)
    if wanted.inset_effect:
        yield from inset_effects(verdicts, demands, _limit())
