"""Unequal, one-sided and damped bodies, linear and nonlinear, against an integration that shares no code with the package."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from oracles.collocation import Body, Edge, conditioning, integrate
from oracles.single_cell import condition

from rocking_cli import Method, Motion, Outcome, RockingParameters, cosine, pulse, response, sine
from rocking_cli.dynamics.contacts.contact import Unequal
from rocking_cli.dynamics.equations.rigid_body import RigidBodyEquation
from rocking_cli.dynamics.system import System
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.responses.history import history
from rocking_cli.structures.parameters import Side

TURN = 2.0 * math.pi
MIRRORED = Motion("mirrored sine", (Piece(0.0, TURN, (Harmonic(-1.0),)),))
MOTIONS = [sine(), sine(2), cosine(1.5), pulse("rectangular-impulse"), pulse("mavroeidis-papageorgiou"), MIRRORED]
SYSTEMS = [
    "symmetric linear", "unequal linear", "one-sided linear", "damped linear", "unequal nonlinear", "one-sided nonlinear",
    "damped nonlinear", "unequal damped linear", "one-sided damped linear", "unequal damped nonlinear", "one-sided damped nonlinear",
]  # fmt: skip
ERROR = {"linear": 1e-9, "nonlinear": 5e-9}  # of theta/alpha where the cell's condition is 1 or less; nonlinear: five tolerances


@dataclass
class Tally:
    """Cells compared, those that are only as sure as their condition allows, and the largest difference of the others."""

    cells: int = 0
    sensitive: int = 0
    worst: float = 0.0


def drawn(words, random):
    """A random body of a system: as the package takes it, and as the oracle does."""
    p, alpha = random.uniform(1.0, 3.0), random.uniform(0.08, 0.4)
    zeta = float(random.choice([0.01, 0.05, 0.2, 0.6])) if "damped" in words else 0.0
    nonlinear = "nonlinear" in words
    if "unequal" in words:
        other, angle = p * random.uniform(0.85, 1.18), alpha * random.uniform(0.6, 1.6)
        e1, e2 = random.uniform(0.3, 0.98, 2)
        left, right = Side("left", p, alpha, math.tan(alpha), 1.0, e1), Side("right", other, angle, math.tan(angle), 1.0, e2)
        return (
            RockingParameters.of_sides("body", "prism", left, right, damping=zeta),
            Body(Edge(other, angle, e2), Edge(p, alpha, e1), zeta, nonlinear),
        )
    one_sided = "one-sided" in words
    eta = -random.uniform(0.0, 0.9) if one_sided else random.uniform(0.3, 0.98)
    edge = Edge(p, alpha, eta)
    body = RockingParameters("body", "block", p, alpha, eta, math.tan(alpha), 1.0, one_sided=one_sided, damping=zeta)
    return body, Body(edge, None if one_sided else edge, zeta, nonlinear)


def shape(motion):
    """s(phase) of an array, for phases inside the pieces."""

    def s(phase):
        total = np.zeros_like(phase)
        for piece in motion.pieces:
            inside = (phase >= piece.start) & (phase <= piece.stop)
            total = np.where(inside, piece.value(phase), total)
        return total

    return s


def compared(system, cells, seed):
    """Every cell equal in outcome and within its error, or as sensitive as that."""
    words, random, tally = system.split(), np.random.default_rng(seed), Tally()
    method = Method(words[-1])
    for i in range(cells):
        structure, body = drawn(words, random)
        motion, omega = MOTIONS[i % len(MOTIONS)], random.uniform(0.7, 9.0)
        amplitude = 1.0 + 10.0 ** random.uniform(-3.0, -0.5) if random.random() < 0.2 else random.uniform(0.8, 7.0)
        found = response(method.system_of(structure), motion, amplitude, omega, structure.eta)
        shaking = float(structure.ground_acceleration(amplitude)), omega * structure.p, tuple(p.stop for p in motion.pieces)
        answer = integrate(body, shape(motion), motion.duration, *shaking)
        same = Outcome(int(found.outcome)).flag == answer.outcome
        gap = abs(answer.rotation - float(found.theta_ratio)) if same and not math.isnan(answer.rotation) else 0.0
        tally.cells += 1
        if same and gap <= ERROR[words[-1]]:
            tally.worst = max(tally.worst, gap)
            continue
        condition = conditioning(body, shape(motion), motion.duration, *shaking)
        assert math.isinf(condition) if not same else gap <= ERROR[words[-1]] * condition, (system, i, amplitude, omega, structure)
        tally.sensitive += 1
    return tally


@pytest.mark.parametrize("system", SYSTEMS)
def test_a_system_equals_an_independent_integration(system):
    tally = compared(system, 16, 1)
    assert tally.sensitive <= 1


@pytest.mark.soak
@pytest.mark.parametrize("system", SYSTEMS)
def test_two_thousand_cells_of_a_system(system, capsys):
    tally = compared(system, 2000, 2)
    with capsys.disabled():
        print(f"\n{system}: {tally.cells} cells, {tally.sensitive} judged by their condition, the others within {tally.worst:.1e}")
    assert tally.sensitive <= 20


def test_a_one_sided_body_rocks_like_a_free_one_up_to_its_first_impact():
    """Its backing plays no part before, and afterwards it never passes it."""
    free = RockingParameters("wall", "block", 1.35, 0.149, 0.9, math.tan(0.149), 1.0)
    wall = RockingParameters("wall", "block", 1.35, 0.149, -0.43667308, math.tan(0.149), 1.0, one_sided=True)
    for model in ("linear", "nonlinear"):
        both, one = (history(Method(model, 1e-11).system_of(s), MIRRORED, 2.5, 4.0, s.eta, duration=20.0) for s in (free, wall))
        end = next(e.tau for e in one.events if e.event == "impact")
        assert end == pytest.approx(next(e.tau for e in both.events if e.event == "impact"), rel=1e-12, abs=0)
        times = np.linspace(0.0, end, 200, endpoint=False)
        assert one.at(times)[0].tolist() == both.at(times)[0].tolist()
        after = np.linspace(end, one.end, 500)[1:]
        assert np.all(one.at(after)[0] >= 0.0)
        assert np.any(both.at(after)[0] < 0.0)


def test_an_inward_drive_holds_a_one_sided_body():
    wall = RockingParameters("wall", "block", 1.35, 0.149, -0.4, math.tan(0.149), 1.0, one_sided=True)
    inward = Motion("inward", (Piece(0.0, TURN, (), 1.0),))
    outward = Motion("outward", (Piece(0.0, TURN, (), -1.0),))
    system = Method().system_of(wall)
    assert response(system, inward, 50.0, 0.5, wall.eta).outcome == Outcome.NO_UPLIFT
    assert response(system, outward, 50.0, 0.5, wall.eta).outcome == Outcome.OVERTURNED_NO_IMPACT
    assert system.least_uplift(inward) == math.inf


def test_two_equal_sides_given_apart_are_the_symmetric_body():
    plain = RockingParameters("body", "block", 2.0, 0.2, 0.8, math.tan(0.2), 1.0)

    random = np.random.default_rng(5)
    cells = random.uniform(0.9, 6.0, 120), random.uniform(1.0, 8.0, 120), 0.8
    for model in ("linear", "nonlinear"):
        system = Method(model).system_of(plain)
        turn = float(system.equation.rotation(np.ones(1))[0])
        drive = 1.0 / float(system.equation.uplift_amplitude)
        equation = system.equation if model == "linear" else RigidBodyEquation((0.2, 0.2))
        apart = System(equation, Unequal((drive, drive), (1.0, 1.0), (0.8, 0.8), (turn, turn)))
        one, other = response(system, sine(3), *cells), response(apart, sine(3), *cells)
        assert one.outcome.tolist() == other.outcome.tolist()
        rounding = np.finfo(float).eps * condition(sine(3), *cells, lambda *cell, system=system: response(system, *cell))
        differ = np.abs(one.theta_ratio - other.theta_ratio)
        assert not np.any(differ > 10.0 * rounding)
        assert np.array_equal(np.isnan(differ), np.isnan(one.theta_ratio))
