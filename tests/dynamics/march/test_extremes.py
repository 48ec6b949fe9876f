"""Stiff and extreme cells: never NaN without an outcome, never a hang, and the closed
form or the limit where there is one.
"""

import math

import numpy as np
import pytest
from support.documents import built
from support.references import reference
from support.soak import quick
from support.synthetic_records import motion_of_samples

from rocking_cli import (
    LinearEquation,
    Method,
    Motion,
    Outcome,
    System,
    cosine,
    dimensionless_oscillator,
    linear_response,
    nonlinear_response,
    parse_grid,
    pulse,
    response,
    safe,
    sine,
    spectrum,
    trace_envelope,
)
from rocking_cli.dynamics import batch
from rocking_cli.dynamics.contacts.contact import OneSided
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.motions.biaxial import with_vertical

DECIDED = (
    Outcome.NO_UPLIFT,
    Outcome.ROCKED,
    Outcome.OVERTURNED_NO_IMPACT,
    Outcome.OVERTURNED_AFTER_IMPACT,
)


def both(amplitude, omega, eta, alpha=0.25, motion=None):
    """(linear, nonlinear) responses of a cell, the amplitude over that of uplift."""
    motion = motion or sine()
    return (
        linear_response(motion, amplitude, omega, eta),
        nonlinear_response(
            motion,
            np.asarray(amplitude) * math.tan(alpha) / alpha,
            omega,
            eta,
            alpha,
            tolerance=1e-11,
        ),
    )


def assert_decided(*responses):
    """Every cell has an outcome, a rotation where it rocks and none where it falls."""
    for found in responses:
        assert set(found.outcome.tolist()) <= set(DECIDED)
        assert np.isfinite(found.theta_ratio[found.outcome == Outcome.ROCKED]).all()
        assert np.isnan(found.theta_ratio[~safe(found.outcome)]).all()


@pytest.mark.parametrize("omega", quick((1e-4, 1e-2, 1.0, 1e2, 1e4), 1e-4, 1.0, 1e4))
@pytest.mark.parametrize("eta", quick((0.0, 1e-6, 0.9, 0.99, 0.999), 0.0, 0.9))
def test_amplitudes_from_uplift_to_1e8_are_decided(omega, eta):
    amplitude = np.array([1 + 1e-12, 1 + 1e-9, 1.001, 1.1, 2.0, 1e2, 1e4, 1e8])
    assert_decided(*both(amplitude, omega, eta))


@pytest.mark.parametrize("motion", [cosine(1), sine(5.5)], ids=lambda m: m.name)
def test_drives_that_jump_and_many_half_cycles_are_decided_too(motion):
    amplitude, omega, eta = (
        np.ravel(x)
        for x in np.meshgrid([1 + 1e-12, 1.001, 2.0, 1e8], [1e-4, 1.0, 1e4], [0.0, 0.9])
    )
    assert_decided(*both(amplitude, omega, eta, motion=motion))


@pytest.mark.parametrize("omega", [1.0, 1e2, 1e4])
def test_peak_just_above_uplift_is_its_expansion(omega):
    """A = 1 + d: the body lifts for 2 sqrt(2 d)/Omega; y'' = d - (Omega tau)^2/2 gives
    a peak of 9 d^2/(2 Omega^2) as d tends to 0.
    """
    d = np.array([1e-12, 1e-10, 1e-8])
    expected = 4.5 * ((1.0 + d) - 1.0) ** 2 / omega**2
    linear, rigid = both(1.0 + d, omega, 0.9)
    assert (linear.outcome == Outcome.ROCKED).all()
    assert (rigid.outcome == Outcome.ROCKED).all()
    assert linear.theta_ratio == pytest.approx(expected, rel=2e-8, abs=0)
    assert rigid.theta_ratio == pytest.approx(
        expected * math.sin(0.25) / 0.25, rel=1e-3, abs=0
    )


def test_slow_pulses_are_statics_and_fast_ones_are_impulses():
    slow, slow_rigid = both(np.array([0.999999, 1.000001, 2.0]), 1e-6, 0.5)  # p T = 6e6
    for found in (slow, slow_rigid):
        assert found.outcome[0] == Outcome.NO_UPLIFT
        assert found.outcome[2] == Outcome.OVERTURNED_NO_IMPACT
    # A half sine much shorter than 1/p is a velocity 2 A/Omega less what the body's
    # weight takes: it overturns at v = 1.
    omega = 1e4
    (found,) = [
        i
        for i in trace_envelope(
            dimensionless_oscillator(eta=0.5), pulse("half-sine"), [omega], a_max=6000
        )
        if i.mode == "no_impact"
    ]
    assert found.a_from == pytest.approx(omega / 2, rel=1e-3, abs=0)


