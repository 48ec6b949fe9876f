"""The slower path of nonlinear cells against an independent integration."""

from __future__ import annotations

import math

import numpy as np
from oracle import integrate_rigid_body

from rocking_cli import sine
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
