"""One body at a time on floats: against the arrays, against integrations that share no code, and what a step may not miss."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracles.collocation import integrate
from oracles.record_lockstep import LINEAR, Rigid, lockstep
from support.bodies import drawn
from support.references import shape
from support.synthetic_records import RECORDS, allowance, assert_same, cells, noise, shaken

from rocking_cli import LinearEquation, Method, Outcome, RigidBodyEquation, System, cosine, load_structures, pulse, response, sine
from rocking_cli.dynamics.contacts.contact import OneSided, Unequal
from rocking_cli.dynamics.outcome import safe
from rocking_cli.dynamics.single.response import response_alone
from rocking_cli.dynamics.single.scan import Scan, follow
from rocking_cli.dynamics.single.series_roots import first_root, only_root, turns
from rocking_cli.motions.biaxial import with_vertical

ALPHA, LEFT = 0.25, 0.2
TURNS = tuple(math.sin(alpha) / alpha for alpha in (ALPHA, LEFT))
UNEQUAL = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=TURNS)
SIDES = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=(1.0, 1.0))
SYSTEMS = {
    "the oscillator": (System(LinearEquation(), scale=ALPHA), 0.9),
    "a body": (System(RigidBodyEquation(ALPHA), scale=ALPHA), 0.9),
    "a damped body of unlike edges": (System(RigidBodyEquation((ALPHA, LEFT), damping=0.05), UNEQUAL, ALPHA), 0.9),
    "a body on one side": (System(RigidBodyEquation(0.5), OneSided(), 0.5), -0.5),
    "the damped oscillator": (System(LinearEquation(0.05), scale=ALPHA), 0.9),
    "the oscillator of unlike edges": (System(LinearEquation(), SIDES, ALPHA), 0.9),
    "the damped oscillator on one side": (System(LinearEquation(0.02), OneSided(), ALPHA), -0.6),
}


def against_the_arrays(system, eta, motion, count, seed):
    """Outcomes equal, rotations within 1e-9 of the condition of each cell."""
    amplitude, omega = cells(count, seed)
    etas = np.full(count, eta)
    expected = response(system, motion, amplitude, omega, etas)
    found = response_alone(system, motion, amplitude, omega, etas)
    allowed = 1e3 * allowance(motion, amplitude, omega, np.abs(etas), lambda m, a, o, e: response(system, m, a, o, np.copysign(e, eta)))
    assert_same(found, expected.theta_ratio, expected.outcome, allowed)
    return set(found.outcome)


def upwards(record, share):
    one, other = shaken(RECORDS[record], 0.04), shaken(noise(120, 0.04, 8)[: RECORDS[record].size], 0.04)
    return with_vertical(one, other, share * one.acceleration / other.acceleration)


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_same_as_on_arrays(name):
    assert against_the_arrays(*SYSTEMS[name], shaken(RECORDS[0][30:70], 0.05), 8, 5) > {Outcome.ROCKED}


@pytest.mark.parametrize("name", ["a body", "a damped body of unlike edges", "the oscillator"])
def test_the_same_on_ground_that_moves_upwards_too(name):
    against_the_arrays(*SYSTEMS[name], upwards(2, 0.5), 6, 6)
    against_the_arrays(*SYSTEMS[name], with_vertical(sine(), cosine(), 0.4), 6, 7)


@pytest.mark.parametrize("motion", [sine(), cosine(1.5), pulse("rectangular-impulse"), pulse("ricker-symmetric")], ids=lambda m: m.name)
def test_the_same_under_a_pulse(motion):
    for name in ("the oscillator", "a damped body of unlike edges", "a body on one side"):
        against_the_arrays(*SYSTEMS[name], motion, 8, 8)


def test_an_arch():
    (arch,) = load_structures("configs/arch.yaml")
    system = Method("nonlinear").system_of(arch)
    against_the_arrays(system, 0.9, shaken(RECORDS[0][30:60], 0.05), 5, 6)
    against_the_arrays(system, 0.9, sine(), 5, 6)


def test_a_body_that_bounces_for_ever_fails_as_on_arrays():
    system, motion = System(RigidBodyEquation(ALPHA)), shaken(RECORDS[0][30:60], 0.05)
    for a in (1.05, 1.5):
        assert response_alone(system, motion, a, 0.5, 1.0).outcome == response(system, motion, np.array(a), np.array(0.5), 1.0).outcome


def against_lockstep(record, count, eta, nonlinear, part=slice(None)):
    motion = shaken(RECORDS[record][part], 0.04)
    amplitude, omega = cells(count, 30 + record)
    system = System(RigidBodyEquation(ALPHA)) if nonlinear else System(LinearEquation())
    lifts, body = (ALPHA / math.tan(ALPHA), Rigid(ALPHA)) if nonlinear else (1.0, LINEAR)
    etas = np.full(count, eta)
    found = response_alone(system, motion, amplitude, omega, etas)
    outcome, theta = lockstep(*reversed(motion.samples), amplitude * lifts, omega, etas, body)
    allowed = (1e3 if nonlinear else 10.0) * allowance(motion, amplitude, omega, etas, lambda *cell: response(system, *cell))
    assert_same(found, theta, outcome, allowed)
    assert np.unique(outcome).size >= 2


@pytest.mark.parametrize("nonlinear", [False, True])
def test_against_an_integration_that_shares_no_code(nonlinear):
    against_lockstep(2, 12, 0.7, nonlinear, slice(35, 80))


@pytest.mark.parametrize("words", ["unequal damped nonlinear", "one-sided nonlinear", "unequal linear", "one-sided damped linear"])
def test_other_bodies_against_collocation_that_shares_no_code(words):
    random, method, motion, outcomes = np.random.default_rng(3), Method(words.split()[-1]), shaken(RECORDS[0][35:60], 0.05), set()
    for amplitude in (1.1, 1.7, 2.6, 6.0):
        structure, body, _ = drawn(words, random, (0.08, 0.4), (0.3, 0.98), 0.4, (0.01, 0.05, 0.2))
        found = response_alone(method.system_of(structure), motion, amplitude, 1.0 / structure.p, structure.eta)
        cell = shape(motion), motion.duration, float(structure.ground_acceleration(amplitude)), 1.0
        answer = integrate(body, *cell, tuple(piece.stop for piece in motion.pieces))
        assert Outcome(int(found.outcome)).flag == answer.outcome
        assert float(found.theta_ratio) == pytest.approx(answer.rotation, rel=0, abs=5e-9, nan_ok=True)
        outcomes.add(answer.outcome)
    assert len(outcomes) > 1


@pytest.mark.soak
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("record", range(3))
def test_two_thousand_cells_against_an_integration_that_shares_no_code(record, nonlinear):
    against_lockstep(record, 2000, 0.9, nonlinear)


@pytest.mark.soak
@pytest.mark.parametrize("record", range(3))
@pytest.mark.parametrize("name", SYSTEMS)
def test_three_hundred_cells_of_each_system(name, record):
    against_the_arrays(*SYSTEMS[name], shaken(RECORDS[record], 0.04), 300, 20 + record)
    against_the_arrays(*SYSTEMS[name], upwards(record, 0.6), 60, 40 + record)


def test_the_first_of_two_roots_is_found():
    """y = (t - 0.3)(t - 0.5): both ends are above the ground."""
    assert first_root((0.15, -0.8, 1.0), 1.0, 4.0, 0.0) == pytest.approx(0.3, rel=1e-14)
    assert first_root((0.1500001 + 0.01, -0.8, 1.0), 1.0, 4.0, 0.0) is None


def test_the_only_root_is_not_the_start():
    """y = t (0.8 - t) after an impact."""
    assert only_root((0.0, 0.8, -1.0, 0.0), 1.0, 5.0, 0.0) == pytest.approx(0.8, rel=1e-14)


def test_a_pair_of_turns_within_a_step():
    """y' = (x - 0.4)(x - 0.6)/2 + small: up, down and up again; and none where it only slows."""
    assert turns((1.0, 0.12, -0.25, 1.0 / 6.0), 1.0) == pytest.approx([0.4], rel=1e-12)
    assert turns((1.0, 0.13, -0.25, 1.0 / 6.0), 1.0) == []


