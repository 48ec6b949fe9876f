"""Figures of a check: a bar of capacity and demand for each structure, or, by a code,
its capacity curve a over d with limit states.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from ...digits import rounded_down
from ...documents.quantities import DEFAULT_GRAVITY
from ...dynamics.outcome import Outcome
from ...errors import UsageError
from ..tables import Above
from .canvas import (
    Axes,
    Figure,
    is_own,
    literal,
    motion_in_words,
    panels,
)
from .colours import COLOURS

if TYPE_CHECKING:
    from ...responses.code_check import CodeCheck, Reached
    from ...responses.verdict import Verdict
    from ..rows import Rows
    from ..units import Units

_MM = 1000.0
_TITLE = 60  # characters of a line of a title, beside long names


def checked(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the rows of `rocking check --csv`."""
    return capacities(figure, list(map(_verdict, rows)), units)


def _verdict(row: Mapping[str, Any]) -> Verdict:
    """Return the verdict of a row of `rocking check`."""
    from ...responses.verdict import Verdict

    numbers: dict[str, Any] = {
        key: None if row.get(key) is None else float(row[key])
        for key in (
            "theta_ratio",
            "demand_a",
            "uplift_a",
            "first_overturning_a",
            "safe_to",
            "searched_to",
            "omega_g",
        )
    }
    return Verdict(
        structure=row["structure"],
        motion=row["motion"],
        model=row["model"],
        outcome=Outcome[str(row["outcome"]).upper()],
        outcome_linear=Outcome[str(row["outcome_linear"]).upper()],
        **numbers,
    )


def capacities(figure: Figure, verdicts: Sequence[Verdict], units: Units) -> list[Axes]:
    """Draw for each structure a bar up to its first overturning, if it was found, marks
    at uplift and demand, and the outcome in words; in g or in m/s2.
    """
    in_g = units.of("acceleration")[0] == "g"
    figure.set_size_inches(6.4, 1.6 + 0.32 * len(verdicts))
    axes = figure.add_subplot()
    unit = DEFAULT_GRAVITY if in_g else 1.0
    most = (
        1.15
        * max(
            x
            for v in verdicts
            for x in (v.demand_a, v.uplift_a, v.first_overturning_a)
            if x is not None
        )
        / unit
    )
    own = is_own(axes)  # else the words stand inside
    for row, v in enumerate(verdicts):
        _plot_bar(axes, row, v, unit)
        axes.annotate(
            _verdict_in_words(v),
            (1.0, row),
            xycoords=("axes fraction", "data"),
            xytext=(6 if own else -4, 0),
            textcoords="offset points",
            ha="left" if own else "right",
            va="center",
            fontsize="small",
        )
    demands = np.repeat([v.demand_a / unit for v in verdicts], 2)
    ends = np.repeat(np.arange(len(verdicts) + 1) - 0.5, 2)[1:-1]
    axes.plot(demands, ends, color="#D55E00", lw=2.0)
    motions, names, models = (
        list(dict.fromkeys(x))
        for x in zip(*((v.motion, v.structure, v.model) for v in verdicts), strict=True)
    )
    rows = [
        (
            v.structure
            if len(motions) == 1
            else v.motion
            if len(names) == 1
            else f"{v.structure}, {v.motion}"
        )
        for v in verdicts
    ]
    axes.set_yticks(range(len(verdicts)), [literal(row) for row in rows])
    axes.invert_yaxis()
    axes.set(
        xlim=(0.0, most),
        xlabel=(
            f"$a_g$ [{'g' if in_g else 'm/s²'}]\nbar: to the first overturning; dots:"
            " uplift; line: demand"
        ),
    )
    under = (
        motion_in_words(motions[0]) if len(motions) == 1 else f"{len(motions)} motions"
    )
    under += _at_frequencies(verdicts)
    of = f"{names[0]}, " if len(names) == 1 else ""
    title = f"capacity over demand: {of}{under}, {' or '.join(models)} equation"
    axes.set_title(fill(literal(title), _TITLE))
    axes.grid(axis="y", visible=False)
    return [axes]


def _at_frequencies(verdicts: Sequence[Verdict]) -> str:
    """Return the frequency of the pulses in words, empty under records."""
    found = [v.omega_g / math.tau for v in verdicts if v.omega_g is not None]
    if not found:
        return ""
    ends = dict.fromkeys(f"{x:.4g}" for x in (min(found), max(found)))
    return f" at {' to '.join(ends)} Hz"


def _plot_bar(axes: Axes, row: int, v: Verdict, unit: float) -> None:
    """Draw the bar of one verdict, and its mark at uplift; unit: of the axis [m/s2]."""
    colour = COLOURS[v.outcome] if v.outcome != Outcome.NO_UPLIFT else "#E8E8E8"
    reach = 0.0 if v.first_overturning_a is None else v.first_overturning_a / unit
    axes.barh(row, reach, height=0.62, color=colour, edgecolor="0.35", linewidth=0.8)
    if v.uplift_a is not None:
        uplift = [v.uplift_a / unit] * 2
        axes.plot(uplift, [row - 0.31, row + 0.31], color="k", lw=1.0, ls=":")


