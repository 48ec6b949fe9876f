"""A report on structures under a motion as one HTML file, which loads nothing from a
network.

The template escapes every text of the user. jinja2 and matplotlib are imported by what
writes a page.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

from ..documents.document import Document
from ..documents.files import whole_text
from ..dynamics.outcome import Outcome
from ..motions.given import AnyMotion, demands_of, motions_of
from ..motions.grid import Grid, demand_in_words
from ..motions.recording import Recording
from ..motions.records import Record
from ..plugins import require
from ..processes import available_cpus, processes
from ..publishing import check_target, published
from ..responses.check import Demand, OfRange, Progress, verdicts
from ..responses.code_check import METHODS
from ..responses.opposite import opposite_outcomes
from ..responses.verdict import Verdict
from ..structures import (
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
    details,
    hashes,
    labelled,
    page_row,
    rendered,
    verdict_row,
)
from .page_sections import Cases, CodeVerdict, Subject, checked, image, section
from .wording import (
    OVERVIEW,
    capacity_left,
    demand_plainly,
    opposite_in_words,
    overview_row,
    tally,
    verified_in_words,
    worst_of,
)

_NAMED = 5  # structures in the title, at most


def page(
    subjects: Sequence[Subject],
    verdicts: Sequence[Verdict],
    asked: Asked,
    *,
    checks: Sequence[CodeVerdict] = (),
    demands: Sequence[Demand] = (),
    recordings: Sequence[Recording] = (),
    vertical: str | None = None,
    demand: str,
    opposite: str = "",
    remarks: Sequence[str] = (),
    workers: int | None = None,
) -> str:
    """Return the page as HTML.

    verdicts: those of `check`, for each of the demands; checks: those by the code, of
    each verdict, or without verdicts of each structure; vertical: name or file of the
    vertical motion; demand: the strength of the shaking in words; opposite: a remark on
    that direction; remarks: sentences below the table of verdicts.
    """
    motions = ", ".join(dict.fromkeys(v.motion for v in verdicts))
    if asked.by_capacity:
        subjects, verdicts, demands = _by_capacity(subjects, verdicts, demands)
    cases = {
        name: Cases.of(name, verdicts, demands, checks)
        for name in (s.structure.name for s in subjects)
    }
    summary = asked.summary
    shaking = f"under {demand}" if summary else f"under {motions}: {demand}"
    structures = _sections(
        [(s, cases[s.structure.name]) for s in subjects], recordings, workers, asked
    )
    drawn = [
        line for one in structures if one["draws"] for line in one["draws"]["lines"]
    ]
    keys = dict.fromkeys(key for s in subjects for key in s.structure.labels)
    labels = {
        s.structure.name: {key: str(s.structure.labels.get(key, "")) for key in keys}
        for s in subjects
    }
    means = "Of the means, " * bool(drawn)
    return rendered(
        asked,
        title=asked.title or f"Rocking of {_some(list(cases))}",
        opposite=opposite,
        remarks=remarks,
        lead=f"{means}{tally(verdicts)}, {shaking}." if verdicts else "",
        code=_of_code(checks, asked.code or {}, labels) if checks else None,
        overview=_overview(cases, labels) if summary and verdicts else [],
        verdicts=details(verdicts, labels) if verdicts else [],
        capacities=(
            image(lambda figure: capacities(figure, verdicts, FIGURE_UNITS))
            if verdicts
            else None
        ),
        structures=structures,
        draws=drawn,
        hashes=hashes(subjects, recordings, [vertical or "", *asked.spectra]),
    )


def _some(names: Sequence[str]) -> str:
    """Return names in words: all of a few, of many the first ones and the number of the
    others.
    """
    if len(names) <= _NAMED:
        return ", ".join(names)
    return f"{', '.join(names[: _NAMED - 1])} and {len(names) - _NAMED + 1} others"


def _sections(
    subjects: Sequence[tuple[Subject, Cases]],
    recordings: Sequence[Recording],
    workers: int | None,
    asked: Asked,
) -> list[dict[str, Any]]:
    """Return the template's values for each structure. Processes share the structures,
    or the cells of each under records, whose curves take most of the time.
    """
    curves = recordings and asked.fragility
    several = 1 if curves else min(workers or available_cpus(), len(subjects))
    task = partial(_section, recordings, asked, 1 if several > 1 else workers)
    if several == 1:
        return list(map(task, subjects))
    with processes(several, task, "fewer `workers` need less") as run:
        return list(run(subjects))


def _section(
    recordings: Sequence[Recording],
    asked: Asked,
    workers: int | None,
    one: tuple[Subject, Cases],
) -> dict[str, Any]:
    """Return the template's values for one structure."""
    return section(*one, recordings, workers, asked.draws, asked.fragility, asked.ends)


