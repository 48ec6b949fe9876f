"""What the forces stay between along a step, against their values along it, which follow from the state and the drive."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest
from support.stocky_bodies import ACROSS, KINDS, UP, drawn

from rocking_cli import Method
from rocking_cli.dynamics.march import hulls
from rocking_cli.dynamics.march.demand import Demands
from rocking_cli.dynamics.march.hulls import hulls_of
from rocking_cli.dynamics.response import response_with_demands
from rocking_cli.motions.biaxial import with_vertical

EVENLY = np.linspace(0.0, 1.0, 23)
NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(6) / 5)


def polynomial(coefficients, x):
    degree = len(coefficients) - 1
    return sum(c * comb(degree, n) * x**n * (1.0 - x) ** (degree - n) for n, c in enumerate(coefficients))


def along_steps(demands, lanes, arc, stop, at, places):
    """Fx and Fz over m g, (2, places, steps)."""
    some, whole, length = lanes.take(at), arc.take(at), stop[at]
    forces = []
    for x in places:
        point = whole.at(x * length)
        least, ratio = demands.course(some, x * length, point.y, point.v).value
        forces.append((ratio * -least, -least))
    return np.array(forces).transpose(1, 0, 2)


def watched(kind, seed, cells, monkeypatch, tolerance=1e-9):
    """Along the steps of bodies drawn at random: what the forces differ from their polynomials, over what they may, (differences,)."""
    found, follow, random = [], Demands.follow, np.random.default_rng(seed)

    def look(self, lanes, arc, stop, y, v, at):
        hull, (fx, fz) = hulls_of(arc.shown, stop / arc.longest).take(at), along_steps(self, lanes, arc, stop, at, EVENLY)
        none = np.isnan(hull.possible[0])  # the reach of series with hardly any bend overflows: their steps are searched
        assert not np.any(hull.take(np.flatnonzero(none)).crests(np.zeros(np.count_nonzero(none), dtype=np.int64)).plain)
        for (across, up), x in zip(zip(fx, fz, strict=True), EVENLY, strict=True):
            there = polynomial(hull.forces.astype(float), x)
            found.append((np.abs(there - (-across, up)) / hull.slack)[:, ~none].ravel())
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(fz > 0.0, np.abs(fx / fz), np.inf)
            assert not np.any(-fz.min(axis=0) >= hull.possible[0])
            assert not np.any((ratio.max(axis=0) >= hull.possible[1]) & np.isfinite(hull.possible[1]))
            fx, fz = along_steps(self, lanes, arc, stop, at, NODES)
            assert not np.any(-fz.min(axis=0) < hull.reached[0])
            assert not np.any(np.where(fz > 0.0, np.abs(fx / fz), np.inf).max(axis=0) < hull.reached[1])
        return follow(self, lanes, arc, stop, y, v, at)

    monkeypatch.setattr(Demands, "follow", look)
    for vertical in (False, True):
        body, _, _ = drawn(kind, random, (0.1, 0.7), (0.4, 0.85), 0.3)
        motion = ACROSS[random.integers(len(ACROSS))]
        if vertical:
            motion = with_vertical(motion, UP[random.integers(len(UP))], random.uniform(-0.4, 0.4))
        system = Method("nonlinear", tolerance).system_of(body)
        response_with_demands(system, motion, random.uniform(0.8, 8.0, cells), random.uniform(0.5, 12.0, cells), body.eta)
    return np.concatenate(found)


def test_forces_stay_within_the_hulls_of_their_steps(monkeypatch):
    apart = watched("unequal", 2, 20, monkeypatch)
    assert apart.max() < 1.0
    assert apart.max() > 0.2  # not wider than it has to be


@pytest.mark.soak
@pytest.mark.parametrize("tolerance", [1e-13, 1e-9, 1e-6, 1e-2])
@pytest.mark.parametrize("kind", KINDS)
def test_forces_of_many_bodies_do(kind, tolerance, monkeypatch):
    for seed in range(8):
        with monkeypatch.context() as patched:
            assert watched(kind, seed, 300, patched, tolerance).max() < 1.0


def hull_through(across, up, slack=1e-9):
    """Of one step, from the Bernstein coefficients of -Fx and Fz, and what these may be off."""
    forces = np.array([across, up], dtype=hulls.SINGLE).T[:, :, None]
    return hulls_of([(forces, np.full((2, 1), slack, dtype=hulls.SINGLE))], np.ones(1))


def test_a_crest_of_the_hull():
    """Fz = 1 - x (1 - x)^4 is least at x = 1/5, by 256/3125, where its second derivative is 64/25; Fx does not change."""
    crests = hull_through([0.3] * 6, [1.0, 1.0 - 1.0 / 5.0, 1.0, 1.0, 1.0, 1.0]).crests(np.zeros(1, dtype=np.int64))
    assert crests.plain[0]
    assert crests.x[0] == pytest.approx(0.2, abs=1e-5)  # of single precision
    assert crests.bend[0] == pytest.approx(-64.0 / 25.0, rel=1e-4)


def test_a_hull_with_two_places_of_one_height_is_not_plain():
    """Fz falls to 0.8 at either end; where one end is the lower by more than may be wrong it is the place."""
    two, one = [0.8, 1.0, 1.0, 1.0, 1.0, 0.8], [0.8, 1.0, 1.0, 1.0, 1.0, 0.79]
    found = [hull_through([0.0] * 6, up).crests(np.zeros(1, dtype=np.int64)) for up in (two, one)]
    assert [bool(x.plain[0]) for x in found] == [False, True]
    assert found[1].x[0] == 1.0


def test_a_crest_of_the_ratio():
    """|Fx| = x (1 - x)^4 under a steady Fz of 2: the second derivative is half of that of |Fx|."""
    crests = hull_through([0.0, 1.0 / 5.0, 0.0, 0.0, 0.0, 0.0], [2.0] * 6).crests(np.ones(1, dtype=np.int64))
    assert (crests.x[0], crests.bend[0]) == (pytest.approx(0.2, abs=1e-5), pytest.approx(-32.0 / 25.0, rel=1e-4))


def test_a_hull_that_leaves_room_for_two_crests_is_not_plain():
    assert not hull_through([0.0] * 6, [1.0, 0.5, 1.0, 0.6, 1.0, 1.0]).crests(np.zeros(1, dtype=np.int64)).plain[0]


def test_a_hull_that_is_level_where_its_crest_is_looked_for_is_not_plain():
    """Newton's method comes to x = 0, where neither the slope 6 x^2 (1 - x)^2 + x^4 of -Fz nor its rate says where to go."""
    with np.errstate(invalid="ignore"):  # as a march does
        crests = hull_through([0.0] * 6, [1.0, 1.0, 1.0, 0.75, 0.75, 0.5]).crests(np.zeros(1, dtype=np.int64))
    assert not crests.plain[0]
    assert 0.0 <= crests.x[0] <= 1.0  # a place to begin with


