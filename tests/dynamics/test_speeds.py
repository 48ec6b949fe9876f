"""The largest angular speed, against an integration that shares no code and against energy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from recorded import wave
from scipy.integrate import solve_ivp
from written import built

from rocking_cli import Method, Outcome, response
from rocking_cli.dynamics.speeds import SpeedRun, response_with_speed
from rocking_cli.motions.polyline import record_motion
from rocking_cli.motions.records import Record

ALPHA, ETA = 0.25, 0.85
BLOCK = built(f"kind: block\nradius: 1.5 m\nalpha: {ALPHA}\nrestitution: {ETA}")
MOTION = record_motion(Record("a", "text", None, 0.05, wave(40, 3.0), None, "m/s2", "a", "a"))


def fastest(model: str, damping: float, amplitude: float, omega: float) -> float:
    """max |theta'|/alpha by DOP853 from uplift to impact, on a fine grid of its own steps; omega, the time in 1/p: tau = t/omega."""
    end, side, y, v, tau, best = MOTION.duration / omega, 0, 0.0, 0.0, 0.0, 0.0

    def drive(t: float) -> float:
        return float(amplitude * MOTION.value(min(omega * t, MOTION.duration + 1.0)))

    def acceleration(t: float, x: float, side: int) -> float:
        if model == "linear":
            return x - 1.0 - side * drive(t)
        return -(math.sin(ALPHA * (1.0 - x)) + side * ALPHA * drive(t) * math.cos(ALPHA * (1.0 - x))) / ALPHA

    least = 1.0 if model == "linear" else math.tan(ALPHA) / ALPHA
    grid = np.linspace(0.0, end, 200_001)
    while tau < end + 6.0:
        if side == 0:
            ahead = grid[(grid >= tau) & (np.abs(amplitude * MOTION.value(omega * grid)) > least)]
            if not ahead.size:
                return best
            tau, y, v = float(ahead[0]), 0.0, 0.0
            side = -int(np.sign(drive(tau)))
        done = solve_ivp(
            lambda t, z, on: [z[1], acceleration(t, z[0], on) - 2.0 * damping * z[1]], (tau, end + 6.0), [y, v], args=(side,),
            method="DOP853", rtol=1e-10, atol=1e-12, max_step=0.01, events=landing, dense_output=True,
        )  # fmt: skip
        stop = float(done.t[-1])
        assert done.y[0].max() < 1.0 or stop < end + 6.0
        best = max(best, float(np.abs(done.sol(np.linspace(tau, stop, 20_001))[1]).max()))
        tau, y, v, side = stop, 0.0, -ETA * float(done.y[1, -1]), -side
        if v < 1e-7:
            side = 0
    return best


def landing(t, z, on):
    return z[0] if z[0] > 1e-9 or z[1] < 0.0 else 1.0


landing.terminal = True
landing.direction = -1.0


@pytest.mark.parametrize(("model", "damping"), [pytest.param("linear", 0.0, marks=pytest.mark.soak), ("nonlinear", 0.05)])
def test_the_largest_speed_by_another_integration(model, damping):
    system = Method(model).system_of(replace(BLOCK, damping=damping))
    amplitude, omega = np.array([1.6]), np.array([0.8])
    found, speed = response_with_speed(system, MOTION, amplitude, omega, ETA)
    plain = response(system, MOTION, amplitude, omega, ETA)
    assert np.array_equal(found.outcome, plain.outcome)
    np.testing.assert_allclose(found.theta_ratio, plain.theta_ratio, rtol=1e-12, atol=0)  # jumps are cut where a speed may hide
    assert set(found.outcome) == {Outcome.ROCKED}
    assert speed == pytest.approx([fastest(model, damping, a, w) for a, w in zip(amplitude, omega, strict=True)], rel=2e-6)


@pytest.mark.parametrize(("model", "damping"), [("linear", 0.0), ("nonlinear", 0.0), ("linear", 0.1), ("nonlinear", 0.02)])
def test_the_largest_speed_is_the_same_flown_or_walked_and_marched(model, damping):
    random = np.random.default_rng(11)
    amplitude, omega, eta = random.uniform(1.2, 6.0, 40), np.exp(random.uniform(-2.0, 0.5, 40)), np.full(40, 0.7)
    system = Method(model).system_of(replace(BLOCK, damping=damping))
    marched = SpeedRun(system, MOTION, amplitude, omega, eta)
    marched.all()
    found, speed = response_with_speed(system, MOTION, amplitude, omega, eta)
    rocks = found.outcome == Outcome.ROCKED
    assert rocks.sum() > 20
    np.testing.assert_array_equal(found.outcome, marched.outcome)
    np.testing.assert_allclose(speed[rocks], marched.fastest[rocks], rtol=1e-10 if model == "linear" else 1e-8)


def test_only_what_rocks_and_has_a_speed_has_one():
    system = Method().system_of(BLOCK)
    _, speed = response_with_speed(system, MOTION, np.array([0.5, 1.2, 900.0]), np.array(0.4), ETA)
    assert speed[0] == 0.0
    assert 0.0 < speed[1] < math.inf
    assert math.isnan(speed[2])
    leaning = built("kind: rigid\nleft: 0.2\nright: 0.3\nheight: 1\ngyration: 0.6")
    assert np.isnan(response_with_speed(Method().system_of(leaning), MOTION, np.array([1.2]), np.array([0.4]), leaning.eta)[1]).all()


def test_a_step_throws_a_body_that_falls_back_as_its_energy_says():
    """Uplift by a short strong drive and then still ground: v at the next impact, and E = v^2 + y (2 - y), are the speed."""
    short = record_motion(Record("s", "text", None, 0.1, np.array([0.0, -1.0, 0.0]), None, "m/s2", "s", "s"))
    amplitude, omega = 1.8, 0.3
    _, speed = response_with_speed(Method().system_of(BLOCK), short, np.array([amplitude]), np.array([omega]), ETA)
    # y'' = y - 1 + a, a = A t/h up to h and back to 0 at 2h: from uplift at a = 1 the sum of two ramps
    h = 0.1 / omega
    rate, lift, end = amplitude / h, h / amplitude, 2.0 * h
    t = np.linspace(lift, end, 100_001)
    after = np.maximum(t - h, 0.0)
    y = rate * (np.sinh(t - lift) - (t - lift)) - 2.0 * rate * (np.sinh(after) - after)
    v = rate * (np.cosh(t - lift) - 1.0) - 2.0 * rate * (np.cosh(after) - 1.0)
    assert y[1:].min() > 0.0 > y[-1] + v[-1] - 1.0, "it neither lands before the end nor overturns after it"
    at_ground = math.sqrt(v[-1] ** 2 + y[-1] * (2.0 - y[-1]))
    assert speed[0] == pytest.approx(max(float(v.max()), at_ground), rel=1e-8)
