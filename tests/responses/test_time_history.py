"""Time histories in units, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rocking_cli import Outcome, build_structure, check, cosine, parse_documents, parse_grid, pulse, sine
from rocking_cli.dynamics.method import LINEAR, Method
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.responses.time_history import time_history

STATUE = "kind: rigid\nleft: {left}\nright: {right}\nheight: 1.0\ngyration: 0.6\n"


@pytest.mark.parametrize(
    ("left", "right", "release"), [(0.6, 0.25, 0.5), (0.25, 0.6, 0.1)], ids=["released over the weaker edge", "over the stronger edge"]
)
def test_each_edge_keeps_its_own_time_in_free_rocking(left, right, release):
    """On an edge x = 1 - cosh p t + v sinh p t: back at p t = 2 artanh v, by way of the crest 1 - sqrt(1 - v^2)."""
    body = build_structure(parse_documents(STATUE.format(left=left, right=right))[0])
    found = time_history(body, None, None, [LINEAR], release=release, duration=60.0)
    edges = {side.side: side for side in body.sides}
    here, there, sign = edges["right"], edges["left"], 1.0
    t, v = math.acosh(1.0 / (1.0 - release)) / here.p, math.sqrt(release * (2.0 - release))
    wanted, impacts = [("release", 0.0, release * here.alpha, 0.0)], 0
    while v > 1e-3:
        wanted.append(("impact", t, 0.0, -sign * v * here.alpha * here.p))
        v *= here.eta * here.alpha * here.p / (there.alpha * there.p)
        here, there, sign = there, here, -sign
        crest = 1.0 - math.sqrt(1.0 - v * v)
        wanted.append(("peak", t + math.atanh(v) / here.p, sign * crest * here.alpha, 0.0))
        t += 2.0 * math.atanh(v) / here.p
        impacts += 1
    assert impacts > 20
    events = list(found.events())
    for event, (name, *numbers) in zip(events, wanted, strict=False):
        assert event["event"] == name
        assert (event["t"], event["theta"], event["theta_dot"]) == pytest.approx(tuple(numbers), abs=1e-11)
    while v > 1e-12:
        v *= here.eta * here.alpha * here.p / (there.alpha * there.p)
        here, there = there, here
        t += 2.0 * math.atanh(v) / here.p
    assert [e["t"] for e in events if e["event"] == "rest"] == [pytest.approx(t, abs=1e-6)]
    crests = [(at, theta) for name, at, theta, _ in wanted if name == "peak"][:4]
    rotation, _ = found.histories["linear"].at(np.array([at for at, _ in crests]) * body.p)
    assert rotation * body.alpha_on(np.sign(rotation)) == pytest.approx([theta for _, theta in crests], abs=1e-11)


def test_a_body_that_needs_pulling_down_is_not_called_safe():
    """Its rotation stays below alpha while Fz falls to 0, which only its forces show; with a little less of the motion it keeps contact."""
    body, shaking = build_structure(parse_documents("kind: block\nwidth: 2\nheight: 3\n")[0]), parse_grid("A=1.7,Omega=5")
    for scale, outcome in ((0.85, Outcome.ROCKED), (1.0, Outcome.LOST_CONTACT)):
        motion = with_vertical(sine(), cosine(3), scale)
        found = time_history(body, motion, shaking, [Method("nonlinear")])
        (said,) = found.summaries()
        assert found.histories["nonlinear"].outcome == Outcome.ROCKED
        assert (found.forces["nonlinear"].demands.fz_min <= 0.0) == (outcome == Outcome.LOST_CONTACT)
        assert said["outcome"] == outcome.flag
        assert outcome.sentence in next(found.summary())
        assert check(body, motion, shaking).outcome == outcome


def test_ground_that_falls_away_as_it_lifts_the_body_leaves_no_force():
    """From the first instant the weight is 1 - 1.03 A alpha < 0, with the push to the side that lifts the body."""
    body = build_structure(parse_documents("kind: block\nwidth: 2\nheight: 3\n")[0])
    motion = with_vertical(pulse("rectangular-impulse"), pulse("rectangular-impulse"), -1.03)
    for omega in (5.0, 7.5):
        (said,) = time_history(body, motion, parse_grid(f"A=1.9,Omega={omega}"), [LINEAR]).summaries(forces=True)
        assert (said["outcome"], said["fz_min"], said["friction"]) == ("lost_contact", 0.0, None)


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize(("a_g", "falls"), [(0.34, False), (0.5, True)])
def test_what_becomes_of_a_body_does_not_depend_on_how_much_of_it_is_shown(model, a_g, falls):
    """Cut within the shaking, at its end, on the way to the highest crest after it: what is shown ends there, the verdict stays."""
    body, shaking, method = build_structure(parse_documents("kind: block\nwidth: 1\nheight: 4\n")[0]), f"a_g={a_g}g,f_g=1", Method(model)
    long = time_history(body, sine(), parse_grid(shaking), [method])
    (whole,) = long.summaries(forces=True)
    assert Outcome[whole["outcome"].upper()].overturned == falls
    for duration in (0.05, 0.4, 1.0, 1.05):
        cut = time_history(body, sine(), parse_grid(shaking), [method], duration=duration)
        (said,) = cut.summaries(forces=not falls)
        for key, value in said.items():
            assert value == (pytest.approx(whole[key], rel=1e-9) if isinstance(value, float) else whole[key]), key
        assert [e["event"] for e in cut.events()] == [e["event"] for e in long.events() if e["t"] <= duration]
        assert list(cut.records())[-1]["t"] == pytest.approx(duration, rel=1e-14)
        assert list(cut.records(steps=True))[-1]["t"] == pytest.approx(duration, rel=1e-14)
