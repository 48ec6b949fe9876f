"""Bodies that leave the ground, against their least force and closed forms; against an
integration: test_contact_forces.py.
"""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from oracles.ground_forces import lifting, pendulum
from scipy.integrate import solve_ivp
from support.bodies import forces_of, random_body

from rocking_cli import (
    Method,
    Outcome,
    RockingParameters,
    cosine,
    parse_grid,
    pulse,
    response,
    sine,
)
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.body import Body
from rocking_cli.dynamics.observers.contact_loss import (
    ContactLoss,
    Ends,
    ShakingBounds,
    chord_errors,
)
from rocking_cli.dynamics.outcome import safe
from rocking_cli.dynamics.references.general_solver import solve_cell
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.polyline import Polyline
from rocking_cli.reports.work_precision import scipy_path
from rocking_cli.responses.time_history import time_history

ETAS = 0.6, 0.98


@pytest.mark.parametrize("kind", ["plain", "damped"])
@pytest.mark.parametrize("vertical", [0.0, 0.3])
def test_a_body_lifted_at_lambda_leaves_the_ground_where_the_same_motion_does(
    kind, vertical
):
    """At equal A and weight the motion is that of a_scale = 1, and Fz follows from the
    motion.
    """
    body, _, _ = random_body(kind, np.random.default_rng(4), (0.5, 0.7), ETAS, 0.2)
    lifted, found = body.lifting_at_lambda(), []
    for one, factor in (
        (body, vertical * body.uplift / body.alpha),
        (lifted, vertical),
    ):
        motion = with_vertical(sine(), cosine(1.0), factor) if vertical else sine()
        found.append(
            response(
                Method().system_of(one),
                motion,
                np.linspace(0.8, 4.0, 60),
                np.linspace(2.0, 9.0, 5)[:, None],
                body.eta,
            )
        )
    assert np.count_nonzero(found[0].outcome == Outcome.LOST_CONTACT) > 10
    assert np.count_nonzero(found[0].outcome == Outcome.ROCKED) > 10
    assert np.array_equal(*(x.outcome for x in found))


@pytest.mark.parametrize("path", ["march", "midpoint rule", "DOP853"])
@pytest.mark.parametrize("omega", [8.0, 15.0])
def test_a_linear_point_mass_leaves_the_ground_from_where_its_closed_form_says(
    omega, path
):
    body, method = pendulum(), Method()
    solver = (
        {}
        if path == "midpoint rule"
        else {"solver": partial(scipy_path, "DOP853", 1e-10)}
    )
    off = 1e-12 if path == "march" else 1e-9
    for factor, expected in (
        (1.0 - off, Outcome.ROCKED),
        (1.0 + off, Outcome.LOST_CONTACT),
    ):
        cell = pulse("rectangular"), factor * lifting(omega), omega
        marched = path == "march"
        outcome, theta = (
            response(method.system_of(body), *cell)[1::-1]
            if marched
            else solve_cell(*cell, method.problem_of(body), **solver)
        )
        assert outcome == expected
        assert math.isnan(theta) == (expected == Outcome.LOST_CONTACT)


@pytest.mark.parametrize("paths", ["march", "midpoint rule"])
def test_what_overturns_is_told_as_overturned_and_unknown_forces_are_not_looked_at(
    paths,
):
    body, method = pendulum(), Method()
    unknown = replace(body, arm=None)

    def outcome(body, *cell):
        return (
            response(method.system_of(body), *cell).outcome
            if paths == "march"
            else method.reference_of(body)(*cell)[0]
        )

    assert outcome(body, sine(), 12.0, 2.0) == Outcome.OVERTURNED_NO_IMPACT
    assert (
        outcome(unknown, pulse("rectangular"), 1.1 * lifting(8.0), 8.0)
        == Outcome.ROCKED
    )


