"""The relay against a walk from end to end: the same to the last bit, whatever the legs."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.record_lockstep import Rigid, lockstep
from support.stocky_bodies import KINDS, drawn
from support.synthetic_records import allowance, assert_same, noise, shaken

from rocking_cli import LinearEquation, Method, Outcome, RigidBodyEquation, System, safe
from rocking_cli.dynamics.contacts.one_sided import OneSided
from rocking_cli.dynamics.contacts.unequal import Unequal
from rocking_cli.dynamics.flight import relay
from rocking_cli.dynamics.flight.walk import Walk
from rocking_cli.dynamics.march.aftermath import follow_on

ALPHA, STEP = 0.25, 0.04
UNEQUAL = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=(1.0, 1.0))
SYSTEMS = {
    "bodies": (System(RigidBodyEquation(np.linspace(0.2, 0.3, 5))), 0.8),
    "a damped body of unlike edges": (System(RigidBodyEquation((ALPHA, 0.2), damping=0.05), UNEQUAL), 0.9),
    "the damped oscillator": (System(LinearEquation(0.05)), 0.9),
    "a body on one side": (System(RigidBodyEquation(0.5), OneSided()), -0.5),
}
BURSTS = np.concatenate([noise(70, STEP, seed, quiet=15) for seed in (4, 5)])


def walked(system, eta, relayed, peaks=True, apart=True, amplitude=None, samples=BURSTS):
    """A walk of five bodies, some of which fall, through two bursts."""
    motion = shaken(samples, STEP)
    amplitude = np.array([1.05, 1.5, 3.0, 6.0, 20.0]) if amplitude is None else amplitude
    walk = Walk(
        system, motion.segments, motion.samples, amplitude, np.full(amplitude.size, 0.35), np.full(amplitude.size, eta), peaks, None
    )
    walk.relays, walk.apart = relayed, apart
    walk.all()
    return walk


def the_same(one, other):
    for name in ("outcome", "impacts", "theta_ratio"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.fixture
def legs(monkeypatch):
    """Short legs in stretches of many, and what became of each stretch."""
    found = []
    hand_in = relay.Legs.hand_in

    def listen(self):
        found.append((self.count, self.outcome.size, self.taken_over))
        return hand_in(self)

    monkeypatch.setattr(relay.Legs, "hand_in", listen)
    monkeypatch.setattr(relay, "_FIRST", 60)
    monkeypatch.setattr(relay, "_SHORTEST", 15)
    return found


@pytest.mark.parametrize(
    ("name", "ahead"), [("bodies", 8), *(pytest.param(name, ahead, marks=pytest.mark.soak) for name in SYSTEMS for ahead in (0, 2))]
)
def test_no_digit_depends_on_the_legs(name, ahead, legs, monkeypatch):
    monkeypatch.setattr(relay, "_AHEAD", ahead)
    relayed = walked(*SYSTEMS[name], True)
    the_same(relayed, walked(*SYSTEMS[name], False))
    assert Outcome.ROCKED in relayed.outcome
    assert not np.all(safe(relayed.outcome))
    assert legs[0][0] == 4
    assert 0 < legs[0][2] < legs[0][1], "some legs are taken over, others stand"


@pytest.mark.parametrize(
    ("jolt", "push"), [(46, 0.9), (40, 0.0)], ids=["a last push overturns at once", "the largest rotation is an early one"]
)
def test_what_legs_that_are_over_came_to_is_kept(jolt, push, legs):
    """A jolt in the last leg of the first stretch, noise after it, and a slow push at the end."""
    first, second = (peak / np.abs(x).max() * x for peak, x in zip((0.35, 0.3), (BURSTS[:85], BURSTS[85:]), strict=True))
    first[jolt : jolt + 6] += (0.5, 0.9, 1.0, 0.2, -0.6, -0.3)
    samples = np.concatenate([first, second, push * np.sin(np.pi * np.arange(50) / 49), np.zeros(20)])
    system, amplitude = System(RigidBodyEquation(np.linspace(0.2, 0.3, 24))), np.geomspace(1.05, 12.0, 24)
    relayed, plain = (walked(system, 0.7, how, amplitude=amplitude, samples=samples) for how in (True, False))
    the_same(relayed, plain)
    assert {Outcome.ROCKED, Outcome.OVERTURNED_AFTER_IMPACT} <= set(plain.outcome)


def test_without_peaks_a_relay_is_any_walk(legs):
    system, eta = SYSTEMS["bodies"]
    relayed = walked(system, eta, True, peaks=False)
    the_same(relayed, walked(system, eta, False, peaks=False, apart=False))
    assert legs


@pytest.mark.soak
def test_a_small_pool_changes_nothing(legs, monkeypatch):
    system, eta = SYSTEMS["bodies"]
    first = walked(system, eta, True)
    monkeypatch.setattr("rocking_cli.dynamics.flight.walk._POOL", 5)
    the_same(walked(system, eta, True), first)


def test_bodies_that_hardly_rest_are_walked_alone_for_a_stretch(legs, monkeypatch):
    monkeypatch.setattr(relay, "_FIRST", 45)
    walked(System(RigidBodyEquation(ALPHA)), 0.97, True, amplitude=np.array([3.0]))
    assert [count for count, _, _ in legs] == [3, 1]


def asked(kind, model, relayed, count):
    """A walk of bodies whose forces are wanted, and these forces of those that stay upright; the shaking ends in a last push."""
    random = np.random.default_rng(1)
    bursts = [noise(70, STEP, seed, quiet=15) for seed in (4, 5, 6, 7)]
    motion = shaken(np.concatenate([*bursts, np.full(4, 0.8 * np.max(bursts))]), STEP)
    body, _, _ = drawn(kind, random, (0.1, 0.5), (0.4, 0.85), 0.3)
    system = Method(model).system_of(body)
    cells = random.uniform(0.8, 3.0, count), random.uniform(0.25, 0.9, count), np.full(count, body.eta)
    walk = Walk(system, motion.segments, motion.samples, *cells, True, None, system.body)
    walk.relays, walk.apart = relayed, True
    walk.all()
    follow_on(walk, system, motion.segments, cells)
    upright = safe(walk.outcome)
    return walk, walk.demands.friction[upright], walk.demands.fz_min[upright]


@pytest.mark.parametrize(
    ("kind", "model"),
    [
        ("damped", "nonlinear"),
        ("plain", "linear"),
        *(pytest.param(kind, model, marks=pytest.mark.soak) for kind in KINDS for model in ("linear", "nonlinear")),
    ],
)
def test_no_digit_of_the_forces_depends_on_the_legs(kind, model, legs):
    (relayed, *forces), (walked, *others) = (asked(kind, model, way, 8) for way in (True, False))
    the_same(relayed, walked)
    np.testing.assert_array_equal(forces, others)
    assert len(legs) > 1
    assert max(count for count, _, _ in legs) > 2
    assert len(forces[0]) > 4


def against_lockstep(count):
    """Peaks kept excursion by excursion: within 1e-9 of each cell's condition of an integration that shares no code."""
    motion = shaken(BURSTS, STEP)
    amplitude = np.linspace(1.05, 14.0, count)
    omega, eta = np.full(count, 0.35), np.full(count, 0.8)

    def respond(motion, amplitude, omega, eta):
        shape = np.broadcast_shapes(amplitude.shape, omega.shape, eta.shape)
        cells = (np.broadcast_to(x, shape).ravel() for x in (amplitude, omega, eta))
        walk = Walk(System(RigidBodyEquation(ALPHA)), motion.segments, motion.samples, *cells, True, None)
        walk.relays = walk.apart = True
        walk.all()
        walk.theta_ratio, walk.outcome = walk.theta_ratio.reshape(shape), walk.outcome.reshape(shape)
        return walk

    outcome, theta = lockstep(*reversed(motion.samples), amplitude * (ALPHA / np.tan(ALPHA)), omega, eta, Rigid(ALPHA))
    found = respond(motion, amplitude, omega, eta)
    assert_same(found, theta, outcome, 1e3 * allowance(motion, amplitude, omega, eta, respond))
    assert np.unique(outcome).size >= 2


@pytest.mark.soak
def test_forty_relayed_bodies_against_an_integration_that_shares_no_code(legs):
    against_lockstep(40)
    assert legs
