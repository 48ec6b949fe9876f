"""Fragility fits: published counts, an independent optimiser, and data of known median
and dispersion.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import norm
from support.refusals import refuses

from rocking_cli import UsageError
from rocking_cli.fragility.bootstrap import Resampling, bootstrap, bootstrap_counts
from rocking_cli.fragility.estimates import LEAST, cloud, first_overturning, stripes
from rocking_cli.fragility.fits import fit_cloud, fit_first, fit_stripes

LEVELS = np.array([0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0])
COUNTS = np.array([0, 0, 0, 4, 6, 13, 12, 16])
MEDIAN, DISPERSION = 0.5, 0.4


def likeliest(loss):
    """exp of the first and of the second parameter at the least loss, by the simplex
    method.
    """
    found = minimize(
        loss,
        [0.0, -0.5],
        method="Nelder-Mead",
        options={"xatol": 1e-11, "fatol": 1e-13, "maxiter": 4000, "maxfev": 4000},
    )
    return np.exp(found.x)


@pytest.mark.requirement(
    "A fragility curve is the most likely lognormal of the counts",
    "fragility/fits.py",
    "Fragility of counts",
)
@pytest.mark.parametrize(
    ("x", "n", "z", "theta", "beta"),
    [
        (LEVELS, 40, COUNTS, 1.0761158, 0.4292372),
        (np.array([1.0, 1.5, 2.0]), 54, np.array([2, 25, 43]), 1.5724765, 0.2700332),
    ],
    ids=["Baker 2015", "three levels"],
)
def test_counts_of_the_literature(x, n, z, theta, beta):
    curve = fit_stripes(x, np.full(x.size, n), z)
    assert (curve.median, curve.beta, curve.n) == (
        pytest.approx(theta, abs=5.1e-8),
        pytest.approx(beta, abs=5.1e-8),
        n,
    )
    assert curve(curve.median) == pytest.approx(0.5, abs=1e-15)
    assert curve(curve.median * np.exp(1.5 * curve.beta)) == pytest.approx(
        norm.cdf(1.5), rel=1e-13
    )


def test_first_overturnings_without_censoring_are_a_mean_and_a_standard_deviation():
    r = np.random.default_rng(5).lognormal(np.log(MEDIAN), DISPERSION, 30)
    curve = fit_first(r, 10.0)
    assert (curve.median, curve.beta) == pytest.approx(
        (np.exp(np.log(r).mean()), np.log(r).std(ddof=1)), rel=1e-12, abs=0
    )


@pytest.mark.parametrize("alike", [True, False])
def test_first_overturnings_with_censoring_are_the_most_likely_by_another_optimiser(
    alike,
):
    random = np.random.default_rng(6)
    r = random.lognormal(np.log(MEDIAN), DISPERSION, 50)
    limit = np.full(50, 0.6) if alike else random.uniform(0.3, 0.9, 50)
    falls = r <= limit

    def loss(q):
        u = (np.log(np.where(falls, r, limit)) - q[0]) / np.exp(q[1])
        return -np.where(falls, norm.logpdf(u) - q[1], norm.logsf(u)).sum()

    curve = fit_first(np.where(falls, r, np.nan), limit)
    assert (curve.median, curve.beta) == pytest.approx(
        tuple(likeliest(loss)), rel=3e-7, abs=0
    )


def test_a_cloud_is_a_line_in_logarithms():
    random = np.random.default_rng(7)
    x = random.lognormal(0.0, 0.5, 25)
    y = np.exp(-0.3 + 1.4 * np.log(x) + 0.3 * random.standard_normal(25))
    b, a = np.polyfit(np.log(x), np.log(y), 1)
    sigma = np.sqrt(((np.log(y) - a - b * np.log(x)) ** 2).sum() / 23)
    curve = fit_cloud(np.append(x, [2.0, 0.1]), np.append(y, [np.nan, 0.0]), 0.5)
    assert (curve.median, curve.beta, curve.n) == pytest.approx(
        (np.exp((np.log(0.5) - a) / b), sigma / b, 25), rel=1e-11, abs=0
    )


def test_weights_count_as_repetitions():
    random = np.random.default_rng(8)
    r, x, y = (random.lognormal(0.0, 0.4, 12) for _ in range(3))
    twice = np.where(np.arange(12) < 5, 2.0, 1.0)
    spared = np.where(r > 1.2, np.nan, r)
    again = np.append(spared, spared[:5])
    assert np.allclose(
        first_overturning(spared, 1.2, twice),
        first_overturning(again, 1.2),
        rtol=1e-10,
        atol=0,
    )
    line = [
        cloud(a, b, 0.5, w)[0]
        for a, b, w in ((x, y, twice), (np.append(x, x[:5]), np.append(y, y[:5]), None))
    ]
    assert line[0] == pytest.approx(line[1], rel=1e-10)


def test_counts_that_part_at_one_level_have_no_dispersion():
    centre, beta = stripes(
        np.array([1.0, 2.0, 3.0]), np.full(3, 10.0), np.array([0.0, 0.0, 10.0])
    )
    assert np.log(2.0) < centre < np.log(3.0)
    assert beta < 0.1
    assert first_overturning(np.full(6, 2.0), 3.0)[1] == LEAST


REFUSED = [
    (
        lambda: fit_stripes(LEVELS[::-1], np.full(8, 40), COUNTS),
        "levels: expected two or more, positive and rising",
    ),
    (
        lambda: fit_stripes(LEVELS[:4], np.full(4, 40), COUNTS[:4]),
        "1 level with some records beyond",
    ),
    (lambda: fit_stripes(LEVELS, np.full(8, 10), COUNTS), "z from 0 to n"),
    (
        lambda: fit_stripes(LEVELS, np.full(8, 40), COUNTS[::-1]),
        "does not rise with the levels",
    ),
    (
        lambda: fit_first(np.array([1.0, 2.0, 3.0, np.nan]), 4.0),
        "3 of 4 records overturn",
    ),
    (
        lambda: fit_cloud(np.ones(5), np.array([0.1, 0.2, 0.3, np.nan, 0.0]), 0.5),
        "3 of 5 records rock the body",
    ),
    (
        lambda: fit_cloud(
            np.array([4.0, 3.0, 2.0, 1.0]), np.array([0.1, 0.2, 0.3, 0.4]), 0.5
        ),
        "does not grow",
    ),
]
test_what_the_data_do_not_bear_is_refused = refuses(
    lambda call: call(), UsageError, REFUSED
)


def test_bands_follow_from_their_seed_and_hold_the_estimate():
    one, again, other = (
        bootstrap_counts(LEVELS, np.full(8, 40), COUNTS, Resampling(200, seed), LEVELS)
        for seed in (1, 1, 2)
    )
    assert (
        (one.median_low, one.beta_high)
        == (again.median_low, again.beta_high)
        != (other.median_low, other.beta_high)
    )
    curve = fit_stripes(LEVELS, np.full(8, 40), COUNTS)
    assert one.median_low < curve.median < one.median_high
    assert one.beta_low < curve.beta < one.beta_high
    assert np.all((one.low <= curve(LEVELS)) & (curve(LEVELS) <= one.high))


def covered(seeds, samples):
    """How often the band holds the true (theta, beta) of data drawn anew with each
    seed: stripes, first overturning, cloud.
    """
    records, levels, hits = 40, np.geomspace(0.2, 1.4, 10), np.zeros((3, 2))
    truth = [
        (MEDIAN, DISPERSION),
        (MEDIAN, DISPERSION),
        (np.exp((np.log(0.5) + 0.2) / 1.3), 0.45 / 1.3),
    ]
    for seed in range(seeds):
        random = np.random.default_rng(seed)
        r = random.lognormal(np.log(MEDIAN), DISPERSION, records)
        beyond, spared = r[:, None] <= levels, np.where(r <= 0.8, r, np.nan)
        x = random.lognormal(np.log(0.4), 0.5, records)
        y = np.exp(-0.2 + 1.3 * np.log(x) + 0.45 * random.standard_normal(records))
        estimates = (
            lambda i, beyond=beyond: stripes(
                levels, np.full(10, float(records)), beyond[i].sum(-2)
            ),
            lambda i, spared=spared: first_overturning(spared[i], 0.8),
            lambda i, x=x, y=y: cloud(x[i], y[i], 0.5),
        )
        for n, (estimate, (theta, beta)) in enumerate(
            zip(estimates, truth, strict=True)
        ):
            band = bootstrap(records, estimate, Resampling(samples, seed))
            hits[n] += (
                band.median_low < theta < band.median_high,
                band.beta_low < beta < band.beta_high,
            )
    return hits / seeds


@pytest.mark.soak
@pytest.mark.parametrize(
    ("seeds", "samples", "least", "most"),
    [
        (40, 300, 33 / 40, 1.0),
        pytest.param(200, 1000, 0.9, 0.98, marks=pytest.mark.soak),
    ],
)
def test_bands_hold_the_truth_as_often_as_they_say(seeds, samples, least, most):
    """40 draws of a band that holds it 95 times in 100: fewer than 33 are as rare as 1
    in 1000.
    """
    share = covered(seeds, samples)
    assert np.all((share >= least) & (share <= most)), share


def test_draws_that_all_lie_below_the_estimate_give_no_band():
    """How many records a draw holds that differ: fewer than there are, in every one;
    nothing is said of the division that fails.
    """

    def different(index):
        count = 1.0 + np.count_nonzero(
            np.diff(np.sort(index, axis=-1), axis=-1), axis=-1
        )
        return count, count

    assert bootstrap(12, different, Resampling(100, 0)) is None
