"""The parameters' record: sides, one side, damping; what it refuses."""

import json
import math
from dataclasses import replace

import pytest
from support.documents import built
from support.refusals import refuses

from rocking_cli import RockingParameters, dimensionless_oscillator
from rocking_cli.structures.parameters import Side

LEFT = Side("left", 2.1, 0.3, 0.31, 1.0, 0.8)
RIGHT = Side("right", 1.9, 0.2, 0.21, 1.0, 0.9)
TWO = RockingParameters.of_sides("Statue", "rigid", LEFT, RIGHT)
STATUE = "kind: rigid\nleft: 0.42\nright: 31 cm\nheight: 1.15\ngyration: 0.68\n"
NUMBER = RockingParameters(
    name="x", structure="block", p=1.0, alpha=0.2, eta=0.9, uplift=0.2, a_scale=1.0
)


def test_an_unequal_body_has_the_numbers_of_the_edge_that_lifts_first():
    assert (TWO.p, TWO.alpha, TWO.eta, TWO.uplift, TWO.a_scale) == (
        1.9,
        0.2,
        0.9,
        0.21,
        1.0,
    )
    assert TWO.sides == (LEFT, RIGHT)
    same = RockingParameters.of_sides(
        "Statue", "rigid", replace(RIGHT, side="left"), RIGHT
    )
    assert (same.sides, same.p, same.eta) == (
        (),
        RIGHT.p,
        RIGHT.eta,
    )  # a symmetric body


def test_defaults_are_not_printed_and_a_row_is_read_again():
    now = NUMBER.row()
    assert RockingParameters.from_row(now) == NUMBER
    assert not {"sides", "one_sided", "damping"} & set(now)


REFUSED = [
    (
        (TWO, {"sides": (RIGHT, LEFT)}),
        "expected two, the left one first and then the right one",
    ),
    (
        (TWO, {"sides": (LEFT,)}),
        "expected two, the left one first and then the right one",
    ),
    ((TWO, {"p": 2.0}), "not those of the right edge, which lifts first"),
    ((TWO, {"one_sided": True, "eta": -0.4}), "one side"),
    ((TWO, {"one_sided": True, "sides": ()}), "eta is 0.9; expected a number above -1"),
    ((TWO, {"eta": -0.4, "sides": ()}), "eta is -0.4; expected a number from 0 to 1"),
    ((TWO, {"damping": -0.1}), "damping is -0.1"),
    ((TWO, {"damping": 1.0}), "damping is 1; expected a number from 0 to below 1"),
    ((NUMBER, {"p": 0.0}), "p is 0; expected"),
    ((NUMBER, {"alpha": math.nan}), "alpha is nan; expected"),
    ((NUMBER, {"eta": 1.2}), "eta is 1.2; expected"),
    ((NUMBER, {"uplift": -1.0}), "lambda is -1; expected"),
    ((NUMBER, {"a_scale": math.inf}), "a_scale is inf; expected"),
    ((LEFT, {"side": "top"}), "side is 'top'; expected left or right"),
    ((LEFT, {"p": 0.0}), "p is"),
    ((LEFT, {"alpha": math.nan}), "alpha is"),
    ((LEFT, {"eta": 1.1}), "eta is"),
    ((LEFT, {"eta": -0.1}), "eta is"),
]
test_numbers_that_cannot_be = refuses(
    lambda given: replace(given[0], **given[1]), ValueError, REFUSED
)


def test_dimensionless_oscillator_scales_nothing():
    o = dimensionless_oscillator(eta=0.9)
    assert (o.dimensionless, TWO.dimensionless) == (True, False)
    assert (o.dimensionless_amplitude(3.0), o.p, o.name) == (3.0, 1.0, "eta=0.9")


def test_a_linear_oscillator_can_lift_where_the_body_does():
    """Eq. 3.9 for a rigid body: a_g at A = 1 is then lambda g; unequal edges each by
    itself, and mechanisms as they are.
    """
    for text in ("kind: block\nwidth: 1\nheight: 2", STATUE):
        body = built(text)
        lifted = body.lifting_at_lambda()
        assert body.linear_uplift == body.alpha
        assert lifted.linear_uplift == pytest.approx(body.uplift, rel=1e-14, abs=0.0)
        assert lifted.ground_acceleration(1.0) == pytest.approx(
            body.uplift * 9.81, rel=1e-14, abs=0.0
        )
        assert [side.a_scale for side in lifted.sides] == [
            side.alpha / side.uplift for side in body.sides
        ]
    stated = built(
        "kind: parameters\np: 2\nalpha: 0.1\neta: 0.9\nlambda: 0.3\na_scale: 0.5"
    )
    assert stated.lifting_at_lambda() == stated


TEXTS = [
    STATUE + more
    for more in (
        "",
        "mass: 3 t",
        "restitution: 0.7\ndamping: 0.05",
        "one_sided: true\nrestitution: -0.3",
    )
]
TEXTS += [
    "kind: block\nwidth: 0.5\nheight: 2",
    "kind: spire\nbase_radius: 1\nheight: 9\nname: Ö 'x'",
]


@pytest.mark.parametrize(
    "body", [TWO, replace(TWO, damping=0.05), *map(built, TEXTS)], ids=range(8)
)
def test_what_is_printed_is_a_document_of_the_same_body(body):
    assert built(json.dumps(body.row())) == body


SIDES = (
    "kind: parameters\nsides:\n- {side: left, p: 2, alpha: 0.2, lambda: 0.2, eta:"
    " 0.9}\n"
)
OTHER = "- {side: right, p: 2, alpha: 0.3, a_scale: 1, eta: 0.8}\n"


def test_sides_are_read_with_lambda_or_a_scale():
    body = built(SIDES + OTHER)
    assert body.sides[1] == Side("right", 2.0, 0.3, 0.3, 1.0, 0.8)
    assert (body.alpha, body.eta) == (0.2, 0.9)
    assert built(SIDES + OTHER + "alpha: 0.2\np: 2 rad/s") == body


def test_parameters_give_lambda_and_a_scale_from_each_other():
    base = "kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\n"
    assert built(base + "lambda: 0.4").a_scale == pytest.approx(0.5)
    assert built(base + "a_scale: 0.5").uplift == pytest.approx(0.4)
    both = built(base + "lambda: 0.3\na_scale: 1")
    assert (both.uplift, both.a_scale) == (0.3, 1.0)
