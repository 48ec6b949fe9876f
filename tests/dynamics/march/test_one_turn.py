"""Within one step: bodies that turn back near the ground, one turn at most, and every
peak.
"""

import math

import numpy as np
import pytest
from support.bodies import OnSeries
from support.references import MIXED, lanes
from support.synthetic_records import RECORDS, motion_of_samples, weighed

from rocking_cli import LinearEquation, RigidBodyEquation, pulse, sine
from rocking_cli.dynamics.drive import drive_change
from rocking_cli.dynamics.march.one_turn import advance, one_turn_step
from rocking_cli.motions import Motion, Piece

EQUATIONS = [
    OnSeries(),
    LinearEquation(0.1),
    RigidBodyEquation(0.3),
    RigidBodyEquation(0.3, damping=0.1),
]
MOTIONS = {
    "sinusoids": sine(2),
    "many sinusoids": pulse("ricker-symmetric"),
    "sinusoids and a slope": MIXED,
    "lines": motion_of_samples(RECORDS[0], 0.3),
}


@pytest.mark.parametrize(
    "model",
    [LinearEquation(), RigidBodyEquation(0.25, 1e-13), RigidBodyEquation(0.6, 1e-13)],
    ids=["linear", "alpha-0.25", "alpha-0.6"],
)
def test_grazing_is_decided_on_either_side(model):
    """A constant push a > 1 turns a body back within 1e-6 ... 1e-12 of the ground, by
    v0^2/2 = G(y0) - G(y_min) with G' = y''.
    """
    push = Motion("push", (Piece(0.0, 60.0, (), 1.0),)).segments
    random = np.random.default_rng(6)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    for offset in np.geomspace(1e-6, 1e-12, 7):
        for _ in range(6):
            a, y0 = random.uniform(1.2, 4.0), random.uniform(0.02, 0.4)
            for least in (-offset, offset):
                spots = least + 0.5 * (y0 - least) * (nodes + 1.0)
                rise = (
                    0.5
                    * (y0 - least)
                    * float(weights @ model.force(spots, np.full(40, a)))
                )
                v0 = -math.sqrt(2 * rise)
                b = model.force(np.array([y0]), np.array([a]))
                body = lanes(amplitude=a, side=-1.0, y=y0, v=v0, force=b)
                for _ in range(40):
                    event = advance(push, body, model)
                    hit = bool(event.hit[0])
                    if hit or event.end.v[0] > 0.0:
                        break
                    body.phase, body.y, body.v, body.force = (
                        body.phase + event.reach,
                        event.end.y,
                        event.end.v,
                        event.end.b,
                    )
                assert hit == (least < 0.0), (offset, a, y0)
                if hit:  # the speed there, by the work from the lowest point
                    deep = -least * float(model.force(np.zeros(1), np.array([a]))[0])
                    assert -event.impact_v[0] == pytest.approx(
                        math.sqrt(2.0 * deep), rel=1e-5, abs=2e-7
                    )


def states(motion, equation, count, seed):
    """Random lanes in the air under a motion."""
    random, segments = np.random.default_rng(seed), motion.segments
    k = random.integers(0, len(segments), count)
    side = random.choice([-1.0, 1.0], count)
    u = segments.length[k] * random.uniform(0.0, 0.95, count)
    strongest = np.abs([segments.s_start, segments.s_end]).max()
    amplitude = random.uniform(0.3, 3.0, count) / strongest
    omega = random.uniform(0.3, 2.0, count)
    y, v = random.uniform(0.2, 1.4, count), random.uniform(-0.4, 0.4, count)
    v[:10] = 0.0
    s = segments.s_start[k] + drive_change(segments, k, u)
    return lanes(
        amplitude=amplitude,
        omega=omega,
        segment=k,
        phase=u,
        side=side,
        y=y,
        v=v,
        force=equation.force(y, -side * amplitude * s),
    )


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
@pytest.mark.parametrize("equation", EQUATIONS)
def test_a_step_turns_once_at_most_and_every_peak_is_found(equation, motion):
    """On a fine raster of the step y' changes its sign once at most, and where it falls
    through zero there is a peak; nowhere else.
    """
    count = 500
    segments, bodies = motion.segments, states(motion, equation, count, 21)
    result = advance(segments, bodies, equation)
    left = segments.left_of_piece(bodies.segment, bodies.phase) / bodies.omega
    h, _, turns = one_turn_step(result.arc, left)
    assert np.all((h <= left) & (h <= result.arc.longest))
    np.testing.assert_array_equal(result.reach[~result.hit], h[~result.hit])

    raster = np.linspace(0.0, 1.0, 401)[:, None] * h
    points = [result.arc.at(x) for x in raster]
    y, speed = (np.array([getattr(p, name) for p in points]) for name in ("y", "v"))
    scale = 1e-13 * (1.0 + np.abs(speed).max(axis=0))
    falls = (speed[:-1] > scale) & (speed[1:] < -scale)
    signs = np.where(np.abs(speed) > scale, np.sign(speed), 0.0)
    changes = [np.count_nonzero(np.diff(s[s != 0.0])) for s in signs.T]
    assert max(changes) == 1
    inside = np.abs(speed[-1]) > scale  # no turn at the very end
    np.testing.assert_array_equal(np.array(changes)[inside] == 1, turns.turns[inside])
    assert np.all(np.abs(speed).max(axis=0) * h <= turns.fastest * (1.0 + 1e-9))

    down = (signs.max(axis=0) > 0.0) & (speed[-1] < -scale)
    np.testing.assert_array_equal(down[inside], np.isfinite(result.top)[inside])
    peaks = np.flatnonzero(np.isfinite(result.top) & down)
    assert peaks.size > 5
    highest = y[:, peaks].max(axis=0)
    assert np.all(result.top[peaks] >= highest * (1.0 - 1e-14))
    slack = np.abs([p.b for p in points]).max(axis=0) * (h / 400.0) ** 2
    assert np.all(result.top[peaks] <= highest + slack[peaks])
    assert falls.sum() > 5


@pytest.mark.parametrize("equation", EQUATIONS)
def test_a_step_is_the_same_whatever_steps_are_beside_it(equation):
    for motion in (*MOTIONS.values(), weighed(slice(36, 52), 0.5, 2)[0]):
        segments = motion.segments
        bodies = states(motion, equation, 40, 5)
        whole = advance(segments, bodies, equation)
        for some in (np.array([7]), np.arange(40)[::-1], np.array([30, 3, 7])):
            part = advance(segments, bodies.take(some), equation)
            names = ("reach", "hit", "impact_v", "impact_force", "top", "fastest")
            for name in names:
                np.testing.assert_array_equal(
                    getattr(part, name), getattr(whole, name)[some], err_msg=name
                )
            for one, other in zip(part.end, whole.end, strict=True):
                np.testing.assert_array_equal(one, other[some])
