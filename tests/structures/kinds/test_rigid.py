"""The body that was measured elsewhere."""

from __future__ import annotations

import math

import pytest
from support.documents import built

STATUE = "kind: rigid\nleft: 0.42\nright: 31 cm\nheight: 1.15\n"


def test_a_block_by_its_mass_centre_is_the_block():
    gyration = math.sqrt((1.2**2 + 8**2) / 12)
    body = built(f"kind: rigid\nleft: 0.6\nright: 0.6\nheight: 4\ngyration: {gyration!r}")
    block = built("kind: block\nwidth: 1.2\nheight: 8")
    assert (body.p, body.alpha, body.eta, body.uplift) == pytest.approx((block.p, block.alpha, block.eta, block.uplift), rel=1e-14, abs=0)
    assert body.sides == ()


def test_a_prism_by_its_mass_centre_is_the_prism():
    # A right triangle 2 x 9 m: mass centre a third from the right angle, I_G = m (b^2 + h^2)/18.
    body = built(f"kind: rigid\nleft: {4 / 3!r}\nright: {2 / 3!r}\nheight: 3\ninertia: {850 * 85 / 18!r} kg m2\nmass: 0.85 t")
    prism = built("kind: prism\ncorners: [[0, 0], [2, 0], [2, 9]]")
    for one, other in zip(body.sides, prism.sides, strict=True):
        assert tuple(one.numbers().values()) == pytest.approx(tuple(other.numbers().values()), rel=1e-13, abs=0)
    assert body.details == {"mass": 850.0, "direction": "over the right edge"}


def test_momentum_of_both_edges():
    left, right = built(STATUE + "gyration: 0.68").sides
    shared = 0.68**2 + 1.15**2 - 0.42 * 0.31
    assert left.eta == pytest.approx(shared / (0.68**2 + 1.15**2 + 0.31**2), rel=1e-14, abs=0)
    assert right.eta == pytest.approx(shared / (0.68**2 + 1.15**2 + 0.42**2), rel=1e-14, abs=0)
    assert right.p**2 == pytest.approx(9.81 * math.hypot(0.31, 1.15) / (0.68**2 + 1.15**2 + 0.31**2), rel=1e-14, abs=0)
