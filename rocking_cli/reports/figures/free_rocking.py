"""Measured free rocking: trace and fit, residuals, and eta over the amplitude."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...responses.identification.identified import Course, Identification
from ...responses.identification.trace import DIMENSIONS
from ..units import Units
from .canvas import COLOURS, PLAIN, Axes, Figure, label, literal

MOST = 3  # releases across
_GREY = "0.6"


def fits(figure: Figure, found: Sequence[Identification], units: Units) -> None:
    """Draw traces with their fits and impacts, residuals with 2 standard deviations of
    the noise, and eta over theta/alpha; samples that the fit leaves out are grey. The
    first releases of many.
    """
    drawn = found[:MOST]
    figure.set_size_inches(max(6.4, 4.2 * len(drawn)), 7.2)
    grid = figure.add_gridspec(3, len(drawn), height_ratios=(2.0, 1.0, 1.6))
    below = figure.add_subplot(grid[2, :])
    for i, one in enumerate(drawn):
        axes = figure.add_subplot(grid[0, i])
        name = literal(f"{one.row['trace']} {one.row['release']}")
        axes.set_title(name if len(drawn) > 1 else literal(one.row["trace"]))
        _release(axes, figure.add_subplot(grid[1, i], sharex=axes), one, units)
        _restitutions(below, one, COLOURS[i], name)
    momentum = drawn[0].row["eta_momentum"]
    if momentum is not None:
        below.axhline(momentum, color="0.4", ls="--", lw=0.8, label="angular momentum")
    below.set(xlabel=r"$\theta/\alpha$ before the impact", ylabel=r"$\eta$")
    below.set_xlim(left=0.0)
    below.legend(loc="best")


def _release(above: Axes, below: Axes, one: Identification, units: Units) -> None:
    """Draw the trace with its fit and impacts, and what the fit leaves."""
    course = one.course
    assert course is not None
    unit, factor = units.of(DIMENSIONS[course.quantity])
    unit = PLAIN.get(unit, unit)
    residual = (course.y - course.fit) / factor
    _samples(above, course, course.y / factor, "measured")
    above.plot(course.t, course.fit / factor, color=COLOURS[1], lw=0.8, label="fit")
    for t in course.impacts:
        above.axvline(t, color=_GREY, lw=0.5, ls=":")
    above.set_ylabel(f"{course.quantity.replace('_', ' ')} [{unit}]")
    above.legend(loc="upper right")

    _samples(below, course, residual)
    noise = one.row["noise"] / factor
    below.axhspan(-2.0 * noise, 2.0 * noise, color=_GREY, alpha=0.25)
    most = max(float(np.max(np.abs(residual[course.kept]))), 3.0 * noise)
    below.set_ylim(-1.1 * most, 1.1 * most)
    below.set(xlabel=label("t", units), ylabel=f"residual [{unit}]")


def _samples(axes: Axes, course: Course, y: np.ndarray, name: str = "") -> None:
    style: dict[str, Any] = {"ls": "", "marker": ".", "ms": 2.0}
    used, left_out = np.where(course.kept, y, np.nan), np.where(course.kept, np.nan, y)
    axes.plot(course.t, used, color=COLOURS[0], label=name or None, **style)
    axes.plot(course.t, left_out, color=_GREY, **style)


def _restitutions(axes: Axes, one: Identification, colour: str, name: str) -> None:
    """Draw eta with its intervals, and the mean or line."""
    keys = ("ratio", "eta", "eta_low", "eta_high")
    x, eta, low, high = (np.array([row[key] for row in one.impacts]) for key in keys)
    bars = np.stack([eta - low, high - eta])
    axes.errorbar(x, eta, bars, color=colour, fmt="o", ms=3, lw=0.8, label=name)
    ends = np.array([0.0, x.max()])
    line = one.row["eta"] + (one.row["eta_slope"] or 0.0) * (ends - x.mean())
    axes.plot(ends, line, color=colour, lw=0.8)
