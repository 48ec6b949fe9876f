"""Measured free rocking: trace and fit, residuals, and eta over the amplitude."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UsageError
from ...responses.identification.identified import Course, Identification
from ..units import Units
from .canvas import COLOURS, PLAIN, Axes, canvas, label, literal

MOST = 3  # releases across
_DIMENSIONS = {
    "theta": "angle",
    "theta_dot": "angular velocity",
    "displacement": "length",
    "uplift": "length",
}
_FIT, _GREY = COLOURS[1], "0.6"


def draw_identified(
    found: Sequence[Identification],
    target: Path,
    units: Units | None,
    overwrite: bool,
    tell: Callable[[str], None] | None,
) -> None:
    """Draw traces with their fits and impacts, residuals with 2 standard deviations of
    the noise, and eta over theta/alpha; samples that the fit leaves out are grey. The
    first releases of many. Raises UsageError without a trace to draw, OutputError.
    """
    drawn = [one for one in found if one.course is not None][:MOST]
    if not drawn:
        raise UsageError(f"{target}: times of impacts alone give no figure")
    units = units or Units()
    with canvas(target, overwrite, tell=tell) as figure:
        figure.set_size_inches(max(6.4, 4.2 * len(drawn)), 7.2)
        grid = figure.add_gridspec(3, len(drawn), height_ratios=(2.0, 1.0, 1.6))
        for i, one in enumerate(drawn):
            above = figure.add_subplot(grid[0, i])
            below = figure.add_subplot(grid[1, i], sharex=above)
            assert one.course is not None
            _trace(above, one.course, units)
            _residuals(below, one.course, float(one.row["noise"]), units)
            number = f", release {one.row['release']}" if len(drawn) > 1 else ""
            above.set_title(literal(f"{one.row['trace']}{number}"))
        _restitutions(figure.add_subplot(grid[2, :]), drawn)


def _trace(axes: Axes, course: Course, units: Units) -> None:
    unit, factor = units.of(_DIMENSIONS[course.quantity])
    _samples(axes, course, course.y / factor, "measured")
    axes.plot(course.t, course.fit / factor, color=_FIT, lw=0.8, label="fit")
    for t in course.impacts:
        axes.axvline(t, color=_GREY, lw=0.5, ls=":")
    axes.set_ylabel(f"{course.quantity.replace('_', ' ')} [{PLAIN.get(unit, unit)}]")
    axes.legend(loc="upper right")


def _residuals(axes: Axes, course: Course, noise: float, units: Units) -> None:
    unit, factor = units.of(_DIMENSIONS[course.quantity])
    _samples(axes, course, (course.y - course.fit) / factor, "")
    axes.axhspan(-2.0 * noise / factor, 2.0 * noise / factor, color=_GREY, alpha=0.25)
    inside = np.abs(course.y - course.fit)[course.kept]
    most = max(float(np.max(inside)), 3.0 * noise) / factor
    axes.set_ylim(-1.1 * most, 1.1 * most)
    axes.set_ylabel(f"residual [{PLAIN.get(unit, unit)}]")
    axes.set_xlabel(label("t", units))


def _samples(axes: Axes, course: Course, y: np.ndarray, name: str) -> None:
    style: dict[str, Any] = {"ls": "", "marker": ".", "ms": 2.0}
    kept = course.kept
    axes.plot(course.t[kept], y[kept], color=COLOURS[0], label=name or None, **style)
    axes.plot(course.t[~kept], y[~kept], color=_GREY, **style)


def _restitutions(axes: Axes, found: Sequence[Identification]) -> None:
    """Draw eta with its intervals, the mean or line, and the value of momentum."""
    for i, one in enumerate(found):
        keys = ("ratio", "eta", "eta_low", "eta_high")
        x, eta, low, high = (
            np.array([row[key] for row in one.impacts]) for key in keys
        )
        colour = COLOURS[i]
        bars = np.stack([eta - low, high - eta])
        name = literal(f"{one.row['trace']} {one.row['release']}")
        axes.errorbar(x, eta, bars, color=colour, fmt="o", ms=3, lw=0.8, label=name)
        ends = np.array([0.0, x.max()])
        slope = one.row["eta_slope"] or 0.0
        axes.plot(
            ends, one.row["eta"] + slope * (ends - x.mean()), color=colour, lw=0.8
        )
    momentum = found[0].row["eta_momentum"]
    if momentum is not None:
        axes.axhline(momentum, color="0.4", ls="--", lw=0.8, label="angular momentum")
    axes.set_xlim(left=0.0)
    axes.set_xlabel(r"$\theta/\alpha$ before the impact")
    axes.set_ylabel(r"$\eta$")
    axes.legend(loc="best")
