"""Stretches of amplitudes with one outcome: the march agrees at their amplitudes, and
an integration that shares no code with the bound of their paths.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.documents import built
from support.soak import quick

from rocking_cli import Outcome, sine, trace_envelope
from rocking_cli.dynamics.method import Method
from rocking_cli.dynamics.outcome import safe
from rocking_cli.dynamics.shared_march import SharedMarch
from rocking_cli.envelopes import boundaries, capacity
from rocking_cli.envelopes.boundaries import Search
from rocking_cli.envelopes.capacity import CapacitySearch, capacities
from rocking_cli.envelopes.stretches import (
    UNKNOWN,
    AmplitudeStretches,
    _Distance,
    _LeastPath,
    outcomes_of_stretches,
    proved_outcomes,
    proved_to,
)

PILLAR = built("kind: block\nwidth: 0.1\nheight: 2")
COLUMN = built("kind: block\nwidth: 0.5\nheight: 2")
STOUT = built("kind: block\nwidth: 1.2\nheight: 2\nrestitution: 0.7")
STATUE = built("kind: rigid\nleft: 0.42\nright: 0.31\nheight: 1.15\ngyration: 0.68")
NONLINEAR = Method("nonlinear")


@pytest.mark.parametrize(
    ("body", "sign"),
    [
        (PILLAR, 1.0),
        pytest.param(STOUT, 1.0, marks=pytest.mark.soak),
        (STATUE, -1.0),
        pytest.param(COLUMN, 1.0, marks=pytest.mark.soak),
        pytest.param(STATUE, 1.0, marks=pytest.mark.soak),
    ],
)
def test_what_is_proved_is_what_the_march_finds(body, sign):
    system = NONLINEAR.system_of(body)
    motion = sine() if sign > 0.0 else sine().scaled(-1.0)
    search = Search(system, motion, 20.0)
    omegas = np.array([0.7, 1.3, 2.9, 5.1, 11.0])
    amplitude = np.tile(search.grid.amplitude(np.arange(search.grid.size)), 5)
    row = np.repeat(np.arange(5), search.grid.size)
    label, first = proved_outcomes(
        lambda row, ends: outcomes_of_stretches(system, motion, omegas[row], ends),
        row,
        amplitude,
    )
    proved = label != UNKNOWN
    assert not proved[row == 0].any()
    assert proved[row == 3].mean() > 0.5
    assert Outcome.OVERTURNED_NO_IMPACT in label[proved]
    # Of the others those that stand may lose contact: they are marched.
    assert (Outcome.ROCKED in label[proved]) == (body is PILLAR)
    assert np.all(label[first[proved]] == label[proved])

    # Next to other stretches, and at every fifteenth amplitude.
    edge = np.append(first[1:] != first[:-1], True)
    some = np.flatnonzero(proved & (edge | (np.arange(row.size) % 15 == 0)))
    found, impacts = search.respond(amplitude[some], omegas[row[some]])
    np.testing.assert_array_equal(found, label[some])
    assert not impacts.any()


def integrated(alpha, amplitude, omega, until):
    """(theta/sin(alpha), its derivative by tau) under a sine cycle from the uplift to
    this phase: Eq. 2.3 by SciPy.
    """
    a = amplitude * alpha  # over g

    def slopes(tau, state):
        z = alpha - state[0]
        return state[1], -np.sin(z) + a * np.sin(omega * tau) * np.cos(z)

    begin = np.arcsin(np.tan(alpha) / a) / omega
    path = solve_ivp(
        slopes, (begin, until / omega), [0.0, 0.0], "DOP853", rtol=1e-11, atol=1e-13
    )
    return path.y[:, -1] / np.sin(alpha)


@pytest.mark.parametrize("omega", [1.3, 9.0])
@pytest.mark.parametrize("until", [2.5, np.pi, 2.0 * np.pi])
def test_no_path_is_farther_away_than_the_bound(omega, until):
    least, gap = np.array([1.5, 3.0, 6.0]), 0.01
    ends = np.array([least, least + gap])
    stretches = AmplitudeStretches(
        NONLINEAR.system_of(COLUMN), sine(), np.full(3, omega), ends
    )
    start = np.arcsin(1.0 / stretches.least)
    path, count = stretches._at_uplift(start), 200
    step = (until - start) / count
    for n in range(count):
        near = np.zeros(3, dtype=bool)  # the bound that holds for any rotation
        path = stretches._stepped(path, start + n * step, step, near)
    for i, a in enumerate(least):
        y, v = integrated(COLUMN.alpha, a, omega, until)
        assert [path.y[i], path.v[i]] == pytest.approx(
            [y, v], abs=1e-4 * (1.0 + path.z[i])
        )
        for share in (0.3, 1.0):
            other, rate = integrated(COLUMN.alpha, a + share * gap, omega, until)
            unit = stretches.gap[i]
            assert abs(other - y) <= share * unit * path.z[i]
            assert abs(rate - v) <= share * unit * path.w[i]


def test_after_the_shaking_all_bodies_of_a_stretch_end_as_is_said():
    """At 25 places of wide ranges of y and y', also about the equilibrium."""
    random, count = np.random.default_rng(3), 4000
    system, at = NONLINEAR.system_of(COLUMN), np.arange(count)
    ends = np.array([np.full(count, 1.1), np.full(count, 1.2)])
    stretches = AmplitudeStretches(system, sine(), np.full(count, 4.0), ends)
    off = _Distance(*random.uniform(0.0, 0.3, (2, count)))
    y, v = off.y + random.uniform(0.0, 2.0, count), random.uniform(-1.5, 1.0, count)
    few = slice(0, 400)  # as fast as those that just overturn after an impact
    off.y[few], off.v[few] = 0.3, 0.01
    y[few], v[few] = random.uniform([[0.7], [-0.6]], [[1.3], [-0.45]], (2, 400))
    found = stretches._after_shaking(at, _LeastPath(y, v, y, v), off)
    known = found != UNKNOWN
    assert np.unique(found).size == 4
    for up in np.linspace(-1.0, 1.0, 5):
        for right in np.linspace(-1.0, 1.0, 5):
            free = stretches._free(at, y + up * off.y, v + right * off.v)
            ended = np.where(
                free.overturns_after_impact,
                Outcome.OVERTURNED_AFTER_IMPACT,
                Outcome.ROCKED,
            )
            ended[free.overturns] = Outcome.OVERTURNED_NO_IMPACT
            np.testing.assert_array_equal(found[known], ended[known])


