"""One rigid body: closed forms, published values, invariances; edges that differ, and a backing behind it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.documents import built

from rocking_cli import DocumentError


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


def points(corners):
    """Points and weights that integrate quadratics over a convex polygon exactly: the middles of its triangles' edges."""
    corners = np.array(corners, dtype=float)
    found = []
    for b, c in itertools.pairwise(corners[1:]):
        a = corners[0]
        area = 0.5 * abs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
        found += [(*(0.5 * (p + q)), area / 3.0) for p, q in ((a, b), (b, c), (c, a))]
    x, z, weight = np.array(found).T
    return x, z, weight


def speed_ratio(corners, old, new):
    """Angular speed about `new` over that about `old`, from the moment of momentum of every point about `new`."""
    x, z, w = points(corners)
    about_new = (w * ((x - new[0]) * (x - old[0]) + (z - new[1]) * (z - old[1]))).sum()
    return about_new / (w * ((x - new[0]) ** 2 + (z - new[1]) ** 2)).sum()


LEANING = [(0.0, 0.0), (1.3, 0.0), (1.5, 4.0), (0.6, 5.0), (0.1, 3.0)]


def prism(corners, more=""):
    return built(f"kind: prism\ncorners: {[list(c) for c in corners]}\n{more}")


def test_sides_of_an_unequal_section_by_integration_over_its_points():
    x, z, w = points(LEANING)
    mass, centre, height = w.sum(), (w * x).sum() / w.sum(), (w * z).sum() / w.sum()
    body = prism(LEANING)
    for side, edge, other in zip(body.sides, ((0.0, 0.0), (1.3, 0.0)), ((1.3, 0.0), (0.0, 0.0)), strict=True):
        lever = abs(centre - edge[0])
        inertia = (w * ((x - edge[0]) ** 2 + z**2)).sum()
        assert side.p**2 == pytest.approx(9.81 * mass * math.hypot(lever, height) / inertia, rel=1e-13, abs=0)
        assert side.alpha == pytest.approx(math.atan2(lever, height), rel=1e-13, abs=0)
        assert side.uplift == pytest.approx(lever / height, rel=1e-13, abs=0)
        assert side.eta == pytest.approx(speed_ratio(LEANING, edge, other), rel=1e-13, abs=0)
        assert side.a_scale == 1.0
    assert body.alpha == min(side.alpha for side in body.sides)


@given(st.floats(0.05, 1), st.floats(0.05, 1), st.floats(1.1, 5), st.floats(0.3, 2))
def test_a_cycle_of_impacts_loses_energy_and_mirrors_exchange_sides(left, right, height, gyration):
    text = "kind: rigid\nheight: {h!r}\ngyration: {g!r}\nleft: {a!r}\nright: {b!r}"
    one, other = (built(text.format(h=height, g=gyration, a=a, b=b)) for a, b in ((left, right), (right, left)))
    if not one.sides:
        assert one == other
        return
    for here, there in zip(one.sides, reversed(other.sides), strict=True):
        assert tuple(here.numbers().values()) == pytest.approx(tuple(there.numbers().values()), rel=1e-12, abs=0)
    # The speed on leaving an edge for the other and coming back, and the energy of one impact, I eta^2 over I.
    assert one.sides[0].eta * one.sides[1].eta < 1.0
    inertia = [gyration**2 + height**2 + x**2 for x in (left, right)]
    for i in (0, 1):
        assert inertia[1 - i] * one.sides[i].eta ** 2 < inertia[i]


def test_a_given_restitution_is_that_of_both_impacts():
    assert [side.eta for side in prism(LEANING, "restitution: 0.8").sides] == [0.8, 0.8]


def test_momentum_that_would_throw_an_unequal_body_backwards_is_refused():
    flat = [(0, 0), (6, 0), (4, 1), (1, 1)]
    with pytest.raises(DocumentError, match=r"found a restitution of -0\.\d+ from momentum; expected a section more slender"):
        prism(flat)
    assert prism(flat, "restitution: 0.3").eta == 0.3


def test_one_sided_wall_of_the_literature():
    # Sorrentino et al. (2011): e = (1 - 1.5 sin^2 alpha)^2 (1 - 1.5 cos^2 alpha), 1.2 x 8 m.
    wall = built("kind: block\nwidth: 1.2\nheight: 8\none_sided: true")
    assert wall.eta == pytest.approx(-0.43667308, abs=5e-9)
    assert (wall.one_sided, wall.sides, wall.eta_source) == (True, (), "momentum")
    free = built("kind: block\nwidth: 1.2\nheight: 8")
    assert (wall.p, wall.alpha, wall.uplift) == (free.p, free.alpha, free.uplift)
    of_corners = prism([(0, 0), (1.2, 0), (1.2, 8 * (1 + 1e-15)), (0, 8)], "one_sided: true")
    assert of_corners.eta == pytest.approx(wall.eta, rel=1e-13, abs=0)


@pytest.mark.parametrize(
    ("corners", "top"), [(LEANING, (0.6, 5.0)), ([(0, 0), (1, 0), (0.9, 6), (0.1, 6)], (0.1, 6.0)), ([(0, 0), (1, 0), (1, 7)], (1.0, 7.0))]
)
def test_three_impacts_by_integration_over_the_points(corners, top):
    left, right = (corners[0][0], 0.0), (corners[1][0], 0.0)
    base = speed_ratio(corners, right, left), speed_ratio(corners, left, right)
    wall = prism(corners, "one_sided: true")
    assert wall.eta == pytest.approx(base[0] * base[1] * speed_ratio(corners, left, top), rel=1e-12, abs=0)
    free = prism(corners)
    right_side = free.sides[1] if free.sides else free
    assert (wall.p, wall.alpha, wall.uplift) == (right_side.p, right_side.alpha, right_side.uplift)


def test_one_sided_restitution_is_given_as_the_literature_prints_it():
    text = "kind: block\nwidth: 1.2\nheight: 8\none_sided: true\nrestitution: "
    assert (built(text + "-0.4").eta, built(text + "-0.4").eta_source) == (-0.4, "given")
    assert str(built(text + "0").eta) == "0.0"
    assert built(text + "auto").eta_source == "momentum"
