"""The steps of the slower path against closed forms."""

import math

import pytest

from rocking_cli.dynamics.references.extrapolation import EdgeMotion, StatePoint, path


def free(time, y, v):
    """Eq. 2.4 without a drive."""
    return v, y - 1.0


@pytest.mark.parametrize(
    "rate",
    [
        lambda t, y, v: (v, 1.0 / (t - 0.5)),
        lambda t, y, v: (v, math.sqrt(0.1 - t)),
        lambda t, y, v: (v, 1e6 * y),
    ],
)
def test_a_step_that_is_too_long_is_none(rate):
    assert EdgeMotion(rate).step(StatePoint(0.0, 1.0, 0.0), 1.0) is None


@pytest.mark.parametrize("v", [1e-9, 1e-4, 0.3, 0.9])
@pytest.mark.parametrize(
    "stretch", [2.05, 9.0]
)  # times of a peak: the impact lies in the last step, or both lie in one
def test_peak_and_impact_of_a_free_arc(v, stretch):
    """y = 1 - cosh t + v sinh t: the peak is at artanh v, 1 - sqrt(1 - v^2) high, and
    the body comes down at twice the time as fast as it left.
    """
    rise = math.atanh(v)
    near = (
        1e-14 + 1e-10 * (stretch * rise / 2.0) ** 2
    )  # ten times what a step is trusted to: they grow
    found = path(EdgeMotion(free), StatePoint(0.0, 0.0, v), stretch * rise, math.inf)
    assert found.struck
    (top,) = found.peaks
    height = v * v / (1.0 + math.sqrt(1.0 - v * v))
    assert abs(top.time / rise - 1.0) < 2e-9
    assert (
        abs(top.theta - 0.5 * top.w**2 / (top.theta - 1.0) - height)
        < near * height + 1e-16 * v
    )
    end = found.end
    assert abs(end.time - end.theta / end.w - 2.0 * rise) < near * rise
    assert abs(end.w + end.theta / end.w - -v) < near * v
