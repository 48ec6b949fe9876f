"""Sequences of impacts that are below rounding are rest."""

import numpy as np
import pytest

from rocking_cli import (
    Outcome,
    linear_response,
    sine,
)


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
