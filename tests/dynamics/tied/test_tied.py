"""Tied bodies: an integration that shares no code, reference values, limits, and the
outcomes that a remaining force decides.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracles.tied_body import Device, TiedBody, wall
from scipy.integrate import solve_ivp
from support.bodies import shaking
from support.documents import built
from support.tied_march import marched as march_of

from rocking_cli import (
    Method,
    Outcome,
    Verdict,
    check,
    parse_grid,
    pulse,
    response,
    sine,
    time_history,
)
from rocking_cli.dynamics.drive import drive_change
from rocking_cli.dynamics.method import LINEAR
from rocking_cli.dynamics.tied.bounces import Bounces
from rocking_cli.dynamics.tied.devices import BROKEN
from rocking_cli.motions.polyline import Polyline
from rocking_cli.reports.device_words import devices_in_words
from rocking_cli.responses.history import history

WALL = "kind: wall\nthickness: 0.6 m\nheight: 6 m\none_sided: true\nmass: 7200 kg\n"
TIE = "ties: [{height: 5.5 m, stiffness: 2e6 N/m, prestress: 5 kN%s}]\n"
ELASTIC, YIELDING = TIE % "", TIE % ", yield: 20 kN"
OUTWARDS = sine().scaled(-1.0)
MASS, G, RADIUS, ALPHA = 7200.0, 9.81, math.hypot(0.3, 3.0), math.atan2(0.3, 3.0)
NAMES = {"yield": "force"}  # of a document's key in the integration
EXACT = Method("nonlinear", 1e-12)


def marched(text, motion, a_g, period, method=EXACT, damping=""):
    """(structure, results) of the march of one body; a_g [g]."""
    body = built(text + damping)
    system = method.system_of(body)
    cells = (
        body.dimensionless_amplitude(a_g * G),
        2 * math.pi / period / body.p,
    )
    return body, march_of(system, motion, *(np.array([x]) for x in cells))


@pytest.mark.parametrize(
    ("a_g", "period", "release", "one_sided", "keys"),
    [
        (0.3, 0.8, 0.0, True, {"stiffness": 0.0, "prestress": 1e-9}),
        (0.6, 0.5, 0.0, True, {"yield": 20e3}),
        (0.9, 0.8, 0.0, False, {"yield": 15e3, "behind": 0.4, "ultimate": 0.9}),
        (0.0, 0.8, 0.5, False, {}),
    ],
)
def test_a_history_is_that_of_an_integration_that_shares_no_code(
    a_g, period, release, one_sided, keys
):
    """The first half of the cycle drives the wall outwards."""
    keys = {"height": 5.5, "stiffness": 2e6, "prestress": 5e3} | keys
    text = (
        WALL.replace("true", str(one_sided).lower())
        + f"ties: [{{{', '.join(f'{key}: {x}' for key, x in keys.items())}}}]\n"
    )
    body = built(text)
    devices = [
        Device(side, **{NAMES.get(key, key): x for key, x in keys.items()})
        for side in ((1,) if one_sided else (1, -1))
    ]
    omega, steps = 2.0 * math.pi / period / body.p, []
    motion, end = (
        OUTWARDS.still_until(2.0 * math.pi + 3.0 * omega),
        period + 3.0 / body.p,
    )
    oracle, pulls = wall(devices, body.eta), []

    def seen(side, step):
        steps.append((side, step))
        pulls.append(
            sum(device.tension(step.height(0.5)) for device in oracle.on(side))
        )

    oracle.run(
        shaking(motion, a_g * G, omega * body.p), seen=seen, release=release * ALPHA
    )
    found = history(
        EXACT.system_of(body),
        OUTWARDS,
        body.dimensionless_amplitude(a_g * G),
        omega,
        body.eta,
        duration=end * body.p,
        release=release,
    )
    side, t, u, v = np.array(
        [
            (side, step.t + step.h, step.u_end, step.v_end)
            for side, step in steps
            if step.t < 0.999 * end
        ]
    ).T
    impacts, struck = [e.tau for e in found.events if e.event == "impact"], u < 1e-9
    count = min(len(impacts), 10)  # later bounces are summed
    assert t[struck & (v < -1e-6)][:count] * body.p == pytest.approx(
        impacts[:count], abs=1e-8
    )
    ratio, rate = found.at(t[~struck] * body.p)
    assert ratio * ALPHA == pytest.approx((side * u)[~struck], abs=1e-10)
    assert rate * ALPHA * body.p == pytest.approx((side * v)[~struck], abs=1e-9)
    middle = np.array([step.t + 0.5 * step.h for _, step in steps]) * body.p
    rotation = found.at(middle)[0] * ALPHA
    seen_by_both = (rotation != 0.0) & (
        middle < (impacts[9] if len(impacts) > 9 else end * body.p)
    )
    assert found.device_forces is not None
    (force,) = found.device_forces.columns(middle, rotation).values()
    assert force[seen_by_both] == pytest.approx(
        np.array(pulls)[seen_by_both],
        abs=1e-10 * keys["height"] * keys["stiffness"] + 1e-9,
    )
    for device, told in zip(devices, found.devices, strict=True) if one_sided else ():
        force = min(device.force, device.prestress + device.stiffness * device.farthest)
        assert (told["force"], told["permanent"]) == pytest.approx(
            (force, device.permanent), rel=1e-8, abs=1e-12
        )
        assert told["state"] == ("yielded" if device.permanent else "elastic")


def test_rows_have_the_force_of_each_device_and_at_rest_its_prestress():
    """After a permanent elongation of 0.224 m the tie is slack at rest. The elastic tie
    has its largest force in a row at a peak.
    """
    strong = parse_grid("a_g=1g,T_g=0.8")
    rows = list(
        time_history(built(WALL + YIELDING), OUTWARDS, strong, [EXACT]).rows(dt=0.05)
    )
    assert (rows[0]["tie_1_force"], rows[-1]["theta"], rows[-1]["tie_1_force"]) == (
        5000.0,
        0.0,
        0.0,
    )
    rows = list(
        time_history(built(WALL + ELASTIC), OUTWARDS, strong, [EXACT]).rows(steps=True)
    )
    assert max(row["tie_1_force"] for row in rows) == pytest.approx(50925.712, abs=5e-4)
    assert rows[-1]["tie_1_force"] == 5000.0
    assert "tie_1_force" not in next(
        time_history(built(WALL + ELASTIC), OUTWARDS, strong, [EXACT]).rows(
            dimensionless=True
        )
    )


def test_the_first_yield_is_met_when_the_reference_says():
    found = time_history(
        built(WALL + YIELDING), OUTWARDS, parse_grid("a_g=0.6g,T_g=0.5"), [EXACT]
    )
    events = list(found.events())
    first = next(row for row in events if row["event"] == "yield")
    assert (first["t"], first["device"]) == (
        pytest.approx(0.1252954474, abs=6e-11),
        "tie 1",
    )
    words = [row["event"] for row in events]
    assert words[:7] == [
        "uplift",
        "yield",
        "peak",
        "unloading",
        "slack",
        "impact",
        "peak",
    ]


@pytest.mark.requirement(
    "A tie holds with its prestress and its stiffness",
    "structures/restraints.py",
    "Block held by a tie of constant force",
)
def test_the_prestress_holds_the_wall_at_a_fifth_of_g():
    _, found = marched(WALL + YIELDING, OUTWARDS, 0.2, 0.8)
    assert found.outcome[0] == Outcome.NO_UPLIFT
    body = built(WALL + YIELDING)
    uplift = 0.1 + 5000 * 5.5 / (MASS * G * 3)
    assert EXACT.system_of(body).least_uplift(sine()) == pytest.approx(
        body.dimensionless_amplitude(uplift * G), rel=1e-12
    )
    assert EXACT.system_of(body).least_uplift(OUTWARDS) == pytest.approx(
        body.dimensionless_amplitude(uplift * G), rel=1e-12
    )


def cases():
    """Random ties on a wall under a sine cycle: (document, devices, damping, one-sided,
    a_g, period, sign).
    """
    random = np.random.default_rng(5)
    for _ in range(24):
        one = random.random() < 0.5
        rows, devices = [], []
        for _ in range(random.integers(1, 3)):
            h, stiffness = random.uniform(2, 6), 10 ** random.uniform(4, 6.5)
            prestress = random.choice([0.0, random.uniform(0, 8e3)])
            force = max(prestress, 1e3) + random.uniform(0, 3e4)
            ultimate = (force - prestress) / stiffness + random.uniform(0.005, 0.3)
            keys = {
                "height": h,
                "stiffness": stiffness,
                "prestress": prestress,
                "behind": random.choice([0.0, random.uniform(0, 0.6)]),
            }
            yields, breaks = random.random() < 0.8, random.random() < 0.5
            keys |= ({"yield": force} if yields else {}) | (
                {"ultimate": ultimate} if breaks else {}
            )
            keys["side"] = (
                "right" if one else str(random.choice(["left", "right", "both"]))
            )
            rows.append("{" + ", ".join(f"{key}: {x}" for key, x in keys.items()) + "}")
            for side in {"right": [1], "left": [-1], "both": [1, -1]}[keys["side"]]:
                limits = force if yields else math.inf, ultimate if breaks else math.inf
                devices.append(
                    Device(side, stiffness, prestress, *limits, h, keys["behind"])
                )
        damping = random.choice([0.0, 0.03])
        text = (
            WALL.replace("true", str(one).lower())
            + f"ties: [{', '.join(rows)}]\ndamping: {damping}\n"
        )
        yield (
            text,
            devices,
            damping,
            random.uniform(0.15, 1.2),
            random.uniform(0.3, 1.5),
            random.choice([1.0, -1.0]),
        )


@pytest.mark.parametrize(
    ("text", "devices", "damping", "a_g", "period", "sign"),
    [
        pytest.param(*case, marks=[pytest.mark.soak] * (i > 4))
        for i, case in enumerate(cases())
    ],
)
def test_ties_hold_yield_and_break_as_another_integration_says(
    text, devices, damping, a_g, period, sign
):
    motion = sine().scaled(sign)
    body, found = marched(text, motion, a_g, period, Method("nonlinear", 1e-11))
    end = motion.still_until(2.0 * math.pi * (1.0 + 12.0 / body.p / period))
    largest, fell = wall(devices, body.eta, damping).run(
        shaking(end, a_g * G, 2.0 * math.pi / period)
    )
    assert Outcome(int(found.outcome[0])).overturned == fell
    answer = EXACT.reference_of(body)(
        motion,
        body.dimensionless_amplitude(a_g * G),
        2.0 * math.pi / period / body.p,
    )
    assert answer[0] == found.outcome[0]
    if not fell:
        assert found.theta_ratio[0] == pytest.approx(largest, abs=1e-8)
        assert answer[1] == pytest.approx(largest, abs=1e-8)
        for side, stretched, stiffness in zip(
            (1, -1),
            found.farthest[:, :, 0],
            EXACT.system_of(body).devices.stiffness,
            strict=False,
        ):
            assert stretched[stiffness > 0.0] == pytest.approx(
                [d.farthest for d in devices if d.side == side], abs=1e-8
            )


def test_two_ties_of_a_leaning_wall_yield_again_at_one_instant():
    # Both ties unloaded at one peak, so both yield again where the wall comes back to
    # it.
    ties = [
        {"stiffness": 1.7e5, "height": 5.7, "behind": 0.1},
        {"stiffness": 1.5e4, "height": 3.9, "behind": 0.3},
    ]
    forces = 20.7e3, 16.8e3
    rows = [
        str({**tie, "yield": force, "side": "left"})
        for tie, force in zip(ties, forces, strict=True)
    ]
    t, s = (
        0.36 * np.arange(10),
        np.array([0, -0.9, 0.9, 0.8, 0.5, 0.1, 0.2, -0.6, 0.5, 0]),
    )
    motion = Polyline("lines", t[:-1], t[1:], s[:-1], np.diff(s) / np.diff(t))
    text = WALL.replace("true", "false") + f"ties: [{', '.join(rows)}]\ndamping: 0.03"
    body, found = marched(text, motion, 11.5 / G, math.tau)
    devices = [
        Device(-1, force=force, **tie) for tie, force in zip(ties, forces, strict=True)
    ]
    largest, _ = wall(devices, body.eta, 0.03).run(
        shaking(motion.still_until(4.0), 11.5, 1.0)
    )
    assert (found.outcome[0], found.theta_ratio[0]) == (
        Outcome.LEANING,
        pytest.approx(largest, abs=1e-9),
    )
    assert found.plastic[1, :, 0] == pytest.approx(
        [d.permanent for d in devices], abs=1e-9
    )


def test_a_tie_without_force_is_the_free_body_to_the_bit():
    free, held = (
        built(WALL),
        built(WALL + "ties: [{height: 5, stiffness: 0, yield: 5 kN}]"),
    )
    grid = parse_grid("a_g=0.05g:1g:16,T_g=0.3:2:4")
    for method in (EXACT, LINEAR):
        one, other = (
            response(method.system_of(s), sine(), *np.meshgrid(*grid.scaled(s)), s.eta)
            for s in (free, held)
        )
        np.testing.assert_array_equal(one.theta_ratio, other.theta_ratio)
        np.testing.assert_array_equal(one.outcome, other.outcome)
    assert (
        check(held, sine(), parse_grid("a_g=0.3g,T_g=0.8")).row()
        == check(free, sine(), parse_grid("a_g=0.3g,T_g=0.8")).row()
    )


BLOCK = "kind: block\nwidth: 1\nheight: 5\ngravity: 9.8\nmass: 2551.0204081632653\n"
TENDON = (
    "tendon: {area: 144 mm2, modulus: 195 GPa, length: 5 m, prestress: 150 kN, rupture:"
    " 267.84 kN}\n"
)


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize(
    ("a_g", "period", "stands", "breaks"),
    [(2.0, 0.2, True, False), (2.5, 0.25, True, True), (2.0, 0.5, False, True)],
)
def test_a_block_with_a_tendon_against_another_integration(
    linear, a_g, period, stands, breaks
):
    body, found = marched(
        BLOCK + TENDON,
        sine(),
        a_g * 9.8 / G,
        period,
        LINEAR if linear else Method("nonlinear", 1e-11),
    )
    mass, radius = 25000 / 9.8, math.hypot(0.5, 2.5)
    ultimate = (267840 - 150000) / 5.616e6
    devices = [
        Device(
            side,
            5.616e6,
            150e3,
            ultimate=ultimate,
            height=0.5,
            tendon=True,
            linear=linear,
        )
        for side in (1, -1)
    ]
    oracle = TiedBody(
        mass,
        radius,
        math.atan(0.2),
        4 / 3 * mass * radius**2,
        body.eta,
        devices,
        gravity=9.8,
        linear=linear,
    )
    omega_g = 2 * math.pi / period
    largest, fell = oracle.run(
        shaking(sine().still_until(omega_g * (period + 3 / body.p)), a_g * 9.8, omega_g)
    )
    assert (
        (found.branch == BROKEN).ravel().tolist()
        == [device.broken for device in devices]
        == [breaks, breaks]
    )  # on both sides
    assert Outcome(int(found.outcome[0])).overturned == fell != stands
    at = body.dimensionless_amplitude(a_g * 9.8), omega_g / body.p
    answer = Method("linear" if linear else "nonlinear").reference_of(body)(sine(), *at)
    assert answer == pytest.approx(
        (found.outcome[0], found.theta_ratio[0]), abs=1e-9, nan_ok=True
    )
    if stands:
        assert found.theta_ratio[0] == pytest.approx(largest, abs=1e-7)


def test_the_tendon_of_a_block_breaks_at_its_elongation():
    # By the stated elongation 2 b sin(theta/2), as in the equation of motion; b sin
    # theta would break it at 0.041978.
    text, tendon = BLOCK, TENDON
    found = time_history(
        built(text + tendon), sine(), parse_grid("a_g=19.6,T_g=0.5"), [EXACT]
    ).histories["nonlinear"]
    (breaks,) = (e for e in found.events if e.event == "rupture")
    assert abs(breaks.theta_ratio) * math.atan(0.2) == pytest.approx(
        2 * math.asin((267840 - 150000) / 5.616e6), rel=1e-12
    )
    assert found.devices[0]["state"] == "broken"
    assert found.outcome.overturned
    kept = response(
        LINEAR.system_of(built(text + tendon.replace(", rupture: 267.84 kN", ""))),
        sine(),
        30.0,
        np.linspace(1, 9, 9),
        0.9,
    )
    assert not any(
        Outcome(x).overturned for x in kept.outcome
    )  # nothing overturns it before rupture


@pytest.mark.slow
def test_a_body_that_a_tie_holds_beyond_alpha_leans():
    body, found = marched(WALL + YIELDING, OUTWARDS, 1.6, 0.8)
    assert found.outcome[0] == Outcome.LEANING
    assert found.theta_ratio[0] > 1.0
    demand = parse_grid("a_g=1.6g,T_g=0.8")
    verdict = check(body, OUTWARDS, demand, a_max=None)
    assert (verdict.outcome.flag, verdict.falls, verdict.row()["tie_state"]) == (
        "leaning",
        True,
        "yielded",
    )
    method = Method("nonlinear", 1e-9)
    late = time_history(body, OUTWARDS, demand, [method], duration=12.0).histories[
        "nonlinear"
    ]
    assert late.outcome == Outcome.LEANING
    ratio, _ = late.at(np.linspace(8.0, 11.0, 300) * body.p)
    assert (
        ratio.min() > 0.5
    )  # it goes to and fro about an equilibrium that is not upright
    assert ratio.max() <= late.theta_ratio * (1 + 1e-12)
    damped = time_history(
        built(WALL + YIELDING + "damping: 0.3\n"),
        OUTWARDS,
        demand,
        [method],
        duration=30.0,
    ).histories["nonlinear"]
    theta = ALPHA * damped.at(np.array([29.0]) * body.p)[0][0]
    left = damped.devices[0]["permanent"]
    force = 5e3 + 2e6 * (5.5 * math.sin(theta) - left)
    weight = MASS * G * RADIUS * math.sin(ALPHA - theta)
    assert force * 5.5 * math.cos(theta) == pytest.approx(
        -weight, rel=1e-4
    )  # the equilibrium of the remaining force
    _, torn = marched(
        WALL + TIE % ", yield: 20 kN, ultimate: 80 cm", OUTWARDS, 1.6, 0.8
    )
    assert Outcome(int(torn.outcome[0])).overturned


def test_a_body_that_a_tie_presses_to_the_ground_comes_to_rest_at_once():
    # The drive would lift the wall to the right without the tie on this side.
    system = EXACT.system_of(
        built(WALL.replace("true", "false") + TIE % ", yield: 20 kN, side: right")
    ).with_restitution(0.9)
    cells = np.array([1.0886, 1.0770]), np.array([9.9814, 10.7059])
    found = march_of(system, sine(), *cells)
    assert found.steps.max() < 150


def test_bouncing_that_is_summed_ends_as_it_does_impact_by_impact(monkeypatch):
    # Lemma 7 of a body that its tendon holds to seven times m g R sin(alpha); eta 0.6,
    # so that each bounce can be followed.
    body = built(BLOCK + TENDON)
    system = Method("nonlinear").system_of(body)
    cells = (
        system.least_uplift(sine()) * np.array([1.02]),
        np.array([3.0]),
    )
    summed = response(system, sine(), *cells, 0.6)
    monkeypatch.setattr(
        Bounces, "end", lambda self, lanes: np.zeros(lanes.cell.size, dtype=bool)
    )
    marched = response(system, sine(), *cells, 0.6)
    assert marched.work.steps > 5 * summed.work.steps
    np.testing.assert_array_equal(marched.outcome, summed.outcome)
    np.testing.assert_allclose(marched.theta_ratio, summed.theta_ratio, rtol=1e-10)


@pytest.mark.parametrize("name", ["ricker-symmetric", "mavroeidis-papageorgiou"])
def test_bouncing_after_a_sum_of_sinusoids_is_summed(name):
    still = pulse(name).segments.followed_by_rest(math.inf)
    assert drive_change(still, np.array([len(still) - 1]), np.array([1e3])) == [0.0]
    body = built(
        WALL + "damping: 0.05\nties: [{height: 5.5 m, stiffness: 2e5 N/m, prestress: 5"
        " kN}]\n"
    )
    found = time_history(
        body, pulse(name), parse_grid("a_g=1g,f_g=1"), [EXACT], duration=60.0
    ).histories["nonlinear"]
    assert (found.events[-1].event, len(found.events) < 60) == ("rest", True)


def test_bouncing_that_makes_the_tie_of_the_other_side_yield_is_not_summed(monkeypatch):
    # The tie yields from 0.1 mm on. Bounces to the left reach that, below the peak of
    # the body: each of them stretches it further.
    body = built(
        WALL.replace("true", "false")
        + "ties: [{height: 5.5 m, stiffness: 2e6 N/m, yield: 200 N, side: left}]\n"
    )
    system = Method("nonlinear", 1e-11).system_of(body).with_restitution(0.7)
    cells = (
        system.least_uplift(sine()) * np.array([1.29, 1.42]),
        np.array([6.3, 9.1]),
    )
    summed = march_of(system, sine(), *cells)
    monkeypatch.setattr(
        Bounces, "end", lambda self, lanes: np.zeros(lanes.cell.size, dtype=bool)
    )
    marched = march_of(system, sine(), *cells)
    assert (summed.plastic[1] > 0.0).all()
    np.testing.assert_allclose(summed.plastic, marched.plastic, rtol=1e-9)
    np.testing.assert_allclose(summed.theta_ratio, marched.theta_ratio, rtol=1e-9)


AT_REST = {"tie_force": None, "tie_elongation": 0.0, "force": 0.0, "state": "elastic"}


@pytest.mark.parametrize(
    ("names", "first", "words"),
    [
        (["tie 1"], 3.0, "its ties add 50 % of the capacity without them"),
        (["tendon"], 3.0, "its tendon adds 50 % of the capacity without it"),
        (
            ["tie 1", "tendon"],
            1.0,
            "its ties and tendon take 50 % of the capacity without them",
        ),
    ],
)
def test_the_change_of_the_capacity_names_its_restraints(names, first, words):
    verdict = Verdict(
        *("W", "m", "linear", Outcome.ROCKED, 0.5, 1.0, 0.5, first, None),
        Outcome.ROCKED,
        devices=tuple({"device": name, **AT_REST} for name in names),
        first_overturning_a_free=2.0,
    )
    assert devices_in_words(verdict)[-1] == words


@pytest.mark.parametrize(
    ("a_g", "tie", "a_max", "told"),
    [
        (0.3, YIELDING, 20.0, True),  # elastic: it yields at the capacity of 1.34 g
        (1.0, YIELDING, None, True),
        (1.0, TIE % ", yield: 20 kN, ultimate: 50 cm", None, False),
        (1.0, ELASTIC, None, False),
    ],
)
def test_check_says_that_a_yielding_tie_never_breaks(a_g, tie, a_max, told):
    """As its capacity may count on any elongation."""
    demand = parse_grid(f"a_g={a_g}g,T_g=0.8")
    verdict = check(built(WALL + tie), OUTWARDS, demand, a_max=a_max)
    said = devices_in_words(verdict)
    assert any("tie 1 never breaks in this model" in line for line in said) is told


def lost_at(body_height, height, mass, stiffness, alpha, a_g, f_g):
    """(t [s], u) at which the ground is lost below a block with one tie at its top of
    this height, by an integration of its first arc that shares no code.
    """
    omega, radius = 2.0 * math.pi * f_g, 0.5 * body_height / math.cos(alpha)

    def acceleration(t, u):
        # stretch of the tie, h sin u, on the lever h cos u
        pull = stiffness * height**2 * np.sin(u) * np.cos(u) / (mass * G * radius)
        push = a_g * np.sin(omega * t) * np.cos(alpha - u)
        return 0.75 * G / radius * (push - np.sin(alpha - u) - pull)

    def ground(t, state):
        z = alpha - state[0]
        lifted = acceleration(t, state[0]) * np.sin(z) - state[1] ** 2 * np.cos(z)
        return G + radius * lifted

    ground.terminal = True
    found = solve_ivp(
        lambda t, s: (s[1], acceleration(t, s[0])),
        (math.asin(math.tan(alpha) / a_g) / omega, 1.0),
        (0.0, 0.0),
        "DOP853",
        events=ground,
        rtol=1e-12,
        atol=1e-14,
    )
    return found.t_events[0][0], found.y_events[0][0][0]


def test_the_ground_is_lost_where_another_integration_says():
    """The event stands where the vertical force of the ground on this square block
    vanishes.
    """
    tie = "ties: [{height: 1.8, stiffness: 2e5, side: both}]"
    body = built(f"kind: block\nwidth: 2\nheight: 2\nmass: 8000\n{tie}\n")
    grid = parse_grid("a_g=3g,f_g=1.5")
    events = time_history(body, sine(), grid, [EXACT]).histories["nonlinear"].events
    (event,) = (e for e in events if e.event == "lost contact")
    at, turned = lost_at(2.0, 1.8, 8000.0, 2e5, math.pi / 4, 3.0, 1.5)
    assert event.tau / body.p == pytest.approx(at, abs=1e-11)
    assert -event.theta_ratio * math.pi / 4 == pytest.approx(turned, abs=1e-11)
    swept = response(
        EXACT.system_of(body),
        sine(),
        body.dimensionless_amplitude(np.array([1.4, 3.0]) * G),
        3.0 * math.pi / body.p,
        body.eta,
    )
    assert swept.outcome.tolist() == [Outcome.ROCKED, Outcome.LOST_CONTACT]
    assert np.isnan(swept.theta_ratio).tolist() == [False, True]


def test_the_ground_is_lost_in_a_fall_where_another_integration_says():
    """A tall wall under a weak tie overturns within half a cycle; the vertical force of
    the ground vanishes on its way. `check` says so.
    """
    tie = "ties: [{height: 6, stiffness: 2e3, side: both}]"
    body = built(f"kind: block\nwidth: 0.6\nheight: 6\nmass: 7200\n{tie}\n")
    demand = "a_g=4g,f_g=1"
    history = time_history(body, sine(), demand, [EXACT]).histories["nonlinear"]
    assert history.outcome == Outcome.OVERTURNED_NO_IMPACT
    assert check(body, sine(), demand, a_max=None).lost_in_fall
    at, _ = lost_at(6.0, 6.0, 7200.0, 2e3, math.atan(0.1), 4.0, 1.0)
    assert history.lost / body.p == pytest.approx(at, abs=1e-9)