@pytest.mark.parametrize(
    ("kind", "model", "share"),
    [
        ("plain", "linear", 0.0),
        ("plain", "nonlinear", 0.0),
        ("one-sided", "nonlinear", -0.9),
        ("damped", "nonlinear", -0.9),
    ],
)
def test_they_are_the_cells_whose_least_force_is_not_positive(kind, model, share):
    body, _, _ = random_body(
        f"{kind} {model}", np.random.default_rng(3), (0.45, 0.6), ETAS, 0.3
    )
    amplitude, omega = np.meshgrid(
        np.linspace(0.5, 4.0 if share else 12.0, 12), np.linspace(2.0, 12.0, 6)
    )
    cell = (
        Method(model).system_of(body),
        with_vertical(sine(), cosine(), share) if share else sine(),
    )
    found = response(*cell, amplitude, omega, body.eta)
    known, lost = (
        np.argwhere(safe(found.outcome) | (found.outcome == Outcome.LOST_CONTACT)),
        found.outcome == Outcome.LOST_CONTACT,
    )
    assert 5 < np.count_nonzero(lost) < len(known) - 5
    for i, j in known[::6]:
        asked = forces_of(
            body, cell[1], float(amplitude[i, j]), float(omega[i, j]), Method(model)
        )
        assert (
            lost[i, j] == (asked.fz_min <= 0.0) == math.isinf(asked.friction.friction)
        )
    for peaks in (True, False):
        assert np.array_equal(
            found.outcome,
            response(*cell, amplitude, omega, body.eta, peaks=peaks).outcome,
        )
    assert (
        response(*cell, amplitude[3, 7], omega[3, 7], body.eta).outcome
        == found.outcome[3, 7]
    )


@pytest.mark.parametrize(
    ("model", "alpha", "eta", "zeta", "motion", "amplitude", "omega", "least"),
    [
        ("nonlinear", 1.04, -0.95, 0.3, cosine(1), 2.82, 1.2, -0.07596778403958),
        ("nonlinear", 1.0, 0.99, 0.6, cosine(1), 2.4, 1.41, -0.04265350447360),
        ("linear", 0.8, 0.3, 0.5, sine(1), 2.62, 2.0, -0.12540632586296),
    ],
    ids=["after an impact, one-sided", "after an impact", "within a long step"],
)
def test_a_damped_body_may_lose_it_at_the_end_of_the_shaking_and_later(
    model, alpha, eta, zeta, motion, amplitude, omega, least
):
    """least: Fz/(m g), from a Runge-Kutta integration of order 8 in small steps that
    shares no code.
    """
    body = RockingParameters(
        name="b",
        structure="block",
        p=1.0,
        alpha=alpha,
        eta=eta,
        uplift=math.tan(alpha),
        a_scale=1.0,
        arm=0.75 * 9.81,
        one_sided=eta < 0.0,
        damping=zeta,
    )
    system, scene = (
        Method(model, 1e-11).system_of(body),
        (motion, amplitude, omega, eta),
    )
    assert int(response(system, *scene).outcome) == Outcome.LOST_CONTACT
    assert forces_of(
        body, motion, amplitude, omega, Method(model, 1e-11)
    ).fz_min == pytest.approx(least, abs=1e-9)


def test_a_body_that_an_impact_leaves_no_speed_does_not_bounce():
    """Linear, eta = 0: bounces of no height would lose the ground, with Fz = -0.205 m
    g; the least and |Fx|/Fz are of that integration.
    """
    body = RockingParameters(
        name="b",
        structure="block",
        p=1.0,
        alpha=1.15,
        eta=0.0,
        uplift=math.tan(1.15),
        a_scale=1.0,
        arm=0.9 * 9.81,
    )
    assert (
        int(response(Method().system_of(body), sine(1), 1.1, 4.0, 0.0).outcome)
        == Outcome.ROCKED
    )
    demands = forces_of(body, sine(1), 1.1, 4.0, Method())
    assert [demands.fz_min, demands.friction.friction] == pytest.approx(
        [0.31447055220054, 1.97191430146448], abs=1e-12
    )


@pytest.mark.slow
def test_what_a_rotation_proves_to_press_does():
    """Every cell that the bound settles has a positive least force, and it settles
    most.
    """
    body = RockingParameters(
        name="b",
        structure="block",
        p=1.0,
        alpha=0.35,
        eta=0.9,
        uplift=math.tan(0.35),
        a_scale=1.0,
        arm=0.75 * 9.81,
    )
    amplitude, omega = (
        x.ravel()
        for x in np.meshgrid(np.linspace(1.0, 6.0, 7), np.linspace(1.0, 9.0, 6))
    )
    system = Method("nonlinear").system_of(body)
    scene = sine(), amplitude, omega
    batch = Batch.of(system, sine().segments, *scene[1:])
    loss = ContactLoss(system.body, batch)
    found = response(system, *scene)
    at = np.flatnonzero(found.outcome == Outcome.ROCKED)
    proved = loss.contact_proved(at, found.theta_ratio[at])
    for i in at[proved].tolist():
        assert (
            forces_of(
                body, sine(), float(amplitude[i]), float(omega[i]), Method("nonlinear")
            ).fz_min
            > 0.0
        )
    assert 0.5 < proved.mean() < 1.0
    assert not np.any(loss.open & (amplitude <= system.safe_amplitude(sine())))


