"""Extremes of smooth functions."""

import math

import numpy as np
import pytest

from rocking_cli.responses.chebyshev import extent


def test_every_extremum_counts_and_none_is_a_sample():
    found = extent(lambda t: np.sin(40.0 * t) + 0.3 * t, 0.0, 2.0)
    turn = math.acos(-0.3 / 40.0)
    highest, lowest = (turn + 2 * math.pi * 12) / 40.0, (2 * math.pi - turn) / 40.0
    assert (found.at_largest, found.largest) == pytest.approx(
        (highest, math.sin(40 * highest) + 0.3 * highest), abs=1e-13
    )
    assert (found.at_least, found.least) == pytest.approx(
        (lowest, math.sin(40 * lowest) + 0.3 * lowest), abs=1e-13
    )


def test_a_narrow_peak_between_points_is_found():
    found = extent(lambda t: 1.0 / (1e-4 + (t - 0.123456) ** 2), 0.0, 1.0)
    assert found.largest == pytest.approx(1e4, rel=1e-13)


def test_an_infinite_value_has_no_extent_and_no_warning():
    """The friction of a joint that opens is infinite; a warning fails the test."""
    found = extent(lambda t: np.where(t < 0.5, np.inf, t), 0.0, 1.0)
    assert (found.least, found.largest) == (-math.inf, math.inf)


def test_ends_and_constants():
    assert extent(lambda t: np.full(t.shape, 3.0), 1.0, 2.0)[::2] == (3.0, 3.0)
    assert extent(np.exp, 0.0, 1.0) == pytest.approx(
        (1.0, 0.0, math.e, 1.0), rel=1e-14, abs=0.0
    )
