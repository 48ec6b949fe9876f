"""Taylor steps over samples: their tolerance, what is proved of a step,
and free fall.
"""

import numpy as np
import pytest
from support.bodies import ALPHA, SYSTEMS
from support.references import lanes
from support.synthetic_records import (
    RECORDS,
    allowance,
    assert_same,
    long_series,
    motion_of_samples,
    noise,
    random_cells,
    weighed,
)

from rocking_cli import (
    LinearEquation,
    Outcome,
    RigidBodyEquation,
    System,
    response,
    sine,
)
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.equations.equation import Drive
from rocking_cli.dynamics.equations.recurrence import Rows, motion_terms
from rocking_cli.dynamics.equations.taylor import degrees, factors_for
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.samples import taylor_steps
from rocking_cli.dynamics.samples.taylor_steps import TaylorStepper
from rocking_cli.motions.biaxial import with_vertical


@pytest.mark.slow
def test_the_tolerance_is_kept():
    """Against steps at 1e-13: an error of the tolerance at the most, times the
    condition of each cell.
    """
    motion, eta = motion_of_samples(RECORDS[0][30:80], 0.04), np.full(16, 0.9)
    amplitude, omega = random_cells(16, 9)
    condition = 1e12 * allowance(
        motion, amplitude, omega, eta, System(RigidBodyEquation(ALPHA))
    )
    exact = response(
        System(RigidBodyEquation(ALPHA, 1e-13)), motion, amplitude, omega, eta
    )
    for tolerance in (1e-4, 1e-7, 1e-10):
        found = response(
            System(RigidBodyEquation(ALPHA, tolerance)), motion, amplitude, omega, eta
        )
        assert_same(found, exact.theta_ratio, exact.outcome, tolerance * condition)
        assert (
            np.nanmax(np.abs(found.theta_ratio - exact.theta_ratio)) > 1e-6 * tolerance
        ), "fewer terms are taken"


@pytest.mark.parametrize(
    "motion",
    [motion_of_samples(RECORDS[0][36:52], 0.04), sine()],
    ids=["stepped", "marched"],
)
def test_bodies_of_many_angles_in_one_run_are_those_of_each_alone(motion):
    alphas, count = np.array([0.6, 0.1, 0.3]), 7
    amplitude, omega = random_cells(3 * count, 8)
    omega[::5] /= 40.0  # samples too far apart to be stepped over
    omega *= 1.0 if motion.samples else 20.0
    eta = np.tile([0.6, 0.9, 1.0 - 1e-4], count)
    together = response(
        System(RigidBodyEquation(np.repeat(alphas, count))),
        motion,
        amplitude,
        omega,
        eta,
    )
    assert len(set(together.outcome)) > 2
    for i in (0, 2):
        mine = slice(count * i, count * (i + 1))
        alone = response(
            System(RigidBodyEquation(float(alphas[i]))),
            motion,
            amplitude[mine],
            omega[mine],
            eta[mine],
        )
        for name in ("theta_ratio", "outcome", "impacts_at_least"):
            np.testing.assert_array_equal(
                getattr(together, name)[mine], getattr(alone, name)
            )


@pytest.mark.parametrize("alpha", [0.2, ALPHA, 0.3, 0.4])
def test_a_body_that_is_just_lifted_at_a_sample(alpha):
    """The uplift falls on the end of an interval, to the last digits."""
    system, motion = (
        System(RigidBodyEquation(alpha)),
        motion_of_samples(RECORDS[0], 0.04),
    )
    amplitude = system.least_uplift(motion) * (1.0 + 1.2e-16 * np.arange(-8, 9))
    found = response(system, motion, amplitude, 0.4, 0.9)
    assert set(found.outcome) == {Outcome.NO_UPLIFT, Outcome.ROCKED}
    assert found.theta_ratio.max() < 1e-20


