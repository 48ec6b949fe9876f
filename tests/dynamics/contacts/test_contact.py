"""The contacts: uplift, impacts and sums of their sequences on equal edges, on one side
and on edges that differ; the free motion.
"""

import math

import numpy as np
import pytest
from support.references import lanes

from rocking_cli import (
    ArgumentError,
    LinearEquation,
    Method,
    Motion,
    RigidBodyEquation,
    System,
    history,
    response,
    sine,
)
from rocking_cli.dynamics.contacts.contact import OneSided, Symmetric, Unequal
from rocking_cli.dynamics.contacts.sequences import sequence_ends, sequence_time
from rocking_cli.motions import Piece
from rocking_cli.structures.parameters import RockingParameters, Side

LEFT, RIGHT = (
    Side("left", 2.0, 0.2, math.tan(0.2), 1.0, 0.9),
    Side("right", 1.6, 0.3, math.tan(0.3), 1.0, 0.7),
)
BODY = RockingParameters.of_sides("body", "prism", LEFT, RIGHT)


def march(y, v, eta):
    """The free motion in small steps of its exact hyperbolic flow, impact by impact:
    overturns, and the largest y.
    """
    peak, h, bounces = (y if v > 0 else 0.0), 1e-3, 0
    c, s = math.cosh(h), math.sinh(h)
    for _ in range(200_000):
        y, v = 1 + (y - 1) * c + v * s, (y - 1) * s + v * c
        peak = max(peak, y)
        if y < 0:
            y, v, bounces = 0.0, -eta * v, bounces + 1
        if y > 3:
            return True, peak
        if bounces > 2:
            return False, peak
    raise AssertionError("undecided")


def test_free_motion_equals_marching():
    random = np.random.default_rng(4)
    y, v, eta = (
        random.uniform(0, 1.5, 60),
        random.uniform(-2, 1.2, 60),
        random.uniform(0.3, 1, 60),
    )
    free = Symmetric().free_motion(
        LinearEquation(), lanes(eta=eta), np.arange(60), y, v
    )
    for i in range(60):
        overturns, peak = march(y[i], v[i], eta[i])
        assert overturns == (free.overturns[i] or free.overturns_after_impact[i])
        if not overturns and v[i] > 0:
            assert free.peak[i] == pytest.approx(peak, abs=2e-3)


@pytest.mark.parametrize(
    ("contact", "force"),
    [(Symmetric(), -0.7), (OneSided(), -1.4)],
    ids=["equal", "one side"],
)
def test_sequence_time_is_the_sum_of_its_arcs(contact, force):
    body, total, speed, a = lanes(v=1e-3, force=force, eta=0.6), 0.0, 1e-3, 1.0 + force
    for _ in range(200):
        total, speed, a = (
            total + 2.0 * speed / (1.0 - a),
            0.6 * speed,
            -a if contact.alike else a,
        )
    found = sequence_time(sine().segments, body, contact.other_side(body))
    assert found[0] == pytest.approx(total, rel=1e-13, abs=0)


@pytest.mark.parametrize(
    ("contact", "eta", "expected"),
    [
        *((Symmetric, eta, r"within \[0, 1\]") for eta in (-0.1, 1.1, np.nan)),
        *((OneSided, eta, r"within \(-1, 0\]") for eta in (0.1, -1.0, -1.2, np.nan)),
    ],
)
def test_restitutions_out_of_range_are_refused(contact, eta, expected):
    for given in (eta, np.array([0.0, eta])):
        with pytest.raises(ValueError, match=expected):
            contact(given)
        with pytest.raises(ValueError, match=expected):
            response(System(LinearEquation(), contact()), sine(), 2.0, 3.0, given)


def test_a_restitution_that_nobody_gave_is_asked_for():
    """By every march; the uplift needs none."""
    system = System(LinearEquation())
    assert system.least_uplift(sine()) == pytest.approx(1.0, rel=1e-12, abs=0)
    for how in ("arrays", "floats"):
        with pytest.raises(ArgumentError, match="`eta`: found none; expected"):
            response(system, sine(), 2.0, 3.0, how=how)
    with pytest.raises(ArgumentError, match="`eta`: found none; expected"):
        history(system, sine(), 2.0, 3.0, duration=9.0)


@pytest.mark.parametrize("how", ["arrays", "floats"])
def test_cells_with_restitutions_of_their_own_end_as_each_alone(how):
    amplitude, omega = np.array([1.5, 4.0, 1.8]), np.array([[6.0], [3.0]])
    eta = np.array([0.9, 0.5, 0.9])
    system = System(RigidBodyEquation(0.25))
    found = response(system, sine(), amplitude, omega, eta, how=how)
    for i, own in enumerate(eta):
        alone = response(
            system.with_restitution(own), sine(), amplitude[i], omega[:, 0], how=how
        )
        for cells, one in zip(found[:-1], alone[:-1], strict=True):
            np.testing.assert_array_equal(cells[:, i], one)


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_impacts_that_take_nothing_take_nothing_in_the_units_of_the_edges_either(model):
    """A product above 1 would be refused, and bouncing settle under one below; as they
    are multiplied a quarter of such pairs are off.
    """
    random, products = np.random.default_rng(1), set()
    for p, other, alpha, angle in random.uniform(
        (1.0, 1.0, 0.1, 0.1), (4.0, 4.0, 0.9, 0.9), (300, 4)
    ).tolist():
        left, right = (
            Side("left", p, alpha, math.tan(alpha), 1.0, 1.0),
            Side("right", other, angle, math.tan(angle), 1.0, 1.0),
        )
        contact = (
            Method(model)
            .system_of(RockingParameters.of_sides("body", "prism", left, right))
            .contact
        )
        products.add(contact.eta[0] * contact.eta[1])
    assert products == {1.0}


