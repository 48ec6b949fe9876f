"""The search for extremes on stretches, and forces by the slopes that belong to them."""

import numpy as np
import pytest

from rocking_cli.dynamics.body import Body, Shaking
from rocking_cli.dynamics.observers.extremes import Extremes, Stretches
from rocking_cli.dynamics.observers.ground_forces import ForceExtremes, Forces, forces_on


def test_extremes_are_the_largest_values_offered():
    found = Extremes(np.array([1.0, 0.0]))
    found.offer(np.array([0, 1, 1, 0]), np.array([0.5, 2.0, 1.0, np.nan]))
    assert found.largest.tolist() == [1.0, 2.0]
    assert found.can_beat(np.array([0, 0, 1, 1]), np.array([1.0, 1.1, np.nan, 2.0])).tolist() == [False, True, True, False]


def searched(along, low, high, rate, one_way):
    """(largest |Fx|/Fz, least Fz) of each motion."""
    cell = np.arange(low.size)
    found = ForceExtremes(cell.size)
    found.take_in_along(cell, along, Stretches(cell, low, high, rate), along(cell, low), along(cell, high), one_way)
    return found.largest[: cell.size], -found.largest[cell.size :]


@pytest.mark.parametrize("one_way", [False, True])
def test_what_values_and_slopes_at_the_ends_do_not_show_is_found(one_way):
    """16 x^2 (1 - x)^2 rises from 0 to 1 and back between level ends."""

    def along(_own, x):
        bump, slope = 16.0 * (x * (1.0 - x)) ** 2, 32.0 * x * (1.0 - x) * (1.0 - 2.0 * x)
        return Forces(0.2 + 0.2 * bump, 1.0 - 0.1 * bump, 0.2 * slope, -0.1 * slope)

    friction, least = searched(along, np.zeros(1), np.ones(1), np.full(1, 5.0), one_way)
    assert least[0] == pytest.approx(0.9, abs=1e-7)
    assert friction[0] == pytest.approx(0.4 / 0.9, abs=1e-7)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("one_way", [False, True])
def test_sinusoids_of_any_phase_have_their_extremes(sign, one_way):
    """Fx = +-0.3 sin(3 t + c) + 0.1, Fz = 1 + 0.5 sin(3 t + d), on stretches of half a rate; against 4,001 instants."""
    random = np.random.default_rng(3)
    c, d = random.uniform(0.0, 6.3, (2, 300))

    def along(own, t):
        return Forces(
            sign * 0.3 * np.sin(3.0 * t + c[own]) + 0.1, 1.0 + 0.5 * np.sin(3.0 * t + d[own]),
            sign * 0.9 * np.cos(3.0 * t + c[own]), 1.5 * np.cos(3.0 * t + d[own]),
        )  # fmt: skip

    friction, least = searched(along, np.zeros(300), np.full(300, 0.5), np.full(300, 3.0), one_way)
    seen = [along(np.arange(300), np.full(300, t)) for t in np.linspace(0.0, 0.5, 4_001)]
    ratio = [(np.maximum(f.fx, 0.0) if one_way else np.abs(f.fx)) / f.fz for f in seen]
    assert friction == pytest.approx(np.max(ratio, axis=0), abs=2e-7)
    assert least == pytest.approx(np.minimum(np.min([f.fz for f in seen], axis=0), 1.0), abs=2e-7)  # at rest Fz is 1


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_slopes_are_those_of_the_forces(linear, damping):
    """By differences along u' = v and v' of the equation of motion, under a push and a weight that grow."""
    body, u, rate, dt = Body((0.4,), (0.8,), linear, damping), np.linspace(0.01, 0.3, 9), np.linspace(-0.4, 0.5, 9), 1e-5
    (edge,) = body.edges
    z = edge.alpha - u
    pull = 0.2 - 0.9 * z if linear else 0.2 * np.cos(z) - 0.9 * np.sin(z)
    before, after = (
        forces_on(body, edge, Shaking(0.2 + 0.5 * t, 0.5, 0.9 + 0.3 * t, 0.3), u + rate * t, rate + (pull - 2.0 * damping * rate) * t)
        for t in (-dt, dt)
    )
    found = forces_on(body, edge, Shaking(0.2, 0.5, 0.9, 0.3), u, rate)
    assert found.fx_slope == pytest.approx((after.fx - before.fx) / (2.0 * dt), abs=1e-8)
    assert found.fz_slope == pytest.approx((after.fz - before.fz) / (2.0 * dt), abs=1e-8)


@pytest.mark.parametrize("linear", [False, True])
def test_still_ground_lets_a_body_rise_to_where_its_speed_is_spent(linear):
    body, square = Body((0.4,), (0.8,), linear), np.linspace(0.0, 0.1, 9)
    (edge,) = body.edges
    assert body.fall(edge, body.top(edge, square)) == pytest.approx(square, abs=1e-15)
