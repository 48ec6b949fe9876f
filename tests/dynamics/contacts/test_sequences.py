"""Sequences of impacts that are closed early: nothing that bodies do is above what is
said of them, and marching on finds the same.
"""

import math
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import bisect
from support.references import lanes
from support.synthetic_records import motion_of_samples, noise

from rocking_cli import (
    LinearEquation,
    Outcome,
    cosine,
    linear_response,
    nonlinear_response,
    pulse,
    sine,
)
from rocking_cli.dynamics import batch
from rocking_cli.dynamics.contacts import lasting_bounces
from rocking_cli.dynamics.contacts.lasting_bounces import (
    bounces_to_end,
    bound_of_peaks,
)
from rocking_cli.dynamics.march import proofs
from rocking_cli.motions.blocks import blocks
from rocking_cli.motions.polyline import Polyline


@pytest.mark.parametrize(
    ("omega", "eta"),
    [([2.0, 8.0], 1.0 - 1e-9), (0.5, np.array([0.9, 1.0 - 1e-9, 1.0]))],
    ids=["lifted by the second half of a cycle", "lifted twice"],
)
def test_bodies_that_hardly_leave_the_ground_and_would_bounce_for_ever_are_at_rest(
    omega, eta
):
    found = linear_response(sine(), 1.0 + 1e-9, omega, eta)
    assert np.all(found.outcome == Outcome.ROCKED)
    assert found.work.steps < 200
    if np.size(eta) > 1:
        assert found.theta_ratio == pytest.approx(
            found.theta_ratio[0], rel=1e-6
        )  # the first arc is the highest


@pytest.mark.slow
@pytest.mark.parametrize(
    "motion",
    [
        cosine(1.5),
        pytest.param(pulse("ricker-symmetric"), marks=pytest.mark.soak),
    ],
    ids=lambda m: m.name,
)
def test_given_up_is_what_would_have_been_given_up(motion, monkeypatch):
    monkeypatch.setattr(batch, "MAX_STEPS", 150)
    random = np.random.default_rng(5)
    amplitude, omega = (
        1.0 + 10.0 ** random.uniform(-9.0, -1.0, 40),
        10.0 ** random.uniform(-1.0, 1.0, 40),
    )
    eta = random.choice([1.0, 1.0 - 1e-9, 1.0 - 1e-5, 0.999], 40)
    early = linear_response(motion, amplitude, omega, eta)
    monkeypatch.setattr(proofs, "TOO_MANY_IMPACTS", proofs.FREE_MOTION)
    late = linear_response(motion, amplitude, omega, eta)
    assert np.array_equal(early.outcome, late.outcome)
    assert np.array_equal(early.theta_ratio, late.theta_ratio, equal_nan=True)
    assert early.work.steps < 0.6 * late.work.steps
    assert 10 < (early.outcome == Outcome.FAILED).sum() < 30


def start(motion, amplitude, v):
    """A body of Omega = 1 just after an impact at the beginning of a record, on the
    right edge.
    """
    force = -amplitude * float(motion.segments.s_start[0]) - 1.0
    return lanes(
        amplitude=amplitude, v=v, force=force, peak=np.inf, impacts=1, steps=16
    )


def highest_peak(drive, step, v):
    """Of the lossless linear oscillator x'' = x - sgn x + a, by closed forms from line
    to line and bisection; `step` apart the drive is `drive`.
    """
    x, side, highest = 0.0, 1.0, 0.0
    for begins, ends in pairwise(drive):
        rate, left, push = (ends - begins) / step, step, begins
        while left > 0.0:
            y0, v0, b, r = side * x, v, side * (push + x) - 1.0, side * rate

            def y(h, y0=y0, v0=v0, b=b, r=r):
                return (
                    y0
                    + v0 * math.sinh(h)
                    + 2.0 * b * math.sinh(0.5 * h) ** 2
                    + r * (math.sinh(h) - h)
                )

            def speed(h, v0=v0, b=b, r=r):
                return (
                    v0 * math.cosh(h)
                    + b * math.sinh(h)
                    + 2.0 * r * math.sinh(0.5 * h) ** 2
                )

            struck = y(left) <= 0.0  # |a| < 1: it falls once
            h = bisect(y, 1e-9 * left, left, xtol=1e-16) if struck else left
            if v0 > 0.0 > speed(h):
                highest = max(highest, y(bisect(speed, 1e-9 * h, h, xtol=1e-16)))
            x, v = side * y(h), speed(h)
            push, left = push + rate * h, left - h if struck else 0.0
            if struck:
                x, side, v = 0.0, -side, -v
    return highest


def fastest(motion, amplitude):
    """The largest speed of which anything is proved."""
    low, high = 1e-9, 1.0
    for _ in range(40):
        middle = math.sqrt(low * high)
        low, high = (
            (middle, high)
            if np.isfinite(
                bound_of_peaks(motion.segments, start(motion, amplitude, middle), 1.0)
            )
            else (low, middle)
        )
    return low


