"""Loads on rigid bodies: an independent program, closed forms, limits, and what
is refused.
"""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.bodies import rotation_under
from support.documents import built
from support.refusals import refuses

from rocking_cli import (
    DocumentError,
    UsageError,
    build_structure,
    check,
    parse_documents,
    parse_grid,
    pulse,
    sine,
    time_history,
)
from rocking_cli.dynamics.method import Method
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.structures.kinds import sketch_of
from rocking_cli.structures.shared_keys import weight_of_loads

G = 9.81
BLOCK = "kind: block\nwidth: 0.5\nheight: 2\nmass: 2000\nname: b\n"


def loaded(inertia, at="at: [0, 2]", weight="19.62 kN", more=""):
    load = f"{{weight: {weight}, {at}, inertia: {inertia}}}"
    return built(f"{BLOCK}loads: [{load}]\n{more}")


def numbers(structure):
    return [
        (x.uplift, x.alpha, x.p, x.a_scale, x.eta)
        for x in structure.sides or (structure,)
    ]


# an independent program, 2026, block_floor_centre, block_weight_only and block_carried
# (left and right): lambda, alpha, p, a_scale (of Eq. 2.3 it is 1), eta
PROGRAM = {
    ("vertical", "at: [0, 2]", "19.62 kN"): [
        (
            0.5,
            0.16514867741462683,
            4.578285617886494,
            0.33029735482925365,
            0.8309859154929577,
        ),
    ],
    ("none", "at: [0, 2]", "19.62 kN"): [
        (
            0.5,
            0.16514867741462683,
            4.58919064076184,
            0.33029735482925365,
            0.9117647058823529,
        ),
    ],
    ("both", "at: [0.1, 2.2]", "9.81 kN"): [
        (
            0.20238095238095238,
            0.19968388537510154,
            2.3221281487296856,
            1.0,
            0.9577693557119653,
        ),
        (
            0.15476190476190477,
            0.15354378253955606,
            2.327561376190761,
            1.0,
            0.9454836985569214,
        ),
    ],
}
# the same program: theta/alpha under one cycle of a sine of a_g [m/s2] and T_g [s]
PULSES = [
    ("vertical", "at: [0, 2]", "19.62 kN", 5.5, 0.8, 0.09605408940553557),
    ("vertical", "at: [0, 2]", "19.62 kN", 7.0, 0.5, None),
    ("none", "at: [0, 2]", "19.62 kN", 5.5, 0.8, 0.14947981551334127),
    ("both", "at: [0.1, 2.2]", "9.81 kN", 2.2, 1.0, 0.1938396503883395),
    ("both", "at: [0.1, 2.2]", "9.81 kN", -2.2, 1.0, None),
]


@pytest.mark.parametrize("load", PROGRAM)
def test_the_parameters_are_those_of_an_independent_program(load):
    wanted = [pytest.approx(row, rel=1e-11) for row in PROGRAM[load]]
    assert numbers(loaded(*load)) == wanted


@pytest.mark.parametrize(("inertia", "at", "weight", "a_g", "period", "wanted"), PULSES)
def test_the_motion_is_that_of_an_independent_program(
    inertia, at, weight, a_g, period, wanted
):
    found = rotation_under(loaded(inertia, at, weight), a_g, period)
    assert found == (wanted if wanted is None else pytest.approx(wanted, abs=1e-8))


@settings(max_examples=15)
@given(
    st.floats(0.05, 2.0),
    st.floats(-0.2, 0.2),
    st.floats(1.5, 2.5),
    st.sampled_from(["vertical", "none", "both"]),
)
def test_each_side_is_its_closed_form(k, x, z, inertia):
    found = loaded(
        inertia, f"at: [{x!r}, {z!r}]", f"{k * 2000 * G!r}", "restitution: 1"
    )
    b, h, m, about = 0.25, 1.0, 2000.0, 4.0 / 3.0 * 2000.0 * (0.25**2 + 1.0)
    for side, own in ((-1.0, numbers(found)[0]), (1.0, numbers(found)[-1])):
        d = b - side * x
        alpha = math.atan2(b + k * d, h + k * z)
        rises = {
            "vertical": (d * math.cos(alpha) - z * math.sin(alpha)) ** 2,
            "none": 0.0,
            "both": d * d + z * z,
        }[inertia]
        reach = math.hypot(b + k * d, h + k * z)
        p = math.sqrt(G * m * reach / (about + k * m * rises))
        uplift = math.tan(alpha) if inertia == "both" else (b + k * d) / h
        assert own[:3] == pytest.approx((uplift, alpha, p), rel=1e-9)


