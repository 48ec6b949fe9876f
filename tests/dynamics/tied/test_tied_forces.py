"""Bodies with ties and a tendon on ground that moves upwards too, and the forces of the
ground on them: an integration by SciPy that knows geometry and Newton's law alone.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.documents import built
from support.tied_bodies import random_motion, random_push, random_tied

from rocking_cli import Method, Outcome, parse_grid, pulse, response, sine, time_history
from rocking_cli.dynamics.response import response_with_speed
from rocking_cli.motions.biaxial import with_vertical

G, MASS = 9.81, 2000.0
EXACT = Method("nonlinear", 1e-12)


class Rope(NamedTuple):
    """A tie (anchored at x, z from the pivot when the body leans right) or a tendon (at
    x, 0), in tension; a tie yields at a force.
    """

    x: float
    z: float
    stiffness: float
    prestress: float
    force: float = math.inf
    tendon: bool = False

    def pull(self, theta, permanent):
        """(force on the body, its moment about the pivot, elongation)."""
        cos, sin = math.cos(theta), math.sin(theta)
        at = np.array([self.x * cos + self.z * sin, self.z * cos - self.x * sin])
        way = at - np.array([self.x, self.z])
        if not self.tendon:
            way = np.array([way[0], 0.0])
        length = math.hypot(*way)
        tension = min(self.prestress + self.stiffness * (length - permanent), 1e99)
        along = way / length if length else np.array([0.0, float(self.tendon)])
        if not self.tendon:
            along = np.array([1.0, 0.0])
        force = -min(max(tension, 0.0), self.force) * along
        return force, at[0] * force[1] - at[1] * force[0], length


class Solved:
    """The motion of a block of half width b and half height h."""

    def __init__(self, b, h, eta, ropes, across, up):
        self.eta, self.ropes, self.across, self.up = eta, ropes, across, up
        self.radius, self.alpha = math.hypot(b, h), math.atan2(b, h)
        self.inertia = 4.0 / 3.0 * MASS * self.radius**2
        self.permanent = {side: np.zeros(len(ropes)) for side in (1, -1)}

    def rates(self, side, t, theta, rate):
        """(angular acceleration, Fx towards the lean, Fz), both over m g."""
        x, z = (
            -self.radius * math.sin(self.alpha - theta),
            self.radius * math.cos(self.alpha - theta),
        )
        ground = np.array([side * self.across(t), G + self.up(t)])
        moment = z * -MASS * ground[0] - x * -MASS * ground[1]
        force = np.zeros(2)
        for rope, permanent in zip(self.ropes, self.permanent[side], strict=True):
            pull, turns, _ = rope.pull(theta, permanent)
            moment, force = moment - turns, force + pull
        acceleration = moment / self.inertia
        of_centre = np.array(
            [
                z * acceleration - x * rate**2,
                -x * acceleration - z * rate**2,
            ]
        )
        needed = MASS * (of_centre + ground) - force
        return acceleration, *(needed / (MASS * G))

    def run(self, end):
        """t, theta, Fx, Fz and |dtheta/dt| along the arcs, (5, instants), up to
        t = end.
        """
        t, side, state, seen = 0.0, 0, (0.0, 0.0), []
        while t < end:
            if not side:
                t, side = self.uplift(t, end)
                if not side:
                    break
            t, side, state = self.arc(t, side, state, end, seen)
        return np.array(seen).T

    def uplift(self, t, end):
        times = np.linspace(t, end, 2001)
        for one, other in pairwise(times):
            for side in (1, -1):
                if self.rates(side, other, 0.0, 0.0)[0] > 0.0:
                    low, high = one, other
                    for _ in range(80):
                        middle = 0.5 * (low + high)
                        lifts = self.rates(side, middle, 0.0, 0.0)[0] > 0.0
                        low, high = (low, middle) if lifts else (middle, high)
                    return high, side
        return end, 0

    def arc(self, t, side, state, end, seen):
        """Go on to the next impact, yield or peak; adds to `seen` as `run` returns."""

        def left(y):
            return min(
                (rope.force - rope.prestress) / rope.stiffness
                - rope.pull(y[0], 0.0)[2]
                + permanent
                for rope, permanent in zip(
                    self.ropes, self.permanent[side], strict=True
                )
            )

        yielding = state[1] > 0.0 and left(state) < 1e-12

        def room(_t, y):
            return 1.0 if yielding else left(y)

        def ground(_t, y):
            return y[0]

        def peak(_t, y):
            return y[1]

        ground.terminal = room.terminal = True
        peak.terminal = yielding
        ground.direction = peak.direction = room.direction = -1.0
        found = solve_ivp(
            lambda t, y: (y[1], self.rates(side, t, *y)[0]),
            (t, end),
            state,
            "DOP853",
            events=(ground, peak, room),
            rtol=1e-12,
            atol=1e-14,
            dense_output=True,
        )
        times = np.linspace(t, found.t[-1], 301)
        for at, (theta, rate) in zip(times, found.sol(times).T, strict=True):
            _, fx, fz = self.rates(side, at, max(theta, 0.0), rate)
            seen.append((at, side * theta, side * fx, fz, abs(rate)))
        t, (theta, rate) = found.t[-1], found.y[:, -1]
        if found.t_events[0].size:
            rate = -self.eta * rate
            # so slow a body is at rest
            return (t, -side, (0.0, rate)) if rate > 1e-3 else (t, 0, (0.0, 0.0))
        if not (yielding and found.t_events[1].size):
            return t, side, (theta, rate)
        # beyond the yield the permanent elongation is that at the peak
        for i, rope in enumerate(self.ropes):
            reach = (rope.force - rope.prestress) / rope.stiffness
            stretched = rope.pull(theta, 0.0)[2] - reach
            self.permanent[side][i] = max(self.permanent[side][i], stretched)
        return t, side, (theta, 0.0)


@pytest.mark.parametrize(
    ("share", "yields"), [(0.0, ""), (0.6, ", yield: 14 kN")], ids=["level", "upwards"]
)
def test_the_ground_bears_what_newton_says(share, yields):
    """A block with a tie behind its pivot and a tendon, which keep their laws."""
    body = built(
        f"kind: block\nwidth: 1\nheight: 3\nmass: {MASS}\nrestitution: 0.7\n"
        "tendon: {stiffness: 3e5, prestress: 3e3}\n"
        f"ties: [{{height: 2.5, behind: 0.2, stiffness: 2e5, prestress: 1e3{yields}}}]"
    )
    a_g, frequency = 12.0, 1.2
    motion = with_vertical(sine(), pulse("cosine"), share) if share else sine()
    omega = 2.0 * math.pi * frequency

    def up(t):
        return a_g * share * math.cos(omega * t)

    ropes = [
        Rope(-0.2, 2.5, 2e5, 1e3, 14e3 if yields else math.inf),
        Rope(-0.5, 0.0, 3e5, 3e3, tendon=True),
    ]
    solved = Solved(0.5, 1.5, 0.7, ropes, lambda t: a_g * math.sin(omega * t), up)
    t, theta, fx, fz, rates = solved.run(0.999 / frequency)

    found = time_history(body, motion, parse_grid(f"a_g={a_g},f_g=1.2"), [EXACT])
    forces = found.forces["nonlinear"]
    tau = body.p * t
    ratio, _ = found.histories["nonlinear"].at(tau)
    np.testing.assert_allclose(body.alpha * ratio, theta, rtol=0, atol=1e-9)
    # at an impact either side may be meant
    air = np.abs(theta) > 1e-7
    across, upwards = (x[air] for x in forces.columns(tau).values())
    np.testing.assert_allclose(across, fx[air], rtol=0, atol=1e-8)
    np.testing.assert_allclose(upwards, fz[air], rtol=0, atol=1e-8)
    cell = found.amplitude, found.omega
    _, speed = response_with_speed(EXACT.system_of(body), motion, *map(np.array, cell))
    # after the shaking it may be faster still
    after = np.linspace(tau[-1], tau[-1] + 3.0, 20001)
    _, later = found.histories["nonlinear"].at(after)
    fastest = max(rates.max() / body.alpha / body.p, np.nanmax(np.abs(later)))
    assert float(speed) == pytest.approx(fastest, rel=1e-4)
    row = forces.summary("tau", 1.0)
    assert row["fz_min"] <= fz.min() + 1e-9
    assert row["friction_needed"] >= np.abs(fx / fz).max() - 1e-9


def compared(seed, model):
    """The outcome of a random body under a motion with a vertical part, which the
    reference solver finds too.
    """
    random = np.random.default_rng(seed)
    body, method = random_tied(random, (0.1, 0.95)), Method(model, 1e-11)
    motion = random_motion(random, vertical=True)
    cell = random_push(random, body, motion)
    found = response(method.system_of(body), motion, *cell)
    outcome, rotation = method.reference_of(body)(motion, *cell)
    assert Outcome(int(found.outcome)) == outcome, seed
    np.testing.assert_allclose(found.theta_ratio, rotation, rtol=0, atol=1e-6)
    return outcome


@pytest.mark.slow
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_random_bodies_on_ground_that_sways_upwards(model):
    found = {compared(seed, model).flag for seed in (3, 6, 7)}
    assert {"rocked", "lost_contact"} <= found


@pytest.mark.soak
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_many_random_bodies_on_ground_that_sways_upwards(model):
    found = [compared(seed, model) for seed in range(1000, 1600)]
    assert min(found.count(x) for x in (Outcome.ROCKED, Outcome.LOST_CONTACT)) > 100


def agreed(seed, vertical):
    """(outcome, least Fz) of a random body: the forces along its history say the same
    of the ground as its march.
    """
    random = np.random.default_rng(seed)
    body, motion = random_tied(random, (0.3, 0.95)), random_motion(random, vertical)
    amplitude, omega = random_push(random, body, motion)
    grid = parse_grid(f"A={amplitude!r},Omega={omega!r}")
    found = time_history(body, motion, grid, [Method("nonlinear")])
    outcome = found.histories["nonlinear"].outcome
    least = found.forces["nonlinear"].extremes.fz_min
    if not outcome.overturned:
        assert (least <= 0.0) == (outcome == Outcome.LOST_CONTACT), seed
    return outcome, least


@pytest.mark.soak
@pytest.mark.parametrize("vertical", [False, True])
def test_forces_and_marches_of_stocky_bodies_agree_on_the_ground(vertical):
    found = [agreed(seed, vertical) for seed in range(1000)]
    assert sum(outcome == Outcome.LOST_CONTACT for outcome, _ in found) > 200
    assert sum(0.0 < least < 0.1 for _, least in found) > 20


def test_the_ground_falls_away_from_a_body_that_rests():
    """Its tie holds it: w = 0 at |zg''| = g, from which moment on its outcome is lost
    contact, with the event at that instant.
    """
    body = built(
        f"kind: block\nwidth: 1\nheight: 2\nmass: {MASS}\n"
        "ties: [{height: 2, stiffness: 1e6, prestress: 9e4}]\n"
    )
    motion = with_vertical(sine().scaled(0.1), sine(), -1.0)
    grid = parse_grid(f"a_g={1.25 * G},f_g=1")
    found = time_history(body, motion, grid, [EXACT]).histories["nonlinear"]
    assert found.outcome == Outcome.LOST_CONTACT
    (event,) = found.events
    assert event.event == "lost contact"
    wanted = math.asin(1.0 / 1.25) / (2.0 * math.pi)
    assert event.tau / body.p == pytest.approx(wanted, rel=1e-12)
    numbers = body.dimensionless_amplitude(1.25 * G), 2.0 * math.pi / body.p
    swept = response(EXACT.system_of(body), motion, *numbers)
    assert swept.outcome == Outcome.LOST_CONTACT
