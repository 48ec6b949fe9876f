"""Forces in an arch that sways: against Eq. 3.4, the static theorem, and the momentum
of the links.
"""

import numpy as np
import pytest
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


def test_the_part_from_a_hinge_to_the_next_brings_the_force_there():
    """Newton and Euler of parts of a link against the equations of all links: they
    agree for the phi'' of Eq. 3.4 alone.
    """
    structure, forces = arch(WHOLE)
    state = swaying(structure, forces)
    ends = np.array(forces.linkage.angles[1:]) - 1e-10
    found = resultants(forces, state, ends)
    hinges = np.hypot(*forces.during(state).hinges.T).T[:, 1:]
    assert np.hypot(found.thrust, found.shear) == pytest.approx(hinges, rel=1e-8)
    assert found.eccentricity == pytest.approx(np.ones(hinges.shape), abs=1e-8)

    late = state._replace(acceleration=1.01 * state.acceleration)
    other = resultants(forces, late, ends).eccentricity
    assert np.abs(other - 1.0).max(axis=1).min() > 1e-4


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
