"""Planar mechanisms against closed forms, an oracle that takes differences of places,
and the static theorem.
"""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles.arch_linkage import carried
from oracles.mechanism_pulse import OneWay, Part, peak
from support.bodies import rotation_under

from rocking_cli import sine
from rocking_cli.dynamics.method import Method
from rocking_cli.dynamics.response import response
from rocking_cli.structures.mechanics.assembly import (
    Assembly,
    Hinge,
    Load,
    MechanismFault,
    PlanarBody,
    Rigid,
    Slide,
)
from rocking_cli.structures.mechanics.planar_mechanism import find_mechanism

G = 9.81


def rectangle(name, x0, x1, z0, z1, density=1800.0):
    m, w, h = density * (x1 - x0) * (z1 - z0), x1 - x0, z1 - z0
    corners = ((x0, z0), (x1, z0), (x1, z1), (x0, z1))
    centre = (0.5 * (x0 + x1), 0.5 * (z0 + z1))
    return PlanarBody(name, m, centre, m * (w * w + h * h) / 12.0, corners)


def held_wall(t, h, crack, load, share, inertia):
    """A wall between floors: its mechanism; load: over the weight of the wall."""
    half = 0.5 * t
    bodies = (
        rectangle("lower", -half, half, 0.0, crack),
        rectangle("upper", -half, half, crack, h),
    )
    bearing = (half - t + share * t, h)
    loads = ()
    if load:
        loads = (Load("upper", bearing, load * 1800.0 * t * h, inertia, True),)
    joints = (
        Hinge(("ground", "lower"), (half, 0.0)),
        Hinge(("lower", "upper"), (-half, crack)),
        Slide("upper", bearing),
    )
    return find_mechanism(Assembly(bodies, loads), joints)


walls = st.tuples(
    st.floats(0.15, 0.5),
    st.floats(8.0, 14.0),
    st.floats(0.3, 0.9),
    st.floats(0.0, 2.0),
    st.floats(0.0, 1.0),
    st.sampled_from(["vertical", "none"]),
)


@settings(max_examples=5)
@given(walls)
def test_a_wall_between_floors_is_its_closed_form(wall):
    # lambda, eta and the reaction of the floor at rest, exact for any thickness
    t, slenderness, beta, k, share, inertia = wall
    h, r = slenderness * t, beta / (1.0 - beta)
    h1, i = beta * h, inertia == "vertical"
    found = held_wall(t, h, h1, k, share, inertia)
    (eta, _), _ = found.momentum
    assert found.right.form.uplift == pytest.approx(
        2.0 * t / h1 * (1.0 + k * (1.0 + share * r)), rel=1e-10
    )
    up = i * k * (1.0 + share * r) ** 2
    below = h1 * h1 / 3.0 + t * t * (1.0 + r / 3.0 + up)
    assert eta == pytest.approx(
        (h1 * h1 / 3.0 - t * t * (1.0 + r / 6.0 + up)) / below, rel=1e-9, abs=1e-12
    )
    weight, upper, h2 = 1800.0 * G * t * h, 1800.0 * G * t * (1.0 - beta) * h, h - h1
    reaction = 0.5 * found.right.form.uplift * upper
    reaction += (0.5 * upper * t + k * weight * share * t) / h2
    (*_, slide) = found.right.joint_rows(G, None, None)
    assert slide["reaction"] == pytest.approx(reaction, rel=1e-9)


