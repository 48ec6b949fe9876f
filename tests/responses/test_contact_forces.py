"""Forces of a rigid body on the ground, against closed forms, the balance of momentum,
and an integration of another kind.
"""

import math
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from oracles.ground_forces import asked, shenton
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar
from support.bodies import KINDS, forces_of, random_body, random_shaking, shaking_of
from support.documents import built
from support.synthetic_records import motion_of_samples

from rocking_cli import (
    Method,
    Motion,
    Outcome,
    UsageError,
    cosine,
    parse_grid,
    pulse,
    read_record,
    response,
    sine,
    time_history,
)
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.grid import as_recorded
from rocking_cli.responses.ground_forces import Forces

BLOCK = "kind: block\nwidth: 0.6\nheight: 3\n"
STATUE = "kind: rigid\nleft: 0.6\nright: 0.4\nheight: 2.0\ngyration: 0.9\n"
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def ground_forces(forces, tau):
    return Forces(*forces.columns(tau).values())


def answer(text, motion=None, grid=None, model="nonlinear", **more):
    body = built(text)
    found = time_history(
        body,
        motion,
        None if grid is None else parse_grid(grid),
        [Method(model, 1e-12)],
        **more,
    )
    return body, found, found.forces[model]


@pytest.mark.parametrize(
    ("alpha", "least", "friction"),
    [(0.2, 0.9413877617, 0.1488772676), (0.4, 0.7783086828, 0.2869880979)],
)
def test_free_release_has_the_extremes_of_its_energy(alpha, least, friction):
    """u'^2 = 2 [cos(alpha - u0) - cos(alpha - u)], u'' = -sin(alpha - u): forces as
    functions of u alone.
    """
    body, found, _ = answer(f"kind: block\nradius: 2\nalpha: {alpha}", release=0.9)
    impact = next(
        e.tau for e in found.histories["nonlinear"].events if e.event == "impact"
    )
    first_swing = time_history(
        body,
        None,
        None,
        [Method("nonlinear", 1e-12)],
        release=0.9,
        duration=impact * (1 - 1e-15) / body.p,
    )
    asked = first_swing.forces["nonlinear"].extremes

    def at(u):
        square, acceleration = (
            2 * (math.cos(0.1 * alpha) - math.cos(alpha - u)),
            -math.sin(alpha - u),
        )
        fx = 0.75 * (acceleration * math.cos(alpha - u) + square * math.sin(alpha - u))
        return fx, 1.0 + 0.75 * (
            acceleration * math.sin(alpha - u) - square * math.cos(alpha - u)
        )

    lowest = minimize_scalar(
        lambda u: at(u)[1],
        bounds=(0, 0.9 * alpha),
        method="bounded",
        options={"xatol": 1e-12},
    )
    worst = minimize_scalar(
        lambda u: -abs(at(u)[0]) / at(u)[1],
        bounds=(0, 0.9 * alpha),
        method="bounded",
        options={"xatol": 1e-12},
    )
    fx, fz = at(0.0)
    wanted = min(lowest.fun, fz), max(-worst.fun, abs(fx) / fz)
    assert (asked.fz_min, asked.friction.friction) == pytest.approx(wanted, abs=1e-11)
    assert (asked.fz_min, asked.friction.friction) == pytest.approx(
        (least, friction), abs=1e-10
    )


@pytest.mark.parametrize("a", [0.21, 0.3, 0.8])
def test_a_jump_beyond_uplift_asks_for_shentons_friction(a):
    _, _, forces = answer(BLOCK, pulse("rectangular"), f"a_g={a}g,T_g=0.2")
    assert forces.extremes.lifting.friction == pytest.approx(shenton(a, 5.0), rel=1e-12)
    assert forces.extremes.slides(shenton(a, 5.0) * (1 - 1e-9)) == "before rocking"
    assert forces.extremes.resting is None or forces.extremes.resting.friction <= 0.2


def test_a_smooth_drive_asks_for_tan_alpha_when_it_lifts():
    assert shenton(0.2, 5.0) == pytest.approx(0.2, rel=1e-14)
    body, found, forces = answer(BLOCK, sine(1), "a_g=0.4g,f_g=2")
    assert found.histories["nonlinear"].events[0].tau / body.p == pytest.approx(
        math.asin(0.5) / (4 * math.pi), rel=1e-12
    )
    assert forces.extremes.resting.friction == pytest.approx(0.2, rel=1e-12)
    assert forces.extremes.lifting.friction == pytest.approx(0.2, rel=1e-12)
    _, found, still = answer(BLOCK, sine(1), "a_g=0.1g,f_g=2", model="linear")
    assert still.extremes.friction.friction == pytest.approx(0.1, rel=1e-14)
    assert (still.extremes.fz_min, still.extremes.rocking, still.extremes.impact) == (
        1.0,
        None,
        None,
    )
    assert next(found.summaries(forces=True))["theta_ratio"] == 0.0


