"""Exact propagation through records: its work, and the tables that it needs."""

from itertools import pairwise

import mpmath
import numpy as np
import pytest
from support.synthetic_records import RECORDS, cells, noise, shaken

from rocking_cli import LinearEquation, System, linear_response
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.samples import exact
from rocking_cli.dynamics.samples.exact import BOUND_MARGIN, LANES, ExactStepper, bounded_response, horizon, stretches


def test_tables_in_shares_change_no_bit(monkeypatch):
    motion = shaken(RECORDS[0], 0.03)
    amplitude, omega = cells(12, 6)
    together = linear_response(motion, amplitude, omega, 0.9)
    monkeypatch.setattr("rocking_cli.dynamics.samples.exact._TABLES", 16 * 4 * 100)
    np.testing.assert_array_equal(linear_response(motion, amplitude, omega, 0.9).theta_ratio, together.theta_ratio)


def test_the_work_follows_the_impacts_and_not_the_samples(monkeypatch):
    """Rounds and propagations are counted, not seconds: the same record four times as finely takes hardly more of them."""
    tried = []
    monkeypatch.setattr(exact, "horizon", lambda y, *state: tried.append(y.size) or horizon(y, *state))
    samples = noise(600, 0.02, 5)
    fine = np.interp(np.arange(4 * 600 - 3) / 4.0, np.arange(600), samples)
    amplitude, omega = cells(60, 8)
    work = []
    for motion in (shaken(samples, 0.02), shaken(fine, 0.005)):
        tried.clear()
        eta = np.full(60, 0.9)
        run = Run(Batch.of(System(LinearEquation()), motion.segments, amplitude, omega, eta), LANES)
        run.all(lambda run, waiting, samples=motion.samples: ExactStepper(run, [samples]).march(waiting))
        work.append((run.work.steps, sum(tried)))
    assert np.all(np.array(work[1]) < 1.5 * np.array(work[0])), work


def by_integration(samples, pace, at):
    """-1/2 of the integral of exp(-|t|) s about a sample, and its derivative, line by line."""
    with mpmath.workdps(40):
        h, value, rate = mpmath.mpf(pace), mpmath.mpf(0), mpmath.mpf(0)
        for i, (s0, s1) in enumerate(pairwise(samples)):
            later = i >= at
            near, far, between = (s0, s1, i - at) if later else (s1, s0, at - i - 1)
            total = mpmath.exp(-between * h) * mpmath.quad(lambda t, a=near, b=far: mpmath.exp(-t) * (a + (b - a) * t / h), [0, h])
            value -= total / 2
            rate -= total / 2 if later else -total / 2
        return complex(value, rate)


@pytest.mark.parametrize("pace", [1e-4, 0.03, 0.5])
def test_the_bounded_response_is_the_integral(pace):
    samples = np.random.default_rng(7).standard_normal(14)
    (found,) = bounded_response(samples, np.array([pace]))
    for at in (0, 5, 13):
        assert abs(found[at] - by_integration(samples, pace, at)) < 2e-16 * np.abs(samples).max() * samples.size


def test_a_row_does_not_depend_on_its_neighbours():
    samples = np.random.default_rng(8).standard_normal(3000)
    samples[:2000] = 0.0  # what has decayed is not added for the sake of another row
    paces = np.array([0.4, 0.001])
    for row, pace in zip(bounded_response(samples, paces), paces, strict=True):
        np.testing.assert_array_equal(row, bounded_response(samples, np.array([pace]))[0])


@pytest.mark.parametrize("count", [2, 3, 17, 300])
def test_each_bound_is_below_its_stretch_and_not_below_a_stretch_a_quarter_longer(count):
    samples = np.random.default_rng(count).standard_normal(count)
    margin = BOUND_MARGIN * np.abs(samples).max()
    levels = 1 + int(np.ceil(np.log2(count)))
    bounds = stretches([samples], levels)
    n = np.arange(count)
    for face, outward in ((0, -samples), (bounds.face, samples)):
        for level in range(levels):
            found = bounds.at(np.full(count, face), np.full(count, level), n)
            reach, late = 1 << level, 1 << max(0, level - 3)
            least = np.array([outward[i : i + reach + 1].min() for i in n])
            wide = np.array([outward[i // late * late : i // late * late + late + reach].min() for i in n])
            assert np.all(found <= least - 0.9 * margin)
            assert np.all(found >= wide - 1.1 * margin)
