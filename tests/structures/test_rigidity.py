"""How rigid a body is: omega_n over sqrt(g/R), and what is said of it."""

import json
import math

import numpy as np
import pytest
from scipy.linalg import eigh
from support.documents import built

from rocking_cli import DocumentError

BLOCK = "kind: block\nwidth: 0.5\nheight: 4\n"


@pytest.mark.parametrize(
    ("period", "said"),
    # shares of the table of a lumped mass on a column: the nearest ratio below
    [
        (0.1, ""),
        (0.15, "no table"),
        (0.19, "10 %"),
        (0.3, "13 %"),
        (0.6, "29 %"),
        (1.5, "no table"),
    ],
)
def test_the_ratio_is_that_of_the_mass_centre(period, said):
    body = built(f"{BLOCK}period: {period} s")
    ratio = 2.0 * math.pi / period / math.sqrt(9.81 / math.hypot(0.25, 2.0))
    assert body.details["omega_n"] == pytest.approx(2.0 * math.pi / period, rel=1e-12)
    assert body.details["omega_n_over_p"] == pytest.approx(ratio, rel=1e-12)
    assert len(body.remarks) == bool(said)
    assert all(said in remark and "not rigid" in remark for remark in body.remarks)


def test_a_steep_body_has_no_table():
    body = built("kind: block\nwidth: 2\nheight: 3\nperiod: 0.15")
    (remark,) = body.remarks
    assert body.details["omega_n_over_p"] < 20.0
    assert "no table" in remark


def test_what_params_prints_says_the_same():
    body = built(f"{BLOCK}period: 0.3 s")
    again = built(json.dumps(body.row()))
    assert again.details == body.details
    assert (
        again.remarks[0].partition(": omega_n/p")[2]
        == body.remarks[0].partition(": omega_n/p")[2]
    )


def test_a_rigid_body_has_no_word():
    assert "omega_n" not in built(BLOCK).details


def test_a_period_of_nothing_is_refused():
    with pytest.raises(DocumentError, match="period: found 0"):
        built(f"{BLOCK}period: 0 s")


def frequency_of_elements(gyration, height, speed, shear, count=40):
    """The least frequency [rad/s] of Timoshenko's cantilever by linear elements with
    one point of integration. gyration: of the section [m]; speed: E/rho [m2/s2]; shear:
    kappa G/E.
    """
    stiffness = np.zeros((2 * count + 2, 2 * count + 2))
    mass, h = np.zeros_like(stiffness), height / count
    strain = np.array([-1.0 / h, -0.5, 1.0 / h, -0.5])  # of deflection and rotation
    curvature = np.array([0.0, -1.0 / h, 0.0, 1.0 / h])
    consistent = h / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    of_section = np.diag([1.0, gyration**2])
    for i in range(0, 2 * count, 2):
        at = slice(i, i + 4)
        stiffness[at, at] += shear * h * np.outer(strain, strain)
        stiffness[at, at] += gyration**2 * h * np.outer(curvature, curvature)
        mass[at, at] += np.kron(consistent, of_section)
    free = slice(2, None)
    least = eigh(
        stiffness[free, free],
        mass[free, free],
        eigvals_only=True,
        subset_by_index=[0, 0],
    )
    return math.sqrt(speed * least[0])


OF_RECTANGLE, OF_CIRCLE = 5.0 / 14.2, 3.0 / 8.2  # kappa G/E of Cowper at nu = 0.2


@pytest.mark.parametrize(
    ("text", "gyration", "shear", "rotatory"),
    # the share that rotatory inertia takes of the frequency
    [
        ("block, width: 0.5, density: 2000", 0.5 / 12**0.5, OF_RECTANGLE, 0.002),
        ("block, width: 1, mass: 1.6e4, depth: 2", 1 / 12**0.5, OF_RECTANGLE, 0.008),
        ("wall, thickness: 2, density: 2000", 2 / 12**0.5, OF_RECTANGLE, 0.022),
        ("drum, radius: 0.25, density: 2000", 0.125, OF_CIRCLE, 0.0015),
        (f"drum, radius: 1, mass: {8e3 * math.pi}", 0.5, OF_CIRCLE, 0.016),
    ],
)
def test_a_section_and_youngs_modulus_tell_the_frequency(
    text, gyration, shear, rotatory
):
    body = built(f"{{kind: {text}, height: 4, youngs_modulus: 3 GPa}}")
    wanted = frequency_of_elements(gyration, 4.0, 3e9 / 2000.0, shear)
    found = body.details["omega_n"]
    assert found == pytest.approx(wanted * (1.0 + rotatory), rel=1.5e-3)
    ratio = found / math.sqrt(9.81 / body.arm)
    assert body.details["omega_n_over_p"] == pytest.approx(ratio, rel=1e-12)


def test_a_slender_cantilever_has_the_first_frequency_of_euler_and_bernoulli():
    body = built(
        "{kind: wall, thickness: 0.01, height: 10, density: 1, youngs_modulus: 1e6}"
    )
    wanted = 1.8751**2 * (0.01 / 12**0.5) / 10.0**2 * 1e3
    assert body.details["omega_n"] == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("period: 0.2, density: 2000", "together with period; expected one of them"),
        ("mass: 4000", "no key 'depth'; expected depth: youngs_modulus needs"),
        ("inset: 0", "no key 'density'; expected density: youngs_modulus needs"),
        (
            "mass: 4000, depth: 1, loads: [{mass: 1, bearing: centre, inertia: both}]",
            "of a body with loads; expected period",
        ),
    ],
)
def test_what_tells_no_frequency_is_refused(keys, said):
    text = f"{{kind: block, width: 0.5, height: 4, youngs_modulus: 1 GPa, {keys}}}"
    with pytest.raises(DocumentError, match=said):
        built(text)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("point_mass, width: 1, height: 4", "section; expected period"),
        (
            "drum, base_radius: 1, top_radius: 0.5, height: 4",
            "section; expected period",
        ),
        ("wall, thickness: 0.5, height: 4, top: held", "expected no youngs_modulus"),
    ],
)
def test_a_section_that_is_not_one_is_refused(text, said):
    with pytest.raises(DocumentError, match=said):
        built(f"{{kind: {text}, youngs_modulus: 1 GPa}}")


def test_young_s_modulus_in_another_unit_is_told():
    body = built(f"{BLOCK}density: 2000\nyoungs_modulus: 30")
    assert "30 MPa" in body.remarks[0]
