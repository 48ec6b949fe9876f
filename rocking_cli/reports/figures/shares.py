"""The figure of draws: the share that falls over the amplitude, with its 95 % band."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .canvas import Axes, label, literal

if TYPE_CHECKING:
    from ...responses.shares import ShareOfDraws
    from ..units import Units


def shares(
    axes: Axes,
    title: str,
    amplitude: np.ndarray,
    found: Sequence[ShareOfDraws],
    demand: float,
    units: Units,
) -> None:
    """Draw the share of draws that falls.

    Parameters
    ----------
    axes
        to draw on
    title
        of the figure
    amplitude
        amplitudes of the ground [m/s2], (k,)
    found
        the share at each amplitude, (k,)
    demand
        the amplitude of the demand [m/s2]
    units
        of the axes
    """
    factor = units.column("a_g")[2]
    x = amplitude / factor
    low, share, high = (
        100.0 * np.array([getattr(one, name) for one in found])
        for name in ("low", "share", "high")
    )
    blue = "#0072B2"
    axes.fill_between(x, low, high, color=blue, alpha=0.25, lw=0, label="95 % band")
    axes.plot(x, share, color=blue, marker="o", ms=3, label="share of the draws")
    axes.axvline(demand / factor, color="#D55E00", ls="--", label="demand")
    axes.set_ylim(0.0, 100.0)
    axes.set_xlim(x[0], x[-1])
    axes.set_xlabel(label("a_g", units))
    axes.set_ylabel(f"draws that fall, of {found[0].draws:,} [%]")
    axes.set_title(literal(title))
    axes.legend(loc="upper left")
