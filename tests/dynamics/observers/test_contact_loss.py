"""Bodies that leave the ground, against the momentum of an integration that shares no code, the histories' forces and closed forms."""

import math
from itertools import islice

import numpy as np
import pytest
from oracles.ground_forces import lifting, pendulum
from oracles.vertical_motion import swing
from support.bodies import KINDS, drawn, shaken, shaking

from rocking_cli import Method, Outcome, RockingParameters, cosine, parse_grid, pulse, response, sine
from rocking_cli.dynamics.body import Body
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.observers.contact_loss import ContactLoss, Ends, Shakes, chord_errors
from rocking_cli.dynamics.response import response_with_demands
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.polyline import Polyline
from rocking_cli.responses.time_history import time_history

ALPHAS, ETAS = (0.3, 0.7), (0.6, 0.98)


@pytest.mark.parametrize("kind", ["plain", "damped"])
@pytest.mark.parametrize("vertical", [0.0, 0.3])
def test_a_body_that_the_linear_equation_lifts_at_lambda_leaves_the_ground_where_the_same_motion_does(kind, vertical):
    """At equal A and weight the motion is that of a_scale = 1, and Fz follows from the motion."""
    body, _, _ = drawn(kind, np.random.default_rng(4), (0.5, 0.7), ETAS, 0.2)
    lifted, found = body.lifting_at_lambda(), []
    for one, factor in ((body, vertical * body.uplift / body.alpha), (lifted, vertical)):
        motion = with_vertical(sine(), cosine(1.0), factor) if vertical else sine()
        found.append(response(Method().system_of(one), motion, np.linspace(0.8, 4.0, 60), np.linspace(2.0, 9.0, 5)[:, None], body.eta))
    assert np.count_nonzero(found[0].outcome == Outcome.LOST_CONTACT) > 10
    assert np.count_nonzero(found[0].outcome == Outcome.ROCKED) > 10
    assert np.array_equal(*(x.outcome for x in found))
    with pytest.raises(ValueError, match="ground forces need a rigid body"):
        response_with_demands(Method().system_of(lifted), sine(), 2.0, 3.0, body.eta)


def least_by_momentum(solved, arms, shaking):
    """(outcome, least Fz/(m g)): the change of the mass centre's vertical momentum between instants 2e-5 s apart, and the weight."""
    least = [1.0]

    def seen(side, path):
        edge, arm = solved.edge(side), arms[0 if side > 0 else 1]
        low, high = path.t_min, path.t_max
        step = min(1e-5, 0.1 * (high - low))
        t = np.linspace(low + step, high - step, 60)

        def rise(t):
            u, v = path(t)
            return arm * v * np.sin(edge.alpha - u)

        lift = (rise(t + step) - rise(t - step)) / (2.0 * step)
        least.append(min(1.0 + (shaking.up(x) + a) / solved.gravity for x, a in zip(t, lift, strict=True)))

    return swing(solved, shaking, seen).outcome, min(least)


def cells(kind, random, tolerance=1e-9):
    """Without end (body, solved, arms, method, motion, A, Omega, outcome) of random bodies that do not overturn."""
    while True:
        body, solved, arms = drawn(kind, random, ALPHAS, ETAS, 0.2)
        motion, *cell = shaken(random, body, (0.0, 0.4), (1.5, 5.0))
        method = Method("nonlinear" if solved.nonlinear else "linear", tolerance)
        found = Outcome(int(response(method.system_of(body), motion, *cell, body.eta).outcome))
        if found in (Outcome.ROCKED, Outcome.LOST_CONTACT):
            yield body, solved, arms, method, motion, *cell, found


@pytest.mark.parametrize(("count", "seed"), [(1, 3), pytest.param(60, 8, marks=pytest.mark.soak)])
@pytest.mark.parametrize("kind", KINDS)
def test_outcomes_are_those_of_the_momentum_of_another_integration(kind, count, seed):
    kept = []
    for body, solved, arms, _, motion, amplitude, omega, found in cells(kind, np.random.default_rng(seed)):
        outcome, least = least_by_momentum(solved, arms, shaking(motion, body, amplitude, omega))
        if outcome == "undecided" or abs(least) < 0.02:  # of the samples; the least lies between them
            continue
        assert outcome == "rocked"
        assert (found == Outcome.LOST_CONTACT) == (least < 0.0), (kind, motion.name, amplitude, omega, least)
        kept.append(least > 0.0)
        if len(kept) == count:
            break
    assert count == 1 or 5 < sum(kept) < count - 5


