"""The nonlinear rigid body: independent numbers, order and tolerance, energy, periods,
and the linear limit.
"""

import math

import numpy as np
import pytest
from support.references import integrated, lanes

from rocking_cli import Outcome, cosine, nonlinear_response, sine
from rocking_cli.dynamics.condition import slope_between
from rocking_cli.dynamics.equations.rigid_body import RigidBodyEquation
from rocking_cli.motions import Harmonic, Motion, Piece


@pytest.mark.slow
@pytest.mark.parametrize("n", [4, pytest.param(200, marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    ("motion", "most"),
    [(sine(), 12), (cosine(1.5), 5)],
    ids=["sine", "a jump at the start"],
)
def test_random_cells_stay_within_five_tolerances(motion, most, n):
    random, tolerances = (
        np.random.default_rng(1),
        (1e-4, 1e-7, 1e-9, 1e-11),
    )
    draw = [
        random.uniform(a, b, 200)[:n]
        for a, b in ((0.9, most), (0.5, 12), (0.5, 1), (0.05, 0.6))
    ]
    for amplitude, omega, eta, alpha in zip(*draw, strict=True):
        around = nonlinear_response(
            motion,
            amplitude * np.array([1 - 1e-7, 1 + 1e-7]),
            omega,
            eta,
            alpha,
            tolerance=1e-11,
        ).outcome
        flag, theta, _ = integrated(motion, amplitude, omega, eta, alpha)
        for tolerance in tolerances:
            found = nonlinear_response(
                motion, amplitude, omega, eta, alpha, tolerance=tolerance
            )
            if (
                around[0] == around[1]
            ):  # no boundary of outcome within 1e-7 of the amplitude
                assert Outcome(int(found.outcome)).flag == flag, tolerance
            assert (
                math.isnan(theta)
                or abs(float(found.theta_ratio) - theta) < 5 * tolerance
            ), tolerance


def test_order_of_the_flow_is_the_order_of_its_series():
    """Error after one step against its length, log-log slope by regression: the first
    term left out.
    """
    still = Motion(
        "still", (Piece(0.0, 1.0, (Harmonic(0.0),)),)
    ).segments  # a sinusoid, though of no height, calls for the long series
    models, steps = (
        [RigidBodyEquation(0.4, tolerance) for tolerance in (1e-4, 1e-13)],
        np.geomspace(0.4, 0.8, 9),
    )
    start = lanes(
        y=0.3, v=0.9, force=-math.sin(0.4 - models[0].sin * 0.3) / models[0].sin
    )
    found, exact = (
        [model.flow(still, start).at(np.array([h])).y[0] for h in steps]
        for model in models
    )
    slope = np.polyfit(np.log(steps), np.log(np.abs(np.subtract(found, exact))), 1)[0]
    assert abs(slope - (models[0].order + 1)) < 0.9


@pytest.mark.parametrize(
    "bad",
    [
        {"alpha": 0.0},
        {"alpha": 1.6},
        {"tolerance": 0.0},
        {"damping": -0.1},
        {"damping": math.inf},
    ],
)
def test_model_checks_its_numbers(bad):
    with pytest.raises(ValueError, match="expected"):
        RigidBodyEquation(**{"alpha": 0.2, "tolerance": 1e-9, **bad})


def test_the_slope_between_two_states_is_that_of_the_force():
    """Of a damped body under a constant drive, in a time in which it hardly moves."""
    equation, y, v, h = RigidBodyEquation(0.5, damping=0.3), 0.4, 0.7, 1e-5

    def force(y):
        return float(equation.force(np.array([y]), np.array([1.5]))[0])

    end = y + h * v, v + h * (force(y) - 2.0 * 0.3 * v)
    wanted = (force(y + 1e-4) - force(y - 1e-4)) / 2e-4
    found = slope_between(equation, (y, v), end, h)
    assert found == pytest.approx(wanted, rel=1e-4)
