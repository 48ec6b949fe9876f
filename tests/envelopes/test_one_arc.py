"""Arcs that outlast the shaking: their modes by quadrature, and that nothing changes where nothing may."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from rocking_cli import Outcome, cosine, linear_response, pulse, sine
from rocking_cli.envelopes.one_arc import may_change, modes_at_end

MOTIONS = [sine(), sine(0.5), cosine(1.5), pulse("rectangular")]
AT_ONCE = [sine(), sine(0.5), sine(2), cosine(1), cosine(1.5), pulse("rectangular-impulse")]


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
def test_both_modes_at_the_end_are_integrals_of_the_drive(motion):
    random = np.random.default_rng(3)
    first, end = motion.segments, motion.duration
    outwards = np.sign(first.s_start[0] or first.s_end[0])
    for amplitude, omega in zip(random.uniform(1.05, 8.0, 6), random.uniform(0.8, 9.0, 6), strict=True):
        found = modes_at_end(motion.segments, np.array([amplitude]), np.array([omega]))
        start = 0.0 if first.s_start[0] else math.asin(1.0 / amplitude)  # pushed from the first, or by a sine
        kinks = [float(x) for x in first.start if x > start]
        for mode, slope, sense in ((found.z, found.z_slope, 1.0), (found.x, found.x_slope, -1.0)):

            def weighed(phase, rate=sense / omega, omega=omega):
                return math.exp(rate * (end - phase)) * outwards * float(motion.value(np.array([phase]))[0]) / omega

            drive, error = quad(weighed, start, end, points=kinks, epsabs=0, epsrel=1e-12, limit=400)
            rest = sense * math.exp(sense * (end - start) / omega)
            assert slope[0] == pytest.approx(drive, rel=0, abs=1e-12 * abs(rest) + 10 * error)
            assert mode[0] == pytest.approx(
                amplitude * drive - rest, rel=0, abs=1e-12 * (1 + amplitude) * abs(rest) + 10 * error * amplitude
            )


@pytest.mark.parametrize("motion", AT_ONCE, ids=lambda m: m.name)
def test_where_nothing_may_change_nothing_does(motion):
    random = np.random.default_rng(4)
    low, omega = random.uniform(1.0, 12.0, 300), random.uniform(0.6, 9.0, 300)
    high = low * (1.0 + 10.0 ** random.uniform(-4.0, -0.5, 300))
    for eta in (0.0, 0.8, 0.97):
        inside = low + (high - low) * np.linspace(0.0, 1.0, 33)[:, None]
        seen = linear_response(motion, inside, omega, eta, peaks=False)
        fallen = (seen.impacts > 0) | np.isin(seen.outcome, [Outcome.NO_UPLIFT, Outcome.OVERTURNED_NO_IMPACT])
        plain = ~fallen.any(axis=0)  # one arc, and falls back: what the bounds speak of
        changes = np.ptp(seen.outcome, axis=0) > 0
        doubtful = may_change(*(modes_at_end(motion.segments, end, omega) for end in (low, high)), high - low, eta)
        assert not np.any(plain & changes & ~doubtful)
        assert np.any(plain & ~doubtful) or not plain.any()
