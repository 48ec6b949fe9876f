"""Structures whose cells are marched together have the bits that each has alone."""

import numpy as np
import pytest
from support.soak import quick

from rocking_cli import Method, load_structures, response, sine
from rocking_cli.dynamics.shared_march import SharedMarch

BODIES = (
    "rigid:left=0.42,right=0.31,height=1.15,gyration=0.68",
    "block:0.5x2",
    "rigid:left=0.3,right=0.37,height=1.6,gyration=0.9",
    "block:0.4x1",
)


@pytest.mark.parametrize("peaks", quick((True, False), False))
def test_a_body_has_the_same_bits_alone_and_with_others(peaks):
    """Blocks share a march, and so do bodies with two different edges; amplitudes up to
    3 include lost contact.
    """
    structures = [load_structures(body)[0] for body in BODIES]
    method = Method("nonlinear")
    march = SharedMarch(sine(2), structures, [method] * len(structures))
    assert march.group.tolist() == [0, 1, 0, 1]
    random = np.random.default_rng(4)
    which = random.integers(0, len(BODIES), 800)
    amplitude, omega = random.uniform(1.0, 3.0, 800), random.uniform(0.7, 9.0, 800)
    theta_ratio, outcome, impacts = march.response(which, amplitude, omega, peaks)
    for i, structure in enumerate(structures):
        own = which == i
        system = method.system_of(structure)
        alone = response(
            system, sine(2), amplitude[own], omega[own], structure.eta, peaks=peaks
        )
        np.testing.assert_array_equal(outcome[own], alone.outcome)
        if peaks:  # else sequences may be closed in one step, which are not counted
            np.testing.assert_array_equal(impacts[own], alone.impacts_at_least)
        np.testing.assert_array_equal(theta_ratio[own], alone.theta_ratio)
        assert np.unique(alone.outcome).size > 3
