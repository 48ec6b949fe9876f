"""Motions: values, monotone segments and their turning points, segments of many
sinusoids as polynomials, and what is refused.
"""

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.refusals import refuses

from rocking_cli import MotionError, cosine, floor_of, pulse, sine
from rocking_cli.dynamics.drive import crossing, segment_value
from rocking_cli.motions import Harmonic, Motion, Piece, sinusoids
from rocking_cli.motions.motion import extremes


def test_sine_and_cosine_are_cut_at_their_extremes_without_rounding():
    segments = sine(1).segments
    np.testing.assert_allclose(
        segments.start, [0, math.pi / 2, 3 * math.pi / 2], rtol=1e-15
    )
    assert segments.s_start.tolist() == [0, 1, -1]
    assert segments.s_end.tolist() == [1, -1, 0]
    long = cosine(10_000).segments
    assert set(np.abs(long.s_start)) == {1.0}
    assert (len(long), long.later_max[-1], long.later_min[-1]) == (20_000, 1.0, -1.0)
    for motion in (
        cosine(5),
        cosine(10_000),
        sine(300.5),
    ):  # half cycles, which no difference of two phases rounds
        assert set(motion.segments.length[1:-1]) == {math.pi}
    assert cosine(1).value(np.array([-0.1, 0.0, 1.0, 6.2, 6.3])).tolist() == [
        0.0,
        1.0,
        math.cos(1.0),
        math.cos(6.2),
        0.0,
    ]


test_cycles_must_be_half_cycles = refuses(
    sine,
    MotionError,
    [(cycles, "positive multiple") for cycles in (0, -1, 0.3, 1e9, math.nan, math.inf)],
)
REFUSED = [
    ((), "no pieces"),
    ((Piece(0, 1), Piece(0.5, 2)), "gap or overlap"),
    ((Piece(0, 1), Piece(1.5, 2)), "gap or overlap"),
    ((Piece(0, 0),), "empty"),
    ((Piece(0, math.nan),), "not finite"),
    ((Piece(0, 1, (Harmonic(1, 0),)),), "not positive"),
]
test_bad_pieces_are_refused = refuses(partial(Motion, "bad"), MotionError, REFUSED)


AT = 2.0 + 1e-3 * math.sqrt(2)


@pytest.mark.parametrize("apart", [1e-2, 1e-3, 1e-4, 1e-6])
def test_two_extremes_close_together_are_both_found(apart):
    """s' = cos(phi - c) - cos(d/2) is positive for |phi - c| < d/2 only."""
    piece = Piece(0.0, 6.0, (Harmonic(1.0, 1.0, -AT),), 0.0, -math.cos(apart / 2))
    found = extremes(piece)
    # A rate of rounding 1e-16 over its slope d/2 there; the cosine rounds its own roots
    # by 1e-16 / d too.
    assert found == pytest.approx(
        [AT - apart / 2, AT + apart / 2], abs=1e-15 / apart + 1e-15
    )
    segments = Motion("two", (piece,)).segments
    rise = (segments.s_end - segments.s_start)[1]
    assert rise == pytest.approx(apart**3 / 12.0, rel=1e-3, abs=2e-15)
    assert len(segments) == 3


def test_a_double_extreme_is_none_and_a_triple_one_is_one():
    """s' = 1 - cos(phi - c) touches zero: s rises throughout; s' = sin^3(phi - c) = (3
    sin - sin 3)/4 crosses it with no slope.
    """
    for at in (0.5, AT, 3.0):
        assert extremes(Piece(0.0, 6.0, (Harmonic(-1.0, 1.0, -at),), 0.0, 1.0)) == []
    piece = Piece(
        0.0,
        4.0,
        (
            Harmonic(-0.75, 1.0, math.pi / 2 - AT),
            Harmonic(1.0 / 12.0, 3.0, math.pi / 2 - 3.0 * AT),
        ),
    )
    assert extremes(piece) == pytest.approx(
        [AT], abs=1e-5
    )  # the cube root of its rounding


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6),
    st.lists(st.floats(-math.pi, math.pi), min_size=6, max_size=6),
    st.floats(-0.5, 0.5),
)
def test_every_root_of_the_rate_is_found(amplitudes, phases, slope):
    """With frequencies 1 ... 6 and z = exp(i phi) the rate is a polynomial in z over
    z^6: its roots of modulus one are the extremes.
    """
    harmonics = tuple(
        Harmonic(c, float(n), f)
        for n, (c, f) in enumerate(zip(amplitudes, phases, strict=True), 1)
        if abs(c) > 1e-3
    )
    if not harmonics:
        return
    piece = Piece(0.0, 2.0 * math.pi, harmonics, 0.0, slope)
    polynomial = np.zeros(13, dtype=complex)
    polynomial[6] = slope
    for h in harmonics:
        n = int(h.frequency)
        polynomial[6 - n] += (
            0.5 * h.amplitude * n * np.exp(1j * h.phase)
        )  # highest power first
        polynomial[6 + n] += 0.5 * h.amplitude * n * np.exp(-1j * h.phase)
    roots = np.roots(np.trim_zeros(polynomial))
    circle = np.sort(
        np.angle(roots[np.abs(np.abs(roots) - 1.0) < 1e-9]) % (2.0 * math.pi)
    )
    close = np.abs(np.abs(roots) - 1.0) < 1e-3
    apart = np.abs(roots[close, None] - roots[None, close])[
        ~np.eye(int(close.sum()), dtype=bool)
    ]
    if (
        (close.sum() != circle.size)
        or (apart < 1e-3).any()
        or (circle < 1e-6).any()
        or (circle > 2.0 * math.pi - 1e-6).any()
    ):
        return  # what a companion matrix cannot tell
    assert extremes(piece) == pytest.approx(circle, abs=1e-9)


