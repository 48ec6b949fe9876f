"""Estimates of fragility curves, P(x) = Phi(ln(x/median)/beta) at the intensity x: from
counts at levels (stripes, Baker 2015), from the intensities of first overturning (a
record that never overturns the body is censored), or from rotations under unscaled
records (cloud). They take arrays of many samples at once, (..., k), so that a bootstrap
is one call.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

Estimate = tuple[Array, Array]  # ln of the median, and beta, each (...)

LEAST = 1e-4  # data with a dispersion below this count as data without scatter
MOST = 1e3  # the largest dispersion
# largest change of the argument of Phi in one step of Newton's method; the slope
# changes by half at most
_LONGEST_STEP = 2.0


@dataclass(frozen=True)
class _Sample:
    """Capacities of records, each known exactly or only to be below or above a level.

    With u = start + slope y, its likelihood is the sum of below ln Phi(u) and above ln
    Phi(-u), and over the exact records of ln slope - u^2/2.
    """

    y: Array  # ln of the levels [-], (..., k)
    below: Array  # weight of the records known to be below each y [-], (..., k)
    above: Array  # weight of the records known to be above each y [-], (..., k)
    exact: Array | float = 0.0  # sum of the weights of exact records [-], (...)
    first: Array | float = 0.0  # sum of weight y of exact records [-], (...)
    second: Array | float = 0.0  # sum of weight y^2 of exact records [-], (...)

    def derivatives(self, start: Array, slope: Array) -> tuple[Estimate, list[Array]]:
        """Return (the gradient of the likelihood by start and slope, the elements 00,
        01 and 11 of its negative second derivative).
        """
        from scipy.special import log_ndtr

        y, below, above = self.y, self.below, self.above
        u = start[..., None] + slope[..., None] * y
        # up = phi(u)/Phi(u), down = phi(u)/Phi(-u)
        log_density = -0.5 * u * u - 0.5 * np.log(2.0 * np.pi)
        up = np.exp(log_density - log_ndtr(u))
        down = np.exp(log_density - log_ndtr(-u))
        pull = below * up - above * down
        weight = below * up * (u + up) + above * down * (down - u)

        exact, first, second = self.exact, self.first, self.second
        gradient = (
            pull.sum(-1) - exact * start - first * slope,
            (pull * y).sum(-1) - first * start - second * slope + exact / slope,
        )
        curvature = [
            weight.sum(-1) + exact,
            (weight * y).sum(-1) + first,
            (weight * y * y).sum(-1) + second + exact / slope**2,
        ]
        return gradient, curvature


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
    slope = np.full(z.shape[:-1], 1.0 / max(float(y.std()), 1e-3))
    centre, beta = _likeliest(start, slope, _Sample(y, z, n - z))
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
    middle = float(y_limit.mean())
    mean, spread = _centred_first_overturning(r, y_limit, middle, w)
    mean = np.clip(np.nan_to_num(mean, nan=9.0), -9.0, 9.0)
    return middle + mean, np.clip(np.nan_to_num(spread, nan=MOST), LEAST, MOST)


def _centred_first_overturning(
    r: Array, y_limit: Array, middle: float, weight: Array
) -> Estimate:
    """Return (the mean of ln r less `middle`, the dispersion) of first overturnings r;
    NaN where no record overturns the body. y_limit: ln of the highest intensity.
    """
    overturned = np.isfinite(r)
    y_limit = y_limit - middle
    y = np.where(overturned, np.log(np.where(overturned, r, 1.0)) - middle, 0.0)
    exact, first, second = (
        (np.where(overturned, weight, 0.0) * y**power).sum(-1) for power in (0, 1, 2)
    )
    standing = np.where(overturned, 0.0, weight)
    with np.errstate(all="ignore"):
        # closed form where every record overturns the body, else the start
        count = overturned.sum(-1)
        mean = first / exact
        variance = np.maximum(second / exact - mean * mean, 0.0)
        spread = np.sqrt(variance * count / np.maximum(count - 1, 1))
        if not np.any(standing > 0.0):
            return mean, spread
        slope = 1.0 / np.clip(np.nan_to_num(spread, nan=1.0), 0.05, 5.0)
        none = np.zeros_like(standing)
        sample = _Sample(y_limit, none, standing, exact, first, second)
        found = _likeliest(-np.nan_to_num(mean) * slope, slope, sample)
        every = ~np.any(standing > 0.0, axis=-1)
        return np.where(every, mean, found[0]), np.where(every, spread, found[1])


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
        y0 = (w * y).sum(-1, keepdims=True) / total
        e0 = (w * e).sum(-1, keepdims=True) / total
        b = (w * (y - y0) * (e - e0)).sum(-1) / (w * (y - y0) ** 2).sum(-1)
        rest = e - e0 - b[..., None] * (y - y0)
        count = there.sum(-1)
        sigma = np.sqrt(
            (w * rest**2).sum(-1) / total[..., 0] * count / np.maximum(count - 2, 1)
        )
        middle = y0[..., 0] + (np.log(limit) - e0[..., 0]) / b
        beta = sigma / b
    middle = np.clip(np.nan_to_num(middle, nan=0.0), y.min() - 9.0, y.max() + 9.0)
    beta = np.where(beta > 0.0, beta, MOST)
    return middle, np.clip(beta, LEAST, MOST)


def _likeliest(start: Array, slope: Array, sample: _Sample) -> Estimate:
    """Return the (mu, beta) of largest likelihood, by Newton's method in slope = 1/beta
    and start = -mu/beta (Olsen 1978).
    """
    for _ in range(200):
        d0, d1 = _newton_step(start, slope, sample)
        # The step is shortened so that no u changes by more than _LONGEST_STEP.
        largest = np.maximum(
            np.abs(d0[..., None] + d1[..., None] * sample.y).max(axis=-1),
            np.where(sample.exact, 2.0 * _LONGEST_STEP * np.abs(d1) / slope, 0.0),
        )
        share = np.minimum(1.0, _LONGEST_STEP / np.maximum(largest, 1e-300))
        start = start + share * d0
        slope = np.clip(slope + share * d1, 1.0 / MOST, 1.0 / LEAST)
        if largest.max() < 1e-13:
            break
    return -start / slope, 1.0 / slope


def _newton_step(start: Array, slope: Array, sample: _Sample) -> list[Array]:
    """Return the changes of start (-mu/beta) and slope (1/beta) in a full step of
    Newton's method for the likelihood; zero where the likelihood is not concave.
    """
    (g0, g1), (h00, h01, h11) = sample.derivatives(start, slope)
    with np.errstate(all="ignore"):
        det = h00 * h11 - h01 * h01
        steps = ((h11 * g0 - h01 * g1) / det, (h00 * g1 - h01 * g0) / det)
    return [np.where(det > 0.0, np.nan_to_num(step), 0.0) for step in steps]
