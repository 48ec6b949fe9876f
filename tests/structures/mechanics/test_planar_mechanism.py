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
from rocking_cli.structures.mechanics.held_wall import HeldWall
from rocking_cli.structures.mechanics.planar_mechanism import find_mechanism

G = 9.81


def rectangle(name, x0, x1, z0, z1, density=1800.0):
    m, w, h = density * (x1 - x0) * (z1 - z0), x1 - x0, z1 - z0
    corners = ((x0, z0), (x1, z0), (x1, z1), (x0, z1))
    centre = (0.5 * (x0 + x1), 0.5 * (z0 + z1))
    return PlanarBody(name, m, centre, m * (w * w + h * h) / 12.0, corners)


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


@pytest.mark.slow
def test_a_side_may_be_measured_by_another_body():
    # eta of one side then exceeds 1; the motion and the product of both stay
    one, other = portal(), portal(coordinate="left", other_coordinate="right")
    (here, _), (there, _) = other.momentum
    assert max(here, there) > 1.0
    assert here * there == pytest.approx(
        one.momentum[0][0] * one.momentum[1][0], rel=1e-12
    )
    cell = np.linspace(1.1, 4.0, 4), np.full(4, 6.0)
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


@pytest.mark.parametrize(
    ("a_g", "period"), [(2.2, 1.2), (-2.2, 1.2), (3.2, 0.8), (-2.4, 1.3)]
)
def test_the_motion_is_that_of_differences_of_places(a_g, period):
    mechanism, oracle = portal(), _portal_oracle()
    body = mechanism.parameters("portal", "mechanism", gravity=G)
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


def test_the_path_goes_on_only_as_far_as_it_is_asked():
    """And its positions are the same in whatever order they are asked."""
    linkage = HeldWall(0.3, 3.0, 1620.0, {1.0: ()}).mechanism(1.65, False).right
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
