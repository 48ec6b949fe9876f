"""The flow within one interval against 40 digits, also where everything is small."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from rocking_cli.dynamics.samples.ramp import RampFlow, hyperbolic


@pytest.mark.parametrize("h", [1e-9, 3e-4, 0.05, 0.5])
def test_hyperbolic_functions_keep_their_last_digits(h):
    with mpmath.workdps(40):
        exact = [mpmath.sinh(h), mpmath.cosh(h) - 1, mpmath.sinh(h) - mpmath.mpf(h)]
        for found, wanted in zip(hyperbolic(np.array([h])), exact, strict=True):
            assert abs(found[0] / wanted - 1) < 1e-15


@pytest.mark.parametrize("h", [1e-7, 0.02, 0.5])
@pytest.mark.parametrize("state", [(0.0, 0.0, 0.0, 2.0), (0.0, 1e-6, -0.3, 0.7), (0.4, -0.5, 1.1, -3.0)])
def test_the_flow_solves_the_equation(h, state):
    y, v, b, rate = state
    point = RampFlow(*(np.array([x]) for x in state)).at(np.array([h]))
    with mpmath.workdps(40):
        sinh, cosh = mpmath.sinh(h), mpmath.cosh(h)
        exact = y + v * sinh + b * (cosh - 1) + rate * (sinh - h), v * cosh + b * sinh + rate * (cosh - 1)
        size = [abs(v) * h + abs(b) * h * h + abs(rate) * h**3, abs(v) + abs(b) * h + abs(rate) * h * h]
        for found, wanted, scale in zip(point[:2], exact, size, strict=True):
            assert abs(found[0] - wanted) <= 4e-16 * (abs(wanted) + scale)
    # y - 1 + a, and its rate: a rounding of each of the terms
    assert abs(point.b[0] - (point.y[0] - y + b + rate * h)) <= 1e-15 * (abs(y) + abs(b) + abs(rate * h) + abs(point.y[0]))
    assert abs(point.j[0] - (point.v[0] + rate)) <= 1e-15 * (abs(point.v[0]) + abs(rate))