def alike(eta, rotation=(1.0, 1.0)):
    """Two edges that differ in these alone."""
    return Unequal(drive=(1.0, 1.0), omega=(1.0, 1.0), eta=eta, rotation=rotation)


def freed(eta, rotation, y, v):
    """The free motion from (y, v) on the right edge."""
    return alike(eta, rotation).free_motion(
        LinearEquation(), lanes(eta=eta[0]), np.array([0]), np.array([y]), np.array([v])
    )


def test_a_second_impact_after_the_shaking_may_be_the_one_that_overturns():
    """Of E = 1.6^2 + 0.5 1.5 the strong edge leaves a quarter, below 1, and the weak
    one 0.95^2, above 1.
    """
    free = freed((0.5, 1.9), (1.0, 1.0), 0.5, -1.6)
    assert (bool(free.overturns[0]), bool(free.overturns_after_impact[0])) == (
        False,
        True,
    )


@pytest.mark.parametrize(
    ("rotation", "v", "highest"),
    [
        ((1.0, 1.0), -0.5, "across"),
        ((1.0, 0.5), 0.5, "outward"),
        ((2.0, 0.5), -0.5, "back"),
    ],
)
def test_after_the_shaking_the_largest_of_three_arcs_is_kept_and_none_of_a_falling_body(
    rotation, v, highest
):
    """From y = 0.3: E = v^2 + y (2 - y) is left with eta^2 of it at each impact, and an
    arc rises to 1 - sqrt(1 - E).
    """
    eta = (1.1, 0.85)
    energy = 0.5**2 + 0.3 * 1.7
    rises = {
        "outward": 1.0 - math.sqrt(1.0 - energy) if v > 0.0 else 0.3,
        "across": (
            (1.0 - math.sqrt(1.0 - eta[0] ** 2 * energy)) * rotation[1] / rotation[0]
        ),
        "back": 1.0 - math.sqrt(1.0 - (eta[0] * eta[1]) ** 2 * energy),
    }
    assert max(rises, key=rises.__getitem__) == highest
    assert freed(eta, rotation, 0.3, v).peak[0] == pytest.approx(
        rises[highest], rel=1e-14
    )
    for y, speed in ((0.9, 1.5), (0.3, -0.7)):
        free = freed(eta, rotation, y, speed)
        assert free.overturns[0] != free.overturns_after_impact[0]
        assert math.isnan(free.peak[0])


def test_bounces_that_rise_above_the_peak_on_the_other_edge_are_not_summed():
    """Thrown across with eight times its speed v, it rises there to (8 v)^2/(2 (1 +
    a)), less what y takes of the force.
    """
    push = Motion(
        "push", (Piece(0.0, 50.0, (), -0.25),)
    ).segments  # a = 0.5 for A = 2 on the right edge
    v, beyond = 1e-3, 1.5
    height = beyond - math.sqrt(beyond**2 - (8.0 * v) ** 2)
    body = lanes(
        v=v,
        force=-0.5,
        eta=8.0,
        amplitude=2.0,
        omega=3.0,
        peak=np.array([0.99, 5.0]) * height,
    )
    there = alike((8.0, 0.1)).other_side(body)
    ends = sequence_ends(push, body, LinearEquation(), there)
    assert ends.tolist() == [False, True]


def test_rectangular_push_overturns_each_edge_at_its_own_closed_form():
    """A = 1/(1 - exp(-p t_d)) of the edge that the ground throws the body on to."""
    t_d = 0.9
    system = Method().system_of(BODY)
    for side, sign in ((LEFT, 1.0), (RIGHT, -1.0)):
        push = Motion("push", (Piece(0.0, t_d * BODY.p, (), sign),))
        edge = side.alpha / BODY.alpha / (1.0 - math.exp(-side.p * t_d))
        below, above = (
            int(response(system, push, f * edge, 1.0, 0.9).outcome)
            for f in (1.0 - 1e-9, 1.0 + 1e-9)
        )
        assert (below, above) == (2, 3)


@pytest.mark.parametrize(
    "bad",
    [
        {"drive": (0.0, 1.0)},
        {"omega": (1.0, -1.0)},
        {"eta": (1.2, 0.9)},
        {"eta": (-0.1, 0.9)},
    ],
)
def test_numbers_out_of_range_are_refused(bad):
    with pytest.raises(ValueError, match="of both edges"):
        Unequal(
            **{
                "drive": (1.0, 1.0),
                "omega": (1.0, 1.0),
                "eta": (0.9, 0.9),
                "rotation": (1.0, 1.0),
                **bad,
            }
        )
