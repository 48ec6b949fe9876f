"""Bodies that leave the ground, against their least force and closed forms; against an
integration: test_contact_forces.py.
"""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from oracles.ground_forces import lifting, pendulum
from support.bodies import forces_of, random_body
from support.soak import quick

from rocking_cli import (
    Method,
    Outcome,
    RockingParameters,
    cosine,
    pulse,
    response,
    sine,
)
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.observers.contact_watch import ContactWatch
from rocking_cli.dynamics.outcome import safe
from rocking_cli.dynamics.references.general_solver import solve_cell
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.reports.work_precision import scipy_path

ETAS = 0.6, 0.98


@pytest.mark.parametrize(("kind", "vertical"), [("plain", 0.3), ("damped", 0.0)])
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
                np.linspace(0.8, 4.0, 30),
                np.linspace(2.0, 9.0, 4)[:, None],
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
        pytest.param("plain", "linear", 0.0, marks=pytest.mark.soak),
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
    for i, j in known[::9]:
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


@pytest.mark.parametrize("kind", ["plain", "unequal", "one-sided", "damped"])
@pytest.mark.parametrize("model", quick(("linear", "nonlinear"), "nonlinear"))
def test_no_body_leaves_the_ground_below_it(model, kind):
    """Up to the amplitude of Lemma 13; not far above it free undamped bodies do."""
    body, _, _ = random_body(
        f"{kind} {model}", np.random.default_rng(7), (0.33, 0.37), ETAS, 0.1
    )
    method, motion = Method(model), sine(2)
    system = method.system_of(body)
    safe_to = system.safe_amplitude(motion)
    amplitude = np.geomspace(system.least_uplift(motion), safe_to, 4)[1:]
    for omega in (3.0, 8.0):
        found = response(system, motion, amplitude, omega, body.eta)
        for a in amplitude[found.outcome == Outcome.ROCKED].tolist():
            assert forces_of(body, motion, a, omega, method).fz_min > 0.0
    far = safe_to * np.geomspace(1.5, 10.0, 12), np.linspace(1.0, 12.0, 6)[:, None]
    lost = Outcome.LOST_CONTACT in response(system, motion, *far, body.eta).outcome
    assert lost == (kind in ("plain", "unequal"))


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


class Seen(ContactWatch):
    """Keeps the steps that it has seen."""

    def losses(self, steps):
        # the march changes its lanes in place
        lanes = steps.lanes.take(np.arange(steps.reach.size))
        self.steps = [*getattr(self, "steps", []), steps._replace(lanes=lanes)]
        return super().losses(steps)


@pytest.mark.parametrize("model", quick(("linear", "nonlinear"), "nonlinear"))
@pytest.mark.parametrize("share", quick((0.0, 0.4), 0.4))
def test_forces_along_steps_stay_within_their_bounds(model, share):
    """Fz by another formula, at 65 instants of each step: above the bound by the
    largest speed and acceleration, and near its chord.
    """
    body, _, _ = random_body(
        f"damped {model}", np.random.default_rng(2), (0.4, 0.6), ETAS, 0.1
    )
    system = Method(model).system_of(body)
    motion = with_vertical(sine(2), sine(3), share) if share else sine(2)
    amplitude, omega = np.tile(np.geomspace(1.2, 6.0, 8), 2), np.repeat([2.0, 7.0], 8)
    batch = Batch.of(
        system.with_restitution(body.eta), system.segments(motion), amplitude, omega
    )
    watch = Seen(
        system.body,
        batch.equation,
        batch.contact,
        batch.segments,
        np.ones(batch.size, bool),
    )
    Run(batch, observers=[watch]).all()
    parts, idle = np.linspace(0.0, 1.0, 65), []
    for steps in watch.steps:
        at = np.flatnonzero(steps.wanted & (steps.lanes.segment < batch.shaken))
        lanes, edge = steps.lanes, system.body.edges[0]
        side, k = lanes.side[at], lanes.segment[at]
        along = []
        for part in parts:
            h = part * steps.reach[at]
            phase = lanes.phase[at] + lanes.omega[at] * h
            here = steps.arc.take(at).at(h)
            s = motion.value(batch.segments.start[k] + phase)
            weight = batch.segments.weight(side, lanes.amplitude[at], k, phase)
            push = -side * lanes.amplitude[at] * edge.uplift * s
            own = edge.theta_per_y * here.y, edge.theta_per_y * here.v
            fz = forces_under(system.body, edge, push, weight, *own)[1]
            np.testing.assert_allclose(watch.fz(steps, at, h), fz, atol=1e-6)
            along.append(fz)
        values, mixed = np.array(along), parts[:, None]
        chord = (1.0 - mixed) * values[0] + mixed * values[-1]
        off = np.abs(values - chord).max(axis=0)
        error = 0.125 * steps.reach[at] ** 2 * watch._largest_curvature(steps, at)
        assert np.all(off <= error * (1.0 + 1e-6) + 1e-9)
        assert np.all(values[:, watch._proved_by_size(steps)[at]] > 0.0)
        idle.append(off / error)
    assert np.nanmedian(np.concatenate(idle)) > 0.02
