"""Capacity against a demand: the closed form's boundaries, on whichever side of them
the demand lies.
"""

from __future__ import annotations

import numpy as np
import pytest
from support.documents import built
from support.synthetic_records import motion_of_samples, noise

from rocking_cli import (
    LinearEquation,
    System,
    UsageError,
    build_structure,
    dimensionless_oscillator,
    parse_documents,
    pulse,
    response,
    sine,
)
from rocking_cli.dynamics.contacts.contact import Symmetric
from rocking_cli.dynamics.method import LINEAR, Method
from rocking_cli.dynamics.outcome import safe
from rocking_cli.envelopes.capacity import CapacitySearch, capacities
from rocking_cli.envelopes.narrow_falls import FallSearch, side_by_side

BLOCK = build_structure(
    parse_documents("kind: block\nradius: 1.6065856\nalpha: 0.25\nrestitution: 0.9")[0]
)  # p = 2.14 rad/s


@pytest.mark.parametrize(
    ("structure", "method", "edges"),
    [
        (dimensionless_oscillator(eta=0.9), LINEAR, (3.01860, 6.31807, 7.16813)),
        (BLOCK, Method("nonlinear"), (3.03234, 6.74302, 7.49300)),
    ],
    ids=["linear", "nonlinear"],
)
def test_reference_values_at_omega_5(structure, method, edges):
    first, until, again = edges
    demands = (
        (0.5, first),
        (2.0, first),
        (4.0, None),
        (0.5 * (until + again), again),
        (8.0, None),
    )
    for demand, safe_to in demands if method.exact else demands[1:4]:
        found = CapacitySearch(structure, sine(), demand, 5.0, method, 20.0).capacity()
        assert found.first == pytest.approx(first, abs=5.1e-6)
        assert found.safe_to == (
            None if safe_to is None else pytest.approx(safe_to, abs=5.1e-6)
        )


def test_a_demand_on_either_side_of_a_boundary_is_told_apart_to_the_last_digits():
    edge = (
        CapacitySearch(
            dimensionless_oscillator(eta=0.9), sine(), 2.0, 5.0, LINEAR, 20.0
        )
        .capacity()
        .first
    )
    below, above = (
        CapacitySearch(
            dimensionless_oscillator(eta=0.9),
            sine(),
            edge * (1.0 + s * 1e-14),
            5.0,
            LINEAR,
            20.0,
        ).capacity()
        for s in (-1, 1)
    )
    assert below.safe_to == pytest.approx(edge, rel=1e-14, abs=0)
    assert above.safe_to is None
    assert below.first == pytest.approx(edge, rel=1e-14, abs=0)
    assert above.first == pytest.approx(edge, rel=1e-14, abs=0)


def test_rectangular_pulse():
    """A = 1/(1 - exp(-p t_d)), with Omega = 2 pi / (p t_d)."""
    for duration, first in ((0.5, 2.54149), (1.0, 1.58198), (2.0, 1.15652)):
        found = CapacitySearch(
            dimensionless_oscillator(eta=0.0),
            pulse("rectangular"),
            1.05,
            2.0 * np.pi / duration,
            LINEAR,
            20.0,
        ).capacity()
        assert (found.uplift, found.first) == (1.0, pytest.approx(first, abs=5.1e-6))


def test_nothing_overturns_up_to_the_limit():
    found = CapacitySearch(
        dimensionless_oscillator(eta=0.9), sine(), 1.5, 30.0, LINEAR, 5.0
    ).capacity()
    assert (found.first, found.safe_to, found.uplift) == (None, None, 1.0)
    assert (
        CapacitySearch(dimensionless_oscillator(eta=0.9), sine(), 0.1, 5.0, LINEAR, 0.5)
        .capacity()
        .first
        is None
    )


def test_a_body_against_its_backing_is_not_lifted_by_a_push_inwards():
    (document,) = parse_documents("kind: block\nwidth: 1.2\nheight: 8\none_sided: true")
    push = pulse("rectangular")
    assert (
        CapacitySearch(build_structure(document), push, 3.0, 1.0, LINEAR, 20.0)
        .capacity()
        .uplift
        is None
    )
    assert (
        CapacitySearch(
            build_structure(document), push.scaled(-1.0), 3.0, 1.0, LINEAR, 20.0
        )
        .capacity()
        .uplift
        == 1.0
    )


@pytest.mark.parametrize("demand", [6e4, 1e300])
def test_a_demand_beyond_the_scan_is_refused(demand):
    with pytest.raises(UsageError, match="expected up to 100000"):
        CapacitySearch(
            dimensionless_oscillator(eta=0.9), sine(), demand, 5.0, LINEAR, 20.0
        ).capacity()


# Falls [m/s2] of a block of 0.5 x 2.5 m under a record, found on a raster of 5e-5; from
# 3.3264 on every other stretch of 0.002 falls.
NARROW = [
    (3.16735, 3.16755),
    (3.18105, 3.18145),
    (3.18275, 3.18330),
    (3.22525, 3.22575),
    (3.2367, 3.23865),
]


