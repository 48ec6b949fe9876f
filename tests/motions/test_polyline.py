"""Motions of straight lines: the same numbers as the pieces they stand for, and records
in their own time.
"""

import dataclasses
import pickle

import numpy as np
import pytest
from support.record_layouts import plain_record as record
from support.record_layouts import wave
from support.refusals import refuses

from rocking_cli import MotionError, linear_response
from rocking_cli.motions import Motion, Piece
from rocking_cli.motions.polyline import Polyline
from rocking_cli.motions.records.record import record_motion


def polyline(count=60):
    level, time = wave(count, 1.0), np.arange(count) ** 1.1
    return Polyline(
        "p", time[:-1], time[1:], level[:-1], np.diff(level) / np.diff(time)
    )


def test_the_same_to_the_last_bit_as_its_pieces():
    lines = polyline()
    pieces = Motion(
        "p",
        tuple(
            Piece(a, b, (), c, s)
            for a, b, c, s in zip(
                lines.start, lines.stop, lines.constant, lines.slope, strict=True
            )
        ),
    )
    assert lines.pieces == pieces.pieces
    assert (lines.duration, lines.largest) == (pieces.duration, pieces.largest)
    phase = np.linspace(-1.0, lines.duration + 1.0, 1000)
    np.testing.assert_array_equal(lines.value(phase), pieces.value(phase))
    for field in dataclasses.fields(lines.segments):
        np.testing.assert_array_equal(
            getattr(lines.segments, field.name),
            getattr(pieces.segments, field.name),
            err_msg=field.name,
        )
    still, plain = lines.still_until(500.0), pieces.still_until(500.0)
    assert still.pieces == plain.pieces
    a, omega = np.meshgrid(np.linspace(1.1, 8.0, 12), np.linspace(0.5, 20.0, 12))
    found, wanted = (linear_response(m, a, omega, 0.9) for m in (lines, pieces))
    np.testing.assert_array_equal(found.theta_ratio, wanted.theta_ratio)
    np.testing.assert_array_equal(found.outcome, wanted.outcome)
    assert pickle.loads(pickle.dumps(lines)).pieces == lines.pieces


def test_a_record_runs_in_its_own_time_and_amplitude():
    samples = wave(300, -4.2)
    for scale in (1.0, 1.5, -0.5):
        motion = record_motion(record(samples, 0.01), scale)
        t = np.linspace(0.0, 2.989, 1001)
        assert motion.acceleration == pytest.approx(abs(scale) * 4.2, rel=1e-14, abs=0)
        assert motion.largest == pytest.approx(1.0, rel=1e-14, abs=0)
        wanted = scale * np.interp(t, 0.01 * np.arange(300), samples)
        np.testing.assert_allclose(
            motion.acceleration * motion.value(t), wanted, rtol=1e-11, atol=1e-13
        )
    assert record_motion(record(samples, 0.01)).name == "r N"
    assert polyline().acceleration is None


test_what_cannot_shake_is_refused = refuses(
    lambda given: record_motion(record(given[0], 0.01), given[1]),
    MotionError,
    [
        (([0.0, 0.0], 1.0), "zero throughout"),
        (([0.0, 1.0], 0.0), "a scale of 0"),
        (([0.0, 1.0], np.nan), "a scale of nan"),
    ],
)
test_bad_lines_are_refused = refuses(
    lambda ends: Polyline("bad", *np.array(ends), *np.zeros((2, len(ends[0])))),
    MotionError,
    [
        (([], []), "no pieces"),
        (([0.0, 1.0], [1.0, 1.0]), "is empty"),
        (([0.0, 1.0], [1.0, np.nan]), "not finite"),
    ],
)


def test_a_record_that_was_sampled_more_finely_is_the_record():
    samples = wave(37, 2.0)
    fine = np.interp(np.arange(5 * 36 + 1) / 5.0, np.arange(37), samples)
    found = record_motion(record(fine, 0.01)).coarsest
    once = record_motion(record(samples, 0.05))
    assert found.samples.step == pytest.approx(once.samples.step, rel=1e-14)
    np.testing.assert_allclose(
        found.samples.values, once.samples.values, rtol=0, atol=4e-15
    )
    assert found.acceleration == pytest.approx(once.acceleration, rel=1e-14)
    assert once.coarsest is once
    late = record_motion(
        record(np.append(fine, [0.0, 0.0]), 0.01)
    )  # its end is no multiple of the others
    assert late.coarsest is late
    ramp = record_motion(record(np.arange(9.0), 0.1)).coarsest
    assert ramp.samples.values.tolist() == [0.0, 1.0]


@pytest.mark.parametrize("count", [2, 8, 9, 10, 66, 701])
def test_the_next_interval_beyond_a_level_is_the_first_there_is(count):
    random = np.random.default_rng(count)
    level, time = random.standard_normal(count) ** 3, np.arange(count) * 1.0
    segments = Polyline("p", time[:-1], time[1:], level[:-1], np.diff(level)).segments
    k = random.integers(0, count, 200)
    above, below = random.uniform(0.0, np.abs(level).max() * 1.1, (2, 200))
    above[:20] = np.inf
    high, low = (
        np.maximum(segments.s_start, segments.s_end),
        np.minimum(segments.s_start, segments.s_end),
    )
    wanted = [
        next((n for n in range(i, count - 1) if high[n] > a or -low[n] > b), count - 1)
        for i, a, b in zip(k, above, below, strict=True)
    ]
    np.testing.assert_array_equal(segments.next_beyond(k, above, below), wanted)
