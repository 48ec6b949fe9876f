"""A report on structures under a motion as one HTML file, which loads nothing from a
network.

The template escapes every text of the user. jinja2 and matplotlib are imported by what
writes a page.
"""

from collections.abc import Mapping, Sequence
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

from ..documents.document import Document
from ..motions.given import AnyMotion, demands_of, motions_of
from ..motions.grid import Grid, demand_in_words
from ..motions.recording import Recording
from ..motions.records import Record
from ..plugins import require
from ..processes import available_cpus, processes
from ..publishing import check_target
from ..responses.check import Demand, verdicts
from ..responses.code_check import METHODS
from ..responses.code_verdict import CodeVerdict
from ..responses.opposite import opposite_outcomes
from ..responses.verdict import Verdict
from ..structures import (
    RockingParameters,
    build_structure,
    on_each_interface,
    with_distinct_names,
)
from ..structures.given import documents_from
from .figures.canvas import FIGURE_UNITS
from .figures.capacities import capacities, code_demand_in_words
from .page_parts import (
    WRITTEN_WITH,
    Asked,
    Labels,
    details,
    labelled,
    labels_of,
    lead,
    page_row,
    rendered,
    verdict_row,
    write,
)
from .page_sections import Cases, image, section
from .wording import (
    OVERVIEW,
    capacity_left,
    demand_plainly,
    opposite_in_words,
    overview_row,
    verified_in_words,
    worst_of,
)

_NAMED = 5  # structures in the title, at most


def page(
    structures: Sequence[RockingParameters],
    verdicts: Sequence[Verdict],
    asked: Asked,
    *,
    checks: Sequence[CodeVerdict] = (),
    demands: Sequence[Demand] = (),
    workers: int | None = None,
) -> str:
    """Return the page as HTML.

    verdicts: those of `check`, for each of the demands; checks: those by the code, of
    each verdict, or without verdicts of each structure.
    """
    if asked.by_capacity:
        structures, verdicts, demands = _by_capacity(structures, verdicts, demands)
    cases = [Cases.of(s, verdicts, demands, checks) for s in structures]
    sections = _sections(cases, workers, asked)
    drawn = [line for one in sections if one["draws"] for line in one["draws"]["lines"]]
    labels = labels_of(structures)
    values: dict[str, Any] = {}
    if verdicts:
        means = "Of the means, " * bool(drawn)
        values = {
            "lead": f"{means}{lead(verdicts, asked)}",
            "overview": _overview(cases, labels) if asked.summary else [],
            "capacities": image(
                lambda figure: capacities(figure, verdicts, FIGURE_UNITS)
            ),
        }
    return rendered(
        asked,
        structures,
        title=asked.title or f"Rocking of {_some([s.name for s in structures])}",
        code=_of_code(checks, asked.code or {}, labels) if checks else None,
        verdicts=details(verdicts, labels),
        sections=sections,
        draws=drawn,
        **values,
    )


def _some(names: Sequence[str]) -> str:
    """Return names in words: all of a few, of many the first ones and the number of the
    others.
    """
    if len(names) <= _NAMED:
        return ", ".join(names)
    return f"{', '.join(names[: _NAMED - 1])} and {len(names) - _NAMED + 1} others"


def _sections(
    cases: Sequence[Cases], workers: int | None, asked: Asked
) -> list[dict[str, Any]]:
    """Return the template's values for each structure. Processes share the structures,
    or the cells of each under records, whose curves take most of the time.
    """
    curves = asked.recordings and asked.fragility
    several = 1 if curves else min(workers or available_cpus(), len(cases))
    task = partial(section, asked, 1 if several > 1 else workers)
    if several == 1:
        return list(map(task, cases))
    with processes(several, task, "fewer `workers` need less") as run:
        return list(run(cases))


def _overview(cases: Sequence[Cases], labels: Labels) -> list[dict[str, Any]]:
    """Return the rows of the first page, one for each structure; labels: of each
    structure.
    """
    rows = []
    several = len({v.motion for mine in cases for v in mine.verdicts}) > 1
    for mine in cases:
        worst = worst_of(mine.verdicts)
        cells = dict(zip(OVERVIEW, overview_row(mine.verdicts), strict=True))
        if not several:
            del cells["worst motion"]
        cells = labelled(cells, labels)
        rows.append(verdict_row(cells, worst))
    return rows


