"""What the shaking still can do, and that it overturns no body of which
that is said.
"""

from itertools import pairwise, product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from support.references import lanes
from support.soak import quick

from rocking_cli import (
    LinearEquation,
    Method,
    Outcome,
    System,
    cosine,
    load_structures,
    pulse,
    response,
    sine,
)
from rocking_cli.dynamics.batch import Batch
from rocking_cli.dynamics.contacts.contact import Symmetric
from rocking_cli.dynamics.drive import RemainingImpulse
from rocking_cli.dynamics.impulse_bound import ImpulseBound
from rocking_cli.dynamics.march import proofs
from rocking_cli.dynamics.march.engine import Run

ARCH = str(Path(__file__).parents[2] / "configs/arch.yaml")
FEW_PUSHES = [
    sine(),
    sine(0.5),
    cosine(0.5),
    pulse("rectangular"),
    pulse("rectangular-impulse"),
]


@pytest.mark.parametrize(
    "motion",
    [
        sine(),
        sine(2.5),
        cosine(1.5),
        *map(pulse, ("ricker-symmetric", "rectangular-impulse")),
        pulse("mavroeidis-papageorgiou", phase=0.7),
    ],
    ids=lambda m: m.name,
)
def test_it_is_the_integral_of_the_size_of_the_drive(motion):
    segments, random = motion.segments, np.random.default_rng(5)
    k = random.integers(0, len(segments), 6)
    u = random.uniform(0.0, 1.0, 6) * segments.length[k]
    found = RemainingImpulse.of(segments).after(
        np.append(k, len(segments)), np.append(u, 0.0)
    )
    assert found[-1] == 0.0
    zeros = [
        zero(motion, a, a + b)
        for a, b in zip(segments.start, segments.length, strict=True)
    ]
    for phase, there in zip(segments.start[k] + u, found, strict=False):
        marks = [
            phase,
            *sorted(x for x in {*segments.start, *zeros} if x > phase),
            motion.duration,
        ]
        size = sum(
            abs(quad(motion.value, a, b, epsabs=1e-14, epsrel=1e-13)[0])
            for a, b in pairwise(marks)
        )
        assert there == pytest.approx(
            size, rel=1e-12, abs=1e-11
        )  # where rounding of the integral has room


def zero(motion, start, stop):
    """Where s changes its sign within a segment, its start where it does not."""
    inside = start + 1e-9 * (stop - start), stop - 1e-9 * (stop - start)
    return (
        brentq(motion.value, *inside, xtol=1e-14)
        if np.prod(motion.value(np.array(inside))) < 0.0
        else start
    )


def landed(motion, cells, seed, share):
    """(Omega, True where nothing to come can overturn them, outcomes) of bodies just
    after an impact anywhere in a motion, with `share` of the speed at which the lemma
    ends.
    """
    segments, random = motion.segments, np.random.default_rng(seed)
    remaining, k = (
        RemainingImpulse.of(segments),
        random.integers(0, len(segments), cells),
    )
    u = random.uniform(0.0, 1.0, cells) * segments.length[k]
    amplitude, omega = random.uniform(0.2, 9.0, cells), random.uniform(0.3, 60.0, cells)
    v = share * (1.0 - amplitude * remaining.after(k, u) / omega)
    at = np.flatnonzero(v > 0.0)
    k, u, amplitude, omega, v = (x[at] for x in (k, u, amplitude, omega, v))
    side, eta = random.choice([-1.0, 1.0], at.size), random.uniform(0.5, 1.0, at.size)
    system = System(LinearEquation(), Symmetric(eta))
    batch = Batch.of(system, segments, amplitude, omega)
    run = Run(batch, at.size)
    b = -side * amplitude * motion.value(segments.start[k] + u) - 1.0
    landing = lanes(
        amplitude=amplitude,
        omega=omega,
        eta=eta,
        segment=k,
        phase=u,
        side=side,
        v=v,
        force=b,
        impacts=1,
        steps=1,
    )
    bound = ImpulseBound.of(batch.equation, batch.cells, segments)
    below = bound.cannot_overturn(batch.cells, landing)
    with np.errstate(all="ignore"):
        while landing.cell.size:
            landing = run.round(landing)
    return omega, below, run.outcome


@pytest.mark.parametrize(
    "motion",
    quick([*FEW_PUSHES, sine(3), pulse("ricker-symmetric")], *FEW_PUSHES[:2]),
    ids=lambda m: m.name,
)
def test_lemma_9_nothing_to_come_overturns_what_is_below_the_bound(motion):
    _, below, outcome = landed(motion, 600, 6, 0.999)
    assert np.all(below)
    assert set(outcome.tolist()) == {Outcome.ROCKED}


@pytest.mark.requirement(
    "A short push overturns by its velocity",
    "dynamics/impulse_bound.py",
    "Block overthrown by a velocity",
)
def test_just_above_the_bound_short_pulses_overturn():
    omega, below, outcome = landed(sine(0.5), 1000, 7, 1.001)
    assert not np.any(below)
    assert (
        np.count_nonzero(outcome[omega > 50.0] == Outcome.OVERTURNED_AFTER_IMPACT) > 30
    )


STATUE = "rigid:left=0.42,right=0.31,height=1.15,gyration=0.68"
LEANING = "wall:thickness=0.6,height=6,one_sided=true"
HALF = sine(0.5).scaled(-1.0)


@pytest.mark.parametrize(
    ("body", "motion"),
    [
        (None, sine()),
        ("block:0.5x2", HALF),
        (STATUE, sine()),
        (LEANING, HALF),
        (ARCH, HALF),
        *(
            pytest.param(*pair, marks=pytest.mark.soak)
            for pair in product(
                (None, "block:0.5x2", STATUE, LEANING, ARCH), (sine(), HALF)
            )
        ),
    ],
)
def test_where_only_outcomes_are_wanted_they_are_the_same(body, motion, monkeypatch):
    """Of linear oscillators, and of bodies by their nonlinear equations."""
    random = np.random.default_rng(8)
    amplitude, omega = (
        1.0 + 10.0 ** random.uniform(-2.0, 0.5, 300),
        random.uniform(0.5, 8.0, 300),
    )
    eta = random.choice([0.0, 0.3, 0.9], 300)
    system = System(LinearEquation())
    if body is not None:
        (structure,) = load_structures(body)
        # without a body, whose forces need the peaks
        system = Method("nonlinear").system_of(structure)._replace(body=None)
        eta = structure.eta
    sooner = response(system, motion, amplitude, omega, eta, peaks=False)
    monkeypatch.setattr(proofs, "FEW_SIGN_CHANGES", -1)
    followed = response(system, motion, amplitude, omega, eta, peaks=False)
    np.testing.assert_array_equal(sooner.outcome, followed.outcome)
    assert np.all(sooner.impacts_at_least <= followed.impacts_at_least)
    assert sooner.work.steps < followed.work.steps
