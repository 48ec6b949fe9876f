"""The oracle of unequal, one-sided and damped bodies itself, against closed forms and the oracle of the symmetric one."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.collocation import Answer, Body, Edge, conditioning, integrate
from support.references import integrated

from rocking_cli import cosine, pulse, sine

G = 9.81
RIGHT, LEFT = Edge(2.1, 0.25, 0.85), Edge(1.7, 0.15, 0.95)
UNEQUAL = Body(RIGHT, LEFT)


def constant(phase: np.ndarray) -> np.ndarray:
    return 1.0 + 0.0 * phase


def rectangular(body: Body, amplitude: float, duration: float) -> Answer:
    """Under a constant ground acceleration of A times the uplift's of the side that it pushes to, for duration/p."""
    side = -1 if amplitude > 0.0 else 1
    return integrate(body, constant, duration, amplitude * body.threshold(side), body.edge(side).p)


@pytest.mark.parametrize(
    ("motion", "amplitude", "omega", "eta", "theta"),  # by closed-form arcs in 50 digits, with steps that pass no event
    [
        (sine(2), 1.3, 2.5, 0.6, 0.3931897472731955),
        (cosine(1), 3.0, 6.0, 0.9, 0.2990185600153954),
        (pulse("ricker-antisymmetric"), 30.0, 25.0, 0.5, 0.05040777378125502),
        (pulse("rectangular-impulse"), 3.0, 30.0, 0.5, 0.08054332243517943),
    ],
)
def test_symmetric_bodies_have_the_rotations_of_fifty_digits(motion, amplitude, omega, eta, theta):
    assert integrated(motion, amplitude, omega, eta)[:2] == ("rocked", pytest.approx(theta, abs=1e-14))


# Overturning of the block alpha = 0.25, p = 2.14 rad/s, eta = 0.9 at Omega = 5 under one sine cycle, in a_g/(g tan alpha).
@pytest.mark.parametrize(
    ("boundary", "below", "above"),
    [
        (2.96890, "rocked", "overturned_after_impact"),
        (6.60195, "overturned_after_impact", "rocked"),
        (7.33624, "rocked", "overturned_no_impact"),
    ],
)
def test_nonlinear_block_of_the_literature(boundary, below, above):
    edge = Edge(2.14, 0.25, 0.9)
    body = Body(edge, edge, nonlinear=True)
    for factor, outcome in ((1 - 2e-6, below), (1 + 2e-6, above)):
        assert integrate(body, np.sin, 2 * math.pi, boundary * factor * G * math.tan(0.25), 5 * 2.14).outcome == outcome


