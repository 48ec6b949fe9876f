"""The frame of columns and a beam."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.documents import built


@given(st.floats(0.01, 5), st.floats(0.05, 0.4), st.integers(1, 40))
def test_frame_is_makris_and_vassilious(gamma, slenderness, columns):
    # Makris and Vassiliou, Earthquake Engng Struct. Dyn. 42 (2013) 691-707: p_hat and the restitution of the frame.
    frame = built(f"kind: frame\ncolumns: {columns}\nwidth: {6 * slenderness!r}\nheight: 6\ncap_ratio: {gamma!r}")
    column = built(f"kind: block\nwidth: {6 * slenderness!r}\nheight: 6")
    assert frame.p == pytest.approx(column.p * math.sqrt((1 + 2 * gamma) / (1 + 3 * gamma)), rel=1e-12, abs=0)
    assert frame.alpha == column.alpha
    expected = (1 - 1.5 * math.sin(column.alpha) ** 2 + 3 * gamma * math.cos(2 * column.alpha)) / (1 + 3 * gamma)
    assert frame.eta == pytest.approx(expected, rel=1e-12, abs=0)


def test_frame_without_a_beam_is_its_column():
    frame, column = built("kind: frame\ncolumns: 1\nwidth: 1\nheight: 6\ncap_ratio: 0"), built("kind: block\nwidth: 1\nheight: 6")
    assert (frame.p, frame.eta) == pytest.approx((column.p, column.eta), rel=5e-15, abs=0)
