"""The nonlinear rigid body: independent numbers, order and tolerance, energy, periods, and the linear limit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from rocking_cli import Method, Outcome, UsageError, cosine, linear_response, nonlinear_response, parse_documents, sine, trace_envelope
from rocking_cli import build_structure as build
from rocking_cli.dynamics.equations.linear import LinearModel
from rocking_cli.dynamics.equations.rigid_body import RigidModel
from rocking_cli.dynamics.march.advance import advance
from rocking_cli.dynamics.march.engine import response
from rocking_cli.dynamics.march.lanes import Lanes
from rocking_cli.dynamics.references.general_solver import RigidBody, reference_nonlinear
from rocking_cli.motions import Motion, Piece

BLOCK = "kind: block\nradius: 1.6065814 m\nalpha: 0.25\nrestitution: 0.9"


def test_overturning_intervals_of_the_reference_block():
    # alpha = 0.25, p = 2.14 rad/s, eta = 0.9, Omega = 5, in A = a_g/(alpha g); traced by two independent programs.
    (document,) = parse_documents(BLOCK)
    found = trace_envelope(sine(), [5.0], build(document), method=Method("nonlinear"), a_max=9.0)
    assert [i.mode for i in found] == ["after_impact", "no_impact"]
    assert (found[0].a_from, found[0].a_to, found[1].a_from) == pytest.approx((3.03234, 6.74302, 7.49300), abs=1e-5)
    scale = 0.25 / math.tan(0.25)
    assert found[0].a_from * scale == pytest.approx(2.96890, abs=1e-5)


def test_one_lane_is_the_same_lane_in_a_batch():
    random = np.random.default_rng(5)
    amplitude, omega = random.uniform(0.9, 9, 300), random.uniform(0.3, 12, 300)
    whole = response(RigidModel(0.25), sine(), amplitude, omega, 0.9)
    for pool in (1, 2, 7, 64):
        other = response(RigidModel(0.25), sine(), amplitude, omega, 0.9, pool=pool)
        assert other.theta_ratio.tobytes() == whole.theta_ratio.tobytes()


def integrate(s, phase_end, amplitude, omega, eta, alpha):
    """Outcome flag and max |theta|/alpha by DOP853 at the limit of double precision on theta itself."""
    drive, end, turn = amplitude * alpha, phase_end / omega, math.pi / (8 * omega)
    fine = np.linspace(0.0, phase_end, 100_001)
    over = drive * np.abs(s(fine)) > math.tan(alpha)
    time, side, y, v, peak, bounced = 0.0, 0, 0.0, 0.0, 0.0, False
    tight = {"method": "DOP853", "rtol": 2.3e-14, "atol": 1e-17}
    while time < end * (1 - 1e-14):
        if side == 0:
            after = np.flatnonzero(over & (fine >= time * omega))
            if not after.size:
                return ("rocked" if peak else "no_uplift"), peak / alpha
            i, at = after[0], fine[after[0]]
            if i and not over[i - 1]:
                at = brentq(lambda q: drive * abs(s(q)) - math.tan(alpha), fine[i - 1], at, xtol=1e-15)
            time, side, y, v = at / omega, -int(np.sign(s(min(at + 1e-9, phase_end - 1e-12)))), 0.0, 0.0
        stop = min(end, (math.floor(time / turn + 1e-9) + 1) * turn)

        def rate(t, z, side=side):
            return [z[1], -math.sin(alpha - z[0]) - side * drive * s(omega * t) * math.cos(alpha - z[0])]

        ground, crest = (lambda t, z: z[0]), (lambda t, z: z[1])
        ground.terminal, ground.direction, crest.direction = True, -1, -1
        path = solve_ivp(rate, (time, stop), [y, v], events=[ground, crest], max_step=(stop - time) / 6, **tight)

        def state(at, time=time, y=y, v=v, rate=rate):
            return solve_ivp(rate, (time, at), [y, v], max_step=(at - time) / 6, **tight).y[:, -1]

        for at in path.t_events[1][path.t_events[1] > time]:
            z = state(at)
            peak = max(peak, z[0] - z[1] ** 2 / (2 * rate(at, z)[1]))
        if path.status == 1:
            at = path.t_events[0][0]
            z = state(at)
            time, v = at - z[0] / z[1], -eta * (z[1] - rate(at, z)[1] * z[0] / z[1])
            y, side, bounced = 0.0, -side, True
            if v < 1e-10 and drive * abs(s(omega * time)) < 0.999 * math.tan(alpha):
                side, v = 0, 0.0
        else:
            time, (y, v) = stop, path.y[:, -1]
        if y > math.pi / 2:
            return ("overturned_after_impact" if bounced else "overturned_no_impact"), math.nan
    if side == 0:
        return "rocked", peak / alpha
    level = v * v / 2 + math.cos(alpha - y)
    if (y < alpha and v > 0 and level > 1) or (y > alpha and (v > 0 or level < 1)):
        return ("overturned_after_impact" if bounced else "overturned_no_impact"), math.nan
    back = math.cos(alpha) + eta**2 * (level - math.cos(alpha))
    if back > 1:
        return "overturned_after_impact", math.nan
    crests = [peak, alpha - math.acos(back)] + ([alpha - math.acos(level)] if v > 0 else [])
    return "rocked", max(crests) / alpha


@pytest.fixture(scope="module")
def cells():
    random = np.random.default_rng(1)
    draw = [random.uniform(a, b, 200) for a, b in ((0.9, 12), (0.5, 12), (0.5, 1), (0.05, 0.6))]
    return [(*c, *integrate(np.sin, 2 * math.pi, *c)) for c in zip(*draw, strict=True)]


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11])
def test_200_random_cells_stay_within_five_tolerances(cells, tolerance):
    worst = 0.0
    for amplitude, omega, eta, alpha, flag, theta in cells:
        found = nonlinear_response(sine(), amplitude, omega, eta, alpha, tolerance=tolerance)
        near = {int(nonlinear_response(sine(), amplitude * f, omega, eta, alpha, tolerance=1e-11).outcome) for f in (1 - 1e-7, 1 + 1e-7)}
        if len(near) == 1:
            assert Outcome(int(found.outcome)).flag == flag
        if not math.isnan(theta):
            worst = max(worst, abs(float(found.theta_ratio) - theta))
    assert worst < 5 * tolerance


def test_jump_at_the_start_and_several_cycles():
    random = np.random.default_rng(2)
    for amplitude, omega, eta, alpha in zip(
        *(random.uniform(a, b, 40) for a, b in ((0.9, 5), (0.5, 12), (0.5, 1), (0.05, 0.6))), strict=True
    ):
        flag, theta = integrate(np.cos, 3 * math.pi, amplitude, omega, eta, alpha)
        found = nonlinear_response(cosine(1.5), amplitude, omega, eta, alpha, tolerance=1e-10)
        assert Outcome(int(found.outcome)).flag == flag
        if not math.isnan(theta):
            assert abs(float(found.theta_ratio) - theta) < 5e-10


def test_the_check_of_sweeps_is_itself_right(cells):
    """`reference_nonlinear`, on which the estimated error of nonlinear sweeps rests, against the oracle above."""
    # The last three hold arcs shorter than its steps, right after uplift.
    odd = [(1.3739303, 8.18093324, 1.0, 0.82321594), (1.77887648, 2.65944071, 1.0, 1.03821494), (1.2, 2.0, 0.3, 1.0)]
    for case in [*(c[:4] for c in cells[:30]), *odd]:
        flag, theta = integrate(np.sin, 2 * math.pi, *case)
        outcome, peak = reference_nonlinear(sine(), *case[:3], RigidBody(case[3]))
        assert outcome.flag == flag
        assert math.isnan(theta) or abs(peak - theta) < 1e-9


def one(x):
    return np.array([float(x)])


def series_from(model, y, v, segments=None):
    """The model's series on still ground from one state."""
    still = segments or Motion("still", (Piece(0.0, 1.0),)).segments
    b = -math.sin(model.alpha - model.sin * y) / model.sin
    k = np.zeros(1, dtype=np.int64)
    return model.flow(still, Lanes(k, one(1), one(1), one(1), k, one(0), one(1), one(y), one(v), one(b), one(0), k, k))


