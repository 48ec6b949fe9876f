"""Rocking spectra of a set of records: theta_max/alpha over T = 2 pi/p, its median and its 16 and 84 % quantiles over the records.

A body that falls, or leaves the ground, has no largest rotation: it counts as larger than all others, so that a line ends where more than
its share of the records do that. The quantiles are observed values (the inverse of the empirical distribution), nothing is interpolated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...dynamics.outcome import falls
from ...spectra.reader import SpectraFile
from ..units import Units
from .canvas import PANEL, legend, literal, look
from .labels import SYMBOLS, label, valued

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHARES = (0.16, 0.5, 0.84)
_LEVELS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)


def record_quantiles(file: SpectraFile) -> np.ndarray:
    """Quantiles of theta_max/alpha over the records at `SHARES`, (shares, alpha, T); inf where so many fall, NaN without cells."""
    theta = file.array("theta_ratio")
    theta[falls(file.array("outcome"))] = np.inf
    ordered = np.sort(theta, axis=0)  # NaN, of cells that failed or are not computed, comes last
    known = (~np.isnan(theta)).sum(axis=0)
    rank = [np.clip(np.ceil(share * known).astype(int) - 1, 0, None) for share in SHARES]
    return np.stack([np.take_along_axis(ordered, r[None], axis=0)[0] for r in rank])


def record_spectra(figure: Figure, file: SpectraFile, units: Units) -> list[Axes]:
    """A line for each alpha with its band; beside it the median as contours over tan alpha and p, where there are several of both."""
    alpha, period = (np.asarray(file.frame.dimensions[name]) for name in ("alpha", "T"))
    found = record_quantiles(file)
    finite = np.where(np.isfinite(found), found, np.nan)
    contours = alpha.size > 1 and period.size > 1
    count = file.frame.shape[0]
    if contours:
        figure.set_size_inches(2.0 * PANEL[0], PANEL[1])
    first, *others = figure.subplots(1, 2 if contours else 1, squeeze=False)[0]
    for i, a in enumerate(alpha):
        first.plot(period, finite[1, i], label=valued("alpha", float(a), units), **look(i))
        if count > 1:  # where the upper quantile falls the band ends at the top of what is drawn
            low, high = finite[0, i], np.where(np.isinf(found[2, i]), max(1.0, float(np.nanmax(finite, initial=0.0))), finite[2, i])
            first.fill_between(period, low, high, color=look(i)["color"], alpha=0.15, lw=0.0)
    many = f"median and 16 to 84 % of {count} records" if count > 1 else literal(str(file.frame.dimensions["record"][0]))
    first.set(xlabel=label("T", units), ylabel=label("theta_max_ratio", units), title=f"{many}, {file.scene['model']} equation")
    first.set_ylim(bottom=0.0)
    legend(first)
    for axes in others:
        _contours(axes, alpha, period, found[1])
    return [first, *others]


def _contours(axes: Axes, alpha: np.ndarray, period: np.ndarray, median: np.ndarray) -> None:
    """The median over tan alpha and p; where half of the records overturn it is grey."""
    x, y = np.tan(alpha), 2.0 * np.pi / period[::-1]
    z = median[:, ::-1].T
    axes.set_facecolor("0.8")
    drawn = axes.contourf(x, y, np.ma.masked_invalid(z), levels=_LEVELS, extend="max", cmap="viridis")
    figure = axes.figure
    figure.colorbar(drawn, ax=axes, label=f"median of {SYMBOLS['theta_max_ratio']}; grey: half of them fall")
    axes.set(xlabel=r"$\tan\alpha$ [-]", ylabel="$p$ [rad/s]")
