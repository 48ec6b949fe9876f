"""Tables drawn as lines: comparisons, families, closed-form curves, accuracy."""

import math
from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np

from ...errors import UsageError
from ..rows import Rows, column, groups
from ..units import HEADING, Units
from .canvas import (
    MARKERS,
    Axes,
    Figure,
    column_in,
    heading,
    label,
    legend,
    line_style,
    literal,
    series,
    valued,
)

VARIED = "varied_"  # begins the columns of the varied values of check and envelope
_X = "over"  # a column for the abscissa of a family


def comparison(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the ground acceleration if the rows have it, theta over t, and theta/alpha
    over p t (Figs. 8b to 8d).
    """
    shown = [("t", "theta"), ("tau", "theta_ratio")]
    shown[:0] = (
        [("t", "ground_acceleration")] if "ground_acceleration" in rows[0] else []
    )
    figure.set_size_inches(4.0 * len(shown), 3.6)
    axes = list(figure.subplots(1, len(shown)))
    for one, (x, y) in zip(axes, shown, strict=True):
        for i, (some, style) in enumerate(series(rows, "structure", "model")):
            one.plot(
                column_in(some, x, units),
                column_in(some, y, units),
                lw=2.4 - 0.5 * min(i, 3),
                **style,
            )
        one.set(xlabel=label(x, units), ylabel=label(y, units))
    if len(shown) == 3:  # the ground moves for the first part of the response only
        axes[0].set_xlim(
            0.0,
            1.1
            * max(float(row["t"]) for row in rows if float(row["ground_acceleration"])),
        )
    axes[len(axes) // 2].set_title(heading(rows, units, "structure", "motion", "model"))
    legend(axes[-1])
    return axes


def accuracy(figure: Figure, rows: Rows, _: Units) -> list[Axes]:
    """Draw the largest error over run time, one line for each method."""
    axes = figure.add_subplot()
    for marker, (some, style) in zip(
        cycle(MARKERS), series(rows, "method"), strict=False
    ):
        axes.plot(
            1e6 * column(some, "time_per_cell"),
            np.maximum(column(some, "largest_difference"), 1e-17),
            marker=marker,
            **style,
        )
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="run time a cell [µs]",
        ylabel=r"largest error of $\theta/\alpha$ [-]",
    )
    legend(axes)
    return [axes]


def closed_forms(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the closed-form curves A(Omega), one line for each."""
    axes = figure.add_subplot()
    for some, style in series(rows, "structure", "curve"):
        axes.plot(
            column_in(some, "Omega", units),
            column_in(some, "A", units),
            **{**style, "label": style["label"].replace("_", " ")},
        )
    axes.set(
        xlabel=label("Omega", units),
        ylabel=label("A", units),
        title=heading(rows, units, "structure", "motion", "model"),
    )
    legend(axes)
    return [axes]


def family(
    figure: Figure, rows: Rows, units: Units, over: str | None = None
) -> list[Axes]:
    """Draw p, alpha, eta, lambda (and a_scale) over the first varied key, or over
    `KEY/KEY`, for each value of the others (Figs. 4, 6).

    Lines have a gap where the hinges change their places, and where members have no
    solution. Raises UsageError.
    """
    head = list(rows[0])
    varied = head[: head.index("name")] if "name" in head else []
    if not varied:
        raise UsageError(
            "a family is drawn over the keys that were varied; this CSV has no column"
            " of a varied key"
        )
    xlabel, others = _abscissa(rows, varied, over)
    keys = ["p", "alpha", "eta", "lambda"]
    if np.any(column(rows, "a_scale") != 1.0):
        keys.append("a_scale")
    figure.set_size_inches(10.5 if len(keys) > 4 else 7.2, 5.2)
    panels = list(figure.subplots(2, (len(keys) + 1) // 2, sharex=True).ravel())
    figure.suptitle(literal(_common_name(rows, varied[0])), fontsize="medium")
    for axes, key in zip(panels, keys, strict=False):
        _plot_members(axes, rows, key, others, units)
    for axes in panels[len(keys) // 2 : len(keys)]:  # the lowest ones with lines
        axes.set_xlabel(xlabel)
        axes.tick_params(labelbottom=True)
    for spare in panels[len(keys) :]:
        spare.axis("off")
        if others:
            spare.legend(handles=panels[0].get_lines(), loc="center")
    if len(keys) == len(panels):
        legend(panels[0])
    return panels[: len(keys)]


def _common_name(rows: Rows, varied: str, column: str = "name") -> str:
    """Return the name of the structure whose members these are, empty for several
    structures; varied: the heading of the first varied key, with which the name of a
    member goes on.
    """
    key = varied.partition(" [")[0]
    names = {row[column].partition(f" {key}=")[0] for row in rows}
    return names.pop() if len(names) == 1 else ""


def _plot_members(
    axes: Axes, rows: Rows, key: str, others: Sequence[str], units: Units
) -> None:
    """Draw one parameter, a line for each combination of the other varied keys."""
    for i, (group, some) in enumerate(groups(rows, *others).items()):
        words = [_valued(k, v) for k, v in zip(others, group, strict=True)]
        points = _broken(some, column_in(some, key, units))
        axes.plot(*points, label=", ".join(words) or "_", **line_style(i))
    axes.set_ylabel(label(key, units))


def least_amplitudes(
    figure: Figure, rows: Rows, units: Units, over: str | None = None
) -> list[Axes]:
    """Draw the least amplitude that overturns over the first varied key, or over
    `KEY/KEY`: the CSV of check or envelope with `vary`.

    One line for each motion or frequency and value of the other keys, with gaps where
    nothing overturns. Raises UsageError.
    """
    y = next(
        key for key in ("first_overturning_a", "a_from", "A_from") if key in rows[0]
    )
    varied = [key for key in rows[0] if key.startswith(VARIED)]
    xlabel, others = _abscissa(rows, varied, over)
    frequency = _with_equal_frequencies(rows)
    axes = figure.add_subplot()
    places = [
        key
        for key in ("motion", "record", frequency, "model")
        if len(groups(rows, key)) > 1
    ]
    demands: set[float] = set()  # that have a line
    for i, (group, some) in enumerate(groups(rows, *others, *places).items()):
        words = [
            valued(key, float(text), units)
            if key == frequency
            else _valued(key, text)
            if key in others
            else text
            for key, text in zip([*others, *places], group, strict=True)
        ]
        least = [_first(lines, y) for lines in groups(some, _X).values()]
        axes.plot(
            *_broken(least, column_in(least, y, units)),
            label=", ".join(words) or "first overturning",
            **line_style(i),
        )
        if "demand_a" in rows[0]:
            _plot_demand(axes, float(column_in(some, "demand_a", units)[0]), demands)
    words = [
        literal(_common_name(rows, varied[0].removeprefix(VARIED), "structure")),
        heading(rows, units, "motion", "record", "model"),
    ]
    axes.set_title("\n".join(filter(None, words)))
    axes.set(xlabel=xlabel, ylabel=label(y, units))
    axes.set_ylim(bottom=0.0)
    legend(axes)
    return [axes]


def _with_equal_frequencies(rows: Rows) -> str:
    """Return the column of frequencies, empty without one. Its last digits, which
    differ between structures, are rounded away in the rows.
    """
    names = ("omega_g", "Omega")
    name = next((key for key in names if rows[0].get(key) is not None), "")
    for row in rows if name else ():
        row[name] = f"{float(row[name]):.9g}"
    return name


def _first(rows: Rows, y: str) -> dict[str, Any]:
    """Return the row with the least number in a column; without a number last."""
    return min(rows, key=lambda row: math.inf if row[y] is None else float(row[y]))


def _plot_demand(axes: Axes, demand: float, drawn: set[float]) -> None:
    """Draw a demand across the axes, once; drawn: those that have a line."""
    demand = round(demand, 9)
    if demand in drawn:
        return
    axes.axhline(demand, color="0.4", lw=1.0, ls="--", label="_" if drawn else "demand")
    drawn.add(demand)


def _abscissa(rows: Rows, varied: list[str], over: str | None) -> tuple[str, list[str]]:
    """Add the column _X of the abscissa to the rows; return its label and the other
    columns. Raises UsageError.
    """
    names = {
        heading.partition(" [")[0].removeprefix(VARIED): heading for heading in varied
    }
    keys = next(iter(names)).split("/") if over is None else over.split("/")
    if len(keys) > 2 or any(key not in names for key in keys):
        more = (
            "; a key of one value is varied too, as in height=2:2:1"
            if len(keys) == 2
            else ""
        )
        raise UsageError(
            f"`over`: found {over!r}; expected {', '.join(names)}, or one over another,"
            f" such as KEY/KEY{more}"
        )
    headings = [names[key] for key in keys]
    x, *divisor = (column(rows, heading) for heading in headings)
    text = headings[0].removeprefix(VARIED).replace("_", " ")
    others = [heading for heading in varied if heading not in headings]
    if divisor:
        units = [
            (HEADING.fullmatch(heading) or {"unit": ""})["unit"] for heading in headings
        ]
        if units[0] != units[1]:
            raise UsageError(
                f"`over`: {keys[0]} is in {units[0]} and {keys[1]} in {units[1]};"
                " expected one unit for both"
            )
        x = x / divisor[0]
        text = f"{' / '.join(keys).replace('_', ' ')} [-]"
        others = [headings[1], *others]
    for row, value in zip(rows, x.tolist(), strict=True):
        row[_X] = value
    return text, others


def _broken(some: Rows, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (x, y) of a line, with NaN where the mechanism changes or a member is
    missing.
    """
    x = column(some, _X)
    order = np.argsort(x)
    x, y = x[order], y[order]
    gaps = np.zeros(max(0, x.size - 1), dtype=bool)
    hinges = [
        key for key in some[0] if key.startswith("hinges_") and key.endswith("_angle")
    ]
    if hinges and x.size > 1:
        steps = np.max(
            np.abs(
                np.diff(np.array([column(some, key)[order] for key in hinges]), axis=1)
            ),
            axis=0,
        )
        # rad; below it is the same hinge
        gaps |= (steps > 0.02) & (steps > 4.0 * np.nanmedian(steps))
    if x.size > 2:
        widths = np.diff(x)
        gaps |= widths > 1.5 * np.median(widths)
    at = np.flatnonzero(gaps) + 1
    return np.insert(x, at, np.nan), np.insert(y, at, np.nan)


def _valued(heading: str, value: str) -> str:
    """Return a heading and a value as text: `height = 8 m`."""
    key, _, unit = heading.partition(" [")
    return (
        f"{key.removeprefix(VARIED).replace('_', ' ')} = {float(value):.4g}"
        f" {unit.removesuffix(']')}".rstrip()
    )
