"""Seismic hazard: how many times a year a site exceeds each level of a measure, and a
structure passes a limit state.

The annual rate of a limit state is the integral of P(x) over |dH(x)|, where P is the
fragility and H the hazard curve. Between its points H is a straight line in log-log, H
= H_i (x/x_i)^-k, so that a lognormal P of median m gives a closed form on each
(integration by parts, and Cornell's H(m) exp(k^2 beta^2/2) for a line without ends):

    -[P H] + H_i (x_i/m)^k exp(k^2 beta^2/2) [Phi(u_i+1 + k beta) - Phi(u_i + k beta)],
    u = ln(x/m)/beta

Nothing is counted outside the points; H(x_last) bounds the part beyond the last.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arguments import check_fields
from ..arrays import Array
from ..errors import UsageError
from ..motions.intensity_measures import measure_of
from ..showing import Shown

RATE_COLUMNS = (
    "annual_rate",
    "annual_rate_low",
    "annual_rate_high",
    "rate_beyond",
    "return_period",
    "p_50_years",
    "rate_without_fit",
    "rejected",
)


@dataclass(frozen=True, eq=False, repr=False)
class HazardCurve(Shown):
    """The annual rates at which levels of an intensity measure are exceeded.

    `read_hazard` reads one of a file; `annual_rate` and `fragility` take it. Between
    the levels ln rate is linear in ln level; a call returns the rate at any level.
    Raises UsageError unless there are two levels or more, positive and rising, with
    positive rates that do not rise.

    Attributes
    ----------
    x: levels [SI], (n,)
    rate: annual rates of exceedance [1/year], (n,)
    im: name of the intensity measure

    Examples
    --------
    >>> hazard = HazardCurve([1.0, 2.0, 4.0], [1e-2, 1e-3, 1e-4])
    >>> round(float(hazard(2.0)), 6)
    0.001
    """

    x: Array  # levels [SI], (n,)
    rate: Array  # annual rates of exceedance [1/year], (n,)
    im: str = "PGA"  # name of the intensity measure

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("x", "rate"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=float))
        there = self.x.ndim == 1 and self.x.shape == self.rate.shape and self.x.size > 1
        if not (
            there
            and np.all(np.isfinite(self.x))
            and self.x[0] > 0.0
            and np.all(np.diff(self.x) > 0.0)
        ):
            raise UsageError(
                "hazard curve: expected two or more levels, positive and rising"
            )
        if not (
            np.all(np.isfinite(self.rate))
            and self.rate[-1] > 0.0
            and np.all(np.diff(self.rate) <= 0.0)
        ):
            raise UsageError("hazard curve: expected positive rates that do not rise")

    def _shown(self) -> dict[str, Any]:
        return {
            "im": self.im,
            "levels": f"{self.x.size}: {self.x[0]:.4g} to {self.x[-1]:.4g}",
            "annual_rate": f"{self.rate[0]:.4g} to {self.rate[-1]:.4g}",
        }

    def _rows(self) -> list[dict[str, Any]]:
        pairs = zip(self.x.tolist(), self.rate.tolist(), strict=True)
        return [{"im": self.im, "x": x, "annual_rate": rate} for x, rate in pairs]

    def __call__(self, x: Array | float) -> Array:
        """Return H [1/year] at levels x [SI], in the shape of x; outside the points the
        H of the nearest one.
        """
        with np.errstate(divide="ignore"):
            return np.asarray(
                np.exp(np.interp(np.log(x), np.log(self.x), np.log(self.rate)))
            )

    @property
    def slope(self) -> Array:
        """k of each line, (n - 1,)."""
        return -np.diff(np.log(self.rate)) / np.diff(np.log(self.x))

    def density(self, x: Array) -> Array:
        """Return -dH/d(ln x) at some levels.

        Parameters
        ----------
        x
            levels [SI], of any shape

        Returns
        -------
        array
            [1/year], of the line to the right of a point; 0 outside the points
        """
        line = np.searchsorted(self.x, x, side="right") - 1
        inside = (line >= 0) & (line < self.slope.size)
        return np.where(
            inside, self.slope[np.clip(line, 0, self.slope.size - 1)] * self(x), 0.0
        )

    def rate_of(self, ln_median: Array, beta: Array) -> Array:
        """Return the annual rate of lognormal fragilities.

        Parameters
        ----------
        ln_median
            ln of the median [SI], of any shape
        beta
            dispersion [-], of the same shape

        Returns
        -------
        array
            [1/year], in the same shape
        """
        from scipy.special import log_ndtr, ndtr

        y, k = np.log(self.x), self.slope
        ln_median = np.asarray(ln_median, dtype=float)[..., None]
        beta = np.asarray(beta, dtype=float)[..., None]
        u = (y - ln_median) / beta
        low, high = u[..., :-1] + k * beta, u[..., 1:] + k * beta
        # the same difference of Phi(high) and Phi(low), without cancellation
        low, high = np.where(low > 0.0, -high, low), np.where(low > 0.0, -low, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            between = log_ndtr(high) + np.log1p(-np.exp(log_ndtr(low) - log_ndtr(high)))
        part = np.exp(
            np.log(self.rate[:-1])
            + k * (y[:-1] - ln_median)
            + 0.5 * (k * beta) ** 2
            + between
        )
        ends = ndtr(u) * self.rate
        return np.asarray(
            np.clip(
                ends[..., 0] - ends[..., -1] + np.nan_to_num(part).sum(-1),
                0.0,
                self.rate[0] - self.rate[-1],
            )
        )

    def of_intervals(
        self,
        intervals: Sequence[Sequence[tuple[float, float]]],
        highest: float = math.inf,
    ) -> Array:
        """Return the annual rate of overturning of each motion from its intervals.

        Parameters
        ----------
        intervals
            of each motion, pairs (from, to) of levels [SI], (members,)
        highest
            level above which nothing is counted [SI]

        Returns
        -------
        array
            the sum of H(from) - H(to) [1/year], (members,)
        """
        return np.array(
            [
                float(
                    sum(self(min(a, highest)) - self(min(b, highest)) for a, b in found)
                )
                for found in intervals
            ]
        )


@dataclass(frozen=True)
class Rate:
    """An annual rate of passing a limit state, part of a `Fit`.

    `probability` turns it into a probability within some years.

    Attributes
    ----------
    annual: [1/year]
    low: lower end of its 95 % band [1/year]
    high: upper end of its 95 % band [1/year]
    beyond: the most that motions beyond the last one that is counted add [1/year]
    last: the last level [SI]
    first: probability of the limit state at the first level of the hazard curve [-]

    Examples
    --------
    >>> rate = Rate(annual=1e-3, low=None, high=None, beyond=0.0, last=9.81, first=0.0)
    >>> f"{rate.probability(50.0):.5f}"
    '0.04877'
    """

    annual: float  # [1/year]
    low: float | None  # lower end of its 95 % band [1/year]
    high: float | None  # upper end of its 95 % band [1/year]
    beyond: float  # the most that stronger motions than the last counted add [1/year]
    last: float  # the last level [SI]
    # probability of the limit state at the first level of the hazard curve [-]
    first: float

    def probability(self, years: float) -> float:
        """Return the probability of passing the limit state within some years.

        Parameters
        ----------
        years
            length of time [years]

        Returns
        -------
        float
            1 - exp(-annual years) [-]
        """
        return -math.expm1(-self.annual * years)

    def row(self) -> dict[str, float | None]:
        """Return the rate as columns of a row."""
        period = 1.0 / self.annual if self.annual > 0.0 else None
        values = (
            self.annual,
            self.low,
            self.high,
            self.beyond,
            period,
            self.probability(50.0),
        )
        return dict(zip(RATE_COLUMNS, values, strict=False))

    def remarks(self, hazard: HazardCurve) -> list[str]:
        """Return a sentence for each end of the hazard curve that matters.

        Parameters
        ----------
        hazard
            the hazard curve of the rate

        Returns
        -------
        list of str
            if more than a tenth of the rate, or P > 0.01, is not counted
        """
        in_words, found = measure_of(hazard.im).in_words, []
        if self.beyond > 0.1 * self.annual:
            rate = f"{self.annual:.3g} a year up to {in_words(self.last)}"
            found.append(
                f"{rate}; stronger motions, not counted, add {self.beyond:.3g} at most"
            )
        if self.first > 0.01:
            place = f"{in_words(float(hazard.x[0]))}, where the hazard curve begins"
            found.append(
                f"the probability is {self.first:.2g} at {place}; weaker motions, not"
                " counted, add to the rate"
            )
        return found
