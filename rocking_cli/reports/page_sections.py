"""The section of the page on one structure: its drawing and parameters, the map around
the demand, the agreement of both equations, and fragility curves.
"""

import base64
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from ..documents.quantities import DEFAULT_GRAVITY
from ..dynamics.method import LINEAR, governing_method
from ..dynamics.outcome import Difference, difference
from ..dynamics.response import LONG
from ..errors import DocumentError, UsageError
from ..fragility.bootstrap import Resampling
from ..fragility.exposure import MotionSet, exposures
from ..fragility.fits import FEWEST
from ..fragility.fitted_curve import Fit, word_of
from ..fragility.measures import members_of
from ..fragility.study import LIMITS, Study
from ..motions import Motion
from ..motions.grid import Axis, Grid
from ..motions.intensity_measures import MEASURES
from ..motions.recording import Recording
from ..responses.check import Demand
from ..responses.code_check import METHODS
from ..responses.code_verdict import CodeVerdict
from ..responses.shares import ShareOfDraws
from ..responses.uncertainty import drawn_verdict, share_curve
from ..responses.verdict import Verdict
from ..spectra.results import Spectrum
from ..spectra.sweep import spectrum
from ..spectra.sweep_options import SweepOptions
from ..structures import RockingParameters
from ..structures.kinds import sketch_of
from .device_words import devices_in_words
from .figures.canvas import FIGURE_UNITS, Figure, Look, drawn_as, place, styled
from .figures.capacities import capacity_curve
from .figures.drawing import structure_axes
from .figures.fragility_curves import fragility_curves
from .figures.maps import outcome_map
from .figures.memory import memory_file
from .figures.shares import shares
from .page_parts import Asked
from .wording import draws_in_words, parameter_rows

SIDE = 60  # values on each axis of a map, whose cells are printed 1 mm wide
# amplitudes of the curve of draws, and those in a step where the share changes
CURVE, CLOSER = 22, 6
_MAP_DPI = 200.0  # of the cells of a map, four dots a cell and more
_SIZE = (4.2, 3.1)  # inches, of a drawing and a map: half of the width of a page
FEW_DRAWS = 128  # draws of that curve under a record, at most


@dataclass(frozen=True)
class Cases:
    """One structure under each of its motions."""

    structure: RockingParameters
    verdicts: list[Verdict]  # of `check`
    shakes: list[tuple[Motion, Grid]]  # motion and demand of each verdict
    checks: list[CodeVerdict]  # by the code, of each verdict; none without a code

    @classmethod
    def of(
        cls,
        structure: RockingParameters,
        verdicts: Sequence[Verdict],
        demands: Sequence[Demand],
        checks: Sequence[CodeVerdict],
    ) -> "Cases":
        """Return those of a structure."""
        name = structure.name
        return cls(
            structure,
            [v for v in verdicts if v.structure == name],
            [(motion, grid) for s, motion, grid in demands if s.name == name],
            [one for one in checks if one.check.structure == name],
        )


def section(asked: Asked, workers: int | None, cases: Cases) -> dict[str, Any]:
    """Return the template's values for one structure and its verdicts."""
    structure, mine, recordings = cases.structure, cases.verdicts, asked.recordings
    # A record, and a motion of a floor, have no map over frequencies.
    pulses = [shake for shake in cases.shakes if shake[0].acceleration is None]
    pulse = pulses[0] if pulses and not recordings else None
    if pulse is None:
        drawn, judged = None, "motions"
        outcomes = np.array(
            [(v.outcome, v.outcome_linear) for v in mine], dtype=np.uint8
        ).reshape(-1, 2)
        codes = difference(outcomes[:, 0], outcomes[:, 1])
    else:
        judged = "cells of the map"
        drawn, codes = _map(structure, *pulse, asked.ends, mine, workers)
    linear = all(v.model == LINEAR.model for v in mine)
    kind = structure.structure
    if structure.eta_source:
        kind = f"kind {kind}, restitution {structure.eta_source}"
    return {
        "name": structure.name,
        "kind": kind,
        "drawing": _drawing(structure),
        "parameters": parameter_rows(structure),
        "ties": [
            f"{v.motion}: {remark}"
            for v in mine
            for remark in [
                *devices_in_words(v),
                *([v.slide.words] if v.slide else []),
                *([v.coupling] if v.coupling else []),
            ]
        ],
        "map": drawn,
        "validity": (
            None
            if not mine
            else "The linear equation alone answers here."
            if linear
            else _agreement(codes, judged)
        ),
        "fragility": (
            _fragility(structure, recordings, workers)
            if recordings and asked.fragility
            else None
        ),
        "code": _by_code(cases) if cases.checks else None,
        "draws": _draws(cases, asked.draws),
        "text": structure.document.text.strip() if structure.document else "",
    }


