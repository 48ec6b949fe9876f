"""Capacity curves against closed forms, and for an arch against the virtual work of
links that another program moves.
"""

import math

import numpy as np
import pytest
from oracles.arch_linkage import links_of, places
from support.documents import built
from support.refusals import refuses

from rocking_cli import UsageError
from rocking_cli.structures.mechanics.capacity_curve import capacity_curves

WALL = "kind: wall\nthickness: 0.6 m\nheight: 6 m\none_sided: true\nmass: 7200 kg\n"
TIES = "ties:\n- {height: 5.5 m, stiffness: 2e6 N/m, prestress: 5 kN, yield: 20 kN, "


def test_a_slender_block_has_the_straight_line_of_the_code():
    # Check values of the reference: e* = 1, d0 = b, alpha = (b/h_G) (1 - d/b).
    (curve,) = capacity_curves(built("kind: block\nwidth: 0.002\nheight: 2"))
    assert (curve.e_star, curve.vanishes) == (1.0, pytest.approx(0.001, rel=1e-12))
    assert curve.multiplier == pytest.approx(
        1e-3 * (1.0 - curve.displacement / 1e-3), abs=1e-9
    )


def test_a_stocky_block_has_the_tilt_at_which_it_stands_displaced():
    (curve,) = capacity_curves(built("kind: block\nwidth: 1\nheight: 2"))
    theta = np.linspace(0.0, math.atan(0.5), 7)
    x, z = (
        0.5 * np.cos(theta) - np.sin(theta),
        np.cos(theta) + 0.5 * np.sin(theta),
    )  # of the mass centre from the pivot
    assert np.interp(0.5 - x, curve.displacement, curve.multiplier) == pytest.approx(
        x / z, abs=1e-7
    )


def test_unequal_edges_have_two_curves_and_a_one_sided_body_one():
    two = capacity_curves(
        built("kind: rigid\nleft: 0.3\nright: 0.5\nheight: 2\ngyration: 1.2")
    )
    assert [curve.vanishes for curve in two] == pytest.approx([0.3, 0.5])
    (one,) = capacity_curves(built(WALL))
    assert one.vanishes == pytest.approx(0.3)


def test_an_arch_has_the_virtual_work_of_its_links():
    body = built(
        "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\nvoussoirs: 7"
    )
    (curve,) = capacity_curves(body)
    points, links = links_of(body.mechanism)
    masses = np.array([mass for mass, *_ in links])
    rest = points[:, 0] + 1j * points[:, 1]
    centre = [complex(x, z) / mass for mass, x, z, _ in links]

    def centres(phi):
        now = np.array([complex(*point) for point in places(points, phi)])
        turn = (now[1:] - now[:-1]) / (rest[1:] - rest[:-1])
        return now[:-1] + turn * (np.array(centre) - rest[:-1])

    step = 1e-5
    rate = (centres(step) - centres(-step)) / (2 * step)
    e_star = (masses @ rate.real) ** 2 / (masses.sum() * (masses @ rate.real**2))
    assert curve.e_star == pytest.approx(e_star, rel=1e-8)
    assert curve.multiplier[0] == pytest.approx(
        0.37000974, rel=1e-7
    )  # by a thrust line
    for share in (0.1, 0.4, 0.8):
        phi = share * body.alpha
        rate = (centres(phi + step) - centres(phi - step)) / (2 * step)
        d = masses @ (centres(phi) - centres(0.0)).real / (masses.sum() * e_star)
        alpha = (masses @ rate.imag) / (masses @ rate.real)
        assert np.interp(d, curve.displacement, curve.multiplier) == pytest.approx(
            alpha, rel=1e-6
        )
    assert curve.multiplier[-1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("ultimate", "share", "broken"),
    [(0.03, 0.4, True), (0.03, 0.6, True), (0.4, 0.4, False), (0.3, 0.6, True)],
)
def test_a_tie_that_breaks_bounds_the_displacement(ultimate, share, broken):
    (curve,) = capacity_curves(built(f"{WALL}{TIES}ultimate: {ultimate} m}}"))
    d, alpha, found = curve.limit(share)
    assert curve.vanishes == pytest.approx(
        0.3, rel=1e-12
    )  # the tie is not counted on at d0
    theta = (
        math.asin(ultimate / 5.5)
        if broken
        else math.atan(0.1) - math.asin((1.0 - share) * 0.3 / math.hypot(0.3, 3.0))
    )
    x, z = (
        0.3 * math.cos(theta) - 3.0 * math.sin(theta),
        3.0 * math.cos(theta) + 0.3 * math.sin(theta),
    )
    assert (d, found) == (pytest.approx(0.3 - x, rel=1e-6), broken)
    assert alpha == pytest.approx(
        (7200 * 9.81 * x + 20e3 * 5.5 * math.cos(theta)) / (7200 * 9.81 * z), rel=1e-6
    )  # before it breaks


def test_a_weak_tie_that_breaks_does_not_decide():
    weak = TIES.replace("5 kN", "0 kN").replace("20 kN", "0.5 kN")
    (curve,) = capacity_curves(built(f"{WALL}{weak}ultimate: 30 mm}}"))
    assert curve.limit(0.4)[::2] == (pytest.approx(0.12), False)


def test_the_break_of_a_tendon_is_that_of_its_elongation():
    tendon = "tendon: {stiffness: 1e6 N/m, prestress: 10 kN, rupture: 30 kN}"
    (curve,) = capacity_curves(
        built(f"kind: block\nwidth: 1\nheight: 5\nmass: 2500\n{tendon}")
    )
    theta = 2.0 * math.asin(0.02)
    assert curve.displacement[curve.breaks[0]] == pytest.approx(
        0.5 * (1.0 - math.cos(theta)) + 2.5 * math.sin(theta), rel=1e-6
    )


HALF_KNOWN = """
kind: parameters
sides:
- {side: left, p: 2, alpha: 0.2, lambda: 0.2027, eta: 0.9, arm: 1.5}
- {side: right, p: 2, alpha: 0.3, lambda: 0.3093, eta: 0.9}
"""
STATED = "kind: parameters\np: 2\nalpha: 0.2\neta: 0.8\nlambda: 0.2"
test_a_body_without_geometry_is_refused = refuses(
    lambda text: capacity_curves(built(text)),
    UsageError,
    [
        (
            text,
            (
                "without the place of one mass centre; expected the geometry of a rigid"
                " body or of a mechanism"
            ),
        )
        for text in (
            STATED,
            HALF_KNOWN,
            "kind: frame\ncolumns: 2\ncap_ratio: 1\nwidth: 1\nheight: 5",
        )
    ],
)
