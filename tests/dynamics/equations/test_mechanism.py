"""The nonlinear mechanism (Eq. 3.4): its tables, its energy, its periods, and cells
against independent integrations.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from support.documents import built

from rocking_cli import Method, Outcome, cosine, linear_response, pulse, sine
from rocking_cli.dynamics.equations.mechanism import MechanismEquation
from rocking_cli.dynamics.response import response
from rocking_cli.dynamics.system import System
from rocking_cli.responses.history import history, quarter_period

ARCHES = {
    "oppenheim": "radius: 10 m\nthickness: 1.5 m\nangle: 157.5 deg\nvoussoirs: 7",
    "thick": "radius: 10 m\nthickness: 2.5 m\nangle: 150 deg",
    "barely stands": "radius: 10 m\nthickness: 1.09 m\nangle: 180 deg",
}


@pytest.fixture(scope="module", params=list(ARCHES))
def arch(request):
    return built(f"kind: arch\nrestitution: 0.8\n{ARCHES[request.param]}")


@pytest.fixture(scope="module")
def oppenheim():
    return built(f"kind: arch\n{ARCHES['oppenheim']}")


def test_tables_are_the_linkage_to_rounding(arch):
    table = MechanismEquation(arch.mechanism).table
    y = np.linspace(0.0, table.edges[-1], 2001)
    phi = table.value(table.turn, y) * arch.alpha
    at, rest = arch.mechanism.coefficients(phi), arch.mechanism.coefficients(0.0)
    root, root0 = np.sqrt(at.inertia), math.sqrt(rest.inertia)
    lift = at.lift / root / (rest.lift / root0)
    assert np.abs(table.value(table.lift, y) - lift).max() < 1e-12 * np.abs(lift).max()
    assert (
        np.abs(table.value(table.push, y) - at.push / root / (rest.push / root0)).max()
        < 1e-12
    )
    rate = arch.p**2 / arch.gravity * root0 / float(rest.lift)
    expected = quad(
        lambda f: rate * math.sqrt(arch.mechanism.coefficients(f).inertia),
        0.0,
        arch.alpha,
        epsabs=1e-12,
        epsrel=1e-12,
    )[0]
    assert MechanismEquation(arch.mechanism).top == pytest.approx(
        expected, rel=1e-10, abs=0
    )


@pytest.mark.parametrize("start", [0.1, 0.9])
def test_free_quarter_period_equals_the_quadrature(arch, start):
    """T/4 = integral of sqrt(M) dphi / sqrt(2 g int L dphi), with the singularity taken
    out by phi = phi0 - u^2.
    """
    coefficients, phi0 = arch.mechanism.coefficients, start * arch.alpha
    nodes, weights = np.polynomial.legendre.leggauss(60)

    def slowness(u):
        phi = phi0 - u * u
        spots = phi + 0.5 * u * u * (nodes + 1.0)
        fall = 0.5 * u * u * float(weights @ coefficients(spots).lift)
        return (
            2.0
            * u
            * math.sqrt(float(coefficients(phi).inertia) / (2.0 * arch.gravity * fall))
        )

    grid, w = np.polynomial.legendre.leggauss(80)
    half = 0.5 * math.sqrt(phi0)
    expected = (
        arch.p
        * half
        * sum(wi * slowness(half * (x + 1.0)) for x, wi in zip(grid, w, strict=True))
    )
    assert quarter_period(
        System(MechanismEquation(arch.mechanism, 1e-12)), start
    ) == pytest.approx(expected, rel=1e-9, abs=0)


def test_oppenheims_arch_rocks_slower_than_its_linear_oscillator(oppenheim):
    # Free rocking from 0.3, 0.6, 0.9 alpha, computed by an independent program: 1.0737,
    # 1.0622, 1.0441 (Fig. 7b).
    model = MechanismEquation(oppenheim.mechanism, 1e-11)
    ratios = [
        quarter_period(System(model), x) / math.acosh(1.0 / (1.0 - x))
        for x in (0.3, 0.6, 0.9)
    ]
    assert ratios == pytest.approx([1.0737, 1.0622, 1.0441], abs=2e-4)


@pytest.mark.parametrize(
    ("motion", "times", "damping"),
    [
        (pulse("rectangular-impulse"), [0.42, 0.45, 0.5, 0.55], 0.1),
        (cosine(), [0.03, 0.06, 0.09, 0.12], 0.0),
    ],
)
def test_first_arc_is_the_paper_s_equation(oppenheim, motion, times, damping):
    """Eq. 3.4 as it stands, M phi'' + M'/2 phi'^2 + V' = -B xg'', in SI units, with M'
    by differences; damped by 2 zeta p M phi'.
    """
    arch, a_g, t_p = oppenheim, 0.52 * 9.81, 0.4
    coefficients, h = arch.mechanism.coefficients, 1e-3 * arch.alpha
    omega = 2 * math.pi / t_p

    def rate(t, state):
        phi, speed = state
        c = coefficients(phi)
        around = coefficients(phi + h * np.array([-2.0, -1.0, 1.0, 2.0])).inertia
        slope = (around[0] - 8 * around[1] + 8 * around[2] - around[3]) / (12 * h)
        ground = a_g * float(
            motion.value(omega * t)
        )  # drives the arch to the side of positive phi here
        force = (
            float(c.push) * ground
            - arch.gravity * float(c.lift)
            - 0.5 * slope * speed**2
        )
        return [speed, force / float(c.inertia) - 2.0 * damping * arch.p * speed]

    state, begin, expected = np.zeros(2), 0.0, []
    for end in (*([t_p] if times[0] > t_p else []), *times):
        arc = solve_ivp(
            rate,
            (begin, end * (1 - 1e-15)),
            state,
            method="DOP853",
            rtol=1e-12,
            atol=1e-14,
        )
        state, begin = arc.y[:, -1], end * (1 + 1e-15)
        expected.append(state)
    expected = np.array(expected[-4:]).T
    amplitude = float(arch.dimensionless_amplitude(a_g))
    system = System(MechanismEquation(arch.mechanism, 1e-12, damping))
    found = history(system, motion, amplitude, omega / arch.p, arch.eta, duration=2.0)
    ratio, speed = found.at(np.array(times) * arch.p)
    assert -ratio * arch.alpha == pytest.approx(expected[0], abs=1e-9)
    assert -speed * arch.alpha * arch.p == pytest.approx(expected[1], abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("n", "damping"),
    [(2, 0.0), (1, 0.1), pytest.param(12, 0.0, marks=pytest.mark.soak)],
)
def test_cells_stay_within_five_tolerances(oppenheim, n, damping):
    arch = replace(oppenheim, damping=damping)
    random, method = np.random.default_rng(5), Method("nonlinear")
    draw = np.array(
        [random.uniform(a, b, 12)[:n] for a, b in ((0.9, 9), (0.5, 12), (0.4, 1))]
    ).T
    expected = [
        method.reference_of(arch.with_restitution(eta))(sine(), *cell)
        for *cell, eta in draw.tolist()
    ]
    for tolerance in (1e-4, 1e-7, 1e-11):
        found = response(
            System(MechanismEquation(arch.mechanism, tolerance, damping)),
            sine(),
            *draw.T,
        )
        assert found.outcome.tolist() == [int(o) for o, _ in expected]
        gaps = [
            abs(a - b)
            for a, (_, b) in zip(found.theta_ratio, expected, strict=True)
            if not math.isnan(b)
        ]
        assert len(gaps) >= n // 4
        assert max(gaps) < 5 * tolerance


def test_the_least_tolerance_is_kept(oppenheim):
    """A series has no more terms than F and G are given with."""
    coarse, fine = (
        response(
            System(MechanismEquation(oppenheim.mechanism, tolerance)),
            sine(),
            np.array([1.5, 1.8]),
            6.0,
            0.6,
        ).theta_ratio
        for tolerance in (1e-11, 1e-13)
    )
    np.testing.assert_allclose(fine, coarse, rtol=0.0, atol=5e-11)


def test_an_arch_that_barely_moves_is_its_linear_oscillator_to_first_order_in_alpha():
    """As alpha tends to 0 the nonlinear arch tends to the linear one: their difference
    is proportional to alpha, 0.0009 and 0.0002 here.
    """
    cells = np.array([[2.0, 6.0, 0.8], [5.5, 10.0, 0.8]])
    linear, slopes = linear_response(sine(), *cells.T), []
    for thickness in (1.09, 1.0776):
        arch = built(
            f"kind: arch\nrestitution: 0.8\nradius: 10 m\nthickness: {thickness}"
            " m\nangle: 180 deg"
        )
        found = response(Method("nonlinear").system_of(arch), sine(), *cells.T)
        assert found.outcome.tolist() == linear.outcome.tolist() == [Outcome.ROCKED] * 2
        slopes.append((found.theta_ratio / linear.theta_ratio - 1.0) / arch.alpha)
    assert slopes[1] == pytest.approx(slopes[0], rel=0.05, abs=0)  # the second order


@pytest.mark.parametrize(
    ("thickness", "angle"),
    [(0.795, 100), (2.0, 140)],
)
def test_ordinary_arches_have_a_nonlinear_model(thickness, angle):
    arch = built(
        f"kind: arch\nradius: 10\nthickness: {thickness}\nangle: {angle}"
        " deg\nrestitution: 0.8"
    )
    assert MechanismEquation(arch.mechanism).limit > 1.0
