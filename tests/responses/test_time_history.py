"""Time histories in units, against closed forms."""

import math

import numpy as np
import pytest
from support.documents import built

from rocking_cli import Outcome, check, cosine, parse_grid, pulse, sine, time_history
from rocking_cli.dynamics.method import LINEAR, Method
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.reports.response_words import response_in_words

STATUE = "kind: rigid\nleft: {left}\nright: {right}\nheight: 1.0\ngyration: 0.6\n"


@pytest.mark.parametrize(
    ("left", "right", "release"),
    [(0.6, 0.25, 0.5), (0.25, 0.6, 0.1)],
    ids=["released over the weaker edge", "over the stronger edge"],
)
def test_each_edge_keeps_its_own_time_in_free_rocking(left, right, release):
    """On an edge x = 1 - cosh p t + v sinh p t: back at p t = 2 artanh v, by way of the
    crest 1 - sqrt(1 - v^2).
    """
    body = built(STATUE.format(left=left, right=right))
    found = time_history(body, None, None, [LINEAR], release=release, duration=60.0)
    edges = {side.side: side for side in body.sides}
    here, there, sign = edges["right"], edges["left"], 1.0
    t, v = (
        math.acosh(1.0 / (1.0 - release)) / here.p,
        math.sqrt(release * (2.0 - release)),
    )
    wanted, impacts = [("release", 0.0, release * here.alpha, 0.0)], 0
    while v > 1e-3:
        wanted.append(("impact", t, 0.0, -sign * v * here.alpha * here.p))
        v *= here.eta * here.alpha * here.p / (there.alpha * there.p)
        here, there, sign = there, here, -sign
        crest = 1.0 - math.sqrt(1.0 - v * v)
        wanted.append(
            ("peak", t + math.atanh(v) / here.p, sign * crest * here.alpha, 0.0)
        )
        t += 2.0 * math.atanh(v) / here.p
        impacts += 1
    assert impacts > 20
    events = list(found.events())
    for event, (name, *numbers) in zip(events, wanted, strict=False):
        assert event["event"] == name
        assert (event["t"], event["theta"], event["theta_dot"]) == pytest.approx(
            tuple(numbers), abs=1e-11
        )
    while v > 1e-12:
        v *= here.eta * here.alpha * here.p / (there.alpha * there.p)
        here, there = there, here
        t += 2.0 * math.atanh(v) / here.p
    assert [e["t"] for e in events if e["event"] == "rest"] == [
        pytest.approx(t, abs=1e-6)
    ]
    crests = [(at, theta) for name, at, theta, _ in wanted if name == "peak"][:4]
    rotation, _ = found.histories["linear"].at(
        np.array([at for at, _ in crests]) * body.p
    )
    assert rotation * body.alpha_on(np.sign(rotation)) == pytest.approx(
        [theta for _, theta in crests], abs=1e-11
    )


def test_a_body_that_needs_pulling_down_is_not_called_safe():
    """Its rotation stays below alpha while Fz falls to 0, which only its forces show;
    with a little less of the motion it keeps contact.
    """
    body, shaking = (
        built("kind: block\nwidth: 2\nheight: 3\n"),
        parse_grid("A=1.7,Omega=5"),
    )
    for scale, outcome in ((0.85, Outcome.ROCKED), (1.0, Outcome.LOST_CONTACT)):
        motion = with_vertical(sine(), cosine(3), scale)
        found = time_history(body, motion, shaking, [Method("nonlinear")])
        (said,) = found.summaries()
        assert found.histories["nonlinear"].outcome == outcome
        assert (found.forces["nonlinear"].extremes.fz_min <= 0.0) == (
            outcome == Outcome.LOST_CONTACT
        )
        assert said["outcome"] == outcome.flag
        assert (said["theta_ratio"] is None) == (outcome == Outcome.LOST_CONTACT)
        assert outcome.sentence in next(response_in_words(found))
        assert check(body, motion, shaking, a_max=None).outcome == outcome


