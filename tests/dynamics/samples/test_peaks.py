"""The peak within a propagation against the flow from sample to sample, which shares no table with it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from rocking_cli.dynamics.samples.bounded import bounded_response
from rocking_cli.dynamics.samples.peaks import Rise, peak_heights
from rocking_cli.dynamics.samples.propagation import ExactLanes
from rocking_cli.dynamics.samples.ramp import RampFlow

PACE = 0.03


def stepped(samples, drive, y, v):
    """y and v at each sample from the first on."""
    states = [(y, v)]
    for now, then in pairwise(samples):
        rate = drive * (then - now) / PACE
        point = RampFlow(*(np.array([x]) for x in (y, v, y - 1.0 + drive * now, rate))).at(np.array([PACE]))
        y, v = float(point.y[0]), float(point.v[0])
        states.append((y, v))
    return np.array(states)


@pytest.mark.parametrize("to", [1, 2, 30, 59])
def test_a_peak_is_that_of_the_flow_from_sample_to_sample(to):
    """Bodies whose peak comes anywhere from the first interval to the last."""
    samples = np.random.default_rng(5).standard_normal(60)
    drive, count = 0.1, 40
    within = PACE * to * (np.arange(count) + 0.5) / count  # where it would come under no drive
    y, v = np.full(count, 0.2), 0.8 * np.tanh(within)
    states = np.array([stepped(samples, drive, *state) for state in zip(y, v, strict=True)])
    turns = (states[:, to, 1] < 0.0) & (v > 0.0)
    assert turns.sum() > count // 3
    y, v, states = y[turns], v[turns], states[turns]
    bounded = bounded_response(samples, np.array([PACE]))[0]
    zero, whole = np.zeros(y.size), np.zeros(y.size, dtype=np.int64)
    up, down = (0.5 * (y - 1.0 - drive * bounded[0].real + sign * (v - drive * bounded[0].imag)) for sign in (1.0, -1.0))
    lanes = ExactLanes(whole, whole, zero, y, v, zero, zero == 0.0, up, down, zero + drive, zero + PACE, whole, whole, whole)
    found = peak_heights(Rise(lanes, whole + to, states[:, to, 1]), bounded, samples)
    for top, state in zip(found, states, strict=True):
        i = int(np.flatnonzero(state[: to + 1, 1] < 0.0)[0]) - 1
        h = np.linspace(0.0, PACE, 20_001)
        arc = RampFlow(
            *(np.full(h.size, x) for x in (*state[i], state[i, 0] - 1.0 + drive * samples[i], drive * (samples[i + 1] - samples[i]) / PACE))
        )
        most = arc.at(h).y.max()  # h is off the peak by PACE/40,000 at the most, y by half the square of that
        assert -4e-15 <= top - most <= 0.5 * (PACE / 40_000) ** 2 + 4e-15
