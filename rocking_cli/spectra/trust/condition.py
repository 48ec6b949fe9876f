"""The condition of cells: how strongly the largest rotation depends on the input, and so on errors of the integration."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...dynamics.outcome import safe
from ...dynamics.response import Response

Array = np.ndarray

STEP = 1e-7  # relative change of each input; the linear equation leaves the differences 8 digits
_ETA = 2
_TOLERANCES = 100.0  # of a method with a tolerance, the least change of input, so that its own error stays below the difference


def condition_of(respond: Callable[[Array, Array, Array], Response], amplitude: Array, omega: Array, eta: Array, tolerance: float) -> Array:
    """Condition of cells (any shape, broadcast): change of max |theta|/alpha over a small relative change of the input,

        kappa = |d theta/d ln A| + |d theta/d ln Omega| + |d theta/d ln eta|,   theta = max |theta|/alpha        [-]

    by central differences over a relative 1e-7, or 100 times the tolerance of the method (0 of an exact one). respond: the
    response of arrays (A, Omega, eta). NaN if the cell or a cell of the differences overturned or failed; 0 below uplift. From about 1e5
    on the difference is no derivative and no bound: a rotation that changes completely over 1e-7 may do so over 1e-12.
    """
    cells = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (amplitude, omega, eta)))
    step, total = max(STEP, _TOLERANCES * tolerance), np.zeros(cells[0].shape)
    for i, values in enumerate(cells):
        ends = np.stack([values * (1.0 - step), values * (1.0 + step)])
        if i == _ETA:
            np.clip(ends, -1.0, 1.0, out=ends)
        beside = [ends if j == i else np.stack([x, x]) for j, x in enumerate(cells)]
        found = respond(*beside)
        still = safe(found.outcome).all(axis=0)
        width = np.abs(ends[1] - ends[0])
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = np.abs(found.theta_ratio[1] - found.theta_ratio[0]) * np.abs(values) / width
        total += np.where(still, np.where(width == 0.0, 0.0, rate), np.nan)
    return total
