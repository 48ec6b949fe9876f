"""A report on structures under a motion as one HTML file, which loads nothing from a
network.

The template escapes every text of the user. jinja2 and matplotlib are imported by what
writes a page.
"""

import base64
import hashlib
import platform
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import date
from importlib.metadata import version
from importlib.resources import files
from operator import attrgetter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from .. import __version__
from ..documents.document import Document
from ..documents.quantities import DEFAULT_GRAVITY
from ..dynamics.method import LINEAR, governing_method, has_direction
from ..dynamics.outcome import Difference, difference
from ..envelopes.intervals import A_MAX
from ..errors import DocumentError, UsageError
from ..fragility.exposure import MotionSet, exposures
from ..fragility.fits import FEWEST, Resampling
from ..fragility.measures import MEASURES, members_of
from ..fragility.study import LIMITS, Fit, Study, word_of
from ..motions import Motion
from ..motions.grid import Axis, Grid, HasMotion, demand_in_words, demand_of
from ..motions.recording import Recording
from ..motions.records import Record
from ..plugins import require
from ..publishing import check_target, published
from ..responses.check import Progress, Verdict, outcome_alone, tally, verdicts
from ..responses.inset import effects
from ..responses.tied_history import remarks
from ..spectra.file.reader import SpectraFile
from ..spectra.sweep import SweepOptions, write_spectrum
from ..structures import (
    RockingParameters,
    build_structure,
    on_each_interface,
    with_distinct_names,
)
from ..structures.kinds import sketch_of
from .figures.canvas import FIGURE_UNITS, Figure, Look, drawn_as, literal, styled
from .figures.capacities import capacities
from .figures.drawing import structure_axes
from .figures.fragility_curves import fragility_curves
from .figures.maps import outcome_map
from .tables import Above
from .wording import (
    OVERVIEW,
    capacity_left,
    demand_plainly,
    opposite_in_words,
    overview_row,
    parameter_rows,
    worst_of,
)

SIDE = 80  # values on each axis of a map
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


