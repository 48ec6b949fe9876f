"""Pulses by name: their shape, their closed forms, and cells under them against an
independent integration.
"""

import math
import re

import numpy as np
import pytest
from oracles.collocation import Body, Edge, Shaking, integrate
from support.documents import TWO_PULSES, built_motion
from support.packages import installed
from support.references import reference
from support.refusals import refuses

from rocking_cli import (
    MotionError,
    Outcome,
    UsageError,
    dimensionless_oscillator,
    linear_response,
    nonlinear_response,
    trace_envelope,
)
from rocking_cli.motions import PULSES, pulse
from rocking_cli.motions.pulses import GROUP


def symmetric(phase):
    """A Ricker wavelet by its formula, shifted so that it begins at phase 0."""
    x = phase / math.sqrt(2) - 8.5
    return (1 - x * x) * np.exp(-x * x / 2)


def antisymmetric(phase):
    """The same; the largest |x (x^2 - 3)| exp(-x^2/2), at x^2 = 3 - sqrt 6, is 1.38 in
    the literature.
    """
    x = phase / math.sqrt(3) - 8.5
    return x * (x * x - 3) * np.exp(-x * x / 2) / 1.380119046161


# of a pulse: its formula over the phase, and how far the motion may be from it [-]
SHAPES = {
    "ricker-symmetric": (symmetric, 5e-14),
    "ricker-antisymmetric": (antisymmetric, 1e-11),
}


@pytest.mark.parametrize("name", list(PULSES))
def test_amplitude_of_every_pulse_is_one(name):
    motion = pulse(name)
    fine = np.linspace(0.0, motion.duration, 40_001)[:-1]
    assert motion.largest == pytest.approx(1.0, abs=1e-13)
    assert np.abs(motion.value(fine)).max() == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize(
    ("gamma", "phase"), [(1.0, 0.3), (1.5, 0.0), (2.0, math.pi / 2), (3.7, 4.0)]
)
def test_mavroeidis_papageorgiou_is_the_derivative_of_its_velocity(gamma, phase):
    motion = pulse("mavroeidis-papageorgiou", gamma=gamma, phase=phase)

    def velocity(phi):
        turned = phi - math.pi * gamma
        return 0.5 * (1 + np.cos(turned / gamma)) * np.cos(turned + phase)

    phi, h = np.linspace(0.1, motion.duration - 0.1, 500), 1e-3
    slope = (
        8 * (velocity(phi + h) - velocity(phi - h))
        - (velocity(phi + 2 * h) - velocity(phi - 2 * h))
    ) / (12 * h)
    assert motion.duration == pytest.approx(2 * math.pi * gamma)
    scale = motion.value(phi) @ slope / (slope @ slope)
    assert np.abs(motion.value(phi) - scale * slope).max() < 1e-11


def test_rectangular_pulse_overturns_where_its_closed_form_says():
    lasting = np.array(
        [0.5, 1.0, 2.0]
    )  # p t_d, for which A = 1/(1 - exp(-p t_d)) = 2.54149, 1.58198, 1.15652
    traced = trace_envelope(
        dimensionless_oscillator(eta=0.5),
        pulse("rectangular"),
        2 * math.pi / lasting,
        a_max=5,
    )
    found = [i.a_from for i in traced if i.mode == "no_impact"]
    assert found == pytest.approx(
        (1 / (1 - np.exp(-lasting))).tolist(), rel=1e-12, abs=0
    )


@pytest.mark.parametrize("name", list(SHAPES))
def test_a_pulse_and_cells_under_it_against_its_formula(name):
    (shape, tolerance), motion, random = (
        SHAPES[name],
        pulse(name),
        np.random.default_rng(3),
    )
    phase = np.linspace(0.0, motion.duration, 5001)[:-1]
    assert np.abs(motion.value(phase) - shape(phase)).max() < tolerance
    ends = [piece.stop for piece in motion.pieces]
    for _ in range(6):
        amplitude, omega, eta = (
            random.uniform(1.1, 6),
            random.uniform(0.7, 6),
            random.uniform(0.5, 1),
        )
        edge = Edge(1.0, 0.1, eta)
        flag, theta, _ = integrate(
            Body(edge, edge),
            Shaking.of(shape, amplitude * 0.1 * 9.81, omega, ends),
        )
        found = linear_response(motion, amplitude, omega, eta)
        assert Outcome(int(found.outcome)).flag == flag
        assert math.isnan(theta) or abs(float(found.theta_ratio) - theta) < 1e-8


