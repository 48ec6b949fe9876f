"""One body at a time on floats: what a step may not miss; its answers stand in
test_conformance.py and samples/test_records.py.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
from support.bodies import ALPHA, random_body
from support.synthetic_records import RECORDS, motion_of_samples, noise

from rocking_cli import (
    LinearEquation,
    Method,
    Motion,
    Outcome,
    RigidBodyEquation,
    System,
    cosine,
    response,
    sine,
)
from rocking_cli.dynamics.one.step import one_turn, root, turn_of
from rocking_cli.motions import Harmonic, Piece

response_alone = partial(response, how="floats")


@pytest.mark.soak
def test_a_body_that_bounces_for_ever_fails_as_on_arrays():
    system, motion = (
        System(RigidBodyEquation(ALPHA)),
        motion_of_samples(RECORDS[0][30:60], 0.05),
    )
    for a in (1.05, 1.5):
        assert (
            response_alone(system, motion, a, 0.5, 1.0).outcome
            == response(system, motion, np.array(a), np.array(0.5), 1.0).outcome
        )


def polynomial(*coefficients):
    """The terms of y by x, from those of y'."""
    return [1.0, *(c / n for n, c in enumerate(coefficients, 1))]


def test_lemma_1_a_step_is_cut_where_it_may_turn_twice():
    """y' = (x - 0.4)(x - 0.6) and a little more, so that it only slows."""
    share, outward, turns = one_turn(polynomial(0.24, -1.0, 1.0))
    assert (share, outward, turns) == (0.5, True, True)
    assert turn_of(polynomial(0.24, -0.5, 0.25)) == pytest.approx(0.8, rel=1e-14)
    share, outward, turns = one_turn(polynomial(0.26, -1.0, 1.0))
    assert (share < 1.0, outward, turns) == (True, True, False)


def test_lemma_1_holds_for_random_polynomials():
    """As many of the roots that a polynomial is made of lie in the step."""
    random, several = np.random.default_rng(1), 0
    for _ in range(300):
        roots = random.uniform(-0.5, 1.5, random.integers(1, 7))
        rate = np.polynomial.polynomial.polyfromroots(roots)
        share, outward, turns = one_turn(polynomial(*rate.tolist()))
        assert np.count_nonzero((roots > 0.0) & (roots < share)) == turns
        assert outward == (rate[0] > 0.0)
        several += share < 1.0
    assert several > 30


def test_a_root_is_found_in_its_bracket():
    """y = (t - 0.3)(t - 0.5), and y = t (0.2 - t) from its own start."""
    assert root([0.15, -0.8, 1.0], 0.0, 0.4, 0.1) == pytest.approx(0.3, rel=1e-14)
    assert root([0.0, 0.2, -1.0], 0.1, 1.0, 0.5) == pytest.approx(0.2, rel=1e-14)


def test_a_body_beyond_its_equilibrium_that_moves_in_when_the_shaking_ends():
    """Linear, a push of A = 2 for tau = 1.5, and a pull: the unstable mode y - 1 + y'
    at its end tells what becomes of the body.
    """
    y, v = math.cosh(1.5) - 1.0, math.sinh(1.5)
    seen = set()
    for pull in (4.0, 6.0, 6.5, 7.0):
        motion = Motion(
            "push and pull",
            (Piece(0.0, 1.5, (), -1.0), Piece(1.5, 2.0, (), 0.5 * pull)),
        ).scaled(1.0 / max(1.0, 0.5 * pull))
        amplitude = 2.0 * max(1.0, 0.5 * pull)
        # y'' = y - 1 - pull, from (y, v)
        middle, c, s = 1.0 + pull, math.cosh(0.5), math.sinh(0.5)
        end, speed = middle + (y - middle) * c + v * s, (y - middle) * s + v * c
        found = response_alone(System(LinearEquation()), motion, amplitude, 1.0, 0.1)
        assert end > 1.0
        assert bool(Outcome(int(found.outcome)).overturned) == (end - 1.0 + speed > 0.0)
        seen.add((speed > 0.0, int(found.outcome)))
    assert {(False, Outcome.OVERTURNED_NO_IMPACT), (False, Outcome.ROCKED)} <= seen


