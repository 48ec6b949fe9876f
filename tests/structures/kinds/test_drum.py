"""The drum and stacked drums."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.documents import built

from rocking_cli.structures.mechanics.stacked_pieces import frustum_moments


def test_drum_is_the_cylinder_and_the_cone():
    r, h = 0.5, 6.0
    cylinder = built(f"kind: drum\nradius: {r}\nheight: {h}")
    assert cylinder.p**2 == pytest.approx(9.81 * math.hypot(r, h / 2) / (1.25 * r * r + h * h / 3), rel=1e-13, abs=0)
    assert cylinder.alpha == pytest.approx(math.atan(2 * r / h), rel=1e-14, abs=0)
    cone = built(f"kind: drum\nbase_radius: {r}\ntop_radius: 0\nheight: {h}")
    assert cone.alpha == pytest.approx(math.atan(4 * r / h), rel=1e-14, abs=0)
    assert cone.p**2 == pytest.approx(9.81 * math.hypot(r, h / 4) / (0.15 * r * r + 0.1 * h * h + r * r), rel=1e-13, abs=0)


def test_stacked_drums_are_the_column_they_make():
    whole = built("kind: drum\nbase_radius: 0.6\ntop_radius: 0.4\nheight: 6")
    parts = "{base_radius: 0.6, top_radius: 0.5, height: 3}, {base_radius: 0.5, top_radius: 0.4, height: 3}"
    stacked = built(f"kind: drum\ndrums: [{parts}]")
    assert (stacked.p, stacked.alpha, stacked.eta) == pytest.approx((whole.p, whole.alpha, whole.eta), rel=1e-13, abs=0)


def test_a_column_on_a_plinth_rocks_on_the_plinth():
    stacked = built("kind: drum\ndrums: [{radius: 2, height: 0.5}, {radius: 0.3, height: 6}]")
    column = built("kind: drum\nradius: 0.3\nheight: 6")
    assert (stacked.p, stacked.alpha, stacked.eta) == pytest.approx((column.p, column.alpha, column.eta), rel=1e-13, abs=0)
    assert stacked.details["rocks_on"] == "drum 1 from below"


@given(st.floats(0.05, 3), st.floats(0, 3), st.floats(0.1, 20))
def test_frustum_moments_equal_quadrature(low, high, height):
    nodes, weights = np.polynomial.legendre.leggauss(4)
    z = 0.5 * height * (nodes + 1)
    w = 0.5 * height * weights * math.pi
    r = low + (high - low) * z / height
    expected = ((w * r**2).sum(), 0.0, (w * r**2 * z).sum(), (w * (r**2 * z**2 + r**4 / 4)).sum())
    assert frustum_moments(low, high, height) == pytest.approx(expected, rel=1e-12, abs=0)


def test_a_drum_whose_mass_centre_is_off_its_axis():
    r, h, e = 0.5, 3.0, 0.08
    drum = built(f"kind: drum\nradius: {r}\nheight: {h}\noffset: {e}")
    gyration = math.sqrt(r * r / 4 + h * h / 12)
    body = built(f"kind: rigid\nleft: {r + e!r}\nright: {r - e!r}\nheight: {h / 2!r}\ngyration: {gyration!r}")
    for one, other in zip(drum.sides, body.sides, strict=True):
        assert tuple(one.numbers().values()) == pytest.approx(tuple(other.numbers().values()), rel=1e-13, abs=0)
    assert drum.details["direction"] == "over the right edge"
    assert built(f"kind: drum\nradius: {r}\nheight: {h}\noffset: 0") == built(f"kind: drum\nradius: {r}\nheight: {h}")


def test_a_stack_moved_as_a_whole_is_the_same_stack():
    def stack(by):
        return built(f"kind: drum\ndrums: [{{radius: 0.5, height: 2, offset: {by}}}, {{radius: 0.45, height: 2, offset: {by}}}]")

    for by in (0.3, -7.1):
        assert (stack(by).p, stack(by).alpha, stack(by).eta) == pytest.approx((stack(0).p, stack(0).alpha, stack(0).eta), rel=1e-12, abs=0)
        assert stack(by).sides == ()


def test_a_drum_that_was_pushed_stands_on_the_overlap():
    stack = built("kind: drum\ndrums: [{radius: 0.5, height: 2}, {radius: 0.5, height: 2, offset: 0.2}]")
    assert stack.details["rocks_on"] == "its base"
    # The lower drum's centre at 0, 1 m up, the upper one's at 0.2, 3 m up, on [-0.5, 0.5].
    assert [side.uplift for side in stack.sides] == pytest.approx([0.6 / 2, 0.4 / 2], rel=1e-13, abs=0)
    inertia = 2 * (0.5**2 / 4 + 2**2 / 12) + (0.5**2 + 1) + (0.3**2 + 9)
    assert stack.sides[1].p ** 2 == pytest.approx(9.81 * 2 * math.hypot(0.4, 2) / inertia, rel=1e-13, abs=0)
    farther = built("kind: drum\ndrums: [{radius: 2, height: 0.1}, {radius: 0.5, height: 2}, {radius: 0.5, height: 2, offset: 0.4}]")
    # Now the upper one alone, at 0.4 on [-0.1, 0.5], lifts before the two.
    assert farther.details["rocks_on"] == "drum 2 from below"
    assert farther.uplift == pytest.approx(0.1 / 1, rel=1e-13, abs=0)


def test_a_one_sided_drum_meets_its_backing_at_its_top():
    alone = built("kind: drum\nradius: 0.5\nheight: 4\none_sided: true")
    # I_G = m (r^2/4 + h^2/12); T = (-r, h).
    central, r, h = 0.5**2 / 4 + 16 / 12, 0.5, 4.0
    backing = (central + r * r - h * h / 4) / (central + r * r + h * h / 4)
    base = (central - r * r + h * h / 4) / (central + r * r + h * h / 4)
    assert alone.eta == pytest.approx(base**2 * backing, rel=1e-13, abs=0)
    halves = built("kind: drum\ndrums: [{radius: 0.5, height: 2}, {radius: 0.5, height: 2}]\none_sided: true")
    assert halves.eta == pytest.approx(alone.eta, rel=1e-12, abs=0)
