"""Figures of fragility: curves over one measure (with a hazard curve), lines of equal
probability over two, overturning spectra.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...documents.quantities import headed
from ...dynamics.outcome import Outcome
from ..rows import Rows, column, groups
from ..units import Units, dimension_of_measure
from .canvas import (
    MARKERS,
    PLAIN,
    Axes,
    Figure,
    column_in,
    label,
    legend,
    line_style,
    literal,
    panels,
    plain_ticks,
)

MEASURE_LABELS = {
    "Arias": "Arias intensity [m/s]",
    "CAV": "CAV [m/s]",
    "nPGA": r"PGA/$(\lambda g)$ [-]",
    "nPGV": r"$p$ PGV/$(g \tan\alpha)$ [-]",
    "nPGD": r"$p^2$ PGD/$(g \tan\alpha)$ [-]",
}


def fragility_curves(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw a fragility curve with its band and the observed fractions for each
    structure, limit state and method.

    A curve is dashed beyond its last fraction; fractions without a curve are drawn as
    steps. A hazard curve stands on a second axis.
    """
    axes = figure.add_subplot()
    im, keys = rows[0]["im"], ("structure", "limit_state", "method")
    dimension = dimension_of_measure(im)
    unit, factor = ("", 1.0) if dimension is None else units.of(dimension)
    rows = [
        {**row, "limit_state": _limit_in_words(row["limit_state"] or "")}
        for row in rows
    ]
    varied = [key for key in keys if len(groups(rows, key)) > 1]
    lines = list(groups(rows, *keys).values())
    for i, some in enumerate(lines):
        words = [some[0][key] for key in varied]
        if "annual_rate" in some[0]:
            words.append(f"{float(some[0]['annual_rate']):.2g} a year")
        _plot_curve(axes, some, i, factor, literal(", ".join(words)) or None)
    state = "limit state" if "limit_state" in varied else rows[0]["limit_state"]
    common = [
        rows[0][key] for key in keys if key not in varied and key != "limit_state"
    ]
    axes.set(
        xlabel=MEASURE_LABELS.get(im) or headed(im, PLAIN.get(unit, unit)),
        ylabel=f"P({state} | {im})",
        ylim=(0.0, 1.0),
        title=literal(", ".join(common)),
    )
    axes.set_xlim(left=0.0)
    _explain(axes, lines)
    if "hazard" in rows[0]:
        _with_hazard(axes, lines, factor)
    legend(axes)
    return [axes]


def _explain(axes: Axes, lines: Sequence[Rows]) -> None:
    """Add what dashes and bands mean to the legend, if there are any, and which states
    lie below others.
    """
    whole = [row for some in lines for row in some]
    if np.all(np.isnan(column(whole, "probability"))):
        return
    if not np.all(np.isnan(column(whole, "low"))):
        band: dict[str, Any] = {"fc": "0.93", "ec": "0.3", "lw": 0.7, "ls": ":"}
        axes.fill_between([], [], label="95 % band of the fit", **band)
    axes.plot([], [], color="0.3", ls="--", label="beyond the last level")
    axes.plot([], [], color="0.3", ls="", marker="o", ms=4.0, label="observed share")
    for i, some in enumerate(lines):
        for other in lines[:i]:
            texts = [
                [(r["x"], r["probability"]) for r in rows] for rows in (some, other)
            ]
            if texts[0] == texts[1]:
                words = [rows[0]["limit_state"] for rows in (some, other)]
                said = f"{words[0]}: as {words[1]}"
                axes.plot([], [], ls="", label=literal(said))


def _limit_in_words(limit: str) -> str:
    """Return a limit state as the legend names it."""
    return limit if limit.startswith(("overturning", "slide")) else f"θ/α > {limit}"


def _plot_curve(
    axes: Axes, rows: Rows, number: int, factor: float, words: str | None
) -> None:
    """Draw one curve with its band and fractions, or fractions alone as steps; number:
    of the line, factor: of the unit of the measure.
    """
    from matplotlib.colors import to_rgba

    x, p = column(rows, "x") / factor, column(rows, "probability")
    fraction = column(rows, "fraction")
    colour = f"C{number}"
    if np.all(np.isnan(p)):
        axes.step(
            np.append(0.0, x),
            np.append(0.0, fraction),
            where="post",
            lw=1.0,
            color=colour,
            label=words,
        )
        return
    last = float(np.max(x[~np.isnan(fraction)], initial=0.0)) or float(x[-1])
    axes.plot(x[x <= last], p[x <= last], color=colour, label=words)
    axes.plot(x[x >= last], p[x >= last], color=colour, ls="--")
    low, high = column(rows, "low"), column(rows, "high")
    # bands of several curves overlap: each has the edges of its colour
    faint = to_rgba(colour, 0.07)
    axes.fill_between(x, low, high, fc=faint, ec=colour, lw=0.7, ls=":")
    marker = MARKERS[number % len(MARKERS)]
    axes.plot(x, fraction, ls="", marker=marker, ms=4.0, color=colour)


