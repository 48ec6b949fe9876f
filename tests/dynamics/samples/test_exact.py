"""Exact propagation through records against the march, an integration that shares no code with either, and what changes nothing."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from oracles.record_lockstep import lockstep
from support.synthetic_records import RECORDS, allowance, assert_same, cells, noise, shaken

from rocking_cli import LinearEquation, System, linear_response, response
from rocking_cli.dynamics.contacts.contact import OneSided, Symmetric, Unequal
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.samples.exact import LANES, ExactStepper

UNEQUAL = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=(1.0, 1.2))


def marched(system, motion, amplitude, omega, eta):
    run = Run(Batch.of(system, motion.segments, amplitude, omega, np.broadcast_to(eta, omega.shape)), 32768)
    run.all()
    return run


def against_lockstep(seed, count):
    motion = shaken(RECORDS[seed], 0.04)
    amplitude, omega = cells(count, seed)
    eta = np.resize([0.5, 0.9, 0.0], count)
    found = linear_response(motion, amplitude, omega, eta)
    outcome, theta = lockstep(*reversed(motion.samples), amplitude, omega, eta)
    assert_same(found, theta, outcome, allowance(motion, amplitude, omega, eta))
    assert np.unique(outcome).size >= 2


@pytest.mark.parametrize("seed", range(3))
def test_records_against_an_integration_that_shares_no_code(seed):
    against_lockstep(seed, 12)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(3))
def test_four_thousand_cells_of_each_record(seed):
    against_lockstep(seed, 4000)


def without_loss(seed, count):
    """Only bodies that bounce little: without loss some never end."""
    motion = shaken(RECORDS[seed], 0.04)
    amplitude, omega = cells(count, 10 + seed)
    amplitude += 2.0
    few = linear_response(motion, amplitude, omega, 0.98).impacts < 40
    amplitude, omega, eta = amplitude[few], omega[few], np.ones(few.sum())
    found = linear_response(motion, amplitude, omega, eta)
    few = found.impacts < 200
    amplitude, omega, eta, found = amplitude[few], omega[few], eta[few], linear_response(motion, amplitude[few], omega[few], eta[few])
    outcome, theta = lockstep(*reversed(motion.samples), amplitude, omega, eta)
    assert_same(found, theta, outcome, allowance(motion, amplitude, omega, eta))


def test_bodies_that_lose_no_speed():
    without_loss(0, 6)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(3))
def test_two_thousand_bodies_that_lose_no_speed(seed):
    without_loss(seed, 3000)


@pytest.mark.parametrize(("contact", "eta"), [(Symmetric(), 0.9), (OneSided(), -0.5), (UNEQUAL, 0.9)], ids=["equal", "one side", "unequal"])
def test_the_same_as_the_march(contact, eta):
    count = 24
    system, motion = System(LinearEquation(), contact), shaken(RECORDS[1], 0.03)
    amplitude, omega = cells(count, 4)
    omega[:3] /= 50.0  # samples too far apart to be propagated over
    found = response(system, motion, amplitude, omega, eta)
    run = marched(system, motion, amplitude, omega, eta)
    np.testing.assert_array_equal(found.impacts, run.impacts)
    allowed = allowance(motion, amplitude, omega, np.full(count, eta), lambda *cell: response(system, *cell))
    assert_same(found, run.theta_ratio, run.outcome, allowed)
    alone = response(system, motion, amplitude, omega, eta, peaks=False)
    np.testing.assert_array_equal(alone.outcome, found.outcome)


def test_a_record_is_propagated_exactly_and_other_motions_are_not():
    assert shaken(RECORDS[0], 0.03).samples is not None
    assert shaken(RECORDS[0], 0.03).still_until(500.3).samples is None


def test_no_digit_depends_on_the_neighbours():
    motion = shaken(RECORDS[0], 0.03)
    amplitude, omega = cells(12, 6)
    together = linear_response(motion, amplitude, omega, 0.7)
    narrow = linear_response(motion, amplitude, omega, 0.7, pool=5)
    alone = [linear_response(motion, amplitude[i : i + 1], omega[i : i + 1], 0.7).theta_ratio[0] for i in range(3)]
    np.testing.assert_array_equal(narrow.theta_ratio, together.theta_ratio)
    np.testing.assert_array_equal(alone, together.theta_ratio[:3])


def test_what_changes_nothing():
    """The mirrored, refined, delayed and continued record, and the scaled record against the scaled amplitude."""
    samples = RECORDS[2]
    amplitude, omega = cells(20, 7)
    eta = np.full(20, 0.8)
    motion = shaken(samples, 0.02)
    first = linear_response(motion, amplitude, omega, eta)
    mirrored = linear_response(shaken(-samples, 0.02), amplitude, omega, eta)
    np.testing.assert_array_equal(mirrored.theta_ratio, first.theta_ratio)
    scaled = linear_response(shaken(4.0 * samples, 0.02), amplitude, omega, eta)
    np.testing.assert_array_equal(scaled.theta_ratio, first.theta_ratio)
    fine = np.interp(np.arange(4 * samples.size - 3) / 4.0, np.arange(samples.size), samples)
    allowed = allowance(motion, amplitude, omega, eta)
    delayed, continued = np.append(np.zeros(33), samples), np.append(samples, np.zeros(500))
    for other in (shaken(fine, 0.005), shaken(delayed, 0.02), shaken(continued, 0.02)):
        found = linear_response(other, amplitude, omega, eta)
        assert_same(found, first.theta_ratio, first.outcome, allowed)


def test_tables_in_shares_change_no_bit(monkeypatch):
    motion = shaken(RECORDS[0], 0.03)
    amplitude, omega = cells(12, 6)
    together = linear_response(motion, amplitude, omega, 0.9)
    monkeypatch.setattr("rocking_cli.dynamics.samples.exact._TABLES", 16 * 4 * 100)
    np.testing.assert_array_equal(linear_response(motion, amplitude, omega, 0.9).theta_ratio, together.theta_ratio)


def test_the_work_follows_the_impacts_and_not_the_samples():
    """Rounds are counted, not seconds: the same record four times as finely takes hardly more of them."""
    samples = noise(600, 0.02, 5)
    fine = np.interp(np.arange(4 * 600 - 3) / 4.0, np.arange(600), samples)
    amplitude, omega = cells(60, 8)
    rounds = []
    for motion in (shaken(samples, 0.02), shaken(fine, 0.005)):
        stepper, eta = partial(ExactStepper, samples=motion.samples), np.full(60, 0.9)
        run = Run(Batch.of(System(LinearEquation()), motion.segments, amplitude, omega, eta), LANES, stepper)
        run.all()
        rounds.append(run.work.steps)
    assert rounds[1] < 1.5 * rounds[0]