STRONG = np.array([1 + 1e-12, 1.001, 2.0, 1e2, 1e8])
NEAR = np.array([1.0001, 1.5, 8.0])


@pytest.mark.parametrize(
    (
        "motion",
        "amplitude",
        "omega",
        "eta",
        "alpha",
        "linear",
        "nonlinear",
    ),  # the last two: the largest error of theta/alpha
    [
        *(
            (sine(), STRONG, omega, eta, 0.25, 1e-16, 1e-14)
            for omega, eta in ((1e-4, 0.0), (1.0, 0.9), (1e4, 0.9))
        ),
        (pulse("half-sine"), np.linspace(1000, 9000, 3), 1e4, 0.5, 0.25, 5e-13, 5e-13),
        *(
            (sine(), NEAR, omega, 0.9, alpha, 1e-14, 1e-12)
            for omega, alpha in ((0.5, 1e-6), (4.0, 1.2), (20.0, 1e-3))
        ),
        (
            pulse("rectangular-impulse"),
            np.array([1.5, 2.0 + 1e-6, 3.0]),
            3.0,
            0.5,
            0.25,
            1e-13,
            1e-13,
        ),
        (
            pulse("rectangular-impulse"),
            np.array([1.5, 2.0 + 1e-6, 3.0]),
            300.0,
            0.5,
            0.25,
            1e-13,
            1e-13,
        ),
        pytest.param(
            sine(100),
            np.array([1.0005, 1.2]),
            30.0,
            0.2,
            0.25,
            1e-16,
            1e-15,
            marks=pytest.mark.soak,
        ),
    ],
    ids=lambda x: getattr(x, "name", str(x) if np.isscalar(x) else ""),
)
def test_stiff_cells_equal_the_slower_path(
    motion, amplitude, omega, eta, alpha, linear, nonlinear
):
    """Bodies that rise by less than 1e-7 bounce through thousands of steps of the
    slower path; of those the expansion above is the test.
    """
    lift = math.tan(alpha) / alpha
    for found, angle, scale, most in zip(
        both(amplitude, omega, eta, alpha, motion),
        (None, alpha),
        (1.0, lift),
        (linear, nonlinear),
        strict=True,
    ):
        for a, outcome, theta in zip(
            amplitude, found.outcome, found.theta_ratio, strict=True
        ):
            if angle is None or omega < 1.0 or a > 1.01:
                expected = reference(motion, scale * a, omega, eta, angle)
                assert outcome == expected[0], a
                assert theta == pytest.approx(expected[1], rel=0, abs=most, nan_ok=True)


@pytest.mark.slow
def test_a_hundred_thousand_impacts_end_in_an_outcome(monkeypatch):
    """Without loss a body just above uplift never stops bouncing: the cell is given up
    as failed after a bounded number of steps.
    """
    monkeypatch.setattr(batch, "MAX_STEPS", 300)
    found = linear_response(sine(), 1 + 2e-3, 1.0, 1.0)
    assert found.outcome == Outcome.FAILED
    assert 270 < int(found.impacts_at_least) < 2 * 300


@pytest.mark.parametrize("omega", quick((2.0, 5.0), 5.0))
def test_cells_next_to_a_boundary_have_an_outcome_and_its_rotation(omega):
    for interval in trace_envelope(
        dimensionless_oscillator(eta=0.9), sine(), [omega], a_max=10
    ):
        for edge in (a for a in (interval.a_from, interval.a_to) if a is not None):
            assert_decided(
                linear_response(
                    sine(), edge * (1 + 1e-13 * np.arange(-10, 11)), omega, 0.9
                )
            )
            for a in (edge * (1 - 1e-9), edge * (1 + 1e-9)):
                found, (outcome, theta) = (
                    linear_response(sine(), a, omega, 0.9),
                    reference(sine(), a, omega, 0.9),
                )
                assert found.outcome == outcome
                assert float(found.theta_ratio) == pytest.approx(
                    theta, rel=0, abs=5e-10, nan_ok=True
                )


