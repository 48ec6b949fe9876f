"""A figure of capacity and demand: one bar for each structure, up to its first overturning."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...documents.quantities import DEFAULT_GRAVITY
from ...dynamics.outcome import Outcome
from .canvas import Axes, Figure, Look, canvas, literal

if TYPE_CHECKING:
    from ...responses.check import Verdict
    from ..rows import Rows
    from ..units import Units

_ROW = 0.32  # inches


def draw_capacities(
    verdicts: Sequence[Verdict], target: str | Path, *, in_g: bool = False, look: Look | None = None, overwrite: bool = True,
    tell: Callable[[str], None] | None = None,
) -> None:  # fmt: skip
    """Draw the verdicts of a check into a PNG, SVG or PDF file.

    in_g: accelerations in g, else in m/s2; overwrite: an existing file may be replaced; tell: called with characters that the font
    lacks. Raises OutputError if matplotlib is not installed or the figure cannot be written.

    >>> (arch,) = load_structures('configs/parameters.yaml')
    >>> draw_capacities([check(arch, sine(), parse_grid('a_g=0.35g,f_g=1.5'))], 'capacity.svg')
    """
    with canvas(target, overwrite, look=look, tell=tell) as figure:
        capacities(figure, verdicts, in_g)


def checked(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the rows of `rocking check --csv`. Raises ValueError if a row states neither its demand nor its capacity."""
    return [capacities(figure, [_verdict(row) for row in rows], units.of("acceleration")[0] == "g")]


def _verdict(row: dict[str, str]) -> Verdict:
    from ...responses.check import Verdict

    name = row.get("structure") or row["name"]
    theta, demand, uplift, first, safe_to, ratio = (
        float(row[key]) if row.get(key) else None
        for key in ("theta_ratio", "demand_a", "uplift_a", "first_overturning_a", "safe_to", "capacity_demand")
    )
    if demand is None:
        if first is None or ratio is None:
            raise ValueError(f"{name} never overturns, and no column demand_a states the demand")
        demand = first / ratio
    outcome, linear = (next(o for o in Outcome if o.flag == row[key]) for key in ("outcome", "outcome_linear"))
    return Verdict(name, row["motion"], row["model"], outcome, theta, demand, uplift, first, safe_to, linear)


def capacities(figure: Figure, verdicts: Sequence[Verdict], in_g: bool) -> Axes:
    """Draw for each structure a bar up to its first overturning, marks at uplift and demand, and the outcome in words."""
    figure.set_size_inches(6.4, 1.6 + _ROW * len(verdicts))
    axes = figure.add_subplot()
    unit = DEFAULT_GRAVITY if in_g else 1.0
    most = 1.15 * max(x for v in verdicts for x in (v.demand_a, v.uplift_a, v.first_overturning_a) if x is not None) / unit
    for row, v in enumerate(verdicts):
        colour = v.outcome.colour if v.outcome != Outcome.NO_UPLIFT else "#E8E8E8"
        reach = most if v.first_overturning_a is None else v.first_overturning_a / unit
        axes.barh(row, reach, height=0.62, color=colour, edgecolor="0.35", linewidth=0.8)
        if v.uplift_a is not None:
            axes.plot([v.uplift_a / unit] * 2, [row - 0.31, row + 0.31], color="k", lw=1.0, ls=":")
        axes.plot([v.demand_a / unit] * 2, [row - 0.45, row + 0.45], color="#D55E00", lw=2.0)
        ratio = "never overturns" if v.capacity_demand is None else f"{v.capacity_demand:.2f}"
        window = ", in a safe window" if v.outcome.safe and v.capacity_demand is not None and v.capacity_demand < 1.0 else ""
        axes.annotate(
            f"{ratio}  {v.sentence}{window}", (1.0, row), xycoords=("axes fraction", "data"), xytext=(6, 0),
            textcoords="offset points", va="center", fontsize="small",
        )  # fmt: skip
    motions, names, models = (list(dict.fromkeys(x)) for x in zip(*((v.motion, v.structure, v.model) for v in verdicts), strict=True))
    rows = [v.structure if len(motions) == 1 else v.motion if len(names) == 1 else f"{v.structure}, {v.motion}" for v in verdicts]
    axes.set_yticks(range(len(verdicts)), [literal(row) for row in rows])
    axes.invert_yaxis()
    axes.set(xlim=(0.0, most), xlabel=f"a_g [{'g' if in_g else 'm/s²'}]\nbar: to the first overturning; dots: uplift; line: demand")
    under = motions[0] if len(motions) == 1 else f"{len(motions)} motions"
    of = f"{names[0]}, " if len(names) == 1 else ""
    axes.set_title(literal(f"capacity over demand: {of}{under}, {' or '.join(models)} equation"))
    axes.grid(axis="y", visible=False)
    return axes
