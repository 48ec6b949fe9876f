"""What cells ask of the ground under records: against the march by long series, and against stretches all of which are searched."""

from __future__ import annotations

import numpy as np
import pytest
from support.stocky_bodies import KINDS, drawn
from support.synthetic_records import RECORDS, noise, shaken

from rocking_cli import Method, response
from rocking_cli.dynamics.body import Body
from rocking_cli.dynamics.equations.equation import Ramp
from rocking_cli.dynamics.equations.ramp import line_series
from rocking_cli.dynamics.march import bends, lines
from rocking_cli.dynamics.march.demand import Demands
from rocking_cli.dynamics.march.ground import Shaking
from rocking_cli.dynamics.march.lines import LineDemands
from rocking_cli.dynamics.outcome import safe
from rocking_cli.dynamics.response import response_with_demands
from rocking_cli.motions import Harmonic, Motion, Piece
from rocking_cli.motions.biaxial import with_vertical

SPIKES = shaken(np.random.default_rng(4).uniform(-1.0, 1.0, 60), 0.2)
ACROSS, UPWARDS = [*map(shaken, RECORDS, (0.05, 0.05, 0.04)), SPIKES], shaken(noise(120, 0.04, 8), 0.04)


def long(motion):
    """The same with a sinusoid of no height, which the march takes by its long series and their hulls."""
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
    np.testing.assert_allclose(walked, marched, rtol=1e-9, atol=1e-9)


@pytest.mark.soak
@pytest.mark.parametrize("vertical", [False, True])
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize("kind", KINDS)
def test_the_march_finds_the_same_of_many_bodies(kind, model, vertical):
    for i, motion in enumerate(ACROSS):
        np.testing.assert_allclose(*both_ways(kind, model, motion, vertical, 60, 20 + i), rtol=2e-8, atol=2e-8)


