"""Bodies whose weight varies: what must not change, free fall, and their drive; other
answers stand in test_systems.py.
"""

import math

import numpy as np
import pytest
from oracles.collocation import Body, Edge, integrate
from support.bodies import shaking_of
from support.documents import built

from rocking_cli import (
    Motion,
    Outcome,
    RockingParameters,
    cosine,
    parse_grid,
    pulse,
    response,
    sine,
    time_history,
)
from rocking_cli.dynamics.method import Method
from rocking_cli.dynamics.outcome import FALLEN
from rocking_cli.dynamics.weighed_drive import WeighedSegments, weighed
from rocking_cli.errors import UsageError
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.polyline import Polyline
from rocking_cli.responses.history import history

FAST = with_vertical(
    sine(2), Motion("fast", (Piece(0.0, 9.0, (Harmonic(0.6, 3.3, 0.4),)),))
)


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_a_rectangular_impulse_on_ground_that_sways_upwards(model):
    """Straight lines across, and none upwards."""
    body, edge, motion = (
        block(0.3, 0.8),
        Edge(2.0, 0.3, 0.8),
        with_vertical(pulse("rectangular-impulse"), sine(1.5), 0.7),
    )
    found = response(Method(model, 1e-11).system_of(body), motion, 1.36, 7.8, body.eta)
    wanted = integrate(
        Body(edge, edge, 0.0, model == "nonlinear"), shaking_of(body, motion, 1.36, 7.8)
    )
    assert Outcome(int(found.outcome)).flag == wanted.outcome == "rocked"
    assert float(found.theta_ratio) == pytest.approx(wanted.rotation, abs=1e-10)


def block(alpha=0.2, eta=0.9):
    return RockingParameters(
        name="b",
        structure="block",
        p=2.0,
        alpha=alpha,
        eta=eta,
        uplift=math.tan(alpha),
        a_scale=1.0,
    )


def test_free_fall_is_an_outcome_of_its_own_at_its_instant():
    body = block()
    system = Method("nonlinear").system_of(body)
    motion = with_vertical(
        sine(1), sine(1), -8.0
    )  # z'' = -g at sin(phi) = 1/(8 A alpha)
    found = response(system, motion, [1.2, 0.1], 4.0, body.eta)
    assert found.outcome.tolist() == [Outcome.LOST_CONTACT, Outcome.NO_UPLIFT]
    assert math.isnan(found.theta_ratio[0])
    heard = history(system, motion, 1.2, 4.0, body.eta, duration=9.0)
    assert heard.outcome == Outcome.LOST_CONTACT
    assert heard.end == pytest.approx(
        math.asin(1.0 / (8.0 * 1.2 * body.alpha)) / 4.0, rel=1e-12
    )


@pytest.mark.parametrize(
    # end: the phase from which the weight is 0 where the body has just turned so far
    ("model", "line", "end"),
    [("linear", True, 12.0721701080), ("nonlinear", False, 10.6717030127)],
    ids=["linear, on a line", "nonlinear, at once"],
)
def test_the_rotation_when_the_ground_falls_away_tells_whether_the_body_has_overturned(
    model, line, end
):
    body, method, amplitude, edge = (
        block(),
        Method(model, 1e-11),
        2.0,
        Edge(2.0, 0.2, 0.9),
    )

    def motion(end):
        """The weight is 0 from `end` on: below on a line, or after a jump."""
        first = 3.0 if line else end
        fall = (
            Piece(first, 30.0, (), 0.0, -2.5 / (end - 3.0))
            if line
            else Piece(end, 30.0, (), -3.0)
        )  # 2.5: 1/(A alpha)
        across = Motion(
            "across", (sine().pieces[0], Piece(2.0 * math.pi, 14.0, (), 0.1))
        )
        return with_vertical(across, Motion("late", (Piece(0.0, first), fall)))

    def rotation(end):
        ground, steps = shaking_of(body, motion(end), amplitude, 2.0), []
        ground = ground._replace(marks=tuple(sorted({*ground.marks, 0.25 * end})))
        integrate(
            Body(edge, edge, 0.0, model == "nonlinear"),
            ground,
            seen=lambda _side, step: steps.append(step),
        )
        return next(
            (
                step.u_end
                for step in steps
                if step.t + step.h > 0.25 * end * (1.0 - 1e-9)
            ),
            math.inf,
        )

    assert rotation(end * (1.0 - 1e-7)) < FALLEN * body.alpha
    assert rotation(end * (1.0 + 1e-7)) > FALLEN * body.alpha
    for falls, wanted in (
        (end * (1.0 - 1e-6), Outcome.LOST_CONTACT),
        (end * (1.0 + 1e-6), Outcome.OVERTURNED_AFTER_IMPACT),
    ):
        assert response(
            method.system_of(body), motion(falls), [amplitude], 2.0, body.eta
        ).outcome.tolist() == [wanted]
        assert (
            history(
                method.system_of(body),
                motion(falls),
                amplitude,
                2.0,
                body.eta,
                duration=20.0,
            ).outcome
            == wanted
        )
        assert method.reference_of(body)(motion(falls), amplitude, 2.0)[0] == wanted


