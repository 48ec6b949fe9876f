"""Bodies that are taken over many lines of a record at once, against the march line by
line and against closed forms.
"""

import numpy as np
import pytest
from support.bodies import QUICK, SYSTEMS
from support.soak import quick
from support.synthetic_records import (
    RECORDS,
    allowance,
    assert_same,
    motion_of_samples,
    noise,
    random_cells,
    room,
    weighed,
)

from rocking_cli import LinearEquation, System, response
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.march import engine, over_samples
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.march.over_samples import (
    bounded_response,
    horizon,
    least_ahead,
)
from rocking_cli.dynamics.response import response_with_speed

LINEAR = System(LinearEquation()).with_restitution(0.9)


@pytest.mark.parametrize("pace", [1e-3, 0.04, 0.3, 0.5])
def test_the_bounded_response_follows_its_equation_and_is_bounded(pace):
    """From each sample to the next one in closed form, Y'' = Y + s with a linear s."""
    samples = noise(300, 0.02, 5)
    found = bounded_response(samples, pace)
    y, v = found.real, found.imag
    slope, cosh, sinh = np.diff(samples) / pace, np.cosh(pace), np.sinh(pace)
    c, s = y[:-1] + samples[:-1], v[:-1] + slope
    size = np.abs(samples).max()
    np.testing.assert_allclose(
        y[1:], c * cosh + s * sinh - samples[1:], rtol=0.0, atol=1e-13 * size
    )
    np.testing.assert_allclose(
        v[1:], c * sinh + s * cosh - slope, rtol=0.0, atol=1e-13 * size
    )
    # a mode that grows, or decays, would be larger at an end
    assert np.all(np.abs(y) <= size)


@pytest.mark.parametrize("count", [2, 3, 17, 64])
def test_each_bound_is_just_below_the_least_value_ahead(count):
    values = np.random.default_rng(count).standard_normal(count)
    for level, row in enumerate(least_ahead(values)):
        least = [values[k : k + 2**level + 1].min() for k in range(count)]
        assert np.all(row <= least)
        np.testing.assert_allclose(row, least, rtol=0.0, atol=1e-5)
    assert 2**level >= count - 1


def test_the_horizon_is_where_the_lowest_path_comes_to_the_ground():
    random = np.random.default_rng(1)
    y, v, least = random.uniform(
        [[0.0], [-1.0], [-3.0]], [[2.0], [1.0], [3.0]], (3, 99)
    )
    with np.errstate(all="ignore"):
        time, _ = horizon(y, v, least)
    t = np.linspace(0.0, 1.0, 50)[1:, None] * np.where(time < np.inf, time, 10.0)
    path = y + v * np.sinh(t) + (y - 1.0 + least) * (np.cosh(t) - 1.0)
    assert np.all(path > -1e-9 * np.cosh(t))
    lands = np.isfinite(time)
    assert 20 < np.count_nonzero(lands) < 90
    assert np.all(np.abs(path[-1, lands]) < 1e-9 * np.cosh(t[-1, lands]))


def line_by_line(system, motion, cells, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(engine, "ahead_of", lambda *_: None)
        return response(system, motion, *cells)


@pytest.mark.parametrize("name", quick(SYSTEMS, QUICK[0], QUICK[2]))
def test_flights_end_as_line_by_line(name, monkeypatch):
    system, eta = SYSTEMS[name]
    for seed, motion in enumerate(
        (
            motion_of_samples(noise(160, 0.02, 5), 0.02),
            weighed(slice(30, 55), 0.5, 2)[0],
        )
    ):
        cells = (*random_cells(8, 30 + seed), np.full(8, eta))
        found = response(system, motion, *cells)
        slow = line_by_line(system, motion, cells, monkeypatch)
        allowed = room(system) * allowance(motion, *cells, system)
        assert_same(found, slow.theta_ratio, slow.outcome, allowed)
        np.testing.assert_array_equal(found.impacts_at_least, slow.impacts_at_least)
        assert found.work.steps < 0.9 * slow.work.steps


@pytest.mark.soak
@pytest.mark.parametrize("name", SYSTEMS)
def test_many_flights_end_as_line_by_line(name, monkeypatch):
    system, eta = SYSTEMS[name]
    for seed in range(10):
        motion = motion_of_samples(noise(600, 0.01, seed), 0.01)
        cells = (*random_cells(1000, seed), np.full(1000, eta))
        found = response(system, motion, *cells)
        slow = line_by_line(system, motion, cells, monkeypatch)
        # of 10,000 cells the farthest is off by 2.5 times that rounding
        allowed = 4.0 * room(system) * allowance(motion, *cells, system)
        assert_same(found, slow.theta_ratio, slow.outcome, allowed)


@pytest.mark.parametrize("name", quick(("the oscillator", "an arch"), "the oscillator"))
def test_the_largest_speed_is_that_line_by_line(name, monkeypatch):
    system, _ = SYSTEMS[name]
    motion = motion_of_samples(noise(160, 0.02, 5), 0.02)
    cells = random_cells(8, 30)
    found, speed = response_with_speed(system, motion, *cells)
    with monkeypatch.context() as patch:
        patch.setattr(engine, "ahead_of", lambda *_: None)
        slow, wanted = response_with_speed(system, motion, *cells)
    np.testing.assert_array_equal(found.outcome, slow.outcome)
    assert np.count_nonzero(np.isfinite(wanted)) > 2
    np.testing.assert_allclose(speed, wanted, rtol=1e-7)
    assert found.work.steps < 0.9 * slow.work.steps


def test_the_steps_follow_the_impacts_and_not_the_samples():
    samples, cells = noise(300, 0.02, 5), random_cells(20, 8)
    fine = np.interp(np.arange(4 * 300 - 3) / 4.0, np.arange(300), samples)
    coarse, finer = (
        response(LINEAR, motion_of_samples(values, dt), *cells).work.steps
        for values, dt in ((samples, 0.02), (fine, 0.005))
    )
    assert finer < 1.3 * coarse


def test_tables_in_groups_change_no_digit(monkeypatch):
    motion, cells = motion_of_samples(RECORDS[0], 0.03), random_cells(4, 6)
    whole = response(LINEAR, motion, *cells).theta_ratio
    monkeypatch.setattr(over_samples, "_TABLE", 4 * 100)
    again = response(LINEAR, motion, *cells).theta_ratio
    np.testing.assert_array_equal(again, whole)


@pytest.mark.parametrize("name", quick(SYSTEMS, QUICK[2]))
def test_no_digit_of_a_cell_depends_on_the_others(name):
    system, motion = SYSTEMS[name][0], motion_of_samples(noise(100, 0.02, 5), 0.02)
    cells = np.array(random_cells(12, 3))

    def run(some):
        found = Run(Batch.of(system, system.segments(motion), *cells[:, some]))
        found.all()
        return found

    whole = run(slice(None))
    for some in (np.array([7]), np.array([10, 3, 7])):
        part = run(some)
        np.testing.assert_array_equal(part.theta_ratio, whole.theta_ratio[some])
        np.testing.assert_array_equal(part.condition, whole.condition[some])