@pytest.mark.soak
@pytest.mark.parametrize("kind", KINDS)
def test_outcomes_are_those_of_the_extremes_along_histories(kind):
    lost = 0
    for body, _, _, method, motion, amplitude, omega, found in islice(cells(kind, np.random.default_rng(4), 1e-11), 120):
        history = time_history(body, motion, parse_grid(f"A={amplitude!r},Omega={omega!r}"), [method])
        assert history.outcome(method.model) == found, (kind, motion.name, amplitude, omega)
        lost += found == Outcome.LOST_CONTACT
    assert 10 < lost < 110


@pytest.mark.parametrize("omega", [8.0, 15.0])
def test_a_linear_point_mass_leaves_the_ground_from_where_its_closed_form_says(omega):
    body, edge = pendulum(), lifting(omega)
    found = response(Method().system_of(body), pulse("rectangular"), edge * np.array([1.0 - 1e-12, 1.0 + 1e-12]), omega, body.eta)
    assert found.outcome.tolist() == [Outcome.ROCKED, Outcome.LOST_CONTACT]
    assert np.isnan(found.theta_ratio).tolist() == [False, True]


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_they_are_the_cells_whose_least_force_is_not_positive(model):
    body = RockingParameters("b", "block", 1.0, 0.5, 0.9, math.tan(0.5), 1.0, arm=0.75 * 9.81)
    amplitude, omega = np.meshgrid(np.linspace(3.0, 12.0, 12), np.linspace(3.0, 12.0, 6))
    system = Method(model).system_of(body)
    found, asked = response_with_demands(system, sine(), amplitude, omega, body.eta)
    upright = np.isin(found.outcome, (Outcome.ROCKED, Outcome.LOST_CONTACT))
    assert np.array_equal(found.outcome[upright] == Outcome.LOST_CONTACT, asked["fz_min"][upright] <= 0.0)
    assert 5 < np.count_nonzero(found.outcome == Outcome.LOST_CONTACT) < np.count_nonzero(upright) - 5
    assert np.array_equal(response(system, sine(), amplitude, omega, body.eta, peaks=False).outcome, found.outcome)
    one = response(system, sine(), amplitude[3, 7], omega[3, 7], body.eta)
    assert int(one.outcome) == found.outcome[3, 7]


@pytest.mark.parametrize(
    ("model", "alpha", "eta", "zeta", "motion", "amplitude", "omega", "least"),
    [
        ("nonlinear", 1.04, -0.95, 0.3, cosine(1), 2.82, 1.2, -0.07596778403958),
        ("nonlinear", 1.0, 0.99, 0.6, cosine(1), 2.4, 1.41, -0.04265350447360),
        ("linear", 0.8, 0.3, 0.5, sine(1), 2.62, 2.0, -0.12540632586296),
    ],
    ids=["after an impact, one-sided", "after an impact", "within a long step"],
)
def test_a_damped_body_may_lose_it_at_the_end_of_the_shaking_and_later(model, alpha, eta, zeta, motion, amplitude, omega, least):
    """least: Fz/(m g), from a Runge-Kutta integration of order 8 in small steps that shares no code."""
    body = RockingParameters("b", "block", 1.0, alpha, eta, math.tan(alpha), 1.0, arm=0.75 * 9.81, one_sided=eta < 0.0, damping=zeta)
    system, scene = Method(model, 1e-11).system_of(body), (motion, amplitude, omega, eta)
    assert int(response(system, *scene).outcome) == Outcome.LOST_CONTACT
    found, asked = response_with_demands(system, *scene)
    assert int(found.outcome) == Outcome.LOST_CONTACT
    assert float(asked["fz_min"]) == pytest.approx(least, abs=1e-9)


def test_a_body_that_an_impact_leaves_no_speed_does_not_bounce():
    """Linear, eta = 0: bounces of no height would lose the ground, with Fz = -0.205 m g; the least and |Fx|/Fz are of that integration."""
    body = RockingParameters("b", "block", 1.0, 1.15, 0.0, math.tan(1.15), 1.0, arm=0.9 * 9.81)
    system, scene = Method().system_of(body), (sine(1), 1.1, 4.0, 0.0)
    found, asked = response_with_demands(system, *scene)
    assert int(response(system, *scene).outcome) == int(found.outcome) == Outcome.ROCKED
    assert [float(asked[name]) for name in ("fz_min", "friction")] == pytest.approx([0.31447055220054, 1.97191430146448], abs=1e-12)
    demands = time_history(body, sine(1), parse_grid("A=1.1,Omega=4"), [Method()]).forces["linear"].demands
    assert [demands.fz_min, demands.friction.friction] == pytest.approx([0.31447055220054, 1.97191430146448], abs=1e-12)


