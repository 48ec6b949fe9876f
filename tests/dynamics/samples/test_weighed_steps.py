"""Taylor steps over samples of ground that moves upwards too: against the march by long series, and an integration that shares no code."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
from oracles.collocation import Body, Edge
from oracles.vertical_motion import Shaking, swing
from support.synthetic_records import RECORDS, allowance, assert_same, cells, noise, shaken

from rocking_cli import LinearEquation, Method, Outcome, RigidBodyEquation, RockingParameters, System, load_structures, response
from rocking_cli.dynamics.contacts.contact import OneSided, Unequal
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.samples import taylor_steps
from rocking_cli.motions import Harmonic, Motion, Piece
from rocking_cli.motions.biaxial import with_vertical

ALPHA, LEFT = 0.25, 0.2
TURNS = tuple(math.sin(alpha) / alpha for alpha in (ALPHA, LEFT))
UNEQUAL = Unequal(drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=TURNS)
SYSTEMS = {
    "a body": (System(RigidBodyEquation(ALPHA), scale=ALPHA), 0.9),
    "a stocky body on one side": (System(RigidBodyEquation(0.5), OneSided(), 0.5), -0.5),
    "a damped body of unlike edges": (System(RigidBodyEquation((ALPHA, LEFT), damping=0.05), UNEQUAL, ALPHA), 0.9),
    "the oscillator": (System(LinearEquation(), scale=ALPHA), 0.9),
    "the damped oscillator": (System(LinearEquation(0.05), scale=0.4), 0.9),
}
UPWARDS = noise(120, 0.04, 8)


def upwards(part, dt, share, across):
    """A record and another one upwards, of `share` times its peak; and both with a sinusoid of no height, which the march takes by its
    long series."""
    one, other = shaken(RECORDS[across][part], dt), shaken(UPWARDS[part], dt)
    pieces = [Motion(m.name, tuple(Piece(p.start, p.stop, (Harmonic(0.0),), p.constant, p.slope) for p in m.pieces)) for m in (one, other)]
    return with_vertical(one, other, share * one.acceleration / other.acceleration), with_vertical(*pieces, share)


def against_the_march(system, eta, part, share, across, count, seed):
    """Outcomes and impacts equal, rotations within 1e-9 of the condition of each cell."""
    motion, long = upwards(part, 0.04, share, across)
    amplitude, omega = cells(count, seed)
    omega[:2] /= 40.0  # samples too far apart to be stepped over
    etas = np.full(count, eta)
    found = response(system, motion, amplitude, omega, etas)
    run = Run(Batch.of(system, system.segments(long), amplitude, omega, etas))
    run.all()
    np.testing.assert_array_equal(found.impacts, run.impacts)
    allowed = 1e3 * allowance(motion, amplitude, omega, np.abs(etas), lambda m, a, o, e: response(system, m, a, o, np.copysign(e, eta)))
    assert_same(found, run.theta_ratio, run.outcome, allowed)
    return set(found.outcome)


def test_the_same_as_the_march_by_long_series():
    assert against_the_march(*SYSTEMS["a damped body of unlike edges"], slice(36, 56), 0.5, 2, 6, 5) > {Outcome.ROCKED}


@pytest.mark.soak
@pytest.mark.parametrize(("share", "across"), [(0.3, 0), (-1.2, 1), (0.6, 2)])
@pytest.mark.parametrize("name", [*SYSTEMS, "an arch"])
def test_sixty_cells_of_each_system(name, share, across):
    (arch,) = load_structures("configs/arch.yaml")
    system, eta = (Method("nonlinear").system_of(arch), arch.eta) if name == "an arch" else SYSTEMS[name]
    assert against_the_march(system, eta, slice(None, 100), share, across, 60, 20 + across) > {Outcome.ROCKED}


def against_the_integration(words, samples, count, seed):
    """Outcomes equal, and rotations within 1e-10, for bodies with A to 4."""
    random, decided = np.random.default_rng(seed), 0
    motion, _ = upwards(samples, 0.05, 0.5, 2)
    while decided < count:
        p, alpha, eta = random.uniform(1.0, 3.0), random.uniform(0.1, 0.5), random.uniform(0.4, 0.98)
        zeta, nonlinear = 0.05 if "damped" in words else 0.0, "nonlinear" in words
        body = RockingParameters("body", "block", p, alpha, eta, math.tan(alpha), 1.0, damping=zeta)
        amplitude = random.uniform(0.8, 4.0)
        a_g = float(body.ground_acceleration(amplitude))
        up = motion.vertical.scaled(a_g)
        found = response(Method("nonlinear" if nonlinear else "linear", 1e-11).system_of(body), motion, amplitude, 1.0 / p, eta)
        marks = tuple(motion.stop.tolist())
        shaking = Shaking(partial(_at, motion.scaled(a_g)), partial(_at, up), marks[-1], marks)
        wanted = swing(Body(Edge(p, alpha, eta), Edge(p, alpha, eta), zeta, nonlinear), shaking)
        if wanted.outcome == "undecided" or up.peak > 0.95 * body.gravity:
            continue
        decided += 1
        assert Outcome(int(found.outcome)).flag == wanted.outcome
        assert math.isnan(wanted.rotation) or abs(wanted.rotation - float(found.theta_ratio)) < 1e-10


def _at(motion, t):
    return float(motion.value(t))


def test_bodies_against_an_integration_that_shares_no_code():
    against_the_integration("nonlinear", slice(36, 48), 1, 3)


@pytest.mark.soak
@pytest.mark.parametrize("words", ["linear", "nonlinear", "damped nonlinear"])
def test_more_bodies_against_that_integration(words):
    against_the_integration(words, slice(30, 60), 12, 4)


def test_no_digit_depends_on_the_neighbours(monkeypatch):
    (system, eta), (motion, _) = SYSTEMS["a damped body of unlike edges"], upwards(slice(36, 52), 0.04, 0.8, 2)
    amplitude, omega = cells(8, 6)
    together = response(system, motion, amplitude, omega, eta)
    monkeypatch.setattr("rocking_cli.dynamics.samples.stepper.WIDTH", 3)
    narrow = response(system, motion, amplitude, omega, eta, pool=4)
    alone = [response(system, motion, amplitude[i : i + 1], omega[i : i + 1], eta).theta_ratio[0] for i in range(2)]
    np.testing.assert_array_equal(narrow.theta_ratio, together.theta_ratio)
    np.testing.assert_array_equal(narrow.outcome, together.outcome)
    np.testing.assert_array_equal(alone, together.theta_ratio[:2])


def test_free_fall_before_and_after_the_uplift():
    """The ground falls as fast as the body at 0.5 s, which the across motion lifts at 0.25 s or at 0.75 s, or after a fall that is none."""
    t = 0.05 * np.arange(25)
    fall = -np.interp(t, [0.3, 0.55, 0.8], [0.0, 1.0, 0.0])
    for early, share, wanted in ((True, 4.8, "lost_contact"), (False, 4.8, "lost_contact"), (False, 2.0, "rocked")):
        push = np.interp(t, [0.1, 0.3, 0.5], [0.0, 1.0, 0.0]) if early else np.interp(t, [0.65, 0.8, 1.0], [0.0, 1.0, 0.0])
        across, up = shaken(push, 0.05), shaken(fall, 0.05)
        found = response(*SYSTEMS["a body"][:1], with_vertical(across, up, share), [1.2], [0.3], 0.9)
        assert Outcome(int(found.outcome[0])).flag == wanted, (early, share)


def test_records_of_one_step_are_stepped_and_others_marched(monkeypatch):
    motion, _ = upwards(slice(30, 54), 0.04, 0.5, 2)
    other = with_vertical(shaken(RECORDS[2][30:54], 0.04), shaken(UPWARDS[30:54], 0.03))
    stepped = []
    monkeypatch.setattr(taylor_steps.WeighedTaylorStepper, "march", lambda self, waiting: stepped.append(waiting.size))
    for m in (motion, other):
        response(SYSTEMS["a body"][0], m, [2.0, 3.0], 0.5, 0.9)
    assert stepped == [2]