@pytest.mark.parametrize("inertia", ["vertical", "none", "both"])
def test_a_load_without_weight_is_no_load(inertia):
    bare, light = built(BLOCK), loaded(inertia, weight="1e-9")
    assert numbers(light)[0][:3] == pytest.approx(numbers(bare)[0][:3], rel=1e-12)
    assert light.eta == pytest.approx(bare.eta, rel=1e-12)
    shaking = parse_grid("a_g=0.34g,T_g=0.8")
    one, other = (check(body, pulse("rectangular"), shaking) for body in (bare, light))
    assert other.outcome == one.outcome
    assert other.uplift_a == pytest.approx(one.uplift_a, rel=1e-10)
    assert other.first_overturning_a == pytest.approx(
        one.first_overturning_a, rel=1e-10
    )
    ratios = [rotation_under(body, 3.3, 0.8) for body in (bare, light)]
    assert ratios[1] == pytest.approx(ratios[0], abs=1e-10)


def test_a_bearing_changes_places_with_the_side():
    far = loaded("vertical", "bearing: far", "9.81 kN")
    near = loaded("vertical", "bearing: near", "9.81 kN")
    mirrored = loaded("vertical", "at: [-0.25, 2], mirrored: true", "9.81 kN")
    assert far.sides == near.sides == ()
    assert numbers(mirrored) == numbers(far)
    # the floor of half the weight has the lever 2 b, or none
    assert far.uplift == pytest.approx(0.25 * (1.0 + 0.5 * 2.0), rel=1e-12)
    assert near.uplift == pytest.approx(0.25, rel=1e-12)
    # it rises with the far edge on both sides, and falls on none: eta of section 10
    about = 2000.0 * 4.0 / 3.0 * (0.25**2 + 1.0) + 1000.0 * 0.5**2
    spin = 2000.0 * ((0.25**2 + 1.0) / 3.0 + 1.0 - 0.25**2) - 1000.0 * 0.5 * 0.5
    assert far.eta == pytest.approx(spin / about, rel=1e-12)
    fixed = loaded("vertical", "at: [-0.25, 2]", "9.81 kN")
    assert [side.uplift for side in fixed.sides] == pytest.approx([0.25, 0.5])


def test_other_kinds_take_loads():
    prism = built(
        "kind: prism\ncorners: [[1, 0], [1.5, 0], [1.5, 2], [1, 2]]\nmass: 2000\n"
        "loads: [{mass: 2000, at: [1.25, 2], inertia: vertical}]"
    )
    assert numbers(prism)[0] == pytest.approx(
        PROGRAM["vertical", "at: [0, 2]", "19.62 kN"][0], rel=1e-10
    )
    wall = built(
        "kind: wall\nthickness: 0.5\nheight: 2\nlength: 1\ndensity: 2000\n"
        "loads: [{weight: 19.62 kN, bearing: centre, inertia: none}]"
    )
    assert numbers(wall)[0] == pytest.approx(
        PROGRAM["none", "at: [0, 2]", "19.62 kN"][0], rel=1e-10
    )
    inset = loaded("vertical", more="inset: 50 mm")
    assert inset.uplift == pytest.approx(0.4, rel=1e-12)  # 2 (b - inset)/h
    assert inset.details["inset"] == 0.05
    one_sided = loaded("vertical", more="one_sided: true\nrestitution: -0.3")
    assert (one_sided.one_sided, one_sided.eta) == (True, -0.3)
    assert one_sided.uplift == pytest.approx(0.5, rel=1e-12)
    stack = built(
        "kind: stack\nrocks_on: 1\nmass: 100\n"
        "pieces: [{width: 1, height: 4}, {width: 0.5, height: 1}]\n"
        "loads: [{mass: 50, bearing: centre, inertia: vertical}]"
    )
    assert stack.uplift == pytest.approx(0.5 * 1.5, rel=1e-12)


def test_friction_is_compared_with_the_forces_under_the_load():
    shaking = parse_grid("a_g=0.45g,T_g=0.5")
    load = ("vertical", "at: [0.1, 2.2]", "9.81 kN")
    slides = check(loaded(*load, "friction: 0.2"), sine(), shaking, a_max=None)
    assert slides.slides
    found = time_history(loaded(*load), sine(), shaking).forces["nonlinear"]
    assert slides.friction_needed == pytest.approx(
        found.summary("tau", 1.0)["friction_needed"], rel=1e-9
    )


def test_friction_and_strength_carry_the_weight_of_the_load():
    # it slides at mu (1 + k): the floor presses and does not push
    slides = loaded("vertical", more="friction: 0.2")
    assert "it slides from 0.4 g on, or before; lambda = 0.5" in slides.remarks[0]
    holds = loaded("vertical", more="friction: 0.3")
    assert holds.remarks == ()
    # the toe crushes under both weights over 2 f L
    crushed = loaded("vertical", more="depth: 1 m\nstrength: 2 MPa")
    assert crushed.details["inset"] == pytest.approx(2.0 * 19620.0 / 4e6, rel=1e-12)
    assert crushed.uplift == pytest.approx(
        2.0 * (0.25 - crushed.details["inset"]), rel=1e-12
    )


