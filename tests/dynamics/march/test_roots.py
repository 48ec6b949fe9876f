"""Impact times and turning points on arcs whose roots are known:
polynomials in time.
"""

import numpy as np
import pytest

from rocking_cli.dynamics.equations.taylor import TaylorSeries
from rocking_cli.dynamics.march.roots import falls_through_zero, sense


@pytest.mark.parametrize(
    "growth", [0.05, 0.5, 4.0]
)  # hardly, monotone, with several turns
def test_every_fall_of_the_speed_through_zero_has_a_bracket_of_its_own(growth):
    random, lanes = np.random.default_rng(7), 400
    terms = (
        random.normal(size=(9, lanes))
        * growth ** np.maximum(np.arange(9.0) - 2.0, 0.0)[:, None]
        / 2.0 ** np.arange(9.0)[:, None]
    )
    unit, reach = random.uniform(0.5, 2.0, lanes), random.uniform(0.5, 1.5, lanes)
    series = TaylorSeries(terms, unit, reach, 1.0 / unit)
    none = np.zeros(0, dtype=np.int64)
    end, most = series.at_with_chord_errors(reach)
    kept, monotone = sense(series, reach, end, most)
    once = monotone & (series.v > 0.0) & (end.v <= 0.0)
    which, low, high = falls_through_zero(
        series, reach, np.flatnonzero(~monotone), np.flatnonzero(once)
    )
    everywhere = falls_through_zero(series, reach, np.arange(lanes), none)[0]
    assert np.array_equal(which, everywhere)
    found = 0
    for lane in range(lanes):
        speed = np.polynomial.Polynomial(terms[:, lane]).deriv()
        roots = speed.roots()
        roots = np.sort(roots.real[np.abs(roots.imag) < 1e-9]) * unit[lane]
        assert not (kept[lane] and np.any((roots >= 0.0) & (roots <= reach[lane]))), (
            lane
        )
        turns = speed.deriv().roots()
        turns = turns.real[np.abs(turns.imag) < 1e-9] * unit[lane]
        assert not (monotone[lane] and np.any((turns > 0.0) & (turns < reach[lane]))), (
            lane
        )
        falls = [
            t
            for t in roots
            if 0.0 < t < reach[lane] and speed.deriv()(t / unit[lane]) < 0.0
        ]
        mine = which == lane
        assert mine.sum() == len(falls), lane
        assert all(
            a <= t <= b for a, t, b in zip(low[mine], falls, high[mine], strict=True)
        )
        found += len(falls)
    assert found > 5
    assert np.count_nonzero(kept) > (10 if growth < 4.0 else 0)
    assert np.count_nonzero(monotone) > 10 or growth == 4.0
    alone = falls_through_zero(
        series, reach, *((none, which[:1]) if monotone[which[0]] else (which[:1], none))
    )
    assert [x.tolist() for x in alone] == [
        x[which == which[0]].tolist() for x in (which, low, high)
    ]


@pytest.mark.parametrize("dip", [0.98, 1.02])
def test_a_proof_goes_as_far_as_a_parabola_that_hardly_comes_to_zero(dip):
    """Of s (1 - 4 d t (1 - t)), t = h / reach, as y' and as y''."""
    reach, s = np.array([0.4, 0.4, 1.7, 1.7]), np.array([1.0, -1.0, 2.0, -0.1])
    parabola = (
        np.array([0.0, 1.0, -2.0 * dip, 4.0 * dip / 3.0])[:, None] * s
    )  # integrated
    turned = np.append(
        np.zeros((1, 4)), parabola / np.array([[1.0], [2.0], [3.0], [4.0]]), axis=0
    )
    for part, terms in enumerate((parabola * reach, turned * reach**2)):
        series = TaylorSeries(
            np.append(terms, np.zeros((5 - len(terms), 4)), axis=0),
            reach,
            reach,
            1.0 / reach,
        )
        assert np.all(
            sense(series, reach, *series.at_with_chord_errors(reach))[part]
            == (dip < 1.0)
        )
