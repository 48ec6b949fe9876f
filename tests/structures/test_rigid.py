"""Blocks, point masses and thin spires: closed forms, published values, invariances."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from written import built


def test_block_has_housners_parameters():
    b = built("kind: block\nwidth: 0.5\nheight: 2 m")
    radius, alpha = math.hypot(0.25, 1.0), math.atan(0.25)
    assert b.p == pytest.approx(math.sqrt(3 * 9.81 / (4 * radius)), rel=5e-15, abs=0)
    assert b.alpha == pytest.approx(alpha, rel=5e-15, abs=0)
    assert b.eta == pytest.approx(1 - 1.5 * math.sin(alpha) ** 2, rel=5e-15, abs=0)
    assert b.uplift == pytest.approx(0.25, rel=5e-15, abs=0)
    assert (b.a_scale, b.eta_source, b.name) == (1.0, "momentum", "f")


def test_block_of_the_nonlinear_reference_case():
    # alpha = 0.25 and p = 2.14 rad/s belong to R = 3 g / (4 p^2) = 1.606581 m.
    b = built("kind: block\nradius: 1.60658 m\nalpha: 0.25\nrestitution: 0.9")
    assert b.p == pytest.approx(2.14, abs=1e-6)
    assert (b.eta, b.eta_source) == (0.9, "given")


def test_point_mass():
    m = built("kind: point_mass\nradius: 4 m\nalpha: 20 deg")
    assert m.p == pytest.approx(math.sqrt(9.81 / 4), rel=5e-15, abs=0)
    assert m.eta == pytest.approx(1 - 2 * math.sin(math.radians(20)) ** 2, rel=5e-15, abs=0)
    same = built(f"kind: point_mass\nwidth: {8 * math.sin(math.radians(20))!r}\nheight: {4 * math.cos(math.radians(20))!r}")
    assert same.p == pytest.approx(m.p, rel=1e-14, abs=0)


def test_thin_spire_has_the_reference_values():
    # r_b = 1.5 m, H = 12 m: Eqs. 3.1-3.3 of the paper evaluated independently, to the digits given.
    s = built("kind: spire\nbase_radius: 1.5\nheight: 12")
    assert s.p == pytest.approx(1.250206, abs=1e-6)
    assert s.alpha == pytest.approx(0.358771, abs=1e-6)
    assert s.eta == pytest.approx(0.832168, abs=1e-6)
    kappa = 1.5 / 12
    assert s.p**2 == pytest.approx(9.81 / 12 * math.sqrt(1 / 9 + kappa**2) / (1.25 * kappa**2 + 1 / 6), rel=1e-14, abs=0)


@given(st.floats(0.01, 1.3), st.floats(0.01, 100), st.floats(0.1, 100))
def test_scale_moves_only_p(slenderness, height, factor):
    a = built(f"kind: block\nwidth: {slenderness * height!r}\nheight: {height!r}")
    b = built(f"kind: block\nwidth: {slenderness * height * factor!r}\nheight: {height * factor!r}")
    assert b.p * math.sqrt(factor) == pytest.approx(a.p, rel=1e-12, abs=0)
    assert (b.alpha, b.eta, b.uplift) == pytest.approx((a.alpha, a.eta, a.uplift), rel=1e-12, abs=0)
    assert 0 <= a.eta <= 1


@given(st.floats(0.05, 50))
def test_units_do_not_matter(width):
    height = 3 * width
    si = built(f"kind: block\nwidth: {width!r}\nheight: {height!r}")
    mm = built(f"kind: block\nwidth: {1000 * width!r} mm\nheight: {100 * height!r} cm")
    assert mm.p == pytest.approx(si.p, rel=1e-14, abs=0)


def test_eta_given_lifts_the_limit_on_alpha():
    assert built("kind: block\nwidth: 3\nheight: 2\nrestitution: 0.5").eta == 0.5