def test_alpha_without_the_inset_is_that_under_the_load():
    worn = loaded("vertical", more="inset: 2 cm")
    assert worn.details["alpha_geometric"] == loaded("vertical").alpha
    # tan alpha = (b + k d)/(h + k z_P), k = 1, b = d = 0.25 m, h = 1 m, z_P = 2 m
    assert worn.details["alpha_geometric"] == pytest.approx(math.atan(0.5 / 3.0))


def test_the_weight_of_all_loads_and_their_arrows():
    (document,) = parse_documents(
        f"{BLOCK}loads: [{{weight: 9.81 kN, at: [0.1, 2.2], inertia: both}},"
        " {mass: 500, bearing: far, inertia: none}]"
    )
    build_structure(document)
    assert weight_of_loads(document) == pytest.approx(9810.0 + 500.0 * G)
    built_of = built(document.text)
    (document,) = parse_documents(document.text)
    drawn = sketch_of(document, built_of)
    assert [label for label, _ in drawn.arrows] == ["9.81 kN", "4.905 kN"]
    assert [head for _, (_, head) in drawn.arrows] == [(0.1, 2.2), (-0.25, 2.0)]
    # with the carried mass
    assert drawn.centre == pytest.approx((0.1 / 3.0, (2.0 + 2.2) / 3.0))


def test_vertical_motion_needs_loads_with_mass():
    system = Method("nonlinear").system_of(loaded("none"))
    with pytest.raises(UsageError, match="loads of inertia: none"):
        system.segments(with_vertical(sine(), sine()))


LOAD = BLOCK + "loads: [{weight: 1 kN, "
test_what_is_refused = refuses(
    built,
    DocumentError,
    [
        (LOAD + "at: [0, 2]}]", "no key 'inertia'; expected inertia: one of both"),
        (LOAD + "inertia: none}]", "no key 'at'; expected at: a point [x, z]"),
        (
            LOAD + "bearing: far, inertia: both}]",
            "loads.0: a carried load (inertia: both) cannot change its place; leave out"
            " bearing.",
        ),
        (
            LOAD + "at: [0.1, 2], mirrored: true, inertia: both}]",
            "loads.0: a carried load (inertia: both) cannot change its place; leave out"
            " mirrored.",
        ),
        (
            LOAD + "bearing: far, mirrored: true, inertia: none}]",
            "bearing: found bearing together with mirrored",
        ),
        (LOAD + "mass: 3, at: [0, 2], inertia: none}]", "weight together with mass"),
        (
            BLOCK + "loads: [{weight: 60 kN, at: [0.6, 2], inertia: none}]",
            "loads: it does not stand: its weight and its loads turn it over its right"
            " edge.",
        ),
        (
            LOAD + "bearing: far, inertia: none}]\nties: [{height: 2, stiffness: 1e6}]",
            "ties: found ties of a body with loads, whose equation has no such part;"
            " expected no ties, or no loads",
        ),
        (
            LOAD + "bearing: far, inertia: none}]\none_sided: true",
            "restitution: needed for a one-sided mechanism (between -1 and 0).",
        ),
        (
            BLOCK + "loads: [{weight: 300 kN, bearing: far, inertia: vertical}]",
            "restitution: momentum gives -0.483, that is no rocking on to the other",
        ),
        (BLOCK + "loads:", "loads: found nothing; expected the loads, or no such key"),
        (
            "kind: block\nwidth: 0.5\nheight: 2\n"
            "loads: [{weight: 1 kN, bearing: far, inertia: none}]",
            "no key 'mass'; expected mass: the mass [kg] of the body, which loads need",
        ),
        (
            "kind: point_mass\nwidth: 0.5\nheight: 2\nmass: 10\n"
            "loads: [{weight: 1 kN, bearing: far, inertia: none}]",
            "bearing: found a bearing on a body without a flat top",
        ),
        (
            "kind: frame\ncolumns: 2\nwidth: 0.5\nheight: 2\ncap_ratio: 1\nmass: 10\n"
            "loads: [{weight: 50, at: [0, 2], inertia: vertical}]",
            "loads: found loads on a body with other parts on each edge",
        ),
        (
            "kind: stack\npieces: [{width: 1, height: 4}, {width: 0.5, height: 1}]\n"
            "mass: 10\nloads: [{weight: 50, at: [0, 2], inertia: vertical}]",
            "no key 'rocks_on'",
        ),
    ],
    literal=True,
)