def test_uplift_on_the_edge_of_a_piece():
    """The push of -A/2 that follows lifts a resting body on the other side above A = 2;
    at A = 2 exactly it does not.
    """
    motion = pulse("rectangular-impulse")
    assert_decided(
        *(
            x
            for a, omega in ((2.0, 300.0), (2.0 + 1e-12, 300.0), (1.0 + 1e-15, 3.0))
            for x in both([a], omega, 0.0, motion=motion)
        )
    )
    assert linear_response(cosine(), 1.0 + 1e-15, 2.0, 0.5).outcome == Outcome.ROCKED
    assert linear_response(cosine(), 1.0, 2.0, 0.5).outcome == Outcome.NO_UPLIFT


@pytest.mark.parametrize(
    ("thickness", "amplitude"),
    [
        (1.1, 1.5),
        # of these the polynomials of the reference take seconds
        pytest.param(1.0751, 1.5, marks=pytest.mark.soak),
        pytest.param(1.0751, 12.0, marks=pytest.mark.soak),
    ],
)
def test_an_arch_at_the_edge_of_stability(thickness, amplitude):
    """Two rock and one overturns."""
    arch = built(
        f"{{kind: arch, radius: 10, thickness: {thickness}, angle: 180 deg,"
        " restitution: 0.8}"
    )
    assert 0.0 < arch.uplift < 0.01
    system = Method("nonlinear", 1e-11).system_of(arch)
    found = response(system, sine(), amplitude, 4.0, 0.8)
    outcome, theta = Method("nonlinear", 1e-9).reference_of(arch)(
        sine(), amplitude, 4.0
    )
    assert found.outcome == outcome
    assert float(found.theta_ratio) == pytest.approx(theta, abs=5e-10, nan_ok=True)


@pytest.mark.parametrize(
    "grid",
    [
        "a_g=1e-310:2e-310:3,omega_g=1:2:3",
        "a_g=1e300:1e301:3,omega_g=1e-3:1:3",
        "a_g=1e290:1e291:3,omega_g=1e9:1e10:3",
    ],
)
def test_denormal_and_huge_inputs_have_an_outcome(grid):
    found = spectrum(
        [built("kind: block\nwidth: 0.5\nheight: 2")], sine(), parse_grid(grid), check=0
    )
    assert not np.any(found.outcome == Outcome.NOT_COMPUTED)
    assert np.isfinite(found.theta_ratio[found.outcome == Outcome.ROCKED]).all()


@pytest.mark.parametrize(("cells", "pool"), [(3, 1), (5000, None)])
def test_ground_that_falls_away_before_any_uplift_ends_every_cell(cells, pool):
    """The first cells of the pool end before they begin."""
    down = Motion("down", (Piece(0.0, 2.0 * math.pi, (Harmonic(1.0, 1.0, math.pi),)),))
    motion = with_vertical(sine(), down, 3.0)
    system = System(LinearEquation(), OneSided(), 0.2)
    amplitude = np.linspace(3.0, 5.0, cells)
    found = response(system, motion, amplitude, 6.0, -0.5, pool=pool)
    assert set(found.outcome.tolist()) == {Outcome.LOST_CONTACT}


@pytest.mark.parametrize("above", [1, 2, 3])
def test_a_body_that_rounding_lifts_at_an_extreme_of_the_drive_is_decided(above):
    """It has no acceleration and a falling drive: its turn and its fall are at once."""
    for first, second in ((1.0, 0.4), (0.5, 0.2), (1.0, 0.2)):
        waves = Harmonic(1.0, 1.0), Harmonic(first, 2.0), Harmonic(second, 3.0)
        motion = Motion("waves", (Piece(0.0, 6.0, waves),))
        amplitude = 1.0 / motion.largest
        for _ in range(above):
            amplitude = np.nextafter(amplitude, 9.0)
        found = linear_response(motion, amplitude, 1.0, 0.9)
        assert Outcome(int(found.outcome)) in DECIDED
        assert found.theta_ratio < 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_the_last_sample_of_a_record_may_lift_a_body_by_rounding(seed):
    samples = np.append(np.random.default_rng(seed).uniform(-1.0, 1.0, 3), 1.17)
    motion = motion_of_samples(samples, 0.1)
    for amplitude in (1.0 / motion.largest, np.nextafter(1.0 / motion.largest, 9.0)):
        found = linear_response(motion, amplitude, 1.0, 0.9)
        assert Outcome(int(found.outcome)) in DECIDED
        assert found.theta_ratio == pytest.approx(0.0, abs=1e-12)
