"""Approximate scans of amplitudes: where they fall, as the march does, and what they do
not depend on.
"""

from itertools import cycle

import numpy as np
import pytest
from support.bodies import SYSTEMS
from support.documents import built
from support.synthetic_records import motion_of_samples, noise

from rocking_cli import Method, Outcome, RigidBodyEquation, System, response
from rocking_cli.dynamics.contacts.contact import Symmetric
from rocking_cli.dynamics.outcome import safe
from rocking_cli.envelopes.scan import Scan, follow
from rocking_cli.motions.biaxial import with_vertical

NAMES = [name for name in SYSTEMS if name != "an arch"]
SCANNED = {
    "a step a sample": motion_of_samples(noise(100, 0.06, 4), 0.06),
    "five samples a step": motion_of_samples(noise(600, 0.01, 9), 0.01),
    "a vertical one": with_vertical(
        motion_of_samples(noise(120, 0.05, 4), 0.05),
        motion_of_samples(noise(150, 0.04, 5), 0.04),
        -0.7,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "motion"),
    [
        pytest.param(name, motion, marks=[pytest.mark.soak] * (i != 8))
        for i, (name, motion) in enumerate(zip(NAMES, cycle(SCANNED), strict=False))
    ],
)
def test_a_scan_falls_as_the_march_but_next_to_boundaries(name, motion):
    (system, _), motion = SYSTEMS[name], SCANNED[motion]
    amplitude = np.geomspace(1.01, 4.0, 24) * system.least_uplift(motion)
    near = response(
        system,
        motion,
        np.outer([1.0 - 2e-4, 1.0, 1.0 + 2e-4], amplitude),
        0.4,
        peaks=False,
    )
    falls = ~safe(near.outcome)
    settled = falls.all(axis=0) | ~falls.any(axis=0)
    found = ~safe(Scan(system, motion, 0.4).outcomes(amplitude))
    assert 1 < falls[1].sum() < 12
    assert np.count_nonzero((found != falls[1])[settled]) <= 1


def test_what_may_lose_contact_is_left_to_the_march():
    """A stocky body, of which the march finds that half of the cells lose contact."""
    body = built("kind: block\nwidth: 2\nheight: 2.2\nrestitution: 0.7")
    system, omega = Method("nonlinear").system_of(body), 1.0 / body.p
    motion = motion_of_samples(noise(120, 0.05, 1), 0.05)
    amplitude = system.least_uplift(motion) * np.geomspace(1.0, 6.0, 30)
    falls, doubtful = Scan(system, motion, omega).falls(amplitude)
    found = response(system, motion, amplitude, omega, peaks=False).outcome
    lost = found == Outcome.LOST_CONTACT
    assert np.all((falls | doubtful)[lost])
    assert lost.sum() >= 5
    assert np.sum(safe(found) & ~falls & ~doubtful) >= 5


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "a damped body of unlike edges",
        "the oscillator",
        pytest.param("a body on one side", marks=pytest.mark.soak),
        pytest.param("the damped oscillator", marks=pytest.mark.soak),
    ],
)
def test_a_scan_ends_where_a_sample_just_reaches_the_uplift(name):
    system, _ = SYSTEMS[name]
    motion = SCANNED["a step a sample"]
    scan = Scan(system, motion, 0.4)
    amplitude = np.unique(
        [
            x
            for edge in scan.edges
            for x in 1.0 / (edge.drive * scan.lines.s[scan.lines.s != 0.0])
            if 0.0 < x < 20.0
        ]
    )
    assert amplitude.size > 20
    assert np.all(scan.outcomes(amplitude) != Outcome.FAILED)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "the oscillator",
        pytest.param("a damped body of unlike edges", marks=pytest.mark.soak),
        pytest.param("a body", marks=pytest.mark.soak),
        pytest.param("a body on one side", marks=pytest.mark.soak),
    ],
)
def test_a_close_scan_has_the_outcomes_of_the_march(name):
    system, _ = SYSTEMS[name]
    motion = SCANNED["a step a sample"]
    amplitude = np.geomspace(1.01, 4.0, 80) * system.least_uplift(motion)
    expected = response(system, motion, amplitude, 0.4, peaks=False).outcome
    expected[expected == Outcome.NO_UPLIFT] = Outcome.ROCKED
    assert np.unique(expected).size >= 2
    found = Scan(system, motion, 0.4).outcomes(amplitude)
    assert np.count_nonzero(found != expected) <= 1


@pytest.mark.soak
def test_no_fall_depends_on_the_bodies_and_the_motions_that_are_scanned_with_it():
    cases = [
        (SYSTEMS[name][0], SCANNED[motion], 0.4)
        for name, motion in zip(NAMES[::2], cycle(SCANNED), strict=False)
    ]
    cases += [
        (
            System(RigidBodyEquation(alpha), Symmetric(0.9), alpha),
            SCANNED["a step a sample"],
            0.4,
        )
        for alpha in (0.1, 0.3)
    ]
    together = [Scan(*case) for case in cases]
    amplitudes = [
        np.geomspace(1.01, 4.0, 6 + i) * case[0].least_uplift(case[1])
        for i, case in enumerate(cases)
    ]
    follow(together, amplitudes)
    for scan, case, amplitude in zip(together, cases, amplitudes, strict=True):
        assert scan.known.outcome.tolist() == Scan(*case).outcomes(amplitude).tolist()