@pytest.mark.parametrize("weighed", [False, True])
@pytest.mark.parametrize(
    "equation",
    [RigidBodyEquation(0.4), RigidBodyEquation(0.4, damping=0.3), LinearEquation(0.1)],
)
def test_lemma_12_a_step_that_is_taken_holds_no_impact_and_no_higher_peak(
    equation, weighed
):
    """Random steps near the ground and near their peak: those that are taken, looked at
    on 200 points.
    """
    random, count = np.random.default_rng(3), 4000
    motion = motion_of_samples(RECORDS[0], 0.04)
    one = np.ones(1)
    stepper = TaylorStepper(
        Run(Batch.of(System(equation), motion.segments, one, one, one)),
        [motion.samples],
    )
    unit = 10.0 ** random.uniform(-2.5, -0.3, count)
    y, v = (
        10.0 ** random.uniform(-5.0, 0.0, count),
        random.uniform(-1.0, 1.0, count) * 10.0 ** random.uniform(-3.0, 0.0, count),
    )
    drive, gain = random.uniform(-4.0, 4.0, (2, count))
    gain[::2] += 4.0
    # Half of them come down to the ground, or nearly, within the step, and rise again
    # before its end.
    turn, depth, fall, more = (
        random.uniform(0.3, 0.9, count),
        random.uniform(-0.1, 0.1, count),
        unit**2 * (drive - 1.0),
        unit**2 * gain,
    )
    first_order = -(fall * turn + 0.5 * more * turn**2)
    height = (
        depth * unit**2
        - first_order * turn
        - 0.5 * fall * turn**2
        - more * turn**3 / 6.0
    )
    dips = (np.arange(count) % 2 == 0) & (height > 0.0) & (fall + more * turn > 0.0)
    y, v = np.where(dips, height, y), np.where(dips, first_order / unit, v)
    degree = degrees(
        np.full(count, 10.0) + np.abs(gain) / unit,
        (1.6 if weighed else 1.0) * unit,
        equation.tolerance,
    )
    weight, then = np.random.default_rng(4).uniform(0.0, 2.5, (2, count))
    ramp = Drive(
        Rows.of(drive, gain), unit, Rows.of(weight, then - weight) if weighed else None
    )
    factors = factors_for(unit, degree)
    peak = y * (1.0 + 10.0 ** random.uniform(-3.0, 1.0, count))
    end, _, taken = stepper._step(
        equation,
        lanes(y=y, v=v, peak=peak),
        ramp,
        factors,
        degree * count + np.arange(count),
    )
    terms = motion_terms(equation, y, v, unit, factors, ramp.terms, ramp.weight)
    path = np.array(
        [
            (terms * x ** np.arange(len(terms))[:, None]).sum(axis=0)
            for x in np.linspace(0.0, 1.0, 201)
        ]
    )
    assert taken.sum() > 300
    assert np.all(path[:, taken] > 0.0)
    assert np.all(
        path.max(axis=0)[taken] <= np.maximum(peak, end)[taken] * (1.0 + 1e-15)
    )
    touches, peaks = (
        path.min(axis=0) < 0.0,
        path.max(axis=0) > np.maximum(peak, end) * (1.0 + 1e-12),
    )
    assert min((touches & ~taken).sum(), (peaks & ~taken).sum()) > 150


@pytest.mark.parametrize(
    ("lifts", "falls", "outcome"),
    [
        (0.1, 1.0, "lost_contact"),
        (2.1, 1.0, "lost_contact"),
        (0.1, 3.6, "overturned_no_impact"),
    ],
)
def test_free_fall_before_and_after_the_uplift_and_after_the_overturning(
    lifts, falls, outcome
):
    """A body that overturns where the ground falls less. With A = 2.5, r = alpha =
    0.25, the least w = 1 - A r share is 0 at 1.6.
    """
    t, system = 0.05 * np.arange(81), SYSTEMS["a body"][0]
    across = motion_of_samples(
        np.interp(t, [lifts, lifts + 0.5, lifts + 1.0], [0.0, 1.0, 0.0]), 0.05
    )
    up = motion_of_samples(
        -np.interp(t, [falls, falls + 0.15, falls + 0.3], [0.0, 1.0, 0.0]), 0.05
    )
    for share, wanted in (
        (1.6 * (1.0 - 1e-9), "overturned_no_impact"),
        (1.6 * (1.0 + 1e-9), outcome),
    ):
        for motion in (
            with_vertical(across, up, share),
            with_vertical(long_series(across), long_series(up), share),
        ):
            assert (
                Outcome(
                    int(response(system, motion, [2.5], [0.5], 0.9).outcome[0])
                ).flag
                == wanted
            )


def test_records_of_one_step_are_stepped_and_others_marched(monkeypatch):
    motion, _ = weighed(slice(30, 54), 0.5, 2)
    other = with_vertical(
        motion_of_samples(RECORDS[2][30:54], 0.04),
        motion_of_samples(noise(120, 0.04, 8)[30:54], 0.03),
    )
    stepped = []
    monkeypatch.setattr(
        taylor_steps.WeighedTaylorStepper,
        "march",
        lambda self, waiting: stepped.append(waiting.size),
    )
    for m in (motion, other):
        response(SYSTEMS["a body"][0], m, [2.0, 3.0], 0.5, 0.9)
    assert stepped == [2]
