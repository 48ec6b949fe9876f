"""One body with ties or a tendon on floats: as the march of many bodies on arrays. Its
histories and forces stand in dynamics/tied.
"""

import math

import numpy as np
import pytest
from support.documents import built
from support.tied_bodies import random_motion, random_push, random_tied
from support.tied_march import marched

from rocking_cli import Method, Outcome, pulse, response, safe
from rocking_cli.dynamics.one.lane import Lane
from rocking_cli.dynamics.one.march import march
from rocking_cli.dynamics.one.one_by_one import OneByOne
from rocking_cli.dynamics.tied.devices import BROKEN
from rocking_cli.responses.history import history
from rocking_cli.responses.march_writer import MarchWriter


def compared(seed):
    """The outcomes of a random body at four amplitudes, which both marches share."""
    random = np.random.default_rng(seed)
    body = random_tied(random, (0.05, 0.95))
    motion = random_motion(random, seed % 4 == 0)
    system = Method(("linear", "nonlinear")[seed % 2]).system_of(body)
    push, omega = random_push(random, body, motion)
    cells = push * np.array([0.6, 0.8, 1.0, 1.3]), np.full(4, omega)
    with np.errstate(all="ignore"):
        alone = OneByOne(system, motion, cells, peaks=True)
    together = response(system, motion, *cells)
    np.testing.assert_array_equal(alone.outcome, together.outcome, f"{seed}")
    stands = safe(together.outcome)
    room = 1e-9 * (1.0 + np.nan_to_num(together.condition))[stands]
    apart = np.abs(alone.theta_ratio - together.theta_ratio)[stands]
    assert (apart <= room).all(), seed
    return set(together.outcome.tolist())


@pytest.mark.parametrize(
    "seeds",
    [range(6), pytest.param(range(6, 1000), marks=pytest.mark.soak)],
    ids=["few", "many"],
)
def test_random_bodies_end_as_on_arrays(seeds):
    seen = set.union(*map(compared, seeds))
    assert {Outcome.ROCKED, Outcome.LOST_CONTACT, Outcome.NO_UPLIFT} <= seen


TIES = (
    "kind: block\nwidth: 0.6\nheight: 3\nmass: 5000\n"
    "ties: [{height: 2.8, stiffness: 1e5, yield: 3e3, behind: 0.2, side: left},"
    " {height: 1.5, stiffness: 4e5, ultimate: 0.02, side: both}]\n"
)


def test_ties_are_left_as_on_arrays():
    """Branches, permanent and largest elongations: one tie yields, one breaks."""
    body = built(TIES)
    system, motion = Method("nonlinear").system_of(body), pulse("ricker-symmetric")
    amplitude, omega = 2.0 * system.least_uplift(motion), 4.0
    cells = np.array([amplitude]), np.array([omega])
    together = marched(system, motion, *cells)
    with np.errstate(all="ignore"):
        alone = march(Lane(system, motion, omega), amplitude)
    assert alone.outcome == together.outcome[0] == Outcome.ROCKED
    assert (together.plastic > 0.0).any()
    assert (together.branch == BROKEN).any()
    for name in ("branch", "plastic", "farthest"):
        values = (getattr(x, name) for x in (alone.restraints, together))
        np.testing.assert_allclose(*values, rtol=1e-9, atol=1e-12)


def test_a_body_falls_where_it_passes_three_times_its_critical_angle():
    """The last event of a fall, and the elongation there, whatever the steps are."""
    body = built(TIES.replace("stiffness: 4e5", "stiffness: 4e3"))
    system, motion = Method("linear").system_of(body), pulse("rectangular-impulse")
    found = history(system, motion, 8.0, 1.0, duration=20.0)
    last = found.events[-1]
    assert (last.event, found.outcome.overturned) == ("overturning", True)
    assert abs(last.theta_ratio) == pytest.approx(3.0, rel=1e-9)
    most = max(row["tie_elongation"] for row in found.devices)
    assert most <= 2.8 * 3.0 * math.atan(0.2) * (1.0 + 1e-9)


def test_a_body_rests_when_it_does_whatever_bounces_are_shown(monkeypatch):
    """Bounces that are no longer shown are followed while the drive changes."""
    text = TIES.replace("side: left", "side: right").replace(
        "side: both", "side: right"
    )
    body = built(text + "one_sided: true\nrestitution: -0.8\ndamping: 0.2\n")
    system, motion = Method("nonlinear").system_of(body), pulse("cosine")
    amplitude = 1.6 * system.least_uplift(motion)
    rests = []
    for visible in (1e-4, 1e-6):
        monkeypatch.setattr(MarchWriter, "visible", visible)
        events = history(system, motion, amplitude, 1.0, duration=40.0).events
        rests.append([e.tau for e in events if e.event == "rest"])
    assert rests[0]
    assert rests[0] == pytest.approx(rests[1], abs=1e-9)
