"""The slower path against independent integrations, against the engine, where it has to
be patient, and where it loses contact.
"""

import math
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.ground_forces import pendulum
from support.bodies import KINDS, random_body, random_shaking
from support.record_layouts import wave
from support.references import LADDER, integrated, reference
from support.synthetic_records import allowance, motion_of_samples

from rocking_cli import (
    LinearEquation,
    Method,
    Outcome,
    RigidBodyEquation,
    RockingParameters,
    System,
    cosine,
    linear_response,
    load_structures,
    parse_grid,
    pulse,
    response,
    sine,
    spectrum,
)
from rocking_cli.dynamics.observers.contact_watch import ContactWatch
from rocking_cli.dynamics.observers.observer import Observer
from rocking_cli.dynamics.references import general_solver
from rocking_cli.dynamics.references.general_solver import (
    falls_to_zero,
    next_uplift,
    solve_cell,
)
from rocking_cli.motions import Motion, Piece
from rocking_cli.motions.biaxial import with_vertical

EPS = float(np.finfo(float).eps)


def test_the_check_of_nonlinear_sweeps_is_itself_right():
    # The last three hold arcs shorter than its steps, right after uplift.
    odd = [
        (1.3739303, 8.18093324, 1.0, 0.82321594),
        (1.77887648, 2.65944071, 1.0, 1.03821494),
        (1.2, 2.0, 0.3, 1.0),
    ]
    random = np.random.default_rng(1)
    draw = np.array(
        [
            random.uniform(a, b, 12)
            for a, b in ((0.9, 12), (0.5, 12), (0.5, 1), (0.05, 0.6))
        ]
    ).T.tolist()
    for case in [*draw, *odd]:
        flag, theta, _ = integrated(sine(), *case)
        outcome, peak = reference(sine(), *case)
        assert outcome.flag == flag
        assert math.isnan(theta) or abs(peak - theta) < 1e-9


def test_the_check_of_linear_sweeps_equals_fifty_digits():
    for motion, *cell, theta in (
        (sine(2), 1.3, 2.5, 0.6, 0.3931897472731955),
        (cosine(1), 3.0, 6.0, 0.9, 0.2990185600153954),
    ):
        assert reference(motion, *cell) == (
            Outcome.ROCKED,
            pytest.approx(theta, abs=1e-12),
        )


@settings(max_examples=12)
@given(
    st.floats(0.5, 20),
    st.floats(0.2, 20),
    st.floats(0, 0.99),
    st.sampled_from([sine(0.5), sine(1), sine(2), cosine(1), cosine(1.5), LADDER]),
)
def test_the_engine_and_the_slower_path_agree(amplitude, omega, eta, motion):
    response = linear_response(motion, amplitude, omega, eta)
    outcome, theta = reference(motion, amplitude, omega, eta)
    # A cell within rounding of a boundary may fall on either side of it; neighbours at
    # 1e-9 show such a cell.
    near = linear_response(
        motion, amplitude * np.array([1 - 1e-9, 1 + 1e-9]), omega, eta
    )
    if (near.outcome == response.outcome).all():
        assert outcome == response.outcome
        (allowed,) = allowance(motion, *np.array([[amplitude], [omega], [eta]]))
        assert math.isnan(theta) or abs(theta - response.theta_ratio) <= allowed


@pytest.mark.parametrize(
    ("motion", "amplitude", "omega", "eta", "alpha", "relative"),
    [
        *(
            (cosine(1), 11.625, 11.0, eta, None, 0.0)
            for eta in (1e-6, 1e-5, 6.1e-5, 1e-4, 1e-3)
        ),
        *(
            (sine(), 1.0 + 1e-9, omega, 0.5, None, 1e-5)
            for omega in (1e-4, 1e-2, 1.0, 100.0)
        ),
        (pulse("half-sine"), 3000.0, 1e4, 0.5, 0.25, 0.0),
    ],
)
def test_what_is_shorter_than_a_stretch_is_seen(
    motion, amplitude, omega, eta, alpha, relative
):
    """A body that bounces for 1e-8 after its second impact and lifts off again; one
    that the drive exceeds by 1e-9 for 9e-5 rad, for which a body in a slow pulse waits
    through 1e5 of its own stretches (rounding of the drive over its excess: 2e-7); and
    an impulse of 3e-4 in tau after which the body rocks for several.
    """
    outcome, theta = reference(motion, amplitude, omega, eta, alpha)
    found = response(
        System(RigidBodyEquation(alpha, 1e-12) if alpha else LinearEquation()),
        motion,
        amplitude,
        omega,
        eta,
    )
    assert outcome == found.outcome == Outcome.ROCKED
    assert theta == pytest.approx(
        float(found.theta_ratio), rel=relative, abs=0.0 if relative else 1e-12
    )


def test_a_dip_between_two_steps_is_seen():
    """A block that a record lifts again right after it came below the ground; it
    overturns after that impact.
    """
    cell = (
        motion_of_samples(-0.5 * wave(40)[::-1], 0.06),
        3.02446,
        1.0 / 5.349519445453641,
        0.9183055975794251,
    )
    assert (
        reference(*cell)[0].flag
        == integrated(*cell).outcome
        == "overturned_after_impact"
    )


def test_the_limit_of_spans_grows_with_the_motion(monkeypatch):
    """A record has a stretch or more a piece, however long it is."""
    monkeypatch.setattr(general_solver, "_MOST", 20)
    heights = np.random.default_rng(0).uniform(-1.0, 1.0, 101)
    pieces = tuple(
        Piece(float(i), i + 1.0, (), float(a), float(b - a))
        for i, (a, b) in enumerate(pairwise(heights))
    )
    motion = Motion("record", pieces)
    found = linear_response(motion, 1.5, 12.0, 0.7)
    outcome, theta = reference(motion, 1.5, 12.0, 0.7)
    assert outcome == found.outcome == Outcome.ROCKED
    assert theta == pytest.approx(float(found.theta_ratio), abs=1e-12)


