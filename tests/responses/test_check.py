"""Verdicts against the envelope, the time history and an independent solver, for
structures and pulses at random.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.collocation import Body, Edge, integrate
from support.bodies import shaking_of
from support.documents import built
from support.synthetic_records import motion_of_samples, noise

from rocking_cli import (
    Axis,
    Grid,
    Outcome,
    Record,
    parse_grid,
    pulse,
    sine,
    time_history,
    trace_envelope,
)
from rocking_cli.dynamics.method import governing_method
from rocking_cli.envelopes.capacity import Capacity
from rocking_cli.envelopes.intervals import A_MAX
from rocking_cli.motions.given import demand_of
from rocking_cli.motions.grid import as_recorded
from rocking_cli.reports.wording import tally
from rocking_cli.responses.check import check, verdicts
from rocking_cli.responses.verdict import CHECK_COLUMNS

QUICK = (sine(), sine(0.5), pulse("rectangular"))  # whose scans have bounds
PULSES = (*QUICK, pulse("cosine"), pulse("rectangular-impulse"))
BLOCK = built("kind: block\nwidth: 0.5\nheight: 2")
DEMAND = parse_grid("a_g=0.3g,f_g=1")


def at_random(random, linear, pulses=PULSES):
    """A structure, a pulse and a demand around its uplift."""
    if linear:
        p, alpha, lam = (
            random.uniform(1.0, 4.0),
            random.uniform(0.05, 0.5),
            random.uniform(0.1, 0.5),
        )
        text = (
            f"kind: parameters\np: {p}\nalpha: {alpha}\neta:"
            f" {random.uniform(0.3, 1.0)}\nlambda: {lam}"
        )
    else:
        slenderness = random.uniform(0.1, 0.45)
        height = random.uniform(0.8, 8.0)
        kind = random.choice(["block", "point_mass", "prism"])
        text = f"kind: {kind}\nwidth: {slenderness * height}\nheight: {height}"
        if kind == "prism":
            width = slenderness * height
            text = (
                f"kind: prism\ncorners: [[0, 0], [{width}, 0],"
                f" [{0.5 * width * random.uniform(0.8, 1.4)}, {height}]]"
            )
    structure = built(text)
    motion = pulses[random.integers(len(pulses))]
    a_g = structure.uplift * 9.81 * float(np.exp(random.uniform(-0.3, 1.8)))
    omega_g = structure.p * random.uniform(1.2, 7.0)
    return (
        structure,
        motion,
        Grid(Axis("a_g", np.array([a_g])), Axis("omega_g", np.array([omega_g]))),
    )


def judged(structure, motion, demand, a_max=A_MAX):
    """Check a verdict against every interval that overturns, and against the history;
    whether the body fell, or stood above a fall.
    """
    verdict, method = (
        check(structure, motion, demand, a_max=a_max),
        governing_method(structure),
    )
    amplitude, omega = (float(x[0]) for x in demand.scaled(structure))
    top = max(a_max, 2.0 * amplitude)
    traced = trace_envelope(
        structure, motion, [omega], method=method, a_max=top, sign="+", workers=1
    )
    falls = [
        (
            structure.ground_acceleration(i.a_from),
            structure.ground_acceleration(i.a_to or np.inf),
        )
        for i in traced
    ]
    inside = any(low < verdict.demand_a < high for low, high in falls)
    assert verdict.falls == inside
    shown = time_history(structure, motion, demand, [method])
    history = shown.histories[method.model]
    assert shown.outcome(method.model) == verdict.outcome
    if history.peak is not None and not verdict.falls:
        assert verdict.theta_ratio == pytest.approx(
            abs(history.peak.theta_ratio), rel=1e-7, abs=1e-12
        )
    first = falls[0][0] if falls else None
    assert (verdict.first_overturning_a is None) == (first is None)
    if (
        first is not None
    ):  # four digits, rounded down, where many narrow intervals overturn
        assert (
            first * (1.0 - (1e-3 if verdict.share_of_falls else 2e-9))
            <= verdict.first_overturning_a
            <= first * (1.0 + 2e-9)
        )
    above = [low for low, _ in falls if low > verdict.demand_a]
    assert verdict.safe_to == (
        None if inside or not above else pytest.approx(above[0], rel=2e-9, abs=0)
    )
    if inside:
        assert verdict.capacity_demand < 1.0
    elif first is not None:
        assert (verdict.capacity_demand > 1.0) == all(
            low > verdict.demand_a for low, _ in falls
        )
    return inside, not inside and first is not None and first < verdict.demand_a


@pytest.mark.parametrize(
    ("a_g", "falls", "at_lambda"),
    [
        pytest.param("3", False, False, marks=pytest.mark.soak),
        pytest.param("6", True, False, marks=pytest.mark.soak),
        ("3", False, True),
    ],
)
def test_forces_under_a_record_are_those_of_its_history(a_g, falls, at_lambda):
    """Of a body that stands the walk tells them, of one that falls its history, and of
    one that the linear equation lifts at lambda.
    """
    structure, motion = (
        BLOCK.lifting_at_lambda() if at_lambda else BLOCK,
        motion_of_samples([0.0, 0.5, 0.6, -1.0, -0.7, 0.4, 0.0], 0.2),
    )
    demand, method = parse_grid(f"a_g={a_g},omega_g=1"), governing_method(structure)
    verdict = check(structure, motion, demand, a_max=None)
    shown = (
        time_history(structure, motion, demand, [method]).forces[method.model].extremes
    )
    assert verdict.falls == falls
    assert (verdict.friction_needed, verdict.fz_min) == pytest.approx(
        (shown.friction.friction, shown.fz_min), rel=1e-9
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("width", "step", "a_g", "falls"),
    [
        pytest.param(0.5, 2e-4, 4.0, False, marks=pytest.mark.soak),
        (0.5, 5e-4, 14.0, True),
        (8.0, 1e-3, 6.0, False),
    ],
)
def test_records_of_a_shaking_table_against_an_integration(width, step, a_g, falls):
    """At 1 to 5 kHz the steps are so short that few terms of a series are enough."""
    body = built(f"kind: block\nwidth: {width}\nheight: {4.0 * width}")
    t = step * np.arange(round(0.6 / step))
    record = Record.of(a_g * np.sin(2.0 * np.pi * t / 0.4), step)
    found = check(body, record, a_max=None)
    amplitude = float(body.dimensionless_amplitude(found.demand_a))
    edge = Edge(body.p, body.alpha, body.eta)
    wanted = integrate(
        Body(edge, edge, nonlinear=True),
        shaking_of(body, record.motion, amplitude, 1.0 / body.p),
    )
    assert found.outcome.flag == wanted.outcome
    assert found.falls == falls
    assert falls or found.theta_ratio == pytest.approx(
        wanted.rotation, rel=1e-9, abs=1e-12
    )


@pytest.mark.soak
def test_verdicts_agree_with_envelope_and_history_for_500():
    random = np.random.default_rng(1616)
    fell = [judged(*at_random(random, linear=n % 2 == 0)) for n in range(500)]
    assert 100 < sum(x for x, _ in fell) < 400
    assert sum(window for _, window in fell) >= 5


@pytest.mark.parametrize(
    "structure",
    [BLOCK, built("kind: parameters\np: 2.1\nalpha: 0.2\neta: 0.8\nlambda: 0.25")],
)
def test_an_independent_solver_agrees_just_below_and_above_the_first_overturning(
    structure,
):
    first = check(structure, sine(), parse_grid("a_g=4.2,f_g=1.2")).first_overturning_a
    method = governing_method(structure)
    for factor, falls in ((1.0 - 1e-6, False), (1.0 + 1e-6, True)):
        amplitude = float(structure.dimensionless_amplitude(first * factor))
        outcome, _ = method.reference_of(structure)(
            sine(), amplitude, 2.0 * np.pi * 1.2 / structure.p
        )
        assert outcome.overturned == falls


def test_the_record_has_the_columns_the_uplift_and_the_top():
    record = check(BLOCK, sine(), DEMAND, a_max=None).row()
    assert tuple(record) == CHECK_COLUMNS
    assert record["uplift_a"] == pytest.approx(0.25 * 9.81, rel=1e-12, abs=0)
    turned = 2.0 * math.sin(0.5 * record["theta_ratio"] * math.atan(0.25))
    assert record["top_displacement"] == pytest.approx(
        turned * math.hypot(0.5, 2.0), rel=1e-9
    )


@pytest.mark.soak
def test_verdicts_under_records_are_the_same_one_by_one_and_together():
    """Their searches are scanned together."""
    motions = [motion_of_samples(noise(240, 0.06, seed), 0.06) for seed in (1, 2)]
    shaking = as_recorded(2.9)
    bodies = [
        built(f"{{kind: block, name: A, width: 0.4, height: {height}}}")
        for height in (1.6, 2.4)
    ]
    demands = [(body, motion, shaking) for motion in motions for body in bodies][1:3]
    alone = [check(*demand, a_max=3.0) for demand in demands]
    assert sum(v.first_overturning_a is not None for v in alone) >= 1
    heard: list[float] = []
    given = {"workers": 1, "progress": lambda done, total: heard.append(done)}
    assert list(verdicts(demands, a_max=3.0, **given)) == alone
    assert heard == sorted(heard)
    assert heard[-1] == len(demands)
    assert 0.0 < heard[0] < 0.1  # while the search goes on


def test_what_leaves_the_ground_counts_as_a_fall_and_is_told_apart():
    lost = check(
        built("kind: block\nwidth: 1.2\nheight: 2\nrestitution: 0.8"),
        sine(),
        parse_grid("A=8,Omega=9"),
        a_max=6.5,
    )
    assert (lost.outcome, lost.falls, lost.theta_ratio, lost.safe_to) == (
        Outcome.LOST_CONTACT,
        True,
        None,
        None,
    )
    assert lost.capacity_demand < 1.0
    stands = replace(lost, outcome=Outcome.ROCKED)
    assert tally([stands]) == "0 of 1 overturn"
    assert tally([stands, lost]) == "0 of 2 overturn, 1 loses contact with the ground"


def test_a_body_that_needs_more_friction_than_its_document_states_slides():
    """A block of b/h = 1/4 under 0.3 g needs as much as lifts it, 0.25, and little
    more.
    """
    for stated, slides in ((0.25, True), (0.28, False)):
        verdict = check(
            built(f"kind: block\nwidth: 0.5\nheight: 2\nfriction: {stated}"),
            sine(),
            DEMAND,
            a_max=None,
        )
        assert (verdict.slides, verdict.friction_needed > stated) == (slides, slides)
        assert verdict.sentence.endswith("though its base would slide") == slides
    assert not check(BLOCK, sine(), DEMAND, a_max=None).slides


@pytest.mark.parametrize(
    "searched",
    [False, pytest.param(True, marks=pytest.mark.soak)],
    ids=["beside the demand", "and in a search"],
)
def test_a_demand_that_the_last_digits_decide_is_called_so(searched, monkeypatch):
    """After 160 impacts five of fifteen amplitudes within a part of 1e-6 stand."""
    if not searched:
        monkeypatch.setattr(
            "rocking_cli.responses.check.capacities",
            lambda *_: [Capacity(None, None, 1.0)],
        )
    structure = built("kind: parameters\np: 2\nalpha: 0.25\neta: 0.98\nlambda: 0.25")
    omega_g = 1.1642588176866302 * structure.p
    grid = Grid(
        Axis("A", np.array([1.046522639017664])), Axis("omega_g", np.array([omega_g]))
    )
    verdict = check(structure, sine(5), grid, a_max=1.2)
    assert verdict.unsettled
    assert verdict.sentence == f"{verdict.outcome.sentence}, on the last digits"
    assert verdict.capacity_demand <= 1.0 + 2e-6
    assert verdict.falls or verdict.safe_to <= verdict.demand_a * (1.0 + 2e-6)
    assert not check(structure, sine(), grid, a_max=1.2).unsettled


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "a_g", "opens"),
    [("voussoirs: 15", 0.2, False), ("", 0.39, True)],
)
def test_a_check_of_an_arch_says_whether_a_further_hinge_opens(text, a_g, opens):
    """As the search over joints and time does; 0.2 g does not lift the arch."""
    arch = built(
        "kind: arch\nspan: 6 m\nrise: 3 m\nthickness: 0.7 m\nmeasured:"
        f" intrados\n{text}"
    )
    demand = parse_grid(f"a_g={a_g}g,f_g=1")
    (summary,) = time_history(arch, sine(), demand).summaries(forces=True)
    assert (summary["opens"], check(arch, sine(), demand, a_max=None).opens) == (
        opens,
        opens,
    )


@pytest.fixture
def few_are_many(monkeypatch):
    """Four demands are marched together on arrays."""
    monkeypatch.setattr("rocking_cli.responses.check._MANY", 4)


@pytest.mark.usefixtures("few_are_many")
def test_many_bodies_are_judged_together_as_each_alone():
    """On arrays, within the tolerance of what each is on floats."""
    random = np.random.default_rng(11)
    texts = [
        f"kind: block\nwidth: {random.uniform(0.3, 1.2)}\nheight: 3\n{more}"
        for more in ("", "damping: 0.04", "damping: 0.07", "one_sided: true", "")
    ]
    samples = noise(120, 0.01, seed=3)
    record = motion_of_samples(3.5 * samples / np.abs(samples).max(), 0.01)
    shaken = (sine(), parse_grid("a_g=0.3g,f_g=0.8")), demand_of(record, None)
    demands = [(built(text), *one) for text in texts for one in shaken]
    together = list(verdicts(demands, a_max=None, workers=1))
    for one, demand in zip(together, demands, strict=True):
        (alone,) = verdicts([demand], a_max=None, workers=1)
        assert (one.outcome, one.outcome_linear) == (
            alone.outcome,
            alone.outcome_linear,
        )
        assert (one.fz_min, one.uplift_a) == (alone.fz_min, alone.uplift_a)
        assert (one.theta_ratio or 0.0) == pytest.approx(
            alone.theta_ratio or 0.0, abs=1e-8
        )
    assert len({one.outcome for one in together}) > 2


@pytest.mark.usefixtures("few_are_many")
def test_the_top_of_a_block_is_displaced_by_its_rotation_without_its_forces():
    demands = [
        (built(f"kind: block\nwidth: {width}\nheight: 3"), sine(), DEMAND)
        for width in np.linspace(0.4, 1.4, 7)
    ]
    whole = verdicts(demands, a_max=None, workers=1)
    fewer = verdicts(demands, a_max=None, workers=1, forces=False)
    for one, other in zip(whole, fewer, strict=True):
        assert other.outcome == one.outcome
        assert other.fz_min is None
        moved = one.top_displacement
        near = None if moved is None else pytest.approx(moved, rel=1e-8)
        assert other.top_displacement == near