def search_of(fall, approximate=None):
    """A search in which those amplitudes fall for which `fall` is true; by its scan
    those for which `approximate` is true.
    """
    return FallSearch(
        lambda a: np.array([fall(x) for x in a], dtype=bool),
        lambda a: np.array([(approximate or fall)(x) for x in a], dtype=bool),
        1e-9,
    )


def first(search, begin, end):
    return side_by_side([(search, search.first(begin, end))])[0]


def falls(a):
    return any(low <= a <= high for low, high in NARROW) or (
        a >= 3.3264 and int((a - 3.3264) / 0.002) % 2 == 0
    )


@pytest.mark.parametrize(
    "shift",
    [0.0, 1e-4, -1e-4],
    ids=["by the march", "by a scan that lags", "by a scan that leads"],
)
def test_the_lowest_of_six_narrow_falls_is_found_under_a_record(shift):
    found = search_of(falls, lambda a: falls(a * (1.0 + shift)))
    assert first(found, 1.962, 40.0) == pytest.approx(3.16735, rel=1e-9, abs=0)
    assert first(found, 3.24, 40.0) == pytest.approx(3.3264, rel=1e-9, abs=0)
    assert first(found, 1.962, 3.1) == np.inf
    assert found.share_of_falls(3.3264) == pytest.approx(0.5, abs=0.05)


def test_a_scan_that_sees_no_fall_is_held_against_the_march():
    found = search_of(lambda a: a >= 3.3, lambda a: False)
    assert first(found, 1.962, 40.0) == pytest.approx(3.3, rel=1e-9, abs=0)
    misled = search_of(lambda a: False, lambda a: a > 3.0)
    assert first(misled, 1.962, 5.0) == np.inf


def test_the_share_of_falls_is_0_in_one_wide_interval():
    found = search_of(lambda a: a >= 3.3)
    assert first(found, 3.0, 4.0) == pytest.approx(3.3, rel=1e-9, abs=0)
    assert found.share_of_falls(3.3) == 0.0


def test_the_lowest_fall_under_a_record_is_cut_to_its_last_digits():
    motion, system = (
        motion_of_samples(noise(100, 0.05, 1)[30:60], 0.05),
        System(LinearEquation(), Symmetric(0.9)),
    )
    found = FallSearch.of(system, motion, 0.4, 1e-9)
    lowest = first(found, 1.02, 8.0)
    assert found.falls(lowest * (1.0 - 3e-9 * np.arange(2.0))).tolist() == [True, False]
    below = np.linspace(0.9 * lowest, lowest * (1.0 - 1e-8), 100)
    assert safe(response(system, motion, below, 0.4, peaks=False).outcome).all()


@pytest.mark.soak
@pytest.mark.parametrize(
    ("dt", "seed"),
    [
        (0.06, 2),
        *(
            pytest.param(*case, marks=pytest.mark.soak)
            for case in ((0.06, 4), (0.01, 2), (0.01, 5))
        ),
    ],
)
def test_a_scan_leads_to_the_fall_that_the_march_finds(dt, seed):
    motion, oscillator = (
        motion_of_samples(noise(int(15.0 / dt), dt, seed), dt),
        dimensionless_oscillator(eta=0.9),
    )
    system = LINEAR.system_of(oscillator)
    march = FallSearch.of(system, motion, 0.4, 1e-6)
    march.approximate_falls = lambda a: (
        ~safe(response(system, motion, a, 0.4, peaks=False).outcome)
    )
    found = CapacitySearch(oscillator, motion, 1.6, 0.4, LINEAR, 4.0).capacity()
    assert found.first is not None
    assert found.first == pytest.approx(
        first(march, found.uplift, 4.0), rel=2e-6, abs=0
    )  # each is traced to 1e-6


def test_the_lowest_of_narrow_falls_does_not_depend_on_the_one_that_was_found():
    """A third of all amplitudes from 1.292 on fall, in intervals 1e-5 wide."""

    search = search_of(lambda a: a >= 1.292 and np.floor((a - 1.292) / 1e-5) % 3 == 0)
    for found in (1.292454, 1.294843, 1.38):
        assert search.lowest_and_share(1.1, found) == (
            pytest.approx(1.292, rel=1e-9, abs=0),
            pytest.approx(1.0 / 3.0, rel=0.4),
        )
    assert search.lowest_and_share(1.1, 1.2) == (1.2, 0.0)


@pytest.mark.slow
def test_no_capacity_depends_on_the_searches_beside_it():
    """A slender body, one that may lose contact, and one of unequal sides."""
    motions = [motion_of_samples(noise(220, 0.03, seed), 0.03) for seed in (1, 2, 1)]
    bodies = [
        built("kind: block\nwidth: 0.3\nheight: 1.2"),
        built("kind: block\nwidth: 1.1\nheight: 1.2\nrestitution: 0.7"),
        built("kind: rigid\nleft: 0.2\nright: 0.15\nheight: 0.6\ngyration: 0.35"),
    ]
    searches = [
        CapacitySearch(body, motion, demand, 1.0 / body.p, Method("nonlinear"), 4.0)
        for body, motion, demand in zip(bodies, motions, (1.2, 1.6, 4.0), strict=True)
    ]
    together = list(capacities(searches))
    assert [one.capacity() for one in searches] == together
    assert len({one.first for one in together}) == 3