def test_a_body_that_lies_on_its_side_is_not_followed():
    """Under 1e8 times its uplift it would turn over a million times
    within one stride.
    """
    calls = 0
    problem = Method("nonlinear").problem_of(
        RockingParameters(
            name="b",
            structure="block",
            p=1.0,
            alpha=0.25,
            eta=0.9,
            uplift=math.tan(0.25),
            a_scale=1.0,
        )
    )
    edge = problem.edges[1]

    def counted(*state):
        nonlocal calls
        calls += 1
        return edge.of(*state)

    watched = edge._replace(of=counted)
    outcome, _ = solve_cell(
        sine(), 1e8, 0.01, problem._replace(edges={1: watched, -1: watched})
    )
    assert outcome == Outcome.OVERTURNED_NO_IMPACT
    assert calls < 20_000


def test_uplift_from_rest_is_at_the_crossing_of_a_line():
    line = Piece(2.0, 4.0, (), -0.5, 1.0)
    assert next_uplift(line, 2.0, 1.0) == pytest.approx(
        3.5, rel=8 * EPS
    )  # a rounding or two of the line and of its place
    assert next_uplift(line, 3.75, 1.0) == 3.75
    assert next_uplift(line, 2.0, 0.6) is None
    assert next_uplift(line, 2.0, -2.5) == 2.0


@pytest.mark.parametrize(("depth", "lost"), [(1e-9, True), (-1e-9, False)])
@pytest.mark.parametrize("place", [0.1, 0.37, 0.5, 0.93])
def test_a_dip_within_a_step_is_found(place, depth, lost):
    def force(x):
        return 0.3 * (x - place) ** 2 * (1.0 + 0.2 * x) - depth

    assert falls_to_zero((force(0.0), force(0.5), force(1.0)), force) == lost


def test_the_ground_falls_away_where_the_weight_is_gone():
    """Bodies that nothing lifts but the loss of their weight; of a linkage that is on
    its way down nothing is told.
    """
    body = RockingParameters(
        name="b",
        structure="block",
        p=2.0,
        alpha=0.2,
        eta=0.9,
        uplift=math.tan(0.2),
        a_scale=1.0,
    )
    for model in ("linear", "nonlinear"):
        reference = Method(model).reference_of(body)
        for factor, expected in (
            (1.0 - 1e-9, Outcome.ROCKED),
            (1.0 + 1e-9, Outcome.LOST_CONTACT),
        ):
            motion = with_vertical(
                sine(), cosine(), factor / (0.5 * 0.2)
            )  # the weight is least at its middle
            assert reference(motion, 0.5, 3.0)[0] == expected
    (arch,) = load_structures("configs/arch.yaml")
    falling = with_vertical(sine(0.5), cosine(1), 0.9)
    found = [
        Method("nonlinear").reference_of(arch)(falling, a, 2.0)[0] for a in (0.9, 6.0)
    ]
    assert found == [Outcome.NO_UPLIFT, Outcome.FAILED]


@pytest.mark.parametrize(
    ("kind", "recorded", "cells", "seed"),
    [
        ("unequal", False, 5, 2),
        ("damped", True, 5, 4),
        *(
            pytest.param(kind, recorded, 150, 7, marks=pytest.mark.soak)
            for kind in KINDS
            for recorded in (False, True)
        ),
    ],
)
def test_the_engine_and_the_slower_paths_lose_the_same_bodies(
    kind, recorded, cells, seed
):
    random, seen = np.random.default_rng(seed), Counter()
    for _ in range(cells):
        body, solved, _ = random_body(kind, random, (0.3, 0.7), (0.6, 0.98), 0.2)
        motion, *cell = random_shaking(
            random, body, (0.0, 0.4, 1.5), (1.5, 5.0), recorded
        )
        method = Method("nonlinear" if solved.nonlinear else "linear", 1e-11)
        found = response(method.system_of(body), motion, *cell)
        outcome, theta = method.reference_of(body)(motion, *cell)
        assert outcome == found.outcome, (kind, motion.name, method.model, *cell)
        assert outcome != Outcome.ROCKED or abs(theta - found.theta_ratio) < 1e-8
        seen[outcome] += 1
    assert min(seen[Outcome.ROCKED], seen[Outcome.LOST_CONTACT]) > (
        20 if cells > 100 else 0
    )


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_a_sweep_counts_bodies_that_one_path_alone_sees_leave_the_ground(
    model, monkeypatch
):
    grid, motion, method = parse_grid("A=4:8:3,Omega=7:9:2"), sine(), Method(model)
    known = spectrum([pendulum()], motion, grid, method=method, check=6).summary
    lost = known.outcomes["lost_contact"]
    assert lost > 0
    assert (known.misjudged, known.checked_cells) == (0, 6)
    with monkeypatch.context() as blind:
        blind.setattr(general_solver, "falls_to_zero", lambda rough, force: False)
        assert (
            spectrum(
                [pendulum()], motion, grid, method=method, check=6
            ).summary.misjudged
            == lost
        )
    monkeypatch.setattr(ContactWatch, "arcs", lambda self, *lanes: None)
    monkeypatch.setattr(ContactWatch, "free", lambda self, *lanes: None)
    monkeypatch.setattr(ContactWatch, "may_rest", Observer.may_rest)
    assert (
        spectrum([pendulum()], motion, grid, method=method, check=6).summary.misjudged
        == lost
    )