@dataclass(frozen=True)
class Subject:
    """A structure and its document."""

    document: Document  # from which the structure was built
    structure: RockingParameters  # its parameters


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
) -> str:
    """Return the page as HTML.

    verdicts: those of `check`, for each structure and motion; pulse: a motion and its
    grid of one cell; vertical: name or file of the vertical motion; demand: the
    strength of the shaking in words; title: None for the names of the structures;
    summary: begin with a sentence on each structure and a list of contents;
    by_capacity: the least capacity first; opposite: a remark on that direction; insets:
    lines on what worn edges would take of the capacities.
    """
    from jinja2 import Environment, StrictUndefined

    template = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True
    ).from_string((files(__package__) / "page.html").read_text(encoding="utf-8"))
    motions = ", ".join(dict.fromkeys(v.motion for v in verdicts))
    if by_capacity:
        verdicts = sorted(verdicts, key=capacity_left)
        order = [v.structure for v in verdicts]
        subjects = sorted(subjects, key=lambda s: order.index(s.structure.name))
    packages = ("numpy", "scipy", "h5py", "matplotlib", "jinja2")
    of = {
        s.structure.name: [v for v in verdicts if v.structure == s.structure.name]
        for s in subjects
    }
    return template.render(
        title=title or f"Rocking of {', '.join(of)}",
        opposite=opposite,
        insets=insets,
        lead=(
            f"{tally(verdicts)}, under {demand}."
            if summary
            else f"{tally(verdicts)}, under {motions}: {demand}."
        ),
        overview=(
            [_row(OVERVIEW, overview_row(mine), worst_of(mine)) for mine in of.values()]
            if summary
            else []
        ),
        verdicts=[_row(HEADS, attrgetter(*HEADS.values())(v), v) for v in verdicts],
        capacities=_image(lambda figure: capacities(figure, verdicts, True)),
        structures=[
            _section(one, of[one.structure.name], pulse, recordings, workers)
            for one in subjects
        ],
        command=command,
        made=made,
        versions=[
            ("rocking", __version__),
            ("Python", platform.python_version()),
            *((p, version(p)) for p in packages),
        ],
        hashes=_hashes(subjects, recordings, vertical),
    )


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
    """Write the page of `rocking report` about the structures of documents under a
    motion or records; return its verdicts.

    shaking: a grid of one cell, which records do not need; the other arguments as of
    `page`. Raises UsageError, and OutputError for a file that cannot be written.

    >>> documents = read_documents('configs/parameters.yaml')
    >>> shaking = parse_grid('a_g=0.2g,f_g=2')
    >>> verdicts = report(documents, sine(), 'r.html', shaking=shaking)
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
    sided = [
        (s.name, outcome_alone(s, motion.scaled(-1.0), grid))
        for s, motion, grid in demands
        if has_direction(s)
    ]
    demand = demand_plainly(shakes, vertical) if summary else demand_in_words(shakes)
    text = page(
        subjects,
        found,
        pulse=None if shakes[0][0].acceleration is not None else shakes[0],
        recordings=recordings,
        vertical=vertical,
        demand=demand,
        workers=workers,
        summary=summary,
        opposite=opposite_in_words(sided) if sided else "",
        insets=list(effects(found, demands, A_MAX)) if inset_effect else [],
        **given,
    )
    with published(Path(target), overwrite) as file:
        file.write(text.encode())
    return found


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


def _section(
    subject: Subject,
    mine: Sequence[Verdict],
    pulse: tuple[Motion, Grid] | None,
    recordings: Sequence[Recording],
    workers: int | None,
) -> dict[str, Any]:
    """Return the template's values for one structure and its verdicts."""
    structure = subject.structure
    linear = all(v.model == LINEAR.model for v in mine)
    outcomes = np.array(
        [(v.outcome, v.outcome_linear) for v in mine], dtype=np.uint8
    ).reshape(-1, 2)
    drawn, codes = None, difference(outcomes[:, 0], outcomes[:, 1])
    if pulse is not None:
        drawn, codes = _map(structure, *pulse, mine, workers)
    cases = "motions" if pulse is None else "cells of the map"
    return {
        "name": structure.name,
        "kind": (
            f"kind {structure.structure}, restitution {structure.eta_source}"
            if structure.eta_source
            else structure.structure
        ),
        "drawing": _drawing(subject),
        "parameters": parameter_rows(structure),
        "ties": [
            f"{v.motion}: {x}"
            for v in mine
            for x in [
                *remarks(v.devices, v.first_overturning_a, v.first_overturning_a_free),
                *([v.slide.words] if v.slide else []),
                *([v.coupling] if v.coupling else []),
            ]
        ],
        "map": drawn,
        "validity": (
            "The linear equation alone answers here."
            if linear
            else _agreement(codes, cases)
        ),
        "fragility": _fragility(structure, recordings, workers) if recordings else None,
        "text": subject.document.text.strip(),
    }


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


def _image(plan: Callable[[Figure], object]) -> str:
    """Return a figure as a data URL."""
    look = Look()
    with styled(look) as figure:
        plan(figure)
        drawn, _ = drawn_as(figure, Path("figure.svg"), look)
    return f"data:image/svg+xml;base64,{base64.b64encode(drawn).decode()}"


def _drawing(subject: Subject) -> str | None:
    """Return a drawing of the structure as a data URL, None without geometry."""
    try:
        sketch = sketch_of(subject.document, subject.structure)
    except DocumentError:
        return None
    return _image(
        lambda figure: structure_axes(
            figure.add_subplot(), subject.structure, sketch, FIGURE_UNITS
        )
    )


