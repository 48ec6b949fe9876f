"""What a set of motions does to a structure: cells, intervals and shares agree with
each other and with single responses.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.documents import built
from support.synthetic_records import pulsed, recorded

from rocking_cli import (
    Outcome,
    Resampling,
    RockingParameters,
    UsageError,
    cosine,
    pulse,
    response,
    sine,
    trace_envelope,
)
from rocking_cli.dynamics.method import LINEAR, Method
from rocking_cli.envelopes import record_changes
from rocking_cli.fragility.exposure import (
    Exposure,
    MotionSet,
    as_recorded,
    exposures,
    first_of,
    share_overturned,
    traced,
)
from rocking_cli.fragility.measures import members_of, shaken_upwards
from rocking_cli.fragility.study import Study
from rocking_cli.motions.biaxial import Upwards, with_vertical
from rocking_cli.motions.intensity_measures import MEASURES
from rocking_cli.spectra.sweep_options import SweepOptions

BLOCK = built("kind: block\nwidth: 0.5\nheight: 2\nrestitution: 0.9")
PULSES = [pulsed(sine(), 2.0, 2 * np.pi * f) for f in (0.8, 1.9)]


def record(seed):
    random, t = np.random.default_rng(seed), 0.01 * np.arange(210)
    waves = (
        random.uniform(0.3, 1.0) * np.sin(2 * np.pi * f * t + random.uniform(0, 6))
        for f in (0.7, 1.3, 2.9)
    )
    return recorded(np.sin(np.pi * t / t[-1]) * sum(waves), 0.01, f"R{seed}")


RECORDS = members_of([record(n) for n in range(3)])


@pytest.mark.slow
def test_intervals_of_pulses_are_those_of_the_envelope():
    motions = MotionSet(PULSES, MEASURES["PGA"], np.array([12.0]), LINEAR)
    (found,) = traced([BLOCK], motions)
    for member, intervals in zip(PULSES, found, strict=True):
        top = float(BLOCK.dimensionless_amplitude(12.0))
        wanted = trace_envelope(BLOCK, sine(), [member.omega / BLOCK.p], a_max=top)
        edges = [
            BLOCK.ground_acceleration(x)
            for i in wanted
            for x in (i.a_from, i.a_to)
            if x is not None
        ]
        mine = [x for i in intervals for x in i if np.isfinite(x)]
        assert mine == pytest.approx(edges, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("name", "members"),
    [
        pytest.param("PGA", PULSES, marks=pytest.mark.soak),
        ("nPGV", PULSES),
        pytest.param("Arias", RECORDS[:1], marks=pytest.mark.soak),
    ],
    ids=["pulses, PGA", "pulses, nPGV", "records, Arias"],
)
def test_cells_lie_in_the_traced_intervals_and_shares_are_those_of_the_cells(
    name, members
):
    measure = MEASURES[name]
    middle = (
        np.median([m.measured(measure, BLOCK) for m in members])
        * (2.4 / members[0].acceleration) ** measure.power
    )
    levels = (
        np.geomspace(0.8, 2.2 if members is PULSES else 5.0, 9) ** measure.power
        * middle
    )
    motions = MotionSet(members, measure, levels, LINEAR)
    (found,), (intervals,) = exposures([BLOCK], motions), traced([BLOCK], motions)
    falls, known = found.beyond(None)
    assert known.all()
    assert 0 < falls.sum() < falls.size
    for row, mine in zip(falls, intervals, strict=True):
        assert row.tolist() == [
            any(low <= x < high for low, high in mine) for x in levels
        ]
    x, share = share_overturned(intervals, np.ones(len(members)))
    at = np.searchsorted(x, levels, side="right") - 1
    assert np.where(at >= 0, share[np.maximum(at, 0)], 0.0) == pytest.approx(
        falls.mean(axis=0), abs=1e-12
    )
    first = first_of(intervals)
    assert [np.isfinite(r) for r in first] == [bool(mine) for mine in intervals]


@pytest.mark.slow
def test_no_interval_depends_on_what_is_searched_together(monkeypatch):
    bodies = [
        built("kind: block\nwidth: 0.25\nheight: 1.2\nrestitution: 0.9"),
        built("kind: block\nwidth: 0.3\nheight: 1.2\nrestitution: 0.85"),
        built("kind: block\nwidth: 0.9\nheight: 1\nrestitution: 0.6"),
    ]
    motions = MotionSet(
        RECORDS[:2], MEASURES["PGA"], np.array([2.0, 4.5]), Method("nonlinear")
    )
    together = traced(bodies, motions, workers=2)
    second = replace(motions, members=RECORDS[1:2])
    alone = [traced([body], second, workers=1)[0][0] for body in bodies]
    assert alone == [of_body[1] for of_body in together]

    # The march holds a record once, however many bodies it shakes.
    march, records = record_changes.response_under_records, []

    def counted(system, motions, *cells):
        records.append(len(motions))
        return march(system, motions, *cells)

    monkeypatch.setattr(record_changes, "response_under_records", counted)
    assert traced(bodies[:2], second, workers=1) == [
        of_body[1:] for of_body in together[:2]
    ]
    assert set(records) == {1}

    # The march agrees on both sides of each end.
    ends = np.array([x for pair in together[1][1] for x in pair if np.isfinite(x)])
    assert ends.size == 3
    levels = np.sort(np.append(ends * (1.0 - 2e-6), ends * (1.0 + 2e-6)))
    (found,) = exposures(bodies[1:2], replace(second, levels=levels))
    inside = [any(low <= x < high for low, high in together[1][1]) for x in levels]
    assert found.beyond(None)[0][0].tolist() == inside


UPWARDS = {"records": Upwards(record(7).motion, 0.6), "pulses": Upwards(cosine(), -0.4)}


@pytest.mark.parametrize(
    "up",
    [
        pytest.param(None, marks=pytest.mark.soak),
        UPWARDS["records"],
        UPWARDS["pulses"],
    ],
    ids=["level", "vertical record", "vertical pulse"],
)
def test_cells_are_single_responses_to_the_scaled_motions(up):
    """A vertical motion is scaled together with the horizontal one, whose measure
    counts.
    """
    method, levels = Method("nonlinear"), np.array([2.6, 4.0])
    members = PULSES[:2] if up is UPWARDS["pulses"] else RECORDS[:2]
    moved = members if up is None else shaken_upwards(members, up)
    motions = MotionSet(moved, MEASURES["PGA"], levels, method)
    (found,), recorded = exposures([BLOCK], motions), as_recorded(BLOCK, motions)
    for i, member in enumerate(members):
        motion = (
            member.motion
            if up is None
            else with_vertical(member.motion, up.vertical, up.scale)
        )
        amplitude = BLOCK.dimensionless_amplitude(
            np.array([*levels, member.acceleration])
        )
        alone = response(
            method.system_of(BLOCK),
            motion,
            amplitude,
            np.array([member.omega / BLOCK.p]),
            BLOCK.eta,
        )
        assert alone.outcome.tolist() == [*found.outcome[i], *recorded.outcome[i]]
        assert alone.theta_ratio == pytest.approx(
            [*found.theta_ratio[i], *recorded.theta_ratio[i]], rel=1e-9, nan_ok=True
        )


def test_a_file_of_cells_is_read_again_and_another_scene_refused(tmp_path):
    level = MotionSet(RECORDS[:1], MEASURES["PGA"], np.array([2.0, 4.0, 6.0]), LINEAR)
    upwards = replace(
        level,
        members=shaken_upwards(RECORDS[:1], UPWARDS["records"]),
        method=Method("nonlinear"),
    )
    for path, motions, other in (
        (tmp_path / "level.h5", level, replace(level, levels=2 * level.levels)),
        (tmp_path / "up.h5", upwards, replace(upwards, members=RECORDS[:1])),
    ):
        (fresh,), (same,) = (
            exposures([BLOCK], motions, path),
            exposures([BLOCK], motions, path, SweepOptions(resume=True)),
        )
        assert same.outcome.tolist() == fresh.outcome.tolist()
        with pytest.raises(UsageError, match="belongs to another scene"):
            exposures([BLOCK], other, path, SweepOptions(resume=True))
    with pytest.raises(UsageError, match="holds one structure only"):
        exposures(
            [BLOCK, BLOCK],
            replace(level, measure=MEASURES["nPGA"]),
            tmp_path / "two.h5",
        )
    with pytest.raises(UsageError, match="goes with records"):
        exposures([BLOCK], replace(level, members=PULSES), tmp_path / "pulses.h5")
    with pytest.raises(UsageError, match="expected two records, or none"):
        shaken_upwards(RECORDS, UPWARDS["pulses"])


def test_shares_step_where_intervals_begin_and_end():
    x, share = share_overturned(
        [[(1.0, 2.0), (3.0, np.inf)], [(2.0, 4.0)], []], np.ones(3)
    )
    assert x.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert share == pytest.approx([1 / 3, 1 / 3, 2 / 3, 1 / 3])


def test_what_leaves_the_ground_passes_every_limit():
    body = RockingParameters(
        name="m",
        structure="point_mass",
        p=2.0,
        alpha=1.0,
        eta=0.9,
        uplift=float(np.tan(1.0)),
        a_scale=1.0,
        arm=9.81 / 4.0,
    )
    motions = MotionSet(
        [pulsed(pulse("rectangular"), 1.0, 16.0)],
        MEASURES["PGA"],
        body.ground_acceleration(np.array([0.5, 1.6])),
        LINEAR,
    )
    (found,) = exposures([body], motions)
    assert found.outcome.tolist() == [[Outcome.NO_UPLIFT, Outcome.LOST_CONTACT]]
    assert [found.beyond(limit)[0].tolist() for limit in (None, 0.1)] == [
        [[False, True]]
    ] * 2
    (((first, *_),),) = traced([body], motions)
    assert 1.0 < first[0] / body.ground_acceleration(1.0) < 1.6


def test_motions_that_stand_again_at_a_larger_level_are_counted():
    beyond = np.array([[0, 1, 1, 1], [0, 1, 0, 1], [1, 0, 1, 0], [0, 0, 0, 0]])
    exposure = Exposure(
        np.zeros(beyond.shape),
        np.where(beyond, Outcome.OVERTURNED_NO_IMPACT, Outcome.ROCKED),
    )
    assert (
        Study(
            BLOCK,
            MotionSet(RECORDS, MEASURES["PGA"], np.arange(1.0, 5.0), LINEAR),
            Resampling(),
            exposure,
        ).standing_again
        == 2
    )


@pytest.mark.parametrize(
    ("model", "uplift"), [("linear", BLOCK.alpha), ("nonlinear", math.tan(BLOCK.alpha))]
)
def test_nothing_is_damaged_up_to_the_uplift_of_the_equation(model, uplift):
    exposure = Exposure(np.zeros((len(RECORDS), 2)), np.zeros((len(RECORDS), 2)))
    motions = MotionSet(RECORDS, MEASURES["PGA"], np.array([1.0, 2.0]), Method(model))
    assert Study(BLOCK, motions, Resampling(), exposure).no_damage == pytest.approx(
        9.81 * uplift, rel=1e-12
    )
