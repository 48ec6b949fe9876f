"""The hazard of a site beside fragility curves, and the levels from which an annual rate comes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..rows import Rows, column

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_DECADES = 5.0  # of annual rates that are shown at most


def with_hazard(axes: Axes, lines: Sequence[Rows], factor: float) -> None:
    """Add the hazard curve (right axis, logarithmic), and for each fitted curve its annual rate over ln x, over the largest of all; that
    of the exact shares only where there is no fit.

    lines: the rows of each fragility curve; factor: from the unit of the abscissa to SI.
    """
    x, h = (np.concatenate([column(some, name) for some in lines]) for name in ("x", "hazard"))
    x, first = np.unique(x[np.isfinite(h)], return_index=True)
    h = h[np.isfinite(h)][first]
    right: Any = axes.twinx()
    right.plot(x / factor, h, color="0.2", lw=1.2)
    right.set(yscale="log", ylabel="annual rate of exceedance $H$ [1/yr]", ylim=(max(h[-1], h[0] * 10.0**-_DECADES), 2.0 * h[0]))
    right.grid(False)
    fitted = [i for i, some in enumerate(lines) if some[0]["probability"]]
    parts = {i: column(lines[i], "deaggregation") for i in fitted or range(len(lines))}
    most = max(float(np.nanmax(part, initial=0.0)) for part in parts.values()) or 1.0
    for i, part in parts.items():
        drawn = "default" if fitted else "steps-post"
        axes.plot(column(lines[i], "x") / factor, part / most, color=f"C{i}", ls=":", lw=1.4, drawstyle=drawn)
    axes.plot([], [], color="0.2", lw=1.2, label="hazard $H$ (right)")
    axes.plot([], [], color="0.2", ls=":", lw=1.2, label=r"$d\lambda/d\ln x$ over its largest")
    axes.set(xscale="log", xlim=(x[0] / factor, x[-1] / factor))
