"""Sliding: closed forms, values of an independent program, stepping without events, and
a block on two corners that knows neither sliding nor rocking.
"""

import math

import numpy as np
import pytest
from oracles.sliding import BlockOnCorners, G, moreau
from scipy.integrate import trapezoid
from scipy.optimize import brentq

from rocking_cli import load_records, load_structures
from rocking_cli.dynamics.outcome import Outcome
from rocking_cli.dynamics.sliding import Base
from rocking_cli.motions import pulse
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.motion import Motion
from rocking_cli.structures.friction import Friction, friction_that_slides

SYNTHETIC = "configs/motions/synthetic.at2"


def slid(motion, a, omega, static, kinetic=None):
    """(max |u|, u at the end, number of slides, start of the first [s])."""
    friction = Friction(static, static if kinetic is None else kinetic)
    found = Base(motion, friction).under(G / a)
    unit = a / omega**2
    first = found.slides[0].start / omega if found.slides else math.inf
    return found.largest * unit, found.residual * unit, len(found.slides), first


def record(factor=1.0):
    """The record, with this part of it upwards."""
    (one,) = load_records(SYNTHETIC)
    if factor == 1.0:
        return one.motion
    return with_vertical(one.motion, one.motion, factor)


@pytest.mark.requirement(
    "A body whose friction is below lambda slides by Newmark's displacement",
    "dynamics/sliding.py",
    "Block that slides under a constant push",
)
@pytest.mark.parametrize(("a", "duration", "mu"), [(0.4, 0.5, 0.2), (0.6, 0.25, 0.3)])
def test_a_rectangular_pulse_has_newmarks_displacement(a, duration, mu):
    speed = a * G * duration
    wanted = speed**2 / (2.0 * mu * G) * (1.0 - mu / a)
    most, end, _, _ = slid(pulse("rectangular"), a * G, math.tau / duration, mu)
    assert (most, end) == pytest.approx((wanted, -wanted), rel=1e-12)


@pytest.mark.parametrize("r", [0.05, 0.25, 0.5, 0.72, 0.73, 0.85, 0.99])
def test_a_half_sine_has_its_closed_form(r):
    c, start = math.sqrt(1.0 - r * r), math.asin(r)
    if r < 0.724611:  # it stops after the pulse
        wanted = (1.0 + c) * (3.0 - c) / (2.0 * r) - (math.pi - start)
    else:
        stop = brentq(
            lambda x: math.cos(start) - math.cos(x) - r * (x - start),
            math.pi - start,
            math.pi,
        )
        wanted = (stop - start) * c - math.sin(stop) + r - 0.5 * r * (stop - start) ** 2
    a = 0.4 * G
    most, end, count, _ = slid(pulse("half-sine"), a, 2.0, 0.4 * r)
    assert (most, end) == pytest.approx((wanted * a / 4.0, -wanted * a / 4.0), rel=1e-9)
    assert count == 1


# from an independent program, 2026, with eight digits: max |u| and u at the end [m]
SINES = [
    (0.1, 0.30719186, -0.12813799),
    (0.2, 0.12581174, 0.0062984558),
    (0.25, 0.0684298, 0.00065430104),
    (0.3, 0.029501431, 0.0),
]


@pytest.mark.parametrize(("mu", "most", "end"), SINES)
def test_a_full_sine_agrees_with_an_independent_program(mu, most, end):
    found = slid(pulse("sine"), 0.4 * G, math.tau, mu)
    assert found[:2] == pytest.approx((most, end), rel=5e-8, abs=1e-14)


# from an independent program, 2026: upwards, friction, max |u|, u at the end [m], the
# number of slides, start of the first [s]
RECORDS = [
    (None, (0.1,), 0.13519129, -0.071937407, 17, 2.6619355),
    (None, (0.2,), 0.077609136, -0.024262239, 10, 4.3022393),
    (0.5, (0.1,), 0.17629243, 0.065429695, 17, 2.6516335),
    (0.5, (0.2,), 0.081199683, 0.081199683, 8, 4.3245225),
    (None, (0.25, 0.2), 0.070196096, -0.021947211, 4, 5.3081445),
]


