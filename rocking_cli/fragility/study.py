"""Fragility curves of structures under a set of motions: the data of each method, and
the printed rows.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ..dynamics.method import LINEAR, Method, governing_method
from ..dynamics.outcome import Outcome
from ..errors import UsageError, did_you_mean
from ..motions.recording import Recording
from ..spectra.sweep import SweepOptions
from ..structures.parameters import RockingParameters
from . import fits
from .exposure import (
    Exposure,
    Interval,
    MotionSet,
    Progress,
    SlideLimit,
    as_recorded,
    exposures,
    first_of,
    share_overturned,
    traced,
)
from .fits import Band, Curve, Resampling, check_levels
from .hazard import HazardCurve, Rate
from .measures import Measure, compared, measure_of, members_of

Array = np.ndarray
Fitted = tuple[
    Curve, Callable[[Array], fits.Estimate], dict[float, float]
]  # with the estimate of samples, and the points of the data
METHODS = ("stripes", "first", "cloud")
LIMITS: tuple[float | None, ...] = (0.1, 0.5, 1.0, None)
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
FRAGILITY_KEYS = ("structure", "limit_state", "method")  # they say which row it is
CURVE_KEYS = (*FRAGILITY_KEYS, "x")
CELL_KEYS = ("structure", "motion", "pga")
EFFICIENCY_KEYS = ("structure", "im")
HAZARD_COLUMNS = ("hazard", "deaggregation", "annual_rate")  # of the points of a curve
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
CELL_COLUMNS = ("structure", "motion", "pga", "pgv_pga", "theta_ratio", "outcome")
EFFICIENCY_COLUMNS = ("structure", "im", "median", "beta", "efficiency", "n")


def word_of(limit: float | None) -> str:
    """Return the printed text of a limit state."""
    if isinstance(limit, SlideLimit):
        return str(limit)
    return "overturning" if limit is None else f"{limit:g}"


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted curve with its band, and with a hazard curve its annual rate.

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
    """

    structure: str  # its name
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
            low, high = (
                (None, None)
                if self.band is None
                else (float(self.band.low[i]), float(self.band.high[i]))
            )
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


def with_more(levels: Array, first: float, last: float) -> Array:
    """Return levels with 61 more from `first` to `last`, at which a curve is drawn."""
    return np.union1d(np.geomspace(first, last, 61), levels)


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


