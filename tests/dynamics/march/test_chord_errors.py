"""By how much forces leave their chords along stretches, against Runge-Kutta steps."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli.dynamics.body import Body
from rocking_cli.dynamics.observers import contact_loss


def forces_of(body, edge, push, weight, u, rate):
    """(Fx, Fz) over m g, and u'' [rad by tau]."""
    z = edge.alpha - u
    bend = push - weight * z if body.linear else push * np.cos(z) - weight * np.sin(z)
    bend = bend - 2.0 * body.damping * rate
    across = edge.kappa * (bend * np.cos(z) + rate**2 * np.sin(z)) - push
    return across, weight + edge.kappa * (bend * np.sin(z) - rate**2 * np.cos(z)), bend


@pytest.mark.parametrize("linear", [False, True])
def test_forces_leave_their_chords_by_no_more_than_their_sag(linear):
    """Of free motions by Taylor's series of u to the fifth order, whose errors on short stretches are far below their chord errors."""
    random, n = np.random.default_rng(2), 2000
    body = Body((0.4,), (0.8,), linear, 0.05)
    (edge,), h = body.edges, np.exp(random.uniform(np.log(0.01), np.log(0.3), n))
    u, rate = random.uniform(0.0, 1.0, n), random.uniform(-0.6, 0.6, n)
    push, push1, weight, weight1 = random.uniform(-1.5, 1.5, (2, n)), *random.uniform(-1.0, 1.0, (1, n)), None, None
    push, weight, weight1 = push[0], random.uniform(0.5, 1.5, n), random.uniform(-0.5, 0.5, n)

    def at(t, state):
        return forces_of(body, edge, push + push1 * t, weight + weight1 * t, *state)

    steps, state, seen = 64, (u, rate), []
    for i in range(steps + 1):
        t, dt = h * i / steps, h / steps
        seen.append((at(t, state), state))
        slopes = [(state[1], seen[-1][0][2])]
        for part in (0.5, 0.5, 1.0):  # Runge-Kutta of the fourth order
            there = tuple(x + part * dt * d for x, d in zip(state, slopes[-1], strict=True))
            slopes.append((there[1], at(t + part * dt, there)[2]))
        state = tuple(x + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d) for x, a, b, c, d in zip(state, *slopes, strict=True))
    (first, begin), (last, end) = seen[0], seen[-1]
    most = np.maximum(np.abs(push), np.abs(push + push1 * h)), np.abs(push1), np.zeros(1)
    heaviest = np.maximum(weight, weight + weight1 * h) - 1.0, np.abs(weight1), np.zeros(1)
    ends = [contact_loss.Ends(*state, forces[2], forces[1]) for forces, state in ((first, begin), (last, end))]
    error = contact_loss.chord_errors(body, edge, contact_loss.Shakes(*most, *heaviest), h, *ends)
    values, share = np.array([forces[1] for forces, _ in seen]), np.arange(steps + 1)[:, None] / steps
    off = np.abs(values - (1.0 - share) * values[0] - share * values[-1]).max(axis=0)
    kept = u > 0.0
    assert np.all(off[kept] <= error[kept] * (1.0 + 1e-6) + 1e-9)
    assert np.median(off / error) > 0.02  # and the bound is no idle one
