"""Overturning envelopes: intervals of amplitude over frequency, size or record, one
panel for each structure.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise, permutations
from typing import TYPE_CHECKING, Any

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

if TYPE_CHECKING:
    from matplotlib.patches import Patch

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
# of amplitudes above all that the rows name, up to which all are searched
_UNKNOWN: dict[str, Any] = {"facecolor": "white", "edgecolor": "0.8", "hatch": "///"}
Bar = tuple[float, float, float]  # frequency, lower and upper amplitude


def bands(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw overturning amplitudes over frequency, where overlapping intervals are
    joined, over T = 2 pi/p, or of each record.
    """
    from matplotlib.patches import Patch

    over = next(
        key
        for key in ("omega_g", "Omega", "T", "record")
        if all(row.get(key) is not None for row in rows)
    )
    amplitude = "a" if over in ("omega_g", "record") else "A"
    apart = [key for key in _APART if key != over]
    found = groups(rows, *apart)
    records = list(dict.fromkeys(row[over] for row in rows if over == "record"))
    drawn = panels(figure, len(found))
    most = _reach(found.values(), over, units) if amplitude == "a" else None
    entries: dict[Outcome, Patch] = {}
    hatched = False
    for axes, some in zip(drawn, found.values(), strict=True):
        x = _abscissa(axes, some, over, records, units)
        axes.set_title(_title(some, apart, units))
        own, searched = _draw(axes, some, amplitude, x, over, units)
        _stop_at(axes, most, units)
        entries |= own
        hatched = hatched or 0.0 < searched < float(axes.get_ylim()[1])
        axes.set_ylabel(label("a_g" if amplitude == "a" else "A", units))
    # without upper ends nothing is known above the lower ones
    word = "stands" if f"{amplitude}_to" in rows[0] else "stands below the first fall"
    white = [Patch(facecolor="white", edgecolor="0.5", label=word)]
    unknown = [Patch(label="not searched", **_UNKNOWN)] * hatched
    legend(drawn[0], [*entries.values(), *white, *unknown])
    return drawn


def _abscissa(
    axes: Axes, some: Rows, over: str, records: list[str], units: Units
) -> np.ndarray:
    """Give the axes their abscissa, and return the place of each row on it."""
    if records:
        names = list(map(literal, records))
        axes.set_xticks(range(len(names)), names, rotation=45.0, ha="right")
        axes.set_xlim(-0.5, len(names) - 0.5)
        return np.array([float(records.index(row["record"])) for row in some])
    x = column_in(some, over, units)
    first, last = float(x.min()), float(x.max())
    # beyond the ends nothing is known
    margin = (0.02 * (last - first) or 0.5) * (over in _WIDTHS or first == last)
    axes.set(xlim=(first - margin, last + margin), xlabel=label(over, units))
    return x


def _title(some: Rows, apart: list[str], units: Units) -> str:
    """Return the title of a panel; apart: the columns that its rows share."""
    names = [
        valued(key, float(some[0][key]), units)
        if key == "alpha"
        else literal(some[0][key])
        for key in apart
        if key != "model" and some[0].get(key)
    ]
    under = heading(some, units, "motion", "model")
    return "\n".join(filter(None, (", ".join(names), under)))


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
    if most is None or top <= _MARGIN * most:
        return
    axes.set_ylim(0.0, most)
    reach = f"intervals up to {top / _MARGIN:.3g} {units.of('acceleration')[0]}"
    axes.set_title(f"{axes.get_title()}\n{reach}")


def _draw(
    axes: Axes, some: Rows, amplitude: str, x: np.ndarray, over: str, units: Units
) -> tuple[dict[Outcome, Patch], float]:
    """Draw the intervals at each x, joined between neighbouring frequencies; only their
    lower ends if the rows have no upper end. Return legend entries by outcome, and the
    amplitude up to which all are known to be searched.
    """
    from matplotlib.patches import Patch

    low = column_in(some, f"{amplitude}_from", units)
    ended = f"{amplitude}_to" in some[0]
    high = column_in(some, f"{amplitude}_to", units) if ended else low
    searched = float(np.nanmax(np.concatenate([low, high, [0.0]])))
    top = _MARGIN * searched or 1.0
    if searched:
        axes.axhspan(searched, top, lw=0.0, zorder=0.0, **_UNKNOWN)
    axes.set_ylim(0.0, top)
    high = np.where(np.isnan(high), top, high)
    bars: dict[Outcome, list[Bar]] = {}
    for row, *bar in zip(some, x.tolist(), low.tolist(), high.tolist(), strict=True):
        outcome = _MODES.get(row["mode"])
        if outcome is not None:  # not of mode "none"
            bars.setdefault(outcome, []).append((bar[0], bar[1], bar[2]))
    frequencies = [] if over in _WIDTHS else sorted(set(x.tolist()))
    if frequencies and bars:
        _plot_changes(axes, bars, frequencies, top)
    for outcome, own in bars.items():
        colour = COLOURS[outcome]
        _plot_bars(axes, own, frequencies, colour, _WIDTHS.get(over, 1.0))
        if not ended:
            places, ends, _ = zip(*own, strict=True)
            axes.plot(places, ends, "o", color=colour, ms=4.0)
    entries = {o: Patch(facecolor=COLOURS[o], label=o.sentence) for o in bars}
    return entries, searched


def _plot_changes(
    axes: Axes, bars: dict[Outcome, list[Bar]], frequencies: list[float], top: float
) -> None:
    """Fill what lies between an interval of one mode and one of another at the next
    frequency, and between an interval without an end and a frequency at which nothing
    falls up to `top`.
    """
    from matplotlib.collections import PolyCollection

    falls: dict[float, list[tuple[float, float, str]]] = {x: [] for x in frequencies}
    for (x, low, high), outcome in sorted(
        (bar, outcome) for outcome, own in bars.items() for bar in own
    ):
        if falls[x] and low <= falls[x][-1][1]:  # the body falls on, by another mode
            low, before, colour = falls[x].pop()
            falls[x].append((low, max(before, high), colour))
        else:
            falls[x].append((low, high, COLOURS[outcome]))
    areas, colours = [], []
    for pair in pairwise(frequencies):
        for (x, own), (other, beside) in permutations((x, falls[x]) for x in pair):
            for low, high, colour in own:
                ends = [(u, o) for u, o, _ in beside if low < o and u < high]
                for under, over in ends or [(top, top)] * (high >= top):
                    areas.append([(x, low), (other, under), (other, over), (x, high)])
                    colours.append(colour)
    axes.add_collection(PolyCollection(areas, facecolors=colours, linewidths=0.0))


def _plot_bars(
    axes: Axes, bars: list[Bar], frequencies: list[float], colour: str, width: float
) -> None:
    """Draw intervals, joined between frequencies; one alone as a line of this width."""
    from matplotlib.collections import PolyCollection

    areas = list(_joined(bars, frequencies))
    joined = {x for area in areas for x, _ in area}
    style: dict[str, Any] = {"facecolors": colour, "edgecolors": colour}
    # the edges leave no seam between neighbours
    axes.add_collection(PolyCollection(areas, linewidths=0.3, **style))
    alone = [one for one in bars if one[0] not in joined]
    if alone:  # a line at a place that is joined would end beyond the corner
        axes.vlines(*np.array(alone).T, color=colour, lw=width)


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
