"""Whole lines of a record: bodies that take them end as bodies that go from event to
event.
"""

import math

import mpmath
import numpy as np
import pytest
from support.documents import built
from support.soak import quick
from support.synthetic_records import motion_of_samples
from support.tied_march import marched

from rocking_cli import Method, Outcome, safe
from rocking_cli.dynamics.equations.recurrence import motion_terms
from rocking_cli.dynamics.tied import tied_march
from rocking_cli.dynamics.tied.devices import ELASTIC
from rocking_cli.dynamics.tied.series import HeldBody

STEP = 0.02  # s
BLOCK = "kind: block\nwidth: 0.6\nheight: 3\nmass: 5000\n"
BODIES = {
    "one-sided, yields": (
        "kind: wall\nthickness: 0.6\nheight: 6\none_sided: true\nmass: 7200\nties:"
        " [{height: 5.5, stiffness: 2e6, prestress: 5e3, yield: 2e4, ultimate: 0.5}]\n"
    ),
    "two ties, one breaks": BLOCK
    + "ties: [{height: 2.8, stiffness: 1e5, yield: 3e3, behind: 0.2, side: left},"
    " {height: 1.5, stiffness: 4e5, ultimate: 0.02, side: both}]\n",
    "tendon, damped": BLOCK
    + "damping: 0.03\ntendon: {stiffness: 2e6, prestress: 1e4, rupture: 9e4}\n",
    "stiff tie": BLOCK + "ties: [{height: 3, stiffness: 3e7, side: right}]\n",
}


def shaking(samples=150):
    """A record of several frequencies."""
    t = STEP * np.arange(samples)
    waves = [(1.0, 0.6, 0.0), (0.7, 1.3, 1.0), (0.5, 2.9, 2.0), (0.3, 6.1, 0.5)]
    s = sum(a * np.sin(2.0 * math.pi * f * t + u) for a, f, u in waves)
    return motion_of_samples(np.sin(math.pi * t / t[-1]) * s, STEP)


@pytest.mark.parametrize("name", quick(BODIES, "two ties, one breaks"))
def test_bodies_end_as_without_whole_lines(name, monkeypatch):
    body, motion = built(BODIES[name]), shaking()
    system, ones = Method("nonlinear").system_of(body), np.ones(4)
    amplitude = system.least_uplift(motion) * np.geomspace(0.99, 4.0, ones.size)
    cells = amplitude, ones / body.p
    many = marched(system, motion, *cells)
    monkeypatch.setattr(tied_march, "LEAST_LINES", 1 << 30)
    found = marched(system, motion, *cells)
    assert {Outcome.NO_UPLIFT, Outcome.ROCKED} <= set(found.outcome.tolist())
    stands = safe(found.outcome)
    assert (many.outcome == found.outcome).all()
    assert (many.impacts == found.impacts).all()
    for field in ("theta_ratio", "branch", "plastic", "farthest"):
        values = (getattr(x, field)[..., stands] for x in (many, found))
        np.testing.assert_allclose(*values, rtol=0.0, atol=1e-9)


def test_the_series_of_a_stiff_tie_begins_without_cancellation():
    """y'' at rest on one side, by the balance of moments in 30 digits."""
    system = Method("nonlinear").system_of(built(BODIES["stiff tie"]))
    devices, row = system.devices, np.zeros(1, dtype=np.int64)
    elastic = np.full((1, 1), ELASTIC)
    branch = devices.branch(row, elastic, np.zeros((1, 1)))
    held = HeldBody.of(system.equation.on(np.ones(1)), devices, row, branch)
    y, drive = 1e-5, 1.2
    one = held.of_first(system.equation.edge(1.0))
    terms = motion_terms(one, y, 0.0, 1.0, [0.5], [drive, 0.0])

    with mpmath.workdps(30):
        alpha = mpmath.mpf(float(system.equation.alpha))
        theta = mpmath.sin(alpha) * y
        height, stiffness = devices.height[0].item(), devices.stiffness[0].item()
        lever = height * mpmath.cos(theta)
        force = stiffness * height * mpmath.sin(theta)
        free = -mpmath.sin(alpha - theta) / mpmath.sin(alpha)
        free += drive * mpmath.cos(alpha - theta) / mpmath.cos(alpha)
        expected = float(free - force * lever / devices.moment[0].item())
    assert 2.0 * terms[2] == pytest.approx(expected, rel=1e-12)
