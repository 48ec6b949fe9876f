"""The slower path of linear cells against the engine."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracle import LADDER

from rocking_cli import Outcome, cosine, linear_response, sine
from rocking_cli.dynamics.references.taylor_series import reference_cell


def test_the_reference_sees_a_bounce_that_the_drive_lifts_again():
    # After its second impact this body bounces for 1e-8 and lifts off again within the same step of the reference.
    for eta in (1e-6, 1e-5, 6.1e-5, 1e-4, 1e-3):
        found = linear_response(cosine(1), 11.625, 11.0, eta).theta_ratio
        assert reference_cell(cosine(1), 11.625, 11.0, eta)[1] == pytest.approx(float(found), abs=1e-12)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.5, 20), st.floats(0.2, 20), st.floats(0, 0.99),
    st.sampled_from([sine(0.5), sine(1), sine(2), cosine(1), cosine(1.5), LADDER]),
)  # fmt: skip
def test_engine_and_taylor_reference_agree(amplitude, omega, eta, motion):
    response = linear_response(motion, amplitude, omega, eta)
    outcome, theta = reference_cell(motion, amplitude, omega, eta)
    # A cell within rounding of a boundary may fall on either side of it; neighbours at 1e-9 show such a cell.
    near = linear_response(motion, amplitude * np.array([1 - 1e-9, 1 + 1e-9]), omega, eta)
    if (near.outcome == response.outcome).all():
        assert outcome == response.outcome
        if outcome == Outcome.ROCKED:
            spread = float(np.ptp(near.theta_ratio))  # the cell's own sensitivity to 1e-9 in A
            assert abs(theta - response.theta_ratio) < 1e-11 + 1e-3 * spread
