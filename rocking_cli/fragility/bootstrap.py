"""Confidence bands of fragility curves: the bootstrap over records, or over counts."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arguments import check_fields
from ..arrays import Array
from .estimates import Estimate, stripes


@dataclass(frozen=True)
class Resampling:
    """Options of the bootstrap that gives the bands of `fragility`.

    Raises ArgumentError for a field of another type.

    Attributes
    ----------
    samples: number of samples, 0 for no band
    seed: of the random numbers
    level: of confidence [-]

    Examples
    --------
    >>> Resampling(samples=200, seed=1).level
    0.95
    """

    samples: int = 1000  # number of samples, 0 for no band
    seed: int = 0  # of the random numbers
    level: float = 0.95  # level of confidence [-]

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Band:
    """A confidence band of a curve."""

    median_low: float  # lower end of the median [SI]
    median_high: float  # upper end of the median [SI]
    beta_low: float  # lower end of the dispersion [-]
    beta_high: float  # upper end of the dispersion [-]
    low: Array  # lower end of the probability at some intensities [-], (k,)
    high: Array  # upper end of the probability at some intensities [-], (k,)
    rate: tuple[float, float] | None = None  # (low, high) of the annual rate [1/year]


def bootstrap(
    records: int,
    estimate: Callable[[Array], Estimate],
    how: Resampling,
    x: Array | None = None,
    rate: Callable[[Array, Array], Array] | None = None,
) -> Band | None:
    """Return the band of an estimate over resampled records (see `interval`), None if
    the samples do not vary.

    estimate: from indices of records, (..., records), to curves; x: intensities of the
    band; rate: from ln median and beta to a rate.
    """
    return _band(
        *interval(records, lambda index: _drawn(estimate(index), x, rate), how),
        rated=rate is not None,
    )


def interval(
    records: int, statistic: Callable[[Array], Array], how: Resampling
) -> tuple[Array, Array]:
    """Return the lower and upper ends of statistics over resampled records, (k,) each,
    bias-corrected and accelerated.

    Samples of few records vary too little, so the level is widened from the normal to
    Student's t, and by the root of n/(n - 1) (Hesterberg 2015, section 3.6). statistic:
    from indices of records, (..., records), to numbers, (k, ...); NaN if they do not
    vary.
    """
    import warnings

    from scipy import stats

    quantile = stats.t.ppf(0.5 * (1.0 - how.level), records - 1) * np.sqrt(
        records / (records - 1.0)
    )

    def of(index: Array, axis: int = -1) -> Array:
        return statistic(np.moveaxis(np.asarray(index, dtype=np.int64), axis, -1))

    # SciPy warns if all samples are on one side of the estimate.
    with (
        warnings.catch_warnings(),
        np.errstate(divide="ignore", invalid="ignore"),
    ):
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        found = stats.bootstrap(
            (np.arange(records),),
            of,
            n_resamples=how.samples,
            batch=_at_once(records),
            vectorized=True,
            confidence_level=1.0 - 2.0 * float(stats.norm.cdf(quantile)),
            method="BCa",
            random_state=np.random.default_rng(how.seed),
        ).confidence_interval
    return np.asarray(found.low), np.asarray(found.high)


def bootstrap_counts(
    levels: Array,
    n: Array,
    z: Array,
    how: Resampling,
    x: Array | None = None,
    rate: Callable[[Array, Array], Array] | None = None,
) -> Band | None:
    """Return the band of given counts: those of each level are drawn independently. x,
    rate: as in `bootstrap`.
    """
    random = np.random.default_rng(how.seed)
    whole = np.rint(np.asarray(n)).astype(np.int64)
    share, most = np.asarray(z, dtype=float) / n, _at_once(np.size(n))
    estimates = []
    for begin in range(0, how.samples, most):
        count = min(most, how.samples - begin)
        draws = random.binomial(whole, share, size=(count, whole.size))
        estimates.append(stripes(levels, whole, draws))
    centre, beta = (np.concatenate(one) for one in zip(*estimates, strict=True))

    tail = 0.5 * (1.0 - how.level)
    tails = [tail, 1.0 - tail]
    ends = [np.quantile(_drawn((centre, beta), None, rate), tails, axis=-1)]
    most, points = _at_once(how.samples), np.zeros(0) if x is None else x
    for begin in range(0, np.size(points), most):
        scores = _drawn((centre, beta), points[begin : begin + most])[2:]
        ends.append(np.quantile(scores, tails, axis=-1))
    low, high = np.concatenate(ends, axis=-1)
    return _band(low, high, rated=rate is not None)


def _at_once(size: int) -> int:
    """Return how many samples of so many numbers are estimated together."""
    return max(1, 2_000_000 // (32 * size))


def _drawn(
    estimate: Estimate,
    x: Array | None,
    rate: Callable[[Array, Array], Array] | None = None,
) -> Array:
    """Return the numbers of resampled curves, (numbers, samples): ln median, beta, the
    rate if wanted, and the standard score at each intensity x.
    """
    centre, beta = estimate
    rates = [] if rate is None else [rate(centre, beta)]
    return np.stack(
        [
            centre,
            beta,
            *rates,
            *((np.log(value) - centre) / beta for value in ([] if x is None else x)),
        ]
    )


def _band(low: Array, high: Array, rated: bool = False) -> Band | None:
    """Return the band from the low and the high ends of the numbers of `_drawn`, None
    if one of them is not finite; rated: True if the rate is among them.
    """
    from scipy.special import ndtr

    rate = (
        (float(low[2]), float(high[2]))
        if rated and np.isfinite(low[2] + high[2])
        else None
    )
    low, high = (np.delete(end, 2) if rated else end for end in (low, high))
    if not (np.all(np.isfinite(low)) and np.all(np.isfinite(high))):
        return None
    median = np.exp([low[0], high[0]])
    return Band(
        float(median[0]),
        float(median[1]),
        float(low[1]),
        float(high[1]),
        ndtr(low[2:]),
        ndtr(high[2:]),
        rate,
    )
