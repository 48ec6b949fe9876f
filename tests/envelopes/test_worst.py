"""A minimum of the first overturning amplitude inside the range of frequencies, against
a raster of an independent integration.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.references import answers

from rocking_cli import (
    FloorMode,
    check,
    dimensionless_oscillator,
    floor_of,
    load_structures,
    overturned,
    parse_grid,
    pulse,
    sine,
)
from rocking_cli.envelopes import worst
from rocking_cli.envelopes.frequency_search import (
    FrequencyRange,
    ScanRows,
    _minima,
)
from rocking_cli.envelopes.intervals import trace_envelope
from rocking_cli.envelopes.worst import at_worst_frequency, search_of


@pytest.mark.soak
def test_a_minimum_inside_the_range_is_found_between_the_points_of_the_scan():
    """The tongue of two cycles of a cosine ends at Omega = 3.03; its lowest point is
    near 3.015. Nothing on the raster falls below it.
    """
    oscillator, motion = dimensionless_oscillator(eta=0.7), pulse("cosine", cycles=2)
    low, high = (parse_grid(f"A=3.5,Omega={omega}") for omega in (2.85, 3.1))
    grid = at_worst_frequency(oscillator, motion, low, high, 4.0).grid
    omega = float(grid.frequency.values[0])
    assert 3.0 < omega < 3.03
    first, *around = (
        trace_envelope(oscillator, motion, [omega + d], a_max=4.0, workers=1)[0].a_from
        for d in (0.0, -1e-3, 1e-3)
    )
    assert first < min(around)
    raster = np.meshgrid(
        np.linspace(1.001, first * 0.997, 40), np.linspace(2.85, 3.1, 11)
    )
    cells = [
        np.append(x, there)
        for x, there in zip(raster, (first * 1.003, omega), strict=True)
    ]
    outcome, _, _ = answers(motion, *cells, np.full(cells[0].size, 0.7))
    assert overturned(outcome).tolist() == [False] * (outcome.size - 1) + [True]
    assert first == pytest.approx(3.351, abs=1e-3)


def test_equal_first_falls_are_all_minima_of_the_scan():
    """As of a body that every frequency overturns at the amplitude of its uplift."""
    before, after = np.array([0, 0, 1]), np.array([1, 2, 2])
    rows = ScanRows(np.zeros(3, dtype=int), np.array([1.0, 2.0, 3.0]), before, after)
    first = np.array([1.2, 1.2, 1.2])
    assert _minima(np.arange(3), rows, first).tolist() == [0, 1, 2]
    first[1] = 1.1
    assert _minima(np.arange(3), rows, first).tolist() == [1]


FLOOR = "T=0.3,xi=0.3,gamma_psi=1.3"
KEYED = "block:0.5x2,building=[{T: 0.3, xi: 0.3, gamma_psi: 1.3}]"


def on_the_floor(f, a_max=None):
    """The verdict under the motion of the floor at a frequency of the ground [Hz]."""
    floor = floor_of(sine(), FLOOR, 0.25 * 9.81, math.tau * f)
    return check("block:0.5x2", floor, "a_g=0.25g", a_max=a_max)


def test_a_search_on_a_floor_moves_it_anew_at_each_frequency():
    (body,) = load_structures(KEYED)
    low, high = (parse_grid(f"a_g=0.25g,f_g={f}") for f in (1.0, 1.2))
    one = FrequencyRange.of(body, sine(), low, high, None)
    turned, outcome = search_of([one], sine()).under(
        np.zeros(2, int), np.array(one.ends)
    )
    found = [on_the_floor(f) for f in (1.0, 1.2)]
    assert outcome.tolist() == [v.outcome for v in found]
    assert turned == pytest.approx([v.theta_ratio for v in found], rel=0.01)


def test_structures_on_floors_and_on_the_ground_keep_their_order(monkeypatch):
    def named(group, **_):
        return [s.name for s in group]

    monkeypatch.setattr(worst, "_of_a_group", named)
    (block,) = load_structures("block:0.5x2")
    floor = (FloorMode(0.4, 0.05),)
    asked = [
        replace(block, name=f"b{i}", building=floor if i in (1, 2, 5) else ())
        for i in range(7)
    ]
    grid = parse_grid("a_g=0.3g,f_g=1")
    found = worst.at_worst_frequencies(asked, sine(), grid, grid, None, workers=1)
    assert found == [s.name for s in asked]
