"""Taylor steps over samples against the march by long series, and on ground that moves upwards too against an integration."""

import math

import numpy as np
import pytest
from oracles.vertical_motion import swing
from support.bodies import drawn, shaking
from support.synthetic_records import RECORDS, allowance, assert_same, cells, long_series, noise, shaken, upwards

from rocking_cli import LinearEquation, Method, Outcome, RigidBodyEquation, System, load_structures, nonlinear_response, response, sine
from rocking_cli.dynamics.contacts.contact import OneSided, Unequal
from rocking_cli.dynamics.equations.equation import Ramp
from rocking_cli.dynamics.equations.taylor import degrees, factors_for
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.samples import taylor_steps
from rocking_cli.dynamics.samples.taylor_steps import TaylorStepper
from rocking_cli.motions.biaxial import with_vertical

ALPHA, LEFT = 0.25, 0.2
TURNS = tuple(math.sin(alpha) / alpha for alpha in (ALPHA, LEFT))
UNEQUAL = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=TURNS)
SIDES = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=(1.0, 1.0))
SYSTEMS = {
    "a body": (System(RigidBodyEquation(ALPHA), scale=ALPHA), 0.9),
    "a damped body of unlike edges": (System(RigidBodyEquation((ALPHA, LEFT), damping=0.05), UNEQUAL, ALPHA), 0.9),
    "a body on one side": (System(RigidBodyEquation(0.5), OneSided(), 0.5), -0.5),
    "the damped oscillator": (System(LinearEquation(0.05), scale=0.4), 0.9),
    "the damped oscillator of unlike edges": (System(LinearEquation(0.3), SIDES, ALPHA), 0.9),
    "the damped oscillator on one side": (System(LinearEquation(0.02), OneSided(), ALPHA), -0.6),
}
UPWARDS = noise(120, 0.04, 8)


def weighed(part, share, across, dt=0.04):
    """(a record with another one upwards, the same for the march by long series)."""
    return upwards(shaken(RECORDS[across][part], dt), shaken(UPWARDS[part], dt), share)


def against_the_march(name, motion, long, count, seed):
    """Outcomes and impacts equal, rotations within the tolerance of each cell, 1e-9 of its condition."""
    (arch,) = load_structures("configs/arch.yaml")
    system, eta = (Method("nonlinear").system_of(arch), arch.eta) if name == "an arch" else SYSTEMS[name]
    amplitude, omega = cells(count, seed)
    omega[:2] /= 40.0  # samples too far apart to be stepped over
    etas = np.full(count, eta)
    found = response(system, motion, amplitude, omega, etas)
    run = Run(Batch.of(system, system.segments(long), amplitude, omega, etas))
    run.all()
    np.testing.assert_array_equal(found.impacts, run.impacts)
    allowed = 1e3 * allowance(motion, amplitude, omega, np.abs(etas), lambda m, a, o, e: response(system, m, a, o, np.copysign(e, eta)))
    assert_same(found, run.theta_ratio, run.outcome, allowed)
    assert set(found.outcome) > {Outcome.ROCKED}


@pytest.mark.parametrize("name", [*SYSTEMS, "an arch"])
def test_the_same_as_the_march_by_long_series(name):
    motion = shaken(RECORDS[0][30:70], 0.05)
    against_the_march(name, motion, long_series(motion), 16, 5)


def test_the_same_as_that_march_on_ground_that_moves_upwards_too():
    against_the_march("a damped body of unlike edges", *weighed(slice(36, 56), 0.5, 2), 6, 5)


@pytest.mark.soak
@pytest.mark.parametrize("record", range(3))
@pytest.mark.parametrize("name", [*SYSTEMS, "an arch"])
def test_many_cells_of_each_system(name, record):
    motion = shaken(RECORDS[record], 0.04)
    against_the_march(name, motion, long_series(motion), 300, 20 + record)
    against_the_march(name, *weighed(slice(None, 100), (0.3, -1.2, 0.6)[record], record), 60, 20 + record)


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


