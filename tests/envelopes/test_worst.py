"""A minimum of the first overturning amplitude inside the range of frequencies, against a raster of an integrator of its own."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli import dimensionless_oscillator, parse_grid, pulse
from rocking_cli.envelopes.intervals import trace_envelope
from rocking_cli.envelopes.worst import at_worst_frequency

ETA = 0.7
STEP, END = 8e-3, 14.0


def overturned(amplitude, omega):
    """True where y'' = y - sgn(y) + A s overturns the body: Runge-Kutta steps of all cells at once; s: two cycles of a cosine."""
    amplitude, omega = (x.ravel() for x in np.broadcast_arrays(amplitude, omega))
    y, v, side, rocks = np.zeros(omega.size), np.zeros(omega.size), np.zeros(omega.size), np.zeros(omega.size, dtype=bool)

    def push(t):
        return np.where(omega * t <= 4.0 * np.pi, -amplitude * np.cos(omega * t), 0.0)

    for t in np.arange(0.0, END, STEP):
        lifts = ~rocks & (np.abs(push(t)) > 1.0)
        side, rocks = np.where(lifts, np.sign(push(t)), side), rocks | lifts

        def rate(y, v, at, side=side):
            return v, y - side + push(at)

        a = rate(y, v, t)
        b = rate(y + 0.5 * STEP * a[0], v + 0.5 * STEP * a[1], t + 0.5 * STEP)
        c = rate(y + 0.5 * STEP * b[0], v + 0.5 * STEP * b[1], t + 0.5 * STEP)
        d = rate(y + STEP * c[0], v + STEP * c[1], t + STEP)
        after = [x + STEP / 6.0 * (k1 + 2.0 * (k2 + k3) + k4) for x, k1, k2, k3, k4 in zip((y, v), a, b, c, d, strict=True)]
        crosses = rocks & (side * after[0] < 0.0)
        left = np.where(crosses, after[0] / np.where(crosses, after[1], 1.0), 0.0)  # time since the impact
        speed = ETA * (after[1] - left * (-side + push(t + STEP)))
        side = np.where(crosses, -side, side)
        y = np.where(crosses, speed * left, after[0]) * rocks
        v = np.where(crosses, speed + left * (-side + push(t + STEP)), after[1]) * rocks
        settled = rocks & (np.abs(v) < 2e-3) & (np.abs(y) < 1e-5) & (np.abs(push(t)) <= 1.0)
        rocks, y, v = rocks & ~settled, np.where(settled, 0.0, y), np.where(settled, 0.0, v)
        far = np.abs(y) > 20.0
        y, v = np.where(far, np.sign(y) * 20.0, y), np.where(far, 0.0, v)
    return np.abs(y) > 3.0


@pytest.mark.soak
def test_a_minimum_inside_the_range_is_found_between_the_points_of_the_scan():
    """The tongue of two cycles of a cosine ends at Omega = 3.03; its lowest point is near 3.015. Nothing on the raster falls below it."""
    oscillator, motion = dimensionless_oscillator(ETA), pulse("cosine", cycles=2)
    low, high = (parse_grid(f"A=3.5,Omega={omega}") for omega in (2.85, 3.1))
    grid, _ = at_worst_frequency(oscillator, motion, low, high, 4.0)
    omega = float(grid.frequency.values[0])
    assert 3.0 < omega < 3.03
    first = trace_envelope(oscillator, motion, [omega], a_max=4.0, workers=1)[0].a_from
    around = [trace_envelope(oscillator, motion, [omega + d], a_max=4.0, workers=1)[0].a_from for d in (-1e-3, 1e-3)]
    assert first < min(around)
    raster = np.meshgrid(np.linspace(1.001, first * 0.997, 40), np.linspace(2.85, 3.1, 11))
    below, above = np.split(overturned(*(np.append(x, there) for x, there in zip(raster, (first * 1.003, omega), strict=True))), [-1])
    assert above.all()
    assert not below.any()
    assert first == pytest.approx(3.351, abs=1e-3)
