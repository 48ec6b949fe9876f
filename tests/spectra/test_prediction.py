"""Predictions: computed, with a margin inside which the fate does not change."""

import numpy as np
import pytest
from support.documents import built

from rocking_cli import (
    closed_form_curves,
    dimensionless_oscillator,
    linear_response,
    parse_grid,
    trace_envelope,
    write_spectrum,
)
from rocking_cli.dynamics.outcome import Outcome, overturned, safe
from rocking_cli.errors import UsageError
from rocking_cli.motions import pulse, sine
from rocking_cli.spectra.file.reader import SpectraFile
from rocking_cli.spectra.prediction import predict, predict_exactly


def cell(amplitude, omega):
    return parse_grid(f"A={amplitude!r},Omega={omega!r}")


def fate(motion, amplitude, omega, eta):
    return overturned(
        linear_response(motion, np.asarray(amplitude), omega, eta).outcome
    )


@pytest.fixture(scope="module")
def three_cycles(tmp_path_factory):
    path = tmp_path_factory.mktemp("spectra") / "three.h5"
    write_spectrum(
        [dimensionless_oscillator(eta=0.8)],
        sine(3),
        parse_grid("A=1:8:8,Omega=1:8:8"),
        path,
        workers=1,
    )
    with SpectraFile(path) as file:
        yield file


def test_a_demand_beyond_the_scan_is_refused_by_its_own_name():
    with pytest.raises(
        UsageError, match=r"^eta=0.8: found A = 60000; expected up to 50000$"
    ):
        predict_exactly(dimensionless_oscillator(eta=0.8), sine(1), cell(6e4, 2.0))


@pytest.mark.soak
def test_the_fate_is_one_within_the_margin_and_another_beyond(three_cycles):
    random = np.random.default_rng(7)
    sides = set()
    for _ in range(2):
        amplitude, omega = float(random.uniform(1, 5)), float(random.uniform(4, 6))
        found = predict(
            dimensionless_oscillator(eta=0.8), three_cycles, cell(amplitude, omega)
        )
        if found["margin"] is None:
            continue
        sides.add((found["margin_side"], Outcome[found["outcome"].upper()].overturned))
        inside = amplitude * (
            1.0 + found["margin"] * np.linspace(-1 + 1e-9, 1 - 1e-9, 201)
        )
        assert set(fate(sine(3), inside[inside > 0], omega, 0.8).tolist()) == {
            Outcome[found["outcome"].upper()].overturned
        }
        sign = 1 if found["margin_side"] == "above" else -1
        edge = amplitude * (1.0 + sign * found["margin"])
        assert fate(sine(3), edge * (1 - 1e-12), omega, 0.8) != fate(
            sine(3), edge * (1 + 1e-12), omega, 0.8
        )
        demand = amplitude * found["capacity_demand"]
        assert safe(
            linear_response(
                sine(3), demand * np.linspace(0.5, 1 - 1e-12, 201), omega, 0.8
            ).outcome
        ).all()
        assert fate(sine(3), demand * (1 + 1e-12), omega, 0.8)
    assert {side for side, _ in sides} == {"above", "below"}
    assert {fell for _, fell in sides} == {True, False}


def test_capacity_is_that_of_the_closed_form():
    points = {p.curve: p.amplitude for p in closed_form_curves(np.array([3.0]), 0.9)}
    first, last = points["after_impact_lower"], points["after_impact_upper"]
    for amplitude in (1.5, 0.5 * (first + last)):
        found = predict_exactly(
            dimensionless_oscillator(eta=0.9), sine(), cell(amplitude, 3.0)
        )
        assert found["capacity_demand"] == pytest.approx(
            first / amplitude, rel=1e-10, abs=0
        )
        assert (found["theta_ratio"] is None) == (amplitude > first)


def test_two_ways_to_fall_that_meet_are_no_boundary():
    """A rectangular pulse: where falling after an impact and without one touch, the
    margin reaches over that point.
    """
    found = predict_exactly(
        dimensionless_oscillator(eta=1.0), pulse("rectangular"), cell(3.0, 2.0)
    )
    assert found["margin_side"] == "below"
    edge = 3.0 * (1.0 - found["margin"])
    assert fate(
        pulse("rectangular"), np.linspace(edge * (1 + 1e-9), 6.0, 1001), 2.0, 1.0
    ).all()
    assert not fate(pulse("rectangular"), edge * (1 - 1e-9), 2.0, 1.0)


@pytest.mark.soak
def test_a_cell_that_the_spectrum_knows_is_interpolated_exactly(three_cycles):
    found = predict(dimensionless_oscillator(eta=0.8), three_cycles, cell(2.0, 7.0))
    assert found["interpolation_error"] == 0.0


@pytest.mark.slow
def test_a_body_of_unequal_edges_is_judged_under_the_motion_as_it_is():
    """Its capacity is that of the sign it is shaken with, which the outcome is of too,
    not of the worse one.
    """
    body = built("kind: prism\ncorners: [[0, 0], [1.2, 0], [0.9, 5], [0.2, 5]]")
    for motion, amplitude in ((sine().scaled(-1.0), 2.6),):
        traced = trace_envelope(body, motion, [3.0], a_max=3.0, sign="+", workers=1)
        found = predict_exactly(body, motion, parse_grid(f"A={amplitude},Omega=3"))
        falls = [i for i in traced if i.a_from < amplitude < (i.a_to or np.inf)]
        assert (found["outcome"] == "rocked") == (not falls)
        assert found["capacity_demand"] == traced[0].a_from / amplitude
        assert found["theta_max"] is None