def _verdict_in_words(v: Verdict) -> str:
    """Return the capacity over the demand and the outcome. A body that stands although
    a weaker motion overturns it is in a safe window.
    """
    if v.capacity_demand is not None:
        window = v.outcome.safe and v.capacity_demand < 1.0
        words = ", in a safe window" if window else ""
        # to the safe side, as in the table of a report
        return f"{rounded_down(v.capacity_demand, 3, 1.0):g}  {v.sentence}{words}"
    if v.capacity_above is not None:
        return f"{Above(v.capacity_above).shown(3)}  {v.sentence}"
    if v.outcome == Outcome.SLID:
        return v.sentence
    return f"{v.sentence}; no capacity known"


def capacity_curves(figure: Figure, checks: Sequence[CodeCheck]) -> list[Axes]:
    """Draw each check by a code in a panel of its own."""
    drawn = panels(figure, len(checks))
    for axes, check in zip(drawn, checks, strict=True):
        capacity_curve(axes, check)
    width, height = figure.get_size_inches()
    figure.set_size_inches(1.4 * width, height)  # for the legends
    return drawn


def capacity_curve(axes: Axes, check: CodeCheck) -> None:
    """Draw a capacity curve, d [mm] across and a [g] upwards, with the spectrum of the
    demand; a cross marks the demand at each limit state.
    """
    d = _MM * check.curve.displacement
    a = check.curve.multiplier * check.factor / DEFAULT_GRAVITY
    axes.plot(d, a, color="k", lw=1.8, label="capacity")
    states = check.reached()
    asked = [
        (_MM * at.demand, (2.0 * np.pi / at.period) ** 2 * at.demand / DEFAULT_GRAVITY)
        for at in states.values()
    ]
    spectra = [_spectrum(at) for at in states.values()]
    right = 1.1 * max(d.max(), *(x for x, _ in asked), 0.0)
    top = 1.1 * max(a.max(), *(y for _, y in asked), 0.0)
    seen = [s_a[s_d <= right].max(initial=0.0) for s_d, s_a in spectra]
    # the plateau of a spectrum far above the capacity is not shown
    top = max(top, min(1.1 * max(seen, default=0.0), 3.0 * top))
    for i, (name, at) in enumerate(states.items()):
        axes.plot(
            *spectra[i],
            lw=1.1,
            alpha=0.7,
            label=f"demand, {100.0 * at.state.damping:g} %",
            color=f"C{i}",
        )
        _plot_state(axes, name, at, asked[i], right, f"C{i}")
    axes.set(xlim=(0.0, right), ylim=(0.0, top), xlabel="$d$ [mm]", ylabel="$a$ [g]")
    verdict = ", ".join(map(check.sentence, ("code_slv", "code_slc")))
    title = f"{check.structure}, NTC 2018, {code_demand_in_words([check])}\n{verdict}"
    axes.set_title(literal(title), fontsize="small")
    axes.legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1.01, 1.0))


def _plot_state(
    axes: Axes,
    name: str,
    at: Reached,
    demand: tuple[float, float],
    right: float,
    colour: str,
) -> None:
    """Draw a limit state, its secant period up to d = `right`, and a cross at its
    demand.
    """
    x, y = _MM * at.displacement, at.acceleration / DEFAULT_GRAVITY
    slope = (2.0 * np.pi / at.period) ** 2 / (_MM * DEFAULT_GRAVITY)
    period = f"$T_{{{name}}}$ = {at.period:.3g} s"
    secant = [0.0, right], [0.0, right * slope]
    axes.plot(*secant, lw=0.9, ls="--", label=period, color=colour)
    axes.plot(x, y, "o", ms=5, label=f"$d_{{{name}}}$ = {x:.3g} mm", color=colour)
    said = f"demand at {name} {demand[0]:.3g} mm"
    axes.plot(*demand, "x", ms=6, label=said, color=colour)
    axes.plot([x, x], [0.0, y], lw=0.7, ls=":", color=colour)


def code_demand_in_words(checks: Sequence[CodeCheck]) -> str:
    """Return the demands of checks by a code in words, such as `SLV of site: 0.335 g`;
    without the limit state if the demand of both is one.
    """
    found: dict[str, dict[str, None]] = {}
    for check in checks:
        for state, of in check.asked.items():
            shaking = motion_in_words(of.name)
            text = f"{shaking}: {of.amplitude / DEFAULT_GRAVITY:.3g} g"
            found.setdefault(text, {})[state] = None
    if all(len(states) > 1 for states in found.values()):
        return ", ".join(found)
    return ", ".join(f"{' and '.join(s)} of {text}" for text, s in found.items())


def _spectrum(at: Reached) -> tuple[np.ndarray, np.ndarray]:
    """Return (displacements [mm], accelerations [g]) of the demand of a limit state at
    its damping, for periods to twice the secant one, or as far as the spectrum goes.
    """
    periods = np.geomspace(0.03, 2.0, 300) * at.period
    try:
        demand = at.of.spectrum.acceleration(periods, at.state.damping)
    except UsageError:  # a spectrum of a file ends before
        periods = np.geomspace(0.03, 1.0, 300) * at.period
        demand = at.of.spectrum.acceleration(periods, at.state.damping)
    displacement = _MM * demand * (periods / (2.0 * np.pi)) ** 2
    return displacement, demand / DEFAULT_GRAVITY
