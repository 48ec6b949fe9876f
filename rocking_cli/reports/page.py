"""A report on structures under a motion as one HTML file, which loads nothing from a
network.

The template escapes every text of the user. jinja2 and matplotlib are imported by what
writes a page.
"""

import hashlib
import platform
from collections.abc import Iterable, Sequence
from datetime import date
from importlib.metadata import version
from importlib.resources import files
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..documents.document import Document
from ..documents.quantities import DEFAULT_GRAVITY
from ..dynamics.method import has_direction
from ..envelopes.intervals import A_MAX
from ..motions import Motion
from ..motions.grid import Grid, HasMotion, demand_in_words, demand_of
from ..motions.recording import Recording
from ..motions.records import Record
from ..plugins import require
from ..publishing import check_target, published
from ..responses.check import Progress, outcome_alone, verdicts
from ..responses.inset import effects
from ..responses.verdict import Verdict, tally
from ..structures import (
    RockingParameters,
    build_structure,
    on_each_interface,
    with_distinct_names,
)
from .figures.capacities import capacities
from .page_sections import Subject, image, section
from .tables import Above
from .wording import (
    OVERVIEW,
    capacity_left,
    demand_plainly,
    opposite_in_words,
    overview_row,
    worst_of,
)

if TYPE_CHECKING:
    from jinja2 import Template

HEADS = {
    "structure": "structure",
    "motion": "motion",
    "model": "model",
    "outcome": "sentence",
    "θ max/α": "theta_ratio",
    "demand [g]": "demand_a",
    "uplift [g]": "uplift_a",
    "overturns from [g]": "first_overturning_a",
    "capacity over demand": "capacity_demand",
    "safe up to [g]": "safe_to",
    "linear says": "outcome_linear.sentence",
    "friction needed": "friction_needed",
    "least vertical force": "fz_min",
}
"""The columns of the table of verdicts, and the attribute of a verdict in each."""


WRITTEN_WITH = ("a report needs", "jinja2", "matplotlib")  # the arguments of `require`


def page(
    subjects: Sequence[Subject],
    verdicts: Sequence[Verdict],
    *,
    pulse: tuple[Motion, Grid] | None = None,
    recordings: Sequence[Recording] = (),
    vertical: str | None = None,
    demand: str,
    command: str,
    made: str,
    workers: int | None = None,
    title: str | None = None,
    summary: bool = False,
    by_capacity: bool = False,
    opposite: str = "",
    insets: Sequence[str] = (),
    draws: tuple[int, int] | None = None,
) -> str:
    """Return the page as HTML.

    verdicts: those of `check`, for each structure and motion; pulse: a motion and its
    grid of one cell; vertical: name or file of the vertical motion; demand: the
    strength of the shaking in words; title: None for the names of the structures;
    summary: begin with a sentence on each structure and a list of contents;
    by_capacity: the least capacity first; opposite: a remark on that direction; insets:
    lines on what worn edges would take of the capacities; draws: their number and seed,
    of structures whose numbers have spreads.
    """
    motions = ", ".join(dict.fromkeys(v.motion for v in verdicts))
    if by_capacity:
        subjects, verdicts = _by_capacity(subjects, verdicts)
    of = {
        s.structure.name: [v for v in verdicts if v.structure == s.structure.name]
        for s in subjects
    }
    shaking = f"under {demand}" if summary else f"under {motions}: {demand}"
    return _template().render(
        title=title or f"Rocking of {', '.join(of)}",
        opposite=opposite,
        insets=insets,
        lead=f"{tally(verdicts)}, {shaking}.",
        overview=(
            [_row(OVERVIEW, overview_row(mine), worst_of(mine)) for mine in of.values()]
            if summary
            else []
        ),
        verdicts=[_row(HEADS, attrgetter(*HEADS.values())(v), v) for v in verdicts],
        capacities=image(lambda figure: capacities(figure, verdicts, True)),
        structures=[
            section(s, of[s.structure.name], pulse, recordings, workers, draws)
            for s in subjects
        ],
        command=command,
        made=made,
        versions=_versions(),
        hashes=_hashes(subjects, recordings, vertical),
    )


def _by_capacity(
    subjects: Sequence[Subject], verdicts: Sequence[Verdict]
) -> tuple[list[Subject], list[Verdict]]:
    """Return the structures and the verdicts, the least capacity first."""
    ordered = sorted(verdicts, key=capacity_left)
    names = [v.structure for v in ordered]
    return sorted(subjects, key=lambda s: names.index(s.structure.name)), ordered


def _template() -> "Template":
    """Return the page without its values; it escapes every text."""
    from jinja2 import Environment, StrictUndefined

    text = (files(__package__) / "page.html").read_text(encoding="utf-8")
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    return environment.from_string(text)


