"""The slower path of nonlinear cells against an independent integration."""

from __future__ import annotations

import math

import numpy as np
from oracles.single_cell import integrate_rigid_body

from rocking_cli import Outcome, nonlinear_response, pulse, sine
from rocking_cli.dynamics.references.general_solver import Problem, RigidBodyRates, solve_cell


def test_the_check_of_sweeps_is_itself_right():
    """`solve_cell`, on which the estimated error of nonlinear sweeps rests, against the oracle."""
    # The last three hold arcs shorter than its steps, right after uplift.
    odd = [(1.3739303, 8.18093324, 1.0, 0.82321594), (1.77887648, 2.65944071, 1.0, 1.03821494), (1.2, 2.0, 0.3, 1.0)]
    random = np.random.default_rng(1)
    draw = np.array([random.uniform(a, b, 30) for a, b in ((0.9, 12), (0.5, 12), (0.5, 1), (0.05, 0.6))]).T.tolist()
    for case in [*draw, *odd]:
        flag, theta = integrate_rigid_body(np.sin, 2 * math.pi, *case)
        outcome, peak = solve_cell(sine(), *case[:3], Problem(RigidBodyRates(case[3]), RigidBodyRates(case[3]), case[3]))
        assert outcome.flag == flag
        assert math.isnan(theta) or abs(peak - theta) < 1e-9


def test_a_body_that_lies_on_its_side_is_not_followed():
    """Under 1e8 times its uplift it would turn over a million times within one stride."""
    calls = 0

    class Counted(RigidBodyRates):
        def __call__(self, theta, w, push, weight=1.0):
            nonlocal calls
            calls += 1
            return super().__call__(theta, w, push, weight)

    outcome, _ = solve_cell(sine(), 1e8, 0.01, 0.9, Problem(Counted(0.25), Counted(0.25), 0.25))
    assert outcome == Outcome.OVERTURNED_NO_IMPACT
    assert calls < 20_000


def test_still_ground_is_crossed_in_strides_of_the_body_itself():
    """After an impulse of 3e-4 in tau the body rocks for several: the fate does not take 1e5 strides of the impulse."""
    rates = RigidBodyRates(0.25)
    outcome, theta = solve_cell(pulse("half-sine"), 3000.0, 1e4, 0.5, Problem(rates, rates, 0.25))
    found = nonlinear_response(pulse("half-sine"), 3000.0, 1e4, 0.5, 0.25, tolerance=1e-12)
    assert outcome == found.outcome == Outcome.ROCKED
    assert abs(theta - float(found.theta_ratio)) < 1e-12