def _of_code(
    checks: Sequence[CodeVerdict],
    code: Mapping[str, Any],
    labels: Labels,
) -> dict[str, Any]:
    """Return what the page says first of the check by a code: its demand, its verdict
    and a row for each check, red if a limit state is not verified.
    """
    found = [one.check for one in checks]
    on_floor = {bool(code.get("floor")) or one.carried for one in checks}
    floor = ", on a floor" * (on_floor == {True})
    floor = floor or ", on a floor where the document has the key building" * any(
        on_floor
    )
    demand = code_demand_in_words(found)
    rows = []
    for one in checks:
        ratios = one.check.ratios()
        cells: dict[str, str | float | None] = {"structure": one.check.structure}
        if len({c.motion for c in checks}) > 1:
            cells["motion"] = one.motion
        for key, head in METHODS.items():
            if key in ratios or head in one.check.asked:
                cells[f"{head}: verdict"] = one.check.verdict(key)
                cells[f"{head}: accepted over demand"] = ratios.get(key)
        rows.append(page_row(labelled(cells, labels), falls=not one.verified))
    return {
        "lead": f"{'; '.join(verified_in_words(found))}. Demand: {demand}{floor},"
        f" confidence factor {code.get('confidence', 1.0):g}.",
        "rows": rows,
        "unknown": [
            f"{check.structure}: {state} is not known: {why}."
            for check in found
            for state, why in check.unanswered.items()
        ],
    }


def _by_capacity(
    structures: Sequence[RockingParameters],
    verdicts: Sequence[Verdict],
    demands: Sequence[Demand],
) -> tuple[list[RockingParameters], list[Verdict], list[Demand]]:
    """Return the structures, verdicts and demands, the least capacity first."""
    order = sorted(range(len(verdicts)), key=lambda i: capacity_left(verdicts[i]))
    names = [verdicts[i].structure for i in order]
    return (
        sorted(structures, key=lambda s: names.index(s.name)),
        [verdicts[i] for i in order],
        [demands[i] for i in order] if demands else [],
    )


def report(
    documents: Document | str | Path | Sequence[Document | str | Path],
    motion: AnyMotion | Sequence[AnyMotion],
    target: str | Path,
    *,
    shaking: Grid | str | None = None,
    title: str | None = None,
    summary: bool = False,
    by_capacity: bool = False,
    overwrite: bool = True,
    workers: int | None = None,
) -> list[Verdict]:
    """Write an HTML page on structures under a motion or records.

    Parameters
    ----------
    documents
        one or more: documents, paths, or texts such as "block:0.5x2"
    motion
        the motion of the ground: an object, the name of a pulse, or a path; or several
    target
        the HTML file to write
    shaking
        amplitude and frequency, a grid of one cell or its text; records do not need it
    title
        of the page, None for the names of the structures
    summary
        True: the page begins with a sentence on each structure
    by_capacity
        True: the structure with the least capacity comes first
    overwrite
        False: an existing file is an error
    workers
        number of processes, None for all cores

    Returns
    -------
    list of Verdict
        a verdict for each structure under each motion

    Raises
    ------
    UsageError
        for a demand of zero, or a target that cannot or must not be written
    DocumentError
        if a document is not valid
    OutputError
        when the file cannot be written, or a package for it is not installed

    Examples
    --------
    >>> documents = read_documents("configs/parameters.yaml")
    >>> shaking = parse_grid("a_g=0.2g,f_g=2")
    >>> verdicts = report(documents, sine(), "r.html", shaking=shaking)
    >>> [verdict.outcome.flag for verdict in verdicts]
    ['no_uplift']
    """
    motions = motions_of(motion)
    structures = list(
        with_distinct_names(
            build_structure(one)
            for document in documents_from(documents)
            for one in on_each_interface(document)
        )
    )
    shakes = demands_of(motions, shaking)
    demands = [(one, *shake) for shake in shakes for one in structures]
    check_target(Path(target), overwrite)
    require(*WRITTEN_WITH)
    found = list(verdicts(demands, workers=workers))
    outcomes = opposite_outcomes(demands)
    asked = Asked(
        "rocking_cli.report",
        str(date.today()),
        title=title,
        summary=summary,
        by_capacity=by_capacity,
        demand=demand_plainly(shakes) if summary else demand_in_words(shakes),
        opposite=opposite_in_words(outcomes) if outcomes else "",
        recordings=[
            one if isinstance(one, Recording) else Recording(one)
            for one in motions
            if isinstance(one, Recording | Record)
        ],
    )
    text = page(structures, found, asked, demands=demands, workers=workers)
    write(target, text, overwrite)
    return found
