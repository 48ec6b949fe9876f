"""The largest angular speed, against an integration that shares no code and against
energy.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.collocation import Body, Edge, integrate
from support.bodies import shaking
from support.documents import built
from support.record_layouts import wave
from support.soak import quick

from rocking_cli import Method, Outcome, history, response
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.dynamics.observers.peak_speed import PeakSpeed
from rocking_cli.dynamics.response import response_with_speed
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.records import Record
from rocking_cli.motions.records.record import record_motion
from rocking_cli.structures.parameters import RockingParameters, Side

ALPHA, ETA = 0.25, 0.85
BLOCK = built(f"kind: block\nradius: 1.5 m\nalpha: {ALPHA}\nrestitution: {ETA}")
LEANING = RockingParameters.of_sides(
    "body",
    "prism",
    Side("left", 2.0, 0.2, math.tan(0.2), 1.0, 0.5),
    Side("right", 1.6, 0.3, math.tan(0.3), 1.0, 0.4),
)
MOTION = record_motion(
    Record("a", "text", None, 0.05, wave(40, 3.0), None, "m/s2", "a", "a")
)


def fastest(model, body, amplitude, omega, eta, motion=MOTION):
    """max |d theta/d tau|/alpha by another integration in the record's own time, in
    which p is 1/omega.
    """
    edges = [
        (side.p / body.p / omega, side.alpha, side.eta) for side in reversed(body.sides)
    ] or [(1.0 / omega, body.alpha, eta)] * 2
    solved, speeds = (
        Body(*(Edge(*e) for e in edges), body.damping, model == "nonlinear"),
        [0.0],
    )
    answer = integrate(
        solved,
        shaking(motion, float(body.ground_acceleration(amplitude)), 1.0),
        seen=lambda _side, step: speeds.append(
            np.abs(step.speed(np.linspace(0.0, 1.0, 100))).max()
        ),
    )
    assert answer.outcome == "rocked"
    return max(speeds) * omega / body.alpha


@pytest.mark.parametrize(
    ("model", "body", "damping"),
    [
        pytest.param("linear", BLOCK, 0.0, marks=pytest.mark.soak),
        pytest.param("nonlinear", BLOCK, 0.0, marks=pytest.mark.soak),
        ("linear", LEANING, 0.0),
        pytest.param("linear", BLOCK, 0.1, marks=pytest.mark.soak),
        ("nonlinear", LEANING, 0.05),
    ],
)
def test_the_largest_speed_by_another_integration(model, body, damping):
    """Of each equation, on one edge and two, with damping."""
    random, count, eta = np.random.default_rng(2), 6, 0.5
    large = (
        np.arange(count) % 2 == 0
    )  # in the air the fastest of these, the others at an impact
    amplitude = np.where(
        large, random.uniform(2.0, 15.0, count), random.uniform(1.5, 4.0, count)
    )
    omega = np.exp(
        np.where(
            large, random.uniform(1.0, 2.0, count), random.uniform(-1.6, 0.3, count)
        )
    )
    body = replace(body, damping=damping)
    system = Method(model).system_of(body).with_restitution(eta)
    found, speed = response_with_speed(system, MOTION, amplitude, omega)
    plain = response(system, MOTION, amplitude, omega)
    batch = Batch.of(system, MOTION.segments, amplitude, omega)
    marched = PeakSpeed(batch)
    Run(batch, observers=[marched]).all()
    assert np.array_equal(found.outcome, plain.outcome)
    np.testing.assert_allclose(
        found.theta_ratio, plain.theta_ratio, rtol=1e-9, atol=0
    )  # jumps are cut where a speed may hide
    assert set(found.outcome) == {Outcome.ROCKED}
    np.testing.assert_allclose(speed, marched.largest, rtol=1e-10)
    for i in range(2):  # one is fastest in the air, the other one at an impact
        assert speed[i] == pytest.approx(
            fastest(model, body, amplitude[i], omega[i], eta), rel=1e-5
        )


def test_only_what_rocks_and_has_a_speed_has_one():
    system = Method().system_of(BLOCK)
    _, speed = response_with_speed(
        system, MOTION, np.array([0.5, 1.2, 900.0]), np.array(0.4)
    )
    assert speed[0] == 0.0
    assert 0.0 < speed[1] < math.inf
    assert math.isnan(speed[2])


def test_a_step_throws_a_body_that_falls_back_as_its_energy_says():
    """Uplift by a short strong drive and then still ground: v at the next impact, and E
    = v^2 + y (2 - y), are the speed.
    """
    short = record_motion(
        Record(
            "s", "text", None, 0.1, np.array([0.0, -1.0, 0.0]), None, "m/s2", "s", "s"
        )
    )
    amplitude, omega = 1.8, 0.3
    _, speed = response_with_speed(
        Method().system_of(BLOCK), short, np.array([amplitude]), np.array([omega])
    )
    # y'' = y - 1 + a, a = A t/h up to h and back to 0 at 2h: from uplift at a = 1 the
    # sum of two ramps
    h = 0.1 / omega
    rate, lift, end = amplitude / h, h / amplitude, 2.0 * h
    t = np.linspace(lift, end, 100_001)
    after = np.maximum(t - h, 0.0)
    y = rate * (np.sinh(t - lift) - (t - lift)) - 2.0 * rate * (np.sinh(after) - after)
    v = rate * (np.cosh(t - lift) - 1.0) - 2.0 * rate * (np.cosh(after) - 1.0)
    assert y[1:].min() > 0.0 > y[-1] + v[-1] - 1.0, (
        "it neither lands before the end nor overturns after it"
    )
    at_ground = math.sqrt(v[-1] ** 2 + y[-1] * (2.0 - y[-1]))
    assert speed[0] == pytest.approx(max(float(v.max()), at_ground), rel=1e-8)


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_a_damped_body_that_falls_back_after_the_shaking_is_fastest_at_its_impact(
    model,
):
    short = record_motion(
        Record(
            "s", "text", None, 0.1, np.array([0.0, -1.0, 0.0]), None, "m/s2", "s", "s"
        )
    )
    body = replace(BLOCK, damping=0.02)
    _, (speed,) = response_with_speed(
        Method(model).system_of(body), short, np.array([1.8]), np.array([0.3])
    )
    assert speed == pytest.approx(fastest(model, body, 1.8, 0.3, ETA, short), rel=1e-5)


@pytest.mark.parametrize("model", quick(("linear", "nonlinear"), "nonlinear"))
def test_a_vertical_record_shakes_those_whose_speed_is_kept_too(model):
    """Outcome and rotation are those of `response`, and the speed is that of the
    history, to what its rows resolve.
    """
    up = record_motion(
        Record(
            "v", "text", None, 0.05, wave(40, 4.0)[::-1].copy(), None, "m/s2", "v", "v"
        )
    )
    motion, system = (
        with_vertical(MOTION, up, 1.5),
        Method(model, 1e-10).system_of(BLOCK),
    )
    amplitude, omega = np.array([1.2, 2.4]), np.array([1.0 / BLOCK.p])
    got, speed = response_with_speed(system, motion, amplitude, omega)
    plain, still = (
        response(system, ground, amplitude, omega) for ground in (motion, MOTION)
    )
    assert got.outcome.tolist() == plain.outcome.tolist()
    np.testing.assert_allclose(got.theta_ratio, plain.theta_ratio, rtol=0.0, atol=1e-10)
    assert (
        np.nanmax(np.abs(plain.theta_ratio - still.theta_ratio)) > 0.01
    )  # the vertical part matters here
    for a, found in zip(amplitude, speed, strict=True):
        _, rate = history(
            system, motion, float(a), float(omega[0]), BLOCK.eta, duration=20.0
        ).at(np.linspace(0.0, 20.0, 20_001))
        assert np.isnan(found) or np.nanmax(np.abs(rate)) == pytest.approx(
            found, rel=5e-3
        )
