"""Windows of the drive: they tile the motion, and the sign of the drive in each is the one they state."""

from __future__ import annotations

import numpy as np
import pytest
from support.references import LADDER, MIXED

from rocking_cli import cosine, pulse, sine
from rocking_cli.dynamics.drive import crossing, phase_between, place, segment_value
from rocking_cli.dynamics.march.advance import window_end
from rocking_cli.dynamics.weight import weighed
from rocking_cli.motions import Harmonic, Motion, Piece
from rocking_cli.motions.biaxial import with_vertical

MOTIONS = [sine(), sine(2.5), cosine(1.5), LADDER, MIXED, pulse("ricker-symmetric"), pulse("rectangular-impulse")]


def drive_at(segments, k, u, side, amplitude):
    """The outward drive at a position, and the rounding of it."""
    s = segments.s_start[k] + segment_value(segments, k, u)[0]
    return -side * amplitude * s, 1e-14 * amplitude * (1.0 + np.abs(segments.s_start[k]))


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
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
            assert window.k[i] in (k[lane], k[lane] + 1)
            spans = [(k[lane], u[lane], window.u[i] if window.k[i] == k[lane] else segments.length[k[lane]])]
            spans += [(window.k[i], 0.0, window.u[i])] if window.k[i] > k[lane] else []
            values = []
            for at, low, high in spans:
                assert high >= low
                covered[lane] += high - low
                inside = np.linspace(low, high, 60)
                a, rounding = drive_at(segments, np.full(60, at), inside, side[lane], amplitude[lane])
                beyond = a - 1.0 if window.supercritical[i] else 1.0 - a
                assert np.all(beyond >= -1e-13 * amplitude[lane] - rounding)
                values.append(a)
            if not window.supercritical[i]:  # a subcritical ends at an inner maximum: the drive falls and rises, never the other way round
                steps = np.sign(np.diff(np.concatenate(values)).round(12))
                steps = steps[steps != 0.0]
                assert np.all(np.diff(steps) >= 0.0)
        k[on], u[on] = place(segments, window.k, window.u)
    assert np.all(k == len(segments))
    assert ridges > 0
    assert covered == pytest.approx(np.full(40, motion.duration), rel=1e-13)


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
def test_a_crossing_is_where_the_motion_has_the_level(motion):
    segments, random = motion.segments, np.random.default_rng(2)
    for share in (1e-12, 1e-6, 0.1, 0.5, 0.9, 1.0 - 1e-9):
        k = random.integers(0, len(segments), 50)
        k = k[segments.s_start[k] != segments.s_end[k]]
        level = segments.s_start[k] + share * (segments.s_end[k] - segments.s_start[k])
        u = crossing(segments, k, level)
        assert np.all((u >= 0.0) & (u <= segments.length[k]))
        assert segments.s_start[k] + segment_value(segments, k, u)[0] == pytest.approx(level, abs=5e-15)


@pytest.mark.parametrize("short", [1e-4, 1e-8, 1e-12])
def test_a_crossing_next_to_an_extremum_keeps_its_distance_to_it(short):
    """sin u = 1 - d at u = pi/2 - sqrt(2 d) (1 + d/12): the distance to the peak is off by no more than one rounding of the level."""
    level = np.array([1.0 - short])
    d = 1.0 - level[0]
    u = crossing(sine(0.5).segments, np.zeros(1, dtype=np.int64), level)
    expected = np.sqrt(2.0 * d) * (1.0 + d / 12.0)
    assert np.pi / 2 - u[0] == pytest.approx(expected, abs=4e-16, rel=np.finfo(float).eps / d + d * d)


WEIGHED = weighed(with_vertical(sine(2), Motion("fast", (Piece(0.0, 9.0, (Harmonic(0.6, 3.3, 0.4),)),))), 0.3, 0.5)


@pytest.mark.parametrize("segments", [*(m.segments for m in (sine(2.5), MIXED, pulse("ricker-symmetric"))), WEIGHED])
def test_the_phase_to_the_end_of_a_window_is_that_of_the_segments_between(segments):
    random = np.random.default_rng(2)
    side, amplitude = random.choice([-1.0, 1.0], 2000), random.uniform(0.5, 8.0, 2000)
    k = random.integers(0, len(segments), 2000)
    u = random.uniform(0.0, 1.0, 2000) * segments.length[k]
    for _ in range(3):  # where a window ends the next one begins, and at its neighbours
        end = window_end(segments, k, u, side, amplitude)
        np.testing.assert_allclose(end.phase(u), phase_between(segments, k, u, end.k, end.u), rtol=0.0, atol=4e-15)
        k, u = place(segments, end.k, np.nextafter(end.u, random.choice([-9.0, 9.0], 2000)))
        k, u = np.minimum(k, len(segments) - 1), np.where(k < len(segments), u, 0.0)
