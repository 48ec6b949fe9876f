"""Extremes of sums of sinusoids: closed forms, and the roots of the rate as a polynomial on the unit circle."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rocking_cli import pulse
from rocking_cli.motions import Harmonic, Motion, Piece
from rocking_cli.motions.turning_points import isolated_extremes

AT = 2.0 + 1e-3 * math.sqrt(2)


@pytest.mark.parametrize("apart", [1e-2, 1e-3, 1e-4, 1e-6])
def test_two_extremes_close_together_are_both_found(apart):
    """s' = cos(phi - c) - cos(d/2) is positive for |phi - c| < d/2 only."""
    piece = Piece(0.0, 6.0, (Harmonic(1.0, 1.0, -AT),), 0.0, -math.cos(apart / 2))
    found = isolated_extremes(piece)
    # A rate of rounding 1e-16 over its slope d/2 there; the cosine rounds its own roots by 1e-16 / d too.
    assert found == pytest.approx([AT - apart / 2, AT + apart / 2], abs=1e-15 / apart + 1e-15)
    segments = Motion("two", (piece,)).segments
    rise = (segments.s_end - segments.s_start)[1]
    assert rise == pytest.approx(apart**3 / 12.0, rel=1e-3, abs=2e-15)
    assert len(segments) == 3


@pytest.mark.parametrize("at", [0.5, AT, 3.0])
def test_a_double_extreme_is_none(at):
    """s' = 1 - cos(phi - c) touches zero: s rises throughout."""
    piece = Piece(0.0, 6.0, (Harmonic(-1.0, 1.0, -at),), 0.0, 1.0)
    assert isolated_extremes(piece).size == 0


def test_a_triple_extreme_is_one():
    """s' = sin^3(phi - c) = (3 sin - sin 3)/4 crosses zero with no slope, known to the cube root of its rounding."""
    piece = Piece(0.0, 4.0, (Harmonic(-0.75, 1.0, math.pi / 2 - AT), Harmonic(1.0 / 12.0, 3.0, math.pi / 2 - 3.0 * AT)))
    assert isolated_extremes(piece) == pytest.approx([AT], abs=1e-5)


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6),
    st.lists(st.floats(-math.pi, math.pi), min_size=6, max_size=6),
    st.floats(-0.5, 0.5),
)
def test_every_root_of_the_rate_is_found(amplitudes, phases, slope):
    """With frequencies 1 ... 6 and z = exp(i phi) the rate is a polynomial in z over z^6: its roots of modulus one are the extremes."""
    harmonics = tuple(Harmonic(c, float(n), f) for n, (c, f) in enumerate(zip(amplitudes, phases, strict=True), 1) if abs(c) > 1e-3)
    if not harmonics:
        return
    piece = Piece(0.0, 2.0 * math.pi, harmonics, 0.0, slope)
    polynomial = np.zeros(13, dtype=complex)
    polynomial[6] = slope
    for h in harmonics:
        n = int(h.frequency)
        polynomial[6 - n] += 0.5 * h.amplitude * n * np.exp(1j * h.phase)  # highest power first
        polynomial[6 + n] += 0.5 * h.amplitude * n * np.exp(-1j * h.phase)
    roots = np.roots(np.trim_zeros(polynomial))
    circle = np.sort(np.angle(roots[np.abs(np.abs(roots) - 1.0) < 1e-9]) % (2.0 * math.pi))
    close = np.abs(np.abs(roots) - 1.0) < 1e-3
    apart = np.abs(roots[close, None] - roots[None, close])[~np.eye(int(close.sum()), dtype=bool)]
    if (close.sum() != circle.size) or (apart < 1e-3).any() or (circle < 1e-6).any() or (circle > 2.0 * math.pi - 1e-6).any():
        return  # what a companion matrix cannot tell
    assert isolated_extremes(piece) == pytest.approx(circle, abs=1e-9)


@pytest.mark.parametrize(("name", "extremes"), [("ricker-antisymmetric", 4), ("mavroeidis-papageorgiou", 6)])
def test_pulses_turn_where_they_do(name, extremes):
    assert len(pulse(name).segments) == extremes + 1
