"""A wall between two floors: an independent program, its closed form, the search for
the crack, and what is refused.
"""

import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.bodies import rotation_under
from support.documents import built, built_motion
from support.refusals import refuses

from rocking_cli import DocumentError, load_structures, sine
from rocking_cli.motions.biaxial import with_vertical

G = 9.81
WALL = "kind: wall\nname: w\nthickness: 0.3\nheight: 3\ndensity: 1800\nlength: 1\n"
HELD = WALL + "top: held\n"


def wall(t=0.3, h=3.0, crack="auto", load="", more=""):
    return built(
        f"kind: wall\nname: w\nthickness: {t!r}\nheight: {h!r}\nlength: 1\n"
        f"density: 1800\ntop: held\ncrack_height: {crack}\nloads: [{load}]\n{more}"
    )


def weight(w, bearing, inertia):
    return f"{{weight: {w!r}, bearing: {bearing}, inertia: {inertia}}}"


# an independent program, 2026: wall_unloaded, wall_loaded_centre, wall_loaded_far,
# wall_negative_eta, wall_one_sided and wall_storey_above: the document, then lambda,
# alpha, p, a_scale, eta, top_reaction
UNLOADED = (0.4, 0.19739555984988075, 4.386227633976139, 0.4934888996247018)
CASES = {
    "unloaded": (
        {"crack": 1.5},
        (*UNLOADED, 0.741379310344827, 2383.83),
    ),
    "loaded, centre": (
        {"crack": 2.0, "load": weight(15892.2, "centre", "vertical")},
        (
            0.9,
            0.1116119011315093,
            7.657703851672636,
            0.12401322347945483,
            0.46292947558770386,
            5562.27,
        ),
    ),
    "loaded, far": (
        {"t": 0.25, "h": 2.8, "crack": 1.6, "load": weight(10e3, "far", "none")},
        (
            0.9024120323177414,
            0.15499674192394094,
            7.228592995319595,
            0.17175828376960983,
            0.8233735649102147,
            5025.364583333332,
        ),
    ),
    "restitution given": (
        {
            "crack": 1.5,
            "load": weight(31784.4, "far", "vertical"),
            "more": "restitution: 0.6",
        },
        (
            2.0,
            0.19739555984988075,
            9.80790315435871,
            0.09869777992494033,
            0.6,
            15097.59,
        ),
    ),
    "one-sided": (
        {"crack": 1.5, "more": "one_sided: true\nrestitution: -0.3"},
        (*UNLOADED, -0.3, 2383.83),
    ),
    "storey above": (  # a held storey as a third body
        {"crack": 1.65, "load": weight(20e3, "far", "vertical")},
        (
            1.3805890927497753,
            0.17985349979247833,
            8.14721652534667,
            0.13027301225034077,
            0.15051400709087656,
            24981.57991739676 - 12805.890927497743,
        ),
    ),
}
# one cycle of a sine in half the time
FASTER = "pieces: [{from: 0, to: 0.5, sines: [{amplitude: 1, frequency: 2}]}]"
# the same program: a_g [m/s2] and T_g [s] of one cycle of a sine, factor of a vertical
# cycle of T_g/2, theta/alpha
PULSES = [
    ("unloaded", 5.0, 0.6, None, 0.4572053392554346),
    ("unloaded", 6.0, 0.6, None, None),
    ("loaded, centre", 12.0, 0.4, None, 0.5317611885917896),
    ("loaded, centre", 15.0, 0.4, None, None),
    ("loaded, centre", 12.0, 0.4, 0.5, 0.513809631070288),
    ("loaded, far", 10.5, 0.4, None, 0.19287002191553054),
    ("restitution given", 26.0, 0.3, None, 0.3060557447930456),
    ("one-sided", 6.0, 0.5, None, 0.10661474804671298),
    ("one-sided", -6.0, 0.5, None, 0.10554596171833752),
]


@pytest.mark.requirement(
    "A wall between two floors cracks at the height of the least lambda",
    "structures/kinds/wall.py",
    "Wall between two floors",
    "The same as a mechanism of two bodies, cracked at 2 m",
)
@pytest.mark.parametrize("case", CASES)
def test_the_parameters_are_those_of_an_independent_program(case):
    document, wanted = CASES[case]
    found = wall(**document)
    own = (found.uplift, found.alpha, found.p, found.a_scale, found.eta)
    assert own == pytest.approx(wanted[:5], rel=1e-9)
    assert found.sides == ()
    if case != "storey above":
        assert found.details["top_reaction"] == pytest.approx(wanted[5], rel=1e-9)


@pytest.mark.parametrize(("case", "a_g", "period", "vertical", "wanted"), PULSES)
def test_the_motion_is_that_of_an_independent_program(
    case, a_g, period, vertical, wanted
):
    body, motion = wall(**CASES[case][0]), sine()
    if vertical:
        motion = with_vertical(motion, built_motion(FASTER).scaled(vertical))
    found = rotation_under(body, a_g, period, motion, tolerance=1e-11)
    assert found == (wanted if wanted is None else pytest.approx(wanted, abs=1e-8))


def test_the_shipped_document(pytestconfig):
    # an independent program, 2026
    (found,) = load_structures(
        [pytestconfig.rootpath / "configs" / "wall_between_floors.yaml"]
    )
    own = (found.uplift, found.alpha, found.p, found.eta, found.details["crack_height"])
    wanted = (0.866274420, 0.111341351, 7.504771386, 0.478316826, 2.009744808)
    assert own == pytest.approx(wanted, abs=6e-10)
    assert found.details["lambda_governing"] == pytest.approx(found.uplift, rel=1e-12)
    assert found.remarks == ()