def test_an_envelope_has_the_same_intervals_without_these_proofs(monkeypatch):
    found = []
    for many in (1000, np.inf):
        monkeypatch.setattr(boundaries, "_MANY", many)
        found.append(
            trace_envelope(
                COLUMN, sine(), [2.2], method=NONLINEAR, a_max=4.0, workers=1
            )
        )
    assert found[0] == found[1]
    assert len(found[0]) > 1


@pytest.mark.parametrize("sign", quick((1.0, -1.0), 1.0))
def test_nothing_overturns_where_it_is_excluded(sign):
    bodies, omegas = [PILLAR, COLUMN, STOUT, STATUE], [1.3, 3.4, 8.0]
    motion = sine() if sign > 0.0 else sine().scaled(-1.0)
    march = SharedMarch(motion, bodies, [NONLINEAR] * 4)
    which, omega = (x.ravel() for x in np.meshgrid(range(4), omegas))
    uplift = np.array([one.least_uplift(motion) for one in march.systems])[which]
    high = np.full(omega.size, 3.0)
    reach = proved_to(march, which, omega, uplift, high)
    assert np.mean(reach[omega > 3.0] > 1.2 * uplift[omega > 3.0]) > 0.6
    # also above the amplitudes up to which any body keeps contact
    assert np.any(reach > march.kept_to[which])

    # Up to there all stand, and from there on a proof is tried again.
    again = proved_to(march, which, omega, np.minimum(1.1 * reach, high), high)
    for low, top in ((uplift, reach), (np.minimum(1.1 * reach, high), again)):
        row = np.repeat(np.flatnonzero(low < top), 20)
        amplitude = low[row] + (top - low)[row] * np.tile(
            np.linspace(0.0, 1.0, 20), row.size // 20
        )
        found = march.response(which[row], amplitude, omega[row], peaks=False)[1]
        assert Outcome.FAILED not in found
        assert np.all(safe(found))


@pytest.mark.soak
def test_capacities_of_a_table_are_the_same_without_these_proofs_and_in_any_order(
    monkeypatch,
):
    random = np.random.default_rng(4)
    bodies = [
        built(f"kind: block\nwidth: {width}\nheight: {width * ratio}")
        for width, ratio in random.uniform([0.3, 3.0], [1.2, 8.0], (3, 2))
    ]
    searches = [
        CapacitySearch(one, sine(), 2.0, 9.0 / one.p, NONLINEAR, 3.0) for one in bodies
    ]
    monkeypatch.setattr(capacity, "_PROVED", 2)
    found = list(capacities(searches))
    assert list(capacities(searches[::-1]))[::-1] == found
    assert [one.capacity() for one in searches] == found
    assert len({one.first for one in found}) > 2
