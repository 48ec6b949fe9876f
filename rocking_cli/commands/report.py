"""`rocking report`: structures under a motion, as one page."""

from dataclasses import dataclass
from pathlib import Path

from . import demand, options
from .command import command, flag, group, option, partly
from .draws import Draws, require_spreads
from .printing import note, quiet
from .progress import ProgressLine

PAGES = (".html", ".htm")
MOST = 12  # structures of a page


@dataclass(frozen=True)
class ReportOptions:
    """What the page holds."""

    output: Path = options.output("The page: .html.", required=True)
    title: str | None = option(
        "--title",
        "Title of the page (default: the names of the structures).",
        metavar="TEXT",
    )
    summary: bool = flag(
        "--summary",
        "Begin with a page in words: a sentence on each structure; the details follow.",
    )
    inset_effect: bool = options.inset_effect()
    sort: str | None = options.sort()


@command(
    "rocking report configs/block.yaml configs/arch.yaml --a-g 0.35g --f-g 1.5 -o"
    " report.html",
    quiet,
)
def report(
    files: tuple[str, ...] = options.files(),
    asked: demand.Demand = group(demand.Demand),
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
    with --draws the share of the draws that falls, over the amplitude;
    then the command, versions and hashes. The page needs jinja2 and matplotlib: pip
    install jinja2 matplotlib.
    """
    from ..dynamics.outcome import Outcome
    from ..reports.page import WRITTEN_WITH, write_page
    from ..reports.page_sections import Subject
    from ..responses.verdict import tally
    from ..structures import build_structure, with_distinct_names

    options.check_target(wanted.output, overwrite, PAGES, packages=WRITTEN_WITH)
    files, shaken = asked.several(files)
    shaken = asked.of(shaken)
    documents = options.documents_of(files, MOST, "a page", each=True)
    shakes = shaken.needed()
    options.refuse_own_input(wanted.output, shaken.recordings)
    structures = with_distinct_names(
        [build_structure(document) for document in documents]
    )
    if drawn.draws is not None:
        require_spreads(structures)
    options.introduce(structures)
    options.note_interfaces(structures)
    subjects = [
        Subject(document, structure)
        for document, structure in zip(documents, structures, strict=True)
    ]
    verdicts = write_page(
        subjects,
        shakes,
        wanted.output,
        recordings=shaken.recordings,
        vertical=asked.vertical,
        command=options.command_line(),
        made=options.now(),
        title=wanted.title,
        summary=wanted.summary,
        by_capacity=wanted.sort is not None,
        inset_effect=wanted.inset_effect,
        draws=None if drawn.draws is None else (drawn.draws, drawn.seed),
        overwrite=overwrite,
        workers=workers,
        progress=ProgressLine("report", "checks"),
    )
    demand.note_demand(shakes)
    demand.note_governing(structures, shakes[0][1].dimensionless)
    note(f"{wanted.output}: {tally(verdicts)}")
    partly(any(v.outcome == Outcome.FAILED for v in verdicts))
