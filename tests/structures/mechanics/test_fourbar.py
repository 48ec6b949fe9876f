"""The four-bar linkage of an arch against a general solver and against sums over its material."""

import math

import numpy as np
import pytest
from scipy.optimize import fsolve

from rocking_cli.structures.mechanics.fourbar import FourBar, Ring

RING = Ring(10.0, 1.5, math.radians(157.5))


def test_finite_kinematics_equal_a_numerical_solution_of_the_loop():
    """M, V' and B from positions found by a general solver and differentiated numerically."""
    bar = FourBar(RING, tuple(np.radians([0, 67.5, 112.5, 157.5])))
    a, b, c, d = bar.points

    def turn(v, q):
        return np.array([math.cos(q) * v[0] + math.sin(q) * v[1], math.cos(q) * v[1] - math.sin(q) * v[0]])

    def positions(phi):
        bn = a + turn(b - a, phi)
        q2, q3 = fsolve(lambda q: bn + turn(c - b, q[0]) + turn(d - c, q[1]) - d, [0.0, 0.0], xtol=1e-12)
        centres = [np.array([m.x, m.z]) / m.mass for m in bar.links]
        return [
            (a + turn(centres[0] - a, phi), phi),
            (bn + turn(centres[1] - b, q2), q2),
            (d + turn(centres[2] - d, q3), q3),
        ]

    h = 1e-5
    for phi in (0.0, 0.02, 0.06, 0.1):
        lift = push = inertia = 0.0
        for m, (x1, q1), (x2, q2) in zip(bar.links, positions(phi - h), positions(phi + h), strict=True):
            u, w = (x2 - x1) / (2 * h), (q2 - q1) / (2 * h)
            lift, push = lift + m.mass * u[1], push + m.mass * u[0]
            inertia += m.mass * u @ u + w * w * m.about(m.x / m.mass, m.z / m.mass)
        found = bar.coefficients(phi)
        assert (float(found.lift), float(found.push), float(found.inertia)) == pytest.approx((lift, push, inertia), rel=1e-6, abs=0)


def test_restitution_equals_integration_over_the_material():
    """eta by summing u.w over a fine mesh of the arch, with velocities taken from the rotation centres of the links."""
    bar = FourBar(RING, tuple(np.radians([0, 67.5, 112.5, 157.5])))
    at, (a, b, _, d) = bar.at_rest(), bar.points
    s, rho = np.meshgrid((np.arange(3150) + 0.5) * RING.angle / 3150, 9.25 + (np.arange(60) + 0.5) * 0.025, indexing="ij")
    polar = math.pi / 2 + RING.angle / 2 - s
    x, z = rho * np.cos(polar), rho * np.sin(polar)

    def field(s, x, z):
        w2, w3 = at.second, at.third
        ux = np.select([s < bar.hinges[1], s < bar.hinges[2]], [z - a[1], b[1] - a[1] + w2 * (z - b[1])], w3 * (z - d[1]))
        uz = np.select([s < bar.hinges[1], s < bar.hinges[2]], [a[0] - x, a[0] - b[0] + w2 * (b[0] - x)], w3 * (d[0] - x))
        return ux, uz

    u = field(s, x, z)
    mirror = field(RING.angle - s, -x, z)
    w = -mirror[0], mirror[1]
    eta = ((-u[0] * w[0] - u[1] * w[1]) * rho).sum() / ((w[0] ** 2 + w[1] ** 2) * rho).sum()
    shared, own = bar.overlap()
    assert shared / own == pytest.approx(eta, abs=2e-5)
