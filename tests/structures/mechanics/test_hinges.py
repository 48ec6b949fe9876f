"""Where an arch hinges: the search against its line of thrust and published values."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from oracles.thrust_line import largest_tilt
from scipy.optimize import brentq
from support.documents import built

from rocking_cli import DocumentError
from rocking_cli.structures.mechanics.hinges import search_continuous, search_joints
from rocking_cli.structures.mechanics.ring import Ring

RING = Ring(10.0, 1.5, math.radians(157.5))


def test_continuous_minimum_leaves_the_springing_as_the_static_theorem_proves():
    """The governing hinge A is 1.5 deg above the springing: lambda is 0.353384, below
    the 0.353498 of A on the springing.
    """
    uplift, hinges, four = search_continuous(RING)
    assert four
    assert np.degrees(hinges) == pytest.approx(
        [1.513526, 59.287414, 117.061302, 157.5], abs=1e-6
    )
    assert uplift == pytest.approx(0.3533838581583, abs=1e-12)
    fine = largest_tilt(1.0, 0.15, RING.angle, 630)
    assert uplift < fine < uplift + 2e-6 < 0.353498


def test_semicircle_of_least_thickness():
    """lambda reaches 0 at t/r = 0.1075, the thinnest semicircle that carries its own
    weight.

    Milankovitch (1907) for radial joints, as quoted by Makris and Alexakis, Arch. Appl.
    Mech. 83 (2013) 1511-1533.
    """

    def uplift(thickness):
        found = search_continuous(Ring(1.0, thickness, math.pi))
        return found.uplift if found else -1.0

    limit = brentq(uplift, 0.105, 0.12, xtol=1e-9)
    assert limit == pytest.approx(0.1075, abs=5e-5)
    assert largest_tilt(1.0, limit - 2e-5, math.pi, 900) is None
    assert largest_tilt(1.0, limit + 2e-5, math.pi, 900) > 0.0
    with pytest.raises(DocumentError, match="cannot carry its own weight"):
        built("kind: arch\nradius: 1\nthickness: 0.107\nangle: 180 deg")
    assert built("kind: arch\nradius: 1\nthickness: 0.108\nangle: 180 deg").uplift > 0


@settings(max_examples=50)
@given(st.floats(60, 270), st.floats(0.06, 0.9), st.integers(3, 40))
@example(157.5, 0.15, 100)
@example(149.336, 0.95, 30)  # whose joints open over their whole depth
def test_forces_of_the_joints_and_line_of_thrust_agree(angle, thickness, voussoirs):
    ring = Ring(10.0, 10.0 * thickness, math.radians(angle))
    found = search_joints(ring, np.linspace(0.0, ring.angle, voussoirs + 1))
    expected = largest_tilt(1.0, thickness, ring.angle, voussoirs)
    if expected is None:  # it does not stand, or carries every acceleration
        assert found is None or found.uplift == math.inf
    else:
        assert found.uplift == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_an_arch_whose_joints_open_whole_has_no_governing_linkage():
    ring = Ring(1.0, 0.95, math.radians(149.336))
    assert not search_joints(ring, np.linspace(0.0, ring.angle, 31)).four_hinges
    assert not search_continuous(ring).four_hinges
    # a short one carries any acceleration
    short = search_continuous(Ring(1.0, 0.5, math.radians(70.0)))
    assert (short.uplift, short.four_hinges) == (math.inf, False)