def test_ground_that_falls_away_as_it_lifts_the_body_leaves_no_force():
    """From the first instant the weight is 1 - 1.03 A alpha < 0, with the push to the
    side that lifts the body.
    """
    body = built("kind: block\nwidth: 2\nheight: 3\n")
    motion = with_vertical(
        pulse("rectangular-impulse"), pulse("rectangular-impulse"), -1.03
    )
    for omega in (5.0, 7.5):
        (said,) = time_history(
            body, motion, parse_grid(f"A=1.9,Omega={omega}"), [LINEAR]
        ).summaries(forces=True)
        assert (said["outcome"], said["fz_min"], said["friction_needed"]) == (
            "lost_contact",
            0.0,
            None,
        )


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize(("a_g", "falls"), [(0.34, False), (0.5, True)])
def test_what_becomes_of_a_body_does_not_depend_on_how_much_of_it_is_shown(
    model, a_g, falls
):
    """Cut within the shaking, at its end, on the way to the highest crest after it:
    what is shown ends there, the verdict stays.
    """
    body, shaking, method = (
        built("kind: block\nwidth: 1\nheight: 4\n"),
        f"a_g={a_g}g,f_g=1",
        Method(model),
    )
    long = time_history(body, sine(), parse_grid(shaking), [method])
    (whole,) = long.summaries(forces=True)
    assert Outcome[whole["outcome"].upper()].overturned == falls
    for duration in (0.05, 0.4, 1.0, 1.05):
        cut = time_history(
            body, sine(), parse_grid(shaking), [method], duration=duration
        )
        (said,) = cut.summaries(forces=not falls)
        for key, value in said.items():
            assert value == (
                pytest.approx(whole[key], rel=1e-9)
                if isinstance(value, float)
                else whole[key]
            ), key
        assert [e["event"] for e in cut.events()] == [
            e["event"] for e in long.events() if e["t"] <= duration
        ]
        assert list(cut.rows())[-1]["t"] == pytest.approx(duration, rel=1e-14)
        assert list(cut.rows(steps=True))[-1]["t"] == pytest.approx(duration, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "left", "right", "corners"),
    [
        (
            "kind: block\nwidth: 0.5\nheight: 2\n",
            (-0.25, 0.0),
            (0.25, 0.0),
            [(-0.25, 2.0), (0.25, 2.0)],
        ),
        (
            "kind: prism\ncorners: [[0, 0], [0.6, 0], [0.5, 1.8], [0.3, 1.8]]\n",
            (0.0, 0.0),
            (0.6, 0.0),
            [(0.5, 1.8), (0.3, 1.8)],
        ),
        (
            "kind: block\nwidth: 0.6\nheight: 2\ninset: 40 mm\n",
            (-0.26, 0.0),
            (0.26, 0.0),
            [(-0.3, 2.0), (0.3, 2.0)],
        ),
    ],
)
def test_the_top_moves_as_far_as_its_corners(text, left, right, corners):
    """Each corner turned about the edge at many instants: theta > 0 turns towards +x
    about the right one.
    """
    body = built(text)
    for share, motion in (
        (1.3, sine(1.5)),
        (1.3, sine(1.5).scaled(-1.0)),
        (0.4, sine()),
    ):
        found = time_history(
            body,
            motion,
            parse_grid(f"a_g={share * body.uplift}g,f_g=2"),
            [Method("nonlinear")],
        )
        theta = np.array([row["theta"] for row in found.rows(dt=1e-3)])
        most = 0.0
        for x, z in corners:
            for pivot, turned in (
                (right, theta[theta > 0.0]),
                (left, theta[theta < 0.0]),
            ):
                dx, dz = x - pivot[0], z - pivot[1]
                move = np.hypot(
                    np.cos(turned) * dx + np.sin(turned) * dz - dx,
                    np.cos(turned) * dz - np.sin(turned) * dx - dz,
                )
                most = max(most, move.max(initial=0.0))
        assert found.top_displacement("nonlinear") == pytest.approx(
            most, rel=1e-4, abs=1e-15
        )
        assert bool(most) == (share > 1.0)


def test_what_falls_or_has_no_geometry_has_no_top():
    history = time_history(
        built("kind: block\nwidth: 0.5\nheight: 2\n"),
        sine(),
        parse_grid("a_g=9,f_g=0.5"),
        [Method("nonlinear")],
    )
    assert history.top_displacement("nonlinear") is None
    stated = built("kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\nlambda: 0.2\n")
    assert (
        time_history(
            stated, sine(), parse_grid("a_g=2.5,f_g=1"), [Method("linear")]
        ).top_displacement("linear")
        is None
    )


def test_rows_end_where_the_body_loses_contact():
    body = built("kind: block\nwidth: 2\nheight: 2\nrestitution: 0.5\n")
    methods = [LINEAR, Method("nonlinear")]
    found = time_history(body, sine(), "a_g=6g,f_g=5", methods)
    ends = {e["model"]: e for e in found.events() if e["event"] == "lost contact"}
    first, last = sorted(ends, key=lambda model: ends[model]["t"])
    *rows, end = found.rows()
    assert end["t"] == pytest.approx(ends[last]["t"], rel=1e-12)
    assert end[f"theta_{last}"] == pytest.approx(ends[last]["theta"], rel=1e-9)
    for row in rows:  # an equation whose body has lost contact says nothing more
        known = row[f"theta_{first}"] is not None
        assert known == (row["t"] <= ends[first]["t"])
    for line, model in zip(response_in_words(found), found.histories, strict=True):
        assert f"loses contact with the ground at {ends[model]['t']:.4g} s" in line
        assert "largest theta" not in line
    brief = time_history(body, sine(), "a_g=6g,f_g=5", methods, duration=0.05)
    assert list(response_in_words(brief)) == list(response_in_words(found))


def test_a_loss_of_contact_during_a_fall_is_told():
    said = [
        next(
            response_in_words(time_history("block:0.5x2", sine(), f"a_g={a_g}g,f_g=1"))
        )
        for a_g in (1, 2)
    ]
    told = ["during its fall, which is therefore not proved" in line for line in said]
    assert told == [False, True]
    verdict = check("block:0.5x2", sine(), "a_g=2g,f_g=1", a_max=None)
    assert verdict.row()["lost_in_fall"]
    assert verdict.fz_min < 0.0