@pytest.mark.parametrize(("up", "mu", "most", "end", "count", "first"), RECORDS)
def test_a_record_agrees_with_an_independent_program(up, mu, most, end, count, first):
    motion = record(1.0 if up is None else up)
    found = slid(motion, record().acceleration, 1.0, *mu)
    assert found == pytest.approx((most, end, count, first), rel=5e-8)


@pytest.mark.parametrize(("up", "mu"), [(1.0, 0.05), (-0.7, 0.2)])
def test_a_record_agrees_with_stepping_without_events(up, mu):
    motion, a = record(up), record().acceleration
    vertical = motion.vertical

    def ground(t):
        return a * float(values(t)), 0.0 if vertical is None else a * float(ups(t))

    marks = record().marks
    lines = a * record().value(marks)

    def values(t):
        return np.interp(t, marks, lines) / a

    def ups(t):
        return up * values(t)

    found = moreau(ground, mu, motion.duration + 4.0, 40_000)
    most, end, _, _ = slid(motion, a, 1.0, mu)
    assert (np.abs(found).max(), found[-1]) == pytest.approx((most, end), abs=2e-4)


@pytest.mark.parametrize(
    "name", ["sine", "ricker-symmetric", "mavroeidis-papageorgiou"]
)
def test_pulses_with_static_and_kinetic_friction_agree_with_stepping(name):
    motion, a = pulse(name), 0.5 * G
    static, kinetic = 0.2, 0.15
    most, end, count, _ = slid(motion, a, 1.0, static, kinetic)
    found = Base(motion, Friction(static, kinetic)).under(G / a)
    for one in found.slides:  # the equation of motion, by quadrature
        times = np.linspace(one.start, one.stop, 20_001)
        push = -motion.value(times) - one.side * kinetic * G / a
        speed = np.concatenate([[0.0], np.cumsum(push[:-1] + push[1:])])
        speed *= 0.5 * (times[1] - times[0])
        assert np.all(one.side * speed[1:-1] > -1e-6)
        assert abs(speed[-1]) < 1e-6
        path = trapezoid(speed, times)
        assert path == pytest.approx(one.ends - one.begins, abs=1e-5)
        assert np.abs(speed).max() == pytest.approx(found.speed_of(one), rel=1e-5)
    still = [(0.0, found.slides[0].start)]
    still += [
        (a.stop, b.start) for a, b in zip(found.slides, found.slides[1:], strict=False)
    ]
    for low, high in still:  # it sticks between its slides
        inside = np.abs(motion.value(np.linspace(low, high, 2001)[1:-1]))
        assert np.all(inside <= static * G / a * (1.0 + 1e-9)) or high - low < 1e-12
    assert count
    assert most >= abs(end)


def test_the_course_of_a_slide_ends_where_the_slides_do():
    motion, a = record(0.5), record().acceleration
    found = Base(motion, Friction(0.2, 0.18)).under(G / a)
    stops = np.array([one.stop for one in found.slides])
    u, v = found.course(stops)
    assert u == pytest.approx([one.ends for one in found.slides], abs=1e-13)
    assert v == pytest.approx(0.0, abs=1e-13)
    times = np.linspace(0.0, motion.duration, 40_001)
    u, v = found.course(times)
    assert np.gradient(u, times) == pytest.approx(v, abs=2e-3 * np.abs(v).max())
    assert np.abs(v).max() == pytest.approx(found.speed, rel=1e-3)