@settings(max_examples=5)
@given(
    st.floats(0.2, 0.5),
    st.floats(0.1, 2.0),
    st.floats(-0.15, 0.15),
    st.floats(1.5, 2.5),
    st.sampled_from(["vertical", "none", "both"]),
)
def test_a_block_under_a_load_is_its_closed_form(b, k, x, z, inertia):
    # a block of half width b, its mass centre at h = 1 m, I_O about its edge
    body = rectangle("block", -b, b, 0.0, 2.0)
    load = Load("block", (x, z), k * body.mass, inertia)
    joints = (Hinge(("ground", "block"), (b, 0.0)),)
    found = find_mechanism(Assembly((body,), (load,)), joints)
    numbers, m, d, h = found.right.numbers(G), body.mass, b - x, 1.0
    about = body.inertia + m * (b * b + h * h)
    alpha = math.atan2(b + k * d, h + k * z)
    rising = {
        "vertical": (d * math.cos(alpha) - z * math.sin(alpha)) ** 2,
        "none": 0.0,
        "both": d * d + z * z,
    }[inertia]
    reach = math.hypot(b + k * d, h + k * z)
    uplift = math.tan(alpha) if inertia == "both" else (b + k * d) / h
    assert numbers["alpha"] == pytest.approx(alpha, rel=1e-11)
    assert numbers["uplift"] == pytest.approx(uplift, rel=1e-11)
    p = math.sqrt(G * m * reach / (about + k * m * rising))
    assert numbers["p"] == pytest.approx(p, rel=1e-10)
    if inertia == "vertical":
        (eta, _), _ = found.momentum
        other = b + x
        wanted = body.inertia + m * (h * h - b * b) - k * m * d * other
        assert eta == pytest.approx(wanted / (about + k * m * other**2), rel=1e-11)


# A portal on a slope, by an independent program, 2026: lambda, alpha, p, eta.
PORTAL = {
    "right": (0.170273877, 0.183109419, 1.755042214, 0.950684220),
    "left": (0.176554945, 0.185951191, 1.772962142, 0.943336789),
}
LEFT, RIGHT = (0.0, 0.7, 0.0, 3.5), (3.0, 3.6, -0.6, 3.5)


def portal(**more):
    bodies = (
        rectangle("left", *LEFT, 2000.0),
        rectangle("right", *RIGHT, 2000.0),
        rectangle("beam", 0.0, 3.6, 3.5, 4.0, 2400.0),
    )

    def joints(a, b, c, d):
        return (
            Hinge(("ground", "left"), a),
            Hinge(("ground", "right"), d),
            Hinge(("left", "beam"), b),
            Hinge(("right", "beam"), c),
        )

    return find_mechanism(
        Assembly(bodies),
        joints((0.7, 0.0), (0.0, 3.5), (3.0, 3.5), (3.6, -0.6)),
        other=joints((0.0, 0.0), (0.7, 3.5), (3.6, 3.5), (3.0, -0.6)),
        **more,
    )


def test_a_portal_whose_directions_differ():
    found = portal()
    for name, side, eta in zip(
        PORTAL, (found.right, found.left), found.momentum, strict=True
    ):
        numbers = side.numbers(G)
        own = (numbers["uplift"], numbers["alpha"], numbers["p"], eta[0])
        assert own == pytest.approx(PORTAL[name], abs=6e-10)


@pytest.mark.slow
def test_a_side_may_be_measured_by_another_body():
    # eta of one side then exceeds 1; the motion and the product of both stay
    one, other = portal(), portal(coordinate="left", other_coordinate="right")
    (here, _), (there, _) = other.momentum
    assert max(here, there) > 1.0
    assert here * there == pytest.approx(
        one.momentum[0][0] * one.momentum[1][0], rel=1e-12
    )
    cell = np.linspace(1.1, 4.0, 10), np.full(10, 6.0)
    bodies = [x.parameters("portal", "mechanism", gravity=G) for x in (one, other)]
    found = [
        response(Method("nonlinear").system_of(body), sine(), *cell, body.eta)
        for body in bodies
    ]
    assert (found[0].outcome == found[1].outcome).all()


def _portal_oracle():
    """Both directions of the portal, by links placed on circles that meet."""
    found = {}
    bodies = [
        rectangle("left", *LEFT, 2000.0),
        rectangle("beam", 0.0, 3.6, 3.5, 4.0, 2400.0),
        rectangle("right", *RIGHT, 2000.0),
    ]
    for side, hinges in (
        (1, [(0.7, 0.0), (0.0, 3.5), (3.0, 3.5), (3.6, -0.6)]),
        (-1, [(0.0, 0.0), (0.7, 3.5), (3.6, 3.5), (3.0, -0.6)]),
    ):
        # the image about x = 0 for the direction -x, where the left link turns too
        points = np.array([(side * x, z) for x, z in hinges])
        masses = [
            (b.mass, b.mass * side * b.centre[0], b.mass * b.centre[1], 0.0)
            for b in bodies
        ]

        def place(phi, i, side=side, points=points, masses=masses):
            x, z, turn = carried(points, masses, phi)[i]
            return np.array([side * x, z, side * turn])

        parts = [
            Part(b.mass, b.inertia, lambda phi, i=i, place=place: place(phi, i))
            for i, b in enumerate(bodies)
        ]
        found[side] = OneWay(parts, 0.3)
    return found


