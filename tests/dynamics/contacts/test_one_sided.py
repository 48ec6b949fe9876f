"""The contact of a body that is free on one side."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rocking_cli import LinearEquation, sine
from rocking_cli.dynamics.contacts.contact import OneSided

CONTACT = OneSided()


def cells(amplitude=2.0, eta=-0.6):
    return CONTACT.cells(LinearEquation(), np.array([amplitude]), np.array([3.0]), np.array([eta]))


def test_only_a_ground_acceleration_towards_the_backing_lifts_it():
    """Under a sine the second half cycle does: phase pi + arcsin(1/A), to the right."""
    found = CONTACT.uplift(cells(), sine().segments, np.array([0]), np.array([0]), np.zeros(1))
    phase = float(sine().segments.start[found.k[0]] + found.u[0])
    assert found.side[0] == 1.0
    assert phase == pytest.approx(math.pi + math.asin(0.5), rel=1e-14, abs=0)
    half = sine(0.5)
    assert CONTACT.strongest(cells(), half.segments)[0] == 0.0
    assert CONTACT.uplift(cells(), half.segments, np.array([0]), np.array([0]), np.zeros(1)).k[0] == len(half.segments)


def test_an_impact_returns_it_to_its_side(lanes):
    body = lanes(1.0, eta=0.6)
    CONTACT.strike(cells(), body, np.array([-0.5]), np.array([-1.75]))
    assert (body.side[0], body.v[0], body.b[0]) == (1.0, 0.3, -1.75)


def test_sequence_time_is_the_sum_of_its_arcs(lanes):
    body = lanes(1.0, v=1e-3, b=-1.4, eta=0.6)
    total, speed = 0.0, 1e-3
    for _ in range(200):
        total, speed = total + 2.0 * speed / 1.4, 0.6 * speed
    assert CONTACT.sequence_time(body)[0] == pytest.approx(total, rel=1e-13, abs=0)


@pytest.mark.parametrize("eta", [0.1, -1.0, -1.2, np.nan])
def test_restitutions_out_of_range_are_refused(eta):
    with pytest.raises(ValueError, match=r"within \(-1, 0\]"):
        cells(eta=eta)
