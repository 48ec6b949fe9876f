"""Records by exact propagation and by Taylor steps: against an integration that shares no code, and what changes nothing."""

import math
from functools import partial

import numpy as np
import pytest
from oracles.record_lockstep import LINEAR, Rigid, lockstep
from support.synthetic_records import RECORDS, allowance, assert_same, cells, shaken

from rocking_cli import Method, RockingParameters, linear_response, nonlinear_response, response
from rocking_cli.structures.parameters import Side

ALPHA = 0.25
RESPOND = {"linear": linear_response, "nonlinear": partial(nonlinear_response, alpha=ALPHA)}
ROOM = {"linear": 1.0, "nonlinear": 1e3}  # times rounding: the tolerance of series


@pytest.mark.parametrize(
    ("model", "record", "part", "count", "etas"),
    [
        *(("linear", record, slice(None), 12, (0.5, 0.9, 0.0)) for record in range(3)),
        ("linear", 0, slice(None), 6, (1.0,)),
        ("nonlinear", 2, slice(35, 80), 20, (0.7,)),
        *(pytest.param("linear", n, slice(None), 4000, eta, marks=pytest.mark.soak) for n in range(3) for eta in ((0.5, 0.9, 0.0), (1.0,))),
        *(pytest.param("nonlinear", n, slice(None), 2000, (e,), marks=pytest.mark.soak) for n in range(3) for e in (0.5, 0.9, 1.0)),
    ],
)
def test_records_against_an_integration_that_shares_no_code(model, record, part, count, etas):
    motion, respond = shaken(RECORDS[record][part], 0.04), RESPOND[model]
    (amplitude, omega), eta = cells(count, record), np.resize(etas, count)
    if 1.0 in etas:  # without loss some never end: only those that bounce little
        amplitude += 2.0
        for less, most in ((0.98, 40), (1.0, 200)):
            few = respond(motion, amplitude, omega, less).impacts < most
            amplitude, omega, eta = amplitude[few], omega[few], eta[few]
    found, body, scale = respond(motion, amplitude, omega, eta), LINEAR, 1.0
    if model == "nonlinear":
        body, scale = Rigid(ALPHA), ALPHA / math.tan(ALPHA)
    outcome, theta = lockstep(*reversed(motion.samples), scale * amplitude, omega, eta, body)
    assert_same(found, theta, outcome, ROOM[model] * allowance(motion, amplitude, omega, eta, respond))
    assert np.unique(outcome).size >= 2 or 1.0 in etas


@pytest.mark.parametrize("model", RESPOND)
def test_what_changes_nothing(model):
    """The mirrored, refined, delayed and continued record, and the scaled record against the scaled amplitude."""
    samples, respond = np.concatenate([[0.0], RECORDS[2][31:89], [0.0]]), RESPOND[model]
    (amplitude, omega), eta, motion = cells(16, 7), np.full(16, 0.8), shaken(samples, 0.04)
    first = respond(motion, amplitude, omega, eta)
    for same in (shaken(-samples, 0.04), shaken(4.0 * samples, 0.04)):
        np.testing.assert_array_equal(respond(same, amplitude, omega, eta).theta_ratio, first.theta_ratio)
    fine = np.interp(np.arange(4 * samples.size - 3) / 4.0, np.arange(samples.size), samples)
    allowed = ROOM[model] * allowance(motion, amplitude, omega, eta, respond)
    delayed, continued = np.append(np.zeros(33), samples), np.append(samples, np.zeros(100))
    for other in (shaken(fine, 0.01), shaken(delayed, 0.04), shaken(continued, 0.04)):
        assert_same(respond(other, amplitude, omega, eta), first.theta_ratio, first.outcome, allowed)


@pytest.mark.parametrize("model", RESPOND)
def test_a_record_turned_over_is_a_body_turned_round(model):
    """Of unlike edges: the other edge goes where the first one did."""
    edges = (2.0, 0.2, math.tan(0.2), 1.0, 0.7), (2.2, 0.26, math.tan(0.26), 1.0, 0.5)
    motion, (amplitude, omega) = shaken(RECORDS[0][30:70], 0.05), cells(12, 3)

    def found(first, other, shaking):
        body = RockingParameters.of_sides("b", "prism", Side("left", *first), Side("right", *other))
        return response(Method(model).system_of(body), shaking, amplitude, omega, body.eta)

    here, there, still = found(*edges, motion.scaled(-1.0)), found(*edges[::-1], motion), found(*edges, motion)
    np.testing.assert_array_equal(here.outcome, there.outcome)
    np.testing.assert_allclose(here.theta_ratio, there.theta_ratio, rtol=1e-13)
    assert not np.allclose(here.theta_ratio, still.theta_ratio, rtol=1e-3, equal_nan=True)
