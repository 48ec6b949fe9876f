"""The linear engine against independent numbers, closed forms and
its own invariances.
"""

import math
import os
import platform
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
from support.bodies import SYSTEMS
from support.references import INTERVALS, LADDER, MIXED, answers
from support.soak import quick
from support.synthetic_records import (
    RECORDS,
    allowance,
    assert_same,
    motion_of_samples,
    weighed,
)

from rocking_cli import Motion, Outcome, cosine, linear_response, pulse, response, sine
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.motions.biaxial import with_vertical


@pytest.mark.parametrize(("omega", "begin", "end", "no_impact", "digit"), INTERVALS)
def test_outcome_changes_where_the_reference_table_says(
    omega, begin, end, no_impact, digit
):
    amplitude = np.array(
        [
            begin - digit,
            begin + digit,
            end - digit,
            end + digit,
            no_impact - digit,
            no_impact + digit,
        ]
    )
    outcome = linear_response(sine(), amplitude, omega, 0.9).outcome
    after, without = Outcome.OVERTURNED_AFTER_IMPACT, Outcome.OVERTURNED_NO_IMPACT
    assert outcome.tolist() == [
        Outcome.ROCKED,
        after,
        after,
        Outcome.ROCKED,
        Outcome.ROCKED,
        without,
    ]


def compare(motion, *cells):
    """Every cell to what errors of 4e-15 come to in it."""
    found, (outcome, theta, impacts) = (
        linear_response(motion, *cells),
        answers(motion, *cells),
    )
    assert_same(found, theta, outcome, 4e-3 * allowance(motion, *cells))
    few = impacts < 10  # the oracle ends a sequence of impacts by a threshold
    np.testing.assert_array_equal(found.impacts_at_least[few], impacts[few])


@pytest.mark.parametrize("n", [30, pytest.param(200, marks=pytest.mark.soak)])
def test_random_cells_equal_an_independent_integration(n):
    random = np.random.default_rng(1)
    amplitude, omega, eta = (
        random.uniform(0.5, 12, 200),
        random.uniform(0.5, 12, 200),
        random.uniform(0.5, 1, 200),
    )
    compare(sine(), amplitude[:n], omega[:n], eta[:n])


