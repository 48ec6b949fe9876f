"""The search along one frequency: what it leaves out changes nothing."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from rocking_cli import (
    LinearEquation,
    Method,
    Outcome,
    RigidBodyEquation,
    System,
    cosine,
    dimensionless_oscillator,
    linear_response,
    load_structures,
    pulse,
    sine,
    trace_envelope,
)
from rocking_cli.dynamics.contacts.contact import OneSided, Symmetric, Unequal
from rocking_cli.dynamics.outcome import safe
from rocking_cli.envelopes import changes
from rocking_cli.envelopes.amplitudes import ScanGrid
from rocking_cli.envelopes.boundaries import Search

MOTIONS = [
    sine(),
    sine(0.5),
    sine(2),
    cosine(1.5),
    pulse("rectangular"),
    pulse("rectangular-impulse"),
    pulse("ricker-symmetric"),
]


OSCILLATOR = System(LinearEquation(), Symmetric(0.9))
BODIES = {
    "oscillator": OSCILLATOR,
    "lossless body": System(RigidBodyEquation(0.6), Symmetric(1.0)),
    "damped body": System(RigidBodyEquation(0.3, damping=0.05), Symmetric(0.9)),
    "unlike edges": System(
        RigidBodyEquation((0.25, 0.2)),
        Unequal(
            drive=(1.0, 0.8),
            omega=(1.0, 1.15),
            eta=(1.05, 0.9),
            rotation=(math.sin(0.25) / 0.25, math.sin(0.2) / 0.2),
        ),
    ),
    "one side": System(RigidBodyEquation(0.5), OneSided(-0.9)),
    "arch": Method("nonlinear")
    .system_of(load_structures("configs/arch.yaml")[0])
    .with_restitution(0.9),
}


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize(
    "motion",
    [
        sine(0.5),
        *(pytest.param(m, marks=pytest.mark.soak) for m in (sine(), MOTIONS[-1])),
    ],
    ids=lambda m: m.name,
)
def test_nothing_overturns_where_the_scan_does_not_look_below(motion, name):
    """And half a sine that is short overturns some bodies at half as much again."""
    system, omegas = BODIES[name], np.geomspace(0.5, 60.0, 10)
    search = Search(system, motion.scaled(-1.0) if name == "one side" else motion, 60.0)
    bound = search.grid.amplitude(search._last_safe_point(omegas))
    below = search.outcome(bound * np.linspace(0.7, 1.0, 4)[:, None], omegas)
    assert np.all(below == Outcome.ROCKED)
    if motion.name == sine(0.5).name:
        assert np.count_nonzero(~safe(search.outcome(1.5 * bound, omegas))) > 1


@pytest.mark.parametrize("motion", MOTIONS[:6], ids=lambda m: m.name)
def test_above_overturning_without_impact_there_is_nothing_else(motion):
    random = np.random.default_rng(10)
    omega, eta = random.uniform(0.3, 12.0, 1000), random.uniform(0.0, 1.0, 1000)
    amplitude = random.uniform(1.0, 30.0, 1000)
    over = np.flatnonzero(
        linear_response(motion, amplitude, omega, eta).outcome
        == Outcome.OVERTURNED_NO_IMPACT
    )
    assert over.size > 100
    for factor in (1.001, 1.1, 2.0, 10.0):
        above = linear_response(
            motion, factor * amplitude[over], omega[over], eta[over]
        ).outcome
        assert set(above.tolist()) == {Outcome.OVERTURNED_NO_IMPACT}


class Plain(LinearEquation):
    """The linear oscillator, of which the search does not know that nothing returns
    above.
    """

    def __init__(self):
        super().__init__()
        self.bounded = False


class Exhaustive(Search):
    """A search that looks at every small amplitude."""

    safe_impulse = 0.0


class Above(Search):
    """A search that begins at A = 3."""

    def _last_safe_point(self, omegas):
        return self.grid.below(np.full(omegas.size, 3.0))


def same_changes(spared, every):
    """Rows with equal outcomes, which change at amplitudes that differ by what rounding
    leaves open, a few last digits.
    """
    assert [[label for _, label in row] for row in spared] == [
        [label for _, label in row] for row in every
    ]
    ends = [
        np.array([amplitude for row in rows for amplitude, _ in row])
        for rows in (spared, every)
    ]
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-14, atol=0)


def random_search(number):
    """A motion, a restitution, four Omega and the least number of changes."""
    random = np.random.default_rng(number)
    motion = [sine(), sine(0.5), pulse("rectangular-impulse"), cosine(1), cosine(0.5)][
        number % 5
    ]
    return pytest.param(
        motion,
        float(random.uniform(0.2, 1.0)),
        random.uniform(0.5, 9.0, 4),
        1,
        marks=pytest.mark.soak,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("motion", "eta", "omegas", "least"),
    [
        (sine(), 0.9, np.array([2.3, 5.0]), 3),
        *(
            pytest.param(
                motion, 0.9, np.array([2.3, 5.0, 9.1]), 3, marks=pytest.mark.soak
            )
            for motion in (cosine(1), sine(0.5))
        ),
        *map(random_search, range(30)),
    ],
)
def test_what_the_scan_leaves_out_changes_nothing(motion, eta, omegas, least):
    spared = Search(OSCILLATOR.with_restitution(eta), motion, 16.0).rows(omegas)
    every = Exhaustive(System(Plain(), Symmetric(eta)), motion, 16.0).rows(omegas)
    same_changes(spared, every)
    assert sum(len(row) - 1 for row in spared) >= least


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param("unlike edges", marks=pytest.mark.soak), "one side"]
)
def test_what_the_scan_leaves_out_below_changes_nothing(name):
    system, omegas = BODIES[name], np.array([9.0])
    spared, every = (
        kind(system, sine(1.5), 2.5).rows(omegas) for kind in (Search, Exhaustive)
    )
    assert spared == every


@pytest.mark.soak
def test_where_changes_have_no_end_only_those_that_the_scan_sees_are_traced(
    monkeypatch,
):
    def traced() -> list:
        return trace_envelope(
            dimensionless_oscillator(eta=0.9), sine(3), [1.0], a_max=1.12, workers=1
        )

    every = traced()
    monkeypatch.setattr(changes, "_MOST_CHANGES", 10)
    some = traced()
    ends = [{x for i in found for x in (i.a_from, i.a_to)} for found in (every, some)]
    assert ends[1] < ends[0]
    for wide in (i for i in every if (i.a_to or 1.12) - i.a_from > 1e-3):
        middle = 0.5 * (wide.a_from + (wide.a_to or 1.12))
        assert [i.mode for i in some if i.a_from < middle < (i.a_to or 1.12)] == [
            wide.mode
        ]


def test_a_narrow_interval_under_several_cycles_is_found():
    """Overturning from 3.029878 to 3.030776 lies between two amplitudes of the scan,
    with equal outcomes.
    """
    (row,) = Above(OSCILLATOR, sine(5), a_max=3.1).rows(np.array([3.0]))
    below, above = (
        [c for c in row[1:] if (c[0] > 3.0303) == up] for up in (False, True)
    )
    (begins, label), (ends, after) = max(below), min(above)
    assert (begins, ends) == pytest.approx((3.029878, 3.030776), abs=1e-6)
    assert not Outcome(label).safe
    assert Outcome(after).safe


@pytest.mark.slow
@pytest.mark.parametrize(
    ("motion", "eta", "omega", "a_max", "least"),
    [
        pytest.param(sine(5), 0.84645, 2.76515, 2.2, 30, marks=pytest.mark.soak),
        pytest.param(sine(2.5), 0.93413, 1.9, 1.5, 10, marks=pytest.mark.soak),
        (cosine(2.5), 0.7, 2.5, 2.0, 4),
    ],
    ids=lambda x: getattr(x, "name", x),
)
def test_no_interval_wider_than_1e_4_is_missed_under_several_cycles(
    motion, eta, omega, a_max, least
):
    """Against a raster whose points are 2.5e-5 apart. An interval of five points is
    missed where the envelope has another outcome all over it, and a raster of 1e-6
    shows that nothing narrower cuts it in two.
    """
    amplitude = np.arange(1.0, a_max, 2.5e-5)
    raster = linear_response(motion, amplitude, omega, eta, peaks=False).outcome
    raster[raster == Outcome.NO_UPLIFT] = Outcome.ROCKED
    traced = np.full(amplitude.size, Outcome.ROCKED, dtype=np.uint8)
    for i in trace_envelope(
        dimensionless_oscillator(eta=eta), motion, [omega], a_max=a_max, workers=1
    ):
        inside = slice(
            *np.searchsorted(amplitude, [i.a_from, a_max if i.a_to is None else i.a_to])
        )
        traced[inside] = next(o for o in Outcome if o.mode == i.mode)
    ends = np.concatenate([[0], np.flatnonzero(np.diff(raster)) + 1, [raster.size]])
    wide = [(a, b) for a, b in pairwise(ends) if b - a >= 5]
    assert len(wide) >= least
    for a, b in wide:
        if not np.any(traced[a:b] == raster[a]):
            inside = np.arange(amplitude[a], amplitude[b - 1], 1e-6)
            assert np.ptp(linear_response(motion, inside, omega, eta).outcome) > 0, (
                amplitude[a],
                amplitude[b - 1],
            )


def test_amplitudes_beyond_any_whole_number_lie_above_the_last_point():
    scan = ScanGrid.between(1.0, 20.0)
    assert scan.below(np.array([1e25, 1e308])).tolist() == [scan.size - 1] * 2
