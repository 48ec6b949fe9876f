"""Where an arch hinges: the search against its line of thrust and published values."""

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from oracles.thrust_line import largest_tilt
from scipy.optimize import brentq
from support.documents import built

from rocking_cli import DocumentError
from rocking_cli.structures.mechanics.fourbar import FourBar, Ring
from rocking_cli.structures.mechanics.hinges import (
    carried_through,
    search_continuous,
    search_joints,
    static_uplift,
)

RING = Ring(10.0, 1.5, math.radians(157.5))


def test_continuous_minimum_leaves_the_springing_as_the_static_theorem_proves():
    """The governing hinge A is 1.5 deg above the springing: lambda is 0.353384, below
    the 0.353498 of A on the springing.
    """
    found, uplift = search_continuous(RING)
    assert np.degrees(found) == pytest.approx(
        [1.513526, 59.287414, 117.061302, 157.5], abs=1e-6
    )
    assert uplift == pytest.approx(0.3533838581583, abs=1e-12)
    fine = largest_tilt(1.0, 0.15, RING.angle, 630)
    assert uplift < fine < uplift + 2e-6 < 0.353498


@pytest.mark.parametrize(
    ("beta", "thickness", "count"),
    [
        (157.5, 0.15, 7),
        (157.5, 0.15, 100),
        (180, 0.13, 25),
        (120, 0.1, 30),
        (200, 0.25, 24),
    ],
)
def test_search_equals_the_static_theorem(beta, thickness, count):
    ring = Ring(1.0, thickness, math.radians(beta))
    _, uplift = search_joints(ring, np.linspace(0, ring.angle, count + 1))
    assert uplift == pytest.approx(
        largest_tilt(1.0, thickness, ring.angle, count), abs=1e-12
    )


def test_semicircle_of_least_thickness():
    """lambda reaches 0 at t/r = 0.1075, the thinnest semicircle that carries its own
    weight.

    Milankovitch (1907) for radial joints, as quoted by Makris and Alexakis, Arch. Appl.
    Mech. 83 (2013) 1511-1533.
    """
    limit = brentq(
        lambda t: search_continuous(Ring(1.0, t, math.pi))[1], 0.105, 0.12, xtol=1e-9
    )
    assert limit == pytest.approx(0.1075, abs=5e-5)
    assert largest_tilt(1.0, limit - 2e-5, math.pi, 900) is None
    assert largest_tilt(1.0, limit + 2e-5, math.pi, 900) > 0.0
    with pytest.raises(DocumentError, match="cannot carry its own weight"):
        built("kind: arch\nradius: 1\nthickness: 0.107\nangle: 180 deg")
    assert built("kind: arch\nradius: 1\nthickness: 0.108\nangle: 180 deg").uplift > 0


@settings(max_examples=6)
@given(st.floats(130, 200), st.floats(0.13, 0.3), st.integers(0, 2**32 - 1))
def test_minimum_is_not_above_any_admissible_mechanism(beta, thickness, seed):
    ring = Ring(1.0, thickness, math.radians(beta))
    found = search_continuous(ring)
    assume(found is not None)  # short thick arches: the hinges run together
    random, tried = np.random.default_rng(seed), 0
    for _ in range(300):
        at = FourBar(
            ring, tuple(ring.angle * np.sort(random.uniform(size=4)))
        ).at_rest()
        if at.admissible and at.push > 0:
            assert found[1] <= at.lift / at.push + 1e-12
            tried += 1
    assert tried > 5


@settings(max_examples=50)
@given(st.floats(60, 270), st.floats(0.06, 0.9), st.integers(3, 40))
@example(149.336, 0.95, 30)  # whose joints open over their whole depth
def test_forces_of_the_joints_and_line_of_thrust_agree(angle, thickness, voussoirs):
    ring = Ring(10.0, 10.0 * thickness, math.radians(angle))
    found = static_uplift(ring, np.linspace(0.0, ring.angle, voussoirs + 1))
    expected = largest_tilt(1.0, thickness, ring.angle, voussoirs)
    assert (found is None) == (expected is None)
    assert found is None or found == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.slow
@settings(max_examples=10)
@given(st.floats(60, 270), st.floats(0.06, 0.9), st.integers(3, 40))
def test_a_thrust_through_the_hinges_that_stays_inside_is_the_largest_there_is(
    angle, thickness, voussoirs
):
    ring = Ring(10.0, 10.0 * thickness, math.radians(angle))
    joints = np.linspace(0.0, ring.angle, voussoirs + 1)
    found = search_joints(ring, joints)
    assume(found is not None and carried_through(ring, joints, found[0]))
    assert found[1] == pytest.approx(
        largest_tilt(1.0, thickness, ring.angle, voussoirs), rel=1e-9, abs=1e-9
    )


def test_the_thrust_through_other_hinges_leaves_a_joint():
    """Oppenheim's arch: its own hinges carry, those one joint further on do not."""
    joints = np.linspace(0.0, RING.angle, 8)
    for hinges, carries in (
        ([0, 3, 5, 7], True),
        ([0, 2, 5, 7], False),
        ([1, 3, 5, 7], False),
    ):
        assert carried_through(RING, joints, joints[hinges]) == carries


def test_an_arch_whose_joints_open_whole_carries_less_than_its_least_linkage():
    ring = Ring(1.0, 0.95, math.radians(149.336))
    joints = np.linspace(0.0, ring.angle, 31)
    assert search_joints(ring, joints)[1] > static_uplift(ring, joints) + 1e-3
