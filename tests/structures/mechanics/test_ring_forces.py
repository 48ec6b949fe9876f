"""Forces in an arch that sways: against Eq. 3.4, the static theorem, and the momentum
of the links.
"""

import numpy as np
import pytest
from oracles.arch_linkage import carried, links_of
from support.documents import built

from rocking_cli.structures.mechanics.joint_forces import Moving
from rocking_cli.structures.mechanics.ring_forces import RingForces

G = 9.81
WHOLE = "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\n"
SEVEN = f"{WHOLE}voussoirs: 7"


def arch(text):
    structure = built(text)
    return structure, RingForces(structure.mechanism, G)


def moved(forces, phi, rate, across, up):
    """These instants, with phi'' of the equation of motion."""
    acceleration = forces.linkage.acceleration(phi, rate, across, up, G)
    return Moving(phi, rate, acceleration, across, up)


def at_rest(forces, across):
    zero = np.zeros(1)
    return moved(forces, zero, zero, np.array([across]), zero)


def resultants(forces, moving, joints):
    return forces.resultants(moving, forces.during(moving), joints)


@pytest.mark.parametrize(
    ("text", "sections"), [(SEVEN, 7), (WHOLE, 500)], ids=["voussoirs", "continuous"]
)
def test_at_incipient_motion_no_joint_is_beyond_its_face(text, sections):
    """The static theorem: under lambda a thrust line lies within the arch and touches
    its faces at the hinges.
    """
    structure, forces = arch(text)
    moving = at_rest(forces, -structure.uplift * G)
    assert moving.acceleration == pytest.approx([0.0], abs=1e-12)
    joints = np.linspace(0.0, forces.linkage.ring.angle, sections + 1)
    found = resultants(forces, moving, joints)
    assert found.thrust.min() > 0.0
    assert found.eccentricity.max() <= 1.0 + 1e-9
    assert np.abs(
        resultants(forces, moving, np.array(forces.linkage.angles)).eccentricity
    ) == pytest.approx(1.0, abs=1e-10)
    beyond = resultants(forces, at_rest(forces, -1.02 * structure.uplift * G), joints)
    assert beyond.eccentricity.max() > 1.0 or sections == 7


def swaying(structure, forces, count=6):
    phi = np.linspace(0.01, 0.9, count) * structure.alpha
    return moved(
        forces,
        phi,
        np.linspace(0.1, 0.6, count),
        np.linspace(-3.0, 2.0, count),
        np.linspace(-1.0, 2.0, count),
    )


def test_the_angular_acceleration_is_that_of_the_equation_of_motion():
    """M phi'' + M'/2 phi'^2 + (1 + z''/g) V' = -B x'', from virtual work."""
    structure, forces = arch(WHOLE)
    state, m = swaying(structure, forces), structure.mechanism
    c, h = m.coefficients(state.phi), 1e-4
    slope = sum(
        w
        * (
            m.coefficients(state.phi + i * h).inertia
            - m.coefficients(state.phi - i * h).inertia
        )
        / h
        for i, w in enumerate((4 / 5, -1 / 5, 4 / 105, -1 / 280), 1)
    )
    wanted = (
        -(c.push * state.across + c.lift * (G + state.up) + 0.5 * slope * state.rate**2)
        / c.inertia
    )
    assert state.acceleration == pytest.approx(wanted, rel=1e-9)


def test_the_springings_give_the_links_their_momentum():
    """H_A - H_D and the weight, against second differences of the mass centres on the
    way of that instant.
    """
    structure, forces = arch(WHOLE)
    state, (points, links) = swaying(structure, forces), links_of(structure.mechanism)
    masses = np.array([mass for mass, *_ in links])
    hinges, acceleration = forces.during(state).hinges, state.acceleration
    h = 2e-3

    def first_moments(t):
        phi = state.phi + state.rate * t + 0.5 * acceleration * t * t
        return np.array([masses @ carried(points, links, x)[:, :2] for x in phi])

    weights = {0: -205 / 72, 1: 8 / 5, 2: -1 / 5, 3: 8 / 315, 4: -1 / 560}
    change = (
        sum(
            w * first_moments(s * i * h)
            for i, w in weights.items()
            for s in ((1, -1) if i else (1,))
        )
        / h**2
    )
    wanted = change + masses.sum() * np.stack([state.across, G + state.up], axis=-1)
    assert hinges[:, 0] - hinges[:, 3] == pytest.approx(wanted, rel=1e-7)


def test_joints_on_the_ground_carry_what_stands_on_them():
    """Between a springing and the next hinge nothing moves: the thrust differs by the
    weight between two sections.
    """
    structure, forces = arch(WHOLE)
    state, m = swaying(structure, forces, 1), structure.mechanism
    low, high = m.angles[0], m.angles[3]
    if low == 0.0 and high == m.ring.angle:
        pytest.fail("an arch with a part that stays on the ground is needed")
    joints = np.array([0.0, low]) if low > 0.0 else np.array([high, m.ring.angle])
    found = resultants(forces, state, joints)
    part = m.ring.sector(*joints)
    squares = (found.thrust**2 + found.shear**2)[0]
    hinge = forces.during(state).hinges[0, 0 if low > 0.0 else 3]
    sign = 1.0 if low > 0.0 else -1.0
    pushed = hinge + sign * part.mass * np.array([state.across[0], G + state.up[0]])
    assert sorted(squares) == pytest.approx(
        sorted([hinge @ hinge, pushed @ pushed]), rel=1e-12
    )
