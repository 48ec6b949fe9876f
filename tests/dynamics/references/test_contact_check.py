"""Where the slower paths lose contact: against closed forms, and the engine, whose outcomes they check."""

from __future__ import annotations

import math
from collections import Counter
from functools import partial

import numpy as np
import pytest
from oracles.ground_forces import lifting, pendulum
from support.stocky_bodies import ACROSS, KINDS, UP, drawn

from rocking_cli import Method, Outcome, RockingParameters, cosine, load_structures, parse_grid, pulse, response, sine, spectrum
from rocking_cli.dynamics.observers.contact_loss import ContactLoss
from rocking_cli.dynamics.observers.observer import Observer
from rocking_cli.dynamics.references import general_solver
from rocking_cli.dynamics.references.general_solver import lets_go, solve_cell
from rocking_cli.dynamics.references.scripted import Script
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.polyline import Polyline


@pytest.mark.parametrize("omega", [8.0, 15.0])
@pytest.mark.parametrize("path", ["midpoint rule", "DOP853"])
def test_a_linear_point_mass_leaves_the_ground_from_where_its_closed_form_says(path, omega):
    body, method = pendulum(), Method()
    reference = partial(solve_cell, problem=method.problem_of(body))
    if path == "DOP853":
        reference = partial(reference, solver=Script("DOP853", 1e-10))
    for factor, expected in ((1.0 - 1e-9, Outcome.ROCKED), (1.0 + 1e-9, Outcome.LOST_CONTACT)):
        outcome, theta = reference(pulse("rectangular"), factor * lifting(omega), omega, body.eta)
        assert outcome == expected
        assert math.isnan(theta) == (expected == Outcome.LOST_CONTACT)


def test_what_overturns_is_told_as_overturned_and_unknown_forces_are_not_looked_at():
    body, method = pendulum(), Method()
    assert method.reference_of(body)(sine(), 12.0, 2.0, body.eta)[0] == Outcome.OVERTURNED_NO_IMPACT
    unknown = RockingParameters("m", "point_mass", 2.0, 1.0, 0.9, math.tan(1.0), 1.0)
    assert method.reference_of(unknown)(pulse("rectangular"), 1.1 * lifting(8.0), 8.0, 0.9)[0] == Outcome.ROCKED


@pytest.mark.parametrize(("depth", "gone"), [(1e-9, True), (-1e-9, False)])
@pytest.mark.parametrize("place", [0.1, 0.37, 0.5, 0.93])
def test_a_dip_within_a_step_is_found(place, depth, gone):
    def force(x):
        return 0.3 * (x - place) ** 2 * (1.0 + 0.2 * x) - depth

    assert lets_go((force(0.0), force(0.5), force(1.0)), force) == gone


def test_the_ground_falls_away_where_the_weight_is_gone():
    """Bodies that nothing lifts but the loss of their weight; of a linkage that is on its way down nothing is told."""
    body = RockingParameters("b", "block", 2.0, 0.2, 0.9, math.tan(0.2), 1.0)
    for model in ("linear", "nonlinear"):
        reference = Method(model).reference_of(body)
        for factor, expected in ((1.0 - 1e-9, Outcome.ROCKED), (1.0 + 1e-9, Outcome.LOST_CONTACT)):
            motion = with_vertical(sine(), cosine(), factor / (0.5 * 0.2))  # the weight is least at its middle
            assert reference(motion, 0.5, 3.0, body.eta)[0] == expected
    (arch,) = load_structures("configs/arch.yaml")
    falling = with_vertical(sine(0.5), cosine(1), 0.9)
    found = [Method("nonlinear").reference_of(arch)(falling, a, 2.0, arch.eta)[0] for a in (0.9, 6.0)]
    assert found == [Outcome.NO_UPLIFT, Outcome.FAILED]


def shaken(random, body, recorded):
    """(motion, A, Omega), of every third with weight enough throughout, of the others mostly not."""
    across, up, omega = ACROSS[random.integers(len(ACROSS))], UP[random.integers(len(UP))], random.uniform(1.0, 10.0)
    if recorded:
        t, omega = 0.15 * np.arange(23), 1.0 / body.p
        rows = np.pad(random.uniform(-1.0, 1.0, (2, 21)), ((0, 0), (1, 1)))
        across, up = (Polyline("r", t[:-1], t[1:], row[:-1], np.diff(row) / 0.15, 1.0) for row in rows)
    share = (0.0, 0.4, 1.5)[random.integers(3)]
    return with_vertical(across, up, share * random.uniform(-1.0, 1.0)) if share else across, random.uniform(1.5, 5.0), omega


def as_the_engine(kind, cells, seed, recorded):
    """How often each outcome came, the same by both."""
    random, seen = np.random.default_rng(seed), Counter()
    for _ in range(cells):
        body, solved, _ = drawn(kind, random, (0.3, 0.7), (0.6, 0.98), 0.2)
        motion, amplitude, omega = shaken(random, body, recorded)
        method = Method("nonlinear" if solved.nonlinear else "linear", 1e-11)
        found = response(method.system_of(body), motion, amplitude, omega, body.eta)
        outcome, theta = method.reference_of(body)(motion, amplitude, omega, body.eta)
        assert outcome == found.outcome, (kind, motion.name, method.model, amplitude, omega)
        assert outcome != Outcome.ROCKED or abs(theta - found.theta_ratio) < 1e-8
        seen[outcome] += 1
    return seen


@pytest.mark.parametrize(("kind", "recorded", "seed"), [("unequal", False, 1), ("damped", True, 4)])
def test_the_engine_and_the_slower_paths_lose_the_same_bodies(kind, recorded, seed):
    assert {Outcome.ROCKED, Outcome.LOST_CONTACT} <= set(as_the_engine(kind, 5, seed, recorded))


@pytest.mark.soak
@pytest.mark.parametrize("recorded", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_they_lose_the_same_of_many(kind, recorded):
    seen = as_the_engine(kind, 150, 7, recorded)
    assert min(seen[Outcome.ROCKED], seen[Outcome.LOST_CONTACT]) > 20


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_a_sweep_counts_bodies_that_one_path_alone_sees_leave_the_ground(model, monkeypatch):
    grid, motion, method = parse_grid("A=4:8:3,Omega=7:9:2"), sine(), Method(model)
    known = spectrum([pendulum()], motion, grid, method=method, check=6).summary
    lost = known.outcomes["lost_contact"]
    assert lost > 0
    assert (known.misjudged, known.checked_cells) == (0, 6)
    with monkeypatch.context() as blind:
        blind.setattr(general_solver, "lets_go", lambda rough, force: False)
        assert spectrum([pendulum()], motion, grid, method=method, check=6).summary.misjudged == lost
    monkeypatch.setattr(ContactLoss, "pressed", lambda self, at, theta_ratio: np.ones(at.size, dtype=bool))
    monkeypatch.setattr(ContactLoss, "arcs", lambda self, *lanes: None)
    monkeypatch.setattr(ContactLoss, "free", lambda self, *lanes: None)
    monkeypatch.setattr(ContactLoss, "may_close", Observer.may_close)
    assert spectrum([pendulum()], motion, grid, method=method, check=6).summary.misjudged == lost