DOWN = Piece(37.0, 40.0, (), -10.0)


@pytest.mark.parametrize(
    # how the ground falls, and the phase at which the weight is 0; only later would it
    # lift off
    ("falls", "at"),
    [
        ([], 37.0),
        ([Piece(36.0, 37.0, (), 0.0, -10.0)], 36.5),
        ([Piece(36.0, 36.6, (), 0.0, -10.0), Piece(36.6, 37.0, (), -10.0)], 36.5),
    ],
    ids=["at once", "on a line", "before a jump"],
)
@pytest.mark.parametrize("lifts", [False, True], ids=["never lifted", "at rest again"])
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_the_ground_falls_away_from_a_body_that_is_pushed_against_its_wall(
    model, lifts, falls, at
):
    body = RockingParameters(
        name="b",
        structure="block",
        p=2.0,
        alpha=0.2,
        eta=-0.3,
        uplift=math.tan(0.2),
        a_scale=1.0,
        one_sided=True,
        arm=0.75 * 9.81 / 4.0,
    )
    system, inward = Method(model).system_of(body), Piece(math.pi, 40.0, (), 0.3)
    across = Motion(
        "push",
        (Piece(0.0, 1.0, (), -2.0 if lifts else 0.5), Piece(1.0, math.pi), inward),
    )
    motion = with_vertical(
        across,
        Motion("up", (Piece(0.0, falls[0].start if falls else 37.0), *falls, DOWN)),
    )
    assert float(system.least_uplift(motion)) == pytest.approx(
        0.5, rel=1e-12
    )  # the ground falls at 10 A alpha g
    for amplitude, wanted in ((1.0, "lost_contact"), (0.4, "no_uplift")):
        found = response(system, motion, [amplitude], 8.0, body.eta)
        forces = (
            time_history(
                body, motion, parse_grid(f"A={amplitude},Omega=8"), [Method(model)]
            )
            .forces[model]
            .extremes
        )
        assert Outcome(int(found.outcome[0])).flag == wanted
        assert math.isnan(found.theta_ratio[0]) == (wanted == "lost_contact")
        assert forces.fz_min == pytest.approx(
            0.0 if wanted == "lost_contact" else 0.2, abs=1e-12
        )
    heard = history(system, motion, 1.0, 8.0, body.eta, duration=9.0)
    words = [e.event for e in heard.events]
    assert (heard.outcome, heard.end, words[-1]) == (
        Outcome.LOST_CONTACT,
        pytest.approx(at / 8.0, rel=1e-12),
        "lost contact",
    )
    assert ("rest" in words) == lifts


def test_a_vertical_motion_is_named_as_it_was_recorded():
    lines = np.array([0.0]), np.array([0.2]), np.array([1.0]), np.array([-5.0])
    one, two = (
        Polyline(name, *lines, peak) for name, peak in (("one", 4.0), ("two", 2.0))
    )
    names = [with_vertical(one, two, *scale).name for scale in ((), (0.5,))]
    assert names == ["one with two upwards", "one with two times 0.5 upwards"]
    assert (
        with_vertical(sine(), cosine()).scaled(-1.0).name
        == "sine 1 cycle times -1 with cosine 1 cycle upwards"
    )


def test_records_keep_the_ratio_of_their_amplitudes_and_others_do_not_go_with_them():
    start, stop = np.array([0.0, 0.1]), np.array([0.1, 0.3])
    one = Polyline(
        "one", start, stop, np.array([0.0, 1.0]), np.array([10.0, -5.0]), 4.0
    )
    two = Polyline(
        "two", np.array([0.0]), np.array([0.2]), np.array([1.0]), np.array([-5.0]), 2.0
    )
    both = with_vertical(one, two, 0.5)
    assert both.vertical.value(np.array([0.0, 0.05, 0.1, 0.25])) == pytest.approx(
        [0.25, 0.1875, 0.125, 0.0], abs=1e-15
    )
    assert (float(both.value(0.05)), both.duration) == pytest.approx(
        (0.5, 0.3), rel=1e-14
    )
    with pytest.raises(UsageError, match="two records, or none"):
        with_vertical(one, sine(1))