def image(plan: Callable[[Figure], object]) -> str:
    """Return a figure as a data URL."""
    look = Look(dpi=_MAP_DPI)
    with styled(look) as figure:
        plan(figure)
        drawn, _ = drawn_as(figure, Path("figure.svg"), look)
    return f"data:image/svg+xml;base64,{base64.b64encode(drawn).decode()}"


def _drawing(structure: RockingParameters) -> str | None:
    """Return a drawing of the structure as a data URL, None without geometry."""
    if structure.document is None:
        return None
    try:
        sketch = sketch_of(structure.document, structure)
    except DocumentError:
        return None

    def plan(figure: Figure) -> None:
        figure.set_size_inches(*_SIZE)
        axes = figure.add_subplot()
        structure_axes(axes, structure, sketch, FIGURE_UNITS, described=False)
        axes.set_axis_off()  # its lines of dimension state the size
        axes.margins(0.05)
        place(figure, axes, left=0.1, bottom=0.1, top=0.3)

    return image(plan)


def _map(
    structure: RockingParameters,
    motion: Motion,
    demand: Grid,
    ends: Sequence[Grid],
    mine: Sequence[Verdict],
    workers: int | None,
) -> tuple[str, np.ndarray]:
    """Return (the map around the demand as a data URL, the `Difference` of each cell,
    empty for the linear equation).
    """
    omega, *asked = (
        float(grid.cell(structure)[1]) * structure.p for grid in (demand, *ends)
    )
    amplitude = mine[0].demand_a
    # the map covers the frequencies that are asked
    low, high = min(asked, default=0.5 * omega), max(asked, default=2.0 * omega)
    omegas = np.geomspace(0.5 * low, 2.0 * high, SIDE)
    method = governing_method(structure, dimensionless=demand.dimensionless)
    found = spectrum(
        [structure],
        motion,
        _grid_over(omegas, amplitude, mine),
        method=method,
        quantities=() if method.exact else ("linear",),
        check=0,
        workers=workers,
    )
    drawn = image(lambda figure: _draw_map(figure, found, omega, asked, amplitude))
    return drawn, found.quantities.get("difference", np.zeros(0))


def _grid_over(omegas: np.ndarray, amplitude: float, mine: Sequence[Verdict]) -> Grid:
    """Return the grid of a map: frequencies [rad/s], and amplitudes up to
    twice the demand or the first overturning, at most eight times the demand [m/s2].
    """
    found = [v.first_overturning_a for v in mine if v.first_overturning_a is not None]
    most = min(2.0 * max([amplitude, *found]), 8.0 * amplitude)
    return Grid(
        Axis("a_g", most * np.arange(1, SIDE + 1) / SIDE),
        Axis("omega_g", omegas),
    )