def _overview(
    cases: Mapping[str, Cases], labels: Mapping[str, Mapping[str, str]]
) -> list[dict[str, Any]]:
    """Return the rows of the first page, one for each structure; labels: of each
    structure.
    """
    rows = []
    several = len({v.motion for mine in cases.values() for v in mine.verdicts}) > 1
    for mine in cases.values():
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
    labels: Mapping[str, Mapping[str, str]],
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
    subjects: Sequence[Subject], verdicts: Sequence[Verdict], demands: Sequence[Demand]
) -> tuple[list[Subject], list[Verdict], list[Demand]]:
    """Return the structures, verdicts and demands, the least capacity first."""
    order = sorted(range(len(verdicts)), key=lambda i: capacity_left(verdicts[i]))
    names = [verdicts[i].structure for i in order]
    return (
        sorted(subjects, key=lambda s: names.index(s.structure.name)),
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
    read = [
        one
        for document in documents_from(documents)
        for one in on_each_interface(document)
    ]
    structures = list(with_distinct_names(map(build_structure, read)))
    shakes = demands_of(motions, shaking)
    demands = [(one, *shake) for shake in shakes for one in structures]
    return write_page(
        [Subject(document, s) for document, s in zip(read, structures, strict=True)],
        demands,
        target,
        Asked(
            "rocking_cli.report",
            str(date.today()),
            title=title,
            summary=summary,
            by_capacity=by_capacity,
        ),
        demand=demand_plainly(shakes) if summary else demand_in_words(shakes),
        opposite=lambda: opposite_outcomes(demands),
        recordings=[
            one if isinstance(one, Recording) else Recording(one)
            for one in motions
            if isinstance(one, Recording | Record)
        ],
        overwrite=overwrite,
        workers=workers,
    )


def write_page(
    subjects: Sequence[Subject],
    demands: Sequence[Demand],
    target: str | Path,
    asked: Asked,
    *,
    demand: str,
    overwrite: bool,
    workers: int | None,
    opposite: Callable[[], Sequence[tuple[str, Outcome]]],
    ranges: Mapping[str, OfRange] | None = None,
    remarks: Callable[[Sequence[Verdict]], Iterable[str]] | None = None,
    recordings: Sequence[Recording] = (),
    vertical: str | None = None,
    progress: Progress | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> list[Verdict]:
    """Check the structures under their demands, write the page and return the verdicts.

    ranges: as of `verdicts`; opposite: returns the outcomes in the opposite direction
    by name; remarks: returns sentences on the verdicts; tell: called with the verdict
    of the code; the other arguments are those of `page`. Raises UsageError for a target
    that cannot or must not be written, before anything is computed, and OutputError.
    """
    check_target(Path(target), overwrite)
    require(*WRITTEN_WITH)
    found = list(verdicts(demands, ranges=ranges, workers=workers, progress=progress))
    outcomes = opposite()
    checks = [] if asked.code is None else checked(subjects, found, demands, asked.code)
    for line in verified_in_words([one.check for one in checks]):
        tell(line)
    text = page(
        subjects,
        found,
        asked,
        checks=checks,
        demands=demands,
        recordings=recordings,
        vertical=vertical,
        demand=demand,
        opposite=opposite_in_words(outcomes) if outcomes else "",
        remarks=[] if remarks is None else list(remarks(found)),
        workers=workers,
    )
    with published(Path(target), overwrite) as file:
        file.write(whole_text(text).encode())
    return found
