"""The static theorem over the forces of all joints, against the line of thrust of the arch as a whole."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from oracles.thrust_line import largest_tilt

from rocking_cli.structures.mechanics.fourbar import Ring
from rocking_cli.structures.mechanics.hinges import search_joints
from rocking_cli.structures.mechanics.statics import carried_through, static_uplift


@given(st.floats(60, 270), st.floats(0.06, 0.9), st.integers(3, 40))
def test_forces_of_the_joints_and_line_of_thrust_agree(angle, thickness, voussoirs):
    ring = Ring(10.0, 10.0 * thickness, math.radians(angle))
    found = static_uplift(ring, np.linspace(0.0, ring.angle, voussoirs + 1))
    expected = largest_tilt(1.0, thickness, ring.angle, voussoirs)
    assert (found is None) == (expected is None)
    assert found is None or found == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_an_arch_whose_joints_open_whole_carries_less_than_its_least_linkage():
    """Short and thick: the bound from below and the bound from above part."""
    ring = Ring(1.0, 0.95, math.radians(149.336))
    joints = np.linspace(0.0, ring.angle, 31)
    carried, found = static_uplift(ring, joints), search_joints(ring, joints)
    assert carried == pytest.approx(largest_tilt(1.0, 0.95, ring.angle, 30), abs=1e-9)
    assert found is None or found[1] >= carried - 1e-9


@given(st.floats(60, 270), st.floats(0.06, 0.9), st.integers(3, 40))
def test_a_thrust_through_the_hinges_that_stays_inside_is_the_largest_there_is(angle, thickness, voussoirs):
    ring = Ring(10.0, 10.0 * thickness, math.radians(angle))
    joints = np.linspace(0.0, ring.angle, voussoirs + 1)
    found = search_joints(ring, joints)
    assume(found is not None and carried_through(ring, joints, found[0]))
    assert found[1] == pytest.approx(largest_tilt(1.0, thickness, ring.angle, voussoirs), rel=1e-9, abs=1e-9)


def test_the_thrust_through_other_hinges_leaves_a_joint():
    """Oppenheim's arch: its own hinges carry, those one joint further on do not."""
    ring = Ring(10.0, 1.5, math.radians(157.5))
    joints = np.linspace(0.0, ring.angle, 8)
    own = joints[[0, 3, 5, 7]]
    assert carried_through(ring, joints, own)
    assert not carried_through(ring, joints, joints[[0, 2, 5, 7]])
    assert not carried_through(ring, joints, joints[[1, 3, 5, 7]])
