"""Envelopes: traced boundaries, closed-form curves and the reference table."""

from __future__ import annotations

import numpy as np
import pytest
from test_engine import INTERVALS

from rocking_cli import (
    Outcome,
    UsageError,
    closed_form_curves,
    cosine,
    dimensionless_oscillator,
    linear_response,
    overturned,
    pulse,
    sine,
    trace_envelope,
)
from rocking_cli.dynamics.equations.linear import LinearModel
from rocking_cli.spectra.boundaries import Search
from rocking_cli.spectra.closed_form import no_impact_amplitude


def test_traced_intervals_are_those_of_the_reference_table():
    traced = trace_envelope(sine(), [row[0] for row in INTERVALS], dimensionless_oscillator(0.9))
    for omega, begin, end, no_impact, digit in INTERVALS:
        mine = [i for i in traced if i.omega == omega]
        assert [i.mode for i in mine] == ["after_impact", "no_impact"]
        assert (mine[0].a_from, mine[0].a_to, mine[1].a_from) == pytest.approx((begin, end, no_impact), abs=0.51 * digit)
        assert mine[1].a_to is None


@pytest.mark.parametrize("eta", [0.5, 0.7, 0.9, 1.0])
def test_traced_and_closed_form_agree_to_1e_10(eta):
    omegas = np.linspace(1.0, 8.0, 22)
    traced = trace_envelope(sine(), omegas, dimensionless_oscillator(eta), a_max=20.0)
    compared = 0
    for point in closed_form_curves(omegas, eta):
        if point.curve == "initiation" or point.amplitude >= 20.0:
            continue
        mode, end = {
            "no_impact": ("no_impact", "a_from"),
            "after_impact_lower": ("after_impact", "a_from"),
            "after_impact_upper": ("after_impact", "a_to"),
        }[point.curve]
        ends = [getattr(i, end) for i in traced if i.omega == point.omega and i.mode == mode]
        assert min(abs(e - point.amplitude) for e in ends if e is not None) < 1e-10
        compared += 1
    assert compared > 30


def test_half_sine_closed_form():
    omegas = np.array([1.0, 3.0, 5.0])
    traced = [i for i in trace_envelope(sine(0.5), omegas, dimensionless_oscillator(0.9), a_max=30) if i.mode == "no_impact"]
    assert [i.a_from for i in traced] == pytest.approx([no_impact_amplitude(w, "half-sine") for w in omegas], abs=1e-10)


def test_every_interval_of_a_fine_raster_is_traced():
    omega, amplitude = 0.4983, np.linspace(1, 1.2, 40_001)
    outcome = linear_response(sine(), amplitude, omega, 0.9).outcome
    traced = trace_envelope(sine(), [omega], dimensionless_oscillator(0.9), a_max=1.2)
    inside = np.zeros(amplitude.size, dtype=bool)
    for i in traced:
        inside |= (amplitude > i.a_from) & (amplitude < (i.a_to or np.inf))
    assert len(traced) > 3
    wrong = np.flatnonzero(inside != overturned(outcome))
    runs = np.split(wrong, np.flatnonzero(np.diff(wrong) > 1) + 1)
    assert max((r.size for r in runs if r.size), default=0) * 5e-6 < 1e-3


def test_boundaries_are_where_the_outcome_changes():
    for i in trace_envelope(cosine(1), [2.0, 4.0], dimensionless_oscillator(0.8), a_max=10):
        for edge in (i.a_from, i.a_to):
            if edge is not None:
                below, above = linear_response(cosine(1), edge * np.array([1 - 1e-12, 1 + 1e-12]), i.omega, 0.8).outcome
                assert below != above


MOTIONS = [sine(), sine(0.5), sine(2), cosine(1.5), pulse("rectangular"), pulse("rectangular-impulse"), pulse("ricker-symmetric")]


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
def test_nothing_overturns_where_the_scan_does_not_look_below(motion):
    random = np.random.default_rng(9)
    omega, eta = random.uniform(0.3, 30.0, 4000), random.uniform(0.0, 1.0, 4000)
    bound = omega / path(motion)
    outcome = linear_response(motion, random.uniform(0.9, 1.0, 4000) * bound, omega, eta).outcome
    assert set(outcome.tolist()) <= {Outcome.NO_UPLIFT, Outcome.ROCKED}


def test_an_impulse_overturns_just_above_that_bound():
    traced = trace_envelope(sine(0.5), [60.0], dimensionless_oscillator(0.9), a_max=40.0)
    assert traced[0].a_from == pytest.approx(60.0 / path(sine(0.5)), rel=0.05)


def path(motion):
    """int |s| dphi by the trapezium rule."""
    phase = np.linspace(0.0, motion.duration, 200_001)
    return float(np.trapezoid(np.abs(motion.value(phase)), phase))


@pytest.mark.parametrize("motion", MOTIONS[:6], ids=lambda m: m.name)
def test_above_overturning_without_impact_there_is_nothing_else(motion):
    random = np.random.default_rng(10)
    omega, eta = random.uniform(0.3, 12.0, 4000), random.uniform(0.0, 1.0, 4000)
    amplitude = random.uniform(1.0, 30.0, 4000)
    over = np.flatnonzero(linear_response(motion, amplitude, omega, eta).outcome == Outcome.OVERTURNED_NO_IMPACT)
    assert over.size > 500
    for factor in (1.001, 1.1, 2.0, 10.0):
        above = linear_response(motion, factor * amplitude[over], omega[over], eta[over]).outcome
        assert set(above.tolist()) == {Outcome.OVERTURNED_NO_IMPACT}


class Plain:
    """The linear model, of which the search knows nothing that would spare it a look."""

    def __getattr__(self, name):
        return getattr(LinearModel(), name)


@pytest.mark.parametrize("motion", [sine(), cosine(1), sine(0.5)], ids=lambda m: m.name)
def test_what_the_scan_leaves_out_changes_nothing(motion):
    omegas = np.array([0.8, 2.3, 5.0, 9.1])
    spared = Search(LinearModel(), motion, 0.9, 16.0).rows(omegas)
    assert spared == Search(Plain(), motion, 0.9, 16.0).rows(omegas)
    assert sum(len(row.changes) for row in spared) > 3


def test_workers_change_nothing():
    omegas = np.linspace(2.0, 6.0, 7)
    one, two = (trace_envelope(sine(), omegas, dimensionless_oscillator(0.9), a_max=9.0, workers=w) for w in (1, 2))
    assert one == two
    with pytest.raises(UsageError, match="workers is 0"):
        trace_envelope(sine(), omegas, dimensionless_oscillator(0.9), workers=0)


@pytest.mark.parametrize("a_max", [1.0, 0.0, -3.0, np.nan, np.inf, 1e9])
def test_a_max_must_make_sense(a_max):
    with pytest.raises(UsageError, match="a-max"):
        trace_envelope(sine(), [2.0], dimensionless_oscillator(0.9), a_max=a_max)


def test_closed_form_only_where_there_is_one():
    with pytest.raises(ValueError, match="accepted"):
        no_impact_amplitude(3.0, "cosine")
