"""The condition of cells: closed forms, where there is none, and the error of the nonlinear equation that it explains."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
from support.references import reference

from rocking_cli import (
    Outcome,
    dimensionless_oscillator,
    linear_response,
    nonlinear_response,
    parse_grid,
    pulse,
    sine,
    spectrum,
    trace_envelope,
)
from rocking_cli.errors import UsageError
from rocking_cli.spectra.trust.condition import condition_of
from rocking_cli.spectra.variables import QUANTITIES


def test_condition_under_a_rectangular_pulse_is_its_derivative():
    """theta = 1 - sqrt(1 - 2 (cosh T - 1) A (A - 1)) with T = 2 pi/Omega, the crest after the pulse, before any impact."""
    amplitude, omega = np.array([1.1, 1.2, 2.0]), np.array([6.0, 7.0, 12.0])
    turn = 2.0 * np.pi / omega
    root = np.sqrt(1.0 - 2.0 * (np.cosh(turn) - 1.0) * amplitude * (amplitude - 1.0))
    by_amplitude = (np.cosh(turn) - 1.0) * amplitude * (2.0 * amplitude - 1.0) / root
    by_frequency = turn * np.sinh(turn) * amplitude * (amplitude - 1.0) / root
    found = condition_of(partial(linear_response, pulse("rectangular")), amplitude, omega, np.full(3, 0.5), 0.0)
    assert found == pytest.approx(by_amplitude + by_frequency, rel=1e-7)


def test_condition_is_none_beside_overturning_and_nothing_below_uplift():
    (first, *_) = trace_envelope(dimensionless_oscillator(0.9), sine(), [3.0], a_max=10)
    amplitude = np.array([0.9, first.a_from * (1 - 1e-9), first.a_from * (1 - 1e-3), first.a_from * 1.01])
    found = condition_of(partial(linear_response, sine()), amplitude, np.full(4, 3.0), np.full(4, 0.9), 0.0)
    assert found[0] == 0.0
    assert np.isnan(found[[1, 3]]).all()
    assert found[2] > 10.0


@pytest.mark.parametrize("eta", [0.0, 1.0])
def test_restitutions_at_the_ends_of_their_range_are_not_left(eta):
    assert np.isfinite(condition_of(partial(linear_response, sine()), np.array([1.5]), np.array([6.0]), np.array([eta]), 0.0)).all()


@pytest.mark.parametrize(("alpha", "tolerance"), [(0.25, 1e-9), (0.57, 1e-7)])
def test_errors_of_the_nonlinear_equation_are_the_tolerance_times_the_condition(alpha, tolerance):
    random = np.random.default_rng(5)
    amplitude, omega = random.uniform(1, 6, 400) * math.tan(alpha) / alpha, np.exp(random.uniform(math.log(0.3), math.log(12), 400))
    eta = random.uniform(0.3, 1, 400)
    respond = partial(nonlinear_response, sine(4), alpha=alpha)
    found, exact = (respond(amplitude, omega, eta, tolerance=t) for t in (tolerance, 1e-13))
    condition = condition_of(partial(respond, tolerance=tolerance), amplitude, omega, eta, tolerance)
    known = np.isfinite(condition) & (exact.outcome == Outcome.ROCKED)
    assert known.sum() > 80
    assert np.array_equal(found.outcome[known], exact.outcome[known])
    error = np.abs(found.theta_ratio - exact.theta_ratio)[known]
    assert (error <= tolerance * np.maximum(1.0, condition[known])).all()


def test_the_largest_error_seen_is_its_condition():
    """A hundred tolerances, after 26 impacts and a chatter: the cell multiplies any error by 1e5."""
    cell, alpha = (1.195484, 0.644377, 0.826051), 0.570
    outcome, theta = reference(sine(2), *cell, alpha)
    found = nonlinear_response(sine(2), *cell, alpha)
    (condition,) = condition_of(partial(nonlinear_response, sine(2), alpha=alpha), *(np.array([x]) for x in cell), 1e-9)
    assert outcome == found.outcome == Outcome.ROCKED
    assert condition == pytest.approx(1.336e5, rel=1e-3)
    assert abs(float(found.theta_ratio) - theta) <= 1e-9 * condition


def test_condition_is_computed_on_request():
    grid, structures = parse_grid("A=0.5:3:6,Omega=4:8:5"), [dimensionless_oscillator(0.9), dimensionless_oscillator(0.5)]
    assert spectrum(structures, sine(), grid).condition is None
    found = spectrum(structures, sine(), grid, quantities=["condition"])
    amplitude, omega = np.meshgrid(grid.amplitude.values, grid.frequency.values)
    for i, eta in enumerate((0.9, 0.5)):
        expected = condition_of(partial(linear_response, sine()), amplitude, omega, np.full(amplitude.shape, eta), 0.0)
        np.testing.assert_array_equal(found.condition[i], expected)
    with pytest.raises(UsageError, match=f"unknown quantity 'conditions'; expected {', '.join(QUANTITIES)}"):
        spectrum(structures, sine(), grid, quantities=["conditions"])
