"""The prism of any polygon."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.documents import built


@given(st.floats(0.1, 1.3), st.floats(1, 20), st.floats(-50, 50), st.booleans())
def test_prism_of_four_corners_is_the_block(slenderness, height, shift, backwards):
    width = slenderness * height
    corners = [(shift, 3.0), (shift + width, 3.0), (shift + width, 3.0 + height), (shift, 3.0 + height)]
    prism = built(f"kind: prism\ncorners: {[list(c) for c in (corners[::-1] if backwards else corners)]}")
    block = built(f"kind: block\nwidth: {width!r}\nheight: {height!r}")
    assert (prism.p, prism.alpha, prism.eta) == pytest.approx((block.p, block.alpha, block.eta), rel=1e-9, abs=1e-12)


def test_prism_of_the_tapered_column():
    # Base 1.11 m, top 0.90 m, height 5.95 m: the single rigid trapezoid beside published discrete-element analyses.
    prism = built("kind: prism\ncorners: [[0, 0], [1.11, 0], [1.005, 5.95], [0.105, 5.95]]")
    assert (prism.p, prism.alpha, prism.eta) == pytest.approx((1.5742, 0.1909, 0.947), abs=5e-4)
    assert (prism.p, prism.alpha) == pytest.approx((1.5742, 0.1909), abs=5e-5)


def test_prism_may_be_a_closed_ring():
    ring, open_ = "[0, 0], [1, 0], [1, 5], [0, 5], [0, 0]", "[0, 0], [1, 0], [1, 5], [0, 5]"
    assert built(f"kind: prism\ncorners: [{ring}]") == built(f"kind: prism\ncorners: [{open_}]")


def test_unsymmetric_prism_falls_over_its_weaker_edge():
    right = built("kind: prism\ncorners: [[0, 0], [2, 0], [2, 9]]")
    left = built("kind: prism\ncorners: [[0, 0], [2, 0], [0, 9]]")
    assert (right.details["direction"], left.details["direction"]) == ("over the right edge", "over the left edge")
    assert right.uplift == pytest.approx((2 - 4 / 3) / 3, rel=1e-14, abs=0)
    # The section and its mirror image: what one does on its left edge the other does on its right.
    for one, other in zip(left.sides, reversed(right.sides), strict=True):
        assert tuple(one.numbers().values()) == pytest.approx(tuple(other.numbers().values()), rel=1e-14, abs=0)
    assert right.sides[1].alpha == right.alpha < right.sides[0].alpha