@dataclass(frozen=True, eq=False)
class Study:
    """A structure under a set of motions."""

    structure: RockingParameters  # the one that rocks
    motions: MotionSet  # the set, its measure and its levels
    how: Resampling  # options of the bootstrap
    exposure: Exposure  # responses at the levels
    # overturning intervals of the measure for each motion, if traced
    intervals: Sequence[Sequence[Interval]] | None = None
    recorded: Exposure | None = None  # responses to the unscaled motions
    hazard: HazardCurve | None = None  # the hazard curve of the site

    @property
    def highest(self) -> float:
        return float(self.motions.levels[-1])

    def own(self, measure: Measure) -> Array:
        """Return a measure of each unscaled motion, (members,)."""
        return np.array(
            [m.measured(measure, self.structure) for m in self.motions.members]
        )

    @property
    def no_damage(self) -> float:
        """The level [SI] of uplift by the equation of the study for PGA without a
        vertical motion and a building, otherwise 0.
        """
        lifted = any(
            (
                m.recording.upwards is not None or m.recording.building is not None
                if m.recording
                else m.motion.vertical is not None
            )
            for m in self.motions.members
        )
        s, linear = self.structure, self.motions.method.model == LINEAR.model
        return (
            0.0
            if lifted or self.motions.measure.name != "PGA"
            else s.gravity * (s.linear_uplift if linear else s.uplift)
        )

    def fit(self, method: str, limit: float | None) -> Fit:
        """Return the fit of a limit state by a method. Raises UsageError if there are
        too few data.
        """
        if (count := len(self.motions.members)) < fits.FEWEST:
            raise UsageError(f"{count} records; a fit needs at least {fits.FEWEST}")
        curve, estimate, points = {
            "stripes": self._stripes,
            "first": self._first,
            "cloud": self._cloud,
        }[method](limit)
        levels, hazard, rate = self.motions.levels, self.hazard, None
        if hazard is None:
            x, of = with_more(levels, 0.5 * levels[0], 1.5 * levels[-1]), None
        else:
            levels, of = np.union1d(levels, hazard.x), hazard.rate_of
            x = with_more(levels, levels[0], levels[-1])
        band = (
            fits.bootstrap(count, estimate, self.how, x, of)
            if self.how.samples
            else None
        )
        if hazard is not None:
            rate = rate_of(curve, band, hazard)
        names = self.structure.name, self.motions.measure.name, word_of(limit), method
        free = self.rate_without_fit if limit is None else None
        return Fit(*names, curve, band, x, points, hazard, rate, free, self.no_damage)

    def _stripes(self, limit: float | None) -> Fitted:
        beyond, known = self.exposure.beyond(limit)
        levels, w = self.motions.levels, self.motions.weight[:, None]
        n, z = w * known, w * (beyond & known)
        points = dict(zip(levels.tolist(), (z.sum(0) / n.sum(0)).tolist(), strict=True))
        return (
            fits.fit_stripes(levels, n.sum(0), z.sum(0)),
            lambda i: fits.stripes(levels, n[i].sum(-2), z[i].sum(-2)),
            points,
        )

    def _first(self, limit: float | None) -> Fitted:
        if limit is not None:
            raise UsageError(
                f'limit state {limit:g}: the method "first" fits only the limit state'
                " overturning"
            )
        assert self.intervals is not None
        r, highest, w = first_of(self.intervals), self.highest, self.motions.weight
        share = {
            float(x): float(w[r <= x].sum() / w.sum()) for x in self.motions.levels
        }
        return (
            fits.fit_first(r, highest, w),
            lambda i: fits.first_overturning(r[i], highest, w[i]),
            share,
        )

    def _cloud(self, limit: float | None) -> Fitted:
        if limit is None or isinstance(limit, SlideLimit):
            raise UsageError(
                f"limit state {word_of(limit)}: the method cloud needs a rotation"
            )
        assert self.recorded is not None
        x, theta, w = (
            self.own(self.motions.measure),
            self.recorded.theta_ratio[:, 0],
            self.motions.weight,
        )
        return (
            fits.fit_cloud(x, theta, limit, w),
            lambda i: fits.cloud(x[i], theta[i], limit, w[i]),
            {},
        )

    @cached_property
    def rate_without_fit(self) -> Rate | None:
        """The annual rate of overturning: the weighted mean of that of the traced
        intervals, up to the highest level and the last of the hazard curve. None
        without a hazard curve, or without intervals.
        """
        if self.hazard is None or self.intervals is None:
            return None
        highest, w = min(self.highest, float(self.hazard.x[-1])), self.motions.weight
        of_each = w * self.hazard.of_intervals(self.intervals, highest)
        low = high = None
        if self.how.samples and w.size >= fits.FEWEST and np.ptp(of_each) > 0.0:
            ends = fits.interval(
                w.size, lambda i: (of_each[i].sum(-1) / w[i].sum(-1))[None], self.how
            )
            low, high = (float(end[0]) if np.isfinite(end[0]) else None for end in ends)
        first = float(
            w
            @ [
                any(a < self.hazard.x[0] < b for a, b in found)
                for found in self.intervals
            ]
            / w.sum()
        )
        return Rate(
            float(of_each.sum() / w.sum()),
            low,
            high,
            float(self.hazard(highest)),
            highest,
            first,
        )

    def exact_row(self) -> dict[str, Any]:
        """Return `rate_without_fit` as one row. Raises UsageError if there is none."""
        if (rate := self.rate_without_fit) is None:
            missing = (
                "hazard curve"
                if self.hazard is None
                else "traced overturning intervals"
            )
            raise UsageError(
                f"{self.structure.name}: found no {missing}; expected a hazard curve"
                " and traced overturning intervals"
            )
        row = {
            **dict.fromkeys(FRAGILITY_COLUMNS),
            **self._exact(),
            "n": len(self.motions.members),
            **rate.row(),
        }
        return {**row, "rate_without_fit": rate.annual}

    def exact_rows(self) -> Iterator[dict[str, Any]]:
        """Yield the share of motions that overturn the structure, without a fit: a row
        for each intensity at which it changes.
        """
        assert self.intervals is not None
        x, share = share_overturned(self.intervals, self.motions.weight)
        for at, part, more in zip(
            x,
            share,
            hazard_points(self.hazard, x, share, self.rate_without_fit),
            strict=True,
        ):
            yield {
                **self._exact(),
                "x": float(at),
                "probability": None,
                "low": None,
                "high": None,
                "fraction": float(part),
                **more,
            }

    def _exact(self) -> dict[str, str]:
        return {
            "structure": self.structure.name,
            "im": self.motions.measure.name,
            "limit_state": "overturning",
            "method": "exact",
        }

    @property
    def resurrections(self) -> int:
        """The number of motions that overturn the structure at one level and not at a
        higher one.
        """
        if self.intervals is None:
            beyond = self.exposure.beyond(None)[0]
            return int((beyond[:, :-1] & ~beyond[:, 1:]).any(axis=1).sum())
        return sum(
            bool(found) and (len(found) > 1 or bool(np.isfinite(found[-1][1])))
            for found in self.intervals
        )

    def efficiency(self) -> list[dict[str, Any]]:
        """Return rows with the dispersion for each measure, the smallest first;
        efficiency: the smallest dispersion over that of the row.

        The dispersion is that of the first overturnings, if traced, otherwise of the
        cells at the levels. Raises UsageError for too few overturnings.
        """
        found: list[tuple[str, Curve]] = []
        (gone, known), motions, weight = (
            self.exposure.beyond(None),
            self.motions,
            self.motions.weight,
        )
        here = self.own(motions.measure)
        for measure in compared(motions.members, motions.measure):
            own, power = self.own(measure), measure.power / motions.measure.power
            if self.intervals is not None:
                first, most = first_of(self.intervals) / here, self.highest / here
                curve = fits.fit_first(own * first**power, own * most**power, weight)
            else:
                x, n = (
                    own[:, None] * (motions.levels / here[:, None]) ** power,
                    weight[:, None] * known,
                )
                if not 0.0 < (n * gone).sum() < n.sum():
                    raise UsageError(
                        f"{self.structure.name}: all cells overturn, or none; expected"
                        " levels at which some do"
                    )
                curve = replace(
                    fits.fit_cells(x.ravel(), n.ravel(), (n * gone).ravel()),
                    n=float(weight.size),
                )
            found.append((measure.name, curve))
        found.sort(key=lambda pair: pair[1].beta)
        least = found[0][1].beta
        rows = (
            (self.structure.name, im, c.median, c.beta, least / c.beta, round(c.n))
            for im, c in found
        )
        return [dict(zip(EFFICIENCY_COLUMNS, row, strict=True)) for row in rows]

    def cells(self) -> Iterator[dict[str, Any]]:
        """Yield the cells as rows over PGA [m/s2] and PGV/PGA [s]; a factor of the
        motion does not change PGV/PGA.
        """
        motions, exposure = self.motions, self.exposure
        for m, own, *cells in zip(
            motions.members,
            self.own(motions.measure),
            exposure.theta_ratio,
            exposure.outcome,
            strict=True,
        ):
            i = m.intensity
            pga = i.pga * (motions.levels / own) ** (1.0 / motions.measure.power)
            for x, theta, outcome in zip(pga, *cells, strict=True):
                values = (
                    self.structure.name,
                    m.label,
                    float(x),
                    i.pgv / i.pga,
                    float(theta),
                    Outcome(int(outcome)).flag,
                )
                yield dict(zip(CELL_COLUMNS, values, strict=True))


