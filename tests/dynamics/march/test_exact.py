"""Steps along exact flows: their turns, their roots, and the march on them against the
march on Taylor series.
"""

import numpy as np
import pytest
from support.bodies import OnSeries

from rocking_cli import LinearEquation, System, cosine, pulse, response, sine
from rocking_cli.dynamics.equations.linear_flow import LinearFlow
from rocking_cli.dynamics.equations.taylor import Instant
from rocking_cli.dynamics.lanes import Lanes
from rocking_cli.dynamics.march.exact import exact_step, impact_guess, peak_guess, root


def lanes_of(random, segments, count):
    """Lanes in the air anywhere in a motion."""
    k = random.integers(len(segments), size=count)
    still = random.random(count) < 0.1
    return Lanes(
        cell=np.arange(count),
        amplitude=10.0 ** random.uniform(-0.5, 1.0, count),
        omega=10.0 ** random.uniform(-1.0, 1.0, count),
        eta=np.full(count, 0.9),
        segment=k,
        phase=random.uniform(0.0, 1.0, count) * segments.length[k],
        side=random.choice([-1.0, 1.0], count),
        y=random.uniform(0.0, 1.0, count),
        v=np.where(still, 0.0, random.normal(0.0, 1.0, count)),
        force=np.full(count, np.nan),
        peak=np.zeros(count),
        impacts=np.zeros(count, dtype=np.int32),
        steps=np.zeros(count, dtype=np.int32),
        moments=np.zeros((4, count)),
    )


@pytest.mark.parametrize("motion", [sine(), cosine(2.5), pulse("half-sine")], ids=str)
def test_lemma_2_a_step_turns_once_at_most_and_every_turn_is_found(motion):
    random, segments = np.random.default_rng(7), motion.segments
    lanes = lanes_of(random, segments, 2000)
    arc = LinearFlow.of(segments, lanes)
    step = exact_step(arc, segments, lanes, np.inf)
    assert np.all(step.h > 0.0)
    parts = np.linspace(0.0, 1.0, 402)[1:-1]
    speeds = np.array([arc.at(part * step.h).v for part in parts])
    # speeds next to a turn, of the size of rounding, have no sign
    signs = np.where(np.abs(speeds) > 1e-12 * np.abs(speeds).max(axis=0), speeds, 0.0)
    for own, turns, outward in zip(signs.T, step.turns, step.outward, strict=True):
        own = own[own != 0.0] > 0.0
        changes = np.count_nonzero(own[1:] != own[:-1])
        assert changes <= turns
        assert own[0] == outward or changes < turns  # one before the first sample
    assert step.turns.sum() > 200

    at = np.flatnonzero(step.turns)
    own, h = arc.take(at), step.h[at]
    sense = np.where(step.outward[at], 1.0, -1.0)
    guess = peak_guess(own, Instant(*(x[at] for x in step.end)), h)
    when, y, _ = root(own, (0.0 * h, h), guess, sense)
    assert np.all((when >= 0.0) & (when <= h))
    before, after = (sense * own.at(np.minimum(when * x, h)).v for x in (0.999, 1.001))
    assert np.all(before >= -1e-12)
    assert np.all(after <= 1e-12)
    size = 1.0 + np.abs(own.v) * np.sinh(h) + np.abs(own.b) * np.cosh(h)
    assert np.all(np.abs(y - own.at(when).y) <= 1e-14 * size)


def test_an_impact_is_where_the_body_meets_the_ground():
    random, segments = np.random.default_rng(8), sine().segments
    lanes = lanes_of(random, segments, 4000)
    arc = LinearFlow.of(segments, lanes)
    step = exact_step(arc, segments, lanes, np.inf)
    at = np.flatnonzero((step.end.y <= 0.0) & ~step.turns & ~step.outward)
    assert at.size > 200
    own, h = arc.take(at), step.h[at]
    bracket = 0.0 * h, h
    guess = impact_guess(own, Instant(*(x[at] for x in step.end)), h, bracket)
    when, _, v = root(own, bracket, guess, None)
    assert np.all((when > 0.0) & (when <= h))
    found = own.at(when)
    size = 1.0 + np.abs(own.v) * np.sinh(when) + np.abs(own.b) * np.cosh(when)
    assert np.all(np.abs(found.y) <= 1e-14 * size)
    assert np.all(np.abs(v - found.v) <= 1e-13 * size)


@pytest.mark.parametrize("count", [600, pytest.param(6000, marks=pytest.mark.soak)])
@pytest.mark.parametrize("motion", [sine(3), pulse("half-sine")], ids=str)
def test_bodies_end_as_on_their_series(motion, count):
    random = np.random.default_rng(9)
    a = 10.0 ** random.uniform(-0.1, 1.2, count)
    omega = 10.0 ** random.uniform(-1.0, 1.2, count)
    eta = random.choice([0.0, 0.6, 0.95, 1.0], count)
    one, other = (
        response(System(equation), motion, a, omega, eta)
        for equation in (LinearEquation(), OnSeries())
    )
    np.testing.assert_array_equal(one.outcome, other.outcome)
    assert np.unique(one.outcome).size >= 3
    differences = np.abs(one.theta_ratio - other.theta_ratio)
    bound = 5e-13 * np.nan_to_num(one.condition + other.condition) + 1e-15
    assert np.all(np.isnan(differences) | (differences <= bound))
