"""Sequences of impacts that are ended early or given up: marching on finds the same."""

import numpy as np
import pytest

from rocking_cli import (
    Outcome,
    cosine,
    linear_response,
    pulse,
    sine,
)
from rocking_cli.dynamics import batch
from rocking_cli.dynamics.march import proofs


@pytest.mark.parametrize(
    ("omega", "eta"),
    [([2.0, 8.0], 1.0 - 1e-9), (0.5, np.array([0.9, 1.0 - 1e-9, 1.0]))],
    ids=["lifted by the second half of a cycle", "lifted twice"],
)
def test_bodies_that_hardly_leave_the_ground_and_would_bounce_for_ever_are_at_rest(
    omega, eta
):
    found = linear_response(sine(), 1.0 + 1e-9, omega, eta)
    assert np.all(found.outcome == Outcome.ROCKED)
    assert found.work.steps < 200
    if np.size(eta) > 1:
        assert found.theta_ratio == pytest.approx(
            found.theta_ratio[0], rel=1e-6
        )  # the first arc is the highest


@pytest.mark.soak
@pytest.mark.parametrize(
    "motion",
    [
        cosine(1.5),
        pytest.param(pulse("ricker-symmetric"), marks=pytest.mark.soak),
    ],
    ids=lambda m: m.name,
)
def test_given_up_is_what_would_have_been_given_up(motion, monkeypatch):
    monkeypatch.setattr(batch, "MAX_STEPS", 150)
    random = np.random.default_rng(5)
    amplitude, omega = (
        1.0 + 10.0 ** random.uniform(-9.0, -1.0, 40),
        10.0 ** random.uniform(-1.0, 1.0, 40),
    )
    eta = random.choice([1.0, 1.0 - 1e-9, 1.0 - 1e-5, 0.999], 40)
    early = linear_response(motion, amplitude, omega, eta)
    monkeypatch.setattr(proofs, "TOO_MANY_IMPACTS", proofs.FREE_MOTION)
    late = linear_response(motion, amplitude, omega, eta)
    assert np.array_equal(early.outcome, late.outcome)
    assert np.array_equal(early.theta_ratio, late.theta_ratio, equal_nan=True)
    assert early.work.steps < 0.6 * late.work.steps
    assert 10 < (early.outcome == Outcome.FAILED).sum() < 30
