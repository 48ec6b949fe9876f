"""Motions: values, monotone segments, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rocking_cli import cosine, sine
from rocking_cli.errors import MotionError
from rocking_cli.motions import Harmonic, Motion, Piece
from rocking_cli.motions.polyline import Polyline


def test_sine_and_cosine_are_cut_at_their_extremes_without_rounding():
    segments = sine(1).segments
    np.testing.assert_allclose(segments.start, [0, math.pi / 2, 3 * math.pi / 2], rtol=1e-15)
    assert segments.s_start.tolist() == [0, 1, -1]
    assert segments.s_end.tolist() == [1, -1, 0]
    long = cosine(10_000).segments
    assert set(np.abs(long.s_start)) == {1.0}
    assert len(long) == 20_000
    assert long.later_max[-1] == 1.0
    assert long.later_min[-1] == -1.0


@pytest.mark.parametrize("motion", [cosine(5), cosine(10_000), sine(300.5)])
def test_half_cycles_are_pi_long_whatever_came_before(motion):
    """As the difference of two phases they would be off by the rounding of those, against sines that are exact there."""
    half_cycles = motion.segments.length[1:-1]
    assert np.array_equal(half_cycles, np.full(half_cycles.size, math.pi))


def test_every_segment_is_monotone():
    harmonics = (Harmonic(0.5, 1, 0.3), Harmonic(0.3, 1.7, 1.0), Harmonic(-0.4, 0.6, 0.2))
    motion = Motion("mixed", (Piece(0, 12, harmonics, 0.1, 0.02), Piece(12, 13, (), -1.0, 2.0)))
    segments = motion.segments
    for k in range(len(segments)):
        phase = segments.start[k] + np.linspace(1e-9, 1 - 1e-9, 500) * segments.length[k]
        steps = np.diff(motion.value(phase))
        assert np.all(steps >= -4e-15) or np.all(steps <= 4e-15)
        assert motion.value(phase)[0] == pytest.approx(segments.s_start[k], abs=1e-8)
        assert motion.value(phase)[-1] == pytest.approx(segments.s_end[k], abs=1e-7)


def test_value_is_zero_outside():
    assert cosine(1).value(np.array([-0.1, 0.0, 1.0, 6.2, 6.3])).tolist() == [0.0, 1.0, math.cos(1.0), math.cos(6.2), 0.0]


@pytest.mark.parametrize("cycles", [0, -1, 0.3, math.nan, math.inf])
def test_cycles_must_be_half_cycles(cycles):
    with pytest.raises(MotionError, match="positive multiple"):
        sine(cycles)


@pytest.mark.parametrize(
    ("pieces", "words"),
    [
        ((), "no pieces"),
        ((Piece(0, 1), Piece(0.5, 2)), "gap or overlap"),
        ((Piece(0, 1), Piece(1.5, 2)), "gap or overlap"),
        ((Piece(0, 0),), "empty"),
        ((Piece(0, math.nan),), "not finite"),
        ((Piece(0, 1, (Harmonic(1, 0),)),), "not positive"),
    ],
)
def test_bad_pieces_are_refused(pieces, words):
    with pytest.raises(MotionError, match=words):
        Motion("bad", pieces)


def test_the_extent_of_segments_is_that_of_each():
    random = np.random.default_rng(2)
    values = random.uniform(-1.0, 1.0, 38)
    t = np.arange(38.0)
    segments = Polyline("r", t[:-1], t[1:], values[:-1], np.diff(values), 1.0).segments
    k, to = (x.ravel() for x in np.meshgrid(np.arange(len(segments)), np.arange(len(segments) + 1), indexing="ij"))
    largest, least = segments.extent(k, to)
    for first, last, high, low in zip(k, to, largest, least, strict=True):
        ends = np.concatenate([segments.s_start[first:last], segments.s_end[first:last]])
        assert (high, low) == (ends.max(initial=-np.inf), ends.min(initial=np.inf))
