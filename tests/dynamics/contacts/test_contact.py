"""The closed form after the shaking against marching."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rocking_cli.dynamics.contacts.contact import Symmetric
from rocking_cli.dynamics.equations.linear import LinearEquation


def march(y, v, eta):
    """The free motion in small steps of its exact hyperbolic flow, impact by impact: overturns, and the largest y."""
    peak, h, bounces = (y if v > 0 else 0.0), 1e-3, 0
    c, s = math.cosh(h), math.sinh(h)
    for _ in range(200_000):
        y, v = 1 + (y - 1) * c + v * s, (y - 1) * s + v * c
        peak = max(peak, y)
        if y < 0:
            y, v, bounces = 0.0, -eta * v, bounces + 1
        if y > 3:
            return True, peak
        if bounces > 2:
            return False, peak
    raise AssertionError("undecided")


def test_free_motion_equals_marching(lanes):
    random = np.random.default_rng(4)
    y, v, eta = random.uniform(0, 1.5, 60), random.uniform(-2, 1.2, 60), random.uniform(0.3, 1, 60)
    free = Symmetric().free_motion(LinearEquation(), lanes(np.ones(60), eta=eta), np.arange(60), y, v)
    for i in range(60):
        overturns, peak = march(y[i], v[i], eta[i])
        assert overturns == (free.overturns[i] or free.overturns_after_impact[i])
        if not overturns and v[i] > 0:
            assert free.peak[i] == pytest.approx(peak, abs=2e-3)
