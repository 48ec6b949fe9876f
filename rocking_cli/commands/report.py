"""`rocking report`: structures under a motion, as one page."""

from pathlib import Path

from . import ground, options
from .command import command, flag, group, option, partly
from .printing import note, quiet
from .progress import ProgressLine

PAGES = (".html", ".htm")
MOST = 12  # structures of a page


@command(
    "rocking report configs/block.yaml configs/arch.yaml --a-g 0.35g --f-g 1.5 -o"
    " report.html",
    quiet,
)
def report(
    files: tuple[str, ...] = options.files(),
    asked: ground.Demand = group(ground.Demand),
    output: Path = options.output("The page: .html.", required=True),
    title: str | None = option(
        "--title",
        "Title of the page (default: the names of the structures).",
        metavar="TEXT",
    ),
    summary: bool = flag(
        "--summary",
        "Begin with a page in words: a sentence on each structure; the details follow.",
    ),
    inset_effect: bool = options.inset_effect(),
    sort: str | None = options.sort(),
    workers: int | None = options.workers(),
    overwrite: bool = options.overwrite(),
) -> None:
    """Write a page about structures under a pulse or a set of records: verdicts,
    drawings, maps and fragility.

    The page is one HTML file. It holds the table of rocking check; for each structure
    its drawing, parameters and their relations, the map with the demand, the number of
    cells in which the linear equation is wrong, and fragility curves under records;
    then the command, versions and hashes. The page needs jinja2 and matplotlib: pip
    install jinja2 matplotlib.
    """
    from ..dynamics.outcome import Outcome
    from ..reports.page import WRITTEN_WITH, Subject, write_page
    from ..responses.verdict import tally
    from ..structures import build_structure, with_distinct_names

    options.check_target(output, overwrite, PAGES, packages=WRITTEN_WITH)
    files, shaken = asked.several(files)
    shaken = asked.of(shaken)
    documents = options.documents_of(files, MOST, "a page", each=True)
    shakes = shaken.needed()
    options.refuse_own_input(output, shaken.recordings)
    structures = with_distinct_names(
        [build_structure(document) for document in documents]
    )
    options.introduce(structures)
    options.note_interfaces(structures)
    subjects = [
        Subject(document, structure)
        for document, structure in zip(documents, structures, strict=True)
    ]
    verdicts = write_page(
        subjects,
        shakes,
        output,
        recordings=shaken.recordings,
        vertical=asked.vertical,
        command=options.command_line(),
        made=options.now(),
        title=title,
        summary=summary,
        by_capacity=sort is not None,
        inset_effect=inset_effect,
        overwrite=overwrite,
        workers=workers,
        progress=ProgressLine("report", "checks"),
    )
    ground.note_demand(shakes)
    ground.note_governing(structures, shakes[0][1].dimensionless)
    note(f"{output}: {tally(verdicts)}")
    partly(any(v.outcome == Outcome.FAILED for v in verdicts))