def _draw_map(
    figure: Figure,
    found: Spectrum,
    omega: float,
    ends: Sequence[float],
    amplitude: float,
) -> None:
    """Draw the map of a spectrum, and a star at the demand [rad/s, m/s2]; of a range
    between two ends a line, and the star at the least capacity.
    """
    figure.set_size_inches(*_SIZE)
    axes, cells = figure.add_subplot(), memory_file(found)
    assert cells is not None
    entries = outcome_map(axes, cells, 0, FIGURE_UNITS)
    unit = FIGURE_UNITS.column("omega_g")[2]
    x = omega / unit
    y = amplitude / FIGURE_UNITS.column("a_g")[2]
    name = "demand"
    if ends:
        between = np.array(ends) / unit
        entries += axes.plot(between, [y, y], color="k", lw=1.6, label=name)
        name = "least capacity"
    entries += axes.plot(
        x, y, ls="", marker="*", ms=13, mfc="#F0E442", mec="k", label=name
    )
    axes.set_xscale("log")
    ticks = np.geomspace(*axes.get_xlim(), 5)
    axes.set_xticks(ticks, [f"{tick:.3g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set_title("")
    figure.legend(handles=entries, loc="lower center", ncols=2, fontsize="small")
    lines = -(-len(entries) // 2)
    place(figure, axes, left=0.7, bottom=0.6 + 0.16 * lines)


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
    study = _stripes(structure, recordings, workers)
    fits: list[Fit] = []
    remarks: list[str] = []
    if recordings[0].upwards is not None:
        remarks.append(
            "The vertical motion is scaled with each record; PGA is that of the"
            " horizontal one."
        )
    for limit in LIMITS:
        try:
            fits.append(study.fit("stripes", limit))
        except UsageError as error:
            remarks.append(f"limit state {word_of(limit)}: {error}")
    rows = [row for fit in fits for row in fit.points_of_curve()]
    drawn = None
    if fits:
        drawn = image(lambda figure: fragility_curves(figure, rows, FIGURE_UNITS))
    return {
        "figure": drawn,
        "fits": [_fitted(fit) for fit in fits],
        "remarks": remarks,
    }


def _by_code(cases: Cases) -> dict[str, Any]:
    """Return the template's values for the checks of a structure by the code: a line on
    each motion, and the capacity curve under the worst one.
    """
    worst = min(cases.checks, key=lambda one: one.least)

    def plan(figure: Figure) -> None:
        figure.set_size_inches(6.4, 3.2)
        capacity_curve(figure.add_subplot(), worst.check)

    lines = []
    for one, v in zip_longest(cases.checks, cases.verdicts):
        several = f"{one.motion}: " if len(cases.checks) > 1 else ""
        lines.append(f"{several}{', '.join(map(one.check.sentence, METHODS))}")
        if v is not None:
            promises = one.check.promises(v.first_overturning_a, one.beyond(v))
            lines += [f"{several}{line}" for line in promises]
        if one.check.slv and one.check.slv.broken:
            lines.append(f"{several}a tie or a tendon breaks before 0.4 d0")
    return {"lines": lines, "figure": image(plan)}


def _draws(cases: Cases, draws: tuple[int, int] | None) -> dict[str, Any] | None:
    """Return the template's values for the draws of a structure: a line on each motion,
    and the share that falls over the amplitude of the worst one. None without draws.
    """
    structure = cases.structure
    if draws is None or structure.drawn_from is None:
        return None
    n, seed = draws
    shakes = cases.shakes
    found = [drawn_verdict(structure, *shake, n=n, seed=seed) for shake in shakes]
    worst = max(range(len(found)), key=lambda i: found[i].share.count)
    motion, shaking = shakes[worst]
    demand = cases.verdicts[worst].demand_a
    some = n if len(motion.segments) <= LONG else min(n, FEW_DRAWS)
    amplitudes, curve = _share_curve(structure, motion, shaking, demand, some, seed)

    def plan(figure: Figure) -> None:
        axes = figure.add_subplot()
        shares(axes, motion.name, amplitudes, curve, demand, FIGURE_UNITS)

    return {
        "lines": [
            draws_in_words(
                f"{structure.name} under {motion.name}"
                if len(shakes) > 1
                else structure.name,
                one,
            )
            for (motion, _), one in zip(shakes, found, strict=True)
        ],
        "figure": image(plan),
    }


def _share_curve(
    structure: RockingParameters,
    motion: Motion,
    shaking: Grid,
    demand: float,
    n: int,
    seed: int,
) -> tuple[np.ndarray, list[ShareOfDraws]]:
    """Return (amplitudes [m/s2], the share of the draws that falls at each), from a
    quarter of the demand to twice it, closer where the share changes much.
    """
    x = demand * np.linspace(0.25, 2.0, CURVE)
    found = share_curve(structure, motion, shaking, x, n, seed)
    steps = np.abs(np.diff([one.share for one in found]))
    between = [
        np.linspace(x[i], x[i + 1], CLOSER + 2)[1:-1]
        for i in np.flatnonzero(steps > 0.05)
    ]
    if not between:
        return x, found
    more = np.concatenate(between)
    found += share_curve(structure, motion, shaking, more, n, seed)
    x = np.append(x, more)
    order = np.argsort(x)
    return x[order], [found[i] for i in order]


def _stripes(
    structure: RockingParameters, recordings: Sequence[Recording], workers: int | None
) -> Study:
    """Return the study of a structure under all records at 16 levels of PGA, from a
    quarter to four times their median.
    """
    measure, members = MEASURES["PGA"], members_of(recordings)
    middle = np.median([m.measured(measure, structure) for m in members])
    levels = middle * np.geomspace(0.25, 4.0, 16)
    motions = MotionSet(members, measure, levels, governing_method(structure))
    (exposure,) = exposures([structure], motions, sweep=SweepOptions(workers=workers))
    return Study(structure, motions, Resampling(200, 0), exposure)


def _fitted(fit: Fit) -> dict[str, str]:
    """Return the numbers of a fragility curve as the page shows them."""
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
