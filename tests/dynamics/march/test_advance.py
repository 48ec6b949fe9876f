"""Within one step: what is proved without a root search, and bodies that turn back next to the ground."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rocking_cli import LinearEquation, Motion, RigidBodyEquation, sine
from rocking_cli.dynamics.drive import drive_change
from rocking_cli.dynamics.lanes import Lanes
from rocking_cli.dynamics.march import advance
from rocking_cli.motions import Piece


def one(x):
    return np.array([float(x)])


@pytest.mark.parametrize(
    "model", [LinearEquation(), RigidBodyEquation(0.25, 1e-13), RigidBodyEquation(0.6, 1e-13)], ids=["linear", "alpha-0.25", "alpha-0.6"]
)
def test_grazing_is_decided_on_either_side(model):
    """A body falls under a constant push a > 1 that turns it back within 1e-6 ... 1e-12 of the ground: energy says on which side.

    v0^2/2 = G(y0) - G(y_min) with G' = y'': for y_min < 0 it strikes, for y_min > 0 it does not. Both ends of the step are
    in the air, so no sign change would show it.
    """
    push = Motion("push", (Piece(0.0, 60.0, (), 1.0),)).segments
    random = np.random.default_rng(6)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    for offset in np.geomspace(1e-6, 1e-12, 7):
        for _ in range(15):
            a, y0 = random.uniform(1.2, 4.0), random.uniform(0.02, 0.4)
            for least in (-offset, offset):
                spots = least + 0.5 * (y0 - least) * (nodes + 1.0)
                rise = 0.5 * (y0 - least) * float(weights @ model.force(spots, np.full(40, a)))
                k = np.zeros(1, dtype=np.int64)
                b = model.force(one(y0), one(a))
                lanes = Lanes(k, one(a), one(1), one(1), k, one(0), one(-1), one(y0), one(-math.sqrt(2 * rise)), b, one(0), k, k)
                hit = False
                for _ in range(40):
                    event = advance.advance(push, lanes, model)
                    hit |= bool(event.hit[0])
                    if hit or event.end.v[0] > 0.0:
                        break
                    lanes.u = event.step.u
                    lanes.y, lanes.v, lanes.b = event.end.y, event.end.v, event.end.b
                assert hit == (least < 0.0), (offset, a, y0)


@pytest.mark.parametrize(
    ("side", "begins", "ends", "falls_until"),
    [
        (1.0, (0, 0.3), (2, 0.4), 1.5 * math.pi),  # into the last of the three segments of the sine: to where that begins
        (1.0, (0, 0.3), (2, 0.0), 0.5 * math.pi),  # with the second
        (1.0, (0, 0.3), (0, 0.7), 0.7),  # outwards is against the ground: the drive falls while the ground's acceleration grows
        (-1.0, (0, 0.3), (0, 0.7), 0.3),
        (-1.0, (1, 0.2), (1, 0.9), 0.5 * math.pi + 0.9),
    ],
)
def test_the_drive_of_a_step_falls_until_its_last_segment_begins(side, begins, ends, falls_until):
    segments = sine().segments
    starts = 0.5 * math.pi * np.array([0.0, 1.0, 3.0])
    k, u = np.array([begins[0]]), one(begins[1])
    lanes = Lanes(k, one(2), one(3), one(1), k, u, one(side), one(0.4), one(0.1), one(0), one(0), k, k)
    h = (starts[ends[0]] + ends[1] - starts[begins[0]] - begins[1]) / 3.0
    step = advance.Step(np.array([ends[0]]), one(ends[1]), one(h), np.array([advance.SUBCRITICAL]), one(0))
    passage = advance.Passage(step, None, None, one(h), np.array([False]), one(0), one(0))
    found = advance._bottom(segments, lanes, passage, np.array([0]))
    assert found[0] == pytest.approx((falls_until - starts[begins[0]] - begins[1]) / 3.0, abs=1e-14)


@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_every_crest_of_a_step_is_found(damping):
    """Bodies at random places of a slow motion, in the air: where y' falls through zero on a fine raster of their step there is a crest,
    also where y' has the same sign at both ends, and nowhere else."""
    random, count, equation = np.random.default_rng(21), 2500, LinearEquation(damping)
    segments = sine(2).segments
    k, side = random.integers(0, len(segments), count), random.choice([-1.0, 1.0], count)
    u, amplitude, omega = (
        segments.length[k] * random.uniform(0.0, 0.95, count),
        random.uniform(0.3, 3.0, count),
        random.uniform(0.3, 2.0, count),
    )
    y, v = random.uniform(0.2, 1.4, count), random.uniform(-0.4, 0.4, count)
    b = equation.force(y, -side * amplitude * (segments.s_start[k] + drive_change(segments, k, u)))
    lanes = Lanes(np.arange(count), amplitude, omega, np.ones(count), k, u, side, y, v, b, np.zeros(count), 0 * k, 0 * k)
    passage = advance.advance(segments, lanes, equation)
    found = advance.turning_points(segments, lanes, passage, np.ones(count, dtype=bool))
    raster = np.linspace(0.0, 1.0, 1001)[:, None] * passage.reach
    speed = np.array([passage.arc.at(h).v for h in raster])
    falls = (speed[:-1] > 0.0) & (speed[1:] <= 0.0)
    (at,) = np.nonzero(falls.any(axis=0))
    np.testing.assert_array_equal(at, np.sort(found.lanes))
    order = np.argsort(found.lanes)
    first = falls[:, at].argmax(axis=0)
    assert np.all(raster[first, at] <= found.h[order] + 1e-12)
    assert np.all(found.h[order] <= raster[first + 1, at] + 1e-12)
    ends = speed[-1, at]
    assert ((v[at] < 0.0) & (ends < 0.0)).sum() > 5, "turned outwards and back"
    assert ((v[at] > 0.0) & (ends > 0.0)).sum() > 5, "turned back and outwards"