def test_what_a_rotation_proves_to_press_does():
    """Every cell that the bound settles has a positive least force, and it settles most."""
    body = RockingParameters("b", "block", 1.0, 0.35, 0.9, math.tan(0.35), 1.0, arm=0.75 * 9.81)
    amplitude, omega = (x.ravel() for x in np.meshgrid(np.linspace(1.0, 6.0, 11), np.linspace(1.0, 9.0, 9)))
    system = Method("nonlinear").system_of(body)
    scene = sine(), amplitude, omega, np.full(omega.size, 0.9)
    batch = Batch.of(system, sine().segments, *scene[1:])
    loss = ContactLoss(system.body, batch, 2.0)
    found, forces = response_with_demands(system, *scene)
    at = np.flatnonzero(found.outcome == Outcome.ROCKED)
    proved = loss.pressed(at, found.theta_ratio[at])
    assert forces["fz_min"][at[proved]].min() > 0.0
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
    for i in np.flatnonzero(np.isin(found.outcome, (Outcome.ROCKED, Outcome.LOST_CONTACT)))[-1:]:
        shaking = parse_grid(f"A={float(amplitude[i])!r},Omega={1.0 / body.p!r}")
        assert time_history(body, record, shaking, [method]).outcome("linear") == found.outcome[i]


def test_of_what_overturns_nothing_is_said():
    body = pendulum()
    found = response(Method().system_of(body), sine(), [0.5, 12.0], 2.0, body.eta)
    assert found.outcome.tolist() == [Outcome.NO_UPLIFT, Outcome.OVERTURNED_NO_IMPACT]


def forces_of(body, edge, push, weight, u, rate):
    """(Fx, Fz) over m g, and u'' [rad by tau]."""
    z = edge.alpha - u
    bend = push - weight * z if body.linear else push * np.cos(z) - weight * np.sin(z)
    bend = bend - 2.0 * body.damping * rate
    across = edge.kappa * (bend * np.cos(z) + rate**2 * np.sin(z)) - push
    return across, weight + edge.kappa * (bend * np.sin(z) - rate**2 * np.cos(z)), bend


@pytest.mark.parametrize("linear", [False, True])
def test_forces_leave_their_chords_by_no_more_than_their_sag(linear):
    """Of free motions by Taylor's series of u to the fifth order, whose errors on short stretches are far below their chord errors."""
    random, n = np.random.default_rng(2), 2000
    body = Body((0.4,), (0.8,), linear, 0.05)
    (edge,), h = body.edges, np.exp(random.uniform(np.log(0.01), np.log(0.3), n))
    u, rate = random.uniform(0.0, 1.0, n), random.uniform(-0.6, 0.6, n)
    push, push1, weight, weight1 = random.uniform(-1.5, 1.5, (2, n)), *random.uniform(-1.0, 1.0, (1, n)), None, None
    push, weight, weight1 = push[0], random.uniform(0.5, 1.5, n), random.uniform(-0.5, 0.5, n)

    def at(t, state):
        return forces_of(body, edge, push + push1 * t, weight + weight1 * t, *state)

    steps, state, seen = 64, (u, rate), []
    for i in range(steps + 1):
        t, dt = h * i / steps, h / steps
        seen.append((at(t, state), state))
        slopes = [(state[1], seen[-1][0][2])]
        for part in (0.5, 0.5, 1.0):  # Runge-Kutta of the fourth order
            there = tuple(x + part * dt * d for x, d in zip(state, slopes[-1], strict=True))
            slopes.append((there[1], at(t + part * dt, there)[2]))
        state = tuple(x + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d) for x, a, b, c, d in zip(state, *slopes, strict=True))
    (first, begin), (last, end) = seen[0], seen[-1]
    most = np.maximum(np.abs(push), np.abs(push + push1 * h)), np.abs(push1), np.zeros(1)
    heaviest = np.maximum(weight, weight + weight1 * h) - 1.0, np.abs(weight1), np.zeros(1)
    ends = [Ends(*state, forces[2], forces[1]) for forces, state in ((first, begin), (last, end))]
    error = chord_errors(body, edge, Shakes(*most, *heaviest), h, *ends)
    values, share = np.array([forces[1] for forces, _ in seen]), np.arange(steps + 1)[:, None] / steps
    off = np.abs(values - (1.0 - share) * values[0] - share * values[-1]).max(axis=0)
    kept = u > 0.0
    assert np.all(off[kept] <= error[kept] * (1.0 + 1e-6) + 1e-9)
    assert np.median(off / error) > 0.02  # and the bound is no idle one
