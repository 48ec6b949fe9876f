"""The contact of a body with two like edges."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli import LinearEquation, RigidBodyEquation, cosine, sine
from rocking_cli.dynamics.contacts.contact import Symmetric

CONTACT = Symmetric()


def cells(equation, amplitude, eta=0.8):
    amplitude = np.atleast_1d(np.asarray(amplitude, dtype=float))
    return CONTACT.cells(equation, amplitude, np.full(amplitude.size, 3.0), np.full(amplitude.size, eta))


def test_a_rigid_body_lifts_at_the_tangent_of_alpha():
    """A = a_g/(alpha g), and the body lifts at a_g = g tan(alpha) (Eq. 2.2)."""
    lift = np.tan(0.4) / 0.4
    strongest = CONTACT.strongest(cells(RigidBodyEquation(0.4), [0.999 * lift, 1.001 * lift]), sine().segments)
    assert strongest[0] < 1.0 < strongest[1]


@pytest.mark.parametrize("amplitude", [1.0 + 1e-12, 1.3, 40.0])
def test_uplift_under_a_sine_is_at_the_arcsine(amplitude):
    """Omega tau_1 = arcsin(1/A), against the ground's push."""
    found = CONTACT.uplift(cells(LinearEquation(), amplitude), sine().segments, np.array([0]), np.array([0]), np.zeros(1))
    assert (found.k[0], found.side[0], found.b[0]) == (0, -1.0, 0.0)
    assert found.u[0] == pytest.approx(np.arcsin(1.0 / amplitude), rel=1e-14, abs=0)


def test_a_jump_of_the_ground_lifts_at_once_and_with_force():
    found = CONTACT.uplift(cells(LinearEquation(), 1.7), cosine(1).segments, np.array([0]), np.array([0]), np.zeros(1))
    assert (found.k[0], found.u[0], found.side[0]) == (0, 0.0, -1.0)
    assert found.b[0] == pytest.approx(0.7, rel=1e-14, abs=0)


def test_an_impact_turns_the_side_the_drive_and_a_part_of_the_speed(lanes):
    body = lanes([1.0, -1.0])
    CONTACT.strike(cells(LinearEquation(), [2.0, 2.0]), body, np.array([-0.5, -1.5]), np.array([-0.25, -3.0]))
    assert body.side.tolist() == [-1.0, 1.0]
    assert body.v.tolist() == [0.8 * 0.5, 0.8 * 1.5]
    assert (body.b + 1.0).tolist() == [-0.75, 2.0]  # a = 0.75 and -2 before


def test_sequence_time_is_the_sum_of_its_arcs(lanes):
    body = lanes(1.0, v=1e-3, b=-0.7, eta=0.6)
    total, speed, a = 0.0, 1e-3, 0.3
    for _ in range(200):
        total, speed, a = total + 2.0 * speed / (1.0 - a), 0.6 * speed, -a
    assert CONTACT.sequence_time(body)[0] == pytest.approx(total, rel=1e-13, abs=0)


@pytest.mark.parametrize("eta", [-0.1, 1.1, np.nan])
def test_restitutions_out_of_range_are_refused(eta):
    with pytest.raises(ValueError, match=r"eta must be within \[0, 1\]"):
        cells(LinearEquation(), 2.0, eta)
