"""Sequences of impacts that are closed or given up early: marching on gives the same outcome and peak."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli import Outcome, cosine, linear_response, pulse, sine
from rocking_cli.dynamics.contacts.sequences import settles
from rocking_cli.dynamics.lanes import Lanes
from rocking_cli.dynamics.march import closings

MOTIONS = [sine(), sine(3), cosine(1.5), pulse("rectangular"), pulse("ricker-symmetric"), pulse("mavroeidis-papageorgiou")]


def test_what_a_motion_varies_later_is_counted_with_its_jumps():
    wave, step = sine().segments, cosine(1).segments
    assert wave.variation == pytest.approx([3.0, 1.0, 0.0], rel=1e-14)  # 1 to -1, and back to 0
    assert wave.largest_later == pytest.approx([1.0, 1.0, 0.0], rel=1e-14)
    assert step.variation == pytest.approx([3.0, 1.0], rel=1e-14)  # -1 to 1, and down to still ground
    assert step.largest_later == pytest.approx([1.0, 0.0], rel=1e-14)


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
def test_marching_on_finds_the_same_peak(motion, monkeypatch):
    random = np.random.default_rng(11)
    amplitude, omega = random.uniform(1.0, 3.0, 150), random.uniform(0.5, 8.0, 150)
    eta = random.choice([0.0, 0.3, 0.9, 0.99], 150)
    settled = linear_response(motion, amplitude, omega, eta)
    monkeypatch.setattr(closings, "SETTLES", closings.FREE_MOTION)
    marched = linear_response(motion, amplitude, omega, eta)
    np.testing.assert_array_equal(settled.outcome, marched.outcome)
    np.testing.assert_array_equal(settled.theta_ratio, marched.theta_ratio)
    assert marched.work.steps >= settled.work.steps
    assert np.all(settled.impacts <= marched.impacts)


def test_sequences_that_only_the_end_of_the_shaking_ends_are_not_followed():
    """Without loss a bounce never ends: bodies just lifted by the second half of a sine cycle have it behind them."""
    found = linear_response(sine(), 1.0 + 1e-9, [2.0, 8.0], 1.0 - 1e-9)
    assert found.outcome.tolist() == [Outcome.ROCKED, Outcome.ROCKED]
    assert found.work.steps < 200


def test_a_body_at_the_bound_is_marched():
    """e = 0.5 and V = 1 by hand: v^2 exp(8/3) <= 3/4 (1 - e)^2, and <= 3/2 (1 - e) of its peak."""
    segments = sine().segments
    most = 0.75 * 0.25 * np.exp(-8.0 / 3.0)
    v, peak = np.sqrt(most * np.array([0.999, 1.001, 0.999, 0.999])), np.array([1.0, 1.0, 0.2501, 0.2497])
    u = np.full(4, 2.0 * np.pi - 1.5 * np.pi - np.arcsin(0.5))  # of the last segment, where a falls from 0.5 to rest: V = 0.5
    lanes = Lanes(
        np.arange(4), np.ones(4), np.ones(4), np.ones(4), np.full(4, 2), u, np.ones(4), np.zeros(4), v, np.full(4, -0.5), peak,
        np.ones(4), np.ones(4),
    )  # fmt: skip
    vars(segments).update(variation=np.full(3, 0.5), largest_later=np.zeros(3))  # and as much again
    assert settles(segments, lanes).tolist() == [True, False, True, False]


def test_bodies_that_hardly_leave_the_ground_and_would_bounce_for_ever_are_at_rest():
    found = linear_response(sine(), 1.0 + 1e-9, 0.5, np.array([0.9, 1.0 - 1e-9, 1.0]))
    assert np.all(found.outcome == Outcome.ROCKED)
    assert found.work.steps < 200
    assert found.theta_ratio == pytest.approx(found.theta_ratio[0], rel=1e-6)  # the first arc is the highest
