"""Taylor series as the flow of an equation: their sums, their derivatives, and the step that a tolerance allows."""

import math

import mpmath
import numpy as np
import pytest
from support.references import LADDER, MIXED, lanes

from rocking_cli import cosine, sine
from rocking_cli.dynamics.equations import taylor

EPS = np.finfo(float).eps


def exponentials(order, unit, growth=1.0):
    """growth exp(h) of each lane, in powers of h / unit."""
    unit = np.asarray(unit, dtype=float)
    terms = np.array([growth * unit**n / float(math.factorial(n)) for n in range(order + 1)])
    return taylor.TaylorSeries(terms, unit, np.ones(unit.size), 1.0 / unit)


@pytest.mark.parametrize("n", [3, 4, 5, 12])
def test_how_far_a_term_is_bent_from_the_chord_is_the_most_that_it_is(n):
    terms, h, unit = np.zeros((13, 2)), np.array([0.7, 1.3]), np.array([0.5, 2.0])
    terms[n] = 0.8, -0.3
    _, most = taylor.TaylorSeries(terms, unit, h, 1.0 / unit).at_with_chord_errors(h)
    t = np.linspace(0.0, 1.0, 4001)[:, None]
    for row, (m, size) in enumerate(((n - 1, n), (n - 2, n * (n - 1)))):
        off = np.abs(size * terms[n] * (h / unit) ** n * (t**m - t)).max(axis=0)  # of h y', h^2 y''
        assert np.all(off <= most[row] * (1.0 + 4 * EPS))
        assert off == pytest.approx(most[row], rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("motion", [sine(), cosine(1.5), LADDER, MIXED], ids=lambda m: m.name)
def test_the_series_of_the_drive_is_the_drive(motion):
    """Term by term against 40-digit derivatives of -side A s(phi + omega h), from positions inside the motion's segments."""
    segments, random = motion.segments, np.random.default_rng(1)
    n, order = 12, 14
    k = random.integers(0, len(segments), n)
    u = random.uniform(0.05, 0.95, n) * segments.length[k]
    side, amplitude, omega = random.choice([-1.0, 1.0], n), random.uniform(0.5, 8.0, n), random.uniform(0.2, 15.0, n)
    drive = taylor.drive_series(segments, lanes(amplitude=amplitude, omega=omega, k=k, u=u, side=side), order)
    mpmath.mp.dps = 40
    for i in range(n):
        phase = float(segments.start[k[i]] + u[i])
        (piece,) = (p for p in motion.pieces if p.start <= phase < p.stop)
        scale = sum(abs(h.amplitude) * amplitude[i] for h in piece.harmonics) + abs(piece.slope) * amplitude[i] * omega[i]
        for m in range(1, order + 1):
            exact = mpmath.mpf(piece.slope) * omega[i] if m == 1 else mpmath.mpf(0)
            for h in piece.harmonics:
                rate = mpmath.mpf(h.frequency) * omega[i]
                turned = mpmath.mpf(h.frequency) * mpmath.mpf(phase) + h.phase + m * mpmath.pi / 2
                exact += h.amplitude * rate**m * mpmath.sin(turned) / mpmath.factorial(m)
            exact *= -side[i] * amplitude[i] * mpmath.mpf(float(drive.unit[i])) ** m
            largest = scale * max(1.0, phase) / math.factorial(m)
            assert abs(float(drive.terms[m, i] / drive.unit[i] ** 2 - exact)) <= 40 * EPS * largest + 1e-300


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-12])
def test_a_step_keeps_the_tolerance_and_does_not_waste_it(tolerance):
    """Of exp(h), whose terms decay like those of any flow: the velocity after the longest step is off by a part of the tolerance."""
    order = taylor.order_for(tolerance)
    base = exponentials(order, [1.0])
    arc = taylor.series(base.terms, base.fastest, tolerance)
    h = float(arc.longest[0])
    terms = np.array([float(math.factorial(n)) for n in range(order + 1)])
    missing = math.exp(h) - sum(h**n / terms[n] for n in range(order))  # of the velocity: one term fewer
    assert missing + 4 * EPS * math.exp(h) < tolerance or tolerance < 1e-11
    assert missing < tolerance + 8 * EPS * math.exp(h)
    longer = 3.0 * h
    assert math.exp(longer) - sum(longer**n / terms[n] for n in range(order)) > 0.1 * tolerance


@pytest.mark.parametrize("tolerance", [0.0, 1e-14, 0.5, math.nan])
def test_tolerances_without_sense_are_refused(tolerance):
    with pytest.raises(ValueError, match=r"expected a number from 1e-13 to 0\.01"):
        taylor.order_for(tolerance)
