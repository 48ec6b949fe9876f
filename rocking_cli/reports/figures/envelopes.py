"""Overturning envelopes: intervals of amplitude over frequency, size or record, one
panel for each structure.
"""

from collections.abc import Iterable, Iterator
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
from .colours import COLOURS

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
_MARGIN = 1.1  # of the axis of amplitudes over the largest one
Bar = tuple[float, float, float]  # frequency, lower and upper amplitude


def bands(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw overturning amplitudes over frequency, where overlapping intervals are
    joined, over T = 2 pi/p, or of each record.
    """
    over = next(
        key
        for key in ("omega_g", "Omega", "T", "record")
        if all(row.get(key) is not None for row in rows)
    )
    amplitude = "a" if over in ("omega_g", "record") else "A"
    found = groups(rows, *(key for key in _APART if key != over))
    records = (
        list(dict.fromkeys(row["record"] for row in rows)) if over == "record" else []
    )
    drawn = panels(figure, len(found))
    most = _reach(found.values(), over, units) if amplitude == "a" else None
    entries: dict[str, Any] = {}
    for axes, some in zip(drawn, found.values(), strict=True):
        x = (
            np.array([float(records.index(row["record"])) for row in some])
            if records
            else column_in(some, over, units)
        )
        places = sorted(set(x.tolist()))
        entries |= _draw(
            axes,
            some,
            (f"{amplitude}_from", f"{amplitude}_to"),
            x,
            units,
            [] if over in _WIDTHS else places,
            _WIDTHS.get(over, 1.0),
        )
        _stop_at(axes, most, units)
        if records:
            axes.set_xticks(
                range(len(records)),
                [literal(record) for record in records],
                rotation=45.0,
                ha="right",
            )
            axes.set(xlim=(-0.5, len(records) - 0.5))
        else:
            # beyond the ends nothing is known
            bars = over in _WIDTHS or len(places) < 2
            margin = (0.02 * (places[-1] - places[0]) or 0.5) * bars
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
        title = "\n".join(
            filter(None, (title, heading(some, units, "motion", "model")))
        )
        axes.set(ylabel=label("a_g" if amplitude == "a" else "A", units), title=title)
    from matplotlib.patches import Patch

    stands = Patch(facecolor="white", edgecolor="0.5", label="stands")
    legend(drawn[0], [*entries.values(), stands])
    return drawn


def _reach(found: Iterable[Rows], over: str, units: Units) -> float | None:
    """Return the largest amplitude of the axes in their unit: twice that of the uplift
    at A = 1, and above the first fall of half of the places. None without an
    overturning.
    """
    reach = []
    for some in found:
        low, A = column_in(some, "a_from", units), column_in(some, "A_from", units)
        if np.all(np.isnan(low)):
            continue
        reach.append(2.0 * float(np.nanmax(low / A)))
        # of records each stands alone
        at = column_in(some, over, units) if over != "record" else None
        least = (
            [np.nanmax(low)]
            if at is None
            else [np.nanmin(low[at == x]) for x in np.unique(at[~np.isnan(low)])]
        )
        reach.append(1.3 * float(np.median(least)))
    return max(reach, default=None)


def _stop_at(axes: Axes, most: float | None, units: Units) -> None:
    """Let the axis of amplitudes end at `most`, and say how far the rows go."""
    top = axes.get_ylim()[1]
    if most is None or top <= most:
        return
    axes.set_ylim(0.0, most)
    axes.annotate(
        f"intervals up to {top / _MARGIN:.3g} {units.of('acceleration')[0]}",
        (1.0, 1.0),
        xycoords="axes fraction",
        xytext=(0, 3),
        textcoords="offset points",
        ha="right",
        fontsize="x-small",
    )


def _draw(
    axes: Axes,
    some: Rows,
    ends: tuple[str, str],
    x: np.ndarray,
    units: Units,
    frequencies: list[float],
    width: float,
) -> dict[str, Any]:
    """Draw the intervals at each x, joined between `frequencies`; only their lower ends
    if the rows have no upper end. Return legend entries by their texts.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    low = column_in(some, ends[0], units)
    high = column_in(some, ends[1], units) if ends[1] in some[0] else low
    top = _MARGIN * float(np.nanmax(np.concatenate([low, high, [0.0]]))) or 1.0
    entries: dict[str, Any] = {}
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
        areas = list(_joined(intervals, frequencies))
        joined = {x for area in areas for x, _ in area}
        axes.add_collection(
            PolyCollection(
                areas,
                facecolors=COLOURS[outcome],
                edgecolors=COLOURS[outcome],
                linewidths=0.3,  # no seam between neighbours
            )
        )
        alone = [one for one in intervals if not frequencies or one[0] not in joined]
        if alone:  # a line at a place that is joined would end beyond the corner
            axes.vlines(*np.array(alone).T, color=COLOURS[outcome], lw=width)
        if ends[1] not in some[0]:
            axes.plot(x[mine], low[mine], "o", color=COLOURS[outcome], ms=4.0)
        words = outcome.sentence
        entries[words] = Patch(facecolor=COLOURS[outcome], label=words)
    axes.set_ylim(0.0, top)
    return entries


def _joined(
    intervals: list[Bar], frequencies: list[float]
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
