"""The bounded response against its integral at 40 digits."""

from __future__ import annotations

from itertools import pairwise

import mpmath
import numpy as np
import pytest

from rocking_cli.dynamics.samples.exact import bounded_response


def by_integration(samples, pace, at):
    """-1/2 of the integral of exp(-|t|) s about a sample, and its derivative, line by line."""
    with mpmath.workdps(40):
        h, value, rate = mpmath.mpf(pace), mpmath.mpf(0), mpmath.mpf(0)
        for i, (s0, s1) in enumerate(pairwise(samples)):
            later = i >= at
            near, far, between = (s0, s1, i - at) if later else (s1, s0, at - i - 1)
            total = mpmath.exp(-between * h) * mpmath.quad(lambda t, a=near, b=far: mpmath.exp(-t) * (a + (b - a) * t / h), [0, h])
            value -= total / 2
            rate -= total / 2 if later else -total / 2
        return complex(value, rate)


@pytest.mark.parametrize("pace", [1e-4, 0.03, 0.5])
def test_the_bounded_response_is_the_integral(pace):
    samples = np.random.default_rng(7).standard_normal(14)
    (found,) = bounded_response(samples, np.array([pace]))
    for at in (0, 5, 13):
        assert abs(found[at] - by_integration(samples, pace, at)) < 2e-16 * np.abs(samples).max() * samples.size


def test_a_row_does_not_depend_on_its_neighbours():
    samples = np.random.default_rng(8).standard_normal(3000)
    samples[:2000] = 0.0  # what is no longer felt of the end is not added for the sake of another row
    both = bounded_response(samples, np.array([0.4, 0.001]))
    np.testing.assert_array_equal(both[1], bounded_response(samples, np.array([0.001]))[0])
