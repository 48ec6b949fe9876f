"""Envelopes and fragility of tied bodies: what a search and a set of motions say
against another integration.
"""

import math

import numpy as np
import pytest
from oracles.tied_body import Device, wall
from support.bodies import shaking
from support.documents import built

from rocking_cli import Method, sine, trace_envelope
from rocking_cli.dynamics.outcome import overturned
from rocking_cli.fragility.exposure import MotionSet, exposures
from rocking_cli.fragility.measures import MotionMember, pulse_intensity
from rocking_cli.motions.intensity_measures import MEASURES

WALL = built(
    "kind: wall\nthickness: 0.6 m\nheight: 6 m\none_sided: true\nmass: 7200 kg\nties:"
    " [{height: 5.5 m, stiffness: 2e6 N/m, prestress: 5 kN, yield: 20 kN, ultimate: 30"
    " mm}]\n"
)
OUTWARDS, METHOD = sine().scaled(-1.0), Method("nonlinear")


def integrated(a_g, omega_g):
    """(largest theta/alpha, True if it overturns) under one cycle of a sine that first
    drives the wall outwards.
    """
    motion = OUTWARDS.still_until(2.0 * math.pi + 20.0 * omega_g / WALL.p)
    return wall([Device(1, 2e6, 5e3, 20e3, 0.03, 5.5)], WALL.eta).run(
        shaking(motion, a_g, omega_g)
    )


@pytest.mark.slow
def test_the_edges_of_an_envelope_separate_what_stands_from_what_falls():
    first, *_ = trace_envelope(
        WALL, OUTWARDS, [4.0], a_max=7.5, method=METHOD, sign="+"
    )
    for share, falls in ((0.999, False), (1.001, True)):
        a_g = WALL.ground_acceleration(first.a_from * share)
        assert integrated(a_g, 4.0 * WALL.p)[1] == falls


def test_a_set_of_pulses_falls_where_the_oracle_does():
    members = [
        MotionMember(
            f"{w} rad/s", 2.0, w, pulse_intensity(OUTWARDS, 2.0, w), pulse=OUTWARDS
        )
        for w in (5.0, 8.0)
    ]
    levels = np.array([3.5, 7.0, 12.0])
    (found,) = exposures([WALL], MotionSet(members, MEASURES["PGA"], levels, METHOD))
    for member, ratios, outcomes in zip(
        members, found.theta_ratio, found.outcome, strict=True
    ):
        for level, ratio, outcome in zip(levels, ratios, outcomes, strict=True):
            largest, falls = integrated(level, member.omega)
            assert overturned(outcome) == falls
            assert falls or ratio == pytest.approx(largest, abs=1e-7)
    assert 0 < overturned(found.outcome).sum() < found.outcome.size
