"""Envelopes: traced intervals against the reference table, a raster and published
simulations.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.documents import built
from support.references import INTERVALS

from rocking_cli import (
    RockingParameters,
    UsageError,
    cosine,
    dimensionless_oscillator,
    linear_response,
    overturned,
    pulse,
    response,
    sine,
    trace_envelope,
)
from rocking_cli.dynamics.method import Method
from rocking_cli.envelopes.intervals import misjudged
from rocking_cli.reports.remarks import misjudged_in_words


@pytest.mark.requirement(
    "Thresholds under a pulse are those of the literature, by either equation",
    "envelopes/intervals.py",
    "Sine, linear, after an impact",
    "The same, upper end",
    "The same, without an impact",
    "Sine of 15.7 rad/s, linear",
    "Sine of 15.7 rad/s, nonlinear",
    "Half sine, 0.4 x 1.2 m",
    "Sine, 1 x 3 m",
)
@pytest.mark.parametrize(
    ("structure", "model", "rows"),
    [
        (dimensionless_oscillator(eta=0.9), "linear", INTERVALS),
        (
            built("kind: block\nradius: 1.6065814 m\nalpha: 0.25\nrestitution: 0.9"),
            "nonlinear",
            [(5.0, 3.03234, 6.74302, 7.49300, 1e-5)],
        ),
    ],
    ids=["linear", "a block, by two independent programs"],
)
def test_traced_intervals_are_those_of_the_reference_tables(structure, model, rows):
    traced = trace_envelope(
        structure, sine(), [row[0] for row in rows], method=Method(model)
    )
    for omega, begin, end, no_impact, digit in rows:
        mine = [i for i in traced if i.omega == omega]
        assert [i.mode for i in mine] == ["after_impact", "no_impact"]
        assert (mine[0].a_from, mine[0].a_to, mine[1].a_from) == pytest.approx(
            (begin, end, no_impact), abs=0.51 * digit
        )
        assert mine[1].a_to is None


@pytest.mark.slow
def test_every_interval_of_a_fine_raster_is_traced():
    omega, amplitude = 0.4983, np.linspace(1, 1.1, 10_001)
    outcome = linear_response(sine(), amplitude, omega, 0.9).outcome
    traced = trace_envelope(
        dimensionless_oscillator(eta=0.9), sine(), [omega], a_max=1.1
    )
    inside = np.zeros(amplitude.size, dtype=bool)
    for i in traced:
        inside |= (amplitude > i.a_from) & (amplitude < (i.a_to or np.inf))
    assert len(traced) > 3
    wrong = np.flatnonzero(inside != overturned(outcome))
    runs = np.split(wrong, np.flatnonzero(np.diff(wrong) > 1) + 1)
    assert max((r.size for r in runs if r.size), default=0) * 1e-5 < 1e-3


def test_boundaries_are_where_the_outcome_changes():
    for i in trace_envelope(
        dimensionless_oscillator(eta=0.8), cosine(1), [2.0, 4.0], a_max=10
    ):
        for edge in (i.a_from, i.a_to):
            if edge is not None:
                below, above = linear_response(
                    cosine(1), edge * np.array([1 - 1e-12, 1 + 1e-12]), i.omega, 0.8
                ).outcome
                assert below != above


def test_no_worker_is_refused():
    with pytest.raises(UsageError, match="`workers`: found 0"):
        trace_envelope(dimensionless_oscillator(eta=0.9), sine(), [2.0], workers=0)


@pytest.mark.parametrize("a_max", [1.0, 0.0, -3.0, np.nan, np.inf, 1e9])
def test_a_max_must_make_sense(a_max):
    with pytest.raises(UsageError, match="a-max"):
        trace_envelope(dimensionless_oscillator(eta=0.9), sine(), [2.0], a_max=a_max)


@pytest.mark.requirement(
    "A column falls where discrete elements do",
    "envelopes/capacity.py",
    "Column under a rectangular impulse of 0.4 s",
    "Column under a rectangular impulse of 0.8 s",
)
def test_a_column_against_discrete_elements():
    # Multi-drum column 1.11/0.90 m wide and 5.95 m high under the rectangular impulse:
    # collapse on a raster of 0.01 g by UDEC, LMGC90 and HybriDFEM, at t_p = 0.4, 0.5,
    # 0.6, 0.8, 1.0 s.
    column = built(
        "kind: prism\ncorners: [[0, 0], [1.11, 0], [1.005, 5.95], [0.105, 5.95]]"
    )
    series = [
        (0.31, 0.30, 0.29),
        (0.27, 0.25, 0.25),
        (0.25, 0.24, 0.23),
        (0.22, 0.22, 0.22),
        (0.20, 0.21, 0.21),
    ]
    omegas = 2 * math.pi / np.array([0.4, 0.5, 0.6, 0.8, 1.0]) / column.p
    found = trace_envelope(
        column,
        pulse("rectangular-impulse"),
        omegas,
        method=Method("nonlinear", 1e-8),
        a_max=2.5,
    )
    first = [min(i.a_from for i in found if i.omega == w) for w in omegas]
    collapse_at = [
        math.ceil(100.0 * column.ground_acceleration(a) / 9.81) / 100.0 for a in first
    ]
    assert collapse_at == [0.30, 0.26, 0.24, 0.22, 0.21]
    for ours, theirs in zip(collapse_at, series, strict=True):
        assert [ours] * 3 == pytest.approx(theirs, rel=0.05 + 1e-12, abs=0)


UNEQUAL = built("kind: prism\ncorners: [[0, 0], [1.2, 0], [0.9, 5], [0.2, 5]]")
WALL = built("kind: block\nwidth: 1.2\nheight: 8\none_sided: true")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("structure", "model"),
    [
        (UNEQUAL, "linear"),
        (WALL, "nonlinear"),
        pytest.param(UNEQUAL, "nonlinear", marks=pytest.mark.soak),
    ],
    ids=["unequal, linear", "one side", "unequal"],
)
def test_the_worse_sign_lists_what_overturns_under_either(structure, model):
    method, omega, top = Method(model), 4.0, 3.0
    plus, minus, worse = (
        trace_envelope(structure, sine(), [omega], method=method, a_max=top, sign=s)
        for s in ("+", "-", "worse")
    )
    assert plus != minus
    amplitudes = np.linspace(1.01, top, 40)
    inside = [
        [
            any(i.a_from < x < (i.a_to or np.inf) for i in found)
            for x in amplitudes.tolist()
        ]
        for found in (plus, minus, worse)
    ]
    assert inside[2] == [one or other for one, other in zip(*inside[:2], strict=True)]
    for found, motion in zip(inside, (sine(), sine().scaled(-1.0)), strict=False):
        answer = response(
            method.system_of(structure), motion, amplitudes, omega, structure.eta
        )
        assert found == overturned(answer.outcome).tolist()


def test_signs_of_a_symmetric_body_are_alike_and_unknown_ones_refused():
    block = dimensionless_oscillator(eta=0.9)
    assert trace_envelope(block, sine(), [4.0], sign="-") == trace_envelope(
        block, sine(), [4.0]
    )
    with pytest.raises(UsageError, match=r"`sign`: found 'up'; expected \+, -, worse"):
        trace_envelope(block, sine(), [4.0], sign="up")


def test_a_push_to_the_backing_never_overturns_a_wall():
    assert trace_envelope(WALL, pulse("rectangular"), [1.0], sign="+") == []
    assert (
        trace_envelope(WALL, pulse("rectangular"), [1.0], sign="-")[0].mode
        == "no_impact"
    )


def test_what_the_linear_equation_misjudges_is_the_width_of_the_difference():
    def rows(*ends):
        return [
            {"Omega": 2.0, "A_from": low, "A_to": high, "mode": "after_impact"}
            for low, high in ends
        ]

    lengths = misjudged(
        rows((1.0, 2.0), (4.0, None)), rows((1.5, 3.0), (5.0, None)), a_max=8.0
    )
    said = misjudged_in_words(*lengths, a_max=8.0)
    assert said.startswith(
        "the linear equation is unsafe over 22.2 % of the amplitudes"
    )  # 1 of 1.5 + 3
    assert said.endswith("falls over 1.5 in A where the body stands")


def test_a_body_that_leaves_the_ground_has_an_interval_of_its_own():
    """The linear point mass of alpha = 1 under a rectangular push that ends tau = 2
    pi/Omega after the uplift: u = alpha (A - 1)(cosh - 1) there, and Fz = 1 - alpha
    sin(alpha) - u'^2 cos(alpha) at the impact after it.
    """
    omega, body = (
        8.0,
        RockingParameters(
            name="m",
            structure="point_mass",
            p=2.0,
            alpha=1.0,
            eta=0.9,
            uplift=math.tan(1.0),
            a_scale=1.0,
            arm=9.81 / 4.0,
        ),
    )
    lost, *falls = trace_envelope(body, pulse("rectangular"), [omega], a_max=6.0)
    y, v = math.cosh(2.0 * math.pi / omega) - 1.0, math.sinh(2.0 * math.pi / omega)
    square = (1.0 - math.sin(1.0)) / math.cos(1.0)  # of u' = y' there
    begin = (-y + math.sqrt(y * y + (v * v - y * y) * square)) / (v * v - y * y)
    assert (lost.mode, lost.a_from) == (
        "lost_contact",
        pytest.approx(1.0 + begin, rel=1e-13),
    )
    alone, *_ = trace_envelope(
        replace(body, arm=None), pulse("rectangular"), [omega], a_max=6.0
    )
    assert falls[0].a_from == lost.a_to == alone.a_from
