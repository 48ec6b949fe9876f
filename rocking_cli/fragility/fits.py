"""Fits of fragility curves, P(x) = Phi(ln(x/median)/beta) at the intensity x: to counts
at levels (stripes, Baker 2015), to the intensities of first overturning (a record that
never overturns the body is censored), or to rotations under unscaled records (cloud).
The fits take arrays of many samples at once, (..., k), so that a bootstrap is one call.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arguments import check_fields
from ..errors import UsageError, counted

Array = np.ndarray
Estimate = tuple[Array, Array]  # ln of the median, and beta, each (...)

LEAST = 1e-4  # data with a dispersion below this count as data without scatter
MOST = 1e3
FEWEST = 4  # least number of records for a fit
# largest change of the argument of Phi in one step of Newton's method; the slope
# changes by half at most
_STRIDE = 2.0


@dataclass(frozen=True)
class Curve:
    """A fragility curve: a lognormal distribution of the capacity.

    P(x) = Phi(ln(x/median)/beta). `fit_stripes`, `fit_first` and `fit_cloud` return
    one.

    Attributes
    ----------
    median: in the unit of the intensity measure
    beta: dispersion [-]
    n: number of records

    Examples
    --------
    >>> curve = Curve(median=0.43, beta=0.35, n=54)
    >>> curve.median, curve.beta
    (0.43, 0.35)
    """

    median: float  # in the unit of the intensity measure
    beta: float  # dispersion [-]
    n: float  # number of records

    def __call__(self, x: Array | float) -> Array:
        """Return the probability at intensities x, in the shape of x."""
        from scipy.special import ndtr

        with np.errstate(divide="ignore"):
            return np.asarray(
                ndtr(np.log(np.asarray(x, dtype=float) / self.median) / self.beta)
            )


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


def stripes(x: Array, n: Array, z: Array) -> Estimate:
    """Return the maximum-likelihood curve of counts: z of n beyond the limit state at
    each level x, (k,); n, z: (..., k), or weights.

    Maximises sum z ln Phi(u) + (n - z) ln Phi(-u), u = ln(x/median)/beta (Baker 2015,
    Eq. 11). If the counts do not rise, beta is its upper bound; if they change from
    none to all, its lower bound.
    """
    from scipy.special import ndtri

    n, z = np.broadcast_arrays(np.asarray(n, dtype=float), np.asarray(z, dtype=float))
    y = np.log(np.asarray(x, dtype=float))
    middle = y.mean()
    y = y - middle
    start = np.asarray(ndtri((z.sum(axis=-1) + 0.5) / (n.sum(axis=-1) + 1.0)))
    centre, beta = _likeliest(
        start, np.full(z.shape[:-1], 1.0 / max(float(y.std()), 1e-3)), y, z, n - z
    )
    reach = 3.0 * (np.ptp(y) + 1.0)
    return middle + np.clip(centre, y.min() - reach, y.max() + reach), beta


def first_overturning(
    r: Array, limit: Array | float, weight: Array | None = None
) -> Estimate:
    """Return the curve of the intensities r at which records first overturn the body;
    NaN or infinite for a record without overturning.

    r: (..., k); limit: the highest intensity computed; both it and weight of the same
    shape or one number. If all records overturn the body, the median is exp(mean ln r)
    and beta is the standard deviation of ln r with k - 1. Otherwise the curve maximises
    sum [ln phi(u) - ln beta] + sum ln(1 - Phi(u_limit)), the second sum over the
    records without overturning.
    """
    r = np.asarray(r, dtype=float)
    y_limit, w = (
        np.broadcast_to(np.asarray(x, dtype=float), r.shape)
        for x in (np.log(limit), 1.0 if weight is None else weight)
    )
    falls = np.isfinite(r)
    middle = float(y_limit.mean())
    y, y_limit = (
        np.where(falls, np.log(np.where(falls, r, 1.0)) - middle, 0.0),
        y_limit - middle,
    )
    m, first, second = (
        (np.where(falls, w, 0.0) * y**power).sum(-1) for power in (0, 1, 2)
    )
    spared = np.where(falls, 0.0, w)
    count = falls.sum(-1)
    with np.errstate(all="ignore"):
        mean = first / m
        spread = np.sqrt(
            np.maximum(second / m - mean * mean, 0.0) * count / np.maximum(count - 1, 1)
        )
        if np.any(spared > 0.0):
            slope = 1.0 / np.clip(np.nan_to_num(spread, nan=1.0), 0.05, 5.0)
            found = _likeliest(
                -np.nan_to_num(mean) * slope,
                slope,
                y_limit,
                np.zeros_like(spared),
                spared,
                m,
                first,
                second,
            )
            every = ~np.any(spared > 0.0, axis=-1)
            mean, spread = (
                np.where(every, mean, found[0]),
                np.where(every, spread, found[1]),
            )
    return middle + np.clip(np.nan_to_num(mean, nan=9.0), -9.0, 9.0), np.clip(
        np.nan_to_num(spread, nan=MOST), LEAST, MOST
    )


def _likeliest(
    start: Array,
    slope: Array,
    y: Array,
    below: Array,
    above: Array,
    m: Array | float = 0.0,
    first: Array | float = 0.0,
    second: Array | float = 0.0,
) -> Estimate:
    """Return the (mu, beta) of largest likelihood, by Newton's method in slope = 1/beta
    and start = -mu/beta (Olsen 1978).
    """
    # below, above: weights of records known to be below and above each y, (..., k); m,
    # first, second: sums of weight, y, y^2 of exact ones. With u = start + slope y
    # maximise the sum of below ln Phi(u) + above ln Phi(-u), and over the exact records
    # of ln slope - u^2/2.
    from scipy.special import log_ndtr

    for _ in range(200):
        u = start[..., None] + slope[..., None] * y
        log_density = -0.5 * u * u - 0.5 * np.log(2.0 * np.pi)
        up, down = np.exp(log_density - log_ndtr(u)), np.exp(log_density - log_ndtr(-u))
        pull, weight = (
            below * up - above * down,
            below * up * (u + up) + above * down * (down - u),
        )
        g0, g1 = (
            pull.sum(-1) - m * start - first * slope,
            (pull * y).sum(-1) - first * start - second * slope + m / slope,
        )
        h00, h01, h11 = (
            weight.sum(-1) + m,
            (weight * y).sum(-1) + first,
            (weight * y * y).sum(-1) + second + m / slope**2,
        )
        with np.errstate(all="ignore"):
            det = h00 * h11 - h01 * h01
            steps = ((h11 * g0 - h01 * g1) / det, (h00 * g1 - h01 * g0) / det)
        d0, d1 = (np.where(det > 0.0, np.nan_to_num(step), 0.0) for step in steps)
        largest = np.maximum(
            np.abs(d0[..., None] + d1[..., None] * y).max(axis=-1),
            np.where(m, 2.0 * _STRIDE * np.abs(d1) / slope, 0.0),
        )
        share = np.minimum(1.0, _STRIDE / np.maximum(largest, 1e-300))
        start, slope = (
            start + share * d0,
            np.clip(slope + share * d1, 1.0 / MOST, 1.0 / LEAST),
        )
        if largest.max() < 1e-13:
            break
    return -start / slope, 1.0 / slope


def cloud(
    x: Array, theta_ratio: Array, limit: float, weight: Array | None = None
) -> Estimate:
    """Return the curve for |theta|/alpha > `limit` from the regression
    ln(theta_max/alpha) = a + b ln x + sigma e over unscaled records.

    x, theta_ratio: (..., k); records without a positive finite rotation are left out.
    median = exp((ln limit - a)/b), beta = sigma/b, sigma with k - 2.
    """
    x, rotation = np.broadcast_arrays(
        np.asarray(x, dtype=float), np.asarray(theta_ratio, dtype=float)
    )
    there = np.isfinite(rotation) & (rotation > 0.0)
    w = there * (
        1.0
        if weight is None
        else np.broadcast_to(np.asarray(weight, dtype=float), x.shape)
    )
    y, e = np.log(x), np.log(np.where(there, rotation, 1.0))
    with np.errstate(all="ignore"):
        total = w.sum(-1, keepdims=True)
        y0, e0 = (
            (w * y).sum(-1, keepdims=True) / total,
            (w * e).sum(-1, keepdims=True) / total,
        )
        b = (w * (y - y0) * (e - e0)).sum(-1) / (w * (y - y0) ** 2).sum(-1)
        rest = e - e0 - b[..., None] * (y - y0)
        count = there.sum(-1)
        sigma = np.sqrt(
            (w * rest**2).sum(-1) / total[..., 0] * count / np.maximum(count - 2, 1)
        )
        middle, beta = y0[..., 0] + (np.log(limit) - e0[..., 0]) / b, sigma / b
    beta = np.where(beta > 0.0, beta, MOST)
    return np.clip(
        np.nan_to_num(middle, nan=0.0), y.min() - 9.0, y.max() + 9.0
    ), np.clip(beta, LEAST, MOST)


def check_levels(x: Array) -> Array:
    """Return the levels as an array. Raises UsageError unless they are positive and
    rise.
    """
    x = np.asarray(x, dtype=float)
    if (
        x.ndim != 1
        or x.size < 2
        or not np.all(np.isfinite(x))
        or not x[0] > 0.0
        or np.any(np.diff(x) <= 0.0)
    ):
        raise UsageError("levels: expected two or more, positive and rising")
    return x


def fit_stripes(x: Array, n: Array, z: Array) -> Curve:
    """Return the curve of counts at some levels, by maximum likelihood.

    Parameters
    ----------
    x
        levels of the intensity measure, positive and rising, (k,)
    n
        number of records at each level, (k,)
    z
        how many of them are beyond the limit state, (k,)

    Returns
    -------
    Curve
        median in the unit of `x`

    Raises
    ------
    UsageError
        unless at two levels some records are beyond the limit state and some are not,
        and their share rises

    Examples
    --------
    >>> curve = fit_stripes([1.0, 1.5, 2.0], [54, 54, 54], [2, 25, 43])
    >>> round(curve.median, 5), round(curve.beta, 5)
    (1.57248, 0.27003)
    """
    x, n, z = check_levels(x), np.asarray(n, dtype=float), np.asarray(z, dtype=float)
    if (
        not x.shape == n.shape == z.shape
        or np.any(n <= 0.0)
        or np.any(z < 0.0)
        or np.any(z > n)
    ):
        raise UsageError("counts: expected n above 0 and z from 0 to n at every level")
    some = int(np.count_nonzero((z > 0.0) & (z < n)))
    if some < 2:
        raise UsageError(
            f"{counted(some, 'level')} with some records beyond the limit state and"
            " some not; a fit needs two"
        )
    return fit_cells(x, n, z)


def fit_cells(x: Array, n: Array, z: Array) -> Curve:
    """Return the curve of cells of weight n at any x, z of it beyond the limit state.
    Raises UsageError if the share does not rise.
    """
    return _curve(
        stripes(x, n, z),
        np.max(n),
        "the share beyond the limit state does not rise with the levels; a fit",
    )


def _curve(estimate: Estimate, n: float, flat: str = "") -> Curve:
    centre, beta = map(float, estimate)
    if flat and beta >= 0.99 * MOST:
        raise UsageError(f"{flat} needs one that does")
    return Curve(float(np.exp(centre)), beta, float(n))


def fit_first(r: Array, limit: Array | float, weight: Array | None = None) -> Curve:
    """Return the curve of the intensities at which records first overturn a body.

    Parameters
    ----------
    r
        intensity of each record, NaN without overturning up to `limit`, (k,)
    limit
        highest intensity that was computed, one or (k,)
    weight
        weights of the records, (k,), None for equal ones

    Returns
    -------
    Curve
        median in the unit of `r`

    Raises
    ------
    UsageError
        for fewer than four records that overturn the body

    Notes
    -----
    If all records overturn the body, the median is exp(mean ln r) and beta the standard
    deviation of ln r with k - 1. Otherwise the likelihood counts records without
    overturning as 1 - Phi at `limit`.

    Examples
    --------
    >>> curve = fit_first([0.2, 0.3, 0.4, 0.5], 1.0)
    >>> round(curve.median, 4), round(curve.beta, 4)
    (0.331, 0.3956)
    """
    falls = int(np.count_nonzero(np.isfinite(r)))
    if falls < FEWEST:
        raise UsageError(
            f"{falls} of {np.size(r)} records overturn the body; a fit of first"
            f" overturnings needs at least {FEWEST}"
        )
    return _curve(first_overturning(r, limit, weight), np.size(r))


def fit_cloud(
    x: Array, theta_ratio: Array, limit: float, weight: Array | None = None
) -> Curve:
    """Return the curve of a regression of unscaled rotations on an intensity measure.

    Parameters
    ----------
    x
        intensity of each record, (k,)
    theta_ratio
        |theta|/alpha under each record [-], NaN where it overturned, (k,)
    limit
        |theta|/alpha of the limit state [-]
    weight
        weights of the records, (k,), None for equal ones

    Returns
    -------
    Curve
        median in the unit of `x`

    Raises
    ------
    UsageError
        for too few rotations, or if they do not grow with x

    Examples
    --------
    >>> curve = fit_cloud([1.0, 2.0, 3.0, 4.0], [0.1, 0.25, 0.3, 0.45], 0.5)
    >>> round(curve.median, 4), round(curve.beta, 4)
    (4.4542, 0.1223)
    """
    there = int(
        np.count_nonzero(np.isfinite(theta_ratio) & (np.asarray(theta_ratio) > 0.0))
    )
    if there < FEWEST:
        raise UsageError(
            f"{there} of {np.size(x)} records rock the body without overturning; a"
            f" regression needs at least {FEWEST}"
        )
    return _curve(
        cloud(x, theta_ratio, limit, weight),
        there,
        "the rotation does not grow with the intensity measure; a regression",
    )


@dataclass(frozen=True)
class Resampling:
    """Options of the bootstrap that gives the bands of `fragility`.

    Raises ArgumentError for a field of another type.

    Attributes
    ----------
    samples: their number, 0 for no band
    seed: of the random numbers
    level: of confidence [-]

    Examples
    --------
    >>> Resampling(samples=200, seed=1).level
    0.95
    """

    samples: int = 1000  # their number, 0 for no band
    seed: int = 0  # of the random numbers
    level: float = 0.95  # of confidence [-]

    def __post_init__(self) -> None:
        check_fields(self)


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

    with (
        warnings.catch_warnings(),
        np.errstate(divide="ignore", invalid="ignore"),
    ):  # if all samples are on one side of the estimate
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        found = stats.bootstrap(
            (np.arange(records),),
            of,
            n_resamples=how.samples,
            batch=max(1, 2_000_000 // (32 * records)),
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
    draws = random.binomial(
        whole, np.asarray(z, dtype=float) / n, size=(how.samples, np.size(n))
    )
    tail = 0.5 * (1.0 - how.level)
    low, high = np.quantile(
        _drawn(stripes(levels, whole, draws), x, rate), [tail, 1.0 - tail], axis=-1
    )
    return _band(low, high, rated=rate is not None)


def _drawn(
    estimate: Estimate,
    x: Array | None,
    rate: Callable[[Array, Array], Array] | None = None,
) -> Array:
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