@pytest.mark.parametrize("alpha", [0.1, 0.25, 0.6])
@pytest.mark.parametrize("start", [0.1, 0.5, 0.9, 0.99])
def test_free_quarter_period_equals_the_quadrature(alpha, start):
    """T/4 = integral of dtheta / sqrt(2 (cos(alpha - theta0) - cos(alpha - theta))), the singularity taken out by theta = theta0 - u^2."""
    theta0 = start * alpha

    def slowness(u):
        theta = theta0 - u * u
        fall = 2.0 * math.sin(alpha - (theta + theta0) / 2) * math.sin(u * u / 2)
        return 2.0 / math.sqrt(2.0 * fall / (u * u)) if u > 1e-7 else 2.0 / math.sqrt(math.sin(alpha - theta0))

    expected = quad(slowness, 0.0, math.sqrt(theta0), epsabs=1e-13, epsrel=1e-13, limit=400)[0]
    model, time = RigidModel(alpha, 1e-12), 0.0
    y, v = theta0 / model.sin, 0.0
    while True:
        flow = series_from(model, y, v)
        h = flow.longest
        end = flow.at(h)
        if end.y[0] <= 0.0:
            break
        time, y, v = time + h[0], end.y[0], end.v[0]
    time += brentq(lambda x: flow.at(np.array([x])).y[0], 0.0, h[0], xtol=1e-15)
    assert time == pytest.approx(expected, rel=1e-9)