@pytest.mark.parametrize(("mu", "up"), [(0.2, 0.0), (0.24, 0.5)])
def test_a_block_on_two_corners_slides_alike_and_does_not_rock(mu, up):
    """The block has springs of 4e7 N/m a kg under its corners: it sinks by 0.12 um."""
    a, duration = 0.6 * G, 1.0

    def ground(t):
        s = a * math.sin(math.tau * t) if t < duration else 0.0
        return s, up * s

    theta, u = BlockOnCorners(0.5, 2.0, mu).run(ground, 1.8, 1.5e-5)
    motion = pulse("sine")
    motion = with_vertical(motion, motion, up) if up else motion
    _, end, _, _ = slid(motion, a, math.tau, mu)
    assert theta / math.atan(0.25) < 5e-4  # it leans on its springs
    assert u == pytest.approx(end, abs=1e-3)


def test_contact_is_lost_at_the_first_weightless_instant():
    motion = with_vertical(pulse("sine"), pulse("sine"), 1.0)
    found = Base(motion, Friction(0.1, 0.1)).under(1.0 / 2.0)
    assert found.lost == pytest.approx(math.pi + math.asin(0.5), rel=1e-12)
    assert found.outcome == Outcome.LOST_CONTACT
    assert found.slides[-1].stop <= found.lost
    assert found.least_weight == pytest.approx(-1.0)


def test_scale_and_mirror_image():
    motion, a = record(0.5), record().acceleration
    most, end, count, _ = slid(motion, a, 1.0, 0.15)
    mirrored = slid(motion.scaled(-1.0), a, 1.0, 0.15)
    assert mirrored[:3] == pytest.approx((most, -end, count), rel=1e-12)


def test_random_motions_keep_their_equation():
    """A slide begins beyond mu_s, and between its ends the body moves one way."""
    rng = np.random.default_rng(7)
    for _ in range(20):
        points = rng.normal(size=60) * np.hanning(60)
        points[[0, -1]] = 0.0
        motion = _joined(points)
        static = float(rng.uniform(0.1, 1.0))
        kinetic = static * float(rng.uniform(0.7, 1.0))
        found = Base(motion, Friction(static, kinetic)).under(1.0)
        stops = 0.0
        for one in found.slides:
            assert one.start >= stops
            assert one.stop > one.start
            force = abs(float(motion.value(one.start + 1e-12)))
            assert force >= static * (1.0 - 1e-6)
            stops = one.stop
            u, v = found.course(np.linspace(one.start, one.stop, 201)[1:-1])
            assert np.all(one.side * v > 0.0)
            assert np.all(one.side * np.diff(u) > 0.0)


def _joined(points: np.ndarray) -> Motion:
    from rocking_cli.motions.polyline import Polyline

    t = np.arange(points.size, dtype=float)
    return Polyline("points", t[:-1], t[1:], points[:-1], np.diff(points))


@pytest.mark.parametrize(
    ("text", "slides"),
    [
        ("block:0.5x2,friction=0.2", True),
        ("block:0.5x2,friction=0.25", False),
        ("block:0.5x2", False),
        ("block:0.5x2,friction=0.2,one_sided=true", False),
        ("rigid:left=0.2,right=0.3,height=1,gyration=0.6,friction=0.19", True),
        ("rigid:left=0.2,right=0.3,height=1,gyration=0.6,friction=0.25", False),
        ("spire:1.5x12,thickness=0.15,crack=diagonal,friction=0.01", False),
        ("frame:width=0.5,height=2,columns=3,cap_ratio=1,friction=0.01", False),
        ("block:0.5x2,friction=0.24,inset=20mm", False),
    ],
)
def test_the_bodies_that_slide(text, slides):
    (structure,) = load_structures(text)
    assert (friction_that_slides(structure) is not None) == slides


def test_a_stack_slides_below_the_least_lambda_of_its_interfaces():
    text = (
        "stack:friction={},pieces=[{{width: 1, height: 1}}, {{width: 0.4, height: 2}}]"
    )
    for friction, slides in ((0.19, True), (0.21, False)):
        found = load_structures(text.format(friction))
        assert [friction_that_slides(one) is not None for one in found] == [slides] * 2