@pytest.mark.parametrize("motion", [shaken(RECORDS[0][30:60], 0.04), weighed(slice(36, 52), 0.8, 2)[0]], ids=["steady", "weighed"])
@pytest.mark.parametrize("name", ["a body", "a damped body of unlike edges"])
def test_no_digit_depends_on_the_neighbours(name, motion, monkeypatch):
    system, eta = SYSTEMS[name]
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
    stepper = TaylorStepper(Run(Batch.of(System(equation), motion.segments, one, one, one)), [motion.samples])
    unit = 10.0 ** random.uniform(-2.5, -0.3, count)
    y, v = 10.0 ** random.uniform(-5.0, 0.0, count), random.uniform(-1.0, 1.0, count) * 10.0 ** random.uniform(-3.0, 0.0, count)
    drive, gain = random.uniform(-4.0, 4.0, (2, count))
    gain[::2] += 4.0
    # Half of them come down to the ground, or nearly, within the step, and rise again before its end.
    turn, depth, bend, more = random.uniform(0.3, 0.9, count), random.uniform(-0.1, 0.1, count), unit**2 * (drive - 1.0), unit**2 * gain
    hop = -(bend * turn + 0.5 * more * turn**2)
    height = depth * unit**2 - hop * turn - 0.5 * bend * turn**2 - more * turn**3 / 6.0
    dips = (np.arange(count) % 2 == 0) & (height > 0.0) & (bend + more * turn > 0.0)
    y, v = np.where(dips, height, y), np.where(dips, hop / unit, v)
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
    assert min((touches & ~taken).sum(), (peaks & ~taken).sum()) > 150


def against_the_integration(words, samples, count, seed):
    """Outcomes equal, and rotations within 1e-10, for bodies with A to 4 on ground that moves upwards too."""
    random, decided = np.random.default_rng(seed), 0
    motion, _ = weighed(samples, 0.5, 2, dt=0.05)
    while decided < count:
        body, solved, _ = drawn(words, random, (0.1, 0.5), (0.4, 0.98), 0.0)
        amplitude = random.uniform(0.8, 4.0)
        system = Method("nonlinear" if solved.nonlinear else "linear", 1e-11).system_of(body)
        found = response(system, motion, amplitude, 1.0 / body.p, body.eta)
        wanted = swing(solved, shaking(motion, body, amplitude, 1.0 / body.p))
        if wanted.outcome == "undecided" or float(body.ground_acceleration(amplitude)) * motion.vertical.peak > 0.95 * body.gravity:
            continue
        decided += 1
        assert Outcome(int(found.outcome)).flag == wanted.outcome
        assert math.isnan(wanted.rotation) or abs(wanted.rotation - float(found.theta_ratio)) < 1e-10


def test_weighed_bodies_against_an_integration_that_shares_no_code():
    against_the_integration("nonlinear", slice(36, 48), 1, 3)


@pytest.mark.soak
@pytest.mark.parametrize("words", ["linear", "nonlinear", "damped nonlinear"])
def test_more_weighed_bodies_against_that_integration(words):
    against_the_integration(words, slice(30, 60), 12, 4)


@pytest.mark.parametrize(
    ("lifts", "falls", "outcome"), [(0.1, 1.0, "lost_contact"), (2.1, 1.0, "lost_contact"), (0.1, 3.6, "overturned_no_impact")]
)
def test_free_fall_before_and_after_the_uplift_and_after_the_overturning(lifts, falls, outcome):
    """A body that overturns where the ground falls less. With A = 2.5, r = alpha = 0.25, the least w = 1 - A r share is 0 at 1.6."""
    t, system = 0.05 * np.arange(81), SYSTEMS["a body"][0]
    across = shaken(np.interp(t, [lifts, lifts + 0.5, lifts + 1.0], [0.0, 1.0, 0.0]), 0.05)
    up = shaken(-np.interp(t, [falls, falls + 0.15, falls + 0.3], [0.0, 1.0, 0.0]), 0.05)
    for share, wanted in ((1.6 * (1.0 - 1e-9), "overturned_no_impact"), (1.6 * (1.0 + 1e-9), outcome)):
        for motion in (with_vertical(across, up, share), with_vertical(long_series(across), long_series(up), share)):
            assert Outcome(int(response(system, motion, [2.5], [0.5], 0.9).outcome[0])).flag == wanted


def test_records_of_one_step_are_stepped_and_others_marched(monkeypatch):
    motion, _ = weighed(slice(30, 54), 0.5, 2)
    other = with_vertical(shaken(RECORDS[2][30:54], 0.04), shaken(UPWARDS[30:54], 0.03))
    stepped = []
    monkeypatch.setattr(taylor_steps.WeighedTaylorStepper, "march", lambda self, waiting: stepped.append(waiting.size))
    for m in (motion, other):
        response(SYSTEMS["a body"][0], m, [2.0, 3.0], 0.5, 0.9)
    assert stepped == [2]