def fragility(
    structures: Sequence[RockingParameters],
    records: Sequence[Recording],
    levels: Sequence[float] | Array,
    im: str = "PGA",
    *,
    limits: Sequence[float | None] = LIMITS,
    methods: Sequence[str] = ("stripes",),
    method: Method | None = None,
    how: Resampling | None = None,
    workers: int | None = None,
    hazard: HazardCurve | None = None,
) -> list[Fit]:
    """Return the fragility curves of structures under records, as `rocking fragility`
    fits them.

    levels: of the measure im, in SI; limits: values of |theta|/alpha, None for
    overturning; methods: some of `METHODS`; method: the equation of motion, None for
    `governing_method`; hazard: a curve of the same measure, for annual rates. A limit
    state with too few data is left out. Raises UsageError for bad levels or another
    measure, and if no fit is left.

    >>> columns = load_structures('configs/block.yaml')
    >>> fragility(columns, load_records('configs/motions/synthetic.at2'), [1.0, 2.0])
    Traceback (most recent call last):
        ...
    rocking_cli.errors.UsageError: Column, 0.1, stripes: 1 records; a fit needs at least
    4
    """
    measure, x = measure_of(im), check_levels(np.asarray(levels, dtype=float))
    if hazard is not None and hazard.im != measure.name:
        raise UsageError(
            f"found a hazard curve of {hazard.im}; expected {measure.name}, the measure"
            " `im`"
        )
    for word in methods:
        if word not in METHODS:
            raise UsageError(
                f"`methods`: found {word!r}; expected some of"
                f" {', '.join(METHODS)}{did_you_mean(word, METHODS)}"
            )
    motions = MotionSet(
        members_of(records), measure, x, method or governing_method(*structures)
    )
    exact, sweep = hazard is not None and None in limits, SweepOptions(workers=workers)
    each = list(
        studies(
            structures,
            motions,
            methods,
            how or Resampling(),
            exact=exact,
            hazard=hazard,
            sweep=sweep,
        )
    )
    found, refused = fitted(each, limits, methods)
    if not found and refused:
        raise UsageError(refused[0])
    return found


