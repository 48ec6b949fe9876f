"""The conditioning by which tests judge sensitive cells."""

import math

import numpy as np
import pytest
from oracles.collocation import Body, Edge, conditioning

LEFT = Edge(1.7, 0.15, 0.95)
UNEQUAL = Body(Edge(2.1, 0.25, 0.85), LEFT)


def test_conditioning_is_the_slope_of_the_answer():
    smooth = conditioning(UNEQUAL, np.sin, 2 * math.pi, 1.4 * UNEQUAL.threshold(-1), 9.0)
    slow = conditioning(UNEQUAL, np.sin, 2 * math.pi, 1.4 * UNEQUAL.threshold(-1), 9.0, delta=1e-6)
    assert 0.0 < smooth < 100.0
    assert smooth == pytest.approx(slow, rel=1e-3, abs=0)
    boundary = 1.0 / (1.0 - math.exp(-1.0)) * LEFT.alpha * UNEQUAL.gravity
    assert conditioning(UNEQUAL, np.ones_like, 1.0, boundary, LEFT.p) == math.inf
