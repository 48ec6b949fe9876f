"""First falls of many bodies together are those that an envelope traces for each."""

import numpy as np
import pytest

from rocking_cli import Method, cosine, load_structures, sine, trace_envelope
from rocking_cli.dynamics.outcome import Outcome, safe
from rocking_cli.dynamics.shared_march import SharedMarch
from rocking_cli.envelopes.boundaries import looks_finely
from rocking_cli.envelopes.first_falls import Climb, lowest_falls

BODIES = ("block:0.5x2", "rigid:left=0.42,right=0.31,height=1.15,gyration=0.68")
MOST = 1.4
OMEGAS = np.array([1.5, 2.0])


@pytest.mark.slow
@pytest.mark.parametrize(
    "motion",
    [sine(), pytest.param(cosine(1), marks=pytest.mark.soak)],
    ids=lambda m: m.name,
)
def test_first_falls_are_those_of_an_envelope(motion):
    """Under one cycle, and under a motion that is scanned more finely."""
    method, structures = (
        Method("nonlinear"),
        [load_structures(body)[0] for body in BODIES],
    )
    march = SharedMarch(motion, structures, [method] * len(structures))
    body = np.repeat(np.arange(len(BODIES)), OMEGAS.size)
    uplift = np.array(
        [method.system_of(one).least_uplift(motion) for one in structures]
    )
    falls = lowest_falls(
        march.of_rows(body, np.tile(OMEGAS, len(BODIES))),
        Climb(uplift[body], np.full(body.size, MOST), uplift[body]),
        1e-9,
        finely=looks_finely(motion),
    )
    traced = np.full(body.size, np.inf)
    for i, structure in enumerate(structures):
        for interval in trace_envelope(
            structure, motion, OMEGAS, method=method, a_max=MOST, sign="+", workers=1
        ):
            row = i * OMEGAS.size + int(np.searchsorted(OMEGAS, interval.omega))
            traced[row] = min(traced[row], interval.a_from)
    np.testing.assert_array_equal(np.isinf(falls.amplitude), np.isinf(traced))
    assert 2 <= np.isfinite(traced).sum() < traced.size
    fallen = np.isfinite(traced)
    np.testing.assert_allclose(falls.amplitude[fallen], traced[fallen], rtol=3e-9)
    np.testing.assert_array_equal(safe(falls.outcome), ~fallen)


# Intervals of amplitudes that fall, of each row.
FALLS = [(1.2345, 1.2356), (2.0, 3.0)], [(1.0, 1.1)], [(1.5, 1.5 + 5e-4)], [(4.1, 9.0)]


def test_an_interval_of_a_thousandth_is_found_anywhere():
    """The one of row 2 is narrower; row 3 is above the end of the search."""

    def march(row, amplitude):
        falls = [
            any(low <= a <= high for low, high in FALLS[i])
            for i, a in zip(row, amplitude, strict=True)
        ]
        outcome = np.where(falls, Outcome.LOST_CONTACT, Outcome.NO_UPLIFT)
        return outcome, np.zeros_like(row)

    for low in np.linspace(1.0, 1.23, 60):
        ends = np.full(4, low), np.full(4, 4.0), np.ones(4)
        found = lowest_falls(march, Climb(*ends), 1e-12)
        assert found.amplitude[0] == pytest.approx(1.2345, rel=1e-12, abs=0)
        assert found.amplitude[1] == (low if low <= 1.1 else np.inf)
        assert found.amplitude[2] == np.inf or 1.5 <= found.amplitude[2] <= 1.5005
        assert found.amplitude[3] == np.inf
        assert found.outcome.tolist()[0] == Outcome.LOST_CONTACT
        assert found.outcome.tolist()[3] == Outcome.ROCKED
    # A fall far above the lowest one of its rivals counts as none.
    climb = Climb(np.ones(4), np.full(4, 4.0), np.ones(4))
    found = lowest_falls(march, climb, 1e-12, rivals=np.zeros(4, dtype=int))
    assert found.amplitude.tolist() == [np.inf, 1.0, np.inf, np.inf]


def test_the_amplitudes_of_a_climb_are_close_and_end_at_the_last_one():
    rng = np.random.default_rng(3)
    for ratio in (0.0, 0.01):
        uplift = rng.uniform(0.5, 2.0, 30)
        low = uplift * np.append(rng.uniform(0.9, 1.0, 5), rng.uniform(1.0, 1.3, 25))
        high = low + np.append(0.0, rng.exponential(1.0, 29))
        climb = Climb(low, high, uplift, ratio)
        every = climb.amplitude(np.arange(30)[:, None], np.arange(20_000))
        for own, first, last, lift in zip(every, low, high, uplift, strict=True):
            own = own[np.isfinite(own)]
            begin = first if ratio else min(max(first, lift), last)
            assert (own[0], own[-1]) == (begin, last)
            steps = np.diff(own) / (own[:-1] if ratio else 1.0)
            assert np.all((steps > 0.0) & (steps <= (ratio or 1e-3) * (1.0 + 1e-9)))
