"""Ground forces of cells, against an integration by DOP853 with forces of its own, and the forces along their histories."""

import math
from collections import Counter

import numpy as np
import pytest
from oracles.ground_forces import asked
from support.bodies import KINDS, drawn, shaken, shaking_of
from support.documents import built
from support.synthetic_records import RECORDS, long_series, noise, upwards
from support.synthetic_records import shaken as shaken_by

from rocking_cli import Method, Outcome, cosine, parse_grid, pulse, response, sine
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.observers import extremes, ground_forces
from rocking_cli.dynamics.observers.ground_forces import GroundForces
from rocking_cli.dynamics.outcome import safe
from rocking_cli.dynamics.response import response_with_ground_forces, upright
from rocking_cli.errors import UsageError
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.responses.time_history import time_history
from rocking_cli.spectra.scene import PulseScene
from rocking_cli.spectra.sweep import SweepOptions, spectrum_of

MOTIONS = [sine(1), sine(2), pulse("rectangular-impulse"), cosine(1)]
ETAS = 0.4, 0.85

RECORD, UPWARDS = shaken_by(RECORDS[0], 0.05), shaken_by(noise(120, 0.04, 8), 0.04)
SPIKES = shaken_by(np.random.default_rng(4).uniform(-1.0, 1.0, 60), 0.2)
BLOCK = "kind: block\nwidth: 0.6\nheight: 3\n"


@pytest.mark.parametrize(
    ("kind", "vertical", "count", "angles", "recorded"),
    [
        *((kind, vertical, 2, (0.2, 0.8), False) for kind in KINDS for vertical in (0.0, 0.4)),
        *(
            pytest.param(kind, vertical, *rest, marks=pytest.mark.soak)
            for kind in KINDS
            for vertical in (0.0, 0.4)
            for rest in ((60, (0.1, 0.7), False), (15, (0.6, 1.2), False), (5, (0.1, 0.5), True))
        ),
    ],
)
def test_they_are_those_of_an_integration_by_another_hand_which_loses_the_same_bodies(kind, vertical, count, angles, recorded):
    random, seen = np.random.default_rng(5), Counter()
    while seen.total() < count:
        body, solved, arm = drawn(kind, random, angles, ETAS, 0.3)
        motion, *cell = shaken(random, body, (vertical,), (0.9, 4.0), recorded)
        system = Method("nonlinear" if solved.nonlinear else "linear", 1e-11).system_of(body)
        found, got = response_with_ground_forces(system, motion, *cell, body.eta)
        outcome, where = Outcome(int(found.outcome)), (kind, motion.name, *cell)
        if outcome.overturned:
            continue
        assert response(system, motion, *cell, body.eta).outcome == outcome
        ground = shaking_of(body, motion, *cell)
        there = asked(solved, arm, ground)
        assert (outcome == Outcome.LOST_CONTACT) == (there.fz_min <= 0.0), where
        seen[outcome] += 1
        if ground.at(np.linspace(0.0, ground.end, 10_000))[1].min() > -body.gravity:  # the ground does not fall away
            assert there.answer.outcome in ("rocked", "no_uplift")
            assert float(got["friction"]) == pytest.approx(there.friction, abs=1e-6), where
            assert float(got["fz_min"]) == pytest.approx(there.fz_min, abs=1e-6), where
    assert count < 60 or seen[Outcome.ROCKED] > 5
    assert count != 15 or seen[Outcome.LOST_CONTACT] > 0  # the stocky ones