FALLING = Motion(
    "falling",
    (
        Piece(0.0, math.pi, (Harmonic(1.0, 1.0, 0.5 * math.pi),)),
        Piece(math.pi, 6.0, (Harmonic(0.4, 1.0),)),
    ),
)


@pytest.mark.parametrize("motion", [FAST, with_vertical(FALLING, sine(1.5), 0.4)])
def test_the_strongest_drive_to_come_is_no_less_than_any_of_it(motion):
    """Of the horizontal motion, whose extremes are no ends of the common segments; one
    motion is strongest at its start.
    """
    found = weighed(motion, 0.3, 0.5)
    most, least = found.inward
    for k in range(len(found)):
        ahead = motion.value(np.linspace(found.start[k], motion.duration, 3000))
        assert most[k] >= ahead.max() - 1e-15
        assert least[k] <= ahead.min() + 1e-15
    assert most[0] == 1.0 == -least[0]


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("amplitude", [1.7, -1.7])
def test_the_least_weight_from_a_segment_on_is_that_of_a_raster(side, amplitude):
    segments = weighed(with_vertical(cosine(1.5), sine(2), 0.4), 0.3, 0.2)
    assert isinstance(segments, WeighedSegments)
    where, drive = np.full(2001, side), np.full(2001, amplitude)
    lows = [
        segments.weight(
            where, drive, np.full(2001, k), np.linspace(0.0, segments.length[k], 2001)
        ).min()
        for k in range(len(segments))
    ]
    least = [
        float(segments.least_weight(where[:1], drive[:1], np.array([k]))[0])
        for k in range(len(segments))
    ]
    assert least == pytest.approx(
        [min(lows[k:]) for k in range(len(segments))], abs=1e-6
    )
    after = np.array([len(segments)])
    assert segments.net(where[:1], drive[:1], after, np.zeros(1)) == [0.0]


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize("share", [0.6, -0.6])
def test_uplift_needs_the_part_of_gravity_that_is_there(model, share):
    """|xg''| = lambda (g + zg''), zg'' = r xg'': the side that grows lighter lifts
    first, at lambda g/(1 + lambda |r|).
    """
    texts = [
        "kind: block\nwidth: 0.5\nheight: 2",
        "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg",
    ]
    texts += (
        ["kind: parameters\np: 2\nalpha: 0.3\neta: 0.9\nlambda: 0.2"]
        if model == "linear"
        else []
    )
    for text in texts:
        body = built(text)
        system = Method(model).system_of(body)
        lifted = body.alpha / body.a_scale if model == "linear" else body.uplift
        lifts = (
            float(
                body.ground_acceleration(
                    system.least_uplift(with_vertical(sine(), sine(), share))
                )
            )
            / body.gravity
        )
        assert lifts == pytest.approx(lifted / (1.0 + lifted * abs(share)), rel=1e-12)


def test_points_under_a_vertical_sine_are_as_the_same_lines_in_pieces():
    """The sine is cut at its extremes, and the points with it."""
    time, level = np.array([0.0, 1.0, 4.0, 6.0]), np.array([0.0, 1.0, -1.0, 0.0])
    points = Polyline(
        "points", time[:-1], time[1:], level[:-1], np.diff(level) / np.diff(time)
    )
    body, a, omega = (
        block(),
        np.linspace(0.5, 4.0, 15),
        np.geomspace(0.5, 8.0, 7)[:, None],
    )
    found, wanted = (
        response(
            Method("linear").system_of(body),
            with_vertical(m, sine(), 0.5),
            a,
            omega,
            0.9,
        )
        for m in (points, Motion("p", points.pieces))
    )
    np.testing.assert_array_equal(found.outcome, wanted.outcome)
    np.testing.assert_array_equal(found.theta_ratio, wanted.theta_ratio)


@pytest.mark.parametrize("name", ["ricker-symmetric", "mavroeidis-papageorgiou"])
def test_the_weight_holds_to_the_end_of_a_piece(name):
    """A step goes across the extremes of a piece, each of which begins a segment."""
    motion = with_vertical(sine(), pulse(name), 0.5)
    segments = weighed(motion, 1.0, 1.0)
    k = np.repeat(np.arange(len(segments)), 20)
    left = segments.left_of_piece(k, np.zeros(k.size))
    u = np.tile(np.linspace(0.0, 0.999, 20), len(segments)) * left
    found = segments.weight(np.ones(k.size), np.ones(k.size), k, u)
    wanted = 1.0 + motion.vertical.value(segments.start[k] + u)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12)