def velocity(found, forces, tau):
    """Of the mass centre relative to the ground over g/p, by tau of the history."""
    ratio, rate = found.at(np.array([tau]))
    side = float(found.sides(np.array([tau]))[0])
    edge = forces.statics[side]
    u, w = edge.alpha * abs(float(ratio[0])), edge.alpha * side * float(rate[0])
    scale = edge.kappa * (forces.structure.p / edge.p) ** 2 * w
    return scale * side * math.cos(edge.alpha - u), scale * math.sin(edge.alpha - u)


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize(
    ("text", "grid"),
    [
        (BLOCK, "a_g=0.45g,f_g=2.5"),
        (BLOCK + "damping: 0.04\n", "a_g=0.45g,f_g=2.5"),
        (STATUE, "a_g=0.5g,f_g=2.5"),
    ],
    ids=["block", "damped", "unequal"],
)
def test_the_impulse_of_the_ground_is_the_change_of_momentum(text, grid, model):
    """int F dt over arcs and rests and the impulses at impacts, against the velocity of
    the mass centre and of the ground.
    """
    _, found, forces = answer(text, sine(1), grid, model=model, duration=3.0)
    history, ground = found.histories[model], forces.ground
    total = np.zeros(2)
    marks = np.unique(
        np.concatenate([history.steps(), ground.stops[ground.stops < history.end]])
    )
    for a, b in pairwise(marks):
        at = ground_forces(forces, 0.5 * (a + b) + 0.5 * (b - a) * NODES)
        total += 0.5 * (b - a) * np.array([WEIGHTS @ at.fx, WEIGHTS @ (at.fz - 1.0)])
    impacts = [forces.impulses(e) for e in history.events if e.event == "impact"]
    assert len(impacts) > 3
    total += np.sum([(j.fx, j.fz) for j in impacts], axis=0)
    moved = np.array(velocity(history, forces, history.end))
    a_g, omega = ground.amplitude, ground.omega
    end = min(history.end, 2 * math.pi / omega)
    moved[0] += a_g * (1 - math.cos(omega * end)) / omega
    assert total == pytest.approx(moved, abs=1e-9)


def test_forces_are_those_of_an_integration_of_another_kind():
    """DOP853 from uplift to the first impact; forces from differences of the momentum
    that it finds.
    """
    structure, found, forces = answer(BLOCK, sine(1), "a_g=0.45g,f_g=1.5")
    uplift, impact = (
        next(e.tau for e in found.histories["nonlinear"].events if e.event == word)
        for word in ("uplift", "impact")
    )
    g, p, alpha, arm, omega = (
        9.81,
        structure.p,
        structure.alpha,
        math.hypot(0.3, 1.5),
        3 * math.pi,
    )

    def push(t):
        return 0.45 * math.sin(omega * t)

    def rate(t, state):  # |theta| on the left edge: a positive push lifts it
        z = alpha - state[0]
        return [state[1], p * p * (-math.sin(z) + push(t) * math.cos(z))]

    path = solve_ivp(
        rate,
        (uplift / p, impact / p),
        [0.0, 0.0],
        method="DOP853",
        rtol=1e-13,
        atol=1e-15,
        max_step=1e-3,
        dense_output=True,
    )

    def momentum(t):
        u, w = path.sol(t)
        return np.array([-arm * w * np.cos(alpha - u), arm * w * np.sin(alpha - u)])

    times = np.linspace(uplift / p + 0.01, impact / p - 0.01, 7)
    h = 2e-3
    change = (
        8 * (momentum(times + h) - momentum(times - h))
        - (momentum(times + 2 * h) - momentum(times - 2 * h))
    ) / (12 * h * g)
    fx, fz = ground_forces(forces, times * p)
    assert fx == pytest.approx(change[0] + [push(t) for t in times], abs=1e-8)
    assert fz == pytest.approx(change[1] + 1.0, abs=1e-8)


