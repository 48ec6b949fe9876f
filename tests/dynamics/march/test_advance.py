"""Within one step: windows of the drive, what is proved without a root search, and
bodies that turn back next to the ground.
"""

import math

import numpy as np
import pytest
from support.references import LADDER, MIXED, lanes

from rocking_cli import LinearEquation, RigidBodyEquation, cosine, pulse, sine
from rocking_cli.dynamics.drive import crossing, drive_change, place, segment_value
from rocking_cli.dynamics.march import advance
from rocking_cli.dynamics.march.advance import window_end
from rocking_cli.motions import Motion, Piece


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
        for _ in range(15):
            a, y0 = random.uniform(1.2, 4.0), random.uniform(0.02, 0.4)
            for least in (-offset, offset):
                spots = least + 0.5 * (y0 - least) * (nodes + 1.0)
                rise = (
                    0.5
                    * (y0 - least)
                    * float(weights @ model.force(spots, np.full(40, a)))
                )
                b = model.force(np.array([y0]), np.array([a]))
                body, hit = (
                    lanes(
                        amplitude=a, side=-1.0, y=y0, v=-math.sqrt(2 * rise), force=b
                    ),
                    False,
                )
                for _ in range(40):
                    event = advance.advance(push, body, model)
                    hit |= bool(event.hit[0])
                    if hit or event.end.v[0] > 0.0:
                        break
                    body.phase, body.y, body.v, body.force = (
                        event.step.phase,
                        event.end.y,
                        event.end.v,
                        event.end.b,
                    )
                assert hit == (least < 0.0), (offset, a, y0)


@pytest.mark.parametrize(
    "equation",
    [
        LinearEquation(),
        LinearEquation(0.1),
        RigidBodyEquation(0.3),
        RigidBodyEquation(0.3, damping=0.1),
    ],
)
def test_every_crest_of_a_step_is_found(equation):
    """Where y' falls through zero on a fine raster of the step there is one, also
    between ends of the same sign, and nowhere else.
    """
    random, count = np.random.default_rng(21), 2500
    segments = sine(2).segments
    k, side = (
        random.integers(0, len(segments), count),
        random.choice([-1.0, 1.0], count),
    )
    u = segments.length[k] * random.uniform(0.0, 0.95, count)
    amplitude, omega = random.uniform(0.3, 3.0, count), random.uniform(0.3, 2.0, count)
    y, v = random.uniform(0.2, 1.4, count), random.uniform(-0.4, 0.4, count)
    b = equation.force(
        y, -side * amplitude * (segments.s_start[k] + drive_change(segments, k, u))
    )
    bodies = lanes(
        amplitude=amplitude,
        omega=omega,
        segment=k,
        phase=u,
        side=side,
        y=y,
        v=v,
        force=b,
    )
    result = advance.advance(segments, bodies, equation)
    turned, h, _ = advance.turning_points(
        segments, bodies, result, np.ones(count, dtype=bool)
    )
    raster = np.linspace(0.0, 1.0, 1001)[:, None] * result.reach
    speed = np.array([result.arc.at(x).v for x in raster])
    falls = (speed[:-1] > 0.0) & (speed[1:] <= 0.0)
    (at,) = np.nonzero(falls.any(axis=0))
    np.testing.assert_array_equal(at, np.sort(turned))
    order = np.argsort(turned)
    first = falls[:, at].argmax(axis=0)
    assert np.all(raster[first, at] <= h[order] + 1e-12)
    assert np.all(h[order] <= raster[first + 1, at] + 1e-12)
    ends = speed[-1, at]
    assert ((v[at] < 0.0) & (ends < 0.0)).sum() > 5, "turned outwards and back"
    assert ((v[at] > 0.0) & (ends > 0.0)).sum() > 5, "turned back and outwards"


@pytest.mark.parametrize(
    "motion",
    [
        sine(),
        sine(2.5),
        cosine(1.5),
        LADDER,
        MIXED,
        *map(pulse, ("ricker-symmetric", "rectangular-impulse")),
    ],
    ids=lambda m: m.name,
)
def test_windows_tile_the_motion_and_state_the_sign_of_the_drive(motion):
    segments, random = motion.segments, np.random.default_rng(1)
    amplitude, side = random.uniform(0.5, 8.0, 40), random.choice([-1.0, 1.0], 40)
    k, u = np.zeros(40, dtype=np.int64), np.zeros(40)
    covered, ridges = np.zeros(40), 0
    for _ in range(4 * len(segments) + 4):
        on = np.flatnonzero(k < len(segments))
        if not on.size:
            break
        window = window_end(segments, k[on], u[on], side[on], amplitude[on])
        ridges += int(window.supercritical.sum())
        for i, lane in enumerate(on):
            assert window.segment[i] in (k[lane], k[lane] + 1)
            spans = [
                (
                    k[lane],
                    u[lane],
                    window.phase[i]
                    if window.segment[i] == k[lane]
                    else segments.length[k[lane]],
                )
            ]
            spans += (
                [(window.segment[i], 0.0, window.phase[i])]
                if window.segment[i] > k[lane]
                else []
            )
            values = []
            for at, low, high in spans:
                assert high >= low
                covered[lane] += high - low
                change = segment_value(
                    segments, np.full(60, at), np.linspace(low, high, 60)
                )[0]
                a = -side[lane] * amplitude[lane] * (segments.s_start[at] + change)
                beyond = a - 1.0 if window.supercritical[i] else 1.0 - a
                assert np.all(
                    beyond
                    >= -amplitude[lane]
                    * (1.1e-13 + 1e-14 * np.abs(segments.s_start[at]))
                )
                values.append(a)
            if not window.supercritical[
                i
                # a subcritical ends at an inner maximum: the drive falls and rises,
                # never the other way round
            ]:
                steps = np.sign(np.diff(np.concatenate(values)).round(12))
                steps = steps[steps != 0.0]
                assert np.all(np.diff(steps) >= 0.0)
        k[on], u[on] = place(segments, window.segment, window.phase)
    assert np.all(k == len(segments))
    assert ridges > 0
    assert covered == pytest.approx(np.full(40, motion.duration), rel=1e-13)


@pytest.mark.parametrize("short", [1e-4, 1e-8, 1e-12])
def test_a_crossing_next_to_an_extremum_keeps_its_distance_to_it(short):
    """sin u = 1 - d at u = pi/2 - sqrt(2 d) (1 + d/12): the distance to the peak is off
    by no more than one rounding of the level.
    """
    level = np.array([1.0 - short])
    d = 1.0 - level[0]
    u = crossing(sine(0.5).segments, np.zeros(1, dtype=np.int64), level)
    expected = np.sqrt(2.0 * d) * (1.0 + d / 12.0)
    assert np.pi / 2 - u[0] == pytest.approx(
        expected, abs=4e-16, rel=np.finfo(float).eps / d + d * d
    )
