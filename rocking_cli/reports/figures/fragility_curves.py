"""Fragility curves over an intensity measure, and overturning spectra."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...documents.quantities import headed
from ..rows import Rows, column, groups
from ..units import Units, dimension_of
from .canvas import MARKERS, legend, literal, look
from .labels import PLAIN

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LABELS = {
    "Arias": "Arias intensity [m/s]", "CAV": "CAV [m/s]",
    "nPGA": r"PGA/$(\lambda g)$ [-]", "nPGV": r"$p$ PGV/$(g \tan\alpha)$ [-]", "nPGD": r"$p^2$ PGD/$(g \tan\alpha)$ [-]",
}  # fmt: skip


def fragility_curves(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw a fragility curve with its confidence band and the observed fractions for each structure, limit state and method.

    A method without a fitted curve is drawn as steps of its fractions.
    """
    axes = figure.add_subplot()
    im = rows[0]["im"]
    dimension = dimension_of(im.lower())
    unit, factor = ("", 1.0) if dimension is None else units.of(dimension)
    for i, (group, some) in enumerate(groups(rows, "structure", "limit_state", "method").items()):
        x, p = column(some, "x") / factor, column(some, "probability")
        style: dict[str, Any] = {**look(i), "label": literal(", ".join(group))}
        if np.all(np.isnan(p)):
            axes.step(np.append(0.0, x), np.append(0.0, column(some, "fraction")), where="post", lw=1.0, **style)
            continue
        axes.plot(x, p, **style)
        axes.fill_between(x, column(some, "low"), column(some, "high"), color=style["color"], alpha=0.15, lw=0.0)
        axes.plot(x, column(some, "fraction"), ls="", marker=MARKERS[i % len(MARKERS)], ms=4.0, color=style["color"])
    axes.set(xlabel=LABELS.get(im) or headed(im, PLAIN.get(unit, unit)), ylabel="probability [-]", ylim=(0.0, 1.0))
    axes.set_xlim(left=0.0)
    legend(axes)
    return [axes]


def overturning_spectra(figure: Figure, rows: Rows, _: Units) -> list[Axes]:
    """Draw the first overturning PGA over p: the median of the records as a line, 16 to 84 % as a band, for each critical angle."""
    axes = figure.add_subplot()
    for i, (group, some) in enumerate(groups(rows, "alpha").items()):
        p = column(some, "p")
        low, middle, high = (column(some, f"pga_ratio_{q}") for q in (16, 50, 84))
        style = look(i) if group else {**look(i), "ls": "", "marker": MARKERS[i % len(MARKERS)]}
        axes.plot(p, middle, label=rf"$\alpha$ = {np.degrees(float(group[0])):.3g}°" if group else None, **style)
        axes.fill_between(p, low, high, color=style["color"], alpha=0.2, lw=0.0)
    axes.set(xlabel=r"$p$ [rad/s]", ylabel=r"first overturning PGA/$(\lambda g)$ [-]")
    legend(axes)
    return [axes]