def all_of_it(kind, model, vertical, count, monkeypatch):
    """What is asked with stretches judged by their ends, and with all of them halved."""
    motion = upwards(SPIKES, 0.3) if vertical else SPIKES
    cells, looked = bodies(kind, model, motion, count, 6), []
    find = LineDemands._find
    monkeypatch.setattr(LineDemands, "_find", lambda self, some, arc: (looked.append(some.cell.size), find(self, some, arc))[1])
    found, judged = response_with_demands(*cells)
    few = sum(looked)
    looked.clear()
    monkeypatch.setattr(lines, "_monotone", lambda slope, other, sag, h: np.zeros(h.size, dtype=bool))
    monkeypatch.setattr(lines, "_MARGIN", 9.0)
    _, searched = response_with_demands(*cells)
    assert 0 < 5 * few < sum(looked)
    for name, values in judged.items():
        np.testing.assert_allclose(values[safe(found.outcome)], searched[name][safe(found.outcome)], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(("kind", "model", "vertical"), [("plain", "nonlinear", False), ("unequal", "linear", True)])
def test_no_stretch_that_is_left_out_holds_a_record(kind, model, vertical, monkeypatch):
    all_of_it(kind, model, vertical, 6, monkeypatch)


@pytest.mark.soak
@pytest.mark.parametrize("vertical", [False, True])
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize("kind", KINDS)
def test_no_stretch_of_many_bodies_that_is_left_out_does(kind, model, vertical, monkeypatch):
    all_of_it(kind, model, vertical, 300, monkeypatch)


@pytest.mark.parametrize("vertical", [False, True])
def test_neither_other_cells_nor_the_time_of_the_look_change_a_digit(vertical, monkeypatch):
    motion = upwards(ACROSS[0], 0.3) if vertical else ACROSS[0]
    system, motion, amplitude, omega, eta = bodies("unequal", "nonlinear", motion, 5, 5)
    found, together = response_with_demands(system, motion, amplitude, omega, eta)
    assert np.count_nonzero(safe(found.outcome)) > 2
    monkeypatch.setattr(lines, "_TOGETHER", 1)
    _, turned = response_with_demands(system, motion, amplitude[::-1], omega[::-1], eta)
    monkeypatch.setattr(lines, "_TOGETHER", 10**9)
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
def test_a_rest_asks_most_where_lines_meet(kind):
    """Against a search on every line."""
    system, motion, amplitude, omega, _ = bodies(kind, "nonlinear", upwards(SPIKES, 0.5), 40, 9)
    segments, random = system.segments(motion), np.random.default_rng(1)
    cells = system.contact.cells(system.equation, amplitude, omega, np.zeros(40))
    k, to_k = np.sort(random.integers(0, len(segments) + 1, (2, 40)), axis=0)
    u, to_u = (random.uniform(0.0, 1.0, 40) * np.append(segments.length, 0.0)[i] for i in (k, to_k))
    u[:3], to_u[:5] = 0.0, 0.0
    found = []
    for kind_of in (Demands, LineDemands):
        demands = kind_of(system.body, system.equation, segments, len(segments), system.contact, cells)
        demands.rest(np.arange(40), k, u, to_k, to_u)
        found.append((demands.friction, demands.fz_min))
    np.testing.assert_allclose(*found, rtol=1e-12, atol=1e-14)
    assert np.ptp(found[0][1]) > 0.1


def demands_of(kind, model, count):
    system, motion, amplitude, omega, eta = bodies(kind, model, SPIKES, count, 3)
    segments, cells = motion.segments, system.contact.cells(system.equation, amplitude, omega, np.full(count, eta))
    return system, LineDemands(system.body, system.equation, segments, len(segments), system.contact, cells)


@pytest.mark.parametrize(("kind", "model", "weighed"), [("unequal", "nonlinear", True), ("damped", "linear", False)])
def test_strides_ask_what_is_seen_at_a_thousand_instants_of_theirs(kind, model, weighed):
    """Of cells that have had nearly as much, and of others."""
    count, random = 2000, np.random.default_rng(7)
    _, demands = demands_of(kind, model, count)
    cell, side, unit = np.arange(count), random.choice([-1.0, 1.0], count), random.uniform(0.2, 0.5, count)
    y, v, drive, gain = (random.uniform(low, high, count) for low, high in ((0.1, 1.0), (-1.0, 1.0), (-2.0, 2.0), (-2.0, 2.0)))
    weight = (random.uniform(0.7, 1.3, count), random.uniform(-0.1, 0.1, count)) if weighed else None
    ramp = Ramp(drive, gain, unit, unit, None, weight)
    series = line_series(demands.equation.on(side, cell), y, v, ramp)
    edge, seen, instants = demands.body.on(side), [], 1000
    for share in np.arange(instants + 1) / instants:
        push = Shaking(edge.uplift * (drive + gain * share), 0.0, weight[0] + weight[1] * share if weighed else 1.0, 0.0)
        point = series.at(share * unit)
        forces = bends.forces_on(demands.body, edge, push, edge.unit * point.y, edge.unit * point.v)
        seen.append((forces.fz, np.abs(forces.fx) / forces.fz))
    fz, friction = np.array(seen).swapaxes(0, 1)
    pressed = fz.min(axis=0) > 0.05
    least, most = fz.min(axis=0), friction.max(axis=0)
    turns = least < np.minimum(fz[0], fz[-1]), most > np.maximum(friction[0], friction[-1])
    assert min(np.count_nonzero(there & pressed) for there in turns) > 20
    demands.fz_min, demands.friction = least + random.choice([-1e-4, 1e-3, 1.0], count), most + random.choice([1e-4, -1e-3, -1.0], count)
    before = demands.fz_min.copy(), demands.friction.copy()
    demands.stride(cell, side, (y, v), (point.y, point.v), ramp, np.ones(count, dtype=bool))
    demands._sift()
    near = 5e-6  # a parabola between instants
    for found, had, asked, worse in ((demands.fz_min, before[0], least, np.minimum), (demands.friction, before[1], most, np.maximum)):
        np.testing.assert_allclose(found[pressed], worse(had, asked)[pressed], atol=near, rtol=near)
        assert np.all(worse(found, asked)[pressed] == found[pressed]) or np.abs(worse(found, asked) - found)[pressed].max() < 1e-10


@pytest.mark.parametrize(("dip", "monotone"), [(0.4, True), (0.9, False), (1.2, False)])
def test_a_turn_may_hide_where_slopes_change_by_as_much_as_they_are(dip, monotone):
    """Of slope 1 - 4 dip x (1 - x), which is negative in the middle for a dip above 1; the chord is left by dip/2 at most."""
    one = np.ones(1)
    assert lines._monotone(one, one, 0.5 * dip * one, one).tolist() == [monotone]
    assert not lines._monotone(one, -one, 0.0 * one, one)


@pytest.mark.parametrize("linear", [False, True])
def test_forces_leave_their_chords_by_no_more_than_their_sag(linear):
    """Of free motions by Taylor's series of u to the fifth order, whose errors on short stretches are far below their sags."""
    random, n = np.random.default_rng(2), 2000
    body = Body((0.4,), (0.8,), linear, 0.05)
    (edge,), h = body.edges, np.exp(random.uniform(np.log(0.01), np.log(0.3), n))
    u, rate = random.uniform(0.0, 1.0, n), random.uniform(-0.6, 0.6, n)
    push, push1, weight, weight1 = random.uniform(-1.5, 1.5, (2, n)), *random.uniform(-1.0, 1.0, (1, n)), None, None
    push, weight, weight1 = push[0], random.uniform(0.5, 1.5, n), random.uniform(-0.5, 0.5, n)

    def at(t, state):
        return bends.forces_on(body, edge, Shaking(push + push1 * t, push1, weight + weight1 * t, weight1), *state)

    steps, state, seen = 64, (u, rate), []
    for i in range(steps + 1):
        t, dt = h * i / steps, h / steps
        seen.append((at(t, state), state))
        slopes = [(state[1], seen[-1][0].bend)]
        for part in (0.5, 0.5, 1.0):  # Runge-Kutta of the fourth order
            there = tuple(x + part * dt * d for x, d in zip(state, slopes[-1], strict=True))
            slopes.append((there[1], at(t + part * dt, there).bend))
        state = tuple(x + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d) for x, a, b, c, d in zip(state, *slopes, strict=True))
    (first, begin), (last, end) = seen[0], seen[-1]
    most = np.maximum(np.abs(push), np.abs(push + push1 * h)), np.abs(push1), np.zeros(1)
    heaviest = np.maximum(weight, weight + weight1 * h) - 1.0, np.abs(weight1), np.zeros(1)
    ends = [bends.Ends(*state, forces.bend, forces.fz) for forces, state in ((first, begin), (last, end))]
    sags = bends.sags(body, edge, bends.Shakes(*most, *heaviest), h, *ends)
    for name, sag in zip(("fx", "fz"), sags, strict=True):
        values = np.array([getattr(forces, name) for forces, _ in seen])
        share = np.arange(steps + 1)[:, None] / steps
        off = np.abs(values - (1.0 - share) * values[0] - share * values[-1]).max(axis=0)
        kept = u > 0.0
        assert np.all(off[kept] <= sag[kept] * (1.0 + 1e-6) + 1e-9)
        assert np.median(off / sag) > 0.02  # and the bound is no idle one
