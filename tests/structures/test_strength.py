"""The toe that a strength gives: closed forms, an independent program, quadrature, and
the same numbers as with the inset that it means.
"""

import math

import numpy as np
import pytest

from rocking_cli import load_structures
from rocking_cli.errors import DocumentError
from rocking_cli.structures.mechanics.toe import RingBase

# from an independent program, 2026: document, inset [m], alpha, R [m], p, eta, lambda
KNOWN = [
    (
        "wall:0.6x6,density=1800,strength=5MPa",
        0.00635688,
        0.097570235,
        3.0143368,
        1.5622362,
        0.98576681,
        0.09788104,
    ),
    (
        "wall:0.6x6,density=1800,strength=1 MPa",
        0.0317844,
        0.089168122,
        3.0119661,
        1.5625433,
        0.98811106,
        0.0894052,
    ),
    (
        "block:0.5x2.5,density=2000,strength=2e6",
        0.00613125,
        0.1926748,
        1.2735666,
        2.4029956,
        0.94502597,
        0.195095,
    ),
    (
        "drum:0.5x5,density=2300,strength=5MPa",
        0.033942903,
        0.18430717,
        2.5430708,
        1.7019055,
        0.94956272,
        0.18642284,
    ),
    (
        "drum:0.5x5,density=2300,strength=2MPa",
        0.06297753,
        0.17306032,
        2.5379103,
        1.7027716,
        0.95551587,
        0.17480899,
    ),
    (
        "drum:0.5x5,density=2300,strength=20MPa",
        0.013403074,
        0.19223526,
        2.5469151,
        1.70126,
        0.94514369,
        0.19463877,
    ),
]


@pytest.mark.filterwarnings("ignore:.*strength")
@pytest.mark.parametrize(("text", "inset", "alpha", "arm", "p", "eta", "uplift"), KNOWN)
def test_the_toe_agrees_with_an_independent_program(
    text, inset, alpha, arm, p, eta, uplift
):
    (s,) = load_structures(text)
    found = s.details["inset"], s.alpha, s.arm, s.p, s.eta, s.uplift
    assert found == pytest.approx((inset, alpha, arm, p, eta, uplift), rel=5e-8)


def test_a_wall_of_its_own_weight_has_lambda_of_its_stress():
    """lambda = (t/h)(1 - sigma/f) with sigma = rho g h, whatever its length."""
    for length in ("", ",length=3"):
        (s,) = load_structures(f"wall:0.3x3,density=1800,strength=1.5MPa{length}")
        stress = 1800.0 * 9.81 * 3.0
        assert s.uplift == pytest.approx(0.1 * (1.0 - stress / 1.5e6), rel=1e-14)
        assert s.details["base_stress"] == pytest.approx(stress, rel=1e-14)
        assert s.details["alpha_geometric"] == pytest.approx(math.atan(0.1))


@pytest.mark.parametrize(
    ("outer", "inner", "share"),
    [(0.5, 0.0, 1e-9), (0.5, 0.0, 0.01), (0.5, 0.0, 0.6), (1.5, 1.35, 0.3)],
)
def test_the_centroid_of_a_segment_agrees_with_quadrature(outer, inner, share):
    """The chord is found by bisection on a quadrature in the angle."""
    area = share * math.pi * (outer**2 - inner**2)
    nodes, weights = np.polynomial.legendre.leggauss(400)

    def part(r, x):
        if x >= r:
            return 0.0, 0.0
        half = math.acos(max(x / r, -1.0))
        t = 0.5 * half * (nodes + 1.0)
        w = half * weights * r * r * np.sin(t) ** 2
        return w.sum(), (w * r * np.cos(t)).sum()

    low, high = -outer, outer
    for _ in range(200):
        middle = 0.5 * (low + high)
        here = part(outer, middle)[0] - (part(inner, middle)[0] if inner else 0.0)
        low, high = (middle, high) if here > area else (low, middle)
    moment = part(outer, low)[1] - (part(inner, low)[1] if inner else 0.0)
    inset = outer - moment / area
    tolerance = 1e-9 if share > 1e-6 else 1e-4
    assert RingBase(outer, inner).inset(area) == pytest.approx(inset, rel=tolerance)


def test_a_small_segment_has_its_limits():
    """inset = 3/5 of the depth, depth = r psi^2/2, psi^3 = 3 N/(2 f r^2)."""
    for area in (1e-12, 1e-9, 1e-6):
        psi = (1.5 * area / 0.25) ** (1.0 / 3.0)
        wanted = 0.6 * 0.5 * 0.5 * psi**2
        assert RingBase(0.5).inset(area) == pytest.approx(
            wanted, rel=0.1 * psi**2 + 1e-7
        )