def studies(
    structures: Sequence[RockingParameters],
    motions: MotionSet,
    fits: Iterable[str],
    how: Resampling,
    *,
    sweep: SweepOptions,
    path: Path | None = None,
    exact: bool = False,
    hazard: HazardCurve | None = None,
    line: Callable[[str, str], Progress | None] = lambda name, unit: None,
) -> Iterator[Study]:
    """Yield each structure under a set of motions; sweep, path: as of `exposures`;
    exact: trace every overturning interval; line: the progress of work by its name and
    unit.
    """
    found = exposures(
        structures, motions, path, replace(sweep, progress=line("fragility", "chunks"))
    )
    for number, (s, exposure) in enumerate(zip(structures, found, strict=False), 1):
        label = (
            s.name
            if len(structures) == 1
            else f"{s.name}, {number} of {len(structures)}"
        )
        intervals = (
            traced(s, motions, sweep.workers, line(label, "motions"))
            if exact or "first" in fits
            else None
        )
        recorded = as_recorded(s, motions) if "cloud" in fits else None
        yield Study(s, motions, how, exposure, intervals, recorded, hazard)


def fitted(
    studies: Sequence[Study], limits: Iterable[float | None], methods: Iterable[str]
) -> tuple[list[Fit], list[str]]:
    """Return (the fits, a sentence on each that has too few data)."""
    found, refused = [], []
    for study, method, limit in product(studies, methods, limits):
        if (method == "first") != (limit is None) and method != "stripes":
            continue  # first is of overturning, cloud of rotations
        try:
            found.append(study.fit(method, limit))
        except UsageError as error:
            refused.append(
                f"{study.structure.name}, {word_of(limit)}, {method}: {error}"
            )
    return found, refused


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
