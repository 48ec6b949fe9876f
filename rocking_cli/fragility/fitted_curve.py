"""A fitted fragility curve: its rows, its points with those of a hazard curve, and its
annual rate.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arrays import Array
from ..showing import Shown
from .bootstrap import Band
from .fits import Curve
from .hazard import HazardCurve, Rate

FRAGILITY_COLUMNS = (
    "structure",
    "im",
    "limit_state",
    "method",
    "median",
    "beta",
    "median_low",
    "median_high",
    "beta_low",
    "beta_high",
    "n",
)
CURVE_COLUMNS = (
    "structure",
    "im",
    "limit_state",
    "method",
    "x",
    "probability",
    "low",
    "high",
    "fraction",
)
HAZARD_COLUMNS = ("hazard", "deaggregation", "annual_rate")  # of the points of a curve


class SlideLimit(float):
    """A limit state of a body that slides: its displacement over the ground [m]."""

    def __str__(self) -> str:
        return f"slide={1e3 * self:g}mm"


def word_of(limit: float | None) -> str:
    """Return the printed text of a limit state."""
    if isinstance(limit, SlideLimit):
        return str(limit)
    return "overturning" if limit is None else f"{limit:g}"


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Shown):
    """A fitted fragility curve with its band, and with a hazard curve its annual rate.

    `fragility` returns one for each structure, limit state and method; `row` and
    `points_of_curve` are what `rocking fragility` prints, and `export_fragility` writes
    them for other programs.

    Attributes
    ----------
    structure: its name
    im: name of the intensity measure
    limit: the limit state, a number of |theta|/alpha or "overturning"
    method: "stripes", "first" or "cloud"
    curve: median and dispersion
    band: at x, None without a bootstrap
    x: intensities [SI] of the band, (k,)
    points: fraction beyond the limit state by level [SI]
    hazard: the hazard curve of the site
    rate: annual rate of the limit state by this curve
    rate_without_fit: annual rate of overturning from traced intervals
    no_damage: level [SI] up to which the structure stays at rest, 0 if unknown

    Examples
    --------
    >>> curve = fit_stripes([1.0, 1.5, 2.0], [54, 54, 54], [2, 25, 43])
    >>> import numpy as np
    >>> fit = Fit("Column", "PGA", "overturning", "stripes", curve, None, np.ones(1))
    >>> fit.row()["structure"], round(fit.row()["median"], 4)
    ('Column', 1.5725)
    """

    structure: str  # name of the structure
    im: str  # name of the intensity measure
    limit: str  # the limit state, a number of |theta|/alpha or "overturning"
    method: str  # "stripes", "first" or "cloud"
    curve: Curve  # median and dispersion
    band: Band | None  # at x, None without a bootstrap
    x: Array  # intensities [SI] of the band, (k,)
    # fraction beyond the limit state by level [SI]
    points: dict[float, float] = field(default_factory=dict)
    hazard: HazardCurve | None = None  # the hazard curve of the site
    rate: Rate | None = None  # annual rate of the limit state by this curve
    # annual rate of overturning from traced intervals
    rate_without_fit: Rate | None = None
    # level [SI] up to which the structure stays at rest, 0 if unknown
    no_damage: float = 0.0
    # dispersion of the motions alone, at the means of numbers with a spread [-]; None
    # without draws
    beta_motions: float | None = None

    def _shown(self) -> dict[str, Any]:
        return self.row()

    def _rows(self) -> Iterator[dict[str, Any]]:
        return self.points_of_curve()

    def row(self) -> dict[str, Any]:
        """Return the fit as one row."""
        c, b = self.curve, self.band
        low, high, *beta = (
            (None,) * 4
            if b is None
            else (b.median_low, b.median_high, b.beta_low, b.beta_high)
        )
        values = (
            *self._names().values(),
            c.median,
            c.beta,
            low,
            high,
            *beta,
            round(c.n),
        )
        row: dict[str, Any] = dict(zip(FRAGILITY_COLUMNS, values, strict=True))
        if self.beta_motions is not None:
            row["beta_motions"] = self.beta_motions
        if self.rate is not None:
            row |= {
                **self.rate.row(),
                "rate_without_fit": (
                    self.rate_without_fit and self.rate_without_fit.annual
                ),
            }
        return row

    def points_of_curve(self) -> Iterator[dict[str, Any]]:
        """Yield the curve as rows."""
        probability = self.curve(self.x)
        hazard = hazard_points(self.hazard, self.x, probability, self.rate)
        for i, (x, more) in enumerate(zip(self.x.tolist(), hazard, strict=True)):
            low = high = None
            if self.band is not None:
                low, high = float(self.band.low[i]), float(self.band.high[i])
            row = {
                **self._names(),
                "x": x,
                "probability": float(probability[i]),
                "low": low,
                "high": high,
            }
            yield {**row, "fraction": self.points.get(x), **more}

    def _names(self) -> dict[str, Any]:
        return {
            "structure": self.structure,
            "im": self.im,
            "limit_state": self.limit,
            "method": self.method,
        }


def drawn_at(
    levels: Array, hazard: HazardCurve | None
) -> tuple[Array, Callable[[Array, Array], Array] | None]:
    """Return (the intensities at which a curve is drawn: the levels and 61 more, with a
    hazard curve from its first to its last level as well; the annual rate of lognormal
    curves, None without a hazard curve).
    """
    if hazard is None:
        first, last, rate = 0.5 * levels[0], 1.5 * levels[-1], None
    else:
        levels, rate = np.union1d(levels, hazard.x), hazard.rate_of
        first, last = levels[0], levels[-1]
    return np.union1d(np.geomspace(first, last, 61), levels), rate


def hazard_points(
    hazard: HazardCurve | None, x: Array, probability: Array, rate: Rate | None
) -> list[dict[str, Any]]:
    """Return the columns HAZARD_COLUMNS at points of a curve: H, dlambda/d(ln x) with
    the annual rate lambda, and lambda [1/year].
    """
    if hazard is None or rate is None:
        return [{} for _ in x]
    inside = (x >= hazard.x[0]) & (x <= hazard.x[-1])
    columns = (
        np.where(inside, hazard(x), np.nan),
        probability * hazard.density(x),
        np.full(x.shape, rate.annual),
    )
    return [
        dict(zip(HAZARD_COLUMNS, map(float, values), strict=True))
        for values in zip(*columns, strict=True)
    ]


def rate_of(curve: Curve, band: Band | None, hazard: HazardCurve) -> Rate:
    """Return the annual rate of a fitted curve, with the band of its samples."""
    low, high = (None, None) if band is None or band.rate is None else band.rate
    annual = float(hazard.rate_of(np.log(curve.median), np.array(curve.beta)))
    return Rate(
        annual,
        low,
        high,
        float(hazard.rate[-1]),
        float(hazard.x[-1]),
        float(curve(hazard.x[0])),
    )
