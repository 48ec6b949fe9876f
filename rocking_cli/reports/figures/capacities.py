"""A figure of capacities against the demand: a bar a structure, from uplift to its first overturning."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...documents.quantities import DEFAULT_GRAVITY
from ...dynamics.outcome import Outcome
from .canvas import canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...responses.check import Verdict

_ROW = 0.32  # inches


def draw_capacities(verdicts: Sequence[Verdict], target: str | Path, *, in_g: bool = False, overwrite: bool = True) -> None:
    """Draw the verdicts on structures under one demand into a PNG, SVG or PDF; in_g: accelerations in g, else m/s2; overwrite:
    replace a file of that name.

    Raises OutputError without matplotlib or where the figure cannot be written.

    >>> (arch,) = load_structures('configs/parameters.yaml')
    >>> draw_capacities([check(arch, sine(), parse_grid('a_g=0.35g,f_g=1.5'))], 'capacity.svg')
    """
    with canvas(target, overwrite) as figure:
        figure.set_size_inches(6.4, 1.6 + _ROW * len(verdicts))
        capacities(figure.add_subplot(), verdicts, in_g)


def capacities(axes: Axes, verdicts: Sequence[Verdict], in_g: bool) -> None:
    """The bars: what a body takes before it falls, its uplift, the demand, and in words what becomes of it."""
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
            textcoords="offset points", va="center", fontsize=8,
        )  # fmt: skip
    axes.set_yticks(range(len(verdicts)), [v.name for v in verdicts])
    axes.invert_yaxis()
    axes.set(xlim=(0.0, most), xlabel=f"a_g [{'g' if in_g else 'm/s²'}]: bar to first overturning, dots uplift, line demand")
    axes.set_title(f"capacity over demand: {', '.join(dict.fromkeys(v.motion for v in verdicts))}")
    axes.grid(axis="y", visible=False)
