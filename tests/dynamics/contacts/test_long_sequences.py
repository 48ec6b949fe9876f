"""Sequences of impacts that are given up beforehand."""

import numpy as np
import pytest

from rocking_cli.dynamics.march import batch, closings
from rocking_cli.dynamics.outcome import Outcome
from rocking_cli.dynamics.response import linear_response
from rocking_cli.motions import cosine, sine


@pytest.mark.parametrize("motion", [cosine(1.5)], ids=lambda m: m.name)
def test_given_up_is_what_would_have_been_given_up(motion, monkeypatch):
    monkeypatch.setattr(batch, "MAX_STEPS", 60)
    random = np.random.default_rng(5)
    amplitude = 1.0 + 10.0 ** random.uniform(-10.0, -1.0, 100)
    omega, eta = 10.0 ** random.uniform(-1.0, 1.0, 100), 1.0 - 10.0 ** random.uniform(-10.0, -3.0, 100)
    early = linear_response(motion, amplitude, omega, eta)
    monkeypatch.setattr(closings, "AT_IMPACTS", closings.AT_IMPACTS[:-1])
    late = linear_response(motion, amplitude, omega, eta)
    assert np.array_equal(early.outcome, late.outcome)
    assert np.array_equal(early.theta_ratio, late.theta_ratio, equal_nan=True)
    assert early.work.steps < 0.8 * late.work.steps
    assert 10 < (early.outcome == Outcome.FAILED).sum() < 90


def test_bodies_that_hardly_leave_the_ground_and_would_bounce_for_ever_are_at_rest():
    found = linear_response(sine(), 1.0 + 1e-9, 0.5, np.array([0.9, 1.0 - 1e-9, 1.0]))
    assert np.all(found.outcome == Outcome.ROCKED)
    assert found.work.steps < 200
    assert found.theta_ratio == pytest.approx(found.theta_ratio[0], rel=1e-6)  # the first arc is the highest