SCANNED = {"a step a sample": shaken(noise(100, 0.06, 4), 0.06), "five samples a step": shaken(noise(600, 0.01, 9), 0.01)}


@pytest.mark.parametrize("motion", SCANNED.values(), ids=SCANNED)
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_scan_falls_as_the_march_but_next_to_boundaries(name, motion):
    system, eta = SYSTEMS[name]
    amplitude = np.geomspace(1.01, 4.0, 150) * system.least_uplift(motion)
    near = response(system, motion, np.outer([1.0 - 2e-4, 1.0, 1.0 + 2e-4], amplitude), 0.4, eta, peaks=False)
    falls = ~safe(near.outcome)
    settled = falls.all(axis=0) | ~falls.any(axis=0)
    found = ~safe(Scan(system, motion, 0.4, eta).outcomes(amplitude))
    assert 3 < falls[1].sum() < 50
    assert np.mean((found != falls[1])[settled]) < 0.015


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_scan_ends_where_a_sample_just_reaches_the_uplift(name):
    system, eta = SYSTEMS[name]
    motion = SCANNED["a step a sample"]
    for close in (False, True):
        scan = Scan(system, motion, 0.4, eta, close=close)
        amplitude = np.unique([x for face in scan.faces for x in 1.0 / (face.drive * scan.lines.s[scan.lines.s != 0.0]) if 0.0 < x < 20.0])
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
    assert np.mean(Scan(system, motion, 0.4, eta, close=True).outcomes(amplitude) != expected) < 0.005


def test_no_fall_depends_on_the_bodies_and_the_motions_that_are_scanned_with_it():
    cases = [(system, motion, 0.4, eta) for motion in SCANNED.values() for system, eta in SYSTEMS.values()]
    cases += [(System(RigidBodyEquation(alpha), scale=alpha), SCANNED["a step a sample"], 0.4, 0.9) for alpha in (0.1, 0.3)]
    together = [Scan(*case) for case in cases]
    amplitudes = [np.geomspace(1.01, 4.0, 12 + i) * case[0].least_uplift(case[1]) for i, case in enumerate(cases)]
    follow(together, amplitudes)
    for scan, case, amplitude in zip(together, cases, amplitudes, strict=True):
        assert scan.known[1].tolist() == Scan(*case).outcomes(amplitude).tolist()