def test_energy_is_constant_between_impacts():
    model, y, v, energies = RigidModel(0.3, 1e-11), 0.0, 1.2, []
    for _ in range(60):
        energies.append(0.5 * v * v + math.cos(model.alpha - model.sin * y) / model.sin**2)
        flow = series_from(model, y, v)
        end = flow.at(flow.longest)
        y, v = end.y[0], end.v[0]
        if y < 0.0:
            break
    assert len(energies) > 3
    assert np.ptp(energies) < 1e-11 * energies[0]


def test_order_of_the_flow_is_the_order_of_its_series():
    """Error after one step against its length, log-log slope by regression: the first term left out."""
    model = RigidModel(0.4, 1e-4)
    flow, exact = series_from(model, 0.3, 0.9), series_from(RigidModel(0.4, 1e-13), 0.3, 0.9)
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


@pytest.mark.parametrize(
    "model", [LinearModel(), RigidModel(0.25, 1e-13), RigidModel(0.6, 1e-13)], ids=["linear", "alpha-0.25", "alpha-0.6"]
)
def test_grazing_is_decided_on_either_side(model):
    """A body falls under a constant push a > 1 that turns it back within 1e-6 ... 1e-12 of the ground: energy says on which side.

    v0^2/2 = G(y0) - G(y_min) with G' = y'': for y_min < 0 it strikes, for y_min > 0 it does not. Both ends of the step are
    in the air, so no sign change would show it.
    """
    push = Motion("push", (Piece(0.0, 60.0, (), 1.0),)).segments
    random = np.random.default_rng(6)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    for offset in np.geomspace(1e-6, 1e-12, 7):
        for _ in range(15):
            a, y0 = random.uniform(1.2, 4.0), random.uniform(0.02, 0.4)
            for least in (-offset, offset):
                spots = least + 0.5 * (y0 - least) * (nodes + 1.0)
                rise = 0.5 * (y0 - least) * float(weights @ model.acceleration(spots, np.full(40, a)))
                k = np.zeros(1, dtype=np.int64)
                b = model.acceleration(one(y0), one(a))
                lanes = Lanes(k, one(a), one(1), one(1), k, one(0), one(-1), one(y0), one(-math.sqrt(2 * rise)), b, one(0), k, k)
                hit = False
                for _ in range(40):
                    event = advance(push, lanes, model)
                    hit |= bool(event.hit[0])
                    if hit or event.end.v[0] > 0.0:
                        break
                    lanes.u = event.step.u
                    lanes.y, lanes.v, lanes.b = event.end.y, event.end.v, event.end.b
                assert hit == (least < 0.0), (offset, a, y0)


@pytest.mark.parametrize(
    "bad", [{"alpha": 0.0}, {"alpha": 1.6}, {"tolerance": 0.0}, {"tolerance": 1e-15}, {"tolerance": 1.0}, {"tolerance": math.nan}]
)
def test_model_checks_its_numbers(bad):
    with pytest.raises(ValueError, match="accepted"):
        RigidModel(**{"alpha": 0.2, "tolerance": 1e-9, **bad})


def test_model_is_refused_where_it_does_not_hold():
    (document,) = parse_documents("kind: parameters\np: 2\nalpha: 0.1\neta: 0.9\nlambda: 0.3")
    with pytest.raises(UsageError, match="a rigid body, whose a_scale is 1"):
        Method("nonlinear").model_of(build(document))
    with pytest.raises(UsageError, match="unknown model"):
        Method("quadratic")
    with pytest.raises(UsageError, match="tolerance"):
        Method("nonlinear", 0.5)