@pytest.mark.parametrize("amplitude", [1.0 + 1e-9, 1.0 + 1e-6, 1.001, 1.3])
def test_a_jump_of_the_drive_lifts_the_body_with_a_force(amplitude):
    """Linear: y = (A - 1)(cosh tau - 1) under a constant drive after a quiet time."""
    motion = Motion("late", (Piece(0.0, 1.0), Piece(1.0, 1.7, (), -1.0)))
    found = response_alone(System(LinearEquation()), motion, amplitude, 1.0, 0.9)
    y = (amplitude - 1.0) * (math.cosh(0.7) - 1.0)
    v = (amplitude - 1.0) * math.sinh(0.7)
    peak = 1.0 - math.sqrt((1.0 - y) ** 2 - v * v)
    assert found.theta_ratio == pytest.approx(
        peak, rel=1e-7 if amplitude < 1.001 else 1e-11
    )


def test_a_body_that_has_lain_on_its_side_does_not_come_back():
    """A push over theta = pi/2 and, within the same step, a pull that would bring the
    body back.
    """
    motion = Motion("wave", (Piece(0.0, 40.0, (Harmonic(-1.0, 1.0, 0.0),)),))
    system, outcomes = System(RigidBodyEquation(0.7)), []
    for amplitude in np.geomspace(1.05, 60.0, 20):
        cell = system, motion, amplitude, 1.6, 0.9
        alone, together = response_alone(*cell), response(*cell)
        assert alone.outcome == together.outcome
        outcomes.append(int(alone.outcome))
    assert Outcome.OVERTURNED_NO_IMPACT in outcomes


@pytest.mark.parametrize(
    ("equation", "dt"),
    [
        (LinearEquation(), 1e-5),
        (RigidBodyEquation(ALPHA), 2e-4),
        *(
            pytest.param(equation, dt, marks=pytest.mark.soak)
            for equation in (LinearEquation(), RigidBodyEquation(ALPHA))
            for dt in (1e-3, 2e-4, 1e-5)
        ),
    ],
)
def test_series_of_few_terms_over_short_steps(equation, dt):
    motion = motion_of_samples(noise(60, 0.06, 3).repeat(5), dt)
    system = System(equation)
    cells = system.least_uplift(motion) * np.array([1.01, 6.0]), 1.0, 0.8
    alone, together = (
        response_alone(system, motion, *cells),
        response(system, motion, *cells),
    )
    np.testing.assert_array_equal(alone.outcome, together.outcome)
    np.testing.assert_allclose(alone.theta_ratio, together.theta_ratio, rtol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    "motion",
    [
        motion_of_samples(noise(60, 0.06, 3), 0.06),
        pytest.param(sine(2), marks=pytest.mark.soak),
        pytest.param(cosine(), marks=pytest.mark.soak),
    ],
    ids=["record", "sine", "cosine"],
)
@pytest.mark.parametrize("kind", ["plain", "unequal", "one-sided"])
def test_a_body_loses_contact_where_it_does_on_arrays(kind, motion):
    random, seen = np.random.default_rng(4), set()
    for model in ("linear", "nonlinear"):
        body, _, _ = random_body(kind, random, (0.4, 1.2), (0.4, 0.9), 0.3)
        system = Method(model, 1e-10).system_of(body)
        cells = (
            system.least_uplift(motion) * np.geomspace(1.1, 7.0, 5),
            0.5 if motion.samples else 2.0,
            body.eta,
        )
        together, alone = (
            respond(system, motion, *cells, peaks=False).outcome
            for respond in (response, response_alone)
        )
        np.testing.assert_array_equal(alone, together)
        seen.update(alone.tolist())
    assert {Outcome.ROCKED, Outcome.LOST_CONTACT} <= seen