@settings(max_examples=3)
@given(
    st.floats(0.15, 0.4),
    st.floats(8.0, 14.0),
    st.floats(0.05, 3.0),
    st.sampled_from(["far", "centre"]),
)
def test_the_crack_is_that_of_the_least_lambda(t, slenderness, k, bearing):
    h, delta = slenderness * t, {"far": 1.0, "centre": 0.5}[bearing]
    load = weight(k * 1800.0 * G * t * h, bearing, "none")
    found = wall(t, h, "auto", load)
    share = k * delta / (1.0 + k * (1.0 - delta))
    crack = h * (1.0 + share - math.sqrt(share * share + share))
    least = 2.0 * t / h * (math.sqrt(1.0 + k) + math.sqrt(delta * k)) ** 2
    if crack > h - t:
        assert found.details["crack_height"] == pytest.approx(h - t, rel=1e-12)
        assert "ends on its bound" in found.remarks[0]
        return
    assert found.details["crack_height"] == pytest.approx(crack, rel=1e-12)
    assert found.uplift == pytest.approx(least, rel=1e-10)
    for other in (0.99 * crack, min(1.01 * crack, 0.999 * h)):
        there = wall(t, h, repr(other), load)
        assert there.uplift > found.uplift
        assert there.details["lambda_governing"] == pytest.approx(least, rel=1e-10)
    # reaction of the floor at rest
    upper, weighs = 1800.0 * G * t * (h - crack), k * 1800.0 * G * t * h
    reaction = 0.5 * least * upper + (0.5 * upper * t + weighs * delta * t) / (
        h - crack
    )
    assert found.details["top_reaction"] == pytest.approx(reaction, rel=1e-8)


def test_a_search_that_ends_on_a_bound_says_so():
    found = built(HELD)
    assert found.details["crack_height"] == pytest.approx(2.7)
    assert "w: the search for crack_height ends on its bound, 2.7 m" in found.remarks[0]
    given_one = wall(crack=1.5)
    assert given_one.remarks[-1] == (
        "w: it moves from 0.222 g on, in another mechanism (a crack at 2.7 m); lambda ="
        " 0.4 is that of the crack given."
    )
    assert given_one.details["joints_source"] == "given"


def test_directions_differ_under_a_fixed_load():
    # a load on one face: near while it bulges one way, far while it bulges the other
    load = "{weight: 15892.2, at: [0.15, 3], inertia: vertical}"
    found = wall(crack=2.0, load=load)
    near, far = (
        wall(2.0 * 0.15, 3.0, 2.0, weight(15892.2, b, "vertical"), "restitution: 0.5")
        for b in ("near", "far")
    )
    left, right = found.sides
    assert right.uplift == pytest.approx(far.uplift, rel=1e-12)
    assert left.uplift == pytest.approx(near.uplift, rel=1e-12)
    assert (right.p, right.alpha) == pytest.approx((far.p, far.alpha), rel=1e-10)
    # the crack of the weaker direction
    auto = wall(load=load)
    assert min(side.uplift for side in auto.sides) == pytest.approx(
        auto.details["lambda_governing"], rel=1e-12
    )


def test_a_free_wall_is_as_before():
    free, plain = built(WALL + "top: free"), built(WALL)
    assert json.dumps(free.row()) == json.dumps(plain.row())


test_what_is_refused = refuses(
    built,
    DocumentError,
    [
        (
            WALL + "crack_height: 2",
            "crack_height: found crack_height of a wall whose top is free",
        ),
        (WALL + "top: heldd", "top: found heldd; expected one of held, free"),
        (
            HELD + "crack_height: 4",
            "crack_height: found 4; expected a length between 0 and the height, 3 m; or"
            " auto",
        ),
        (HELD + "crack_height: automatic", "crack_height: found automatic"),
        (
            HELD + "inset: 10 mm",
            "inset: found inset of a wall whose top is held; expected no inset",
        ),
        (HELD + "ties: [{height: 2, stiffness: 1e6}]", "ties: found ties of a wall"),
        (
            HELD + "loads: [{weight: 1 kN, at: [0, 2], inertia: vertical}]",
            "it is searched only for loads on the top, at z = 3 m",
        ),
        (
            HELD + "loads: [{weight: 1 kN, at: [0, 3500], inertia: vertical}]",
            "loads: found loads.0 at [0, 3500] m; expected a load on the wall",
        ),
        (
            HELD + "one_sided: true",
            "restitution: needed for a one-sided mechanism (between -1 and 0).",
        ),
        (
            HELD
            + "crack_height: 1.5\nloads: ["
            + weight(31784.4, "far", "vertical")
            + "]",
            "restitution: momentum gives -0.0472, that is no rocking on to the other"
            " side (loads with vertical inertia, or squat bodies); state a restitution",
        ),
        (
            "kind: wall\nthickness: 0.3\nheight: 3\ntop: held",
            "no key 'mass'; expected mass: mass, or density and length",
        ),
        (
            "kind: wall\nthickness: 2.5\nheight: 3\nmass: 100\ntop: held",
            "thickness: found 2.5 m, above 3/4 of the height",
        ),
    ],
    literal=True,
)
