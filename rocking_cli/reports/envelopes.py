"""Overturning envelopes: bands of amplitude over frequency, a panel a structure; and the closed-form curves."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ..dynamics.outcome import Outcome
from .canvas import legend, literal, look, panels
from .labels import label
from .rows import Rows, column, groups
from .units import Units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MODES = {o.mode: o for o in Outcome}
_APART = ("structure", "record", "sign")  # columns whose values have a panel each
Band = tuple[float, float, float]  # frequency, from, to


def bands(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Intervals of neighbouring frequencies that overlap are joined; in g and Hz (or the units asked for) where there are any."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    dimensional = all("a_from" in row and row.get("omega_g") for row in rows)
    names = ("omega_g", "a_from", "a_to") if dimensional else ("Omega", "A_from", "A_to")
    found = groups(rows, *_APART)
    drawn = panels(figure, len(found))
    for axes, (key, some) in zip(drawn, found.items(), strict=True):
        x, low, high = (column(some, name) / units.column(name)[2] for name in names)
        top = 1.1 * float(np.nanmax(np.concatenate([low, high, [0.0]]))) or 1.0
        modes = [row["mode"] for row in some]
        frequencies = sorted(set(x.tolist()))
        entries: list[Any] = []
        for mode in dict.fromkeys(modes):
            outcome = _MODES.get(mode)
            if outcome is None:  # a frequency that never overturns
                continue
            mine = np.array([m == mode for m in modes]) & ~np.isnan(low)
            ends = np.where(np.isnan(high), top, high)
            intervals = [(float(a), float(b), float(c)) for a, b, c in zip(x[mine], low[mine], ends[mine], strict=True)]
            axes.add_collection(PolyCollection(list(_joined(intervals, frequencies)), facecolors=outcome.colour, edgecolors="none"))
            axes.vlines(*np.array(intervals).T, color=outcome.colour, lw=1.0)
            entries.append(Patch(facecolor=outcome.colour, label=outcome.sentence))
        margin = 0.02 * (frequencies[-1] - frequencies[0]) or 0.5
        axes.set(xlim=(frequencies[0] - margin, frequencies[-1] + margin), ylim=(0.0, top))
        axes.set(xlabel=label(names[0], units), ylabel=label("a_g" if dimensional else "A", units))
        axes.set_title(literal(", ".join(filter(None, key))))
        if entries:
            legend(axes, entries)
    return drawn


def _joined(intervals: list[Band], frequencies: list[float]) -> Iterator[list[tuple[float, float]]]:
    """The quadrilaterals between intervals at neighbouring frequencies that overlap."""
    at: dict[float, list[tuple[float, float]]] = {x: [] for x in frequencies}
    for x, low, high in intervals:
        at[x].append((low, high))
    for left, right in pairwise(frequencies):
        for low, high in at[left]:
            for under, over in at[right]:
                if low < over and under < high:
                    yield [(left, low), (right, under), (right, over), (left, high)]


def curves(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """The closed-form curves, a line each."""
    axes = figure.add_subplot()
    for i, (key, some) in enumerate(groups(rows, "structure", "curve").items()):
        axes.plot(column(some, "Omega"), column(some, "A"), label=literal(" ".join(key).replace("_", " ")), **look(i))
    axes.set(xlabel=label("Omega", units), ylabel=label("A", units))
    legend(axes)
    return [axes]