def test_extremes_are_no_samples():
    """The demand and the least Fz lie beyond every one of 20,000 samples, by no more
    than those are apart.
    """
    _, found, forces = answer(BLOCK, sine(1), "a_g=0.45g,f_g=2.5")
    at = ground_forces(forces, np.linspace(0.0, found.end, 20_001))
    asked = forces.extremes
    assert 0.0 <= np.nanmin(at.fz) - asked.fz_min < 1e-5
    assert 0.0 <= asked.friction.friction - np.nanmax(np.abs(at.fx) / at.fz) < 1e-3


def test_an_impact_of_a_block_asks_for_less_than_its_slenderness():
    """(1 - eta)/((1 + eta) tan(alpha)), eta = 1 - 3/2 sin^2(alpha)."""
    structure, _, forces = answer(BLOCK, release=0.5)
    ratio = (1 - structure.eta) / (1 + structure.eta) / 0.2
    assert forces.extremes.impact.friction == pytest.approx(ratio, rel=1e-12)
    assert forces.extremes.slides(0.5 * ratio) == "rocking"


def test_a_backing_bears_what_nobody_knows():
    _, _, forces = answer(
        BLOCK + "one_sided: true\n", sine(1).scaled(-1), "a_g=0.4g,f_g=2"
    )
    assert forces.extremes.impact is None
    assert forces.extremes.rocking.friction > 0.0


@pytest.mark.parametrize(
    "text",
    [
        "kind: frame\ncolumns: 2\nwidth: 1\nheight: 6\ncap_ratio: 0.5\n",
        "kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\na_scale: 1\n",
    ],
)
def test_what_is_not_one_rigid_body_has_no_forces(text):
    with pytest.raises(UsageError, match="a single rigid body, and `arm`"):
        answer(text, release=0.5)


@pytest.mark.parametrize(
    "scale", [0.3, 0.52]
)  # at rest throughout, rocking and at rest again
def test_what_lines_ask_of_a_body_at_rest_is_what_each_of_them_asks(scale):
    record = read_record("configs/motions/synthetic.at2")
    peak = int(np.abs(record.acceleration).argmax())
    lines = motion_of_samples(
        scale * record.acceleration[peak - 100 : peak + 200], record.dt
    )
    shaking, pieces = as_recorded(lines.acceleration), Motion(lines.name, lines.pieces)
    histories = [
        time_history(built(BLOCK), motion, shaking, [Method("linear")])
        for motion in (lines, pieces)
    ]
    found, wanted = (one.forces["linear"].extremes for one in histories)
    assert found == wanted
    assert (found.rocking is not None) == (scale > 0.4)


def test_contact_is_lost_at_the_first_instant_without_force_with_a_free_fall_ahead():
    """Against an integration that stops where its own Fz is 0: -u'' = sin(alpha - u) (1
    + zg''/g) + s xg''/g cos(alpha - u).
    """
    motion = with_vertical(cosine(2), sine(3), 1.3)
    body, found, _ = answer(
        "kind: block\nwidth: 0.7\nheight: 1.6\nrestitution: 0.8",
        motion,
        "a_g=0.8g,f_g=1",
    )
    history = found.histories["nonlinear"]
    *_, last = found.events(dimensionless=True)
    omega, a, up = found.omega, 0.8, 1.3 * 0.8
    assert (last["event"], history.events[-1].event) == ("lost contact", "lost contact")
    assert up * math.sin(omega * history.end) == pytest.approx(-1.0, abs=1e-9)
    side = float(history.sides(last["tau"]))
    lifts = max(
        e.tau
        for e in history.events
        if e.event in ("uplift", "impact") and e.tau < last["tau"]
    )
    u, rate = (
        abs(float(x[0])) * body.alpha for x in history.at(np.array([lifts + 1e-9]))
    )

    def acceleration(t, u):
        z = body.alpha - u
        return -math.sin(z) * (1.0 + up * math.sin(omega * t)) - side * a * math.cos(
            omega * t
        ) * math.cos(z)

    def fz(t, y):
        z = body.alpha - y[0]
        return (
            1.0
            + up * math.sin(omega * t)
            + 0.75 * (acceleration(t, y[0]) * math.sin(z) - y[1] * y[1] * math.cos(z))
        )

    fz.terminal = True
    solved = solve_ivp(
        lambda t, y: (y[1], acceleration(t, y[0])),
        (lifts + 1e-9, history.end),
        (u, rate),
        events=fz,
        rtol=1e-12,
        atol=1e-14,
    )
    assert solved.t_events[0][0] == pytest.approx(last["tau"], abs=1e-8)
    assert last["tau"] < history.end - 1e-2


