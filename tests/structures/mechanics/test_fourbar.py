"""The four-bar linkage of an arch against a general solver."""

import math

import numpy as np
import pytest
from scipy.optimize import fsolve

from rocking_cli.structures.mechanics.fourbar import FourBar, Ring


def test_finite_kinematics_equal_a_numerical_solution_of_the_loop():
    """M, V' and B from positions found by a general solver and differentiated
    numerically.
    """
    bar = FourBar(
        Ring(10.0, 1.5, math.radians(157.5)), tuple(np.radians([0, 67.5, 112.5, 157.5]))
    )
    a, b, c, d = bar.points

    def turn(v, q):
        return np.array(
            [
                math.cos(q) * v[0] + math.sin(q) * v[1],
                math.cos(q) * v[1] - math.sin(q) * v[0],
            ]
        )

    def positions(phi):
        bn = a + turn(b - a, phi)
        q2, q3 = fsolve(
            lambda q: bn + turn(c - b, q[0]) + turn(d - c, q[1]) - d,
            [0.0, 0.0],
            xtol=1e-12,
        )
        centres = [np.array([m.x, m.z]) / m.mass for m in bar.links]
        return [
            (a + turn(centres[0] - a, phi), phi),
            (bn + turn(centres[1] - b, q2), q2),
            (d + turn(centres[2] - d, q3), q3),
        ]

    h = 1e-5
    for phi in (0.0, 0.02, 0.06, 0.1):
        lift = push = inertia = 0.0
        for m, (x1, q1), (x2, q2) in zip(
            bar.links, positions(phi - h), positions(phi + h), strict=True
        ):
            u, w = (x2 - x1) / (2 * h), (q2 - q1) / (2 * h)
            lift, push = lift + m.mass * u[1], push + m.mass * u[0]
            inertia += m.mass * u @ u + w * w * m.about(m.x / m.mass, m.z / m.mass)
        found = bar.coefficients(phi)
        assert (
            float(found.lift),
            float(found.push),
            float(found.inertia),
        ) == pytest.approx((lift, push, inertia), rel=1e-6, abs=0)
