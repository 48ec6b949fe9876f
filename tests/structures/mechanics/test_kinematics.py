"""Rigid bodies pass through the general mechanism with their closed forms."""

from __future__ import annotations

import math

import pytest
from support.documents import built
from support.edge_rocker import EdgeRocker

from rocking_cli.structures.kinds.prism import polygon_moments
from rocking_cli.structures.kinds.spire import Spire
from rocking_cli.structures.mechanics.kinematics import Moments, linearise

THIN = "kind: spire\nbase_radius: 1.5\nheight: 12\n"
CRACKED = THIN + "thickness: 0.15\ncrack: diagonal\n"


def same(parameters, mechanism, g=9.81):
    """A rigid body's closed forms and the general mechanism agree to 1e-10."""
    found = linearise(mechanism)
    assert math.sqrt(g * found.stiffness) == pytest.approx(parameters.p, rel=1e-10, abs=0)
    assert (found.alpha, found.uplift, found.eta) == pytest.approx((parameters.alpha, parameters.uplift, parameters.eta), rel=1e-10, abs=0)
    assert found.a_scale_3_7 == pytest.approx(1.0, rel=1e-10, abs=0)


def test_block_point_mass_and_spire_pass_through_the_mechanism():
    block = polygon_moments([(-0.25, 0), (0.25, 0), (0.25, 2), (-0.25, 2)])
    same(built("kind: block\nwidth: 0.5\nheight: 2"), EdgeRocker(block, 0.25))
    same(built("kind: point_mass\nwidth: 1.2\nheight: 4"), EdgeRocker(Moments(1.0, 0.0, 4.0, 16.0), 0.6))
    for text, spire in ((THIN, Spire(1.5, 12.0, 0.0, 12.0, 0.0)), (CRACKED, Spire(1.5, 12.0, 0.15, 10.8, 10.8))):
        same(built(text), EdgeRocker(spire.rocking(), 1.5, spire.rocking(both=True)))
