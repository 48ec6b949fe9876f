"""Taylor steps over samples against the march by long series, an integration that shares no code with either, and what changes nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracles.record_lockstep import Rigid, lockstep
from support.synthetic_records import RECORDS, allowance, assert_same, cells, shaken

from rocking_cli import LinearEquation, Method, Outcome, RigidBodyEquation, System, load_structures, nonlinear_response, response, sine
from rocking_cli.dynamics.contacts.contact import OneSided, Unequal
from rocking_cli.dynamics.equations.equation import Ramp
from rocking_cli.dynamics.equations.taylor import degrees, factors_for
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.samples.taylor_steps import TaylorStepper
from rocking_cli.motions import Harmonic, Motion, Piece

ALPHA, LEFT = 0.25, 0.2
TURNS = tuple(math.sin(alpha) / alpha for alpha in (ALPHA, LEFT))
UNEQUAL = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=TURNS)
SIDES = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=(1.0, 1.0))
SYSTEMS = {
    "a body": (System(RigidBodyEquation(ALPHA)), 0.9),
    "a damped body of unlike edges": (System(RigidBodyEquation((ALPHA, LEFT), damping=0.05), UNEQUAL), 0.9),
    "a body on one side": (System(RigidBodyEquation(0.5), OneSided()), -0.5),
    "the damped oscillator": (System(LinearEquation(0.05)), 0.9),
    "the damped oscillator of unlike edges": (System(LinearEquation(0.3), SIDES), 0.9),
    "the damped oscillator on one side": (System(LinearEquation(0.02), OneSided()), -0.6),
}


def long_series(motion):
    """The same motion with a sinusoid of no height in each piece, for which the march takes its long series, not the short ones."""
    return Motion(motion.name, tuple(Piece(p.start, p.stop, (Harmonic(0.0),), p.constant, p.slope) for p in motion.pieces))


def against_the_march(system, eta, samples, dt, count, seed):
    """Outcomes and impacts equal, rotations within the tolerance of each cell, 1e-9 of its condition."""
    motion = shaken(samples, dt)
    amplitude, omega = cells(count, seed)
    omega[:2] /= 40.0  # samples too far apart to be stepped over
    etas = np.full(count, eta)
    found = response(system, motion, amplitude, omega, etas)
    run = Run(Batch.of(system, long_series(motion).segments, amplitude, omega, etas))
    run.all()
    np.testing.assert_array_equal(found.impacts, run.impacts)
    allowed = 1e3 * allowance(motion, amplitude, omega, np.abs(etas), lambda m, a, o, e: response(system, m, a, o, np.copysign(e, eta)))
    assert_same(found, run.theta_ratio, run.outcome, allowed)
    assert set(found.outcome) > {Outcome.ROCKED}


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_same_as_the_march_by_long_series(name):
    against_the_march(*SYSTEMS[name], RECORDS[0][30:70], 0.05, 16, 5)


def test_an_arch_steps_as_it_marches():
    (arch,) = load_structures("configs/arch.yaml")
    against_the_march(Method("nonlinear").system_of(arch), 0.9, RECORDS[0][30:60], 0.05, 12, 6)


@pytest.mark.soak
@pytest.mark.parametrize("record", range(3))
@pytest.mark.parametrize("name", SYSTEMS)
def test_three_hundred_cells_of_each_system(name, record):
    against_the_march(*SYSTEMS[name], RECORDS[record], 0.04, 300, 20 + record)


def against_lockstep(record, count, eta, alpha=ALPHA, part=slice(None)):
    motion = shaken(RECORDS[record][part], 0.04)
    amplitude, omega = cells(count, 30 + record)
    etas = np.full(count, eta)
    if eta == 1.0:  # without loss some never end: only those that bounce little
        few = nonlinear_response(motion, amplitude + 2.0, omega, 0.98, alpha).impacts < 40
        amplitude, omega, etas = amplitude[few] + 2.0, omega[few], etas[few]
        few = nonlinear_response(motion, amplitude, omega, etas, alpha).impacts < 200
        amplitude, omega, etas = amplitude[few], omega[few], etas[few]
    found = nonlinear_response(motion, amplitude, omega, etas, alpha)
    outcome, theta = lockstep(*reversed(motion.samples), amplitude * (alpha / math.tan(alpha)), omega, etas, Rigid(alpha))
    allowed = 1e3 * allowance(motion, amplitude, omega, etas, lambda *cell: nonlinear_response(*cell, alpha))
    assert_same(found, theta, outcome, allowed)
    assert np.unique(outcome).size >= 2


def test_bodies_against_an_integration_that_shares_no_code():
    against_lockstep(2, 20, 0.7, part=slice(35, 80))


@pytest.mark.soak
@pytest.mark.parametrize("eta", [0.5, 0.9, 1.0])
@pytest.mark.parametrize("record", range(3))
def test_two_thousand_bodies_against_an_integration_that_shares_no_code(record, eta):
    against_lockstep(record, 2000, eta)


def test_what_changes_nothing():
    """The mirrored, refined, delayed and continued record, and the scaled record against the scaled amplitude."""
    samples = np.concatenate([[0.0], RECORDS[2][31:89], [0.0]])
    amplitude, omega = cells(16, 7)
    eta = np.full(16, 0.8)

    def respond(m, a, o, e):
        return nonlinear_response(m, a, o, e, ALPHA)

    motion = shaken(samples, 0.04)
    first = respond(motion, amplitude, omega, eta)
    for same in (shaken(-samples, 0.04), shaken(4.0 * samples, 0.04)):
        np.testing.assert_array_equal(respond(same, amplitude, omega, eta).theta_ratio, first.theta_ratio)
    fine = np.interp(np.arange(4 * samples.size - 3) / 4.0, np.arange(samples.size), samples)
    allowed = 1e3 * allowance(motion, amplitude, omega, eta, respond)
    delayed, continued = np.append(np.zeros(33), samples), np.append(samples, np.zeros(100))
    for other in (shaken(fine, 0.01), shaken(delayed, 0.04), shaken(continued, 0.04)):
        assert_same(respond(other, amplitude, omega, eta), first.theta_ratio, first.outcome, allowed)


def test_the_tolerance_is_kept():
    """Against steps at 1e-13: an error of the tolerance at the most, times the condition of each cell."""
    motion, eta = shaken(RECORDS[0][30:80], 0.04), np.full(16, 0.9)
    amplitude, omega = cells(16, 9)
    condition = 1e12 * allowance(motion, amplitude, omega, eta, lambda *cell: nonlinear_response(*cell, ALPHA))
    exact = nonlinear_response(motion, amplitude, omega, eta, ALPHA, tolerance=1e-13)
    for tolerance in (1e-4, 1e-7, 1e-10):
        found = nonlinear_response(motion, amplitude, omega, eta, ALPHA, tolerance=tolerance)
        assert_same(found, exact.theta_ratio, exact.outcome, tolerance * condition)
        assert np.nanmax(np.abs(found.theta_ratio - exact.theta_ratio)) > 1e-6 * tolerance, "fewer terms are taken"


@pytest.mark.parametrize("name", ["a body", "a damped body of unlike edges"])
def test_no_digit_depends_on_the_neighbours(name, monkeypatch):
    system, eta = SYSTEMS[name]
    motion = shaken(RECORDS[0][30:60], 0.04)
    amplitude, omega = cells(12, 6)
    together = response(system, motion, amplitude, omega, eta)
    narrow = response(system, motion, amplitude, omega, eta, pool=5)
    np.testing.assert_array_equal(narrow.theta_ratio, together.theta_ratio)
    alone = [response(system, motion, amplitude[i : i + 1], omega[i : i + 1], eta).theta_ratio[0] for i in range(2)]
    np.testing.assert_array_equal(alone, together.theta_ratio[:2])
    monkeypatch.setattr("rocking_cli.dynamics.samples.stepper.WIDTH", 3)
    np.testing.assert_array_equal(response(system, motion, amplitude, omega, eta).theta_ratio, together.theta_ratio)
    np.testing.assert_array_equal(response(system, motion, amplitude, omega, eta, peaks=False).outcome, together.outcome)


@pytest.mark.parametrize("motion", [shaken(RECORDS[0][36:52], 0.04), sine()], ids=["stepped", "marched"])
def test_bodies_of_many_angles_in_one_run_are_those_of_each_alone(motion):
    alphas, count = np.array([0.6, 0.1, 0.3]), 7
    amplitude, omega = cells(3 * count, 8)
    omega[::5] /= 40.0  # samples too far apart to be stepped over
    omega *= 1.0 if motion.samples else 20.0
    eta = np.tile([0.6, 0.9, 1.0 - 1e-4], count)
    together = response(System(RigidBodyEquation(np.repeat(alphas, count))), motion, amplitude, omega, eta)
    assert len(set(together.outcome)) > 2
    for i in (0, 2):
        mine = slice(count * i, count * (i + 1))
        alone = response(System(RigidBodyEquation(float(alphas[i]))), motion, amplitude[mine], omega[mine], eta[mine])
        for name in ("theta_ratio", "outcome", "impacts"):
            np.testing.assert_array_equal(getattr(together, name)[mine], getattr(alone, name))


@pytest.mark.parametrize("alpha", [0.2, ALPHA, 0.3, 0.4])
def test_a_body_that_is_just_lifted_at_a_sample(alpha):
    """The uplift falls on the end of an interval, to the last digits."""
    system, motion = System(RigidBodyEquation(alpha)), shaken(RECORDS[0], 0.04)
    amplitude = system.least_uplift(motion) * (1.0 + 1.2e-16 * np.arange(-8, 9))
    found = response(system, motion, amplitude, 0.4, 0.9)
    assert set(found.outcome) == {Outcome.NO_UPLIFT, Outcome.ROCKED}
    assert found.theta_ratio.max() < 1e-20


@pytest.mark.parametrize("weighed", [False, True])
@pytest.mark.parametrize("equation", [RigidBodyEquation(0.4), RigidBodyEquation(0.4, damping=0.3), LinearEquation(0.1)])
def test_lemma_12_a_step_that_is_taken_holds_no_impact_and_no_higher_peak(equation, weighed):
    """Random strides near the ground and near their peak: those that are taken, looked at on 200 points."""
    random, count = np.random.default_rng(3), 4000
    motion = shaken(RECORDS[0], 0.04)
    one = np.ones(1)
    stepper = TaylorStepper(Run(Batch.of(System(equation), motion.segments, one, one, one)), motion.samples)
    unit = 10.0 ** random.uniform(-2.5, -0.3, count)
    y, v = 10.0 ** random.uniform(-5.0, 0.0, count), random.uniform(-1.0, 1.0, count) * 10.0 ** random.uniform(-3.0, 0.0, count)
    drive, gain = random.uniform(-4.0, 4.0, (2, count))
    degree = degrees(np.full(count, 10.0) + np.abs(gain) / unit, (1.6 if weighed else 1.0) * unit, equation.tolerance)
    weight, then = np.random.default_rng(4).uniform(0.0, 2.5, (2, count))
    ramp = Ramp(drive, gain, unit, factors_for(unit, degree), weight=(weight, then - weight) if weighed else None)
    peak = y * (1.0 + 10.0 ** random.uniform(-3.0, 1.0, count))
    end, _, taken = stepper._step(equation, y, v, peak, ramp, degree * count + np.arange(count))
    terms = equation.ramp_terms(y, v, ramp)
    path = np.array([(terms * x ** np.arange(len(terms))[:, None]).sum(axis=0) for x in np.linspace(0.0, 1.0, 201)])
    assert taken.sum() > 300
    assert np.all(path[:, taken] > 0.0)
    assert np.all(path.max(axis=0)[taken] <= np.maximum(peak, end)[taken] * (1.0 + 1e-15))
    touches, peaks = path.min(axis=0) < 0.0, path.max(axis=0) > np.maximum(peak, end) * (1.0 + 1e-12)
    assert min((touches & ~taken).sum(), (peaks & ~taken).sum()) > 200
