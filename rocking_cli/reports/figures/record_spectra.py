"""Rocking spectra of a set of records: median, 16 and 84 % quantiles of theta_max/alpha over T = 2 pi/p.

A cell that overturns or loses contact counts as infinite, so a line ends where its quantile is infinite. The quantiles are
observed values (the inverse of the empirical distribution), without interpolation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...dynamics.outcome import falls
from ...spectra.file.reader import SpectraFile
from ..units import Units
from .canvas import PANEL, legend, literal, look
from .labels import SYMBOLS, label, valued

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHARES = (0.16, 0.5, 0.84)
_LEVELS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)


def record_quantiles(file: SpectraFile) -> np.ndarray:
    """The quantiles SHARES of theta_max/alpha over the records, (shares, alpha, T); inf where too many overturn, NaN without cells."""
    theta = file.array("theta_ratio")
    theta[falls(file.array("outcome"))] = np.inf
    ordered = np.sort(theta, axis=0)  # NaN (failed or not computed) is sorted to the end
    known = (~np.isnan(theta)).sum(axis=0)
    rank = [np.clip(np.ceil(share * known).astype(int) - 1, 0, None) for share in SHARES]
    return np.stack([np.take_along_axis(ordered, r[None], axis=0)[0] for r in rank])


def record_spectra(figure: Figure, file: SpectraFile, units: Units) -> list[Axes]:
    """Draw the quantiles over T for each alpha, and contours of the median over tan alpha and p if there are several of both."""
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
        if count > 1:  # an infinite upper quantile is drawn at the top
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
    """Draw the median over tan alpha and p; grey where half of the records overturn."""
    x, y = np.tan(alpha), 2.0 * np.pi / period[::-1]
    z = median[:, ::-1].T
    axes.set_facecolor("0.8")
    drawn = axes.contourf(x, y, np.ma.masked_invalid(z), levels=_LEVELS, extend="max", cmap="viridis")
    figure = axes.figure
    figure.colorbar(drawn, ax=axes, label=f"median of {SYMBOLS['theta_max_ratio']}; grey: half of them fall")
    axes.set(xlabel=r"$\tan\alpha$ [-]", ylabel="$p$ [rad/s]")