def _with_hazard(axes: Axes, lines: Sequence[Rows], factor: float) -> None:
    """Add the hazard curve (right axis), and for each fitted curve, or the exact
    shares, its annual rate per ln x over the largest one.
    """
    x, h = (
        np.concatenate([column(some, name) for some in lines])
        for name in ("x", "hazard")
    )
    x, first = np.unique(x[np.isfinite(h)], return_index=True)
    h = h[np.isfinite(h)][first]
    right: Any = axes.twinx()
    right.plot(x / factor, h, color="0.2", lw=1.2)
    right.set(
        yscale="log",
        ylabel="annual rate of exceedance $H$ [1/yr]",
        ylim=(max(h[-1], h[0] * 1e-5), 2.0 * h[0]),
    )
    right.grid(False)
    fitted = [i for i, some in enumerate(lines) if some[0]["probability"] is not None]
    parts = {i: column(lines[i], "deaggregation") for i in fitted or range(len(lines))}
    most = max(float(np.nanmax(part, initial=0.0)) for part in parts.values()) or 1.0
    for i, part in parts.items():
        drawn = "default" if fitted else "steps-post"
        axes.plot(
            column(lines[i], "x") / factor,
            part / most,
            color=f"C{i}",
            ls=":",
            lw=1.4,
            drawstyle=drawn,
        )
    axes.plot([], [], color="0.2", lw=1.2, label="hazard $H$ (right)")
    axes.plot(
        [], [], color="0.2", ls=":", lw=1.2, label=r"$d\lambda/d\ln x$ over its largest"
    )
    axes.set(xscale="log", xlim=(x[0] / factor, x[-1] / factor))


def two_measures(figure: Figure, rows: Rows, units: Units) -> list[Axes]:
    """Draw the cells over PGA and PGV/PGA, a panel for each structure, and lines of
    equal probability of overturning, P = Phi(a + b ln PGA + c ln(PGV/PGA)) of the
    largest likelihood.
    """
    found = groups(rows, "structure")
    drawn = panels(figure, len(found))
    for axes, ((name,), some) in zip(drawn, found.items(), strict=True):
        known = [row for row in some if row["outcome"] != Outcome.FAILED.flag]
        x, y = (column_in(known, key, units) for key in ("pga", "pgv_pga"))
        sign = np.array(
            [
                1.0 if Outcome[str(row["outcome"]).upper()].falls else -1.0
                for row in known
            ]
        )
        for fell, text, mark in ((1.0, "falls", "xC1"), (-1.0, "stands", ".C0")):
            axes.plot(x[sign == fell], y[sign == fell], mark, ls="", ms=4.0, label=text)
        _plot_probabilities(axes, x, y, sign)
        axes.set(
            xscale="log",
            yscale="log",
            xlabel=label("pga", units),
            ylabel=label("pgv_pga", units),
            title=literal(name),
        )
        axes.margins(0.08)  # cells on the frame are whole
        for axis in (axes.xaxis, axes.yaxis):
            plain_ticks(axis)
        legend(axes)
    return drawn


def _plot_probabilities(
    axes: Axes, x: np.ndarray, y: np.ndarray, sign: np.ndarray
) -> None:
    """Draw lines of equal P = Phi(a + b ln x + c ln y) of the largest likelihood; sign:
    1 for a cell that falls, -1 for one that stands.
    """
    from scipy.optimize import minimize
    from scipy.special import log_ndtr, ndtr, ndtri

    terms = np.stack([np.ones(x.size), np.log(x), np.log(y)])
    fit = minimize(lambda q: -log_ndtr(sign * (q @ terms)).sum(), np.zeros(3))
    grid = np.meshgrid(
        np.geomspace(x.min(), x.max(), 80), np.geomspace(y.min(), y.max(), 80)
    )

    # Cells that one line parts have no more than that line.
    levels = [0.1, 0.5, 0.9] if fit.fun > 1e-2 else [0.5]
    u = fit.x[0] + fit.x[1] * np.log(grid[0]) + fit.x[2] * np.log(grid[1])
    axes.clabel(
        axes.contour(*grid, u, ndtri(levels), colors="0.2"),
        fmt=lambda u: f"P = {ndtr(u):.2g}",
        fontsize="x-small",
    )


def overturning_spectra(figure: Figure, rows: Rows, _: Units) -> list[Axes]:
    """Draw the first overturning PGA over p for each critical angle: the median of the
    records, and 16 to 84 % as a band.
    """
    axes = figure.add_subplot()
    for i, (group, some) in enumerate(groups(rows, "alpha").items()):
        p = column(some, "p")
        low, middle, high = (column(some, f"pga_ratio_{q}") for q in (16, 50, 84))
        style = (
            line_style(i)
            if group
            else {**line_style(i), "ls": "", "marker": MARKERS[i % len(MARKERS)]}
        )
        axes.plot(
            p,
            middle,
            label=rf"$\alpha$ = {np.degrees(float(group[0])):.3g}°" if group else None,
            **style,
        )
        axes.fill_between(p, low, high, color=style["color"], alpha=0.2, lw=0.0)
    axes.set(xlabel=r"$p$ [rad/s]", ylabel=r"first overturning PGA/$(\lambda g)$ [-]")
    legend(axes)
    return [axes]
