"""Closed-form curves of overturning, and where there is none."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rocking_cli import (
    closed_form_curves,
    dimensionless_oscillator,
    linear_response,
    sine,
    trace_envelope,
)
from rocking_cli.envelopes.closed_form import no_impact_amplitude, peak_after_impact


@pytest.mark.requirement(
    "Lowest overturning amplitudes of the linear oscillator have a closed form",
    "envelopes/intervals.py",
    "Envelope of a linear block under one sine cycle",
    "Envelope under a rectangular pulse",
)
@pytest.mark.parametrize(
    "eta",
    [0.5, 0.9, *(pytest.param(eta, marks=pytest.mark.soak) for eta in (0.7, 1.0))],
)
def test_traced_and_closed_form_agree_to_1e_10(eta):
    omegas = np.linspace(1.0, 8.0, 11)
    traced = trace_envelope(
        dimensionless_oscillator(eta=eta), sine(), omegas, a_max=20.0
    )
    compared = 0
    for point in closed_form_curves(omegas, eta):
        if point.curve == "initiation" or point.amplitude >= 20.0:
            continue
        mode, end = {
            "no_impact": ("no_impact", "a_from"),
            "after_impact_lower": ("after_impact", "a_from"),
            "after_impact_upper": ("after_impact", "a_to"),
        }[point.curve]
        ends = [
            getattr(i, end) for i in traced if i.omega == point.omega and i.mode == mode
        ]
        assert min(abs(e - point.amplitude) for e in ends if e is not None) < 1e-10
        compared += 1
    assert compared > 15


@pytest.mark.requirement(
    "Under half a sine they follow from one equation in the frequency",
    "envelopes/closed_form.py",
    "Envelope under half a sine",
)
def test_half_sine_closed_form():
    omegas = np.array([1.0, 3.0, 5.0])
    traced = [
        i
        for i in trace_envelope(
            dimensionless_oscillator(eta=0.9), sine(0.5), omegas, a_max=30
        )
        if i.mode == "no_impact"
    ]
    assert [i.a_from for i in traced] == pytest.approx(
        [no_impact_amplitude(w, "half-sine") for w in omegas], abs=1e-10
    )


def test_closed_form_only_where_there_is_one():
    with pytest.raises(ValueError, match="expected"):
        no_impact_amplitude(3.0, "cosine")


def test_eq_2_7_is_the_peak_where_the_impact_follows_the_pulse():
    """At Omega = 5 and eta = 0.7 the first impact is after the pulse from A = 3, and
    the peak is after it up to A = 3.3.
    """
    found = linear_response(sine(), np.array([3.05, 3.2]), 5.0, 0.7)
    assert found.theta_ratio.ravel() == pytest.approx(
        [peak_after_impact(a, 5.0, 0.7) for a in (3.05, 3.2)], rel=1e-9
    )
    assert math.isnan(peak_after_impact(4.0, 5.0, 0.9))  # overturns after it
