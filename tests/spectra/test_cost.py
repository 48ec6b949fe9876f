"""What a run will take: said before a long one; one without end is refused, with the number, before anything is computed or printed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.documents import built

from rocking_cli import Axis, RockingParameters, UsageError, dimensionless_oscillator, parse_grid, sine, write_spectrum
from rocking_cli.dynamics.method import Method
from rocking_cli.envelopes.envelope import check_intervals
from rocking_cli.spectra import sweep
from rocking_cli.spectra.cost import announce, expected_seconds

BLOCK = "kind: block\nwidth: 1\nheight: 5\nrestitution: 0.9"
ARCH = "kind: arch\nradius: 10 m\nthickness: 1.5 m\nangle: 157.5 deg\nrestitution: 0.9"


@pytest.mark.parametrize(
    ("seconds", "workers", "words"),
    [
        (61.0, 1, "it: up to roughly 61 s"),
        (600.0, 2, "it: up to roughly 5 min on 2 processes"),
        (7200.0, 1, "it: up to roughly 2 h"),
        (86400.0 * 3.14, 1, "it: up to roughly 3.1 days"),
        (86400.0 * 365.25 * 8, 2, "it: up to roughly 4 years on 2 processes"),
    ],
)
def test_a_long_run_is_told_in_words(seconds, workers, words):
    said: list[str] = []
    announce(seconds, "it", workers, said.append)
    assert said == [words]


def test_a_minute_is_not_worth_a_line():
    said: list[str] = []
    announce(59.0, "it", 1, said.append)
    announce(119.0, "it", 2, said.append)
    announce(1e6, "it", 1, None)
    assert said == []


def test_ten_years_are_refused_with_the_number():
    with pytest.raises(UsageError, match=r"^they take roughly 63 years of a processor, accepted are up to 10 years$"):
        announce(2e9, "they", 1, None)


def test_cells_batches_checks_and_segments_add_up():
    block, arch = built(BLOCK), built(ARCH)
    linear, nonlinear = Method(), Method("nonlinear")
    one = expected_seconds(linear, block, 3, cells=1000, batches=1, checked=4)
    assert expected_seconds(linear, block, 6, cells=2000, batches=2, checked=8) == pytest.approx(4 * one)
    assert one == expected_seconds(linear, arch, 3, cells=1000, batches=1, checked=4)
    costs = [expected_seconds(*who, 3, cells=1000, batches=1) for who in ((linear, block), (nonlinear, block), (nonlinear, arch))]
    assert costs == sorted(costs)
    assert len(set(costs)) == 3


def test_a_sweep_says_what_it_will_take(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep, "_sweep", lambda *_: pytest.fail("computed"))
    said: list[str] = []

    def tell(line: str) -> None:
        said.append(line)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_spectrum([dimensionless_oscillator(0.9)], sine(1e5), parse_grid("A=1:2:2,Omega=1:2:2"), tmp_path / "s.h5", tell=tell)
    assert said == ["4 cells under 200001 segments of shaking, 4 of them checked: up to roughly 43 min"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--cycles", "1e5", "--grid", "A=1:20:100000,Omega=1:20:100000"], "years of a processor, accepted are up to 10 years"),
        (["--chunk", "1", "--grid", "A=1:20:10000,Omega=1:20:10000"], "100000000 units of work of 1 cells, accepted are up to 1000000"),
        (["--scheduler", "bogus", "--grid", "A=1:2:3,Omega=1:2:3"], "accepted is HOST:PORT"),
    ],
)
def test_a_sweep_without_end_is_refused(arguments, words, refused):
    assert words in refused(2, "spectrum", "--eta", "0.9", *arguments, "-o", "s.h5")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--grid", "f_g=1:2:2"], "no units"),
        (["--grid", "f_g=1:2:2", "--closed-form"], "no units"),
        (["--grid", "Omega=1:2:1000000", "--cycles", "1e5", "--a-max", "1e5"], "years of a processor"),
        (["--grid", "Omega=1:2:2", "--model", "nonlinear"], "needs a critical angle"),
    ],
)
def test_an_envelope_is_refused_before_its_first_row(arguments, words, refused, tmp_path):
    (tmp_path / "b.yaml").write_text(BLOCK)
    assert words in refused(2, "envelope", "b.yaml", "--eta", "0.9", *arguments)


def test_a_scan_of_bodies_that_hardly_lose_speed_is_said_to_be_long():
    told = []
    for eta in (0.9, 0.9999999, 1.0):
        check_intervals(dimensionless_oscillator(eta), sine(5), Axis("Omega", np.array([3.0])), tell=told.append)
    assert len(told) == 2
    assert all("up to roughly" in line for line in told)


def test_cells_checked_by_the_general_solver_cost_more():
    plain = RockingParameters("b", "block", 2.0, 0.2, 0.9, 0.2, 1.0)
    counts = {"segments": 1000, "cells": 10, "batches": 1, "checked": 4}
    assert expected_seconds(Method(), replace(plain, damping=0.05), **counts) > 3.0 * expected_seconds(Method(), plain, **counts)


def test_through_records_cells_fly_at_the_cost_of_their_impacts():
    block, counts = built(BLOCK), {"cells": 10**4, "batches": 1, "record": True}
    assert expected_seconds(Method(), block, 42_000, **counts) == pytest.approx(expected_seconds(Method(), block, 2000, **counts), rel=0.02)
    assert expected_seconds(Method(), block, 2000, **counts) < expected_seconds(Method("nonlinear"), block, 2000, **counts)
    damped = replace(block, damping=0.05)
    assert expected_seconds(Method(), damped, 4000, **counts) == 2.0 * expected_seconds(Method(), damped, 2000, **counts)


def test_through_records_other_equations_walk_at_a_fraction_of_the_march():
    block, counts = built(BLOCK), {"cells": 10**4, "batches": 1}
    for method, structure in ((Method("nonlinear"), block), (Method(), replace(block, damping=0.05))):
        walked, marched = (expected_seconds(method, structure, 2000, record=record, **counts) for record in (True, False))
        assert 0.01 * marched < walked < 0.2 * marched