@pytest.mark.parametrize("zeta", [0.0, 0.03, 0.4])
@pytest.mark.parametrize("duration", [0.5, 2.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_damped_overturning_under_a_rectangular_pulse(zeta, duration, sign):
    # From rest y'' + 2 zeta y' - y = A - 1 overturns when its growing mode, of rate r, does: A = 1/(1 - exp(-r T)).
    boundary = 1.0 / (1.0 - math.exp(-(math.hypot(1.0, zeta) - zeta) * duration))
    body = replace(UNEQUAL, damping=zeta)
    assert rectangular(body, sign * boundary * (1 - 1e-12), duration).outcome != "overturned_no_impact"
    assert rectangular(body, sign * boundary * (1 + 1e-12), duration) == ("overturned_no_impact", pytest.approx(math.nan, nan_ok=True), 0)


@pytest.mark.parametrize("sign", [1, -1])
def test_an_impact_picks_the_other_edge(sign):
    # Released at T = 0.6/p with energy below the barrier, it falls back and rises on the other edge: both crests are closed.
    first, other = (LEFT, RIGHT) if sign > 0 else (RIGHT, LEFT)
    x, v = 0.9 * (math.cosh(0.6) - 1.0), 0.9 * math.sinh(0.6)
    drop = v * v + x * (2.0 - x)
    rebound = drop * (first.eta * first.alpha * first.p / (other.alpha * other.p)) ** 2
    found = rectangular(UNEQUAL, sign * 1.9, 0.6)
    if rebound > 1.0:
        assert found.outcome == "overturned_after_impact"
    else:
        third = rebound * (other.eta * other.alpha * other.p / (first.alpha * first.p)) ** 2
        crests = [1.0 - math.sqrt(1.0 - e) for e in (drop, rebound, third)]
        assert found == ("rocked", pytest.approx(max(crests), abs=1e-13), 0)


def test_nonlinear_crests_of_both_edges():
    # H = (theta'/p)^2/2 + cos(alpha - theta) is constant on still ground.
    first, other = LEFT, RIGHT
    body = replace(UNEQUAL, nonlinear=True)
    push, duration = 1.5 * math.tan(first.alpha), 0.5
    # The pulse does the work push * (sin alpha - sin(alpha - theta)) on the way to where it ends.
    found = integrate(body, constant, duration, push * G, first.p)
    on_left = integrate(replace(body, right=replace(other, eta=0.0), left=replace(first, eta=0.0)), constant, duration, push * G, first.p)
    crest = on_left.rotation * first.alpha
    speed = first.p * math.sqrt(2.0 * (math.cos(first.alpha - crest) - math.cos(first.alpha))) * first.eta
    height = math.cos(other.alpha) + 0.5 * (speed / other.p) ** 2
    assert height < 1.0
    assert found.rotation == pytest.approx(max(on_left.rotation, (other.alpha - math.acos(height)) / other.alpha), abs=1e-12)


@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("cell", range(6))
def test_the_mirror_image_answers_alike(nonlinear, cell):
    random = np.random.default_rng(100 + cell)
    a_g, omega = random.uniform(1.0, 5.0) * 0.2 * G, random.uniform(2.0, 10.0)
    body = replace(UNEQUAL, nonlinear=nonlinear, damping=0.02)
    here = integrate(body, np.sin, 4 * math.pi, a_g, omega)
    there = integrate(replace(body, right=LEFT, left=RIGHT), np.sin, 4 * math.pi, -a_g, omega)
    assert (here.outcome, here.impacts) == (there.outcome, there.impacts)
    assert here.rotation == there.rotation or math.isnan(here.rotation)


def test_a_one_sided_body_waits_for_a_push_outwards():
    body = Body(replace(RIGHT, eta=-0.4), None)
    assert integrate(body, constant, 0.6, 1.9 * body.threshold(1), RIGHT.p) == ("no_uplift", 0.0, 0)
    assert rectangular(body, -1.9, 0.6) == ("rocked", pytest.approx(1.0 - math.sqrt(1.0 - _drop(0.9, 0.6)), abs=1e-13), 0)
    # Under a full sine it leaves in the second half, as the symmetric body does in the first of the mirrored motion.
    edge = replace(RIGHT, eta=0.0)
    late = integrate(replace(body, right=replace(RIGHT, eta=-0.0)), np.sin, 2 * math.pi, 2.5 * body.threshold(1), 9.0)
    half = integrate(Body(edge, edge), np.sin, math.pi, 2.5 * body.threshold(1), 9.0)
    assert late.rotation == pytest.approx(half.rotation, abs=1e-12)


def _drop(excess: float, duration: float) -> float:
    x, v = excess * (math.cosh(duration) - 1.0), excess * math.sinh(duration)
    return v * v + x * (2.0 - x)


def test_a_one_sided_body_comes_back_on_its_own_side():
    # After one bounce under the second pulse: the first half sine's bounce, then a crest on the same side.
    body = Body(replace(RIGHT, eta=-0.5), None)
    edge = replace(RIGHT, eta=0.5)
    pulses = (0.0, 0.6, 0.6 + 3.0)

    def s(phase):
        return np.where(phase < 0.6, -1.0, 0.0)

    one = integrate(body, s, pulses[-1], 1.9 * body.threshold(1), RIGHT.p, pulses)
    two = integrate(Body(edge, edge), s, pulses[-1], 1.9 * body.threshold(1), RIGHT.p, pulses)
    assert one.rotation == pytest.approx(two.rotation, abs=1e-13)
    assert one.impacts == two.impacts > 0


def test_conditioning_is_the_slope_of_the_answer():
    smooth = conditioning(UNEQUAL, np.sin, 2 * math.pi, 1.4 * UNEQUAL.threshold(-1), 9.0)
    slow = conditioning(UNEQUAL, np.sin, 2 * math.pi, 1.4 * UNEQUAL.threshold(-1), 9.0, delta=1e-6)
    assert 0.0 < smooth < 100.0
    assert smooth == pytest.approx(slow, rel=1e-3, abs=0)
    edge = UNEQUAL.left
    boundary = 1.0 / (1.0 - math.exp(-1.0)) * edge.alpha * G
    assert conditioning(UNEQUAL, constant, 1.0, boundary, edge.p) == math.inf
