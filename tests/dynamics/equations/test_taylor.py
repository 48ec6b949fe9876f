"""Taylor series: the step that a tolerance allows, and the degree that a step needs."""

import math

import numpy as np
import pytest

from rocking_cli.dynamics.equations import straight_lines, taylor

EPS = np.finfo(float).eps


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-12])
def test_a_step_keeps_the_tolerance_and_does_not_waste_it(tolerance):
    """Of exp(h), whose terms decay like those of any flow: the velocity after the
    longest step is off by a part of the tolerance.
    """
    terms = np.array(
        [1.0 / math.factorial(n) for n in range(taylor.order_for(tolerance) + 1)]
    )
    h = float(taylor.longest(terms[:, None], np.ones(1), tolerance)[0])
    missing, longer = (
        math.exp(x) - np.polynomial.polynomial.polyval(x, terms[:-1])
        for x in (h, 3.0 * h)
    )  # of y': one term fewer
    assert missing + 4 * EPS * math.exp(h) < tolerance or tolerance < 1e-11
    assert missing < tolerance + 8 * EPS * math.exp(h)
    assert longer > 0.1 * tolerance


@pytest.mark.parametrize("tolerance", [0.0, 1e-14, 0.5, math.nan])
def test_tolerances_without_sense_are_refused(tolerance):
    with pytest.raises(ValueError, match=r"expected a number from 1e-13 to 0\.01"):
        taylor.order_for(tolerance)


@pytest.mark.parametrize("unit", [1e-3, 0.05, 0.7])
def test_the_largest_sizes_of_a_degree_are_those_at_which_another_term_is_needed(unit):
    limits = np.array(straight_lines.size_limits(unit, 1e-9))
    for factor, more in ((1.0 - 1e-9, 0), (1.0 + 1e-9, 1)):
        needed = straight_lines.degrees(
            factor * limits[:-1], np.full(limits.size - 1, unit), 1e-9
        )
        np.testing.assert_array_equal(needed, np.arange(3, limits.size + 2) + more)