@pytest.mark.parametrize("n", [6, pytest.param(24, marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    ("motion", "largest"),
    [
        pytest.param(sine(0.5), 12, marks=pytest.mark.soak),
        pytest.param(sine(6), 4, marks=pytest.mark.soak),
        (cosine(2.5), 3),
        (LADDER, 6),
        (MIXED, 4),
    ],
    ids=lambda x: getattr(x, "name", ""),
)
def test_other_motions_equal_an_independent_integration(motion, largest, n):
    random = np.random.default_rng(2)
    draw = [
        random.uniform(low, high, 24)
        for low, high in ((0.9, largest), (0.5, 12), (0.5, 1))
    ]
    compare(motion, *(x[:n] for x in draw))


@pytest.mark.parametrize(
    ("amplitude", "omega", "peak"),  # in 60 digits: the closed form at the root of y'
    [
        (1.001, 3.0, 4.99700212697253e-07),
        (1.001, 10.0, 4.4964839168937423e-08),
        (1.01, 3.0, 4.970211270508924e-05),
        (1.01, 10.0, 4.465099455444657e-06),
        (1.1, 3.0, 0.00471980249891647),
        (1.1, 10.0, 0.00041749898436687613),
    ],
)
def test_amplitudes_barely_above_uplift_keep_their_relative_accuracy(
    amplitude, omega, peak
):
    got = float(linear_response(sine(), amplitude, omega, 0.5).theta_ratio)
    condition_of_peak = (
        2 * amplitude / (amplitude - 1)
    )  # it is 9 (A - 1)^2/(2 Omega^2) at first
    assert abs(got / peak - 1) < np.finfo(float).eps * (2 * condition_of_peak + 150)


def test_first_uplift_and_no_uplift():
    response = linear_response(
        sine(), np.array([0.0, 0.5, 1.0, np.nextafter(1.0, 2.0)]), 3.0, 0.9
    )
    assert response.outcome.tolist() == [Outcome.NO_UPLIFT] * 3 + [Outcome.ROCKED]
    assert response.theta_ratio[:3].tolist() == [0.0] * 3


ORDERED = {
    "sine": sine(1.5),
    "ricker": pulse("ricker-symmetric"),
    "sine upwards": with_vertical(sine(), cosine(), 0.4),
    "record": motion_of_samples(RECORDS[0][30:70], 0.05),
    "record upwards": weighed(slice(36, 52), 0.8, 2)[0],
}


@pytest.mark.parametrize("rows", [15, pytest.param(1000, marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    "body",
    quick(
        ("the oscillator", "a body", "a damped body of unlike edges"),
        "a damped body of unlike edges",
    ),
)
@pytest.mark.parametrize("motion", quick(ORDERED, "sine upwards", "record"))
def test_a_row_alone_has_the_digits_of_rows_in_any_order(body, motion, rows):
    random, (system, eta) = np.random.default_rng(4), SYSTEMS[body]
    motion = ORDERED[motion]
    slow, fast = (0.3, 12.0) if motion.acceleration is None else (0.1, 1.5)
    amplitude = random.uniform(0.9, 5.0, rows)
    omega = random.uniform(slow, fast, rows)
    whole = response(system, motion, amplitude, omega, eta)
    order = random.permutation(rows)
    other = response(system, motion, amplitude[order], omega[order], eta, pool=5)
    picked = slice(None, None, 5)
    alone = [
        response(system, motion, a, w, eta)
        for a, w in zip(amplitude[picked], omega[picked], strict=True)
    ]
    for name in ("theta_ratio", "outcome", "impacts_at_least"):
        found = getattr(whole, name)
        np.testing.assert_array_equal(getattr(other, name), found[order])
        each = [getattr(one, name) for one in alone]
        np.testing.assert_array_equal(each, found[picked])
    assert {Outcome.ROCKED} < set(whole.outcome.tolist())


def test_a_pulse_cut_into_pieces_is_the_same_pulse():
    cuts = np.linspace(0.0, 2 * math.pi, 8)
    pieces = tuple(
        Piece(float(a), float(b), (Harmonic(1.0),)) for a, b in pairwise(cuts)
    )
    grid = np.linspace(0.9, 8, 40)
    a = linear_response(sine(), grid[:, None], grid, 0.9)
    b = linear_response(Motion("cut", pieces), grid[:, None], grid, 0.9)
    assert np.array_equal(a.outcome, b.outcome)
    np.testing.assert_allclose(b.theta_ratio, a.theta_ratio, rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize(
    "bad",
    [
        {"amplitude": -1.0},
        {"amplitude": np.inf},
        {"omega": 0.0},
        {"omega": np.nan},
        {"eta": 1.1},
        {"eta": -0.1},
        {"eta": np.nan},
    ],
)
def test_numbers_out_of_range_are_refused(bad):
    with pytest.raises(ValueError, match=next(iter(bad))):
        linear_response(sine(), **{"amplitude": 2.0, "omega": 3.0, "eta": 0.9, **bad})


@pytest.mark.parametrize(
    (
        "motion",
        "amplitude",
        "omega",
        "eta",
        "theta",
        "tolerance",
    ),  # by closed-form arcs in 50 digits, with steps that pass no event
    [
        (
            cosine(5),
            743.56,
            80.335,
            0.3,
            0.6598258167426396,
            3e-13,
        ),  # A = 743: a rounding of the drive is 1e-13
        (cosine(40), 743.56, 2000.0, 0.3, 0.0036951909052310777, 1e-12),
        (sine(40), 200.0, 700.0, 0.7, 0.0499960913594055, 1e-13),
        (pulse("ricker-antisymmetric"), 30.0, 25.0, 0.5, 0.05040777378125502, 1e-15),
        (pulse("rectangular-impulse"), 3.0, 30.0, 0.5, 0.08054332243517943, 1e-15),
        (sine(), 1.0 + 1e-9, 1.0, 0.5, 4.5000007491633706e-18, 1e-24),
    ],
)
def test_cells_equal_fifty_digits(motion, amplitude, omega, eta, theta, tolerance):
    found = linear_response(motion, amplitude, omega, eta)
    assert found.outcome == Outcome.ROCKED
    assert float(found.theta_ratio) == pytest.approx(theta, rel=0.0, abs=tolerance)


CODE = """
import resource
import numpy as np
from rocking_cli import linear_response, sine
axis = np.linspace(0.5, 12.0, 200)
for _ in range(3):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    linear_response(sine(), axis[None, :], axis[:, None], 0.9)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.soak
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another C library")
@pytest.mark.parametrize(
    "asked",
    [{}, {"MALLOC_TRIM_THRESHOLD_": "65536"}],
)
def test_a_march_faults_in_no_memory_that_it_had_before(asked):
    done = subprocess.run(
        [sys.executable, "-c", CODE],
        env={**os.environ, **asked},
        capture_output=True,
        text=True,
        check=True,
    )
    assert (
        int(done.stdout) < 1000
    )  # pages; 16,000 where each round gets its arrays anew
