"""Figures of a check by a code: the capacity curve a over d, the secants of its limit states, and the demand spectrum."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from ...documents.quantities import DEFAULT_GRAVITY
from ...responses.code_check import SLC, SLV, CodeCheck
from .canvas import Axes, Look, canvas, literal, panels

_PERIODS = np.geomspace(0.03, 1.0, 200)  # over the longest secant period, of the demand
_FARTHEST = 3.0  # times the capacity, up to which the axes show a demand
_MM = 1000.0


def draw_capacity_curves(
    checks: Sequence[CodeCheck], target: str | Path, *, look: Look | None = None, overwrite: bool = True,
    tell: Callable[[str], None] | None = None,
) -> None:  # fmt: skip
    """Draw each check by a code in a panel of its own, into a PNG, SVG or PDF file.

    overwrite: an existing file may be replaced; tell: called with characters that the font lacks. Raises UsageError for too many panels,
    OutputError if matplotlib is not installed or the figure cannot be written.

    >>> (column,) = load_structures('configs/block.yaml')
    >>> draw_capacity_curves([code_check(column, sine(), parse_grid('a_g=0.3g,T_g=0.4'))], 'curve.svg')
    """
    with canvas(target, overwrite, look=look, tell=tell) as figure:
        for axes, check in zip(panels(figure, len(checks)), checks, strict=True):
            _panel(axes, check)
        width, height = figure.get_size_inches()
        figure.set_size_inches(1.4 * width, height)  # for the legends


def _panel(axes: Axes, check: CodeCheck) -> None:
    """One check: d in mm, a in g; a cross marks the demand at each limit state."""
    d, a = _MM * check.curve.displacement, check.curve.multiplier * check.factor / DEFAULT_GRAVITY
    axes.plot(d, a, color="k", lw=1.8, label="capacity")
    asked = [(_MM * at.demand, (2.0 * np.pi / at.period) ** 2 * at.demand / DEFAULT_GRAVITY) for at in (check.slv, check.slc)]
    right, top = (
        1.1 * max(own.max(), *np.minimum(marks, _FARTHEST * own.max())) for own, marks in zip((d, a), zip(*asked, strict=True), strict=True)
    )
    periods = _PERIODS * max(check.slv.period, check.slc.period)
    for i, (name, at, state, mark) in enumerate((("SLV", check.slv, SLV, asked[0]), ("SLC", check.slc, SLC, asked[1]))):
        x, y, colour = _MM * at.displacement, at.acceleration / DEFAULT_GRAVITY, f"C{i}"
        demand = check.spectrum.acceleration(periods, state.damping)
        s_d = _MM * demand * (periods / (2.0 * np.pi)) ** 2
        axes.plot(s_d, demand / DEFAULT_GRAVITY, lw=1.1, alpha=0.7, label=f"demand, {100.0 * state.damping:g} %", color=colour)
        slope = (2.0 * np.pi / at.period) ** 2 / (_MM * DEFAULT_GRAVITY)
        axes.plot([0.0, right], [0.0, right * slope], lw=0.9, ls="--", label=f"$T_{{{name}}}$ = {at.period:.3g} s", color=colour)
        axes.plot(x, y, "o", ms=5, label=f"$d_{{{name}}}$ = {x:.3g} mm", color=colour)
        axes.plot(*mark, "x", ms=6, label=f"demand at {name} {mark[0]:.3g} mm", color=colour)
        axes.plot([x, x], [0.0, y], lw=0.7, ls=":", color=colour)
    axes.set(xlim=(0.0, right), ylim=(0.0, top), xlabel="$d$ [mm]", ylabel="$a$ [g]")
    axes.set_title(literal(f"{check.structure}, {check.demand}: {check.demand_a / DEFAULT_GRAVITY:.3g} g"), fontsize="small")
    axes.legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
