"""What `identify` finds in a trace: a row, the impacts, the lines to paste, and what
cannot be told.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...showing import Shown

COLUMNS = (
    "trace",
    "release",
    "impacts",
    "theta0_ratio",
    *("inset", "inset_low", "inset_high"),
    *("alpha", "alpha_low", "alpha_high", "alpha_ratio"),
    *("p", "p_low", "p_high", "p_structure"),
    *("eta", "eta_low", "eta_high", "eta_scatter"),
    *("eta_right", "eta_left", "eta_momentum"),
    *("eta_slope", "eta_slope_low", "eta_slope_high"),
    *("noise", "rms", "offset", "drift", "unexplained"),
)
IMPACT_COLUMNS = (
    *("trace", "release", "impact", "t", "side", "theta_before", "ratio"),
    *("eta", "eta_low", "eta_high", "eta_alone"),
)
_TINY = 1e-12


class Estimate(NamedTuple):
    """A number with its standard deviation."""

    value: float
    sd: float
    factor: float = 0.0  # half the width of its interval over sd

    def text(self, unit: str = "", factor: float = 1.0) -> str:
        """Return it as a document states a number with a spread, the spread to two
        digits.
        """
        value, sd = self.value / factor, max(self.sd / factor, _TINY)
        digits = max(0, 1 - math.floor(math.log10(sd)))
        parts = (f"{value:.{digits}f}", unit, "+-", f"{sd:.{digits}f}", unit)
        return " ".join(filter(None, parts))


@dataclass(frozen=True)
class Course:
    """The samples of a trace and the fit of one release, for a figure."""

    quantity: str  # what was measured
    t: Array  # [s], (N,)
    y: Array  # readings [SI], (N,)
    fit: Array  # [SI], NaN outside the release, (N,)
    kept: Array  # True for the samples that the fit uses, (N,)
    impacts: Array  # times [s]


@dataclass(frozen=True, repr=False)
class Identification(Shown):
    """What free rocking tells of a body: one release, or the mean of several.

    `identify` returns them.

    Attributes
    ----------
    row: numbers by the columns of `rocking identify --json`, in SI; None where the
        trace does not tell
    impacts: rows of the impacts, by the columns of its CSV; empty for a mean
    lines: of a structure document, to paste; empty if none may be pasted
    remarks: sentences on what the trace does not tell or contradicts
    course: the samples and the fit, None for a mean and for impact times
    estimates: inset [m], alpha [rad], p [rad/s] and eta with their standard deviations,
        those that are found

    Examples
    --------
    >>> blows = Trace("blows", "impact", [0.0, 0.9, 1.62, 2.25, 2.81, 3.32, 3.79])
    >>> found = identify(blows, "block:0.5x2")[0]
    >>> print(found.lines[-1])
    restitution: 0.9224 +- 0.0081  # momentum: 0.912
    >>> [round(found.row[key], 3) for key in ("eta", "eta_low", "eta_high")]
    [0.922, 0.9, 0.945]
    """

    row: Mapping[str, Any]
    impacts: Sequence[Mapping[str, Any]] = ()
    lines: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    course: Course | None = None
    estimates: Mapping[str, Estimate] = field(default_factory=dict)

    def _shown(self) -> Mapping[str, Any]:
        return {key: value for key, value in self.row.items() if value is not None}

    def _rows(self) -> Iterable[Mapping[str, Any]]:
        return self.impacts


def bounds(found: Mapping[str, Estimate]) -> dict[str, float]:
    """Return columns of estimates, each with the ends of its interval."""
    ends = (("", 0.0), ("_low", -1.0), ("_high", 1.0))
    return {
        key + end: one.value + side * one.factor * one.sd
        for key, one in found.items()
        for end, side in ends
    }


def mean_of(found: Sequence[Estimate]) -> tuple[Estimate, float]:
    """Return (the mean of several tests, the standard deviation between them): random
    effects by expectation and maximisation.
    """
    values, own, _ = np.array(found, float).T
    between = float(np.std(values))
    for _ in range(200):
        weight = 1.0 / (between**2 + own**2)
        mean, variance = weight @ values / weight.sum(), 1.0 / weight.sum()
        # of the true value of each test, given its estimate
        shrunk = between**2 * weight
        left = shrunk**2 * (values - mean) ** 2 + (1.0 - shrunk) * between**2
        between = float(np.sqrt(np.mean(left + shrunk**2 * variance))) + _TINY
    return Estimate(float(mean), math.sqrt(variance)), between
