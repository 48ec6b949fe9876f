"""Turns of a series, against the roots of its derivative by eigenvalues."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli.dynamics.equations.taylor import TaylorSeries
from rocking_cli.dynamics.march.turns import falls_through_zero, keeps_sense


@pytest.mark.parametrize("bent", [0.05, 0.5, 4.0])  # hardly, monotone, with several turns
def test_every_fall_of_the_speed_through_zero_has_a_bracket_of_its_own(bent):
    random, lanes = np.random.default_rng(7), 150
    terms = random.normal(size=(9, lanes)) * bent ** np.maximum(np.arange(9.0) - 2.0, 0.0)[:, None] / 2.0 ** np.arange(9.0)[:, None]
    unit, reach = random.uniform(0.5, 2.0, lanes), random.uniform(0.5, 1.5, lanes)
    series = TaylorSeries(terms, unit, reach, 1.0 / unit)
    which, low, high = falls_through_zero(series, reach, np.arange(lanes))
    kept = keeps_sense(series, reach, series.bent(reach)[1])
    found = 0
    for lane in range(lanes):
        speed = np.polynomial.Polynomial(terms[:, lane]).deriv()
        roots = speed.roots()
        roots = np.sort(roots.real[np.abs(roots.imag) < 1e-9]) * unit[lane]
        assert not (kept[lane] and np.any((roots >= 0.0) & (roots <= reach[lane]))), lane
        falls = [t for t in roots if 0.0 < t < reach[lane] and speed.deriv()(t / unit[lane]) < 0.0]
        mine = which == lane
        assert mine.sum() == len(falls), lane
        assert all(a <= t <= b for a, t, b in zip(low[mine], falls, high[mine], strict=True))
        found += len(falls)
    assert found > 5
    assert np.count_nonzero(kept) > (10 if bent < 4.0 else 0)
    alone = falls_through_zero(series, reach, which[:1])
    assert [x.tolist() for x in alone] == [x[which == which[0]].tolist() for x in (which, low, high)]
