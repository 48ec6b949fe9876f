"""Exact propagation through records: its work, and the tables that it needs."""

import numpy as np
import pytest
from support.synthetic_records import RECORDS, motion_of_samples, noise, random_cells

from rocking_cli import LinearEquation, System, linear_response
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.samples import exact
from rocking_cli.dynamics.samples.exact import (
    BOUND_MARGIN,
    LANES,
    ExactStepper,
    horizon,
    stretches,
)


def test_tables_in_shares_change_no_bit(monkeypatch):
    motion = motion_of_samples(RECORDS[0], 0.03)
    amplitude, omega = random_cells(12, 6)
    together = linear_response(motion, amplitude, omega, 0.9)
    monkeypatch.setattr("rocking_cli.dynamics.samples.exact._TABLES", 16 * 4 * 100)
    np.testing.assert_array_equal(
        linear_response(motion, amplitude, omega, 0.9).theta_ratio, together.theta_ratio
    )


def test_the_work_follows_the_impacts_and_not_the_samples(monkeypatch):
    """Rounds and propagations are counted, not seconds: the same record four times as
    finely takes hardly more of them.
    """
    tried = []
    monkeypatch.setattr(
        exact, "horizon", lambda y, *state: tried.append(y.size) or horizon(y, *state)
    )
    samples = noise(600, 0.02, 5)
    fine = np.interp(np.arange(4 * 600 - 3) / 4.0, np.arange(600), samples)
    amplitude, omega = random_cells(60, 8)
    work = []
    for motion in (motion_of_samples(samples, 0.02), motion_of_samples(fine, 0.005)):
        tried.clear()
        eta = np.full(60, 0.9)
        run = Run(
            Batch.of(System(LinearEquation()), motion.segments, amplitude, omega, eta),
            LANES,
        )
        run.all(
            lambda run, waiting, samples=motion.samples: ExactStepper(
                run, [samples]
            ).march(waiting)
        )
        work.append((run.work.steps, sum(tried)))
    assert np.all(np.array(work[1]) < 1.5 * np.array(work[0])), work


@pytest.mark.parametrize("count", [2, 3, 17, 300])
def test_each_bound_is_below_its_stretch_and_not_below_a_stretch_a_quarter_longer(
    count,
):
    samples = np.random.default_rng(count).standard_normal(count)
    margin = BOUND_MARGIN * np.abs(samples).max()
    levels = 1 + int(np.ceil(np.log2(count)))
    bounds = stretches([samples], levels)
    n = np.arange(count)
    for begin, outward in ((0, -samples), (bounds.side_size, samples)):
        for level in range(levels):
            found = bounds.at(np.full(count, begin), np.full(count, level), n)
            reach, late = 1 << level, 1 << max(0, level - 3)
            least = np.array([outward[i : i + reach + 1].min() for i in n])
            wide = np.array(
                [
                    outward[i // late * late : i // late * late + late + reach].min()
                    for i in n
                ]
            )
            assert np.all(found <= least - 0.9 * margin)
            assert np.all(found >= wide - 1.1 * margin)
