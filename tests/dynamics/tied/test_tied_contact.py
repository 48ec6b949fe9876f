"""Tied bodies that lose the ground: a sweep, a history and an integration that shares
no code find the same ones.
"""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from oracles.tied_body import Device, TiedBody
from support.bodies import shaking
from support.documents import built

from rocking_cli import (
    Method,
    Motion,
    Outcome,
    history,
    parse_grid,
    pulse,
    response,
    sine,
    time_history,
)

GRAVITY, METHOD = 9.81, Method("nonlinear")
Drawn = tuple[str, Motion, float, float]  # document, motion, a_g [m/s2], period [s]


def stocky(
    count: int, seed: int = 11
) -> Iterator[tuple[float, float, float, float, str, float, float, float]]:
    """(width, height, mass, stiffness, side, sign of the motion, a_g, period) of blocks
    with one tie at their top.
    """
    random = np.random.default_rng(seed)
    for _ in range(count):
        height = random.uniform(1, 4)
        width = height * random.uniform(0.3, 0.95)
        stiffness, mass = 10 ** random.uniform(6, 7), 10 ** random.uniform(2.5, 4)
        side, sign = (
            str(random.choice(["right", "left", "both"])),
            float(random.choice([1.0, -1.0])),
        )
        yield (
            width,
            height,
            mass,
            stiffness,
            side,
            sign,
            width / height * GRAVITY * random.uniform(1.02, 3.0),
            random.uniform(0.2, 1.0),
        )


def document_of(
    width: float, height: float, mass: float, stiffness: float, side: str
) -> str:
    tie = f"{{height: {height}, stiffness: {stiffness}, side: {side}}}"
    return (
        f"kind: block\nwidth: {width}\nheight: {height}\nmass: {mass}\nties: [{tie}]\n"
    )


def agree(text: str, motion: Motion, a_g: float, period: float) -> Outcome:
    """The outcome that a sweep and a history share, and their rotation to 1e-9."""
    body = built(text)
    system = METHOD.system_of(body)
    amplitude, omega = (
        float(body.dimensionless_amplitude(a_g)),
        2.0 * math.pi / period / body.p,
    )
    swept = response(system, motion, amplitude, omega, body.eta)
    followed = history(
        system,
        motion,
        amplitude,
        omega,
        body.eta,
        duration=motion.duration / omega + 30.0,
    )
    assert followed.outcome == swept.outcome, text
    if followed.theta_ratio is not None and np.isfinite(swept.theta_ratio):
        assert followed.theta_ratio == pytest.approx(float(swept.theta_ratio), abs=1e-9)
    outcome, events = Outcome(int(swept.outcome)), [e.event for e in followed.events]
    ends = [e for e in events if e in ("lost contact", "overturning")]
    lost = outcome == Outcome.LOST_CONTACT
    assert ends == ["lost contact"] * lost + ["overturning"] * outcome.overturned, text
    if outcome.overturned:
        after_impact = outcome == Outcome.OVERTURNED_AFTER_IMPACT
        assert ("impact" in events) == after_impact, text
    return outcome


def lowest_fz(
    width: float,
    height: float,
    mass: float,
    stiffness: float,
    side: str,
    sign: float,
    a_g: float,
    period: float,
) -> float:
    """The least Fz/(m g) of an integration that shares no code."""
    body = built(document_of(width, height, mass, stiffness, side))
    radius, alpha = 0.5 * math.hypot(width, height), math.atan2(width, height)
    devices = [
        Device(s, stiffness, height=height)
        for s, name in ((1, "right"), (-1, "left"))
        if side in (name, "both")
    ]
    solved = TiedBody(
        mass, radius, alpha, 4.0 / 3.0 * mass * radius**2, body.eta, devices
    )
    omega = 2.0 * math.pi / period
    motion = sine().scaled(sign).still_until(2.0 * math.pi + 20.0 * omega / body.p)
    return solved.lowest_fz(shaking(motion, a_g, omega))


REPORTED = 1.3, 2.0, 500.0, 2e6, "right", -1.0, 1.06 * GRAVITY, 0.5


@pytest.mark.parametrize(
    "at", [None, 9, *(pytest.param(at, marks=pytest.mark.soak) for at in (1, 40))]
)
def test_bounces_that_lose_the_ground_are_followed(at):
    """One step would take these bodies from an impact to rest, although the tie throws
    them off the ground on the way.
    """
    drawn = REPORTED if at is None else list(stocky(at + 1))[at]
    text, (sign, a_g, period) = document_of(*drawn[:5]), drawn[5:]
    assert agree(text, sine().scaled(sign), a_g, period) == Outcome.LOST_CONTACT
    assert lowest_fz(*drawn) < 0.0


