"""Overturning envelopes: intervals of amplitude over frequency, size or record, one
panel for each structure.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from ...dynamics.outcome import Outcome
from ..rows import Rows, groups
from ..units import Units
from .canvas import (
    Axes,
    Figure,
    column_in,
    heading,
    label,
    legend,
    literal,
    panels,
    valued,
)

_MODES = {o.mode: o for o in Outcome}
# each combination of their values has its panel
_APART = (
    "structure",
    "record",
    "alpha",
    "sign",
    "model",
)
# of bars; the intervals of neighbouring sizes and records are unrelated
_WIDTHS = {
    "T": 2.5,
    "record": 6.0,
}
Interval = tuple[float, float, float]  # frequency, lower and upper amplitude


def bands(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw overturning amplitudes over frequency, where overlapping intervals are
    joined, over T = 2 pi/p, or of each record.
    """
    over = next(
        key
        for key in ("omega_g", "Omega", "T", "record")
        if all(row.get(key) for row in rows)
    )
    amplitude = "a" if over in ("omega_g", "record") else "A"
    found = groups(rows, *(key for key in _APART if key != over))
    records = (
        list(dict.fromkeys(row["record"] for row in rows)) if over == "record" else []
    )
    drawn = panels(figure, len(found))
    for axes, some in zip(drawn, found.values(), strict=True):
        x = (
            np.array([float(records.index(row["record"])) for row in some])
            if records
            else column_in(some, over, units)
        )
        places = sorted(set(x.tolist()))
        _draw(
            axes,
            some,
            (f"{amplitude}_from", f"{amplitude}_to"),
            x,
            units,
            [] if over in _WIDTHS else places,
            _WIDTHS.get(over, 1.0),
        )
        if records:
            axes.set_xticks(
                range(len(records)),
                [literal(record) for record in records],
                rotation=45.0,
                ha="right",
            )
            axes.set(xlim=(-0.5, len(records) - 0.5))
        else:
            margin = 0.02 * (places[-1] - places[0]) or 0.5
            axes.set(
                xlim=(places[0] - margin, places[-1] + margin),
                xlabel=label(over, units),
            )
        names = [
            (key, some[0][key])
            for key in _APART[:-1]
            if key != over and some[0].get(key)
        ]
        title = ", ".join(
            valued(key, float(text), units) if key == "alpha" else literal(text)
            for key, text in names
        )
        title = "\n".join(filter(None, (title, heading(some, "motion", "model"))))
        axes.set(ylabel=label("a_g" if amplitude == "a" else "A", units), title=title)
    return drawn


def _draw(
    axes: Axes,
    some: Rows,
    ends: tuple[str, str],
    x: np.ndarray,
    units: Units,
    frequencies: list[float],
    width: float,
) -> None:
    """Draw the intervals at each x, joined between `frequencies`; only their lower ends
    if the rows have no upper end.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    low = column_in(some, ends[0], units)
    high = column_in(some, ends[1], units) if ends[1] in some[0] else low
    top = 1.1 * float(np.nanmax(np.concatenate([low, high, [0.0]]))) or 1.0
    entries: list[Any] = []
    for mode in dict.fromkeys(row["mode"] for row in some):
        outcome = _MODES.get(mode)
        if outcome is None:  # mode "none"
            continue
        mine = np.array([row["mode"] == mode for row in some]) & ~np.isnan(low)
        upto = np.where(np.isnan(high), top, high)
        intervals = [
            (float(a), float(b), float(c))
            for a, b, c in zip(x[mine], low[mine], upto[mine], strict=True)
        ]
        axes.add_collection(
            PolyCollection(
                list(_joined(intervals, frequencies)),
                facecolors=outcome.colour,
                edgecolors="none",
            )
        )
        axes.vlines(*np.array(intervals).T, color=outcome.colour, lw=width)
        if ends[1] not in some[0]:
            axes.plot(x[mine], low[mine], "o", color=outcome.colour, ms=4.0)
        entries.append(Patch(facecolor=outcome.colour, label=outcome.sentence))
    axes.set_ylim(0.0, top)
    if entries:
        legend(axes, entries)


def _joined(
    intervals: list[Interval], frequencies: list[float]
) -> Iterator[list[tuple[float, float]]]:
    """Yield the quadrilaterals between overlapping intervals at neighbouring
    frequencies.
    """
    at: dict[float, list[tuple[float, float]]] = {x: [] for x in frequencies}
    for x, low, high in intervals if frequencies else ():
        at[x].append((low, high))
    for left, right in pairwise(frequencies):
        for low, high in at[left]:
            for under, over in at[right]:
                if low < over and under < high:
                    yield [(left, low), (right, under), (right, over), (left, high)]