def test_a_flight_marks_them_too():
    body, random = pendulum(0.6), np.random.default_rng(1)
    values = np.append(random.uniform(-1.0, 1.0, 24), 0.0)
    t = 0.1 * np.arange(25)
    record = Polyline("r", t[:-1], t[1:], values[:-1], np.diff(values) / 0.1, 1.0)
    amplitude, method = np.linspace(0.8, 3.0, 6), Method()
    found = response(method.system_of(body), record, amplitude, 1.0 / body.p, body.eta)
    assert np.count_nonzero(found.outcome == Outcome.LOST_CONTACT) >= 1
    for i in np.flatnonzero(
        np.isin(found.outcome, (Outcome.ROCKED, Outcome.LOST_CONTACT))
    )[-1:]:
        shaking = parse_grid(f"A={float(amplitude[i])!r},Omega={1.0 / body.p!r}")
        assert (
            time_history(body, record, shaking, [method]).outcome("linear")
            == found.outcome[i]
        )


def forces_under(body, edge, push, weight, u, rate):
    """(Fx, Fz) over m g, and u'' [rad by tau]."""
    z = edge.alpha - u
    acceleration = (
        push - weight * z if body.linear else push * np.cos(z) - weight * np.sin(z)
    )
    acceleration = acceleration - 2.0 * body.damping * rate
    across = edge.kappa * (acceleration * np.cos(z) + rate**2 * np.sin(z)) - push
    return (
        across,
        weight + edge.kappa * (acceleration * np.sin(z) - rate**2 * np.cos(z)),
        acceleration,
    )


@pytest.mark.parametrize("linear", [False, True])
def test_forces_leave_their_chords_by_no_more_than_their_sag(linear):
    random, n = np.random.default_rng(2), 2000
    body = Body((0.4,), (0.8,), linear, 0.05)
    (edge,), h = body.edges, np.exp(random.uniform(np.log(0.01), np.log(0.3), n))
    lows, highs = zip(
        (0.0, 1.0),
        (-0.6, 0.6),
        (-1.5, 1.5),
        (-1.0, 1.0),
        (0.5, 1.5),
        (-0.5, 0.5),
        strict=True,
    )
    u, rate, push, push1, weight, weight1 = random.uniform(lows, highs, (n, 6)).T

    def forces(part, state):
        return forces_under(
            body,
            edge,
            push + push1 * h * part,
            weight + weight1 * h * part,
            *state.reshape(2, n),
        )

    def slopes(part, state):
        return np.append(h * state[n:], h * forces(part, state)[2])

    parts = np.linspace(0.0, 1.0, 65)
    states = solve_ivp(
        slopes, (0.0, 1.0), np.append(u, rate), "DOP853", parts, rtol=1e-11, atol=1e-12
    ).y.T
    along = [forces(part, state) for part, state in zip(parts, states, strict=True)]
    ends = [Ends(*states[i].reshape(2, n), along[i][2], along[i][1]) for i in (0, -1)]
    most = (
        np.maximum(np.abs(push), np.abs(push + push1 * h)),
        np.abs(push1),
        np.zeros(1),
    )
    heaviest = (
        np.maximum(weight, weight + weight1 * h) - 1.0,
        np.abs(weight1),
        np.zeros(1),
    )
    error = chord_errors(body, edge, ShakingBounds(*most, *heaviest), h, *ends)
    values, share = np.array([fz for _, fz, _ in along]), parts[:, None]
    off = np.abs(values - (1.0 - share) * values[0] - share * values[-1]).max(axis=0)
    kept = u > 0.0
    assert np.all(off[kept] <= error[kept] * (1.0 + 1e-6) + 1e-9)
    assert np.median(off / error) > 0.02  # and the bound is no idle one