@pytest.mark.parametrize(
    ("kind", "model", "vertical", "motion", "count"),
    [
        ("unequal", "nonlinear", True, RECORD, 3),
        ("one-sided", "linear", False, RECORD, 3),
        ("damped", "nonlinear", False, RECORD, 3),
        *(
            pytest.param(kind, model, vertical, motion, 60, marks=pytest.mark.soak)
            for kind in KINDS
            for model in ("linear", "nonlinear")
            for vertical in (False, True)
            for motion in (*map(shaken_by, RECORDS, (0.05, 0.05, 0.04)), SPIKES)
        ),
    ],
)
def test_under_records_they_are_those_of_the_march_by_long_series(kind, model, vertical, motion, count):
    random = np.random.default_rng(3)
    system = Method(model, 1e-12).system_of(drawn(kind, random, (0.1, 0.5), ETAS, 0.3)[0])
    cells = random.uniform(0.8, 4.0, count), np.exp(random.uniform(-1.1, 0.5, count)), -0.6 if kind == "one-sided" else 0.6
    motions = upwards(motion, UPWARDS, 0.3) if vertical else (motion, long_series(motion))
    (found, stepped), (marched, asked) = (response_with_ground_forces(system, m, *cells) for m in motions)
    np.testing.assert_array_equal(found.outcome, marched.outcome)
    upright = safe(found.outcome)
    assert upright.sum() > 1
    for name, values in stepped.items():
        np.testing.assert_allclose(values[upright], asked[name][upright], rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("kind", ["unequal", "one-sided"])
def test_a_rest_under_lines_has_the_extremes_of_many_instants(kind):
    motion, random = upwards(SPIKES, UPWARDS, 0.5)[0], np.random.default_rng(9)
    system = Method("nonlinear").system_of(drawn(kind, random, (0.1, 0.5), ETAS, 0.3)[0])
    amplitude, omega, segments = random.uniform(0.8, 4.0, 40), random.uniform(0.3, 1.6, 40), system.segments(motion)
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


def worst(body, model, motion, cells, seed):
    """(cells compared, largest differences of friction and of fz_min from the histories); outcomes are equal."""
    method, random, differences = Method(model, 1e-11), np.random.default_rng(seed), []
    amplitude, omega = random.uniform(0.6, 4.0, cells), random.uniform(0.8, 8.0, cells)
    found, asked = response_with_ground_forces(method.system_of(body), motion, amplitude, omega, body.eta)
    for i in np.flatnonzero(upright(found.outcome) & (found.outcome != Outcome.NO_UPLIFT)):
        grid = parse_grid(f"A={float(amplitude[i])!r},Omega={float(omega[i])!r}")
        history = time_history(body, motion, grid, [method], duration=(motion.duration / omega[i] + 40.0) / body.p)
        assert history.outcome(model) == found.outcome[i]
        demands = history.forces[model].extremes
        if found.outcome[i] == Outcome.ROCKED:
            differences.append((abs(demands.friction.friction - asked["friction"][i]), abs(demands.fz_min - asked["fz_min"][i])))
    return len(differences), *np.max(differences, axis=0)


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize(
    ("kind", "cells", "motion"),
    [("plain", 3, sine(1)), ("one-sided", 3, sine(1)), *(pytest.param(k, 80, m, marks=pytest.mark.soak) for k in KINDS for m in MOTIONS)],
)
def test_the_extremes_are_those_of_the_histories(kind, model, motion, cells):
    body, _, _ = drawn(kind, np.random.default_rng(1), (0.2, 0.5), ETAS, 0.2)
    count, friction, least = worst(body, model, motion, cells, 4 if cells == 3 else 9)
    assert count >= (2 if cells > 3 else 1)  # most bodies overturn under a rectangular pulse
    assert max(friction, least) < 1e-6


@pytest.mark.soak
def test_bounces_that_a_history_does_not_show_press_less_than_a_body_at_rest():
    """Just above uplift the force falls until the last of them; an integration by DOP853 follows 318 to 1e-8 of the speed."""
    body, method = built(BLOCK), Method("linear")
    amplitude, omega, fz_min = 1.02779675372563, 4.887328366201234, 0.94759598
    _, got = response_with_ground_forces(method.system_of(body), sine(1), amplitude, omega, body.eta)
    history = time_history(body, sine(1), parse_grid(f"A={amplitude!r},Omega={omega!r}"), [method])
    least = history.forces["linear"].extremes.fz_min
    assert least == pytest.approx(float(got["fz_min"]), abs=1e-6)
    assert least == pytest.approx(fz_min, abs=2e-7)


@pytest.mark.parametrize(("across", "up"), [("sine", "mavroeidis-papageorgiou"), ("rectangular-impulse", "rectangular-impulse")])
def test_forces_of_a_body_that_has_gone_far_before_the_ground_falls_away_are_not_searched(across, up):
    """Linear, it goes to 1e9 rad, where its forces oscillate a billion times."""
    body = built("kind: block\nwidth: 0.1\nheight: 0.4\n")
    motion, grid = with_vertical(pulse(across), pulse(up), 0.7), parse_grid("a_g=3g,f_g=0.3")
    found, asked_for = response_with_ground_forces(
        Method().system_of(body), motion, 3.0 / body.alpha, 2.0 * math.pi * 0.3 / body.p, body.eta
    )
    assert Outcome(int(found.outcome)).overturned
    assert math.isnan(float(asked_for["friction"]))
    assert time_history(body, motion, grid, [Method()]).forces["linear"].extremes.fz_min < 1.0


def test_structures_of_one_rotation_have_their_own_forces():
    """The linear equation answers for both blocks at once, but not for their forces."""
    grid, motion, blocks = parse_grid("A=0.5:2:2,Omega=4"), sine(1), [built(BLOCK), built(BLOCK.replace("0.6", "0.9"))]
    both = spectrum_of(PulseScene(tuple(blocks), grid, motion, Method()), SweepOptions(quantities=("friction",))).quantities["friction"]
    for found, block in zip(both, blocks, strict=True):
        alone = spectrum_of(PulseScene((block,), grid, motion, Method()), SweepOptions(quantities=("friction",))).quantities["friction"]
        assert np.array_equal(found, alone[0], equal_nan=True)
    assert both[1, 0, 0] == pytest.approx(0.5 * blocks[1].alpha, rel=1e-14)


def test_a_body_that_stays_at_rest_needs_the_ground_acceleration_over_g():
    body = built(BLOCK)
    for model in ("linear", "nonlinear"):
        system = Method(model).system_of(body)
        _, asked = response_with_ground_forces(system, sine(1), [0.3, 0.6], 3.0, body.eta)
        assert asked["friction"] == pytest.approx(np.array([0.3, 0.6]) * body.alpha, rel=1e-14)
        assert asked["fz_min"].tolist() == [1.0, 1.0]


def test_sweeps_hold_them_and_refuse_what_they_do_not_follow():
    grid, method = parse_grid("A=0.5:3:4,Omega=2:4:2"), Method("nonlinear")
    scene = PulseScene((built(BLOCK),), grid, sine(1), method)
    found = spectrum_of(scene, SweepOptions(quantities=("friction", "fz_min")))
    assert found.quantities["friction"].shape == found.theta_ratio.shape
    assert np.nanmin(found.quantities["friction"]) == pytest.approx(0.5 * scene.structures[0].alpha, rel=1e-14)
    mass = built(f"kind: point_mass\nradius: 3\nalpha: {math.atan(0.2)}\nrestitution: {scene.structures[0].eta!r}\n")
    with pytest.raises(UsageError, match="not its forces"):
        spectrum_of(PulseScene((*scene.structures, mass), grid, sine(1), Method()), SweepOptions(quantities=("friction",)))


def apart_from_short_cuts(kind, model, motion, cells, seed, monkeypatch):
    """Largest differences from the extremes that are found on stretches four times as short, over 1 and what they are."""
    random = np.random.default_rng(seed)
    body, _, _ = drawn(kind, random, (0.2, 0.5), ETAS, 0.3)
    amplitude, omega, system = random.uniform(0.8, 8.0, cells), random.uniform(0.5, 12.0, cells), Method(model).system_of(body)
    found, forces = response_with_ground_forces(system, motion, amplitude, omega, body.eta)
    monkeypatch.setattr(extremes, "_CUT", 0.4)
    monkeypatch.setattr(ground_forces, "_STILL", 1e-11)
    _, finely = response_with_ground_forces(system, motion, amplitude, omega, body.eta)
    upright = found.outcome == Outcome.ROCKED
    assert np.count_nonzero(upright) > cells / 4
    pairs = [(values[upright], finely[name][upright]) for name, values in forces.items()]
    return max(float((np.abs(one - fine) / (1.0 + np.abs(fine))).max()) for one, fine in pairs)


@pytest.mark.parametrize(
    ("kind", "model", "motion", "cells", "seed"),
    [
        *((kind, model, sine(1), 100, 13) for kind, model in (("unequal", "linear"), ("plain", "nonlinear"), ("damped", "linear"))),
        *(
            pytest.param(kind, model, motion, 1500, 5, marks=pytest.mark.soak)
            for kind in KINDS
            for model in ("linear", "nonlinear")
            for motion in (sine(1), cosine(1.5), pulse("ricker-symmetric"))
        ),
    ],
)
def test_extremes_do_not_depend_on_how_arcs_are_cut(kind, model, motion, cells, seed, monkeypatch):
    assert apart_from_short_cuts(kind, model, motion, cells, seed, monkeypatch) < 1e-6


@pytest.mark.parametrize(
    ("model", "motion"),
    [
        ("linear", sine(2)),
        ("nonlinear", sine(2)),
        ("nonlinear", with_vertical(sine(1), cosine(1.0), 0.2)),
        ("nonlinear", RECORD),
        ("nonlinear", upwards(RECORD, UPWARDS, 0.3)[0]),
    ],
    ids=lambda x: getattr(x, "name", x),
)
def test_neither_other_cells_nor_the_time_of_the_look_change_a_digit(model, motion, monkeypatch):
    """Bodies that turn back beyond y = 1, that bounce for long, and that fall."""
    body, _, _ = drawn("unequal", np.random.default_rng(2), (0.2, 0.4), ETAS, 0.3)
    amplitude, omega = np.concatenate([np.linspace(4.0, 6.0, 30), np.linspace(1.001, 1.05, 4)]), 4.0
    if motion.coarsest.samples is not None:
        amplitude, omega = np.linspace(0.9, 3.0, 4), 0.6
    cell = Method(model).system_of(body), motion
    found, together = response_with_ground_forces(*cell, amplitude, omega, body.eta)
    monkeypatch.setattr(ground_forces, "_TOGETHER", 3)
    _, few = response_with_ground_forces(*cell, amplitude[::-1], omega, body.eta)
    assert np.count_nonzero(safe(found.outcome)) > 2
    for name, values in together.items():
        assert np.array_equal(values, few[name][::-1], equal_nan=True)
    for i in (0, amplitude.size // 2, -1):
        _, alone = response_with_ground_forces(*cell, amplitude[i], omega, body.eta)
        assert all(np.array_equal(values[i], alone[name], equal_nan=True) for name, values in together.items())
