"""Segments of many sinusoids as polynomials."""

import numpy as np
import pytest

from rocking_cli.dynamics.drive import crossing, segment_value
from rocking_cli.motions import Harmonic, Motion, Piece, polynomials, pulse, sine

TWO_TONES = Motion("two tones", (Piece(0.0, 5.0, (Harmonic(1.0), Harmonic(0.3, 7.0, 1.0)), 0.1, 0.2), Piece(5.0, 6.0, slope=-0.5)))
MOTIONS = [pulse("ricker-symmetric"), pulse("ricker-antisymmetric"), pulse("mavroeidis-papageorgiou", gamma=3.3, phase=1.0), TWO_TONES]


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
def test_polynomials_are_the_sums_of_sinusoids_and_their_derivatives(motion):
    segments = motion.segments
    random = np.random.default_rng(1)
    k = random.integers(0, len(segments), 3000)
    u = random.uniform(0.0, 1.0, k.size) * segments.length[k]
    u[:100] = 0.0
    u[100:200] = segments.length[k[100:200]]
    near = segments.table.near(k, u)
    change, sin, cos = segment_value(segments, k, u)
    w = segments.frequency[:, k]
    assert np.abs(near.change - change).max() < 2e-15
    assert np.abs(near.rate - (w * cos).sum(axis=0) - segments.slope[k]).max() < 1e-14
    assert np.abs(near.bend + (w * w * sin).sum(axis=0)).max() < 5e-13


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
def test_crossings_are_where_the_drive_has_the_level(motion):
    segments = motion.segments
    random = np.random.default_rng(2)
    rises = np.abs(segments.s_end - segments.s_start) > 1e-3
    k = random.choice(np.flatnonzero(rises), 2000)
    share = np.concatenate([10.0 ** -np.arange(1.0, 13.0), 1.0 - 10.0 ** -np.arange(1.0, 13.0), random.uniform(0.0, 1.0, 1976)])
    level = segments.s_start[k] + share * (segments.s_end[k] - segments.s_start[k])
    u = crossing(segments, k, level)
    assert np.all((u >= 0.0) & (u <= segments.length[k]))
    assert np.abs(segments.s_start[k] + segment_value(segments, k, u)[0] - level).max() < 3e-15
    assert np.array_equal(u[:50], [crossing(segments, k[i : i + 1], level[i : i + 1])[0] for i in range(50)])  # each by itself


def test_what_has_a_closed_form_has_no_table():
    assert sine(3).segments.table is None
    assert Motion("line", (Piece(0.0, 1.0, slope=1.0),)).segments.table is None


def test_a_motion_of_too_many_patches_is_summed_term_by_term(monkeypatch):
    monkeypatch.setattr(polynomials, "_MOST_PATCHES", 5)
    segments = Motion(TWO_TONES.name, TWO_TONES.pieces).segments
    assert segments.table is None
    k = np.full(5, 1)
    level = np.linspace(segments.s_start[1], segments.s_end[1], 7)[1:-1]
    u = crossing(segments, k, level)
    assert np.abs(segments.s_start[k] + segment_value(segments, k, u)[0] - level).max() < 1e-15
    assert np.abs(u - crossing(TWO_TONES.segments, k, level)).max() < 1e-14
