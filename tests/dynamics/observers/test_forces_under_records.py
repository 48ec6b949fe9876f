"""Ground forces of cells under records, against the march by long series."""

from __future__ import annotations

import numpy as np
import pytest
from support.bodies import KINDS, drawn
from support.synthetic_records import RECORDS, noise, shaken

from rocking_cli import Method, response
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.observers import ground_forces
from rocking_cli.dynamics.observers.ground_forces import GroundForces
from rocking_cli.dynamics.outcome import safe
from rocking_cli.dynamics.response import response_with_demands
from rocking_cli.motions import Harmonic, Motion, Piece
from rocking_cli.motions.biaxial import with_vertical

SPIKES = shaken(np.random.default_rng(4).uniform(-1.0, 1.0, 60), 0.2)
ACROSS, UPWARDS = [*map(shaken, RECORDS, (0.05, 0.05, 0.04)), SPIKES], shaken(noise(120, 0.04, 8), 0.04)


def long(motion):
    """The same with a sinusoid of no height, which the march takes by its long series."""
    return Motion(motion.name, tuple(Piece(p.start, p.stop, (Harmonic(0.0),), p.constant, p.slope) for p in motion.pieces))


def upwards(motion, share):
    """A motion with another one upwards, of `share` times its peak."""
    return with_vertical(motion, UPWARDS, share * motion.acceleration / UPWARDS.acceleration)


def bodies(kind, model, motion, count, seed, tolerance=1e-9):
    random = np.random.default_rng(seed)
    body, _, _ = drawn(kind, random, (0.1, 0.5), (0.4, 0.85), 0.3)
    cells = random.uniform(0.8, 4.0, count), np.exp(random.uniform(np.log(2.0), np.log(10.0), count)) / (2.0 * np.pi), body.eta
    return Method(model, tolerance).system_of(body), motion, *cells


def both_ways(kind, model, motion, vertical, count, seed):
    """(what walks ask, what the march by long series asks) of cells that stay upright, in rows, and how many these are."""
    system, _, *cells = bodies(kind, model, motion, count, seed, 1e-12)
    motions = (upwards(motion, 0.3), with_vertical(long(motion), long(UPWARDS), 0.3)) if vertical else (motion, long(motion))
    (found, walked), (marched, asked) = (response_with_demands(system, m, *cells) for m in motions)
    np.testing.assert_array_equal(found.outcome, marched.outcome)
    upright = safe(found.outcome)
    return [np.array([got[name][upright] for name in ("friction", "fz_min")]) for got in (walked, asked)]


@pytest.mark.parametrize(
    ("kind", "model", "vertical"), [("unequal", "nonlinear", True), ("one-sided", "linear", False), ("damped", "nonlinear", False)]
)
def test_the_march_by_long_series_finds_the_same(kind, model, vertical):
    walked, marched = both_ways(kind, model, ACROSS[0], vertical, 3, 3)
    assert walked.shape[1] > 1
    np.testing.assert_allclose(walked, marched, rtol=1e-6, atol=1e-6)


@pytest.mark.soak
@pytest.mark.parametrize("vertical", [False, True])
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize("kind", KINDS)
def test_the_march_finds_the_same_of_many_bodies(kind, model, vertical):
    for i, motion in enumerate(ACROSS):
        np.testing.assert_allclose(*both_ways(kind, model, motion, vertical, 60, 20 + i), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("vertical", [False, True])
def test_neither_other_cells_nor_the_time_of_the_look_change_a_digit(vertical, monkeypatch):
    motion = upwards(ACROSS[0], 0.3) if vertical else ACROSS[0]
    system, motion, amplitude, omega, eta = bodies("unequal", "nonlinear", motion, 5, 5)
    found, together = response_with_demands(system, motion, amplitude, omega, eta)
    assert np.count_nonzero(safe(found.outcome)) > 2
    monkeypatch.setattr(ground_forces, "_TOGETHER", 1)
    _, turned = response_with_demands(system, motion, amplitude[::-1], omega[::-1], eta)
    monkeypatch.setattr(ground_forces, "_TOGETHER", 10**9)
    _, alone = response_with_demands(system, motion, amplitude[:1], omega[:1], eta)
    for name, values in together.items():
        np.testing.assert_array_equal(values, turned[name][::-1])
        np.testing.assert_array_equal(values[:1], alone[name])


@pytest.mark.parametrize(("model", "etas"), [("nonlinear", (0.8, 0.9)), ("nonlinear", (0.8, 0.992)), ("linear", (0.8, 0.9))])
def test_following_the_forces_changes_no_bit_of_the_rest(model, etas):
    """Also where those of bodies that keep their speed are another walk."""
    system, motion, amplitude, omega, _ = bodies("plain", model, ACROSS[0], 3, 8)
    cells = np.append(amplitude, 1.05), np.append(omega, 0.5), np.resize(etas, 4)
    plain, (found, _) = response(system, motion, *cells), response_with_demands(system, motion, *cells)
    for name in ("theta_ratio", "outcome", "impacts"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(found, name))


@pytest.mark.parametrize("kind", ["unequal", "one-sided"])
def test_a_rest_under_lines_has_the_extremes_of_many_instants(kind):
    system, motion, amplitude, omega, _ = bodies(kind, "nonlinear", upwards(SPIKES, 0.5), 40, 9)
    segments, random = system.segments(motion), np.random.default_rng(1)
    forces = GroundForces(system.body, Batch.of(system, segments, amplitude, omega, np.zeros(40)))
    cells = forces.cells
    k, to_k = np.sort(random.integers(0, len(segments) + 1, (2, 40)), axis=0)
    u, to_u = (random.uniform(0.0, 1.0, 40) * np.append(segments.length, 0.0)[i] for i in (k, to_k))
    u[:3], to_u[:5] = 0.0, 0.0
    forces.rest(np.arange(40), k, u, to_k, to_u)
    friction, lift = forces.extremes.largest.reshape(2, 40)
    start, length = np.append(segments.start, segments.start[-1] + segments.length[-1]), motion.duration
    for i in range(40):
        low, high = start[k[i]] + u[i], start[to_k[i]] + to_u[i]
        phase = np.sort(np.append(np.linspace(low, high, 500), start)) if high > low else start[:0]
        phase = phase[(phase >= low) & (phase <= high) & (phase < length * (1.0 - 1e-12))]
        scale = float(cells.amplitude[0, i]) * system.body.edges[0].uplift
        fx, fz = -scale * motion.value(phase), 1.0 + scale * motion.vertical.value(phase)
        most = ((np.maximum(fx, 0.0) if kind == "one-sided" else np.abs(fx)) / fz).max(initial=0.0)
        assert friction[i] == pytest.approx(most, abs=1e-9)
        assert -lift[i] == pytest.approx(fz.min(initial=1.0), abs=1e-9)
