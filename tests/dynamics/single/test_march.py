"""One body at a time on floats: what a step may not miss, and scans of amplitudes; its answers stand in samples/test_records.py."""

from __future__ import annotations

from itertools import cycle

import numpy as np
import pytest
from support.bodies import ALPHA, SYSTEMS, drawn
from support.synthetic_records import RECORDS, noise, shaken

from rocking_cli import Method, Outcome, RigidBodyEquation, System, cosine, response, sine
from rocking_cli.dynamics.outcome import safe
from rocking_cli.dynamics.single.one_by_one import response_alone
from rocking_cli.dynamics.single.scan import Scan, follow
from rocking_cli.dynamics.single.series_roots import first_root, turns


def test_a_body_that_bounces_for_ever_fails_as_on_arrays():
    system, motion = System(RigidBodyEquation(ALPHA)), shaken(RECORDS[0][30:60], 0.05)
    for a in (1.05, 1.5):
        assert response_alone(system, motion, a, 0.5, 1.0).outcome == response(system, motion, np.array(a), np.array(0.5), 1.0).outcome


def test_the_first_of_two_roots_is_found():
    """y = (t - 0.3)(t - 0.5): both ends are above the ground."""
    assert first_root((0.15, -0.8, 1.0), 1.0, 4.0, 0.0) == pytest.approx(0.3, rel=1e-14)
    assert first_root((0.1500001 + 0.01, -0.8, 1.0), 1.0, 4.0, 0.0) is None


def test_a_pair_of_turns_within_a_step():
    """y' = (x - 0.4)(x - 0.6)/2 + small: up, down and up again; and none where it only slows."""
    assert turns((1.0, 0.12, -0.25, 1.0 / 6.0), 1.0) == pytest.approx([0.4], rel=1e-12)
    assert turns((1.0, 0.13, -0.25, 1.0 / 6.0), 1.0) == []


NAMES = [name for name in SYSTEMS if name != "an arch"]
SCANNED = {"a step a sample": shaken(noise(100, 0.06, 4), 0.06), "five samples a step": shaken(noise(600, 0.01, 9), 0.01)}


@pytest.mark.parametrize(("name", "motion"), list(zip(NAMES, cycle(SCANNED), strict=False)))
def test_a_scan_falls_as_the_march_but_next_to_boundaries(name, motion):
    (system, eta), motion = SYSTEMS[name], SCANNED[motion]
    amplitude = np.geomspace(1.01, 4.0, 150) * system.least_uplift(motion)
    near = response(system, motion, np.outer([1.0 - 2e-4, 1.0, 1.0 + 2e-4], amplitude), 0.4, eta, peaks=False)
    falls = ~safe(near.outcome)
    settled = falls.all(axis=0) | ~falls.any(axis=0)
    found = ~safe(Scan(system, motion, 0.4, eta).outcomes(amplitude))
    assert 3 < falls[1].sum() < 50
    assert np.mean((found != falls[1])[settled]) < 0.015


@pytest.mark.parametrize("name", ["a body on one side", "a damped body of unlike edges", "the oscillator", "the damped oscillator"])
def test_a_scan_ends_where_a_sample_just_reaches_the_uplift(name):
    system, eta = SYSTEMS[name]
    motion = SCANNED["a step a sample"]
    for fine in (False, True):
        scan = Scan(system, motion, 0.4, eta, fine=fine)
        amplitude = np.unique([x for edge in scan.edges for x in 1.0 / (edge.drive * scan.lines.s[scan.lines.s != 0.0]) if 0.0 < x < 20.0])
        assert amplitude.size > 20
        assert np.all(scan.outcomes(amplitude) != Outcome.FAILED)


@pytest.mark.parametrize("name", ["a body", "the oscillator", "a damped body of unlike edges", "a body on one side"])
def test_a_close_scan_has_the_outcomes_of_the_march(name):
    system, eta = SYSTEMS[name]
    motion = SCANNED["a step a sample"]
    amplitude = np.geomspace(1.01, 4.0, 400) * system.least_uplift(motion)
    expected = response(system, motion, amplitude, 0.4, eta, peaks=False).outcome
    expected[expected == Outcome.NO_UPLIFT] = Outcome.ROCKED
    assert np.unique(expected).size >= 2
    assert np.mean(Scan(system, motion, 0.4, eta, fine=True).outcomes(amplitude) != expected) < 0.005


def test_no_fall_depends_on_the_bodies_and_the_motions_that_are_scanned_with_it():
    cases = [(SYSTEMS[name][0], SCANNED[motion], 0.4, SYSTEMS[name][1]) for name, motion in zip(NAMES, cycle(SCANNED), strict=False)]
    cases += [(System(RigidBodyEquation(alpha), scale=alpha), SCANNED["a step a sample"], 0.4, 0.9) for alpha in (0.1, 0.3)]
    together = [Scan(*case) for case in cases]
    amplitudes = [np.geomspace(1.01, 4.0, 12 + i) * case[0].least_uplift(case[1]) for i, case in enumerate(cases)]
    follow(together, amplitudes)
    for scan, case, amplitude in zip(together, cases, amplitudes, strict=True):
        assert scan.known[1].tolist() == Scan(*case).outcomes(amplitude).tolist()


@pytest.mark.parametrize("motion", [shaken(noise(80, 0.06, 3), 0.06), sine(2), cosine()], ids=["record", "sine", "cosine"])
@pytest.mark.parametrize("kind", ["plain", "unequal", "one-sided"])
def test_a_body_loses_contact_where_it_does_on_arrays(kind, motion):
    random, seen = np.random.default_rng(4), set()
    for model in ("linear", "nonlinear"):
        body, _, _ = drawn(kind, random, (0.4, 1.2), (0.4, 0.9), 0.3)
        system = Method(model, 1e-10).system_of(body)
        cells = system.least_uplift(motion) * np.geomspace(1.1, 7.0, 8), 0.5 if motion.samples else 2.0, body.eta
        together, alone = (respond(system, motion, *cells, peaks=False).outcome for respond in (response, response_alone))
        np.testing.assert_array_equal(alone, together)
        seen.update(alone.tolist())
    assert {Outcome.ROCKED, Outcome.LOST_CONTACT} <= seen
