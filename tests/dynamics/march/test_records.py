"""Records on arrays and one body at a time: against an integration that shares no code,
against the march by long series, the tolerance, free fall, and what changes nothing.
"""

from functools import partial

import numpy as np
import pytest
from support.bodies import ALPHA, QUICK, SYSTEMS
from support.references import answers
from support.soak import quick
from support.synthetic_records import (
    RECORDS,
    allowance,
    assert_same,
    long_series,
    motion_of_samples,
    random_cells,
    room,
    weighed,
)

from rocking_cli import (
    Outcome,
    RigidBodyEquation,
    System,
    cosine,
    pulse,
    response,
    sine,
)
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.motions.biaxial import with_vertical

response_alone = partial(response, how="floats")

MODELS = {"linear": "the oscillator", "nonlinear": "a body"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "record", "part", "count", "etas"),
    [
        ("linear", 1, slice(None), 6, (0.5, 0.9, 0.0)),
        pytest.param("linear", 0, slice(None), 3, (1.0,), marks=pytest.mark.soak),
        ("nonlinear", 2, slice(35, 70), 6, (0.7,)),
        *(
            pytest.param("linear", n, slice(None), 1000, eta, marks=pytest.mark.soak)
            for n in range(3)
            for eta in ((0.5, 0.9, 0.0), (1.0,))
        ),
        *(
            pytest.param(
                "nonlinear", n, slice(None), 1000, (e,), marks=pytest.mark.soak
            )
            for n in range(3)
            for e in (0.5, 0.9, 1.0)
        ),
    ],
)
def test_records_against_an_integration_that_shares_no_code(
    model, record, part, count, etas
):
    motion, (system, _) = (
        motion_of_samples(RECORDS[record][part], 0.04),
        SYSTEMS[MODELS[model]],
    )
    (amplitude, omega), eta = random_cells(count, record), np.resize(etas, count)
    if 1.0 in etas:  # without loss some never end: only those that bounce little
        amplitude += 2.0
        for less, most in ((0.98, 40), (1.0, 200)):
            few = (
                response(system, motion, amplitude, omega, less).impacts_at_least < most
            )
            amplitude, omega, eta = amplitude[few], omega[few], eta[few]
    outcome, theta, _ = answers(
        motion, amplitude, omega, eta, alpha=ALPHA if model == "nonlinear" else None
    )
    allowed = room(system) * allowance(motion, amplitude, omega, eta, system)
    for respond, more in ((response, 1.0), (response_alone, 10.0)):
        assert_same(
            respond(system, motion, amplitude, omega, eta),
            theta,
            outcome,
            more * allowed,
        )
    assert np.unique(outcome).size >= 2 or 1.0 in etas


def against_the_march(name, motion, long, count, seed):
    """On arrays and one at a time: outcomes and impacts equal, rotations within what
    rounding, or the tolerance of series, may come to.
    """
    (system, eta), (amplitude, omega) = SYSTEMS[name], random_cells(count, seed)
    omega *= 8.0 if motion.samples is None else 1.0
    omega[:2] /= 40.0  # samples that a step does not reach
    etas = np.full(count, eta)
    run = Run(Batch.of(system, system.segments(long), amplitude, omega))
    run.all()
    rounding = allowance(motion, amplitude, omega, etas, system)
    found = response(system, motion, amplitude, omega, etas)
    assert_same(found, run.theta_ratio, run.outcome, room(system) * rounding)
    np.testing.assert_array_equal(found.impacts_at_least, run.impacts)
    for respond in (response, response_alone):
        np.testing.assert_array_equal(
            respond(system, motion, amplitude, omega, etas, peaks=False).outcome,
            run.outcome,
        )
    assert_same(
        response_alone(system, motion, amplitude, omega, etas),
        run.theta_ratio,
        run.outcome,
        1e3 * rounding,
    )
    assert set(found.outcome) > ({Outcome.ROCKED} if motion.samples else set())


@pytest.mark.slow
@pytest.mark.parametrize("name", quick(SYSTEMS, *QUICK[1:3]))
def test_the_same_as_the_march_by_long_series(name):
    motion = (
        motion_of_samples(RECORDS[1], 0.03)
        if SYSTEMS[name][0].equation.bounded
        else motion_of_samples(RECORDS[0][30:70], 0.05)
    )
    against_the_march(name, motion, long_series(motion), 8, 5)


@pytest.mark.parametrize("name", quick(("the oscillator", QUICK[2]), QUICK[2]))
def test_the_same_as_that_march_on_ground_that_moves_upwards_too(name):
    against_the_march(name, *weighed(slice(36, 52), 0.5, 2), 5, 5)


@pytest.mark.parametrize(
    "motion",
    [
        cosine(1.5),
        pytest.param(pulse("ricker-symmetric"), marks=pytest.mark.soak),
        with_vertical(sine(), cosine(), 0.4),
    ],
    ids=lambda m: m.name,
)
def test_one_arch_at_a_time_is_the_march_under_a_pulse(motion):
    against_the_march("an arch", motion, motion, 4, 8)


@pytest.mark.soak
@pytest.mark.parametrize("record", range(3))
@pytest.mark.parametrize("name", quick(SYSTEMS, *QUICK))
def test_many_cells_of_each_system(name, record):
    motion = motion_of_samples(RECORDS[record], 0.04)
    against_the_march(name, motion, long_series(motion), 300, 20 + record)
    against_the_march(
        name,
        *weighed(slice(None, 100), (0.3, -1.2, 0.6)[record], record),
        60,
        20 + record,
    )


@pytest.mark.parametrize("model", quick(MODELS, "linear"))
def test_samples_that_change_nothing(model):
    """The refined, delayed and continued record."""
    samples, (system, _) = (
        np.concatenate([[0.0], RECORDS[2][31:89], [0.0]]),
        SYSTEMS[MODELS[model]],
    )
    cell, motion = (
        (*random_cells(5, 7), np.full(5, 0.8)),
        motion_of_samples(samples, 0.04),
    )
    first = response(system, motion, *cell)
    fine = np.interp(
        np.arange(4 * samples.size - 3) / 4.0, np.arange(samples.size), samples
    )
    allowed = room(system) * allowance(motion, *cell, system)
    delayed, continued = (
        np.append(np.zeros(33), samples),
        np.append(samples, np.zeros(100)),
    )
    for other in (
        motion_of_samples(fine, 0.01),
        motion_of_samples(delayed, 0.04),
        motion_of_samples(continued, 0.04),
    ):
        assert_same(
            response(system, other, *cell), first.theta_ratio, first.outcome, allowed
        )


@pytest.mark.parametrize("alpha", [0.2, 0.4])
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


@pytest.mark.parametrize(
    ("lifts", "falls", "outcome"),
    [
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
