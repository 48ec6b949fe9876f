"""The exact flow against high precision."""

from __future__ import annotations

import math
from itertools import product

import mpmath
import numpy as np
import pytest

from rocking_cli.dynamics.equations.flow import LinearFlow


def one(x):
    return np.array([x])


def exact(y, v, a0, rate, w, ramp, h):
    """y(h) and v(h) in 60 digits from variation of constants: y'' = y - 1 + a0 cos(wt) + rate sin(wt)/1 + ramp t."""
    mpmath.mp.dps = 60
    y, v, a0, rate, w, ramp, h = (mpmath.mpf(float(x)) for x in (y, v, a0, rate, w, ramp, h))

    def kernel(u, f):
        return f(h - u) * (a0 * mpmath.cos(w * u) + rate * mpmath.sin(w * u) + ramp * u - 1)

    return (
        y * mpmath.cosh(h) + v * mpmath.sinh(h) + mpmath.quad(lambda u: kernel(u, mpmath.sinh), mpmath.linspace(0, h, 9)),
        y * mpmath.sinh(h) + v * mpmath.cosh(h) + mpmath.quad(lambda u: kernel(u, mpmath.cosh), mpmath.linspace(0, h, 9)),
    )


STEPS, FREQUENCIES, STARTS = (
    (1e-7, 1e-3, 0.04, 0.3, 1.7, 6.0),
    (1e-3, 0.7, 5.0, 40.0),
    ((0.0, 0.0, 1.0), (0.3, -0.2, -2.5), (0.0, 1e-6, 0.2)),
)
EVERY = list(product(STEPS, FREQUENCIES, STARTS))  # one of five of them, which meets each value, stands for the others


@pytest.mark.parametrize(
    ("h", "w", "start"), [*EVERY[::5], *(pytest.param(*x, marks=pytest.mark.soak) for i, x in enumerate(EVERY) if i % 5)]
)
def test_flow_equals_variation_of_constants_in_60_digits(h, w, start):
    y0, v0, a0 = start
    rate, ramp = 1.3, 0.4
    arc = LinearFlow(one(y0), one(v0), one(y0 - 1.0 + a0), one([rate]).T, one([a0]).T, one([w]).T, one(ramp))
    point = arc.at(one(h))
    y, v = exact(y0, v0, a0, rate, w, ramp, h)
    # y and v are sums of terms that may cancel: the error is a few units in the last place of the largest of them.
    size_y = abs(y0) + abs(v0) * math.sinh(h) + (abs(y0 - 1 + a0) + abs(a0)) * 2 * math.sinh(h / 2) ** 2 + abs(float(y))
    size_v = abs(v0) * math.cosh(h) + (abs(y0 - 1 + a0) + abs(a0) + rate) * math.sinh(h) + abs(float(v))
    assert abs(float(point.y[0] - y)) < 2e-15 * (size_y + 1e-3 * rate * min(1.0, w * h) * h * h)
    assert abs(float(point.v[0] - v)) < 2e-15 * size_v
    step = 1e-4 * min(1.0, 1.0 / w)
    accelerations = (arc.at(one(h + step)).v - arc.at(one(h - step if h > step else h)).v) / (step + min(step, h if h > step else 0.0))
    if h > 0.01:
        assert abs(accelerations[0] - point.b[0]) < 1e-6 * (1 + abs(point.b[0]) + w * w)


def test_uplift_from_rest_is_a_triple_root_without_noise():
    """After uplift y starts as (rate w) h^3/6; at h = 1e-6 that is 1e-18, far below the rounding of terms of order one."""
    a = 1.5
    rate = math.sqrt(a * a - 1)
    arc = LinearFlow(np.zeros(1), np.zeros(1), np.zeros(1), np.array([[rate]]), np.array([[1.0]]), np.array([[3.0]]), None)
    for h in (1e-6, 1e-5, 1e-4):
        expected = 3.0 * rate * h**3 / 6 - 9.0 * h**4 / 24
        assert arc.at(np.array([h])).y[0] == pytest.approx(expected, rel=1e-7, abs=0)


def test_free_rocking_period_is_housners():
    """Slender free period pT = 4 arccosh(1/(1-x0)), Housner's formula: a quarter of it leads from rest at x0 to the ground."""
    for x0 in (1e-6, 0.1, 0.5, 0.9, 0.999):
        quarter = math.acosh(1 / (1 - x0)) if x0 > 1e-3 else math.sqrt(2 * x0) * (1 + 5 * x0 / 12)
        still = np.zeros((1, 1))
        arc = LinearFlow(np.array([x0]), np.zeros(1), np.array([x0 - 1.0]), still, still, np.ones((1, 1)), None)
        assert abs(arc.at(np.array([quarter])).y[0]) < 1e-15 + 1e-11 * x0
