"""Responses in time: against closed forms and an independent integration, and against
the engine's own peaks.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.documents import built
from support.refusals import refuses

from rocking_cli import (
    LinearEquation,
    MechanismEquation,
    Method,
    Outcome,
    RigidBodyEquation,
    cosine,
    parse_grid,
    pulse,
    response,
    sine,
)
from rocking_cli.dynamics.system import System
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.responses.history import history

ARCH = built("kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\nvoussoirs: 7")
EQUATIONS = {
    "linear": LinearEquation(),
    "rigid body": RigidBodyEquation(0.3, 1e-11),
    "arch": MechanismEquation(ARCH.mechanism, 1e-10),
}
MODELS = {name: System(equation) for name, equation in EQUATIONS.items()}
every_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
ACROSS = [sine(), pulse("mavroeidis-papageorgiou")]


def test_linear_history_is_the_equation_in_si_units():
    """Eq. 2.4 with p, alpha, a_g in SI units by DOP853, through uplift
    and one impact.
    """
    p, alpha, eta, a_g, w = 2.1, 0.22, 0.85, 3.0, 9.0
    scale = a_g / (alpha * 9.81)

    def rate(t, z, side):
        ground = a_g * math.sin(w * t) if t * w < math.pi else 0.0
        return [z[1], p * p * (z[0] - alpha * side - ground / 9.81)]

    def ground(t, z, side):
        return z[0]

    ground.terminal, ground.direction = True, 1
    lift, close = (
        math.asin(1 / scale) / w,
        {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15},
    )
    first = solve_ivp(
        rate, (lift, math.pi / w), [0.0, 0.0], args=(-1,), max_step=0.01, **close
    )
    fall = solve_ivp(
        rate,
        (math.pi / w, 5.0),
        first.y[:, -1],
        args=(-1,),
        events=ground,
        max_step=0.01,
        **close,
    )
    strike = fall.t_events[0][0]
    second = solve_ivp(
        rate,
        (strike, strike + 0.1),
        [0.0, eta * fall.y_events[0][0][1]],
        args=(1,),
        max_step=0.01,
        **close,
    )
    found = history(
        System(LinearEquation()), pulse("half-sine"), scale, w / p, eta, duration=20.0
    )
    events = {m.event: m.tau / p for m in reversed(found.events)}
    assert (events["uplift"], events["impact"]) == pytest.approx(
        (lift, strike), abs=1e-9
    )
    ratio, speed = found.at(np.array([0.6 * strike, strike + 0.1]) * p)
    middle = solve_ivp(
        rate,
        (lift, math.pi / w),
        [0.0, 0.0],
        args=(-1,),
        t_eval=[0.6 * strike],
        max_step=0.01,
        **close,
    )
    assert ratio * alpha == pytest.approx([middle.y[0, 0], second.y[0, -1]], abs=1e-9)
    assert speed * alpha * p == pytest.approx(
        [middle.y[1, 0], second.y[1, -1]], abs=1e-8
    )


@pytest.mark.parametrize("motion", ACROSS, ids=lambda m: m.name)
def test_the_history_of_an_arch_comes_to_what_the_engine_says(motion):
    """Of other systems in `test_conformance.py`."""
    model = MODELS["arch"]
    random = np.random.default_rng(4)
    rocked = 0
    for _ in range(20):
        cell = random.uniform(0.9, 2.5), random.uniform(6, 14), random.uniform(0.3, 0.9)
        expected = response(model, motion, *cell)
        found = history(model, motion, *cell, duration=motion.duration / cell[1] + 40.0)
        assert found.outcome == int(expected.outcome)
        if found.peak is not None:
            rocked += 1
            assert abs(found.peak.theta_ratio) == pytest.approx(
                float(expected.theta_ratio), abs=1e-11
            )
            times = np.linspace(0.0, found.end, 4001)
            assert (
                np.abs(found.at(times)[0]).max() <= abs(found.peak.theta_ratio) + 1e-12
            )
            assert found.at(np.array([found.peak.tau]))[0][0] == pytest.approx(
                found.peak.theta_ratio, abs=1e-12
            )
        if rocked == 2:
            break
    assert rocked == 2


@pytest.mark.requirement(
    "Between impacts energy is kept, and each impact multiplies the speed by eta",
    "dynamics/contacts/contact.py",
    "Free rocking of a block released at 0.8 alpha",
)
@every_model
def test_impacts_lose_speed_and_rest_is_the_end(model):
    found = history(model, sine(), 1.6, 5.0, 0.6, duration=200.0)
    impacts = [m for m in found.events if m.event == "impact"]
    assert found.events[-1].event == "rest"
    free = [abs(m.rate) for m in impacts if m.tau > 2 * math.pi / 5.0]
    assert len(free) > 5
    # On still ground an arc gives back its speed, so each impact is eta times the one
    # before.
    assert [b / a for a, b in pairwise(free[1:])] == pytest.approx(
        [0.6] * (len(free) - 2), abs=1e-6
    )
    # The rests of a geometric series: the last arcs take 2 v/(1 - eta) in all.
    assert found.events[-1].tau - impacts[-1].tau == pytest.approx(
        2 * 0.6 * free[-1] / 0.4 / float(model.equation.rotation_rate(0.0, 1.0)),
        rel=1e-3,
        abs=0,
    )
    assert not found.at(np.array([found.events[-1].tau + 0.1, found.end]))[0].any()


USUAL = {"amplitude": 2.0, "omega": 3.0, "eta": 0.9, "duration": 5.0}
BAD = [
    {"amplitude": -1.0},
    {"omega": 0.0},
    {"omega": math.nan},
    {"eta": 1.1},
    {"release": 1.0},
    {"duration": 0.0},
]
test_numbers_out_of_range_are_refused = refuses(
    lambda bad: history(System(LinearEquation()), sine(), **USUAL | bad),
    ValueError,
    [(bad, r"expected|must") for bad in BAD],
)


def test_a_body_past_its_limit_has_overturned_even_if_it_turns_back_within_the_step():
    cell = (17.628431883129675, 3.9264169916137712, 0.5)
    found = history(System(RigidBodyEquation(1.2)), cosine(1), *cell, duration=30.0)
    assert (
        found.outcome
        == int(response(System(RigidBodyEquation(1.2)), cosine(1), *cell).outcome)
        == Outcome.OVERTURNED_AFTER_IMPACT
    )
    assert found.events[-1].event == "overturning"
    assert [m.tau for m in found.events] == sorted(m.tau for m in found.events)


def test_the_last_row_of_an_overturning_history_is_where_it_ends():
    found = history(
        System(MechanismEquation(ARCH.mechanism)),
        sine(),
        3.283,
        2.547,
        ARCH.eta,
        duration=30.0,
    )
    assert found.at(np.array([found.end]))[0][0] == pytest.approx(
        found.events[-1].theta_ratio, rel=1e-9, abs=0
    )


def test_a_body_that_falls_after_the_shaking_falls_whatever_is_followed_of_it():
    """The arch of Fig. 7 under 0.44 s of 1 g: on its way down when the shaking ends,
    long before it is 3 alpha away.
    """
    amplitude, omega = (
        float(ARCH.dimensionless_amplitude(9.81)),
        2 * math.pi / 0.44 / ARCH.p,
    )
    motion, system = pulse("rectangular-impulse"), System(LinearEquation())
    shaking = motion.duration / omega
    whole = history(system, motion, amplitude, omega, ARCH.eta, duration=shaking + 30.0)
    (fall,) = [e for e in whole.events if e.event == "overturning"]
    # Above the unstable equilibrium still ground makes y - 1 a sum of exp(tau) and
    # exp(-tau).
    ratio, rate = (float(x[0]) for x in whole.at(np.array([shaking])))
    y, v = abs(ratio), math.copysign(1.0, ratio) * rate
    grow, decay = 0.5 * (y - 1 + v), 0.5 * (y - 1 - v)
    rest = math.log(
        (2.0 + math.sqrt(4.0 - 4.0 * grow * decay)) / (2.0 * grow)
    )  # grow e^t + decay e^-t = 2
    assert fall.tau == pytest.approx(shaking + rest, rel=1e-9, abs=0)
    for duration in (shaking + 0.5, shaking + rest + 1.0, shaking + 20.0):
        found = history(system, motion, amplitude, omega, ARCH.eta, duration=duration)
        assert found.outcome == whole.outcome == Outcome.OVERTURNED_NO_IMPACT
        assert found.end == pytest.approx(min(duration, fall.tau), rel=1e-9, abs=0)


@pytest.mark.parametrize("more", ["", "damping: 0.05"])
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize(
    "motion", [cosine(4), with_vertical(cosine(4), sine(5), 0.5)], ids=["across", "up"]
)
def test_a_body_that_falls_is_followed_to_3_alpha(more, model, motion):
    """Nor further where it is certain only later that it falls: it has passed 3 alpha
    for the last time.
    """
    body = built(f"kind: block\nwidth: 0.4\nheight: 3\n{more}")
    for a in np.linspace(0.3, 1.5, 6):
        amplitude, omega = (
            float(x[0]) for x in parse_grid(f"a_g={a}g,f_g=0.8").scaled(body)
        )
        found = history(
            Method(model, 1e-9).system_of(body),
            motion,
            amplitude,
            omega,
            body.eta,
            duration=40.0,
        )
        last = found.events[-1]
        assert (last.event, abs(last.theta_ratio)) == (
            "overturning",
            pytest.approx(3.0, rel=1e-9),
        )
        assert found.arcs.stop[-1] == found.end == last.tau
        assert np.isnan(found.at(np.array([found.end + 0.1]))[0]).all()
        assert np.array_equal(
            np.sort([e.tau for e in found.events]), [e.tau for e in found.events]
        )


def test_a_hardly_damped_body_that_is_still_rocking_at_the_end_has_an_outcome():
    block = built("kind: block\nwidth: 0.5\nheight: 2\nrestitution: 1\ndamping: 0.001")
    system, scene = Method("nonlinear").system_of(block), (1.4, 3.5, block.eta)
    found, plain = (
        history(system, sine(), *scene, duration=40.0),
        response(system, sine(), *scene),
    )
    assert found.outcome == plain.outcome == Outcome.ROCKED
    assert found.theta_ratio == pytest.approx(float(plain.theta_ratio), rel=1e-8)