@pytest.mark.parametrize(
    "lower", [[0.0] * 6, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], [0.0, 1.0, 4.0, 4.0, -10.0, -100.0]], ids=["level", "end", "inside"]
)
def test_a_hull_that_falls_by_less_than_it_may_be_off_is_not_plain(lower):
    """What is least may as well be where it begins."""
    up = 0.9 - 1e-6 * np.array(lower)
    plain = [hull_through([0.0] * 6, up, slack).crests(np.zeros(1, dtype=np.int64)).plain[0] for slack in (1e-5, 1e-7)]
    assert plain == [False, any(lower)]


def test_a_ratio_that_is_as_large_on_either_side_is_not_plain():
    """Fx goes from -0.3 to 0.3 under a steady Fz."""
    for begin, plain in ((-0.3, False), (-0.2, True)):
        crests = hull_through(np.linspace(begin, 0.3, 6), [1.0] * 6).crests(np.ones(1, dtype=np.int64))
        assert bool(crests.plain[0]) == plain
        assert crests.x[0] == 1.0 or not plain


def test_a_step_that_ends_before_its_series_has_the_beginning_of_its_polynomials():
    forces = np.random.default_rng(4).uniform(0.5, 1.0, (6, 2, 1)).astype(hulls.SINGLE)
    slack, share = np.full((2, 1), 1e-5, dtype=hulls.SINGLE), 0.3
    begin = hulls_of([(forces.copy(), slack)], np.array([share])).forces
    for x in EVENLY:
        assert polynomial(begin.astype(float), x) == pytest.approx(polynomial(forces.astype(float), share * x), abs=5e-7)
