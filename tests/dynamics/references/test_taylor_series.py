"""The slower path of linear cells against the engine."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.multiple_precision import march
from oracles.record_lockstep import lockstep
from oracles.single_cell import LADDER, condition
from support.record_layouts import wave
from support.synthetic_records import shaken

from rocking_cli import Outcome, cosine, linear_response, sine
from rocking_cli.dynamics.references import taylor_series
from rocking_cli.dynamics.references.taylor_series import reference_cell
from rocking_cli.motions import Motion, Piece


def test_the_reference_sees_a_bounce_that_the_drive_lifts_again():
    # After its second impact this body bounces for 1e-8 and lifts off again within the same step of the reference.
    for eta in (1e-6, 1e-5, 6.1e-5, 1e-4, 1e-3):
        found = linear_response(cosine(1), 11.625, 11.0, eta).theta_ratio
        assert reference_cell(cosine(1), 11.625, 11.0, eta)[1] == pytest.approx(float(found), abs=1e-12)


def test_the_reference_sees_a_dip_between_its_marks():
    """A block that a record lifts again before it is an eighth of a step below the ground; it overturns after that impact."""
    motion, eta, omega = shaken(-0.5 * wave(40)[::-1], 0.06), 0.9183055975794251, 1.0 / 5.349519445453641
    (outcome,), _ = lockstep(*reversed(motion.samples), *np.array([[3.02446], [omega], [eta]]))
    assert outcome == Outcome.OVERTURNED_AFTER_IMPACT
    assert reference_cell(motion, 3.02446, omega, eta)[0] == outcome


@settings(max_examples=60)
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
        scale = float(condition(motion, amplitude, omega, eta))
        if not math.isnan(scale):
            assert abs(theta - response.theta_ratio) <= 1e3 * np.finfo(float).eps * scale


def test_the_limit_of_steps_grows_with_the_motion(monkeypatch):
    """A record has a step or more a piece, however long it is."""
    monkeypatch.setattr(taylor_series, "_MAX_STEPS", 20)
    heights = np.random.default_rng(0).uniform(-1.0, 1.0, 101)
    pieces = tuple(Piece(float(i), i + 1.0, (), float(a), float(b - a)) for i, (a, b) in enumerate(pairwise(heights)))
    motion = Motion("record", pieces)
    found = linear_response(motion, 1.5, 12.0, 0.7)
    outcome, theta = reference_cell(motion, 1.5, 12.0, 0.7)
    assert outcome == found.outcome == Outcome.ROCKED
    assert theta == pytest.approx(float(found.theta_ratio), abs=1e-13)


@pytest.mark.parametrize("omega", [1e-4, 1e-2, 1.0, 100.0])
def test_an_uplift_shorter_than_a_step_is_seen(omega):
    """The drive exceeds 1 by 1e-9 for 9e-5 rad, and in a slow pulse the body waits for it through 1e5 of its own steps."""
    outcome, theta = reference_cell(sine(), 1.0 + 1e-9, omega, 0.5)
    found = linear_response(sine(), 1.0 + 1e-9, omega, 0.5)
    assert outcome == found.outcome == Outcome.ROCKED
    assert theta == pytest.approx(float(found.theta_ratio), rel=1e-5, abs=0)  # rounding of the drive over its excess: 2e-7


def test_the_reference_equals_fifty_digits():
    for motion, amplitude, omega, eta in ((sine(2), 1.3, 2.5, 0.6), (cosine(1), 3.0, 6.0, 0.9)):
        flag, theta, _ = march(motion, amplitude, omega, eta)
        outcome, peak = reference_cell(motion, amplitude, omega, eta)
        assert outcome.flag == flag
        assert math.isnan(theta) or peak == pytest.approx(theta, abs=1e-13)
