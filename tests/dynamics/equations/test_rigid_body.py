"""The nonlinear rigid body: independent numbers, order and tolerance, energy, periods, and the linear limit."""

import math

import numpy as np
import pytest
from support.documents import built
from support.references import integrated, lanes

from rocking_cli import Method, Outcome, cosine, linear_response, nonlinear_response, sine, trace_envelope
from rocking_cli.dynamics.equations.rigid_body import RigidBodyEquation
from rocking_cli.motions import Harmonic, Motion, Piece

BLOCK = "kind: block\nradius: 1.6065814 m\nalpha: 0.25\nrestitution: 0.9"


def test_overturning_intervals_of_the_reference_block():
    # alpha = 0.25, p = 2.14 rad/s, eta = 0.9, Omega = 5, in A = a_g/(alpha g); traced by two independent programs.
    found = trace_envelope(built(BLOCK), sine(), [5.0], method=Method("nonlinear"), a_max=9.0)
    assert [i.mode for i in found] == ["after_impact", "no_impact"]
    assert (found[0].a_from, found[0].a_to, found[1].a_from) == pytest.approx((3.03234, 6.74302, 7.49300), abs=1e-5)
    scale = 0.25 / math.tan(0.25)
    assert found[0].a_from * scale == pytest.approx(2.96890, abs=1e-5)


@pytest.mark.parametrize("n", [10, pytest.param(200, marks=pytest.mark.soak)])
@pytest.mark.parametrize(("motion", "most"), [(sine(), 12), (cosine(1.5), 5)], ids=["sine", "a jump at the start"])
def test_random_cells_stay_within_five_tolerances(motion, most, n):
    random, tolerances = np.random.default_rng(1), (1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11)
    draw = [random.uniform(a, b, 200)[:n] for a, b in ((0.9, most), (0.5, 12), (0.5, 1), (0.05, 0.6))]
    for amplitude, omega, eta, alpha in zip(*draw, strict=True):
        around = nonlinear_response(motion, amplitude * np.array([1 - 1e-7, 1 + 1e-7]), omega, eta, alpha, tolerance=1e-11).outcome
        flag, theta, _ = integrated(motion, amplitude, omega, eta, alpha)
        for tolerance in tolerances:
            found = nonlinear_response(motion, amplitude, omega, eta, alpha, tolerance=tolerance)
            if around[0] == around[1]:  # no boundary of outcome within 1e-7 of the amplitude
                assert Outcome(int(found.outcome)).flag == flag, tolerance
            assert math.isnan(theta) or abs(float(found.theta_ratio) - theta) < 5 * tolerance, tolerance


def series_from(model, y, v, segments=None):
    """The model's series on still ground from one state; a sinusoid, though of no height, calls for the long series."""
    still = segments or Motion("still", (Piece(0.0, 1.0, (Harmonic(0.0),)),)).segments
    b = -math.sin(model.alpha - model.sin * y) / model.sin
    return model.flow(still, lanes(y=y, v=v, b=b))


def test_order_of_the_flow_is_the_order_of_its_series():
    """Error after one step against its length, log-log slope by regression: the first term left out."""
    model = RigidBodyEquation(0.4, 1e-4)
    flow, exact = series_from(model, 0.3, 0.9), series_from(RigidBodyEquation(0.4, 1e-13), 0.3, 0.9)
    steps = np.geomspace(0.4, 0.8, 9)
    error = [abs(flow.at(np.array([h])).y[0] - exact.at(np.array([h])).y[0]) for h in steps]
    slope = np.polyfit(np.log(steps), np.log(error), 1)[0]
    assert abs(slope - (model.order + 1)) < 0.9


def test_small_angles_lead_to_the_linear_oscillator():
    """theta/alpha of Eq. 2.3 tends to that of Eq. 2.4 as alpha^2."""
    amplitude, omega = np.array([2.0, 4.0, 5.5]), np.array([6.0, 8.0, 10.0])
    linear = linear_response(sine(), amplitude, omega, 0.8).theta_ratio
    alphas = np.array([0.02, 0.04, 0.08])
    for i in range(3):
        gaps = [
            abs(float(nonlinear_response(sine(), amplitude[i], omega[i], 0.8, a, tolerance=1e-12).theta_ratio) - linear[i]) for a in alphas
        ]
        assert np.polyfit(np.log(alphas), np.log(gaps), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("bad", [{"alpha": 0.0}, {"alpha": 1.6}, {"tolerance": 0.0}, {"damping": -0.1}, {"damping": math.inf}])
def test_model_checks_its_numbers(bad):
    with pytest.raises(ValueError, match="expected"):
        RigidBodyEquation(**{"alpha": 0.2, "tolerance": 1e-9, **bad})
