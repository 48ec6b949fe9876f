"""Overturning envelopes: intervals of amplitude over frequency, one panel for each structure; and the closed-form curves."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ...dynamics.outcome import Outcome
from ..rows import Rows, column, groups
from ..units import Units
from .canvas import legend, literal, look, panels
from .labels import label, valued

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MODES = {o.mode: o for o in Outcome}
_APART = ("structure", "record", "alpha", "sign", "model")  # each combination of their values has its panel
_MOST = 24  # panels
Interval = tuple[float, float, float]  # frequency, lower and upper amplitude


def bands(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw overturning amplitudes over frequency (of records: over T = 2 pi/p), one panel for each structure and record.

    Intervals of neighbouring frequencies that overlap are joined; intervals of records are bars. Raises ValueError for too many panels.
    """
    dimensional = all(row.get("omega_g") for row in rows)
    over = "omega_g" if dimensional else "Omega" if "Omega" in rows[0] else "T"
    low, high = ("a_from", "a_to") if dimensional else ("A_from", "A_to")
    found = groups(rows, *_APART)
    drawn = _panels(figure, len(found))
    for axes, (key, some) in zip(drawn, found.items(), strict=True):
        x = column(some, over) / units.column(over)[2]
        frequencies = sorted(set(x.tolist()))
        bars = over == "T"  # under a record the intervals of neighbouring sizes are unrelated
        _draw(axes, some, (low, high), x, units, [] if bars else frequencies, 2.5 if bars else 1.0)
        margin = 0.02 * (frequencies[-1] - frequencies[0]) or 0.5
        axes.set(xlim=(frequencies[0] - margin, frequencies[-1] + margin))
        axes.set(xlabel=label(over, units), ylabel=label("a_g" if dimensional else "A", units), title=_title(some[0], key, units))
    return drawn


def record_bars(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the overturning amplitudes of records, a bar for each, one panel for each structure."""
    records = list(dict.fromkeys(row["record"] for row in rows))
    found = groups(rows, *(name for name in _APART if name != "record"))
    drawn = _panels(figure, len(found))
    for axes, (key, some) in zip(drawn, found.items(), strict=True):
        x = np.array([float(records.index(row["record"])) for row in some])
        _draw(axes, some, ("a_from", "a_to"), x, units, [], width=6.0)
        axes.set_xticks(range(len(records)), [literal(record) for record in records], rotation=45.0, ha="right")
        axes.set(xlim=(-0.5, len(records) - 0.5), ylabel=label("a_g", units), title=_title(some[0], key, units))
    return drawn


def _panels(figure: Figure, count: int) -> list[Axes]:
    if count > _MOST:
        raise ValueError(f"found {count} panels; expected up to {_MOST}")
    return panels(figure, count)


def _title(row: dict[str, str], key: tuple[str, ...], units: Units) -> str:
    names = [name for name in _APART if name in row]
    known = [(name, text) for name, text in zip(names, key, strict=False) if text]
    return ", ".join(valued(name, float(text), units) if name == "alpha" else literal(text) for name, text in known)


def _draw(axes: Axes, some: Rows, ends: tuple[str, str], x: np.ndarray, units: Units, frequencies: list[float], width: float = 1.0) -> None:
    """Draw the intervals at each x, joined between neighbouring `frequencies`; only their lower ends if the rows have no upper end."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    factor = units.column(ends[0])[2]
    low = column(some, ends[0]) / factor
    high = column(some, ends[1]) / factor if ends[1] in some[0] else low
    top = 1.1 * float(np.nanmax(np.concatenate([low, high, [0.0]]))) or 1.0
    entries: list[Any] = []
    for mode in dict.fromkeys(row["mode"] for row in some):
        outcome = _MODES.get(mode)
        if outcome is None:  # mode "none"
            continue
        mine = np.array([row["mode"] == mode for row in some]) & ~np.isnan(low)
        upto = np.where(np.isnan(high), top, high)
        intervals = [(float(a), float(b), float(c)) for a, b, c in zip(x[mine], low[mine], upto[mine], strict=True)]
        axes.add_collection(PolyCollection(list(_joined(intervals, frequencies)), facecolors=outcome.colour, edgecolors="none"))
        axes.vlines(*np.array(intervals).T, color=outcome.colour, lw=width)
        if ends[1] not in some[0]:
            axes.plot(x[mine], low[mine], "o", color=outcome.colour, ms=4.0)
        entries.append(Patch(facecolor=outcome.colour, label=outcome.sentence))
    axes.set_ylim(0.0, top)
    if entries:
        legend(axes, entries)


def _joined(intervals: list[Interval], frequencies: list[float]) -> Iterator[list[tuple[float, float]]]:
    """The quadrilaterals between overlapping intervals at neighbouring frequencies."""
    at: dict[float, list[tuple[float, float]]] = {x: [] for x in frequencies}
    for x, low, high in intervals if frequencies else ():
        at[x].append((low, high))
    for left, right in pairwise(frequencies):
        for low, high in at[left]:
            for under, over in at[right]:
                if low < over and under < high:
                    yield [(left, low), (right, under), (right, over), (left, high)]


def curves(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the closed-form curves A(Omega), one line for each."""
    axes = figure.add_subplot()
    for i, (key, some) in enumerate(groups(rows, "structure", "curve").items()):
        axes.plot(column(some, "Omega"), column(some, "A"), label=literal(" ".join(key).replace("_", " ")), **look(i))
    axes.set(xlabel=label("Omega", units), ylabel=label("A", units))
    legend(axes)
    return [axes]