@pytest.mark.parametrize(
    ("text", "grid"),
    [
        ("kind: block\nwidth: 0.5\nheight: 2\n", "a_g=0.35g,f_g=1.5"),
        (STATUE, "a_g=0.6g,f_g=1.2"),
    ],
)
def test_the_forces_just_after_an_impact_are_those_of_the_rows_after_it(text, grid):
    """The time of an impact and the end of its arc may differ in the last bit."""
    _, found, forces = answer(text, sine(1), grid)
    impacts = [
        e.tau for e in found.histories["nonlinear"].events if e.event == "impact"
    ]
    for tau in impacts[:20]:
        (before, after), near = (
            forces.around(tau),
            ground_forces(forces, np.array([tau - 1e-9, tau, tau + 1e-9])),
        )
        assert before == pytest.approx((near.fx[0], near.fz[0]), abs=1e-7)
        assert after == pytest.approx((near.fx[2], near.fz[2]), abs=1e-7)
        assert after == pytest.approx((near.fx[1], near.fz[1]), abs=1e-13)


@pytest.mark.parametrize(
    ("kind", "vertical", "count", "angles", "recorded"),
    [
        *((kind, 0.4, 2, (0.2, 0.8), False) for kind in KINDS),
        *(
            pytest.param(kind, vertical, *rest, marks=pytest.mark.soak)
            for kind in KINDS
            for vertical in (0.0, 0.4)
            for rest in (
                (60, (0.1, 0.7), False),
                (15, (0.6, 1.2), False),
                (5, (0.1, 0.5), True),
            )
        ),
    ],
)
def test_forces_are_those_of_an_integration_by_another_hand_which_loses_the_same_bodies(
    kind, vertical, count, angles, recorded
):
    random, seen = np.random.default_rng(5), Counter()
    while seen.total() < count:
        body, solved, arm = random_body(kind, random, angles, (0.4, 0.85), 0.3)
        motion, *cell = random_shaking(random, body, (vertical,), (0.9, 4.0), recorded)
        method, where = (
            Method("nonlinear" if solved.nonlinear else "linear", 1e-11),
            (kind, motion.name, *cell),
        )
        outcome = Outcome(
            int(response(method.system_of(body), motion, *cell, body.eta).outcome)
        )
        if outcome.overturned:
            continue
        ground = shaking_of(body, motion, *cell)
        there = asked(solved, arm, ground)
        assert (outcome == Outcome.LOST_CONTACT) == (there.fz_min <= 0.0), where
        seen[outcome] += 1
        if (
            ground.at(np.linspace(0.0, ground.end, 10_000))[1].min() > -body.gravity
        ):  # the ground does not fall away
            found = forces_of(body, motion, *cell, method)
            assert there.answer.outcome in ("rocked", "no_uplift")
            assert found.friction.friction == pytest.approx(there.friction, abs=1e-6), (
                where
            )
            assert found.fz_min == pytest.approx(there.fz_min, abs=1e-6), where
    assert count < 60 or seen[Outcome.ROCKED] > 5
    assert count != 15 or seen[Outcome.LOST_CONTACT] > 0  # the stocky ones


@pytest.mark.soak
def test_bounces_that_a_history_does_not_show_press_less_than_a_body_at_rest():
    """Just above uplift the force falls until the last of them; an integration by
    DOP853 follows 318 to 1e-8 of the speed.
    """
    found = forces_of(
        built(BLOCK), sine(1), 1.02779675372563, 4.887328366201234, Method("linear")
    )
    assert found.fz_min == pytest.approx(0.94759598, abs=2e-7)


@pytest.mark.parametrize(
    ("across", "up"),
    [
        ("sine", "mavroeidis-papageorgiou"),
        ("rectangular-impulse", "rectangular-impulse"),
    ],
)
def test_forces_of_a_body_far_gone_before_the_ground_falls_away_are_not_searched(
    across, up
):
    """Linear, it goes to 1e9 rad, where its forces oscillate a billion times."""
    motion, grid = (
        with_vertical(pulse(across), pulse(up), 0.7),
        parse_grid("a_g=3g,f_g=0.3"),
    )
    found = time_history(
        built("kind: block\nwidth: 0.1\nheight: 0.4\n"), motion, grid, [Method()]
    )
    assert found.outcome("linear").overturned
    assert found.forces["linear"].extremes.fz_min < 1.0
