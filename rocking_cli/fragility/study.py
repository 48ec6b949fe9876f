"""Fragility curves of structures under a set of motions: the data of each method, and
the printed rows.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..dynamics.method import LINEAR, Method, governing_method
from ..dynamics.outcome import Outcome
from ..errors import UsageError, did_you_mean
from ..motions.given import HasMotion, recordings_from
from ..motions.intensity_measures import Measure, measure_of
from ..spectra.sweep_options import SweepOptions
from ..structures.given import Structure, structures_from
from ..structures.parameters import RockingParameters
from .bootstrap import Resampling, bootstrap, interval
from .drawn import DrawnExposure, drawn_exposure
from .estimates import Estimate, cloud, first_overturning, stripes
from .exposure import (
    Exposure,
    MotionSet,
    Range,
    StudyProgress,
    as_recorded,
    exposures,
    first_of,
    share_overturned,
    traced,
)
from .fits import FEWEST, Curve, check_levels, fit_cloud, fit_first, fit_stripes
from .fitted_curve import (
    FRAGILITY_COLUMNS,
    Fit,
    SlideLimit,
    drawn_at,
    hazard_points,
    rate_of,
    word_of,
)
from .hazard import HazardCurve, Rate
from .hazard_files import read_hazard
from .measures import MotionMember, members_of

# a curve, the estimate of samples of its records, and the points of the data
Fitted = tuple[Curve, Callable[[Array], Estimate], dict[float, float]]
METHODS = ("stripes", "first", "cloud")
LIMITS: tuple[float | None, ...] = (0.1, 0.5, 1.0, None)
CELL_COLUMNS = ("structure", "motion", "pga", "pgv_pga", "theta_ratio", "outcome")


@dataclass(frozen=True, eq=False)
class Study:
    """A structure under a set of motions."""

    structure: RockingParameters  # the one that rocks
    motions: MotionSet  # the set, its measure and its levels
    how: Resampling  # options of the bootstrap
    exposure: Exposure  # responses at the levels
    # overturning intervals of the measure for each motion, if traced
    intervals: Sequence[Sequence[Range]] | None = None
    recorded: Exposure | None = None  # responses to the unscaled motions
    hazard: HazardCurve | None = None  # the hazard curve of the site
    # responses of the draws of a structure whose numbers have spreads
    drawn: DrawnExposure | None = None

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
        if self.motions.measure.name != "PGA" or any(
            map(_is_lifted, self.motions.members)
        ):
            return 0.0
        s = self.structure
        linear = self.motions.method.model == LINEAR.model
        return s.gravity * (s.linear_uplift if linear else s.uplift)

    def fit(self, method: str, limit: float | None) -> Fit:
        """Return the fit of a limit state by a method. Raises UsageError if there are
        too few data.
        """
        if (count := len(self.motions.members)) < FEWEST:
            raise UsageError(f"{count} records; a fit needs at least {FEWEST}")
        of_method: dict[str, Callable[[float | None], Fitted]] = {
            "stripes": partial(self._stripes, self.drawn or self.exposure),
            "first": self._first,
            "cloud": self._cloud,
        }
        curve, estimate, points = of_method[method](limit)
        alone = None
        if self.drawn is not None and not self.drawn.of_class:
            # the motions alone, at the means
            alone = self._stripes(self.exposure, limit)[0].beta
        x, rates = drawn_at(self.motions.levels, self.hazard)
        band = (
            bootstrap(count, estimate, self.how, x, rates) if self.how.samples else None
        )
        rate = None if self.hazard is None else rate_of(curve, band, self.hazard)
        return Fit(
            structure=self.structure.name,
            im=self.motions.measure.name,
            limit=word_of(limit),
            method=method,
            curve=curve,
            band=band,
            x=x,
            points=points,
            hazard=self.hazard,
            rate=rate,
            rate_without_fit=self.rate_without_fit if limit is None else None,
            no_damage=self.no_damage,
            beta_motions=alone,
        )

    def _stripes(
        self, exposure: Exposure | DrawnExposure, limit: float | None
    ) -> Fitted:
        """Fit the shares of motions beyond the limit state at each level: (curve,
        estimate from resampled motions, share at each level).
        """
        known, beyond = exposure.counts(limit)
        levels, w = self.motions.levels, self.motions.weight[:, None]
        n, z = w * known, w * beyond
        points = dict(zip(levels.tolist(), (z.sum(0) / n.sum(0)).tolist(), strict=True))
        return (
            fit_stripes(levels, n.sum(0), z.sum(0)),
            lambda i: stripes(levels, n[i].sum(-2), z[i].sum(-2)),
            points,
        )

    def _first(self, limit: float | None) -> Fitted:
        """Fit the first overturning levels of the motions: (curve, estimate from
        resampled motions, share at each level).
        """
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
            fit_first(r, highest, w),
            lambda i: first_overturning(r[i], highest, w[i]),
            share,
        )

    def _cloud(self, limit: float | None) -> Fitted:
        """Fit the rotations under unscaled motions: (curve, estimate from resampled
        motions, no shares).
        """
        if limit is None or isinstance(limit, SlideLimit):
            raise UsageError(
                f"limit state {word_of(limit)}: the method cloud needs a rotation"
            )
        assert self.recorded is not None
        x, w = self.own(self.motions.measure), self.motions.weight
        theta = self.recorded.theta_ratio[:, 0]
        return (
            fit_cloud(x, theta, limit, w),
            lambda i: cloud(x[i], theta[i], limit, w[i]),
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
        hazard, w = self.hazard, self.motions.weight
        highest = min(self.highest, float(hazard.x[-1]))
        of_each = w * hazard.of_intervals(self.intervals, highest)
        low = high = None
        if self.how.samples and w.size >= FEWEST and np.ptp(of_each) > 0.0:
            ends = interval(
                w.size, lambda i: (of_each[i].sum(-1) / w[i].sum(-1))[None], self.how
            )
            low, high = (float(end[0]) if np.isfinite(end[0]) else None for end in ends)
        at_first = [
            any(a < hazard.x[0] < b for a, b in found) for found in self.intervals
        ]
        return Rate(
            annual=float(of_each.sum() / w.sum()),
            low=low,
            high=high,
            beyond=float(hazard(highest)),
            last=highest,
            first=float(w @ at_first / w.sum()),
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
    def standing_again(self) -> int:
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


def _is_lifted(member: MotionMember) -> bool:
    """True if a motion has a vertical part, or is that of a floor."""
    if member.recording:
        record = member.recording
        return record.upwards is not None or record.building is not None
    return member.motion.vertical is not None


def fragility(
    structures: Structure | Sequence[Structure],
    records: str | Path | Sequence[HasMotion | str | Path],
    levels: Sequence[float] | Array,
    im: str = "PGA",
    *,
    limits: Sequence[float | None] = LIMITS,
    methods: Sequence[str] = ("stripes",),
    method: Method | str | None = None,
    how: Resampling | None = None,
    workers: int | None = None,
    hazard: HazardCurve | str | Path | None = None,
) -> list[Fit]:
    """Return the fragility curves of structures under records, as `rocking fragility`
    does.

    Parameters
    ----------
    structures
        one or more: parameters, documents, paths, or texts such as "block:0.5x2"
    records
        the records, each scaled to every level: those of `load_records`, or the path of
        a folder, or paths
    levels
        levels of the measure [SI], positive and rising, (k,)
    im
        the intensity measure: "PGA", "PGV", "SA(1.0)" and others of
        `rocking help fragility`
    limits
        limit states: values of |theta|/alpha [-], None for overturning
    methods
        some of "stripes", "first" and "cloud"
    method
        the equation of motion or its name, such as "linear"; None for the nonlinear one
        if all geometries are known
    how
        options of the bootstrap, None for 1000 samples
    workers
        number of processes, None for all cores
    hazard
        a hazard curve of the same measure, or the path of its file, for annual rates

    Returns
    -------
    list of Fit
        a limit state with too few data is left out

    Raises
    ------
    UsageError
        for bad levels or another measure, and if no fit is left

    Examples
    --------
    >>> from dataclasses import replace
    >>> record = read_record("configs/motions/synthetic.at2")
    >>> slower = [replace(record, dt=k * record.dt) for k in (0.5, 0.7, 1.0, 1.4, 2.0)]
    >>> how = Resampling(samples=50)
    >>> (fit,) = fragility("block:0.5x2", slower, [2, 4, 6], limits=[None], how=how)
    >>> f"median {fit.curve.median:.2f} m/s2, beta {fit.curve.beta:.2f}"
    'median 5.33 m/s2, beta 0.69'
    """
    bodies = structures_from(structures)
    measure, x = measure_of(im), check_levels(np.asarray(levels, dtype=float))
    if isinstance(hazard, str | Path):
        hazard = read_hazard(hazard, im)
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
        members_of(recordings_from(records)),
        measure,
        x,
        Method.of(method or governing_method(*bodies)),
    )
    exact, sweep = hazard is not None and None in limits, SweepOptions(workers=workers)
    each = list(
        studies(
            bodies,
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
    methods: Iterable[str],
    how: Resampling,
    *,
    sweep: SweepOptions,
    path: Path | None = None,
    exact: bool = False,
    hazard: HazardCurve | None = None,
    line: Callable[[str, str], StudyProgress | None] = lambda name, unit: None,
    draws: tuple[int, int] | None = None,
) -> Iterator[Study]:
    """Yield each structure under a set of motions; sweep, path: as of `exposures`;
    exact: trace every overturning interval; line: the progress of work by its name and
    unit; draws: their number for each motion and their seed, of structures whose
    numbers have spreads.
    """
    structures = list(structures)
    found = exposures(
        structures, motions, path, replace(sweep, progress=line("fragility", "chunks"))
    )
    if not found:
        return
    every: list[Sequence[Sequence[Range]] | None] = [None] * len(structures)
    if exact or "first" in methods:
        several = len(structures) > 1
        told = (
            line(f"{len(structures)} structures", "searches")
            if several
            else line(structures[0].name, "motions")
        )
        every = list(traced(structures, motions, sweep.workers, told))
    for number, (s, exposure, intervals) in enumerate(
        zip(structures, found, every, strict=True), 1
    ):
        recorded = as_recorded(s, motions) if "cloud" in methods else None
        drawn = None
        if draws is not None and s.drawn_from is not None:
            label = (
                s.name
                if len(structures) == 1
                else f"{s.name}, {number} of {len(structures)}"
            )
            drawn = drawn_exposure(s, motions, *draws, line(label, "motions"))
        yield Study(s, motions, how, exposure, intervals, recorded, hazard, drawn)


def of_classes(studies: Sequence[Study], label: str) -> list[Study]:
    """Return a study of each class of structures, those with one value of a label,
    under its name; its shares are means over its structures. Raises UsageError if no
    structure has the label.
    """
    known = dict.fromkeys(key for one in studies for key in one.structure.labels)
    if label not in known:
        raise UsageError(
            f"`by`: found {label!r}{did_you_mean(label, known)}; expected a column of"
            f" the table that is no key: {', '.join(known) or 'it has none'}"
        )
    classes: dict[str, list[Study]] = {}
    for one in studies:
        value = str(one.structure.labels.get(label, ""))
        classes.setdefault(value or f"no {label}", []).append(one)
    return [_of_class(name, own) for name, own in classes.items()]


def _of_class(name: str, studies: Sequence[Study]) -> Study:
    """Return the study of a class; the structure that lifts first stands for it."""
    theta_ratio, outcome = (
        np.stack([getattr(one.exposure, key) for one in studies], axis=2)
        for key in ("theta_ratio", "outcome")
    )
    made = np.ones((outcome.shape[0], len(studies)), dtype=bool)
    first = min(studies, key=lambda one: one.no_damage)
    return replace(
        first,
        structure=replace(first.structure, name=name),
        drawn=DrawnExposure(theta_ratio, outcome, made, of_class=True),
    )


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