def in_step(level, fall, v, cycles):
    """A drive that falls and rises in step with the first bounces: none of its size
    pumps more energy into them.
    """
    lasts = np.tile([2.0 * v / (1.0 - level), 2.0 * v / (1.0 + level)], cycles)
    marks = np.append(0.0, np.cumsum(lasts))
    step = 0.1 * lasts.min()
    return (
        np.interp(
            np.arange(0.0, marks[-1], step),
            marks,
            np.append(np.tile([level, level - fall], cycles), level),
        ),
        step,
    )


RANDOM = np.random.default_rng(7)
IN_STEP = {
    "in step": (0.3, 0.02, 0.009, 6),
    "in step near uplift": (0.7, 0.005, 0.004, 6),
}
DRIVES = {
    "noise": (0.6 * RANDOM.uniform(-1.0, 1.0, 8), 0.05),
    "swings": (0.8 * np.cos(0.2 * np.arange(40)), 0.05),
    "towards uplift": (np.linspace(0.0, 0.9, 4), 0.1),
    "away from uplift": (np.linspace(0.9, -0.5, 4), 0.02),
    "hardly any": (
        np.full(40, 1e-3),
        0.2,
    ),  # only the height of the arcs bounds the speed
}


@pytest.mark.parametrize("name", [*DRIVES, *IN_STEP])
def test_no_peak_is_above_the_ceiling(name):
    """At the largest speed of which anything is proved and at parts of it, or at the
    one that the drive is in step with.
    """
    drive, step = in_step(*IN_STEP[name]) if name in IN_STEP else DRIVES[name]
    motion, amplitude = motion_of_samples(-drive, step), np.abs(drive).max()
    speeds = (
        [IN_STEP[name][2]]
        if name in IN_STEP
        else fastest(motion, amplitude) * np.array([1.0, 0.5])
    )
    found = [
        highest_peak(drive.tolist(), step, v)
        / bound_of_peaks(motion.segments, start(motion, amplitude, v), 1.0)
        for v in speeds
    ]
    assert max(found) <= 1.0
    assert max(found) > 0.35  # of a bound that means something


@pytest.mark.parametrize(
    ("alpha", "excess"),
    [
        (0.0, (-0.9, -0.7)),
        *(
            pytest.param(x, (-1.3, -0.7), marks=pytest.mark.soak)
            for x in (0.0, 0.25, 0.8)
        ),
    ],
)
def test_marching_on_under_a_record_finds_the_same_peak(alpha, excess, monkeypatch):
    """alpha: of a rigid body, 0: the linear oscillator; excess: of A over uplift, its
    logarithm.
    """
    random = np.random.default_rng(3)
    amplitude = 1.0 + 10.0 ** random.uniform(*excess, 8)
    omega, eta = random.uniform(0.2, 0.5, 8), random.choice([0.995, 1.0], 8)
    motion = motion_of_samples(noise(60, 0.05, 1), 0.05)

    def found():
        if alpha:
            return nonlinear_response(
                motion, amplitude * math.tan(alpha) / alpha, omega, eta, alpha
            )
        return linear_response(motion, amplitude, omega, eta)

    early = found()
    monkeypatch.setattr(proofs, "BOUNCES_TO_END", proofs.FREE_MOTION)
    late = found()
    np.testing.assert_array_equal(early.outcome, late.outcome)
    np.testing.assert_array_equal(early.theta_ratio, late.theta_ratio)
    assert early.work.steps < 0.8 * late.work.steps


@pytest.mark.parametrize(
    ("proved", "amplitude", "v", "changed"),
    [
        (True, 0.9, 1e-5, {}),
        (False, 1.0, 1e-5, {}),  # it is lifted again
        (False, 0.9, 1e-5, {"steps": 17}),  # not now
        (False, 0.9, 1e-5, {"eta": 0.98}),
        (False, 0.9, 0.5, {}),
        (False, 0.9, 1e-5, {"force": -1e-17}),  # lost beside 1
    ],
)
def test_a_body_is_followed_unless_its_bounces_are_proved_to_last(
    proved, amplitude, v, changed
):
    motion = motion_of_samples([0.0, 0.5, -1.0, 0.0], 0.1)
    body = start(motion, amplitude, v)
    for name, value in changed.items():
        getattr(body, name)[:] = value
    assert bool(bounces_to_end(motion.segments, body, LinearEquation())[0]) == proved


def test_a_long_record_is_gone_through_part_by_part(monkeypatch):
    motion = motion_of_samples(noise(60, 0.05, 1), 0.05)
    body = start(motion, 0.9, 1e-4)
    whole = bound_of_peaks(motion.segments, body, 1.0)
    monkeypatch.setattr(lasting_bounces, "blocks", partial(blocks, most=7))
    assert bound_of_peaks(motion.segments, body, 1.0) == pytest.approx(whole, rel=1e-14)


def test_nothing_is_proved_of_a_motion_that_jumps(monkeypatch):
    marks = np.array([0.0, 1.0, 2.0])
    for after, sure in ((0.5, True), (0.499, False), (-0.5, False)):
        motion = Polyline(
            "step", marks[:-1], marks[1:], np.array([0.5, after]), np.zeros(2)
        )
        for part in (1, 2):
            monkeypatch.setattr(lasting_bounces, "blocks", partial(blocks, most=part))
            assert (
                np.isfinite(
                    bound_of_peaks(motion.segments, start(motion, 0.5, 1e-3), 1.0)
                )
                == sure
            )