def _versions() -> list[tuple[str, str]]:
    """Return (name, version) of this program and of those that it computes with."""
    packages = ("numpy", "scipy", "h5py", "matplotlib", "jinja2")
    return [
        ("rocking", __version__),
        ("Python", platform.python_version()),
        *((package, version(package)) for package in packages),
    ]


def report(
    documents: Sequence[Document],
    motion: Motion | HasMotion | Sequence[Recording],
    target: str | Path,
    *,
    shaking: Grid | None = None,
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
        of the structures
    motion
        the motion of the ground, or several records
    target
        the HTML file to write
    shaking
        amplitude and frequency, a grid of one cell, which records do not need
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
    motions = list(motion) if isinstance(motion, Sequence) else [motion]
    documents = [one for document in documents for one in on_each_interface(document)]
    structures = with_distinct_names(
        [build_structure(document) for document in documents]
    )
    return write_page(
        [
            Subject(document, s)
            for document, s in zip(documents, structures, strict=True)
        ],
        [demand_of(one, shaking) for one in motions],
        target,
        command="rocking_cli.report",
        made=str(date.today()),
        recordings=[
            one if isinstance(one, Recording) else Recording(one)
            for one in motions
            if isinstance(one, Recording | Record)
        ],
        title=title,
        summary=summary,
        by_capacity=by_capacity,
        overwrite=overwrite,
        workers=workers,
    )


def write_page(
    subjects: Sequence[Subject],
    shakes: Sequence[tuple[Motion, Grid]],
    target: str | Path,
    *,
    recordings: Sequence[Recording],
    overwrite: bool,
    workers: int | None,
    summary: bool,
    vertical: str | None = None,
    progress: Progress | None = None,
    inset_effect: bool = False,
    **given: Any,
) -> list[Verdict]:
    """Check the structures under motions, write the page and return the verdicts;
    inset_effect: with lines on worn edges; given: more arguments of `page`. Raises
    UsageError for a target that cannot or must not be written, before anything is
    computed, and OutputError.
    """
    check_target(Path(target), overwrite)
    require(*WRITTEN_WITH)
    demands = [(one.structure, *shake) for shake in shakes for one in subjects]
    found = list(verdicts(demands, workers=workers, progress=progress))
    text = page(
        subjects,
        found,
        pulse=None if shakes[0][0].acceleration is not None else shakes[0],
        recordings=recordings,
        vertical=vertical,
        demand=(
            demand_plainly(shakes, vertical) if summary else demand_in_words(shakes)
        ),
        workers=workers,
        summary=summary,
        opposite=_opposite(demands),
        insets=list(effects(found, demands, A_MAX)) if inset_effect else [],
        **given,
    )
    with published(Path(target), overwrite) as file:
        file.write(text.encode())
    return found


def _opposite(demands: Sequence[tuple[RockingParameters, Motion, Grid]]) -> str:
    """Return a remark on the motions in the opposite direction, empty if no structure
    has a direction.
    """
    outcomes = [
        (structure.name, outcome_alone(structure, motion.scaled(-1.0), grid))
        for structure, motion, grid in demands
        if has_direction(structure)
    ]
    return opposite_in_words(outcomes) if outcomes else ""


def _hashes(
    subjects: Sequence[Subject], recordings: Sequence[Recording], vertical: str | None
) -> list[tuple[str, str]]:
    """Return (name, SHA-256) of each input: that of its file, or of the text of a
    document without a file.
    """
    inputs: dict[str, bytes] = {}
    for s in subjects:
        inputs[s.document.source] = (
            inputs.get(s.document.source, b"") + s.document.text.encode()
        )
    inputs |= {
        source: Path(source).read_bytes()
        for source in (*inputs, vertical or "")
        if Path(source).is_file()
    }
    found = {
        source: hashlib.sha256(content).hexdigest()
        for source, content in inputs.items()
    }
    return list(
        (found | {r.record.source: r.record.sha256 for r in recordings}).items()
    )


def _row(
    heads: Iterable[str], values: Iterable[str | float | None], v: Verdict
) -> dict[str, Any]:
    """Return the template's values for a row of a table of verdicts."""
    cells = []
    for head, x in zip(heads, values, strict=True):
        text = (
            "–"
            if x is None
            else (
                x
                if isinstance(x, str)
                else f"{x / (DEFAULT_GRAVITY if '[g]' in head else 1.0):.4g}"
            )
        )
        if (
            x is None
            and head == "capacity over demand"
            and v.capacity_above is not None
        ):
            text = Above(v.capacity_above).shown(4)
        cells.append({"head": head, "text": text, "number": not isinstance(x, str)})
    return {"falls": v.falls, "cells": cells}
