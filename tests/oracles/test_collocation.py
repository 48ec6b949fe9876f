"""The conditioning by which tests judge sensitive cells."""

import math

import numpy as np
import pytest
from oracles.collocation import Body, Edge, Shaking, conditioning

LEFT = Edge(1.7, 0.15, 0.95)
UNEQUAL = Body(Edge(2.1, 0.25, 0.85), LEFT)


def test_conditioning_is_the_slope_of_the_answer():
    pulse = Shaking.of(np.sin, 1.4 * LEFT.alpha * UNEQUAL.gravity, 9.0, [2.0 * math.pi])
    smooth, slow = (conditioning(UNEQUAL, pulse, delta) for delta in (1e-9, 1e-6))
    assert 0.0 < smooth < 100.0
    assert smooth == pytest.approx(slow, rel=1e-3, abs=0)
    boundary = 1.0 / (1.0 - math.exp(-1.0)) * LEFT.alpha * UNEQUAL.gravity
    assert (
        conditioning(UNEQUAL, Shaking.of(np.ones_like, boundary, LEFT.p, [1.0]))
        == math.inf
    )
