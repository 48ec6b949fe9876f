"""The search for the extremes of forces on stretches, and forces on still ground."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli.dynamics.body import Body
from rocking_cli.dynamics.march.ground import Shaking
from rocking_cli.dynamics.observers.extremes import Extremes
from rocking_cli.dynamics.observers.forces import Forces, Stretches, forces_on, forces_on_still_ground, note_extremes


def test_extremes_are_the_largest_values_offered():
    found = Extremes(np.array([1.0, 0.0]))
    found.offer(np.array([0, 1, 1, 0]), np.array([0.5, 2.0, 1.0, np.nan]))
    assert found.largest.tolist() == [1.0, 2.0]
    assert found.can_beat(np.array([0, 0, 1, 1]), np.array([1.0, 1.1, np.nan, 2.0])).tolist() == [False, True, True, False]


@pytest.mark.parametrize("one_way", [False, True])
def test_what_values_and_slopes_at_the_ends_do_not_show_is_found(one_way):
    """16 x^2 (1 - x)^2 rises from 0 to 1 and back between level ends."""

    def along(_own, x):
        bump, slope = 16.0 * (x * (1.0 - x)) ** 2, 32.0 * x * (1.0 - x) * (1.0 - 2.0 * x)
        return Forces(0.2 + 0.2 * bump, 1.0 - 0.1 * bump, 0.2 * slope, -0.1 * slope)

    friction, lift, cell = Extremes(np.zeros(1)), Extremes(-np.ones(1)), np.zeros(1, dtype=np.int64)
    ends = np.zeros(1), np.ones(1)
    note_extremes(friction, lift, cell, along, Stretches(*ends, along(cell, ends[0]), along(cell, ends[1]), np.full(1, 5.0)), one_way)
    assert lift.largest[0] == pytest.approx(-0.9, abs=1e-7)
    assert friction.largest[0] == pytest.approx(0.4 / 0.9, abs=1e-7)


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

    cell, low, high = np.arange(300), np.zeros(300), np.full(300, 0.5)
    friction, lift = Extremes(np.zeros(300)), Extremes(np.full(300, -9.0))
    note_extremes(friction, lift, cell, along, Stretches(low, high, along(cell, low), along(cell, high), np.full(300, 3.0)), one_way)
    seen = [along(cell, np.full(300, t)) for t in np.linspace(0.0, 0.5, 4_001)]
    ratio = [(np.maximum(f.fx, 0.0) if one_way else np.abs(f.fx)) / f.fz for f in seen]
    assert friction.largest == pytest.approx(np.max(ratio, axis=0), abs=2e-7)
    assert -lift.largest == pytest.approx(np.min([f.fz for f in seen], axis=0), abs=2e-7)


@pytest.mark.parametrize("linear", [False, True])
def test_still_ground_is_no_push_and_the_weight(linear):
    """With u'^2 by the energy; slopes by u are those by time over u'."""
    body, u, square = Body((0.4,), (0.8,), linear), np.linspace(0.01, 0.2, 9), 0.3
    (edge,) = body.edges
    rate = np.sqrt(square - body.fall(edge, u))
    still = forces_on_still_ground(body, edge, np.full(9, square), u)
    moving = forces_on(body, edge, Shaking(0.0 * u, 0.0 * u, 1.0, 0.0), u, rate)
    assert still.fx == pytest.approx(moving.fx, abs=1e-14)
    assert still.fz == pytest.approx(moving.fz, abs=1e-14)
    assert still.fx_slope == pytest.approx(moving.fx_slope / rate, abs=1e-13)
    assert still.fz_slope == pytest.approx(moving.fz_slope / rate, abs=1e-13)