@pytest.mark.parametrize(
    "motion",
    [pulse(n) for n in PULSES if "ricker" not in n]
    + [
        built_motion(TWO_PULSES),
        built_motion("points: [[0, 0], [0.25, 1], [0.75, -1.2], [1, 0.1]]"),
    ],
    ids=lambda m: m.name,
)
def test_both_models_agree_with_their_references_under_every_motion(motion):
    random = np.random.default_rng(11)
    for i in range(6):
        cell = random.uniform(1.1, 6), random.uniform(0.7, 8), random.uniform(0.4, 1)
        linear, alpha = i < 4, None if i < 4 else 0.3
        found = (
            linear_response(motion, *cell)
            if linear
            else nonlinear_response(motion, *cell, alpha, tolerance=1e-10)
        )
        expected = pytest.approx(
            float(found.theta_ratio), abs=1e-10 if linear else 1e-9, nan_ok=True
        )
        assert reference(motion, *cell, alpha) == (int(found.outcome), expected)


REFUSED = [
    (("mavroeidis-papageorgiou", {"gamma": 0.9}), "gamma is 0.9; expected"),
    (("mavroeidis-papageorgiou", {"gamma": math.nan}), "expected a number from 1"),
    (("mavroeidis-papageorgiou", {"phase": math.inf}), "phase"),
    (("half-sine", {"cycles": 2}), "takes no cycles"),
    (("sine", {"gamma": 2}), "takes no gamma; expected cycles"),
    (("ricker", {}), "unknown pulse 'ricker'; expected sine"),
]
test_faulty_pulses_are_refused = refuses(
    lambda given: pulse(given[0], **given[1]), UsageError, REFUSED
)
STEP = """
pieces:
  - {from: 0, to: 1, constant: -1}
  - {from: 1, to: 1.9, constant: 0.2}
  - {from: 1.9, to: 13.9, constant: -0.633333, slope: 0.111667}
"""


@pytest.mark.parametrize(
    ("motion", "cell", "theta"),
    [
        # A valley of the drive entered inwards, in which the body turns outwards and
        # then crests; by a Runge-Kutta program.
        (built_motion(STEP), (1.5, 2 * math.pi, 0.0), 0.75639),
        (
            pulse("mavroeidis-papageorgiou", gamma=3, phase=0.06),
            (1.5788, 2.698, 0.9),
            0.882476,
        ),
        (
            pulse("mavroeidis-papageorgiou", gamma=3, phase=0.0610721),
            (1.5788487654715873, 2.6981940340400308, 0.9),
            0.881604,
        ),
        (
            pulse("mavroeidis-papageorgiou", gamma=3, phase=6.21634),
            (1.5133430666785952, 2.5930464639444697, 0.9),
            0.902486,
        ),
    ],
)
def test_a_crest_after_an_inward_start_is_seen(motion, cell, theta):
    assert float(linear_response(motion, *cell).theta_ratio) == pytest.approx(
        theta, abs=1e-5
    )


RAMP = """
from rocking_cli.motions import Motion, Piece

def ramp(cycles=1.0):
    return Motion("ramp", (Piece(0.0, 2.0 * cycles, constant=1.0),))
"""


def test_an_installed_package_adds_a_pulse(monkeypatch, tmp_path, rocking):
    installed(monkeypatch, tmp_path, GROUP, "ramp", RAMP, "ramp")
    assert pulse("ramp", cycles=2.0).duration == 4.0
    with pytest.raises(MotionError, match=r"^ramp pulse: takes no gamma; expected cyc"):
        pulse("ramp", gamma=2.0)
    with pytest.raises(MotionError, match=r"unknown pulse 'ram'; .* .did you mean 'ra"):
        pulse("ram")
    words = "check block:0.5x2 --pulse ramp --cycles 2 --a-g 0.3g --f-g 1 --json"
    assert rocking(*words.split()).record["motion"] == "ramp"
    upwards = "check block:0.5x2 --vertical ramp --a-g 0.3g --f-g 1 --json"
    assert "ramp" in rocking(*upwards.split()).record["motion"]


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("return [1.0, 2.0]", "TypeError: it returns a list, which is no Motion"),
        ("return None", "TypeError: it returns a NoneType, which is no Motion"),
        ("import nothing_at_all", "ModuleNotFoundError: No module named 'nothing_at"),
        ("return sine().scaled(2.0)", "ValueError: its largest value is 2, which is"),
        ("return 1 / 0", "ZeroDivisionError: division by zero"),
        ("raise SystemExit(3)", "SystemExit: 3"),
    ],
)
def test_a_pulse_of_a_package_that_is_none_is_told(monkeypatch, tmp_path, body, words):
    source = f"from rocking_cli import sine\ndef make():\n    {body}\n"
    installed(monkeypatch, tmp_path, GROUP, "odd", source, "make")
    told = f"pulse odd, which the package of-odd adds and which cannot be used: {words}"
    with pytest.raises(MotionError, match=f"^{re.escape(told)}"):
        pulse("odd")