def _wall_oracle(t, h1, h2, share, load):
    """A wall between floors, by the explicit rotation of its upper part."""

    def psi(phi):
        wanted = h1 * math.sin(phi) + t * (1.0 - math.cos(phi))
        # h2 sin psi + share t (1 - cos psi) = wanted
        reach, off = math.hypot(h2, share * t), math.atan2(share * t, h2)
        return math.asin((wanted - share * t) / reach) + off

    def lower(phi):
        x = 0.5 * t - 0.5 * t * math.cos(phi) + 0.5 * h1 * math.sin(phi)
        return np.array([x, 0.5 * t * math.sin(phi) + 0.5 * h1 * math.cos(phi), phi])

    def upper(phi, at):
        x = 0.5 * t - t * math.cos(phi) + h1 * math.sin(phi)
        z, turn = t * math.sin(phi) + h1 * math.cos(phi), psi(phi)
        cos, sin = math.cos(turn), math.sin(turn)
        return np.array(
            [x + at[0] * cos - at[1] * sin, z + at[0] * sin + at[1] * cos, turn]
        )

    def parts(side):
        def image(place):
            return lambda phi: np.array([side, 1.0, side]) * place(phi)

        bodies = [
            rectangle("lower", 0.0, t, 0.0, h1),
            rectangle("upper", 0.0, t, 0.0, h2),
        ]
        found = [
            Part(bodies[0].mass, bodies[0].inertia, image(lower)),
            Part(
                bodies[1].mass,
                bodies[1].inertia,
                image(lambda phi: upper(phi, (0.5 * t, 0.5 * h2))),
            ),
        ]
        bearing = image(lambda phi: upper(phi, (share * t, h2)))
        return [*found, Part(load, 0.0, bearing, pushed=False)]

    return {side: OneWay(parts(side), 0.2) for side in (1, -1)}


SCENES = [
    ("portal", 2.2, 1.2),
    ("portal", -2.2, 1.2),
    ("portal", 3.2, 0.8),
    ("portal", -2.4, 1.3),
    ("wall", 12.0, 0.4),
    ("wall", 9.9, 0.6),
]


@pytest.mark.parametrize(("kind", "a_g", "period"), SCENES)
def test_the_motion_is_that_of_differences_of_places(kind, a_g, period):
    if kind == "portal":
        mechanism, oracle = portal(), _portal_oracle()
    else:
        mechanism = held_wall(0.3, 3.0, 2.0, 1.0, 0.5, "vertical")
        oracle = _wall_oracle(0.3, 2.0, 1.0, 0.5, 1800.0 * 0.9)
    body = mechanism.parameters(kind, "mechanism", gravity=G)
    eta = {1: mechanism.momentum[0][0], -1: mechanism.momentum[1][0]}
    for side, one in ((mechanism.right, oracle[1]), (mechanism.left, oracle[-1])):
        numbers = side.numbers(G)
        assert numbers["alpha"] == pytest.approx(one.alpha, rel=1e-8)
        assert numbers["p"] == pytest.approx(one.p, rel=1e-7)
    wanted = peak(oracle, eta, a_g, period)
    for how in ("floats", "arrays"):
        found = rotation_under(body, a_g, period, tolerance=1e-11, how=how)
        assert found == (wanted if wanted is None else pytest.approx(wanted, rel=1e-6))