TWO_TONES = Motion(
    "two tones",
    (
        Piece(0.0, 5.0, (Harmonic(1.0), Harmonic(0.3, 7.0, 1.0)), 0.1, 0.2),
        Piece(5.0, 6.0, slope=-0.5),
    ),
)
MOTIONS = [
    pulse("ricker-symmetric"),
    pulse("ricker-antisymmetric"),
    pulse("mavroeidis-papageorgiou", gamma=3.3, phase=1.0),
    TWO_TONES,
]


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
def test_polynomials_are_the_sums_of_sinusoids_and_cross_each_level_with_the_drive(
    motion,
):
    segments, random = motion.segments, np.random.default_rng(1)
    k = random.integers(0, len(segments), 3000)
    u = random.uniform(0.0, 1.0, k.size) * segments.length[k]
    u[:100] = 0.0
    u[100:200] = segments.length[k[100:200]]
    near, rate, second_derivative = segments.table.change_at(k, u)
    change, sin, cos = segment_value(segments, k, u)
    w = segments.frequency[:, k]
    assert np.abs(near - change).max() < 2e-15
    assert np.abs(rate - (w * cos).sum(axis=0) - segments.slope[k]).max() < 1e-14
    assert np.abs(second_derivative + (w * w * sin).sum(axis=0)).max() < 5e-13
    rises = np.abs(segments.s_end - segments.s_start) > 1e-3
    k = random.choice(np.flatnonzero(rises), 2000)
    share = np.concatenate(
        [
            10.0 ** -np.arange(1.0, 13.0),
            1.0 - 10.0 ** -np.arange(1.0, 13.0),
            random.uniform(0.0, 1.0, 1976),
        ]
    )
    level = segments.s_start[k] + share * (segments.s_end[k] - segments.s_start[k])
    u = crossing(segments, k, level)
    assert np.all((u >= 0.0) & (u <= segments.length[k]))
    assert (
        np.abs(segments.s_start[k] + segment_value(segments, k, u)[0] - level).max()
        < 3e-15
    )
    assert np.array_equal(
        u[:50],
        [crossing(segments, k[i : i + 1], level[i : i + 1])[0] for i in range(50)],
    )  # each by itself


def test_a_motion_of_too_many_patches_is_summed_term_by_term(monkeypatch):
    monkeypatch.setattr(sinusoids, "_MOST_PATCHES", 5)
    segments = Motion(TWO_TONES.name, TWO_TONES.pieces).segments
    assert segments.table is None
    k = np.ones(5, dtype=int)
    level = np.linspace(segments.s_start[1], segments.s_end[1], 7)[1:-1]
    u = crossing(segments, k, level)
    assert (
        np.abs(segments.s_start[k] + segment_value(segments, k, u)[0] - level).max()
        < 1e-15
    )
    assert np.abs(u - crossing(TWO_TONES.segments, k, level)).max() < 1e-14


def test_the_opposite_of_the_opposite_direction_has_the_name_of_the_motion():
    motion = sine()
    assert motion.scaled(-1.0).scaled(-1.0).name == motion.name
    assert motion.scaled(-1.0).scaled(2.5).name == f"{motion.name} times -2.5"
    assert motion.scaled(2.5).scaled(-1.0).name == f"{motion.name} times -2.5"
    floor = floor_of(motion.scaled(-1.0), "T=0.4,xi=0.05", 1.0)
    assert floor.scaled(-1.0).name == f"{motion.name} on floor of T 0.4 s"


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
