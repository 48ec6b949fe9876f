"""Response spectra against SciPy's integration of the oscillator, closed forms, and
their measures.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.record_layouts import plain_record as record
from support.record_layouts import wave
from support.refusals import refuses

from rocking_cli.errors import UsageError
from rocking_cli.motions.response_spectra import (
    acceleration_spectrum,
    displacement_spectrum,
    mean_acceleration,
    periods_of,
)

SAMPLES = wave(240, 3.0) + 0.4 * np.sin(np.arange(240) ** 1.7)


def integrated(samples, dt, period, damping):
    """max |u| by solve_ivp from sample to sample, with a fine dense output, and on
    after the record for a period.
    """
    w, state, most = 2.0 * math.pi / period, np.zeros(2), 0.0
    for a, b, length in [
        *((a, b, dt) for a, b in pairwise(samples)),
        (0.0, 0.0, period),
    ]:
        done = solve_ivp(
            lambda t, y, a=a, b=b, h=length: [
                y[1],
                -2.0 * damping * w * y[1] - w * w * y[0] - a - (b - a) * t / h,
            ],
            (0.0, length),
            state,
            method="DOP853",
            rtol=1e-11,
            atol=1e-15,
            dense_output=True,
        )
        most = max(most, np.abs(done.sol(np.linspace(0.0, length, 400))[0]).max())
        state = done.y[:, -1]
    return most


@pytest.mark.parametrize(
    ("period", "damping"),
    [(0.015, 0.6), (0.04, 0.0), (0.3, 0.05), (1.0, 0.0), (7.0, 0.6)],
)
def test_spectra_are_those_of_an_integration(period, damping):
    samples = SAMPLES[:60] if period < 0.1 else SAMPLES
    found = displacement_spectrum(record(samples, 0.02), np.array([period]), damping)
    assert found == pytest.approx(
        [integrated(samples, 0.02, period, damping)], rel=1e-5 if period < 0.1 else 2e-6
    )


def test_a_step_without_damping_and_its_limits():
    """A constant a moves the undamped oscillator to 2 a/w^2; a stiff one feels the
    peak, a soft one the ground's displacement.
    """
    step = record(np.full(2000, 1.5), 0.01)
    periods = np.array([0.5, 2.0, 3.3])
    assert displacement_spectrum(step, periods, 0.0) == pytest.approx(
        2.0 * 1.5 * (periods / (2.0 * math.pi)) ** 2, rel=1e-10
    )
    measured = record(wave(400, 3.0), 0.02)
    assert acceleration_spectrum(measured, np.array([0.01])) == pytest.approx(
        [3.0], rel=5e-3
    )


def test_periods_go_together_and_alone_with_the_same_digits():
    measured, periods = record(SAMPLES, 0.02), np.array([3.0, 0.2, 1.0, 0.05])
    together = displacement_spectrum(measured, periods)
    assert together == pytest.approx(
        [displacement_spectrum(measured, periods[i : i + 1])[0] for i in range(4)],
        rel=1e-6,
    )
    assert displacement_spectrum(
        record(-2.0 * SAMPLES, 0.02), periods
    ) == pytest.approx(2.0 * together, rel=1e-12)


def test_measures_have_names_and_periods():
    assert periods_of("PGA") is None
    for text, name, periods in (
        ("sa(1.0)", "SA(1)", [1.0]),
        ("AvgSA(0.5, 1, 2 s)", "AvgSA(0.5,1,2)", [0.5, 1.0, 2.0]),
        ("AvgSA", "AvgSA(1)", np.linspace(0.2, 1.5, 10)),
        ("avgsa(2)", "AvgSA(2)", np.linspace(0.4, 3.0, 10)),
    ):
        measure, found = periods_of(text)
        assert (measure, found.tolist()) == (name, pytest.approx(periods))
    measured, periods = record(SAMPLES, 0.02), np.array([0.5, 1.0, 2.0])
    assert mean_acceleration(measured, periods) == pytest.approx(
        np.prod(acceleration_spectrum(measured, periods)) ** (1 / 3), rel=1e-12
    )


NONE = ("SA", "SA()", "SA(0)", "SA(-1)", "SA(1,2)", "SA(x)", "AvgSA(0)", "AvgSA(1 m)")
test_what_is_no_period_is_refused = refuses(
    periods_of, UsageError, [(text, "expected") for text in NONE]
)
BAD = [
    ((times, 0.05), "`periods`: expected one or more positive times")
    for times in ([0.0], [], [math.nan])
]
BAD += [
    (([1.0], ratio), "`damping`: found .*; expected a number from 0 to below 1")
    for ratio in (1.0, -0.1)
]
test_bad_periods_and_damping_are_refused = refuses(
    lambda given: displacement_spectrum(
        record(SAMPLES, 0.02), np.array(given[0]), given[1]
    ),
    UsageError,
    BAD,
)