@settings(max_examples=5)
@given(
    st.integers(2, 6),
    st.lists(st.floats(0.2, 0.7), min_size=6, max_size=6),
    st.integers(1, 5),
    st.floats(0.0, 20e3),
    st.sampled_from(["vertical", "none"]),
)
def test_no_admissible_joints_lift_before_the_static_theorem(
    count, heights, crack, load, inertia
):
    # courses between a floor and the ground, cracked at any joint
    assume(crack < count)
    levels = np.concatenate([[0.0], np.cumsum(heights[:count])])
    names = [f"c{i}" for i in range(count)]
    bodies = tuple(
        rectangle(name, 0.0, 0.3, low, high)
        for name, (low, high) in zip(names, pairwise(levels.tolist()), strict=True)
    )
    top = (0.15, float(levels[-1]))
    loads = (Load(names[-1], top, load / G, inertia),) if load else ()
    joints = [
        Hinge(("ground", names[0]), (0.3, 0.0)),
        Hinge((names[crack - 1], names[crack]), (0.0, float(levels[crack]))),
        Slide(names[-1], top),
        *(Rigid(tuple(g)) for g in (names[:crack], names[crack:]) if len(g) > 1),
    ]
    assembly = Assembly(bodies, loads)
    try:
        given_ones = find_mechanism(assembly, joints)
    except MechanismFault:
        assume(False)
    searched = find_mechanism(assembly, [Slide(names[-1], top)])
    uplift = given_ones.right.form.uplift
    least, _ = given_ones.right.governing
    assert least <= uplift * (1.0 + 1e-9)
    assert searched.right.form.uplift == pytest.approx(least, rel=1e-9)


def test_columns_and_a_beam_are_a_frame():
    # p of Makris and Vassiliou (2013) for four columns of 0.9 m x 6.5 m, gamma = 1.2
    columns = [
        rectangle(f"c{i}", x, x + 0.9, 0.0, 6.5) for i, x in enumerate((0, 4, 8, 12))
    ]
    beam = rectangle("beam", 0.0, 12.9, 6.5, 7.5)
    beam = beam._replace(mass=1.2 * 4.0 * columns[0].mass)
    joints = [
        joint
        for c in columns
        for joint in (
            Hinge(("ground", c.name), c.outline[1]),
            Hinge((c.name, "beam"), c.outline[3]),
        )
    ]
    found = find_mechanism(Assembly((*columns, beam)), joints)
    numbers, radius = found.right.numbers(G), 0.5 * math.hypot(0.9, 6.5)
    alone = math.sqrt(0.75 * G / radius)
    assert numbers["alpha"] == pytest.approx(math.atan2(0.9, 6.5), rel=1e-12)
    assert numbers["p"] == pytest.approx(alone * math.sqrt(3.4 / 4.6), rel=1e-12)


def test_a_storey_that_is_held_above_is_a_vertical_load():
    load = held_wall(0.3, 3.0, 1.65, 20e3 / G / (1800.0 * 0.9), 1.0, "vertical")
    lower = rectangle("lower", -0.15, 0.15, 0.0, 1.65)
    upper = rectangle("upper", -0.15, 0.15, 1.65, 3.0)
    above = PlanarBody("above", 20e3 / G, (0.0, 4.5), 20e3 / G)
    joints = (
        Hinge(("ground", "lower"), (0.15, 0.0)),
        Hinge(("lower", "upper"), (-0.15, 1.65)),
        Slide("upper", (0.15, 3.0)),
        Hinge(("upper", "above"), (0.15, 3.0)),
        Slide("above", (0.0, 6.0)),
    )
    storey = find_mechanism(Assembly((lower, upper, above)), joints)
    assert storey.right.form == pytest.approx(load.right.form, rel=1e-10)
    assert storey.momentum[0] == pytest.approx(load.momentum[0], rel=1e-9)


def test_the_path_goes_on_only_as_far_as_it_is_asked():
    """And its positions are the same in whatever order they are asked."""
    linkage = held_wall(0.3, 3.0, 1.65, 0.0, 1.0, "vertical").right
    step_by_step, at_once = replace(linkage), replace(linkage)
    phi = np.array([0.3, -0.2, 1e-3, 0.7, 2.0])
    whole = at_once.coefficients(phi)
    assert step_by_step.reach_to(1e-3) == 1e-3
    assert step_by_step._walks[0].marks[-1] < 0.1
    each = [[float(x) for x in step_by_step.coefficients(one)] for one in phi]
    # sums of products round differently in arrays and alone, on some processors
    np.testing.assert_allclose(each, np.transpose(whole), rtol=1e-15)
    assert math.isnan(each[-1][0])
    assert step_by_step.reach_to(2.0) == at_once.reach_to(2.0) <= 0.5 * math.pi