@pytest.mark.parametrize(
    ("a_g", "expected"),
    [
        (
            25.0,
            [
                ("uplift", 0.051083),
                ("rupture", 0.299281),
                ("peak", 0.420681),  # Fz = 0 at 0.494455 s
                ("impact", 0.575045),
                ("overturning", 1.625884),
            ],
        ),
        (
            60.0,  # Fz = 0 at 0.223577 s
            [("uplift", 0.020601), ("rupture", 0.165734), ("overturning", 0.455289)],
        ),
    ],
)
def test_the_events_of_a_body_that_overturns_go_on_to_its_fall(a_g, expected):
    """It has Fz <= 0 on its way, and overturns whatever its Fz. Times by an independent
    program, 2026: scipy's DOP853 with rtol = 1e-12.
    """
    text = (
        "kind: block\nwidth: 1.3\nheight: 2\nmass: 500\n"
        "tendon: {stiffness: 1e5, prestress: 4e3, rupture: 12e3}\n"
    )
    shaken = parse_grid(f"a_g={a_g},f_g=1.5")
    found = time_history(built(text), sine(), shaken, [METHOD])
    events = [(row["event"], row["t"]) for row in found.events()]
    assert [event for event, _ in events] == [event for event, _ in expected]
    times = [t for _, t in expected]
    assert [t for _, t in events] == pytest.approx(times, abs=1e-6)


@pytest.mark.parametrize("a_g", [12.8, 14.0, 15.4, 16.9, 18.561062364723465, 20.4])
def test_a_constant_push_leads_back_to_a_touch_without_an_impact(a_g):
    """The energy says that the speed is 0 on the ground, and how far the body turns:
    m g R [cos(alpha - u) - cos alpha] + P0 e + K e^2/2 = m a_g R [sin alpha -
    sin(alpha - u)], e = h sin u.
    """
    body = built(
        "kind: block\nwidth: 1.3\nheight: 2\nmass: 500\n"
        "ties: [{height: 2, stiffness: 2e5, prestress: 1e3, side: both}]\n"
    )
    shaken = parse_grid(f"a_g={a_g},f_g=1.5")
    found = time_history(body, pulse("rectangular-impulse"), shaken, [METHOD])
    pushed = [row for row in found.events() if row["t"] < 1.0 / 1.5 - 1e-9]
    peaks = np.array([abs(row["theta"]) for row in pushed if row["event"] == "peak"])
    assert {row["event"] for row in pushed} <= {"uplift", "peak"}
    assert peaks.size >= 2

    alpha, radius, e = body.alpha, body.arm, 2.0 * np.sin(peaks)
    raised = 500 * GRAVITY * radius * (np.cos(alpha - peaks) - np.cos(alpha))
    pulled = 1e3 * e + 1e5 * e**2
    given = 500 * a_g * radius * (np.sin(alpha) - np.sin(alpha - peaks))
    np.testing.assert_allclose((raised + pulled) / given, 1.0, rtol=1e-9)


@pytest.mark.slow
def test_a_body_that_keeps_the_ground_by_little_rocks():
    """Near the amplitude from which the reported body loses the ground."""
    body = built(document_of(*REPORTED[:5]))
    system, omega = METHOD.system_of(body), 2.0 * math.pi / REPORTED[-1] / body.p
    least = 9.0010104  # from there on it loses the ground
    for a_g, lost in ((least * (1.0 - 1e-4), False), (least * (1.0 + 1e-4), True)):
        amplitude = body.dimensionless_amplitude(a_g)
        found = response(system, sine().scaled(-1.0), amplitude, omega, body.eta)
        assert (found.outcome == Outcome.LOST_CONTACT) == lost
        assert (found.outcome == Outcome.ROCKED) != lost
        assert (lowest_fz(*REPORTED[:6], a_g, REPORTED[-1]) < 0.0) == lost


@pytest.mark.soak
def test_random_stocky_blocks_have_one_outcome():
    found = [
        agree(document_of(*drawn[:5]), sine().scaled(drawn[5]), *drawn[6:])
        for drawn in stocky(800)
    ]
    assert (
        min(found.count(outcome) for outcome in (Outcome.LOST_CONTACT, Outcome.ROCKED))
        > 200
    )
