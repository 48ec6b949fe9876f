"""The tabulated functions of an arch: smooth from patch to patch, work the integral of the force, and the same about any other point."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli import build_structure, parse_documents
from rocking_cli.dynamics.equations.mechanism import MechanismEquation

ARCH = "kind: arch\nradius: 10 m\nthickness: 1.5 m\nangle: 157.5 deg\nvoussoirs: 7\n"
EPS = np.finfo(float).eps


@pytest.fixture(scope="module")
def equation():
    (document,) = parse_documents(ARCH)
    return MechanismEquation(build_structure(document).mechanism)


def test_patches_meet_and_begin_at_rest(equation):
    table = equation.table
    inner = table.edges[1:-1]
    for function in (table.lift, table.push, table.turn, table.work, table.thrust):
        before, after = (table.value(function, y) for y in (np.nextafter(inner, 0.0), inner))
        assert np.abs(after - before).max() < 40 * EPS * max(1.0, np.abs(after).max()) + 1e-13  # 1e-13: two fits of the linkage
    for function in (table.turn, table.work, table.thrust):
        assert table.value(function, np.zeros(1)) == 0.0


def test_work_is_the_integral_of_the_force(equation):
    table = equation.table
    y = np.random.default_rng(1).uniform(0.0, equation.limit, 500)
    for integral, function in ((table.work, table.lift), (table.thrust, table.push)):
        there = table.value(function, y)
        assert np.abs(table.slope(integral, y) - there).max() < 1e-13 * np.abs(there).max()


def test_series_about_a_point_have_the_values_beside_it(equation):
    table, random = equation.table, np.random.default_rng(2)
    y = random.uniform(0.0, 0.9 * equation.limit, 300)
    at, x = table.of(y)
    beside = y + random.uniform(-0.1, 0.1, 300) * table.half[at]
    powers = ((beside - y) / table.half[at]) ** np.arange(19)[:, None]
    for series, function in zip(equation._local(at, x, 19), (table.lift, table.push), strict=True):
        assert np.abs((series * powers).sum(axis=0) - table.value(function, np.abs(beside))).max(initial=0.0, where=beside > 0.0) < 1e-13