def test_a_ring_agrees_with_an_independent_program():
    assert RingBase(1.5, 1.35).inset(0.4) == pytest.approx(0.27257323, rel=2e-8)


PRISM = "prism:corners=[[0,0],[0.6,0],[0.35,3],[0.2,3]],density=2000,length=1"
RIGID = "rigid:left=0.2,right=0.3,height=1,gyration=0.6,mass=1000,length=1"


@pytest.mark.filterwarnings("ignore:.*strength")
@pytest.mark.parametrize(
    "text",
    [
        "block:0.5x2,density=1800,depth=1",
        "block:0.5x2,density=1800,depth=0.7,one_sided=true",
        "block:0.5x2,mass=2000,depth=0.6",
        PRISM,
        RIGID,
        "spire:1.5x12,thickness=0.15,density=2000",
        "stack:pieces=[{width: 0.6, height: 1, density: 2000}, "
        "{width: 0.4, height: 2, density: 1500, depth: 0.3}],rocks_on=1",
        "drum:drums=[{radius: 0.5, height: 1}, {radius: 0.4, height: 2}],density=2000,"
        "rocks_on=1",
    ],
)
def test_a_strength_is_the_inset_that_it_means(text):
    (crushed, *_) = load_structures(f"{text},strength=0.8MPa")
    plain = text.replace(",density=2000", "") if "drum" in text else text
    (moved, *_) = load_structures(f"{plain},inset={crushed.details['inset']!r}")
    for key in ("p", "alpha", "uplift", "eta", "arm"):
        assert getattr(crushed, key) == pytest.approx(getattr(moved, key), rel=1e-12)
    assert crushed.details["alpha_geometric"] == moved.details["alpha_geometric"]


@pytest.mark.filterwarnings("ignore:.*strength")
def test_each_interface_of_a_stack_has_its_own_toe():
    text = "stack:strength=0.05MPa,pieces=[{width: 1, height: 1, density: 2000}, "
    found = load_structures(
        text + "{width: 0.4, height: 2, density: 2000, depth: 0.3}]"
    )
    weights = [2000.0 * 9.81 * 0.4 * 0.3 * 2.0, 2000.0 * 9.81 * (1.0 + 0.24)]
    insets = [weights[0] / (2 * 0.05e6 * 0.3), weights[1] / (2 * 0.05e6)]
    assert [s.details["inset"] for s in found] == pytest.approx(insets, rel=1e-12)
    stresses = [weights[0] / 0.12, weights[1]]
    assert [s.details["base_stress"] for s in found] == pytest.approx(stresses)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (
            "wall:0.6x6,density=1800,strength=2",
            "found 2 Pa, not above .*0.106 MPa .105948 Pa.",
        ),
        ("wall:0.6x6,density=1800,strength=0.1MPa", "0.106 MPa .105948 Pa.; expected"),
        ("drum:0.5x5,density=2300,strength=112 kPa", "112815 Pa"),
        ("wall:0.6x6,density=1800,strength=2MPa,inset=1cm", "together with inset"),
        ("wall:0.6x6,strength=2MPa", "no key 'density'"),
        ("wall:0.6x6,mass=1e4,strength=2MPa", "no key 'length'"),
        ("block:0.5x2,mass=3000,strength=1MPa", "no key 'depth'"),
        ("block:0.5x2,density=1800", "no key 'depth'"),
        ("block:0.5x2,density=1800,mass=3,strength=1MPa", "together with mass"),
        ("point_mass:0.5x2,mass=3,strength=1MPa", "struts have no contact area"),
        ("frame:width=1,height=4,columns=2,cap_ratio=1,strength=1MPa", "of the beam"),
        ("spire:1.5x12,density=2000,strength=1MPa", "thin wall"),
        ("spire:1.5x12,thickness=0.15,crack=diagonal,strength=1MPa", "cracked spire"),
        (f"{RIGID},strength=0.02MPa", "0.2452 m inside the edges"),
        ("wall:0.6x6,density=1800,strength=2 m", "strength: found 2 m"),
        ("wall:0.6x6,density=1800,strength=-2MPa", "a positive stress"),
    ],
)
def test_refusals(text, found):
    with pytest.raises(DocumentError, match=found):
        load_structures(text)


def test_a_large_inset_is_remarked_on():
    with pytest.warns(UserWarning, match="11 % of half the width; cracking"):
        load_structures("wall:0.6x6,density=1800,strength=1MPa")
