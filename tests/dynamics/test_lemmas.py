"""The lemmas on which the march rests, each with what tries to break it;
`rocking_cli.dynamics.lemmas` names the tests of the others.
"""

import math
import re
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from support.soak import quick

from rocking_cli import LinearEquation, RigidBodyEquation, System, response
from rocking_cli.dynamics import lemmas
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.contacts.contact import OneSided, Symmetric, Unequal
from rocking_cli.dynamics.contacts.sequences import sequence_ends
from rocking_cli.dynamics.march import engine
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.motions import Motion, Piece, pulse, sine
from rocking_cli.motions.biaxial import with_vertical

RIGHT_UNEQUAL = Unequal(
    drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=(1.0, 1.0)
)
CONTACTS = {
    "equal": (Symmetric(0.9), 0.9),
    "unequal": (RIGHT_UNEQUAL, 0.9),
    "one side": (OneSided(-0.6), -0.6),
}
LINEAR = {"undamped": LinearEquation(), "damped": LinearEquation(0.3)}


@pytest.mark.parametrize("cells", [300, pytest.param(4000, marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    "equation",
    [*LINEAR.values(), RigidBodyEquation(0.3), RigidBodyEquation(0.5, damping=0.2)],
)
def test_lemma_6_no_drive_up_to_the_strongest_brings_back_what_is_lost(equation, cells):
    """States on the very edge of what the lemma calls lost, then the worst drive, and
    random ones, in small Runge-Kutta steps.
    """
    random = np.random.default_rng(6)
    e = random.uniform(0.0, 3.0, cells)
    y, v = random.uniform(0.0, 3.0, cells), random.uniform(0.0, 4.0, cells)
    low = np.zeros(cells)
    lost = equation.certainly_overturns(y, v, e)
    for _ in range(40):  # down to the least speed that is called lost
        middle = 0.5 * (low + v)
        still = equation.certainly_overturns(y, middle, e)
        low, v = np.where(lost & ~still, middle, low), np.where(lost & still, middle, v)
    at = np.flatnonzero(lost & (y > 0.0))
    assert at.size > cells // 8
    for inward in (e, e * random.uniform(0.0, 1.0, cells)):
        here, speed, edge = y[at].copy(), v[at].copy(), -inward[at]
        start = here.copy()
        for step in range(1500):
            push = edge if step % 7 else random.uniform(-1.0, 3.0, at.size) * e[at]
            here, speed = _step(equation, here, speed, np.maximum(push, -e[at]), 4e-3)
            over = here > np.minimum(equation.limit, 10.0)
            here, speed = np.where(over, 20.0, here), np.where(over, 0.0, speed)
        assert np.all(here > start - 1e-9)


def _step(equation, y, v, a, h):
    def rate(y, v):
        return v, equation.force(y, a) - 2.0 * equation.damping * v

    k1 = rate(y, v)
    k2 = rate(y + 0.5 * h * k1[0], v + 0.5 * h * k1[1])
    k3 = rate(y + 0.5 * h * k2[0], v + 0.5 * h * k2[1])
    k4 = rate(y + h * k3[0], v + h * k3[1])
    return (
        x + h / 6.0 * (p + 2.0 * q + 2.0 * r + s)
        for x, p, q, r, s in zip((y, v), k1, k2, k3, k4, strict=True)
    )


def ramp(rng):
    """A monotone motion that passes from inside the uplift to beyond it, on either
    side.
    """
    ends, sign = rng.uniform(-1.6, 1.6, 2), -1.0
    return Motion(
        "ramp",
        (
            Piece(0.0, 6.0, (), sign * 1.3, -0.2 * sign),
            Piece(6.0, 30.0, (), ends[0], (ends[1] - ends[0]) / 24.0),
        ),
    )


SUMMED = {  # equations, and how strong the ground moves upwards
    f"{name}{words}": (equation, upwards)
    for words, upwards in (("", 0.0), (", upwards", 0.6))
    for name, equation in (
        ("linear", LINEAR["undamped"]),
        ("damped", LINEAR["damped"]),
        ("rigid", RigidBodyEquation(0.3, 1e-11)),
    )
}


@pytest.mark.parametrize("motions", [1, pytest.param(10, marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    "case",
    quick(
        list(product(SUMMED, CONTACTS)),
        ("linear", "equal"),
        ("linear", "one side"),
        ("rigid, upwards", "unequal"),
    ),
    ids=": ".join,
)
def test_lemma_7_a_summed_sequence_ends_before_anything_else_happens(
    case, motions, monkeypatch
):
    """The same cells with every bounce marched through, down to speeds of 1e-9: the
    same outcome, and the same largest rotation.
    """
    (equation, upwards), (contact, eta) = SUMMED[case[0]], CONTACTS[case[1]]
    random = np.random.default_rng(7)
    closed = marched = 0
    for _ in range(motions):
        motion = (
            with_vertical(ramp(random), ramp(random), upwards)
            if upwards
            else ramp(random)
        )
        system = System(equation, contact, scale=0.3)
        amplitude, omega = random.uniform(0.85, 1.5, 6), random.uniform(0.5, 6.0, 6)
        summed = response(system, motion, amplitude, omega, eta)
        closed += summed.work.sequences_closed
        run = Run(
            Batch.of(system, system.segments(motion), amplitude, omega),
            amplitude.size,
        )
        run.proofs = [proof for proof in run.proofs if proof.still]
        with monkeypatch.context() as patch:
            patch.setattr(
                engine,
                "sequence_ends",
                lambda seg, lanes, *more: (
                    sequence_ends(seg, lanes, *more) & (lanes.v < 1e-9)
                ),
            )
            run.all()
        assert run.outcome.tolist() == summed.outcome.tolist()
        assert run.theta_ratio == pytest.approx(
            summed.theta_ratio, rel=1e-9, abs=1e-12, nan_ok=True
        )
        marched += run.work.impacts - summed.work.impacts
    assert closed
    assert marched


@pytest.mark.parametrize(
    "motion",
    [sine(2), pulse("rectangular-impulse"), pulse("mavroeidis-papageorgiou")],
    ids=lambda m: m.name,
)
def test_zero_damping_changes_no_bit_and_little_damping_little(motion):
    random = np.random.default_rng(8)
    omega = random.uniform(1.0, 8.0, 200) * np.repeat(
        [1.0, 10.0], [150, 50]
    )  # as short as an impulse: the body rocks long after it
    cells = (
        random.uniform(1.0, 4.0, 200) * np.maximum(1.0, omega / 8.0),
        omega,
        random.uniform(0.3, 0.95, 200),
    )
    plain, none, little = (
        response(System(LinearEquation(*d)), motion, *cells)
        for d in ((), (0.0,), (1e-9,))
    )
    assert none.theta_ratio.tobytes() == plain.theta_ratio.tobytes()
    assert little.outcome.tolist() == plain.outcome.tolist()
    assert little.theta_ratio == pytest.approx(plain.theta_ratio, abs=1e-5, nan_ok=True)


@pytest.mark.parametrize("inward", [0.0, 0.4, 3.0, 12.0])
@pytest.mark.parametrize(
    "equation",
    [LinearEquation(), RigidBodyEquation(0.2), RigidBodyEquation(0.6)],
    ids=["linear", "0.2", "0.6"],
)
def test_lemma_6_calls_lost_what_has_the_speed_to_pass_the_barrier_and_no_less(
    equation, inward
):
    """The work against the strongest inward drive up to where the force turns outwards,
    by quadrature.
    """

    def force(y):
        return float(equation.force(np.array([y]), np.array([-inward]))[0])

    summit = brentq(
        force, 0.0, min(1.2 * (1.0 + inward), equation.limit + 1.0), xtol=1e-15
    )
    for y in (0.0, 0.3, 0.9):
        work = -quad(force, y, summit, epsabs=1e-14, epsrel=1e-13)[0]
        speed = math.sqrt(2.0 * work) * np.array([1.0 - 1e-10, 1.0 + 1e-10])
        assert equation.certainly_overturns(
            np.full(2, y), speed, np.full(2, inward)
        ).tolist() == [False, True]


def stated():
    """The text of each lemma by its number."""
    parts = re.split(r"^# Lemma (\d+) .*$", lemmas.__doc__, flags=re.MULTILINE)
    return dict(zip(map(int, parts[1::2]), parts[2::2], strict=True))


def test_every_lemma_that_is_cited_is_stated():
    package = Path(lemmas.__file__).parents[1]
    texts = [
        path.read_text()
        for room in ("dynamics", "envelopes")
        for path in (package / room).rglob("*.py")
    ]
    lists = [
        found
        for text in texts
        for found in re.findall(r"Lemmas?\s+(\d+(?:(?:,| and|, and)\s+\d+)*)", text)
    ]
    cited = {int(number) for found in lists for number in re.findall(r"\d+", found)}
    assert cited == set(stated())


@pytest.mark.parametrize("number", stated())
def test_a_lemma_has_a_proof_and_a_test_that_exist(number):
    text = stated()[number]
    assert "Proof. " in text or number == 14  # whose statement is the proof
    tests = re.findall(
        r"`([\w/.]+)::(\w+)`",
        re.search(r"^Test\s(.*)", text, flags=re.MULTILINE | re.DOTALL)[1],
    )
    assert tests
    here = Path(__file__).parent
    for path, name in tests:
        file = here.parents[1] / path if path.startswith("tests/") else here / path
        assert f"def {name}(" in file.read_text()