def _map(
    structure: RockingParameters,
    motion: Motion,
    demand: Grid,
    mine: Sequence[Verdict],
    workers: int | None,
) -> tuple[str, np.ndarray]:
    """Return (the map around the demand as a data URL, the `Difference` of each cell,
    empty for the linear equation).
    """
    (omega,) = demand.frequency.values / (
        1.0 if demand.frequency.name == "omega_g" else 1.0 / structure.p
    )
    amplitude = mine[0].demand_a
    most = 2.0 * max(
        [
            amplitude,
            *(v.first_overturning_a for v in mine if v.first_overturning_a is not None),
        ]
    )
    most = min(most, 8.0 * amplitude)
    grid = Grid(
        Axis("a_g", most * np.arange(1, SIDE + 1) / SIDE),
        Axis("omega_g", omega * np.geomspace(0.25, 4.0, SIDE)),
    )
    method = governing_method(structure, dimensionless=demand.dimensionless)
    quantities = () if method.exact else ("linear",)

    def plan(figure: Figure) -> None:
        figure.set_size_inches(8.4, 4.0)  # with the legend beside the map
        axes = figure.add_subplot()
        entries = outcome_map(axes, file, 0, FIGURE_UNITS)
        x, y = (
            omega / FIGURE_UNITS.column("omega_g")[2],
            amplitude / FIGURE_UNITS.column("a_g")[2],
        )
        entries += axes.plot(
            x, y, ls="", marker="*", ms=13, mfc="#F0E442", mec="k", label="demand"
        )
        axes.set_xscale("log")
        ticks = [x * 2.0**i for i in range(-2, 3)]
        axes.set_xticks(ticks, [f"{tick:.3g}" for tick in ticks])
        axes.set_xticks([], minor=True)
        axes.set_title(literal(structure.name))
        figure.legend(handles=entries, loc="outside right upper")

    with TemporaryDirectory() as folder:
        path = Path(folder) / "map.h5"
        write_spectrum(
            [structure],
            motion,
            grid,
            path,
            method=method,
            quantities=quantities,
            check=0,
            workers=workers,
            overwrite=True,
        )
        with SpectraFile(path) as file:
            return _image(plan), (
                np.zeros(0)
                if method == LINEAR
                else file.block(0, slice(None))["difference"]
            )


def _agreement(codes: np.ndarray, cases: str) -> str:
    """Return a sentence that compares the outcomes of both equations; codes:
    `Difference` of each of the cases.
    """
    judged = codes[codes != Difference.NOT_COMPUTED]
    wrong, unsafe = (
        int(np.count_nonzero(x))
        for x in (judged > Difference.AGREES, judged == Difference.LINEAR_UNSAFE)
    )
    missing = codes.size - judged.size
    verb = "is" if missing == 1 else "are"
    more = (
        f" {missing} more {verb} not compared: by one equation or both the structure"
        " has no outcome."
        if missing
        else ""
    )
    return (
        f"In {wrong} of {judged.size} {cases} the linear equation ends otherwise than"
        f" the nonlinear one; in {unsafe} of them it says that the structure stands,"
        f" and the structure falls or leaves the ground.{more}"
    )


def _fragility(
    structure: RockingParameters, recordings: Sequence[Recording], workers: int | None
) -> dict[str, Any]:
    """Return the template's values for fragility curves over PGA by stripes."""
    if len(recordings) < FEWEST:
        return {
            "figure": None,
            "fits": [],
            "remarks": [f"{len(recordings)} records; a fit needs at least {FEWEST}."],
        }
    measure, members = MEASURES["PGA"], members_of(recordings)
    levels = np.median(
        [m.measured(measure, structure) for m in members]
    ) * np.geomspace(0.25, 4.0, 16)
    motions = MotionSet(members, measure, levels, governing_method(structure))
    (exposure,) = exposures([structure], motions, sweep=SweepOptions(workers=workers))
    study = Study(structure, motions, Resampling(200, 0), exposure)
    upwards = recordings[0].upwards is not None
    fits, remarks = (
        [],
        (
            [
                "The vertical motion is scaled with each record; PGA is that of the"
                " horizontal one."
            ]
            if upwards
            else []
        ),
    )
    for limit in LIMITS:
        try:
            fits.append(study.fit("stripes", limit))
        except UsageError as error:
            remarks.append(f"limit state {word_of(limit)}: {error}")
    rows = [
        {key: "" if value is None else str(value) for key, value in row.items()}
        for fit in fits
        for row in fit.points_of_curve()
    ]
    return {
        "figure": (
            _image(lambda figure: fragility_curves(figure, rows, FIGURE_UNITS))
            if fits
            else None
        ),
        "fits": [_fitted(fit) for fit in fits],
        "remarks": remarks,
    }


def _fitted(fit: Fit) -> dict[str, str]:
    c, b, g = fit.curve, fit.band, DEFAULT_GRAVITY
    return {
        "limit": fit.limit,
        "median": f"{c.median / g:.4g}",
        "median_band": (
            f"{b.median_low / g:.3g} to {b.median_high / g:.3g}" if b else "–"
        ),
        "beta": f"{c.beta:.3g}",
        "beta_band": f"{b.beta_low:.3g} to {b.beta_high:.3g}" if b else "–",
    }
